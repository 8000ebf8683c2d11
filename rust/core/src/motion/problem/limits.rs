//! Which runs are refused, before the first step or on the way; and the spans that breaks of a load cut a run into.

use nalgebra::Vector3;

use crate::error::{Error, MotionFault, all_finite, finite};
use crate::mass::RigidBody;

/// The most steps that a run takes.
pub const MOST_STEPS: u64 = 1_000_000_000;
/// The steps after which a run is judged by how far it has come.
const JUDGED: u64 = 1 << 17;
/// How many times its most steps a run that is judged may seem to need: its steps may yet become longer.
const HOPELESS: f64 = 1e3;

/// Refuses to go on with a run that has taken all its `most_steps`, or is hopelessly far from the end of its `span` of time.
///
/// # Errors
/// [`MotionFault::TooManySteps`].
pub(crate) fn check_steps(
    most_steps: u64,
    steps: u64,
    start: f64,
    elapsed: f64,
    span: f64,
) -> Result<(), Error> {
    let (most, ahead) = (most_steps as f64, steps as f64 * (span / elapsed).abs());
    let is_hopeless = steps >= JUDGED && ahead > HOPELESS * most;
    if steps < most_steps && !is_hopeless {
        return Ok(());
    }
    Err(Error::Motion(MotionFault::TooManySteps {
        time: start + elapsed,
        steps,
        ahead,
        most,
    }))
}

/// The changes of a law on one spot after which a run gives up.
pub(crate) const HELD: u32 = 3;

/// Checks the output times of a simulation.
///
/// # Examples
///
/// ```
/// use polhode::motion::simulate::check_times;
///
/// assert!(check_times(&[0.0, 1.0, 2.0]).is_ok() && check_times(&[0.0, -1.0, -2.0]).is_ok());
/// assert!(check_times(&[0.0, 2.0, 1.0]).is_err());
/// ```
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
            return Err(Error::Motion(MotionFault::NotMonotone {
                what: "t",
                order: "monotone",
                index: k + 1,
                previous: pair[0],
                next: pair[1],
            }));
        }
    }
    Ok(())
}

/// Squares and cubes of the rates of a run, and its torques, stay within float64 while its span is within these bounds.
const SPANS: std::ops::RangeInclusive<f64> = 1e-100..=1e100;
/// Likewise of the largest moment over the square of the span.
const TORQUES: std::ops::RangeInclusive<f64> = 1e-250..=1e250;

/// Checks that the equations of motion of a body through these times can be integrated in float64: its moments about the point
/// that is fixed, if one is, must be finite; rates are of the order of one over the span or more, and torques are moments times
/// their squares.
///
/// # Errors
/// [`Error::NonFinite`], [`Error::OutOfDomain`].
pub fn check_scales(body: &RigidBody, is_pivoted: bool, times: &[f64]) -> Result<(), Error> {
    if is_pivoted {
        body.check_about(&Vector3::zeros())?;
    }
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

/// The ends of the spans into which `breaks` cut the time from the first to the last of `times`.
pub(in crate::motion) fn spans(times: &[f64], mut breaks: Vec<f64>) -> Vec<f64> {
    let (start, end) = (times[0], times[times.len() - 1]);
    if start == end {
        return vec![start];
    }
    breaks.retain(|t| (t - start) * (t - end) < 0.0);
    breaks.extend([start, end]);
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    if end < start {
        breaks.reverse();
    }
    breaks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_cannot_end_are_refused() {
        let is_refused =
            |steps, elapsed| check_steps(MOST_STEPS, steps, 0.0, elapsed, 1.0).is_err();
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
