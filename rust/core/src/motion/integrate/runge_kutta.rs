//! What Runge-Kutta methods have in common: the way from the start to the end, and what a run asks of them.

use nalgebra::SVector;

use super::first_step::first_step;
use super::system::{Compensated, System};
use crate::error::{Error, MotionFault};
use crate::numerics::double_double::fast_two_sum;

/// How far an integration has come.
#[derive(Clone, Debug)]
pub(crate) struct Progress<const N: usize> {
    /// The time at which it starts, and the time from there to the end, negative backward in time.
    pub(super) start: f64,
    pub(super) span: f64,
    /// Time since the start, and what rounding has left out of it.
    pub(super) elapsed: (f64, f64),
    pub(super) state: Compensated<N>,
    /// The step to try next.
    pub(super) step: f64,
    /// Accepted steps.
    pub steps: u64,
    /// Evaluations of the equations, those for Jacobians included.
    pub evaluations: u64,
}

impl<const N: usize> Progress<N> {
    /// At the state `y` at time `start`, and the slope there; the first step is `step`, or one that suits a method whose error is of
    /// the order 1/`exponent`.
    pub(super) fn new<S: System<N>>(
        system: &mut S,
        [start, end]: [f64; 2],
        y: SVector<f64, N>,
        step: Option<f64>,
        exponent: f64,
    ) -> Result<(Self, SVector<f64, N>), S::Error> {
        let mut state = Compensated::new(y);
        system.accept(&mut state);
        let mut progress = Self {
            start,
            span: end - start,
            elapsed: (0.0, 0.0),
            state,
            step: 0.0,
            steps: 0,
            evaluations: 0,
        };
        let (span, y) = (progress.span, progress.state.value);
        let mut slope = SVector::zeros();
        progress.slope(system, 0.0, &y, &mut slope)?;
        if !slope.iter().all(|x| x.is_finite()) {
            return Err(Error::Motion(MotionFault::NotFiniteMotion { time: start }).into());
        }
        progress.step = match step {
            Some(step) if step != 0.0 => step.abs().min(span.abs()).copysign(span),
            _ => {
                progress.evaluations += 1;
                first_step(system, start, span, &y, &slope, exponent)?
            }
        };
        Ok((progress, slope))
    }

    /// The slope in the state `y` at a time since the start, into `slope`.
    #[inline]
    pub(super) fn slope<S: System<N>>(
        &mut self,
        system: &mut S,
        elapsed: f64,
        y: &SVector<f64, N>,
        slope: &mut SVector<f64, N>,
    ) -> Result<(), S::Error> {
        self.evaluations += 1;
        system.derivative(self.start + elapsed, y, slope)
    }

    /// The step to try, and whether it is the last one.
    ///
    /// # Errors
    /// [`MotionFault::StepTooSmall`].
    #[inline]
    pub(super) fn next(&self) -> Result<(f64, bool), Error> {
        let remaining = (self.span - self.elapsed.0) - self.elapsed.1;
        let is_last = 1.01 * self.step.abs() >= remaining.abs();
        let h = if is_last { remaining } else { self.step };
        if self.elapsed.0 + h == self.elapsed.0 && !is_last {
            return Err(self.stuck(h));
        }
        Ok((h, is_last))
    }

    /// Goes on by an accepted step `h`.
    #[inline]
    pub(super) fn advance(&mut self, h: f64, is_last: bool) {
        self.elapsed = if is_last {
            (self.span, 0.0)
        } else {
            fast_two_sum(self.elapsed.0, h + self.elapsed.1)
        };
        self.steps += 1;
    }

    /// After a step that was refused for its `error`: that the next one still advances the time.
    ///
    /// # Errors
    /// [`MotionFault::NotFiniteMotion`], [`MotionFault::StepTooSmall`].
    #[inline]
    pub(super) fn check_advances(&self, error: f64) -> Result<(), Error> {
        if self.elapsed.0 + self.step != self.elapsed.0 {
            return Ok(());
        }
        Err(if error.is_nan() {
            let time = self.start + self.elapsed.0;
            Error::Motion(MotionFault::NotFiniteMotion { time })
        } else {
            self.stuck(self.step)
        })
    }

    #[inline]
    fn stuck(&self, step: f64) -> Error {
        Error::Motion(MotionFault::StepTooSmall {
            time: self.start + self.elapsed.0,
            step,
        })
    }
}

/// A Runge-Kutta method under way.
pub(crate) trait RungeKutta<const N: usize>: Sized {
    /// At the state `y` at time `start`, on the way to `end`, with `step` to try first or one of its own choice.
    ///
    /// # Errors
    /// What the equations refuse at the start; a slope there that is not finite.
    fn new<S: System<N>>(
        system: &mut S,
        start: f64,
        end: f64,
        y: SVector<f64, N>,
        step: Option<f64>,
    ) -> Result<Self, S::Error>;

    /// How far it has come.
    fn progress(&self) -> &Progress<N>;

    /// One accepted step toward the end.
    ///
    /// # Errors
    /// What the equations refuse; a step too small to advance the time.
    fn advance<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error>;

    /// The state within the last accepted step, at a time since the start.
    ///
    /// # Errors
    /// What the equations refuse, where it takes more evaluations.
    fn within<S: System<N>>(
        &mut self,
        system: &mut S,
        elapsed: f64,
    ) -> Result<SVector<f64, N>, S::Error>;

    /// Time since the start.
    #[inline]
    fn elapsed(&self) -> f64 {
        self.progress().elapsed.0
    }

    /// The step that would be tried next.
    #[inline]
    fn step(&self) -> f64 {
        self.progress().step
    }

    /// Whether the end is reached.
    #[cfg(test)]
    #[inline]
    fn is_finished(&self) -> bool {
        self.elapsed() == self.progress().span
    }

    /// The state now.
    #[inline]
    fn state(&self) -> &SVector<f64, N> {
        &self.progress().state.value
    }
}
