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
//! | `motion.rs` | a motion from its start, and its states |
//! | `separation.rs` | the difference `L² − 2T I₂`, on which all depends near the separatrix |
//! | `tumbling.rs` | long- and short-axis mode and the separatrix: from a start to the constants of the theta functions |
//! | `steady_or_symmetric.rs` | steady spin and the symmetric body: the limits in which they are sines |
//! | `propagator.rs` | from the constants to the states, in lanes; what grows with time |
//! | `invariants.rs` | what a motion keeps: energy, momentum, modulus, amplitudes |
//! | `periods.rs`, `from_periods.rs` | periods and mean precession; the motion that has two given periods |
//! | `polhode.rs` | the curve of ω in the body, cones, the rolling ellipsoid |
//! | `sensitivity.rs` | derivatives by initial state and moments; error bars |
//!
//! # Examples
//!
//! ```
//! use std::f64::consts::{FRAC_PI_2, TAU};
//! use polhode::RigidBody;
//! use polhode::mass::refined::RefinedPrincipal;
//! use polhode::motion::free::{Cones, ErrorBar, FreeMotion, Invariants, Mode, Periods, Poinsot, Secular, Sensitivity};
//! use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
//!
//! let moments = [1.0, 2.0, 2.5];
//! let body = RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
//! let (omega, attitude) = (Vector3::new(0.2, 0.1, 1.0), UnitQuaternion::identity());
//! let motion = FreeMotion::from_refined(&RefinedPrincipal::of(&body), &omega, &attitude)?;
//! assert_eq!(motion, FreeMotion::of(&body, &omega, &attitude)?);
//!
//! // What it keeps: L, T and what follows from them.
//! let kept: Invariants = motion.invariants();
//! assert!((kept.angular_momentum() - Vector3::new(0.2_f64, 0.2, 2.5).norm()).abs() < 1e-15);
//! assert!((motion.angular_momentum_in_body() - Vector3::new(0.2, 0.2, 2.5)).norm() < 1e-15);
//! assert!((kept.energy_ratio() - 2.0 * kept.kinetic_energy() * 2.5 / kept.angular_momentum().powi(2)).abs() < 1e-14);
//! assert!((kept.steady_rates()[2] - kept.angular_momentum() / 2.5).abs() < 1e-15);
//! assert_eq!((kept.mode, kept.circled_axis(), kept.is_steady()), (Mode::ShortAxis, 2, false));
//! assert!((kept.modulus().hypot(kept.complementary_modulus()) - 1.0).abs() < 1e-15);
//! assert_eq!(Invariants::of_motion(&motion).modulus(), kept.modulus());
//!
//! // Its rhythms, cones and the ellipsoid that rolls; the third axis leans from L between these angles.
//! let Periods { rotation, precession, .. } = motion.periods();
//! let Secular { .. } = motion.secular;
//! assert!(precession < rotation);
//! let ([_, _, lean], Cones { body: cone, axis: 2, .. }) = (kept.nutation(), kept.cones()) else {
//!     unreachable!("axis 3 is circled")
//! };
//! assert!(lean[0] < lean[1] && lean[1] < FRAC_PI_2 && cone[0] < cone[1]);
//! let Poinsot { distance, radii, .. } = kept.poinsot();
//! let tip = motion.herpolhode(0.3 * rotation);
//! assert!((tip.dot(&motion.normal()) - distance).abs() < 1e-15);
//! let ring = (tip.norm_squared() - distance * distance).sqrt();
//! assert!(radii[0] <= ring * (1.0 + 1e-12) && ring <= radii[1] * (1.0 + 1e-12));
//!
//! // The polhode: a closed curve in the body, along the principal axes or in the body frame.
//! let points: Vec<_> = motion.polhode_points(60).collect();
//! assert!((points[0] - points[59]).norm() < 1e-15);
//! assert!((kept.polhode_points(60).last().unwrap() - points[59]).norm() < 1e-15);
//!
//! // States at many times, and how they depend on the start: after one period ω is what it was.
//! let (mut attitudes, mut omegas) = ([[0.0; 4]; 2], [[0.0; 3]; 2]);
//! motion.sample(&[0.0, rotation], &mut attitudes, &mut omegas);
//! assert!((omegas[1][0] - 0.2).abs() < 1e-14);
//! let Sensitivity { state, .. } = motion.sensitivity(0.0);
//! assert!((state - polhode::nalgebra::Matrix6::identity()).amax() < 1e-15);
//! // What an ω known to six digits says of the attitude after ten periods.
//! let ErrorBar { attitude, .. } = motion.error_bar(10.0 * rotation, 1e-6);
//! assert!(attitude > 1e-6 * TAU);
//! let same = motion.sensitivity(10.0 * rotation).error_bar(&omega, &moments, 1e-6);
//! assert!((same.attitude / attitude - 1.0).abs() < 1e-6);
//! # Ok::<(), polhode::Error>(())
//! ```

mod from_periods;
mod invariants;
pub mod mode;
mod motion;
mod periods;
mod polhode;
mod propagator;
mod sensitivity;
mod separation;
mod steady_or_symmetric;
#[cfg(test)]
mod tests;
mod tumbling;

pub use from_periods::{CircledAxis, FromPeriods, attitude_about};
pub use invariants::Invariants;
pub use mode::Mode;
pub use motion::FreeMotion;
pub use periods::Periods;
pub use polhode::{Cones, Poinsot};
pub use propagator::Secular;
pub use sensitivity::{ErrorBar, Sensitivity};
