//! The free motion of a gyrostat, exact at any time: a body with constant angular momentum h inside.
//!
//! `I ω̇ + ω × (I ω + h) = 0`, `q̇ = ½ q∘ω` (Zhukovskii 1885, Volterra 1899). With L along the third axis of a frame at rest the
//! spinor of the attitude is, but for its length, `e^{iνt} M (Θₑ(t), Θₒ(t))`: M a constant matrix, `Θₑ` and `Θₒ` the two theta
//! functions of order two on the curve that energy and |L| define. ω is a quotient of products of the same two. A state costs
//! the same at any t; two constants multiply t, known to twice the precision.
//!
//! | file | idea |
//! |---|---|
//! | `inside.rs` | momentum and wheels, and the tensor that is left |
//! | `mode.rs` | the ways to move |
//! | `motion.rs` | a motion from its start, its states |
//! | `start.rs` | the frame of L and ω at the start, and the matrix of the motion there |
//! | `quartic.rs` | the quartic that the spinor of L obeys, its invariants |
//! | `curve.rs` | roots, periods and nome |
//! | `logarithm.rs` | where the start is on the curve: an elliptic logarithm by means |
//! | `spinor.rs` | M and ν from the start |
//! | `constants.rs` | from these to what a state takes |
//! | `propagator.rs` | the states, in lanes |
//! | `slender.rs` | the rate about a long axis, from the energy |
//! | [`equilibria`] | steady rotations with one angular momentum |

mod constants;
mod curve;
pub mod equilibria;
mod inside;
mod logarithm;
pub mod mode;
mod motion;
mod propagator;
mod quartic;
mod slender;
mod spinor;
mod start;
#[cfg(test)]
mod tests;

pub use inside::{Gyrostat, Inside};
pub use mode::Mode;
pub use motion::GyrostatMotion;
