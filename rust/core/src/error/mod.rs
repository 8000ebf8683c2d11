//! Every way an input can be unphysical, each with the number that offends, the law and the way out: plain data, which
//! knows nothing of what is built on it.
//!
//! | what is wrong | file |
//! |---|---|
//! | an argument of whatever kind | `any` |
//! | mass properties, particles, densities | `body` |
//! | faces and cells | `mesh` |
//! | the boundary of a lamina | `polygon` |
//! | what a file says | `file` |
//! | attitudes, loads, runs | `motion` |
//! | standard deviations, covariances | `uncertainty` |
//!
//! # Examples
//!
//! ```
//! use std::ops::ControlFlow;
//! use polhode::error::{
//!     BodyFault, CellFault, Corner, Count, FileFault, Kind, MeshFault, MotionFault, PolygonFault, UncertaintyFault,
//! };
//! use polhode::mass::tetrahedra::{CellDensity, tetrahedra};
//! use polhode::mass::{Amount, laminae, polyhedron::polyhedron};
//! use polhode::motion::euler_angles::Sequence;
//! use polhode::nalgebra::{Matrix3, Vector3};
//! use polhode::uncertainty::{LinearForms, Source};
//! use polhode::{Error, RigidBody};
//!
//! // What was refused is told as data: the numbers that break the triangle inequality,
//! let tensor = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0));
//! let error = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0).unwrap_err();
//! assert!(matches!(error, Error::Body(BodyFault::TriangleInequality { deficit: 1.0, .. })));
//!
//! // an edge at which a mesh is open, and how many there are,
//! let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let three = [[0_usize, 2, 1], [0, 1, 3], [0, 3, 2]];
//! let Err(Error::Mesh(MeshFault::Open { from, count, .. })) =
//!     polyhedron(&corners, &three, Amount::Mass(1.0), false)
//! else {
//!     unreachable!("three faces of four close nothing")
//! };
//! assert!(matches!(from, Corner::Vertex(1..=3)));
//! assert_eq!(count, Count { seen: 3, is_least: false });
//!
//! // cells without mass, and the edges of a polygon that cross.
//! let go_on = &mut |_| ControlFlow::Continue(());
//! let empty = tetrahedra(&corners, &[[0, 1, 2, 3]], CellDensity::PerCell(&[0.0]), go_on);
//! assert!(matches!(empty, Err(Error::Cells(CellFault::NoMass { count: 1, .. }))));
//! let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
//! let bow = laminae::polygon(&bow, Amount::Mass(1.0), go_on);
//! assert!(matches!(bow, Err(Error::Polygon(PolygonFault::Crossing { first: 0, second: 2 }))));
//!
//! // So are the faults of angles, of covariances and of files.
//! let unknown = "ZZX".parse::<Sequence>().unwrap_err();
//! assert!(matches!(unknown, Error::Motion(MotionFault::EulerSequence { .. })));
//! let negative = LinearForms::correlated(&[-1.0], Source::fresh()).unwrap_err();
//! assert!(matches!(negative, Error::Uncertainty(UncertaintyFault::NegativeVariance { index: 0, .. })));
//! assert_eq!(Error::from(FileFault::NoFaces { vertices: 8 }).kind(), Kind::File);
//! ```

mod any;
mod body;
mod checks;
mod file;
mod kind;
mod mesh;
mod motion;
mod polygon;
mod uncertainty;

pub use any::Error;
pub use body::BodyFault;
pub(crate) use checks::{all_finite, all_finite_of_body, check_rtol, finite, finite_of_body};
pub use file::FileFault;
pub use kind::Kind;
pub use mesh::{CellFault, Corner, Count, MeshFault};
pub use motion::MotionFault;
pub use polygon::PolygonFault;
pub use uncertainty::UncertaintyFault;
