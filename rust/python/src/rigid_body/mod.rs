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
//! | `instant` | a moving body at one instant: its points, what holds it, whether it spins steadily |
//! | `simulate`, `simulate_stack`, `outcome` | motions under loads |
//! | `stepper` | a motion step by step |
//! | `varying` | a body that changes with time |
//!
//! Motions in closed form are classes of their own: `crate::free_motion`, `crate::heavy_top`, `crate::gyrostat`.

mod construct;
mod figures;
mod instant;
mod interop;
mod outcome;
mod properties;
mod provenance;
mod simulate;
mod simulate_stack;
mod stepper;
mod uncertainty;
mod varying;

pub(crate) use stepper::PyStepper;
pub(crate) use varying::PyVaryingBody;
