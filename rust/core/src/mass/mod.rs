//! Mass distributions and what they add up to: mass, centre of mass, inertia tensor.
//!
//! | theorem or source | file |
//! |---|---|
//! | rigid body (m, C, `I_C`): tensors about any point | [`body`] |
//! | bodies from bodies: change of frame, scaling | [`composition`] |
//! | composites: sums, cavities | [`composites`] |
//! | what makes a tensor possible: symmetry, positivity, triangle inequality | [`validity`] |
//! | what rounding can have done | [`error_bound`] |
//! | mass or density, and what homogeneous shapes share | [`amount`] |
//! | the nearest possible tensor; whether a body of a given size can have it | [`realizable`] |
//! | other people's forms, to and from | [`forms`] |
//! | where the numbers come from | [`provenance`] |
//! | second moment ∫ r rᵀ dm, from which every tensor comes | [`second_moment`] |
//! | principal moments and axes to twice the precision | [`refined`] |
//! | parallel-axis (Steiner, Huygens) theorem | [`parallel_axis`] |
//! | particles, stacks of them, particles with labels | [`particles`] |
//! | particles in chunks, more than fit into memory | [`accumulator`] |
//! | voxels | [`voxels`] |
//! | homogeneous solids | [`solids`] |
//! | homogeneous laminae, in the x-y plane | [`laminae`] |
//! | homogeneous thin rods | [`rods`] |
//! | tetrahedra, their density linear between nodes | [`tetrahedra`] |
//! | regions of space | [`regions`] |
//! | density ρ(r) over a region, and ρ of the radius alone | [`density`] |
//! | closed triangle mesh: divergence theorem | [`polyhedron`] |
//! | simplices: what segments, triangles and tetrahedra add up to | `simplex` |
//! | the ten numbers of a body, in numbers of any kind | [`ten`] |
//! | thin shells | [`surface`] |
//! | shells of finite thickness | [`thick_shell`] |
//! | thin wires | [`curve`] |
//! | powers of two as units, so that nothing under- or overflows on the way | `units` |
//! | equimomental systems: few particles with the moments of a body | [`equimomental`] |

pub mod accumulator;
pub mod amount;
pub mod body;
pub mod composites;
pub mod composition;
pub mod curve;
pub mod density;
pub mod equimomental;
pub mod error_bound;
pub mod forms;
pub mod laminae;
pub mod parallel_axis;
pub mod particles;
pub mod polyhedron;
pub mod provenance;
pub mod realizable;
pub mod refined;
pub mod regions;
pub mod rods;
pub mod second_moment;
mod simplex;
pub mod solids;
pub mod surface;
pub mod ten;
pub mod tetrahedra;
pub mod thick_shell;
mod units;
pub mod validity;
pub mod voxels;

pub use accumulator::MassAccumulator;
pub use amount::Amount;
pub use body::RigidBody;
pub use error_bound::ErrorBound;
pub use polyhedron::Index;
pub use provenance::Provenance;
pub use second_moment::SecondMoment;
