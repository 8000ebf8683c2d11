//! What is to be simulated, and how.

use super::method::Method;
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::mass::RigidBody;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::Subject;
use crate::motion::state::Phase;

/// The tightest relative tolerance that float64 can serve.
pub const TIGHTEST: f64 = 10.0 * f64::EPSILON;
/// The tightest relative tolerance that numbers of twice the precision can serve.
pub const TIGHTEST_TWOFOLD: f64 = 1e-28;

/// The most steps that a run takes.
pub const MOST_STEPS: u64 = 1_000_000_000;
/// The steps after which a run is judged by how far it has come.
const JUDGED: u64 = 1 << 17;
/// How many times [`MOST_STEPS`] a run that is judged may seem to need: its steps may yet become longer.
const HOPELESS: f64 = 1e3;

/// Refuses to go on with a run that has taken all its steps, or is hopelessly far from the end of its `span` of time.
///
/// # Errors
/// [`MotionFault::TooManySteps`].
pub(crate) fn check_steps(steps: u64, start: f64, elapsed: f64, span: f64) -> Result<(), Error> {
    let (most, ahead) = (MOST_STEPS as f64, steps as f64 * (span / elapsed).abs());
    let is_hopeless = steps >= JUDGED && ahead > HOPELESS * most;
    if steps < MOST_STEPS && !is_hopeless {
        return Ok(());
    }
    Err(MotionFault::TooManySteps {
        time: start + elapsed,
        steps,
        ahead,
        most,
    }
    .into())
}

/// How accurate each step is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the attitude in radians (half), and of ω, position and velocity relative to the largest so far.
    pub relative: f64,
    /// Of ω, added to the relative one.
    pub absolute: f64,
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
        Ok(Self { relative, absolute })
    }

    /// Whether it is tighter than doubles can serve.
    #[must_use]
    pub fn is_beyond_doubles(&self) -> bool {
        self.relative < TIGHTEST
    }
}

/// A body and the point its motion refers to: what all motions of the body have in common.
#[derive(Clone, Copy, Debug)]
pub struct Footing {
    /// The body and its reference point, as a load sees them.
    pub subject: Subject,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
}

impl Footing {
    /// `body` free, its centre of mass the reference point, from the time `start` on.
    #[must_use]
    pub fn free(body: &RigidBody, start: f64) -> Self {
        Self::of(body, Subject::free(body, start))
    }

    /// `body` with the origin of its frame fixed in N, from the time `start` on.
    #[must_use]
    pub fn pivoted(body: &RigidBody, start: f64) -> Self {
        Self::of(body, Subject::pivoted(body, start))
    }

    fn of(body: &RigidBody, subject: Subject) -> Self {
        Self {
            subject,
            euler: EulerEquations::refined_about(body, &subject.point),
        }
    }
}

/// What is to be simulated: a body from a state through times, and how.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The body.
    pub body: &'a RigidBody,
    /// The body and its reference point, as a load sees them.
    pub subject: Subject,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
    /// The state at the first time.
    pub initial: Phase,
    /// When the state is asked for, the start first; see [`check_times`].
    pub times: &'a [f64],
    /// How.
    pub method: Method,
    /// How accurately.
    pub tolerance: Tolerance,
}

impl<'a> Task<'a> {
    /// `body` free, its centre of mass the reference point.
    #[must_use]
    pub fn free(
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        let start = times.first().copied().unwrap_or_default();
        let footing = Footing::free(body, start);
        Self::on(&footing, body, initial, times, method, tolerance)
    }

    /// `body` with the origin of its frame fixed in N.
    #[must_use]
    pub fn pivoted(
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        let start = times.first().copied().unwrap_or_default();
        let footing = Footing::pivoted(body, start);
        Self::on(&footing, body, initial, times, method, tolerance)
    }

    /// `body` on a footing of its own, which starts at the first time.
    #[must_use]
    pub fn on(
        footing: &Footing,
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        Self {
            body,
            subject: footing.subject,
            euler: footing.euler,
            initial,
            times,
            method,
            tolerance,
        }
    }
}

/// Checks the output times of a simulation.
///
/// # Errors
/// When there is none, one is not finite, or they do not run strictly in one direction.
pub fn check_times(times: &[f64]) -> Result<(), Error> {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else {
        return Err(Error::Empty { what: "t" });
    };
    all_finite("t", times)?;
    finite("the span of t", last - first)?;
    for (k, pair) in times.windows(2).enumerate() {
        let forward = if last > first {
            pair[1] > pair[0]
        } else {
            pair[1] < pair[0]
        };
        if !forward {
            return Err(MotionFault::NotMonotone {
                index: k + 1,
                previous: pair[0],
                next: pair[1],
            }
            .into());
        }
    }
    Ok(())
}

/// Squares and cubes of the rates of a run, and its torques, stay within float64 while its span is within these bounds.
const SPANS: std::ops::RangeInclusive<f64> = 1e-100..=1e100;
/// Likewise of the largest moment over the square of the span.
const TORQUES: std::ops::RangeInclusive<f64> = 1e-250..=1e250;

/// Checks that the equations of motion of a body through these times can be integrated in float64: rates are of the order of
/// one over the span or more, and torques are moments times their squares.
///
/// # Errors
/// [`Error::OutOfDomain`].
pub fn check_scales(body: &RigidBody, times: &[f64]) -> Result<(), Error> {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else {
        return Ok(());
    };
    let span = (last - first).abs();
    if span == 0.0 {
        return Ok(());
    }
    if !SPANS.contains(&span) {
        return Err(Error::OutOfDomain {
            what: "the span of t",
            law: "from 1e-100 to 1e100 for an integration in steps, whose rates and their squares are to stay within the \
                  range of float64; choose another unit of time",
            value: span,
        });
    }
    let moment = body.inertia().diagonal().max();
    if moment > 0.0 && !TORQUES.contains(&(moment / span / span)) {
        return Err(Error::OutOfDomain {
            what: "the largest moment over the square of the span of t",
            law: "from 1e-250 to 1e250 for an integration in steps, whose torques are to stay within the range of float64; \
                  choose another unit of mass, length or time",
            value: moment / span / span,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_cannot_end_are_refused() {
        let is_refused = |steps, elapsed| check_steps(steps, 0.0, elapsed, 1.0).is_err();
        assert!(is_refused(MOST_STEPS, 1.0) && !is_refused(MOST_STEPS - 1, 1.0));
        // 2¹⁷ steps for 1.3e-7 of the time are 1e12 for all of it.
        let part = JUDGED as f64 / (HOPELESS * MOST_STEPS as f64);
        assert!(is_refused(JUDGED, 0.99 * part) && !is_refused(JUDGED, 1.01 * part));
        assert!(!is_refused(JUDGED - 1, 0.5 * part));
        assert!(is_refused(JUDGED, -0.5 * part) && is_refused(JUDGED, 0.0));
    }

    #[test]
    fn times_must_run_one_way() {
        assert!(check_times(&[0.0, 1.0, 0.5]).is_err() && check_times(&[]).is_err());
        assert!(check_times(&[2.0]).is_ok() && check_times(&[0.0, -1.0, -2.0]).is_ok());
    }
}
