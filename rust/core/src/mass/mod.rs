//! Mass distributions and what they add up to: mass, centre of mass, inertia tensor.
//!
//! | theorem or source | file |
//! |---|---|
//! | rigid body (m, C, `I_C`): tensors about any point | [`body`] |
//! | bodies from bodies: sums, change of frame, scaling | [`composition`] |
//! | what makes a tensor possible: symmetry, positivity, triangle inequality | [`validity`] |
//! | what rounding can have done | [`error_bound`] |
//! | second moment ∫ r rᵀ dm, from which every tensor comes | [`second_moment`] |
//! | parallel-axis (Steiner, Huygens) theorem | [`parallel_axis`] |
//! | particles, stacks of them, particles with labels | [`particles`] |
//! | particles in chunks, more than fit into memory | [`accumulator`] |
//! | voxels | [`voxels`] |
//! | homogeneous solids | [`solids`] |
//! | closed triangle mesh | [`polyhedron`] |
//! | equimomental systems: few particles with the moments of a body | [`equimomental`] |

pub mod accumulator;
pub mod body;
pub mod composition;
pub mod equimomental;
pub mod error_bound;
pub mod parallel_axis;
pub mod particles;
pub mod polyhedron;
pub mod second_moment;
pub mod solids;
pub mod validity;
pub mod voxels;

pub use accumulator::MassAccumulator;
pub use body::RigidBody;
pub use error_bound::ErrorBound;
pub use second_moment::SecondMoment;
pub use solids::Amount;
