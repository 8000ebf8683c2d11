//! Why corners do not bound a polygon.

use thiserror::Error as ThisError;

use super::kind::Kind;

/// Why corners do not bound a polygon.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum PolygonFault {
    /// Fewer than three corners.
    #[error("vertices must be three corners or more, got {count}")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// Two edges cross.
    #[error(
        "vertices must bound a simple polygon: the edge from vertex {first} crosses the edge from vertex {second}; \
         order the corners along the boundary, and cut a hole out by subtracting a polygon"
    )]
    Crossing {
        /// Where one edge starts.
        first: usize,
        /// Where the other edge starts.
        second: usize,
    },
    /// The boundary passes through itself where a corner lies on it, or goes round twice.
    #[error(
        "vertices must bound a simple polygon: where the boundary touches itself it also passes through itself, so that a part \
         of the area counts as negative or twice; order the corners along the boundary, and cut a hole out by subtracting a \
         polygon"
    )]
    Overlapping,
    /// Nothing inside.
    #[error(
        "vertices enclose no area: {area:?} with an extent of {size:?}; model a line as a thin rod instead"
    )]
    NoArea {
        /// The signed area.
        area: f64,
        /// The largest extent.
        size: f64,
    },
}

impl PolygonFault {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        Kind::Argument
    }
}
