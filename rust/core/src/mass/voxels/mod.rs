//! Bodies of voxels: a density for each cell of a rectangular grid, each cell a homogeneous box.
//!
//! | file | what it knows |
//! |---|---|
//! | `grid` | the body of all cells |
//! | `slab` | the sums over the cells of equal x |
//!
//! # Examples
//!
//! ```
//! use std::ops::ControlFlow;
//! use polhode::RigidBody;
//! use polhode::mass::voxels::{Grid, Voxel, voxels};
//!
//! /// A cube of 1 m, of cells with these densities.
//! fn cube<T: Voxel>(density: &[T]) -> Result<RigidBody, polhode::Error> {
//!     let grid = Grid { density, shape: [2; 3], spacing: [0.5; 3], origin: [0.25; 3] };
//!     voxels(&grid, &mut |_| ControlFlow::Continue(()))
//! }
//! let body = cube(&[1000.0_f32; 8])?; // as a scanner stores them
//! assert_eq!(body.mass(), 1000.0);
//! assert!((body.inertia()[(0, 0)] - 1000.0 / 6.0).abs() < 1e-12); // m a²/6: cells are no points
//! assert_eq!(cube(&[1000.0; 8])?.center_of_mass(), body.center_of_mass());
//! # Ok::<(), polhode::Error>(())
//! ```

mod grid;
mod slab;

pub use grid::{Grid, voxels};
pub use slab::Voxel;
