//! Triangles one after the other, without all of them ever being in memory: what a reader of files offers.

use std::ops::ControlFlow;
use std::{fmt, io};

use crate::error::{Error, FileFault};

/// The corners of a triangle.
pub type Triangle = [[f64; 3]; 3];

/// Triangles that a stream hands over at a time, but for the last time.
pub const BLOCK: usize = crate::numerics::tree_sum::BLOCK;

/// The triangles of a file in order, as often as asked, without all of them ever being in memory.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::Amount;
/// use polhode::mass::polyhedron::Options;
/// use polhode::mass::polyhedron::stream::{BLOCK, StreamError, Triangle, TriangleStream};
/// use polhode::mass::polyhedron::streaming::stream_solid;
///
/// /// Triangles that a program makes as they are asked for: here from a list.
/// struct Made(Vec<Triangle>);
///
/// impl TriangleStream for Made {
///     fn blocks(
///         &mut self,
///         visit: &mut dyn FnMut(&[Triangle], f64) -> ControlFlow<()>,
///     ) -> Result<(), StreamError> {
///         let mut done = 0;
///         for block in self.0.chunks(BLOCK) {
///             done += block.len();
///             if visit(block, done as f64 / self.0.len() as f64).is_break() {
///                 break;
///             }
///         }
///         Ok(())
///     }
/// }
///
/// let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let mut corner = Made(vec![[o, y, x], [o, x, z], [o, z, y], [x, y, z]]);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// // Coordinates in millimetres, by the scale.
/// let solid = stream_solid(&mut corner, 1e-3, Amount::Density(6000.0), Options::default(), go_on)?;
/// assert_eq!(solid.triangles, 4);
/// assert!((solid.body.mass() - 1e-6).abs() < 1e-20);
/// # Ok::<(), StreamError>(())
/// ```
pub trait TriangleStream {
    /// Once through: `visit` gets [`BLOCK`] triangles at a time, at the end perhaps fewer, and the fraction of the file
    /// done; where it says [`ControlFlow::Break`] there is no more.
    ///
    /// # Errors
    /// When reading fails or the file is not what its header says.
    fn blocks(
        &mut self,
        visit: &mut dyn FnMut(&[Triangle], f64) -> ControlFlow<()>,
    ) -> Result<(), StreamError>;
}

/// Why a stream ended early.
#[derive(Debug)]
pub enum StreamError {
    /// The operating system says so.
    Io(io::Error),
    /// The contents say so.
    Failed(Error),
    /// Whoever watched said stop.
    Stopped,
}

impl fmt::Display for StreamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Failed(error) => error.fmt(f),
            Self::Stopped => Error::Stopped.fmt(f),
        }
    }
}

impl std::error::Error for StreamError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io(error) => Some(error),
            Self::Failed(error) => Some(error),
            Self::Stopped => None,
        }
    }
}

impl From<io::Error> for StreamError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<Error> for StreamError {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

impl From<FileFault> for StreamError {
    fn from(fault: FileFault) -> Self {
        Self::Failed(fault.into())
    }
}
