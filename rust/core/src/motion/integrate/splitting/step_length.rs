//! How long the equal steps may be, and which scheme then takes fewest kicks.

use super::body::{Body, Point};
use super::scheme::Scheme;
use crate::motion::loads::Load;

/// Steps that are tried to find out how long a step may be.
const TRIALS: usize = 6;
/// Rounds of that search.
const ROUNDS: usize = 5;
/// Of the length of step at which a trial just meets the tolerance.
pub(super) const SAFETY: f64 = 0.9;

/// Steps for each radian up to which a step may err by all that it is told to. Of more steps each may err by less, as their
/// errors add up within the same turn.
const PER_RADIAN: f64 = 20.0;

/// What rounding alone does to a step.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// What a step of length `h` may err by when the body moves by `rate` radians a time.
pub(super) fn allowed(tolerance: f64, h: f64, rate: f64) -> f64 {
    let steps = 1.0 / (h * rate).abs();
    if steps.is_finite() {
        (tolerance * (PER_RADIAN / steps).min(1.0)).max(tolerance.min(ROUNDING))
    } else {
        tolerance // at rest
    }
}

/// The scheme that takes fewest kicks at the length of step at which it meets the tolerance.
pub(super) fn cheapest<L: Load>(
    body: &Body,
    point: &Point,
    load: &mut L,
    start: f64,
    span: f64,
    tolerance: f64,
    evaluations: &mut u64,
) -> Result<(Scheme, f64), L::Error> {
    let mut best: Option<(f64, Scheme, f64)> = None;
    for scheme in Scheme::ALL {
        let step = longest(
            body,
            point,
            load,
            start,
            span,
            tolerance,
            scheme,
            evaluations,
        )?;
        let cost = scheme.kicks() as f64 / step.abs();
        if best.is_none_or(|(least, ..)| cost < least) {
            best = Some((cost, scheme, step));
        }
    }
    Ok(best.map_or((Scheme::Strang, span), |(_, scheme, step)| (scheme, step)))
}

/// The length of step at which one step differs from two halves by no more than the tolerance, over the first few steps.
#[expect(clippy::too_many_arguments, reason = "one search, said in full")]
fn longest<L: Load>(
    body: &Body,
    point: &Point,
    load: &mut L,
    start: f64,
    span: f64,
    tolerance: f64,
    scheme: Scheme,
    evaluations: &mut u64,
) -> Result<f64, L::Error> {
    let rate = rate(body, point, load, start)?;
    let most = span.abs() / TRIALS as f64;
    // A twentieth of a turn or a swing.
    let first = std::f64::consts::TAU / 20.0 / rate;
    let mut step = if first < most { first } else { most }.copysign(span);
    for _ in 0..ROUNDS {
        let mut worst: f64 = 0.0;
        let mut fine = *point;
        let mut reached = 0.0;
        for _ in 0..TRIALS {
            if (reached + step).abs() > span.abs() {
                break;
            }
            let mut coarse = fine;
            let at = start + reached;
            body.step(scheme, &mut coarse, load, at, step)?;
            body.step(scheme, &mut fine, load, at, 0.5 * step)?;
            body.step(scheme, &mut fine, load, at + 0.5 * step, 0.5 * step)?;
            *evaluations += 3 * scheme.kicks() as u64;
            let allowed = allowed(tolerance, step, rate);
            worst = worst.max(body.difference(&coarse, &fine) / allowed);
            reached += step;
        }
        if worst == 0.0 && reached != 0.0 {
            return Ok(span); // the load does nothing
        }
        let factor = if reached == 0.0 {
            0.25 // longer than the span
        } else {
            SAFETY * worst.powf(-1.0 / f64::from(scheme.order() + 1))
        };
        let next = step * factor.clamp(0.02, 50.0);
        if (0.8..1.1).contains(&factor) {
            return Ok(next);
        }
        step = next.abs().min(span.abs() / TRIALS as f64).copysign(span);
    }
    Ok(step)
}

/// How fast the body turns, or swings, in radians a time.
pub(super) fn rate<L: Load>(
    body: &Body,
    point: &Point,
    load: &mut L,
    at: f64,
) -> Result<f64, L::Error> {
    let phase = body.phase(point);
    let torque = load.wrench(at, &phase)?.torque;
    let along = body.q_bp.inverse_transform_vector(&torque);
    let swing: f64 = (along.iter().zip(body.moments))
        .filter(|&(_, moment)| moment > 0.0)
        .map(|(torque, moment)| (torque / moment).abs())
        .fold(0.0, f64::max);
    Ok(phase.omega.norm().max(swing.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_steps_in_a_radian_may_err_by_less_each_down_to_rounding() {
        // Up to twenty steps a radian all of it, of forty half.
        for (steps, part) in [(10.0, 1.0), (19.9, 1.0), (20.1, 0.995), (40.0, 0.5)] {
            let found = allowed(1e-6, -1.0 / steps / 3.0, 3.0) / 1e-6;
            assert!((found - part).abs() < 1e-4, "{steps} {found}");
        }
        assert_eq!(allowed(1e-6, 1e-300, 0.0), 1e-6);
        // A step cannot err by less than rounding, nor by more than it is told to.
        assert_eq!(allowed(1e-14, 1e-5, 1.0), ROUNDING);
        assert_eq!(allowed(0.5 * ROUNDING, 1e-5, 1.0), 0.5 * ROUNDING);
    }
}
