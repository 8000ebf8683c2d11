//! Bodies of voxels: a density for each cell of a rectangular grid, each cell a homogeneous box.
//!
//! | file | what it knows |
//! |---|---|
//! | `grid` | the body of all cells |
//! | `slab` | the sums over the cells of equal x |

mod grid;
mod slab;

pub use grid::{Grid, voxels};
pub use slab::Voxel;
