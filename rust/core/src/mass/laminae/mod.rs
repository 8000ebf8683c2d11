//! Homogeneous laminae: sheets without thickness in the x-y plane.
//!
//! Those known by lengths have their centre of mass at the origin; triangles and polygons stay where their corners are.
//!
//! | what | file |
//! |---|---|
//! | disk, annulus, ellipse, rectangle | `by_lengths` |
//! | triangles and polygons, whether a boundary passes through itself | `polygon` |

mod by_lengths;
mod polygon;

pub use by_lengths::{annulus, disk, ellipse, rectangle};
pub use polygon::{polygon, triangle};
