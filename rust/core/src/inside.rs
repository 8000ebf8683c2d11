//! No part of the interface: what this crate's own tests and benchmarks try of its numerics.
//!
//! They set the level and the limit of threads for the whole process, so that they cannot stand among the unit tests.

pub use crate::numerics::dispatch::{Kernel, dispatch};
pub use crate::numerics::eigen3::{eigen3, eigen3_many, eigenvalues3_many};
pub use crate::numerics::elliptic::carlson_rf;
pub use crate::numerics::lane::{Double, Lane};
