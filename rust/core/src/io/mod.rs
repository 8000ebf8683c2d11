//! Triangles from files.
//!
//! | format | file |
//! |---|---|
//! | binary STL | [`stl`] |
//! | `v`/`f` text: OBJ geometry and plate models | [`plates`] |

pub mod plates;
pub mod stl;

use thiserror::Error as ThisError;

/// Vertices and the triangles that count them from zero.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// Coordinates as stored in the file.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of each triangle.
    pub faces: Vec<[usize; 3]>,
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
