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

/// By how much a correlation may exceed 1, and a variance that the others leave fall below zero: rounding.
const ROUNDING: f64 = 1e-10;

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

    /// Numbers with this covariance, by rows: each is a form of the variables of those before it and one of its own.
    ///
    /// # Errors
    /// When the matrix is not symmetric, or some combination of the numbers would have a negative variance.
    pub fn correlated(covariance: &[f64], source: Source) -> Result<Self, Error> {
        let count = covariance.len().isqrt();
        let at = |i: usize, j: usize| covariance[i * count + j];
        let mut scale = Vec::with_capacity(count);
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
            scale.push(at(i, i).sqrt());
        }
        // Cholesky's decomposition of the correlations, so that numbers of any units stand side by side.
        let mut lower = vec![0.0; count * count];
        for i in 0..count {
            for j in 0..=i {
                let both = scale[i] * scale[j];
                if (at(i, j) - at(j, i)).abs() > ROUNDING * both.max(f64::MIN_POSITIVE) {
                    let (a, b) = (at(i, j), at(j, i));
                    return Err(UncertaintyFault::NotSymmetric {
                        row: i,
                        column: j,
                        a,
                        b,
                    }
                    .into());
                }
                let done: f64 = (0..j)
                    .map(|k| lower[i * count + k] * lower[j * count + k])
                    .sum();
                let correlation = if both == 0.0 {
                    if at(i, j) != 0.0 {
                        return Err(UncertaintyFault::NotPositive {
                            index: i,
                            left: -at(i, j).abs(),
                        }
                        .into());
                    }
                    0.0
                } else {
                    at(i, j) / scale[i] / scale[j]
                };
                let rest = correlation - done;
                lower[i * count + j] = if i == j {
                    let own = if scale[i] == 0.0 { 0.0 } else { 1.0 - done };
                    if own < -ROUNDING {
                        return Err(UncertaintyFault::NotPositive {
                            index: i,
                            left: own,
                        }
                        .into());
                    }
                    if own <= ROUNDING { 0.0 } else { own.sqrt() }
                } else if lower[j * count + j] == 0.0 {
                    if rest.abs() > ROUNDING.sqrt() {
                        return Err(UncertaintyFault::NotPositive {
                            index: i,
                            left: -rest.abs(),
                        }
                        .into());
                    }
                    0.0
                } else {
                    rest / lower[j * count + j]
                };
            }
        }
        let forms = (0..count)
            .map(|i| {
                (0..=i)
                    .map(|j| (variable(source, j), scale[i] * lower[i * count + j]))
                    .filter(|&(_, step)| step != 0.0)
                    .collect()
            })
            .collect();
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
            .sum()
    }
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
        for p in [[1.0, 1.1, 1.1, 1.0], [0.0, 1.0, 1.0, 1.0]] {
            assert!(matches!(
                fault(&p),
                Error::Uncertainty(UncertaintyFault::NotPositive { .. })
            ));
        }
        assert!(matches!(
            fault(&[1.0, 0.5, 0.4, 1.0]),
            Error::Uncertainty(UncertaintyFault::NotSymmetric {
                row: 1,
                column: 0,
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
