//! The methods of the class `RigidBody`.
//!
//! | file | what it knows |
//! |---|---|
//! | `construct` | the ways to a body: from numbers, particles, meshes, curves, voxels, tetrahedra, densities |
//! | `properties` | mass, centre, tensor; sums and changes of frame; a stack as a container; energy and momentum |
//! | `uncertainty` | standard deviations in and out |
//! | `provenance` | where the numbers come from, and how good they are |
//! | `figures` | what a body looks like |
//! | `interop` | what Python does for a body: files, other libraries' objects, pictures |
//! | `motion` | motions in closed form |
//! | `simulate`, `outcome`, `ensemble` | motions under loads |

mod construct;
mod ensemble;
mod figures;
mod interop;
mod motion;
mod outcome;
mod properties;
mod provenance;
mod simulate;
mod uncertainty;
