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
