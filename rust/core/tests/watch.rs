//! Runs that nobody interrupts. All have one function, so that what is generic over it is compiled once.

use std::ops::ControlFlow;

pub(crate) fn go_on(_: f64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}
