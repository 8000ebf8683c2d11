//! Bodies made of particles: `I = Σ m (r² 1 − r rᵀ)` (mln25).
//!
//! | file | idea |
//! |---|---|
//! | `single.rs` | the particles of a body, and what they must be; its second moment about the centre of mass; particles too small, too far apart, too light or too heavy to be squared |
//! | `stack.rs` | many bodies at a time; frames of a trajectory; particles with labels of their bodies |
//! | `sums.rs` | the sums, eight particles side by side |
//!
//! One pass over an ordinary body, about a point that a few of its particles are asked for; a thin one is summed again in
//! its own axes. The same bits for any number of threads, and for a body alone or in any stack.

mod single;
mod stack;
pub(crate) mod sums;

pub(super) use single::{ORDINARY, check, sample_center};
pub use single::{Particles, particles, particles_watched};
pub use stack::{label_ranks, labelled_particles, particle_stack};

pub use crate::numerics::threads::Watch;
