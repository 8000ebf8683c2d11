//! Events: the times at which a function of time and state passes through zero.

use crate::motion::problem::Rule;
use crate::motion::state::Phase;

/// Functions whose passages through zero are events.
pub trait Events {
    /// As of the load.
    type Error;

    /// One rule for each function.
    fn rules(&self) -> &[Rule];

    /// The function of number `event` at time `t`.
    ///
    /// # Errors
    /// Ends the run and comes back to the caller as it is.
    fn value(&mut self, event: usize, t: f64, phase: &Phase) -> Result<f64, Self::Error>;
}

/// No events.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoEvents<E>(std::marker::PhantomData<E>);

impl<E> NoEvents<E> {
    /// None of them.
    #[must_use]
    pub fn new() -> Self {
        Self(std::marker::PhantomData)
    }
}

impl<E> Events for NoEvents<E> {
    type Error = E;

    fn rules(&self) -> &[Rule] {
        &[]
    }

    fn value(&mut self, _: usize, _: f64, _: &Phase) -> Result<f64, E> {
        Ok(f64::NAN)
    }
}
