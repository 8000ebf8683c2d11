//! The heavy symmetric top about a fixed point on its axis: its motion at any time, in closed form (part II).
//!
//! | file | what it holds |
//! |---|---|
//! | `top` | a motion, from its state to its states |
//! | [`pivoted_top`] | which bodies are such tops; steady precession and the sleeping limit |
//! | `reduced` | the state in its own units and axes |
//! | `top_data` | the data of a top, sizes in a unit of their own; numbers of any precision and powers of two |
//! | `turning_points` | the cubic of `cos θ` and the distances between what is singular |
//! | `phases` | the steady rates of the phases and the shifts of the theta functions |
//! | `propagator` | all of these as numbers ready for vector lanes; the motion at one time or many |
//! | [`nutation`] | limits, period, mean rates and the kind of path |
//!
//! # Examples
//!
//! ```
//! use polhode::RigidBody;
//! use polhode::motion::heavy_top::nutation::{Nutation, Mode};
//! use polhode::motion::heavy_top::{HeavyTop, PivotedTop};
//! use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
//!
//! // A top of 0.5 kg that is let go at 30° with 150 rad/s about its axis: it falls, and rises again to rest.
//! let moments = [2e-4, 2e-4, 3e-4];
//! let body = RigidBody::from_principal(0.5, &moments, &Matrix3::identity(), &Vector3::new(0.0, 0.0, 0.03), 0.0)?;
//! let top = PivotedTop::of(&body, 1e-9)?;
//! let lean = 30.0_f64.to_radians();
//! let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), lean);
//! let (spin, gravity) = (Vector3::new(0.0, 0.0, 150.0), Vector3::new(0.0, 0.0, -9.81));
//! let motion = HeavyTop::of(&top, &spin, &attitude, &gravity)?;
//! let Nutation { mode, inclination, period, .. } = motion.nutation();
//! assert_eq!(*mode, Mode::Cusp);
//! assert!((inclination[0] - lean).abs() < 1e-12);
//! let (mut attitudes, mut omegas) = ([[0.0; 4]; 1], [[0.0; 3]; 1]);
//! motion.sample(&[*period], &mut attitudes, &mut omegas);
//! assert!((omegas[0][2] - 150.0).abs() < 1e-10 && omegas[0][0].hypot(omegas[0][1]) < 1e-9);
//!
//! // At both ends of its nodding the effective potential is the same.
//! let potential = |angle| top.effective_potential(&spin, &attitude, &gravity, angle);
//! assert!((potential(inclination[0]) - potential(inclination[1])).abs() < 1e-12);
//! // Steadily it precesses at m g l/(I_s ω_s), nearly, or fast.
//! let [slow, fast] = top.steady_precession(150.0, lean, &gravity)?;
//! assert!((slow / (0.5 * 9.81 * 0.03 / (3e-4 * 150.0)) - 1.0).abs() < 0.1 && fast > 10.0 * slow);
//! # Ok::<(), polhode::Error>(())
//! ```

pub mod nutation;
mod phases;
pub mod pivoted_top;
mod propagator;
mod reduced;
#[cfg(test)]
mod tests;
mod top;
mod top_data;
mod turning_points;

pub use nutation::{Mode, Nutation};
pub use pivoted_top::PivotedTop;
pub use top::HeavyTop;
