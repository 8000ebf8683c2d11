//! The free motion of a gyrostat, exact at any time: a body with constant angular momentum h inside.
//!
//! `I ω̇ + ω × (I ω + h) = 0`, `q̇ = ½ q∘ω` (Zhukovskii 1885, Volterra 1899). With L along the third axis of a frame at rest the
//! spinor of the attitude is, but for its length, `e^{iνt} M (Θₑ(t), Θₒ(t))`: M a constant matrix, `Θₑ` and `Θₒ` the two theta
//! functions of order two on the curve that energy and |L| define. ω is a quotient of products of the same two. A state costs
//! the same at any t; two constants multiply t, known to twice the precision.
//!
//! | file | idea |
//! |---|---|
//! | `internal_momentum.rs` | momentum and wheels, and the tensor that is left |
//! | `mode.rs` | the ways to move |
//! | `motion.rs` | a motion from its start, its states |
//! | `periods.rs` | its periods |
//! | `start.rs` | the frame of L and ω at the start, the matrix of the motion there, and the quartic that the spinor of L obeys |
//! | `pencil.rs` | the real quartic of energy and momentum, the invariants of both; the discriminant next to a separatrix |
//! | `curve.rs` | roots, periods and nome; where the start is on the curve: an elliptic logarithm by means |
//! | `spinor.rs` | M and ν from the start |
//! | `constants.rs` | from these to what a state takes |
//! | `products.rs` | products of the theta functions, as series of their own, and ω from them |
//! | `theta_series.rs` | the theta functions at any argument |
//! | `propagator.rs` | the states, in lanes |
//! | [`equilibria`] | steady rotations with one angular momentum |
//!
//! # Examples
//!
//! ```
//! use polhode::RigidBody;
//! use polhode::motion::gyrostat::equilibria::{Bifurcation, Equilibria, Equilibrium, Extent, Kind, Meeting, equilibria};
//! use polhode::motion::gyrostat::{Gyrostat, GyrostatMotion, InternalMomentum};
//! use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
//!
//! // A satellite with a wheel of 0.1 kg m² that is held at 300 rad/s about its first axis.
//! let body = RigidBody::from_principal(90.0, &[8.0, 10.0, 12.0], &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
//! let inside = InternalMomentum::of(&Vector3::zeros())?.with(&Vector3::x(), 0.1, 30.0, false)?;
//! let omega = Vector3::new(0.05, -0.02, 0.1);
//! assert_eq!(inside.rotor(&omega).map(|h| h.rounded()), [30.0, 0.0, 0.0]);
//! let satellite = Gyrostat::of(&body, &inside)?;
//! let motion: GyrostatMotion = satellite.free_motion(&omega, &UnitQuaternion::identity())?;
//! assert!(motion.as_free().is_none()); // with momentum inside it is no free motion of a body
//! assert!((motion.angular_momentum_in_body() - Vector3::new(30.4, -0.2, 1.2)).norm() < 1e-13);
//! let (mut attitudes, mut omegas) = ([[0.0; 4]; 1], [[0.0; 3]; 1]);
//! motion.sample(&[motion.period.rounded()], &mut attitudes, &mut omegas);
//! assert!((Vector3::from(omegas[0]) - omega).amax() < 1e-12);
//!
//! // With that much momentum it rests about the wheel's axis alone, and about the opposite one.
//! let Equilibria { found, bifurcations } = satellite.equilibria(30.0, &omega)?;
//! assert_eq!(found.len(), 2);
//! let Equilibrium { kind, extent, direction, .. } = &found[0];
//! assert!((direction[0].abs() - 1.0).abs() < 1e-12);
//! assert!(matches!((kind, extent), (Kind::Minimum | Kind::Maximum, Extent::Point)));
//! // The others come in, as the wheel is slowed, where a pair parts from these.
//! let Bifurcation { meeting, rotor, .. } = &bifurcations[0];
//! assert!(*meeting == Meeting::Pitchfork && *rotor < 30.0);
//! // The same from principal moments and h.
//! let again = equilibria(&[8.0, 10.0, 12.0].map(Into::into), &[30.0, 0.0, 0.0].map(Into::into), 30.0.into());
//! assert_eq!(again.found.len(), 2);
//! # Ok::<(), polhode::Error>(())
//! ```

mod constants;
mod curve;
pub mod equilibria;
mod internal_momentum;
pub mod mode;
mod motion;
mod pencil;
mod periods;
mod products;
mod propagator;
mod spinor;
mod start;
#[cfg(test)]
mod tests;
mod theta_series;

pub use internal_momentum::{Gyrostat, InternalMomentum};
pub use mode::Mode;
pub use motion::GyrostatMotion;
