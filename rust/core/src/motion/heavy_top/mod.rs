//! The heavy symmetric top about a fixed point on its axis: its motion at any time, in closed form (part II).
//!
//! | file | what it holds |
//! |---|---|
//! | `top` | a motion, from its state to its states |
//! | [`pivoted_top`] | which bodies are such tops; steady precession and the sleeping limit |
//! | `reduced` | the state in its own units and axes |
//! | `source`, `scaled` | the data of a top, sizes in a unit of their own; numbers of any precision and powers of two |
//! | `turning_points` | the cubic of `cos θ` and the distances between what is singular |
//! | `phases` | the steady rates of the phases and the shifts of the theta functions |
//! | `course` | all of these as numbers ready for vector lanes |
//! | `sampling` | the motion at one time or many |
//! | [`nutation`] | limits, period, mean rates and the kind of path |

mod course;
pub mod nutation;
mod phases;
pub mod pivoted_top;
mod reduced;
mod sampling;
mod scaled;
mod source;
#[cfg(test)]
mod tests;
mod top;
mod turning_points;

pub use nutation::{Nutation, Path};
pub use pivoted_top::PivotedTop;
pub use top::HeavyTop;
