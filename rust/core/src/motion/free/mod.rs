//! Free motion, exact at any time: Euler's problem by theta functions.
//!
//! With L along the third axis of the frame M at rest, and in the body the axes P = (x, y, z), z the principal axis that L
//! circles, the attitude is `q_MP = (Im β, −Re β, Im α, Re α)`, where the Cayley–Klein parameters
//! `α = √(½(1 + L_z/L)) e^{i(μ−χ)/2}` and `β = √(½(1 − L_z/L)) e^{i(μ+χ)/2}` (μ the angle of precession, χ that of L about
//! z, seen from P) are each one theta function of u = λt + u₀ times a steadily turning phase. A state costs the same at any
//! t. Only two constants multiply t, the rate of that phase and 1/4K of the period; they are known to twice the
//! precision, and whole turns are taken off exactly.
//!
//! | file | idea |
//! |---|---|
//! | `mode.rs` | the six ways to move |
//! | `motion.rs`, `secular.rs` | a motion from its start, its states, and what grows with time |
//! | `separation.rs` | the difference `L² − 2T I₂`, on which all depends near the separatrix |
//! | `tumbling.rs` | long- and short-axis mode and the separatrix: from a start to the constants of the theta functions |
//! | `circling.rs` | steady spin and the symmetric body: the limits in which they are sines |
//! | `propagator.rs` | from the constants to the states, in lanes |
//! | `evaluate.rs` | states of any motion in closed form, at one time and at many |
//! | `invariants.rs` | what a motion keeps: energy, momentum, modulus, amplitudes |
//! | `periods.rs`, `from_periods.rs` | periods and mean precession; the motion that has two given periods |
//! | `polhode.rs`, `nutation.rs`, `poinsot.rs` | the curve of ω in the body, cones, the rolling ellipsoid |
//! | `sensitivity` on `clock.rs`, `conditioning.rs` | derivatives by initial state and moments; error bars |

mod circling;
mod clock;
mod conditioning;
pub(super) mod evaluate;
mod from_periods;
mod invariants;
pub mod mode;
mod motion;
mod nutation;
mod periods;
mod poinsot;
mod polhode;
mod propagator;
mod secular;
mod sensitivity;
mod separation;
#[cfg(test)]
mod tests;
mod tumbling;

pub use conditioning::ErrorBar;
pub use from_periods::{Circled, FromPeriods, attitude_about};
pub use invariants::Invariants;
pub use mode::Mode;
pub use motion::FreeMotion;
pub use nutation::Cones;
pub use periods::Periods;
pub use poinsot::Poinsot;
pub use secular::Secular;
pub use sensitivity::Sensitivity;
