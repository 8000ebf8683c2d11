//! The equations that a stepper solves, and the state that it carries.

use nalgebra::SVector;

use crate::error::Error;
use crate::numerics::double_double::two_sum;

/// The equations that a stepper solves.
pub(crate) trait System<const N: usize> {
    /// What evaluating the equations may go wrong with, besides what the stepper itself may refuse.
    type Error: From<Error>;

    /// `f(t, y)` into `slope`, all numbers of it. It is not returned, since a copy of it would wait until it is written.
    ///
    /// # Errors
    /// Ends the integration and comes back to the caller as it is.
    fn derivative(
        &mut self,
        t: f64,
        y: &SVector<f64, N>,
        slope: &mut SVector<f64, N>,
    ) -> Result<(), Self::Error>;

    /// The size of `error` in a step from `y` to `y_new`, in units of what is allowed: at most one is accepted.
    fn error_norm(
        &self,
        y: &SVector<f64, N>,
        y_new: &SVector<f64, N>,
        error: &SVector<f64, N>,
    ) -> f64;

    /// Called with each accepted state: puts it back on the manifold it belongs to, and takes note of it.
    fn accept(&mut self, y: &mut Compensated<N>);
}

/// A state with the rounding errors of its increments carried along, so that many small steps add up as few large ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compensated<const N: usize> {
    /// The rounded state.
    pub value: SVector<f64, N>,
    /// What rounding has left out so far.
    rest: SVector<f64, N>,
}

impl<const N: usize> Compensated<N> {
    /// The state `value`, exactly.
    #[must_use]
    #[inline]
    pub(crate) fn new(value: SVector<f64, N>) -> Self {
        Self {
            value,
            rest: SVector::zeros(),
        }
    }

    /// The state with `increment` added.
    #[must_use]
    #[inline]
    pub(crate) fn plus(&self, increment: &SVector<f64, N>) -> Self {
        let mut sum = *self;
        for i in 0..N {
            (sum.value[i], sum.rest[i]) = two_sum(self.value[i], increment[i] + self.rest[i]);
        }
        sum
    }

    /// What rounding has left out of `value`.
    #[must_use]
    #[inline]
    pub(crate) fn rest(&self) -> &SVector<f64, N> {
        &self.rest
    }
}
