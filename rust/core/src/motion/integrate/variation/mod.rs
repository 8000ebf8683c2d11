//! What small changes at the start, of the body or of the load have become at a time: the derivatives of a motion.
//!
//! Every number of the equations carries its derivatives by the variables with it, through the series of
//! [`taylor`](super::taylor). Eight variables are varied at a time, each eight in a run of its own.
//!
//! Source: Hairer, Nørsett & Wanner, Solving ODEs I, §I.14; where a law changes its torque with the state, Filippov's rule for
//! derivatives ("saltation"), di Bernardo et al., Piecewise-smooth Dynamical Systems, §2.5.

mod derivatives;
#[cfg(test)]
mod tests;

pub use derivatives::{Variation, variations};
