//! Bodies made of particles: `I = Σ m (r² 1 − r rᵀ)` (mln25).
//!
//! | file | idea |
//! |---|---|
//! | `alone.rs` | the body of one set of particles |
//! | `list.rs` | the particles of a body, and what they must be |
//! | `about_center.rs` | their second moment about the centre of mass |
//! | `sums.rs` | the sums, eight particles side by side |
//! | `stack.rs` | many bodies at a time; frames of a trajectory |
//! | `extreme.rs` | particles too small, too far apart, too light or too heavy to be squared |
//! | `labelled.rs` | particles that say which body they belong to |
//!
//! One pass over an ordinary body, about a point that a few of its particles are asked for; a thin one is summed again in
//! its own axes. The same bits for any number of threads, and for a body alone or in any stack.

mod about_center;
mod alone;
mod extreme;
mod labelled;
mod list;
mod stack;
pub(crate) mod sums;

pub(super) use about_center::{ORDINARY, is_thin};
pub use alone::{particles, particles_watched};
pub use labelled::labelled_particles;
pub use list::Particles;
pub(super) use list::{check, sample_center};
pub use stack::particle_stack;

pub use crate::numerics::threads::Watch;
