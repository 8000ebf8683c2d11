//! How a job is watched, and why it ends early.

use std::convert::Infallible;
use std::fmt;
use std::ops::ControlFlow;

use crate::error::Error;

/// Asked now and then, with the fraction done, whether to go on.
pub type Watch<'a> = dyn FnMut(f64) -> ControlFlow<()> + 'a;

/// Why a job ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt<E> {
    /// `watch` asked for it.
    Stopped,
    /// A block failed; of all failing blocks, the one that comes first.
    Failed(E),
}

impl<E: fmt::Display> fmt::Display for Halt<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped => Error::Stopped.fmt(f),
            Self::Failed(error) => error.fmt(f),
        }
    }
}

impl<E: std::error::Error + 'static> std::error::Error for Halt<E> {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Stopped => None,
            Self::Failed(error) => Some(error),
        }
    }
}

impl From<Halt<Infallible>> for Error {
    fn from(halt: Halt<Infallible>) -> Self {
        match halt {
            Halt::Stopped => Self::Stopped,
            Halt::Failed(never) => match never {},
        }
    }
}

impl From<Error> for Halt<Error> {
    fn from(error: Error) -> Self {
        match error {
            Error::Stopped => Self::Stopped,
            error => Self::Failed(error),
        }
    }
}

impl From<Halt<Self>> for Error {
    fn from(halt: Halt<Self>) -> Self {
        match halt {
            Halt::Stopped => Self::Stopped,
            Halt::Failed(error) => error,
        }
    }
}
