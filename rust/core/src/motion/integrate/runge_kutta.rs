//! The common parts of Runge-Kutta methods: the equations, the progress of an integration, the first step.

use nalgebra::SVector;

use crate::error::{Error, MotionFault};
use crate::numerics::double_double::{fast_two_sum, two_sum};

/// The equations that a stepper solves.
pub(crate) trait System<const N: usize> {
    /// The error of an evaluation of the equations, beside those of the stepper itself.
    type Error: From<Error>;

    /// Compute `f(t, y)` into `slope`, all numbers of it. It is not returned: a copy would have to wait until it is written.
    ///
    /// # Errors
    /// Ends the integration and comes back to the caller as it is.
    fn derivative(
        &mut self,
        t: f64,
        y: &SVector<f64, N>,
        slope: &mut SVector<f64, N>,
    ) -> Result<(), Self::Error>;

    /// Compute the size of `error` in a step from `y` to `y_new`, in units of the error allowed: a step with at most one is accepted.
    fn error_norm(
        &self,
        y: &SVector<f64, N>,
        y_new: &SVector<f64, N>,
        error: &SVector<f64, N>,
    ) -> f64;

    /// Called with each accepted state: project it onto its manifold, and store what the system needs of it.
    fn accept(&mut self, y: &mut Compensated<N>);
}

/// A state with the rounding errors of its increments, so that a sum of many small steps is as accurate as one of few large steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compensated<const N: usize> {
    /// The rounded state.
    pub value: SVector<f64, N>,
    /// The rounding error so far.
    rest: SVector<f64, N>,
}

impl<const N: usize> Compensated<N> {
    /// Return the state `value` without rounding error.
    #[must_use]
    #[inline]
    pub(crate) fn new(value: SVector<f64, N>) -> Self {
        Self {
            value,
            rest: SVector::zeros(),
        }
    }

    /// Return the state with `increment` added.
    #[must_use]
    #[inline]
    pub(crate) fn plus(&self, increment: &SVector<f64, N>) -> Self {
        let mut sum = *self;
        for i in 0..N {
            (sum.value[i], sum.rest[i]) = two_sum(self.value[i], increment[i] + self.rest[i]);
        }
        sum
    }

    /// Return the rounding error of `value`.
    #[must_use]
    #[inline]
    pub(crate) fn rest(&self) -> &SVector<f64, N> {
        &self.rest
    }
}

/// The progress of an integration.
#[derive(Clone, Debug)]
pub(crate) struct Progress<const N: usize> {
    /// The time at which it starts, and the time from there to the end, negative backward in time.
    pub(super) start: f64,
    pub(super) span: f64,
    /// Time since the start, and its rounding error.
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
    /// Begin in the state `y` at time `start`; return the slope there too. The first step is `step`, or one that is chosen for a method
    /// with this error.
    pub(super) fn new<S: System<N>>(
        system: &mut S,
        [start, end]: [f64; 2],
        y: SVector<f64, N>,
        step: Option<f64>,
        method: StepError,
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
                first_step(system, start, span, &y, &slope, method)?
            }
        };
        Ok((progress, slope))
    }

    /// Compute the slope in the state `y` at a time since the start.
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

    /// Return the step to try, and whether it is the last one.
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

    /// Advance the time by an accepted step `h`.
    #[inline]
    pub(super) fn advance(&mut self, h: f64, is_last: bool) {
        self.elapsed = if is_last {
            (self.span, 0.0)
        } else {
            fast_two_sum(self.elapsed.0, h + self.elapsed.1)
        };
        self.steps += 1;
    }

    /// Check, after a step that was rejected for its `error`, that the next one advances the time.
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
    /// Begin in the state `y` at time `start`, toward `end`; the first step is `step`, or the method chooses it.
    ///
    /// # Errors
    /// Errors of the equations at the start; a slope there that is not finite.
    fn new<S: System<N>>(
        system: &mut S,
        start: f64,
        end: f64,
        y: SVector<f64, N>,
        step: Option<f64>,
    ) -> Result<Self, S::Error>;

    /// Return the progress.
    fn progress(&self) -> &Progress<N>;

    /// Make one accepted step toward the end.
    ///
    /// # Errors
    /// Errors of the equations; a step too small to advance the time.
    fn advance<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error>;

    /// Compute the state within the last accepted step, at a time since the start.
    ///
    /// # Errors
    /// Errors of the equations, if more evaluations are necessary.
    fn within<S: System<N>>(
        &mut self,
        system: &mut S,
        elapsed: f64,
    ) -> Result<SVector<f64, N>, S::Error>;

    /// Return the time since the start.
    #[inline]
    fn elapsed(&self) -> f64 {
        self.progress().elapsed.0
    }

    /// Return the step to try next.
    #[inline]
    fn step(&self) -> f64 {
        self.progress().step
    }

    /// Return whether the end is reached.
    #[cfg(test)]
    #[inline]
    fn is_finished(&self) -> bool {
        self.elapsed() == self.progress().span
    }

    /// Return the present state.
    #[inline]
    fn state(&self) -> &SVector<f64, N> {
        &self.progress().state.value
    }
}

/// How the estimate of the error of a step grows with its length.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepError {
    /// Of a step h of `y' = λ y` it is this times `|λ h|` to the power of the order.
    pub constant: f64,
    /// The order.
    pub order: f64,
}

/// The least rate of change of the slope, as a part of that of the state: where the slope at the start is at a maximum, it seems to
/// change at no rate.
const LEAST_RATE: f64 = 0.0625;

/// The part of the longest first step that the error allows.
const FIRST: f64 = 0.5;

/// Choose the first step, at most `span` and with its sign, from the sizes of state, slope and change of slope; with one evaluation of
/// the equations.
///
/// If all derivatives grow at the rate ρ at which the slope changes, the error of a step h is that of `y' = ρ y` with the slope at the
/// start. So the choice is the same in any unit of time, unlike that of Hairer, Nørsett & Wanner, Solving ODEs I, §II.4, from which
/// the trial and the longest step are.
///
/// `y`, `slope`: the state and `f(start, y)`.
///
/// # Errors
/// Errors of the equations.
fn first_step<S: System<N>, const N: usize>(
    system: &mut S,
    start: f64,
    span: f64,
    y: &SVector<f64, N>,
    slope: &SVector<f64, N>,
    method: StepError,
) -> Result<f64, S::Error> {
    let (size, speed) = (system.error_norm(y, y, y), system.error_norm(y, y, slope));
    let trial = if speed > 0.0 && speed.is_finite() {
        0.01 * size / speed
    } else {
        1e-3 * span.abs()
    };
    let trial = trial.min(span.abs()).copysign(span);
    let there = y + slope * trial;
    let mut later = SVector::zeros();
    system.derivative(start + trial, &there, &mut later)?;
    let bend = system.error_norm(y, &there, &(later - slope)) / trial.abs();
    let rate = (bend / speed).max(LEAST_RATE * speed / size);
    let step = if rate > 0.0 && rate.is_finite() {
        let allowed = (rate / (method.constant * speed)).powf(1.0 / method.order);
        (FIRST * allowed / rate).min(100.0 * trial.abs())
    } else {
        trial.abs()
    };
    Ok(step.min(span.abs()).copysign(span))
}
