//! Mass distributions and what they add up to: mass, centre of mass, inertia tensor.
//!
//! | theorem or source | file |
//! |---|---|
//! | rigid body (m, C, `I_C`): validity, sums, change of frame | [`body`] |
//! | what makes a tensor possible: symmetry, positivity, triangle inequality | [`validity`] |
//! | second moment ∫ r rᵀ dm, from which every tensor comes | [`second_moment`] |
//! | parallel-axis (Steiner, Huygens) theorem | [`parallel_axis`] |
//! | particles | [`particles`] |
//! | homogeneous solids | [`solids`] |
//! | closed triangle mesh | [`polyhedron`] |
//! | equimomental systems: few particles with the moments of a body | [`equimomental`] |

pub mod body;
pub mod equimomental;
pub mod parallel_axis;
pub mod particles;
pub mod polyhedron;
pub mod second_moment;
pub mod solids;
pub mod validity;

pub use body::RigidBody;
pub use second_moment::SecondMoment;
pub use solids::Amount;
