//! The steps of the method: equal steps, regular checks of their length, shorter steps if a check fails; and the choice of length and
//! scheme.

use super::body::{Body, Point};
use super::scheme::Scheme;
use crate::error::{Error, MotionFault};
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::Load;
use crate::motion::problem::MOST_STEPS;
use crate::motion::state::Phase;

/// The error for which a step is chosen, relative to the tolerance: over the many steps of a long motion errors add up.
const SHARE: f64 = 0.2;
/// The largest error of a step, relative to the tolerance: beyond it the step is made again, and all later steps are shorter.
const MOST: f64 = 1.5;
/// A step at the start of a span with a smaller error is much too short for the load there.
const LEAST: f64 = 1e-4;
/// The largest number of steps between two checks, and the factor by which the body may become faster until the next check.
const UNCHECKED: u32 = 64;
const FASTER: f64 = 1.05;

/// Number of trial steps in the search for the length of a step.
const TRIALS: usize = 6;
/// Iterations of that search.
const ROUNDS: usize = 5;
/// The part of the length of step at which a trial just meets the tolerance.
const SAFETY: f64 = 0.9;

/// Number of steps for each radian up to which a step may have the whole error. If there are more steps, each may have less, because
/// their errors add up within the same turn.
const PER_RADIAN: f64 = 20.0;

/// The error of a step by rounding alone.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// An integration under way.
///
/// Steps are equal as long as they are short enough: one in 64 is made once more in two halves. If its error is too large, this step and
/// all later ones become shorter. They never become longer within a span: changes of length are rare, so the conservation laws of equal
/// steps hold.
#[derive(Clone, Debug)]
pub(crate) struct Splitting {
    body: Body,
    scheme: Scheme,
    tolerance: f64,
    start: f64,
    span: f64,
    point: Point,
    /// Before the last step.
    before: Point,
    /// The length of step that was chosen; steps are a little shorter, so that a whole number of them makes the span.
    chosen: f64,
    /// The time since the start at which the steps got their present length, their number to the end, and the number of those done.
    from: f64,
    total: u32,
    taken: u32,
    /// Steps since the last check, steps until the next one, and the speed at the last check.
    unchecked: u32,
    patience: u32,
    speed: f64,
    steps: u64,
    /// Evaluations of the load.
    pub evaluations: u64,
}

impl Splitting {
    /// Begin at `phase` at time `start`, toward `end`, by equal steps of about `step`; or of the length that meets `tolerance` with the
    /// scheme that needs fewest kicks. The tolerance is that of half the angle of the attitude in radians, and of ω relative to the
    /// largest in the trial.
    ///
    /// `euler`: the equations of the body about the reference point. `mass`: that of a body that can move; none if it is fixed at that
    /// point.
    ///
    /// # Errors
    /// Errors of the load; a torque along an axis without a moment; more than [`MOST_STEPS`] steps.
    pub(crate) fn new<L: Load>(
        euler: &EulerEquations,
        mass: Option<f64>,
        [start, end]: [f64; 2],
        phase: &Phase,
        load: &mut L,
        tolerance: f64,
        step: Option<(Scheme, f64)>,
    ) -> Result<Self, L::Error> {
        let body = Body::of(euler, mass, phase);
        let point = body.point(phase);
        let mut splitting = Self {
            body,
            scheme: Scheme::Strang,
            tolerance: SHARE * tolerance,
            start,
            span: end - start,
            point,
            before: point,
            chosen: end - start,
            from: 0.0,
            total: 1,
            taken: 0,
            unchecked: 0,
            patience: 0,
            speed: 0.0,
            steps: 0,
            evaluations: 0,
        };
        if let Some((scheme, step)) = step {
            (splitting.scheme, splitting.chosen) = (scheme, step);
            let length = step
                .abs()
                .min(splitting.span.abs())
                .copysign(splitting.span);
            // The load may have changed since the step was chosen.
            let error = splitting.error(load, length)?.0;
            if error > MOST || error < LEAST && length == step {
                splitting.choose(load)?;
            }
        } else {
            splitting.choose(load)?;
        }
        splitting.divide()?;
        Ok(splitting)
    }

    /// Choose the scheme and the length of step for the present load.
    fn choose<L: Load>(&mut self, load: &mut L) -> Result<(), L::Error> {
        let elapsed = self.elapsed();
        (self.scheme, self.chosen) = cheapest(
            &self.body,
            &self.point,
            load,
            self.start + elapsed,
            self.span - elapsed,
            self.tolerance,
            &mut self.evaluations,
        )?;
        Ok(())
    }

