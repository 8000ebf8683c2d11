//! How accurate a motion is to be, and how many steps it may take.

use super::limits::MOST_STEPS;
use crate::error::{Error, finite};

/// The tightest relative tolerance that float64 can serve.
pub const TIGHTEST: f64 = 10.0 * f64::EPSILON;
/// The tightest relative tolerance that numbers of twice the precision can serve.
pub const TIGHTEST_TWOFOLD: f64 = 1e-28;

/// How accurate each step is to be, and how many there may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the attitude in radians (half), and of ω, position and velocity relative to the largest so far.
    pub relative: f64,
    /// Of ω, added to the relative one.
    pub absolute: f64,
    /// Steps of a run at most, [`MOST_STEPS`] or fewer.
    pub most_steps: u64,
}

impl Tolerance {
    /// Checked tolerances.
    ///
    /// # Errors
    /// When `relative` is not within [`TIGHTEST_TWOFOLD`]..0.1 or `absolute` is negative.
    pub fn new(relative: f64, absolute: f64) -> Result<Self, Error> {
        finite("rtol", relative)?;
        finite("atol", absolute)?;
        if !(TIGHTEST_TWOFOLD..=0.1).contains(&relative) {
            let law = "between 1e-28 and 0.1; below 2.3e-15 (ten units of rounding) the method \"taylor\" alone serves it";
            return Err(Error::OutOfDomain {
                what: "rtol",
                law,
                value: relative,
            });
        }
        if absolute < 0.0 {
            return Err(Error::OutOfDomain {
                what: "atol",
                law: "zero or more",
                value: absolute,
            });
        }
        Ok(Self {
            relative,
            absolute,
            most_steps: MOST_STEPS,
        })
    }

    /// The same with fewer steps at most.
    #[must_use]
    #[inline]
    pub fn within(self, most_steps: u64) -> Self {
        Self {
            most_steps: most_steps.min(MOST_STEPS),
            ..self
        }
    }

    /// Whether it is tighter than doubles can serve.
    #[must_use]
    #[inline]
    pub fn is_beyond_doubles(&self) -> bool {
        self.relative < TIGHTEST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_serve_down_to_the_tightest() {
        let is_beyond =
            |relative| Tolerance::new(relative, 0.0).map(|found| found.is_beyond_doubles());
        assert_eq!(is_beyond(TIGHTEST), Ok(false));
        assert_eq!(is_beyond(0.999 * TIGHTEST), Ok(true));
        assert!(is_beyond(0.999 * TIGHTEST_TWOFOLD).is_err());
    }
}
