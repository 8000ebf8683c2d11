//! Why triangles do not bound a solid, and why cells fill none.

use std::fmt;

use thiserror::Error as ThisError;

use super::kind::Kind;

/// A corner of a triangle, by its number or, where a file does not number its corners, by its coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corner {
    /// Number in the list of vertices.
    Vertex(usize),
    /// Coordinates.
    At([f64; 3]),
}

impl fmt::Display for Corner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(number) => write!(f, "vertex {number}"),
            Self::At([x, y, z]) => write!(f, "({x:?}, {y:?}, {z:?})"),
        }
    }
}

/// How many edges or faces share a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// So many were seen.
    pub seen: usize,
    /// Whether there may be more, which were not looked at.
    pub is_least: bool,
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_least { "at least " } else { "" })?;
        write!(f, "{}", self.seen)
    }
}

/// Why a mesh does not bound a solid.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum MeshFault {
    /// No faces.
    #[error("the mesh has no faces")]
    NoFaces,
    /// A face names a vertex that does not exist.
    #[error(
        "faces[{face}] names vertex {index}, but there are {vertices} vertices, numbered from 0; \
         if the faces count from 1 subtract 1"
    )]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index it holds.
        index: i64,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertices[{vertex}] is not finite: {value:?}; give finite coordinates")]
    NonFiniteVertex {
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// A coordinate of a triangle is NaN or infinite.
    #[error("faces[{face}] has a corner that is not finite: {corner}; give finite coordinates")]
    NonFiniteCorner {
        /// The triangle.
        face: usize,
        /// The corner.
        corner: Corner,
    },
    /// Two faces are the same triangle, seen from the same side.
    #[error(
        "faces[{first}] and faces[{second}] are the same triangle, seen from the same side ({count} such pairs in all): \
         their matter would count twice; remove one of them"
    )]
    DuplicateFaces {
        /// One face.
        first: usize,
        /// The other face.
        second: usize,
        /// How many faces repeat an earlier one.
        count: Count,
    },
    /// An edge with a face on one side only: a solid needs the mesh closed, a thin shell does not.
    #[error(
        "the mesh is not closed: the edge from {from} to {to} of faces[{face}] has no face on its other side \
         ({count} such edges in all)"
    )]
    Open {
        /// Start of the edge.
        from: Corner,
        /// End of the edge.
        to: Corner,
        /// The face that has it.
        face: usize,
        /// How many open edges.
        count: Count,
    },
    /// Two faces run along an edge in the same direction.
    #[error(
        "the mesh is not consistently wound: faces[{first}] and faces[{second}] both run from {from} to {to} \
         ({count} such edges in all); reverse the order of the vertices of one of them"
    )]
    InconsistentWinding {
        /// Start of the edge.
        from: Corner,
        /// End of the edge.
        to: Corner,
        /// One face.
        first: usize,
        /// The other face.
        second: usize,
        /// How many edges are run along in one direction only.
        count: Count,
    },
    /// The normals point inward.
    #[error(
        "the mesh is inverted: its signed volume is {volume:?}, so the normals point inward; \
         reverse the order of the vertices of every face"
    )]
    Inverted {
        /// The signed volume.
        volume: f64,
    },
    /// A component wound like a cavity, but in nothing.
    #[error(
        "a component of the mesh is inside out: the {faces} connected faces with faces[{face}] are wound the other way \
         than the rest, signed volume {volume:?}, and are no cavity, as no other component has them inside; \
         reverse the order of their vertices"
    )]
    InsideOut {
        /// Its first face.
        face: usize,
        /// How many faces it has.
        faces: usize,
        /// Its signed volume.
        volume: f64,
    },
    /// The mesh encloses nothing.
    #[error(
        "the mesh encloses no volume: {volume:?} with edges up to {size:?}; model a sheet as a thin shell instead"
    )]
    NoVolume {
        /// The signed volume.
        volume: f64,
        /// The largest extent.
        size: f64,
    },
    /// A shell that folds over itself.
    #[error(
        "thickness {thickness:?} folds the shell over itself at faces[{face}], where at most {limit:?} is possible: the \
         surface bends too sharply there for triangles of that size; make the shell thinner or the triangles larger"
    )]
    TooThick {
        /// The face that turns over first.
        face: usize,
        /// What was asked for.
        thickness: f64,
        /// The thickness at which it turns over.
        limit: f64,
    },
    /// A face without a normal, where one is needed.
    #[error(
        "faces[{face}] has no normal: its corners lie on a line; remove the face for a shell of finite thickness"
    )]
    NoNormal {
        /// The face.
        face: usize,
    },
    /// An edge at which a surface branches.
    #[error(
        "{faces} faces meet in the edge from {from} to {to}: a shell of finite thickness needs one or two at each edge; \
         make a body of each sheet and add them"
    )]
    Branching {
        /// One end of the edge.
        from: Corner,
        /// The other end.
        to: Corner,
        /// How many faces.
        faces: usize,
    },
    /// Triangles without area.
    #[error(
        "the surface has no area: {area:?} from {faces} faces; model a line as a thin wire instead"
    )]
    NoArea {
        /// The area.
        area: f64,
        /// How many faces.
        faces: usize,
    },
}

/// Why nodes and cells make no body.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum CellFault {
    /// No cells.
    #[error("cells must not be empty: there is nothing to sum over")]
    NoCells,
    /// A cell names a node that does not exist.
    #[error(
        "cells[{cell}] names node {index}, but there are {nodes} nodes, numbered from 0; \
         if the cells count from 1 subtract 1"
    )]
    IndexOutOfRange {
        /// The cell.
        cell: usize,
        /// The index it holds.
        index: i64,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("nodes[{node}] is not finite: {value:?}; give finite coordinates")]
    NonFiniteNode {
        /// The node.
        node: usize,
        /// The coordinate.
        value: f64,
    },
    /// A density is below zero.
    #[error("density must not be negative: density[{index}] is {value:?}")]
    NegativeDensity {
        /// Of which cell or node.
        index: usize,
        /// The number.
        value: f64,
    },
    /// Every cell is flat or without density.
    #[error(
        "the {count} cells have no mass: {mass:?}; check that they are not flat and their density not zero"
    )]
    NoMass {
        /// How many cells.
        count: usize,
        /// The sum of their masses.
        mass: f64,
    },
}

impl MeshFault {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        Kind::Mesh
    }
}

impl CellFault {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        Kind::Mesh
    }
}
