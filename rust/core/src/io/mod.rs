//! Triangles from files.
//!
//! | format | file |
//! |---|---|
//! | binary STL | [`stl`] |
//! | binary PLY | [`ply`] |
//! | `v`/`f` text: OBJ geometry and plate models | [`plates`] |

pub mod plates;
pub mod ply;
pub mod stl;

use std::io;
use std::ops::ControlFlow;

use thiserror::Error as ThisError;

use crate::error::Error;

/// Vertices and the triangles that count them from zero.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// Coordinates as stored in the file.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of each triangle.
    pub faces: Vec<[usize; 3]>,
}

/// The corners of a triangle.
pub type Triangle = [[f64; 3]; 3];

/// Triangles that a stream hands over at a time, but for the last time.
pub const BLOCK: usize = crate::numerics::reduce::BLOCK;

/// The triangles of a file in order, as often as asked, without all of them ever being in memory.
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

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, ThisError)]
#[non_exhaustive]
pub enum FileFault {
    /// Shorter than its header promises, or than a header.
    #[error(
        "truncated binary STL: {held} bytes where its header of {triangles} triangles promises {promised}"
    )]
    TruncatedStl {
        /// Bytes in the file.
        held: u64,
        /// Bytes that the header promises.
        promised: u64,
        /// Triangles that the header promises.
        triangles: u32,
    },
    /// Longer than its header promises.
    #[error(
        "not a binary STL: {held} bytes where its header of {triangles} triangles promises {promised}; \
         if it is another format give it that format's suffix"
    )]
    NotStl {
        /// Bytes in the file.
        held: u64,
        /// Bytes that the header promises.
        promised: u64,
        /// Triangles that the header promises.
        triangles: u32,
    },
    /// Too short to hold the header of a binary STL.
    #[error("not a binary STL: {held} bytes are less than its header of 84")]
    NoStlHeader {
        /// Bytes in the file.
        held: u64,
    },
    /// A header of a PLY file that cannot be understood.
    #[error("not a readable PLY file: {why}")]
    BadPly {
        /// What is wrong with it.
        why: String,
    },
    /// A PLY file that ends before its last face.
    #[error(
        "truncated PLY: its header promises {promised} {element} elements, but the file ends in number {held}"
    )]
    TruncatedPly {
        /// Name of the element.
        element: String,
        /// How many the header promises.
        promised: usize,
        /// The element that is not whole, from zero.
        held: usize,
    },
    /// A line that cannot be understood.
    #[error("line {line}: {why}")]
    BadLine {
        /// Counted from one.
        line: usize,
        /// What is wrong with it.
        why: String,
    },
    /// A face index of zero where faces count from one.
    #[error(
        "line {line}: face index 0, but faces count their vertices from 1; if this file counts from 0 \
         say so: index_base=0, or --index-base 0 on the command line"
    )]
    IndexZero {
        /// Counted from one.
        line: usize,
    },
    /// No faces in the file.
    #[error("no faces: {vertices} vertices and not one face line")]
    NoFaces {
        /// Vertices found.
        vertices: usize,
    },
}
