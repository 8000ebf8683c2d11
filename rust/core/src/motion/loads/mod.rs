//! What acts on a body: a closed set of analytic terms, and a trait for what only the caller knows.
//!
//! | term | law | file |
//! |---|---|---|
//! | constant torque | N | [`constant_torque`] |
//! | constant force at a point | `N = (p − P)×F` | [`constant_force`] |
//! | uniform gravity | m g at C | [`uniform_gravity`] |
//! | gravity gradient | `N = 3μ/r⁵ r×(I_C r)` on an orbit | [`gravity_gradient`], `path`, [`kepler`], `oblate` |
//! | damping | `N = −D ω − E \|ω\| ω` | [`damping`] |
//! | attitude feedback | `N = −K sign(w) vec(q_target⁻¹∘q) − D (ω − ω_target)` | [`feedback`], `aim` |
//! | a torque sampled in time | cubic spline | [`sampled`] |
//! | a magnetic field | `N = (d − k Ḃ) × B` | [`magnetic`] |
//! | a rotor | `N = −ω × h` | [`rotor`] |
//! | a wheel with motor and friction | `ḣ = τ − c Ω − c₀ sign(Ω)` | [`wheel`], `drive`, [`held`], `bearing`, `resting` |
//! | a spherical damper | `N = k (σ − ω)` | [`slug`] |
//! | any of them on and off | windows of time | [`schedule`] |
//! | what the caller knows | a closure of time and state | `callback` |
//!
//! A law more is a file more here, which answers what a `Law` is asked, and its name in the list in `term.rs`.

mod aim;
mod analytic;
mod axes;
mod bearing;
mod callback;
mod carried;
pub mod constant_force;
pub mod constant_torque;
pub mod damping;
mod drive;
pub mod feedback;
mod forcing;
pub mod gravity_gradient;
pub mod held;
pub mod kepler;
mod law;
mod linear;
mod load;
pub mod magnetic;
mod now;
mod oblate;
mod parameter;
mod path;
mod resting;
pub mod rotor;
pub mod sampled;
pub mod schedule;
pub mod slug;
mod spline;
mod stumpff;
mod subject;
mod switch;
mod term;
pub mod uniform_gravity;
pub(in crate::motion) mod variables;
pub mod wheel;
mod wrench;

pub use self::aim::{Aim, Sampling};
pub use self::analytic::Analytic;
pub use self::axes::Axes;
pub(crate) use self::axes::Exact;
pub use self::bearing::Bearing;
pub use self::callback::Callback;
pub use self::carried::Carried;
pub use self::constant_force::ConstantForce;
pub use self::constant_torque::ConstantTorque;
pub use self::damping::Damping;
pub use self::drive::Drive;
pub use self::feedback::Feedback;
pub(crate) use self::forcing::{Forcing, OnOrbit, When};
pub use self::gravity_gradient::GravityGradient;
pub use self::held::Held;
pub use self::law::Kept;
pub(crate) use self::law::Parts;
pub(crate) use self::linear::{Linear, Own};
pub use self::load::Load;
pub use self::magnetic::{Magnetic, MagneticField};
pub use self::oblate::Oblate;
pub use self::parameter::Parameter;
pub use self::path::Path;
pub(in crate::motion) use self::resting::Resting;
pub use self::resting::wrench_at;
pub use self::rotor::Rotor;
pub use self::sampled::Sampled;
pub use self::schedule::Windows;
pub use self::slug::Slug;
pub use self::subject::Subject;
pub use self::switch::{Change, Switch};
pub use self::term::Term;
pub use self::uniform_gravity::UniformGravity;
pub use self::wheel::Wheel;
pub use self::wrench::Wrench;
pub use super::kinematics::Frame;
