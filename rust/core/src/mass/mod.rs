//! Mass distributions and what they add up to: mass, centre of mass, inertia tensor.
//!
//! | theorem or source | file |
//! |---|---|
//! | rigid body (m, C, `I_C`): tensors about any point | [`body`] |
//! | bodies from bodies: change of frame, scaling | [`transforms`] |
//! | composites: sums, cavities | [`assemblies`] |
//! | what makes a tensor possible: symmetry, positivity, triangle inequality | [`validity`] |
//! | what rounding can have done | [`error_bound`] |
//! | mass or density, and what homogeneous shapes share | [`amount`] |
//! | the nearest possible tensor; whether a body of a given size can have it | [`realizable`] |
//! | other people's forms, to and from | [`forms`] |
//! | where the numbers come from | [`provenance`] |
//! | second moment ∫ r rᵀ dm, from which every tensor comes | [`second_moment`] |
//! | principal moments and axes to twice the precision | [`refined`] |
//! | matter summed once, and again in its own axes where it is thin | `integrator` |
//! | parallel-axis (Steiner, Huygens) theorem | [`parallel_axis`] |
//! | particles, stacks of them, particles with labels | [`particles`] |
//! | particles in chunks, more than fit into memory | [`accumulator`] |
//! | voxels | [`voxels`] |
//! | voxels with labels, all bodies of an image in one pass | [`labelled_voxels`] |
//! | unions of overlapping balls | [`balls`] |
//! | homogeneous solids | [`solids`] |
//! | homogeneous laminae, in the x-y plane | [`laminae`] |
//! | homogeneous thin rods | [`rods`] |
//! | tetrahedra, their density linear between nodes | [`tetrahedra`] |
//! | regions of space | [`regions`] |
//! | density ρ(r) over a region, and ρ of the radius alone | [`density`] |
//! | closed triangle mesh: divergence theorem | [`polyhedron`] |
//! | simplices: what segments, triangles and tetrahedra add up to | `simplex` |
//! | the ten numbers of a body, in numbers of any kind | [`inertial_parameters`] |
//! | thin shells | [`surface`] |
//! | shells of finite thickness | [`thick_shell`] |
//! | thin wires | [`curve`] |
//! | powers of two as units, so that nothing under- or overflows on the way | `scaling` |
//! | equimomental systems: few particles with the moments of a body | [`equimomental`] |
//!
//! # Examples
//!
//! A body in the forms of other libraries, and back:
//!
//! ```
//! use polhode::RigidBody;
//! use polhode::mass::forms::SpatialOrder;
//! use polhode::mass::{Amount, solids};
//! use polhode::nalgebra::Vector3;
//!
//! let brick = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(12.0))?;
//! let brick = brick.translated(&Vector3::new(1.0, 0.0, 0.0))?;
//! let order = SpatialOrder::AngularLinear; // or LinearAngular
//! assert_eq!(brick.spatial_inertia(order)[(3, 3)], 12.0); // the mass stands where forces meet accelerations
//! assert!((brick.pseudo_inertia()[(0, 0)] - 13.0).abs() < 1e-13); // ∫ x² dm = m (a²/12 + C²)
//! let (moments, products) = brick.positive_products(); // products with plus where the tensor has minus
//! for again in [
//!     RigidBody::from_parameters(&brick.parameters(), 0.0)?, // m, m C, the tensor about O
//!     RigidBody::from_pseudo_inertia(&brick.pseudo_inertia(), 0.0)?,
//!     RigidBody::from_spatial_inertia(&brick.spatial_inertia(order), order, 0.0)?,
//!     RigidBody::from_log_cholesky(&brick.log_cholesky()?)?, // any ten numbers are a body
//!     RigidBody::from_positive_products(12.0, &moments, &products, &brick.center_of_mass(), 0.0)?,
//! ] {
//!     assert!(again.is_close(&brick, 1e-13, 1e-13));
//! }
//! # Ok::<(), polhode::Error>(())
//! ```
//!
//! What a body knows of itself:
//!
//! ```
//! use polhode::mass::provenance::{Checks, MomentsFrom, Provenance, BodySource};
//! use polhode::mass::{Amount, solids};
//!
//! let ball = solids::sphere(1.0, Amount::Density(3.0))?;
//! assert!((ball.mass() - 4.0 * std::f64::consts::PI).abs() <= ball.error_bound().mass);
//! let provenance = ball.provenance();
//! assert_eq!((provenance.source, provenance.moments), (BodySource::Solid, MomentsFrom::SecondMoment));
//! assert!(!provenance.checks.contains(Checks::UNCHECKED.and(Checks::CLOSED)));
//! // The same numbers, summed elsewhere from the atoms of a cluster.
//! let summed = ball.with_provenance(Provenance::of_particles(60));
//! assert_eq!((summed.provenance().source, summed.provenance().elements), (BodySource::Particles, 60));
//! # Ok::<(), polhode::Error>(())
//! ```

pub mod accumulator;
pub mod amount;
pub mod assemblies;
pub mod balls;
pub mod body;
pub mod curve;
pub mod density;
pub mod equimomental;
pub mod error_bound;
pub mod forms;
pub mod inertial_parameters;
mod integrator;
pub mod labelled_voxels;
pub mod laminae;
pub mod parallel_axis;
pub mod particles;
pub mod polyhedron;
pub mod provenance;
pub mod realizable;
pub mod refined;
pub mod regions;
pub mod rods;
mod scaling;
pub mod second_moment;
mod simplex;
pub mod solids;
pub mod surface;
pub mod tetrahedra;
pub mod thick_shell;
pub mod transforms;
pub mod validity;
pub mod voxels;

pub use accumulator::MassAccumulator;
pub use amount::Amount;
pub use body::RigidBody;
pub use error_bound::ErrorBound;
pub use polyhedron::Index;
pub use provenance::Provenance;
pub use second_moment::SecondMoment;
