//! The steps of the method: equal ones, a check of their length now and then, shorter ones where it fails.

use super::body::{Body, Point};
use super::scheme::Scheme;
use super::step_length::{self, allowed, cheapest, rate};
use crate::error::{Error, MotionFault};
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::Load;
use crate::motion::problem::MOST_STEPS;
use crate::motion::state::Phase;

/// What a step is chosen to err by, in parts of the tolerance: over the many steps of a long motion errors add up.
const SHARE: f64 = 0.2;
/// What a step may err by, in tolerances: beyond it, it is made again, and those after it are shorter.
const MOST: f64 = 1.5;
/// A step at the start of a span that errs by less is much too short for the load there.
const LEAST: f64 = 1e-4;
/// Steps between two checks at most, and how much faster than at the last one the body may turn until the next.
const UNCHECKED: u32 = 64;
const FASTER: f64 = 1.05;

/// An integration under way.
///
/// Steps are equal as long as they are short enough: one in 64 is made once more in two halves. When it errs by too much, that
/// step and all after it are shorter. They never become longer within a span: a change is rare, so that what equal
/// steps keep is kept.
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
    /// The length of step that was chosen; steps are a little shorter, so that whole ones make the span.
    chosen: f64,
    /// When the steps got their present length, since the start, how many of them there are to the end, and how many are done.
    from: f64,
    total: u32,
    taken: u32,
    /// Until the next check: steps, and how fast the body may turn.
    unchecked: u32,
    patience: u32,
    speed: f64,
    steps: u64,
    /// Evaluations of the load.
    pub evaluations: u64,
}

impl Splitting {
    /// At `phase` at time `start`, on the way to `end` by equal steps of about `step`, or of the length that meets
    /// `tolerance` (of the attitude in radians, half, and of ω relative to the largest on the trial) with the scheme that
    /// takes fewest kicks.
    ///
    /// `euler`: of the body, about the reference point. `mass`: of a body that moves about; of none fixed at that point.
    ///
    /// # Errors
    /// What the load refuses; a torque along an axis without a moment; more than [`MOST_STEPS`] steps.
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
            // The load may be another one than where the step was chosen.
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

    /// Chooses the scheme and the length of step for what the load is now.
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

    /// Divides the rest of the span into steps of the length chosen, or a little less.
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

    /// By how much a step of length `h` from here errs, in tolerances, and where it ends.
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

    /// The scheme and the length of a step.
    #[must_use]
    pub(crate) fn step(&self) -> (Scheme, f64) {
        (self.scheme, self.chosen)
    }

    /// Accepted steps.
    #[must_use]
    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    /// Time since the start.
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

    /// The state now.
    #[must_use]
    pub(crate) fn phase(&self) -> Phase {
        self.body.phase(&self.point)
    }

    /// One step toward the end.
    ///
    /// # Errors
    /// What the load refuses; a state that is not finite.
    pub(crate) fn advance<L: Load>(&mut self, load: &mut L) -> Result<(), L::Error> {
        let speed = self.body.speed(&self.point);
        let is_due = self.unchecked >= self.patience || speed > FASTER * self.speed;
        let point = if is_due {
            self.checked(load, speed)?
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

    /// Where a step ends that errs by no more than it may; the steps become shorter until it does.
    fn checked<L: Load>(&mut self, load: &mut L, speed: f64) -> Result<Point, L::Error> {
        loop {
            let h = self.time(self.taken + 1) - self.elapsed();
            let (error, point) = self.error(load, h)?;
            // What is not finite is refused by the caller.
            if error <= MOST || error.is_nan() {
                (self.unchecked, self.speed) = (0, speed.max(self.speed));
                self.patience = (2 * self.patience + 1).min(UNCHECKED);
                return Ok(point);
            }
            let order = f64::from(self.scheme.order());
            let factor = (step_length::SAFETY * error.powf(-1.0 / (order + 1.0))).max(0.02);
            self.chosen = h * factor;
            if self.elapsed() + self.chosen == self.elapsed() {
                let (time, step) = (self.start + self.elapsed(), self.chosen);
                return Err(Error::from(MotionFault::StepTooSmall { time, step }).into());
            }
            self.divide()?;
        }
    }

    /// The state at a time since the start that is within the last step: by a shorter step from where it began.
    ///
    /// # Errors
    /// What the load refuses.
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
