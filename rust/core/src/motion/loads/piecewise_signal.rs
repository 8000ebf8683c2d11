//! A number that is constant, held from time to time, or the rate of one that runs straight from time to time.

use std::sync::Arc;

use super::principal_frame::{LawNumber, PrincipalFrame};
use super::spline::check_ascending;
use super::variables::Parameter;
use crate::error::{Error, MotionFault, all_finite, finite};

/// A number that changes at known times.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::PiecewiseSignal;
///
/// let torque = PiecewiseSignal::table("torque", &[0.0, 2.0], &[1.0, 3.0])?;
/// assert_eq!((torque.value(0.5), torque.times()), (PiecewiseSignal::constant("torque", 1.0)?.value(9.0), &[0.0, 2.0][..]));
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseSignal {
    /// Ascending; none of a constant.
    times: Arc<[f64]>,
    values: Arc<[f64]>,
}

impl PiecewiseSignal {
    /// The same at all times.
    ///
    /// # Errors
    /// When it is not finite.
    pub fn constant(what: &'static str, value: f64) -> Result<Self, Error> {
        finite(what, value)?;
        Ok(Self {
            times: Arc::default(),
            values: [value].into(),
        })
    }

    /// `values[k]` from `times[k]` on, or there.
    ///
    /// # Errors
    /// Without times, for times that do not ascend, for numbers that are not finite.
    ///
    /// # Panics
    /// When `times` and `values` differ in length.
    pub fn table(what: &'static str, times: &[f64], values: &[f64]) -> Result<Self, Error> {
        assert_eq!(times.len(), values.len(), "a value for each time");
        if times.is_empty() {
            return Err(Error::Empty { what: "times" });
        }
        check_ascending("times", times)?;
        all_finite(what, values)?;
        Ok(Self {
            times: times.into(),
            values: values.into(),
        })
    }

    /// The signal whose values are `factor` times as large.
    pub(super) fn scaled(&self, what: &'static str, factor: f64) -> Result<Self, Error> {
        let values: Arc<[f64]> = self.values.iter().map(|value| value * factor).collect();
        all_finite(what, &*values)?;
        Ok(Self {
            times: Arc::clone(&self.times),
            values,
        })
    }

    /// The times at which it changes.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The values at those times, or the one of a constant.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Whether it is known from one time to another: from its first time on, and where it `ends`, up to its last.
    pub(super) fn covers(
        &self,
        what: &'static str,
        from: f64,
        to: f64,
        ends: bool,
    ) -> Result<(), Error> {
        let (Some(&first), Some(&last)) = (self.times.first(), self.times.last()) else {
            return Ok(());
        };
        let last = if ends { last } else { f64::INFINITY };
        for t in [from, to] {
            if t < first || t > last {
                return Err(Error::Motion(MotionFault::OutsideTimes {
                    what,
                    t,
                    first,
                    last,
                }));
            }
        }
        Ok(())
    }

    /// The value at time `t`, held since the last of its times up to it.
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        self.values[self.index(t)]
    }

    /// The value at time `t` in numbers of any kind. It is made of the numbers of the term of this name.
    pub(super) fn number<X: LawNumber>(
        &self,
        t: f64,
        axes: &PrincipalFrame<'_, X>,
        name: &str,
    ) -> X {
        let index = self.index(t);
        axes.element(self.values[index], name, index)
    }

    fn index(&self, t: f64) -> usize {
        let passed = self.times.partition_point(|&time| time <= t);
        passed.saturating_sub(1)
    }

    /// How fast the straight lines change after `t`, likewise.
    pub(super) fn slope<X: LawNumber>(
        &self,
        t: f64,
        axes: &PrincipalFrame<'_, X>,
        name: &str,
    ) -> X {
        let mut slope = X::from(self.line(t)[1]);
        if axes.varies(name) {
            for (index, [_, share]) in self.shares(t) {
                slope += axes.variation(self.values[index], name, index) * X::from(share);
            }
        }
        slope
    }

    /// The values that the straight lines are made of at time `t`, and the share of each in the value there and in the slope.
    pub(super) fn shares(&self, t: f64) -> Vec<(usize, [f64; 2])> {
        if self.times.len() < 2 {
            return vec![(0, [1.0, 0.0])];
        }
        let k = self.stretch(t);
        let (from, to) = (self.times[k - 1], self.times[k]);
        let (part, rate) = ((t - from) / (to - from), 1.0 / (to - from));
        vec![(k - 1, [1.0 - part, -rate]), (k, [part, rate])]
    }

    /// The line that holds at time `t`, by the number of the time at which it ends.
    fn stretch(&self, t: f64) -> usize {
        let passed = self.times.partition_point(|&time| time <= t);
        passed.clamp(1, self.times.len() - 1)
    }

    /// Its numbers as those of a load.
    pub(super) fn parameter(&self, name: &'static str) -> Parameter {
        if self.times.is_empty() {
            Parameter::new(name, &[])
        } else {
            Parameter::new(name, &[self.values.len()])
        }
    }

    /// The value at time `t` of the straight lines between its times, and how fast it changes after `t`.
    #[must_use]
    pub fn line(&self, t: f64) -> [f64; 2] {
        if self.times.len() < 2 {
            return [self.values[0], 0.0];
        }
        let k = self.stretch(t);
        let (from, to) = (self.times[k - 1], self.times[k]);
        let slope = (self.values[k] - self.values[k - 1]) / (to - from);
        [self.values[k - 1] + slope * (t - from), slope]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_held_or_runs_straight() {
        let table = PiecewiseSignal::table("torque", &[0.0, 1.0, 3.0], &[2.0, 4.0, 0.0])
            .expect("ascending");
        let held = [0.0, 0.5, 1.0, 2.9, 3.0, 9.0].map(|t| table.value(t));
        assert_eq!(held, [2.0, 2.0, 4.0, 4.0, 0.0, 0.0]);
        let line = [0.0, 0.5, 1.0, 2.0].map(|t| table.line(t));
        assert_eq!(line, [[2.0, 2.0], [3.0, 2.0], [4.0, -2.0], [2.0, -2.0]]);
        assert!(
            table.covers("torque", 0.0, 9.0, false).is_ok()
                && table.covers("speed", 0.0, 9.0, true).is_err()
        );
        assert!(table.covers("torque", -1e-9, 1.0, false).is_err());
        let constant = PiecewiseSignal::constant("torque", 7.0).expect("finite");
        assert_eq!(
            (constant.value(-5.0), constant.line(3.0)),
            (7.0, [7.0, 0.0])
        );
        // What its values have a share in is what it is.
        for (held, values) in [(&table, &[2.0, 4.0, 0.0][..]), (&constant, &[7.0])] {
            for t in [0.0, 0.5, 1.0, 2.0] {
                let sum = |part: usize| {
                    let shares = held.shares(t);
                    shares
                        .iter()
                        .map(|(index, share)| values[*index] * share[part])
                        .sum::<f64>()
                };
                assert_eq!([sum(0), sum(1)], held.line(t), "{t}");
            }
        }
        assert!(PiecewiseSignal::table("torque", &[0.0, 0.0], &[1.0, 1.0]).is_err());
        assert!(PiecewiseSignal::table("torque", &[], &[]).is_err());
    }
}
