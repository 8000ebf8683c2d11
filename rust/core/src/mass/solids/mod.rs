//! Homogeneous solids: centre of mass at the origin, symmetry axis z, narrow end, apex or dome toward +z.
//!
//! Each is its second moment in closed form, written without differences of nearly equal numbers, so that the degenerate
//! limits are exact: a hollow solid without thickness is a shell, a thin one a rod, a flat one a disk.
//!
//! | solids | file |
//! |---|---|
//! | box, cube, wedge, prism, pyramid, tetrahedron | `flat_faced.rs` |
//! | ball, hollow ball, ellipsoid, half ball | `round.rs` |
//! | cylinder, tube, cone, frustum, capsule, torus | `turned.rs` |

mod flat_faced;
mod round;
mod turned;

pub use super::amount::Amount;
pub use flat_faced::{cube, cuboid, prism, pyramid, tetrahedron, wedge};
pub use round::{ellipsoid, hemisphere, hollow_sphere, sphere};
pub use turned::{capsule, cone, cylinder, frustum, torus, tube};
