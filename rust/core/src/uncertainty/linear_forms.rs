//! Standard deviations and covariances that are given, as linear forms of standard normal variables.

use super::variable::{Source, Variable};
use crate::error::{Error, finite};
use crate::numerics::cholesky::factor;

/// A linear form: what one standard deviation of each variable does to a number, in the order of the variables.
pub type Form = Vec<(Variable, f64)>;

/// The uncertainties of several numbers, a form for each.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearForms {
    /// The forms.
    pub forms: Vec<Form>,
}

impl LinearForms {
    /// Independent numbers with these standard deviations; one without has no variable.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::uncertainty::{LinearForms, Source};
    ///
    /// let masses = LinearForms::independent(&[0.1, 0.2], Source::named("scales"))?;
    /// assert!((masses.covariance(1, 1) - 0.04).abs() < 1e-17);
    /// assert_eq!(masses.covariance(0, 1), 0.0);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When one is negative or not finite.
    pub fn independent(sigma: &[f64], source: Source) -> Result<Self, Error> {
        let form = |(index, &sigma): (usize, &f64)| {
            finite("sigma", sigma)?;
            if sigma < 0.0 {
                let law = "zero or more";
                return Err(Error::OutOfDomain {
                    what: "sigma",
                    law,
                    value: sigma,
                });
            }
            Ok(if sigma == 0.0 {
                Form::new()
            } else {
                vec![(variable(source, index), sigma)]
            })
        };
        let forms = sigma
            .iter()
            .enumerate()
            .map(form)
            .collect::<Result<_, _>>()?;
        Ok(Self { forms })
    }

    /// Numbers with this covariance, by rows: forms of as many variables as it has ranks.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::uncertainty::{LinearForms, Source};
    ///
    /// // Two lengths from one ruler, their correlation ½.
    /// let lengths = LinearForms::correlated(&[0.04, 0.03, 0.03, 0.09], Source::named("ruler"))?;
    /// assert!((lengths.covariance(0, 1) - 0.03).abs() < 1e-15);
    /// assert!(LinearForms::correlated(&[0.04, 0.07, 0.07, 0.09], Source::fresh()).is_err()); // correlation 7/6
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the matrix is not symmetric, or some combination of the numbers would have a negative variance.
    pub fn correlated(covariance: &[f64], source: Source) -> Result<Self, Error> {
        let count = covariance.len().isqrt();
        let factor = factor(covariance)?;
        let form = |row: &[f64]| {
            let parts = row.iter().enumerate();
            (parts.filter(|(_, part)| **part != 0.0))
                .map(|(step, &part)| (variable(source, step), part))
                .collect()
        };
        let forms = factor.chunks(count.max(1)).map(form).collect();
        Ok(Self { forms })
    }

    /// The covariance of two of the numbers.
    #[must_use]
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        let other = &self.forms[j];
        (self.forms[i].iter())
            .filter_map(|(variable, a)| {
                let place = other
                    .binary_search_by_key(variable, |(other, _)| *other)
                    .ok()?;
                Some(a * other[place].1)
            })
            .fold(0.0, |sum, product| sum + product) // `sum` of none is −0
    }
}

/// Component `index` of a source, of which there are fewer than 2³².
fn variable(source: Source, index: usize) -> Variable {
    source.variable(u32::try_from(index).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::UncertaintyFault;

    #[test]
    fn a_covariance_comes_back() {
        let source = Source::fresh();
        let p = [4.0, 1.0, -2.0, 1.0, 9.0, 0.5, -2.0, 0.5, 16.0];
        let given = LinearForms::correlated(&p, source).expect("positive");
        for i in 0..3 {
            for j in 0..3 {
                assert!((given.covariance(i, j) - p[3 * i + j]).abs() < 1e-14);
            }
        }
        let one =
            LinearForms::correlated(&[1e-40, 1e-40, 1e-40, 1e-40], source).expect("one variable");
        assert_eq!(one.forms[1].len(), 1);
        let known = LinearForms::correlated(&[0.0, 0.0, 0.0, 4.0], source).expect("one known");
        assert!(known.forms[0].is_empty() && known.forms[1].len() == 1);
    }

    #[test]
    fn what_is_no_covariance_is_told() {
        let source = Source::fresh();
        let fault = |p: &[f64]| LinearForms::correlated(p, source).expect_err("no covariance");
        let weak = [1.0, 1.0, 0.0, 1.0, 1.0, 1e-6, 0.0, 1e-6, 1.0];
        assert!(matches!(
            fault(&weak),
            Error::Uncertainty(UncertaintyFault::NotPositive { .. })
        ));
        for p in [[1.0, 1.1, 1.1, 1.0], [0.0, 1.0, 1.0, 1.0]] {
            assert!(matches!(
                fault(&p),
                Error::Uncertainty(UncertaintyFault::NotPositive { .. })
            ));
        }
        assert!(matches!(
            fault(&[1.0, 0.5, 0.4, 1.0]),
            Error::Uncertainty(UncertaintyFault::NotSymmetric {
                row: 0,
                column: 1,
                ..
            })
        ));
        assert!(matches!(
            fault(&[-1.0]),
            Error::Uncertainty(UncertaintyFault::NegativeVariance { index: 0, .. })
        ));
        assert!(LinearForms::independent(&[-1.0], source).is_err());
        assert!(LinearForms::independent(&[f64::NAN], source).is_err());
    }
}
