//! Standard deviations and covariances that are given, as linear forms of standard normal variables.

use super::variable::{Source, Variable};
use crate::error::{Error, UncertaintyFault, finite};

/// A linear form: what one standard deviation of each variable does to a number, in the order of the variables.
pub type Form = Vec<(Variable, f64)>;

/// The doubts of several numbers, a form for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// The forms.
    pub forms: Vec<Form>,
}

/// What is left of a variance, relative to it, that is rounding.
const ROUNDING: f64 = 1e-13;

impl Given {
    /// Independent numbers with these standard deviations; one without has no variable.
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
    /// # Errors
    /// When the matrix is not symmetric, or some combination of the numbers would have a negative variance.
    pub fn correlated(covariance: &[f64], source: Source) -> Result<Self, Error> {
        let count = covariance.len().isqrt();
        let (scale, mut rest) = correlations(covariance, count)?;
        // Cholesky's decomposition of the correlations, so that numbers of any units stand side by side; the number with most of
        // its variance left comes next, so that what is left at the end is rounding or no covariance.
        let mut forms = vec![Form::new(); count];
        for step in 0..count {
            let left = |i: usize| rest[i * count + i];
            let pivot = (0..count)
                .max_by(|&i, &j| left(i).total_cmp(&left(j)))
                .unwrap_or(0);
            if left(pivot) <= ROUNDING {
                break;
            }
            let root = left(pivot).sqrt();
            let column: Vec<f64> = (0..count).map(|i| rest[i * count + pivot] / root).collect();
            for i in 0..count {
                for j in 0..count {
                    rest[i * count + j] -= column[i] * column[j];
                }
                if column[i] != 0.0 {
                    forms[i].push((variable(source, step), scale[i] * column[i]));
                }
            }
            // What the pivot explains of itself is all of it.
            for i in 0..count {
                rest[i * count + pivot] = 0.0;
                rest[pivot * count + i] = 0.0;
            }
        }
        // Where a variance is used up nothing may be left beside it.
        for i in 0..count {
            let worst = (0..count)
                .map(|j| rest[i * count + j])
                .fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
            if worst.abs() > ROUNDING * (count as f64) {
                return Err(UncertaintyFault::NotPositive {
                    index: i,
                    left: -worst.abs(),
                }
                .into());
            }
        }
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

/// Standard deviations, and the matrix of correlations by rows.
fn correlations(covariance: &[f64], count: usize) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let at = |i: usize, j: usize| covariance[i * count + j];
    for i in 0..count {
        for j in 0..count {
            finite("covariance", at(i, j))?;
        }
        if at(i, i) < 0.0 {
            return Err(UncertaintyFault::NegativeVariance {
                index: i,
                variance: at(i, i),
            }
            .into());
        }
    }
    let scale: Vec<f64> = (0..count).map(|i| at(i, i).sqrt()).collect();
    let mut matrix = vec![0.0; count * count];
    for i in 0..count {
        for j in 0..count {
            let (a, b) = (at(i, j), at(j, i));
            if (a - b).abs() > 1e-12 * (scale[i] * scale[j]) {
                return Err(UncertaintyFault::NotSymmetric {
                    row: i,
                    column: j,
                    a,
                    b,
                }
                .into());
            }
            if scale[i] > 0.0 && scale[j] > 0.0 {
                matrix[i * count + j] = 0.5 * (a / scale[i] / scale[j] + b / scale[i] / scale[j]);
            } else if a != 0.0 {
                // Of a number that is known, with another.
                return Err(UncertaintyFault::NotPositive {
                    index: i.max(j),
                    left: -a.abs(),
                }
                .into());
            }
        }
    }
    Ok((scale, matrix))
}

/// Component `index` of a source, of which there are fewer than 2³².
fn variable(source: Source, index: usize) -> Variable {
    source.variable(u32::try_from(index).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_covariance_comes_back() {
        let source = Source::fresh();
        let p = [4.0, 1.0, -2.0, 1.0, 9.0, 0.5, -2.0, 0.5, 16.0];
        let given = Given::correlated(&p, source).expect("positive");
        for i in 0..3 {
            for j in 0..3 {
                assert!((given.covariance(i, j) - p[3 * i + j]).abs() < 1e-14);
            }
        }
        let one = Given::correlated(&[1e-40, 1e-40, 1e-40, 1e-40], source).expect("one variable");
        assert_eq!(one.forms[1].len(), 1);
        let known = Given::correlated(&[0.0, 0.0, 0.0, 4.0], source).expect("one known");
        assert!(known.forms[0].is_empty() && known.forms[1].len() == 1);
    }

    #[test]
    fn what_is_no_covariance_is_told() {
        let source = Source::fresh();
        let fault = |p: &[f64]| Given::correlated(p, source).expect_err("no covariance");
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
        assert!(Given::independent(&[-1.0], source).is_err());
        assert!(Given::independent(&[f64::NAN], source).is_err());
    }
}
