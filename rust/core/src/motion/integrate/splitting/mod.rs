//! Splitting: kicks by the load between exact free motions, at equal steps.
//!
//! The energy of the free motion and that of position are each followed exactly, one at a time; a composition that reads
//! the same backward keeps the total energy near its start for as long as the motion lasts, where other methods drift
//! (Hairer, Lubich & Wanner, Geometric Numerical Integration, §V.1, §IX; `McLachlan` and Quispel, Acta Numerica 11 (2002) 341).

mod body;
pub mod scheme;
mod short_turn;
mod step_length;
#[cfg(test)]
mod tests;

use self::body::{Body, Point};
pub use self::scheme::Scheme;
use self::step_length::cheapest;
use crate::error::Error;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::Load;
use crate::motion::state::Phase;

/// An integration under way.
#[derive(Clone, Debug)]
pub struct Splitting {
    body: Body,
    scheme: Scheme,
    start: f64,
    span: f64,
    point: Point,
    /// Before the last step.
    before: Point,
    taken: u32,
    total: u32,
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
    /// What the load refuses; a torque along an axis without a moment; more than 2³² steps.
    pub fn new<L: Load>(
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
        let span = end - start;
        let mut evaluations = 0;
        let (scheme, step) = match step {
            Some(chosen) => chosen,
            None => cheapest(
                &body,
                &point,
                load,
                start,
                span,
                tolerance,
                &mut evaluations,
            )?,
        };
        let count = (span / step).abs().ceil().max(1.0);
        if count.is_nan() || count > f64::from(u32::MAX) {
            return Err(Error::StepTooSmall { time: start, step }.into());
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number in the range"
        )]
        let total = count as u32;
        Ok(Self {
            body,
            scheme,
            start,
            span,
            point,
            before: point,
            taken: 0,
            total,
            evaluations,
        })
    }

    /// The scheme and the length of a step.
    #[must_use]
    pub fn step(&self) -> (Scheme, f64) {
        (self.scheme, self.span / f64::from(self.total))
    }

    /// Accepted steps.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.taken.into()
    }

    /// Time since the start.
    #[must_use]
    pub fn elapsed(&self) -> f64 {
        self.time(self.taken)
    }

    fn time(&self, steps: u32) -> f64 {
        if steps == self.total {
            return self.span;
        }
        self.span * (f64::from(steps) / f64::from(self.total))
    }

    /// The state now.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.body.phase(&self.point)
    }

    /// One step toward the end.
    ///
    /// # Errors
    /// What the load refuses; a state that is not finite.
    pub fn advance<L: Load>(&mut self, load: &mut L) -> Result<(), L::Error> {
        let from = self.elapsed();
        let h = self.time(self.taken + 1) - from;
        self.before = self.point;
        let mut point = self.point;
        (self.body).step(self.scheme, &mut point, load, self.start + from, h)?;
        self.evaluations += self.scheme.kicks() as u64;
        if !(self.body.phase(&point).numbers().iter()).all(|x| x.is_finite()) {
            let time = self.start + from;
            return Err(Error::NotFiniteMotion { time }.into());
        }
        self.point = point;
        self.taken += 1;
        Ok(())
    }

    /// The state at a time since the start that is within the last step: by a shorter step from where it began.
    ///
    /// # Errors
    /// What the load refuses.
    pub fn within<L: Load>(&mut self, elapsed: f64, load: &mut L) -> Result<Phase, L::Error> {
        let from = self.time(self.taken.saturating_sub(1));
        let mut point = self.before;
        let at = self.start + from;
        (self.body).step(self.scheme, &mut point, load, at, elapsed - from)?;
        self.evaluations += self.scheme.kicks() as u64;
        Ok(self.body.phase(&point))
    }
}
