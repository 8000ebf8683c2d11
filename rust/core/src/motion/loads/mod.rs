//! What acts on a body: a closed set of analytic terms, and a trait for what only the caller knows.
//!
//! The laws are the variants of [`Term`]. Each of them may act [in windows of time](schedule) only; what the caller alone knows is a
//! closure of time and state, [`Callback`].
//!
//! | file | what it knows |
//! |---|---|
//! | `laws` | the list of the laws, each of which is a file in the folder; the type of a term, made from the list |
//! | `law` | what every law is asked |
//! | `load`, `analytic`, [`Callback`] | a load, whoever computes it: sums of terms, closures |
//! | `series_terms`, `principal_frame`, `variables` | what a law adds to the equations of a series, and in which numbers |
//! | `orbit_model`, [`kepler`], `oblate` | orbits |
//! | `attitude_target`, `switch` | where a feedback turns the body, and by which sign |
//! | `thrusters` | thrusters that fire in pulses, of lengths that are known at the start of each period |
//! | `carried_momentum`, `stiction`, [`piecewise_signal`] | wheels and slugs, dry friction, what motors are told |
//! | `varying_body` | a body that changes with time, and a load on it |
//!
//! A new law is a new file in `laws`, which answers what a `Law` is asked, and its lines in the list, `laws.rs`.
//!
//! # Examples
//!
//! ```
//! use std::ops::ControlFlow;
//! use polhode::mass::{Amount, solids};
//! use polhode::motion::loads::{
//!     Analytic, ConstantForce, ConstantTorque, Damping, Frame, Load, Parameter, Rotor, Slug, BodyAtPoint, Term, UniformGravity, Wrench,
//! };
//! use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
//! use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
//!
//! // A top of 2 kg on a table with its point at the origin, in gravity, slowed by air, a rotor and a loose part inside.
//! let disk = solids::cylinder(0.1, 0.02, Amount::Mass(2.0))?.translated(&Vector3::new(0.0, 0.0, 0.05))?;
//! let air = Damping::new(&(Matrix3::identity() * 1e-4), &Matrix3::zeros())?;
//! assert_eq!(air.torque(&Vector3::new(0.0, 0.0, 10.0)).z, -1e-3);
//! let terms = [
//!     UniformGravity::new(&Vector3::new(0.0, 0.0, -9.81))?.into(),
//!     air.into(),
//!     Rotor::new(&Vector3::new(0.0, 0.0, 0.01))?.into(),
//!     Slug::new(1e-5, 1e-4)?.into(),
//!     ConstantTorque::new(&Vector3::new(0.0, 0.0, 1e-3), Frame::Body)?.into(),
//!     Term::ConstantForce(ConstantForce::new(&Vector3::x(), Frame::Space, Some(&Vector3::new(0.0, 0.0, 0.06)))?),
//! ];
//! let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::new(0.0, 0.0, 200.0) };
//! let tolerance = Tolerance::new(1e-12, 0.0)?;
//! let task = Task::pivoted(&disk, Phase::in_place(&state), &[0.0, 0.5], Method::Auto, tolerance);
//! let mut load = Analytic::new(&terms, task.body_at_point);
//! assert!(load.depends_on_rates());
//! assert_eq!((load.terms().len(), load.body()), (6, &BodyAtPoint::pivoted(&disk, 0.0)));
//! let go_on = &mut |_| ControlFlow::Continue(());
//! let run = simulate(&task, &mut load, &mut NoEvents::new(), go_on).into_result()?;
//! assert!(run.phase.omega.z < 200.0);
//! assert_eq!(load.active().len(), 6); // those that act in the last span of time
//!
//! // Each by itself: what it exerts at a state, and its numbers by name.
//! let Wrench { force, torque } = terms[0].wrench(&task.body_at_point, 0.0, &run.samples[0]);
//! assert_eq!((force.z, torque), (-19.62, Vector3::zeros()));
//! let numbers: Vec<Parameter> = terms[0].parameters();
//! assert_eq!(numbers[0].count(), 3);
//! assert_eq!(Wrench::couple(Vector3::z()).force, Vector3::zeros());
//! # Ok::<(), polhode::Error>(())
//! ```

mod allocation;
mod analytic;
mod attitude_target;
mod body_at_point;
mod callback;
mod carried_momentum;
pub mod kepler;
mod law;
mod laws;
mod load;
mod oblate;
mod orbit_model;
pub mod piecewise_signal;
mod principal_frame;
mod quintic;
pub mod schedule;
mod series_terms;
mod spline;
mod stiction;
mod switch;
mod thrusters;
pub(in crate::motion) mod variables;
mod varying_body;
mod wrench;

pub use self::allocation::{allocation, allocation_error};
pub use self::analytic::Analytic;
pub use self::attitude_target::{AttitudeTarget, Sampling};
pub use self::body_at_point::BodyAtPoint;
pub use self::callback::Callback;
pub use self::carried_momentum::CarriedMomentum;
pub use self::law::ConservedMomentum;
pub use self::laws::*;
pub use self::load::{Load, wrench_at};
pub use self::oblate::Oblate;
pub use self::orbit_model::OrbitModel;
pub use self::piecewise_signal::PiecewiseSignal;
pub(crate) use self::principal_frame::{LawNumber, PrincipalFrame};
pub use self::schedule::Windows;
pub(crate) use self::series_terms::{Forcing, OrbitState, StepTime};
pub(crate) use self::series_terms::{FormulaStep, TorqueFormula};
pub(crate) use self::series_terms::{InternalState, SeriesStructure, SeriesTerms};
#[cfg(test)]
pub(crate) use self::series_terms::{OMEGA, Steps};
pub use self::stiction::Bearing;
pub(in crate::motion) use self::stiction::Stiction;
pub use self::switch::{LawSwitch, Switch};
pub use self::thrusters::{Pulses, Thrusters};
pub use self::variables::Parameter;
pub(crate) use self::variables::ParameterColumns;
pub use self::varying_body::{VaryingBody, VaryingLoad};
pub use self::wrench::Wrench;
pub use super::kinematics::Frame;
