//! Functions of Python that call the package anew, which calls them again: how deep that may go.
//!
//! Python counts its own frames alone. A run of `simulate` takes many times as much of the stack as one of them, and where
//! the stack ends so does the process.

use std::cell::Cell;

use pyo3::exceptions::PyRecursionError;
use pyo3::prelude::*;

/// How many calls of the package may be under way at once in a thread, each within a function that the one before called.
///
/// Nobody needs more than two or three; eight fit into the smallest stacks that Python itself can live in.
const DEEPEST: usize = 8;

thread_local! {
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

/// One call of the package that calls functions of Python, as long as it is under way.
pub(crate) struct Deeper;

impl Deeper {
    /// Goes one deeper.
    ///
    /// # Errors
    /// `RecursionError` where a function of Python has gone too deep.
    pub(crate) fn enter(what: &str) -> PyResult<Self> {
        let depth = DEPTH.get();
        if depth >= DEEPEST {
            return Err(PyRecursionError::new_err(format!(
                "{what}: {depth} calls are under way within each other, each made by a function that the one before \
                 called; more than {DEEPEST} are refused: a load, an event, a density or a progress function must not \
                 begin a run of itself"
            )));
        }
        DEPTH.set(depth + 1);
        Ok(Self)
    }
}

/// How many calls are under way in this thread.
pub(crate) fn current() -> usize {
    DEPTH.get()
}

/// Calls a function of Python for a run that is so deep, from whichever of its threads.
pub(crate) fn within<R>(depth: usize, call: impl FnOnce() -> R) -> R {
    let own = DEPTH.replace(depth);
    let answer = call();
    DEPTH.set(own);
    answer
}

impl Drop for Deeper {
    fn drop(&mut self) {
        DEPTH.set(DEPTH.get() - 1);
    }
}
