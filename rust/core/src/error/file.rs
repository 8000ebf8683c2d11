//! Why a file cannot be read.

use thiserror::Error as ThisError;

use super::kind::Kind;

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, ThisError)]
#[non_exhaustive]
pub enum FileFault {
    /// Shorter than its header promises, or than a header.
    #[error(
        "truncated binary STL: {held} bytes where its header of {triangles} triangles promises {promised}; \
         export it again"
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
         say so"
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

impl FileFault {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        Kind::File
    }
}
