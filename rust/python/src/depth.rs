//! Functions of Python that call the package anew, which calls them again: how deep that may go.
//!
//! Python counts its own frames alone. A run of `simulate` takes many times as much of the stack as one of them, and where
//! the stack ends so does the process.

use std::cell::Cell;
use std::thread::LocalKey;

use pyo3::exceptions::PyRecursionError;
use pyo3::prelude::*;

/// How many calls of the package may be under way at once in a thread, each within a function that the one before called.
///
/// Nobody needs more than two or three; eight fit into a stack of 256 kB, smaller than any that threads have by default.
const DEEPEST: usize = 8;

thread_local! {
    /// How many runs are under way.
    static RUNS: Cell<usize> = const { Cell::new(0) };
    /// How many arguments are being read.
    static ARGUMENTS: Cell<usize> = const { Cell::new(0) };
}

/// One call of the package that calls functions of Python, as long as it is under way.
pub(crate) struct RecursionGuard(&'static LocalKey<Cell<usize>>);

impl RecursionGuard {
    /// A run, deeper by one than the one whose function began it.
    ///
    /// # Errors
    /// `RecursionError` where a function of Python has gone too deep.
    pub(crate) fn run(what: &str) -> PyResult<Self> {
        Self::enter(&RUNS).ok_or_else(|| {
            PyRecursionError::new_err(format!(
                "{what}: {DEEPEST} runs are under way within each other, each begun by a function that the one before \
                 called, and there may be no more: a load, an event, a density or a progress function must not begin a run \
                 that calls it again"
            ))
        })
    }

    /// The reading of an argument, whose class may know how to become an array or a rotation.
    ///
    /// # Errors
    /// `RecursionError` where that class asks the package to read it once more.
    pub(crate) fn argument(name: &str) -> PyResult<Self> {
        Self::enter(&ARGUMENTS).ok_or_else(|| {
            PyRecursionError::new_err(format!(
                "{name}: to become an array or a rotation the object passes itself on, {DEEPEST} times so far"
            ))
        })
    }

    fn enter(depth: &'static LocalKey<Cell<usize>>) -> Option<Self> {
        if depth.get() >= DEEPEST {
            return None;
        }
        depth.set(depth.get() + 1);
        Some(Self(depth))
    }
}

impl Drop for RecursionGuard {
    fn drop(&mut self) {
        self.0.set(self.0.get() - 1);
    }
}
