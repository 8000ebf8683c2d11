//! Homogeneous solids.

mod flat_faced;
mod round;
mod turned;

pub(crate) use flat_faced::{cube, cuboid, prism, pyramid, tetrahedron, wedge};
pub(crate) use round::{ellipsoid, hemisphere, hollow_sphere, sphere};
pub(crate) use turned::{capsule, cone, cylinder, frustum, torus, tube};