    /// Divide the rest of the span into steps of the length chosen, or a little less.
    fn divide(&mut self) -> Result<(), Error> {
        (self.from, self.taken) = (self.elapsed(), 0);
        let count = ((self.span - self.from) / self.chosen)
            .abs()
            .ceil()
            .max(1.0);
        if count.is_nan() || count > MOST_STEPS as f64 {
            return Err(MotionFault::TooManySteps {
                time: self.start + self.from,
                steps: self.steps,
                ahead: count,
                most: MOST_STEPS as f64,
            }
            .into());
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number in the range"
        )]
        let total = count as u32;
        self.total = total;
        (self.unchecked, self.patience) = (0, 0);
        Ok(())
    }

    /// Compute the error of a step of length `h` from the present point, relative to the tolerance, and the end of the step.
    fn error<L: Load>(&mut self, load: &mut L, h: f64) -> Result<(f64, Point), L::Error> {
        let at = self.start + self.elapsed();
        let (mut whole, mut halves) = (self.point, self.point);
        self.body.step(self.scheme, &mut whole, load, at, h)?;
        self.body
            .step(self.scheme, &mut halves, load, at, 0.5 * h)?;
        (self.body).step(self.scheme, &mut halves, load, at + 0.5 * h, 0.5 * h)?;
        self.evaluations += 3 * self.scheme.kicks() as u64 + 1;
        let rate = rate(&self.body, &self.point, load, at)?;
        let error = self.body.difference(&whole, &halves) / allowed(self.tolerance, h, rate);
        Ok((error, whole))
    }

    /// Return the scheme and the length of a step.
    #[must_use]
    pub(crate) fn step(&self) -> (Scheme, f64) {
        (self.scheme, self.chosen)
    }

    /// Return the number of accepted steps.
    #[must_use]
    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    /// Return the time since the start.
    #[must_use]
    pub(crate) fn elapsed(&self) -> f64 {
        self.time(self.taken)
    }

    fn time(&self, steps: u32) -> f64 {
        if steps == self.total {
            return self.span;
        }
        self.from + (self.span - self.from) * (f64::from(steps) / f64::from(self.total))
    }

    /// Return the present state.
    #[must_use]
    pub(crate) fn phase(&self) -> Phase {
        self.body.phase(&self.point)
    }

    /// Make one step toward the end.
    ///
    /// # Errors
    /// Errors of the load; a state that is not finite.
    pub(crate) fn advance<L: Load>(&mut self, load: &mut L) -> Result<(), L::Error> {
        let speed = self.body.speed(&self.point);
        let is_due = self.unchecked >= self.patience || speed > FASTER * self.speed;
        let point = if is_due {
            self.checked_step(load, speed)?
        } else {
            let from = self.elapsed();
            let h = self.time(self.taken + 1) - from;
            let mut point = self.point;
            (self.body).step(self.scheme, &mut point, load, self.start + from, h)?;
            self.evaluations += self.scheme.kicks() as u64;
            self.unchecked += 1;
            point
        };
        if !self.body.phase(&point).is_finite() {
            let time = self.start + self.elapsed();
            return Err(Error::from(MotionFault::NotFiniteMotion { time }).into());
        }
        self.before = self.point;
        self.point = point;
        self.taken += 1;
        self.steps += 1;
        Ok(())
    }

    /// Compute the end of a step whose error is checked; the steps become shorter until it is small enough.
    fn checked_step<L: Load>(&mut self, load: &mut L, speed: f64) -> Result<Point, L::Error> {
        loop {
            let h = self.time(self.taken + 1) - self.elapsed();
            let (error, point) = self.error(load, h)?;
            // The caller checks that it is finite.
            if error <= MOST || error.is_nan() {
                (self.unchecked, self.speed) = (0, speed.max(self.speed));
                self.patience = (2 * self.patience + 1).min(UNCHECKED);
                return Ok(point);
            }
            let order = f64::from(self.scheme.order());
            let factor = (SAFETY * error.powf(-1.0 / (order + 1.0))).max(0.02);
            self.chosen = h * factor;
            if self.elapsed() + self.chosen == self.elapsed() {
                let (time, step) = (self.start + self.elapsed(), self.chosen);
                return Err(Error::from(MotionFault::StepTooSmall { time, step }).into());
            }
            self.divide()?;
        }
    }

    /// Compute the state within the last step, at a time since the start: by a shorter step from its beginning.
    ///
    /// # Errors
    /// Errors of the load.
    pub(crate) fn within<L: Load>(
        &mut self,
        elapsed: f64,
        load: &mut L,
    ) -> Result<Phase, L::Error> {
        let from = self.time(self.taken.saturating_sub(1));
        let mut point = self.before;
        let at = self.start + from;
        (self.body).step(self.scheme, &mut point, load, at, elapsed - from)?;
        self.evaluations += self.scheme.kicks() as u64;
        Ok(self.body.phase(&point))
    }
}

/// Compute the error that a step of length `h` may have, if the body turns by `rate` radians per time.
fn allowed(tolerance: f64, h: f64, rate: f64) -> f64 {
    let steps = 1.0 / (h * rate).abs();
    if steps.is_finite() {
        (tolerance * (PER_RADIAN / steps).min(1.0)).max(tolerance.min(ROUNDING))
    } else {
        tolerance // at rest
    }
}

/// Find the scheme that needs fewest kicks, and the length of step with which it meets the tolerance.
fn cheapest<L: Load>(
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

/// Find the length of step at which, over the first few steps, one step differs from two halves by no more than the tolerance.
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

/// Estimate how fast the body turns or swings, in radians per time.
fn rate<L: Load>(body: &Body, point: &Point, load: &mut L, at: f64) -> Result<f64, L::Error> {
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
    use nalgebra::{Matrix3, UnitQuaternion, Vector3};

    use super::*;
    use crate::mass::RigidBody;
    use crate::motion::euler_equations::EulerEquations;
    use crate::motion::loads::{Analytic, BodyAtPoint, Term};
    use crate::motion::state::{Phase, State};

    #[test]
    fn many_steps_in_a_radian_may_err_by_less_each_down_to_rounding() {
        // Up to twenty steps a radian all of it, of forty half.
        for (steps, part) in [(10.0, 1.0), (19.9, 1.0), (20.1, 0.995), (40.0, 0.5)] {
            let found = allowed(1e-6, -1.0 / steps / 3.0, 3.0) / 1e-6;
            assert!((found - part).abs() < 1e-4, "{steps} {found}");
        }
        assert_eq!(allowed(1e-6, 1e-300, 0.0), 1e-6);
        // The error of a step is at least that of rounding, but not above the tolerance.
        assert_eq!(allowed(1e-14, 1e-5, 1.0), ROUNDING);
        assert_eq!(allowed(0.5 * ROUNDING, 1e-5, 1.0), 0.5 * ROUNDING);
    }

    fn top(moments: [f64; 3]) -> RigidBody {
        let center = Vector3::new(0.0, 0.0, 0.6);
        RigidBody::from_principal(1.3, &moments, &Matrix3::identity(), &center, 0.0).expect("body")
    }

    fn energy(body: &RigidBody, phase: &Phase) -> f64 {
        let tensor = body.inertia_about(&Vector3::zeros());
        let height = (phase.attitude * body.center_of_mass()).z;
        0.5 * phase.omega.dot(&(tensor * phase.omega)) + body.mass() * 9.81 * height
    }

    #[test]
    fn energy_and_vertical_momentum_of_a_heavy_body_do_not_drift() {
        for moments in [[0.9, 0.9, 0.5], [0.7, 0.9, 0.5]] {
            let body = top(moments);
            let euler = EulerEquations::about(&body, &Vector3::zeros());
            let phase = Phase::in_place(&State {
                attitude: UnitQuaternion::from_euler_angles(0.8, 0.2, 0.1),
                omega: Vector3::new(0.3, 0.1, 12.0),
            });
            let gravity = [Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81)).expect("finite")];
            let mut load = Analytic::new(&gravity, BodyAtPoint::pivoted(&body, 0.0));
            let times = [0.0, 200.0];
            let mut run =
                Splitting::new(&euler, None, times, &phase, &mut load, 1e-8, None).expect("smooth");
            let vertical = |phase: &Phase| {
                let tensor = body.inertia_about(&Vector3::zeros());
                (phase.attitude * (tensor * phase.omega)).z
            };
            let (e, l) = (energy(&body, &phase), vertical(&phase));
            let (mut first, mut second): (f64, f64) = (0.0, 0.0);
            while run.elapsed() < 200.0 {
                run.advance(&mut load).expect("smooth");
                let change = (energy(&body, &run.phase()) / e - 1.0).abs();
                if run.elapsed() <= 100.0 {
                    first = first.max(change);
                } else {
                    second = second.max(change);
                }
                assert!((vertical(&run.phase()) / l - 1.0).abs() < 1e-13);
            }
            assert!(second <= 1.5 * first + 1e-13, "{first:e} {second:e}");
            assert!(first < 1e-6, "{first:e}");
        }
    }

    #[test]
    fn between_steps_and_backward() {
        let body = top([0.7, 0.9, 0.5]);
        let euler = EulerEquations::about(&body, &Vector3::zeros());
        let phase = Phase::in_place(&State {
            attitude: UnitQuaternion::from_euler_angles(0.8, 0.2, 0.1),
            omega: Vector3::new(0.3, 0.1, 3.0),
        });
        let gravity = [Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81)).expect("finite")];
        let mut load = Analytic::new(&gravity, BodyAtPoint::pivoted(&body, 0.0));
        let mut go = |times: [f64; 2], phase: &Phase| {
            let mut run =
                Splitting::new(&euler, None, times, phase, &mut load, 1e-12, None).expect("smooth");
            let mut between = phase.clone();
            while run.elapsed() != times[1] - times[0] {
                let from = run.elapsed();
                run.advance(&mut load).expect("smooth");
                let middle = 0.5 * (times[1] - times[0]);
                if (from - middle) * (run.elapsed() - middle) <= 0.0 {
                    between = run.within(middle, &mut load).expect("smooth");
                }
            }
            (between, run.phase())
        };
        let (middle, end) = go([1.0, 3.0], &phase);
        let (_, again) = go([2.0, 3.0], &middle);
        let (_, back) = go([3.0, 1.0], &end);
        assert!(end.attitude.angle_to(&again.attitude) < 1e-10);
        assert!(back.attitude.angle_to(&phase.attitude) < 1e-10);
        assert!((back.omega - phase.omega).norm() < 1e-9);
    }
}
