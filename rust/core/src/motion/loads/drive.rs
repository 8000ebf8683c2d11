//! What turns a wheel.

use super::body_at_point::BodyAtPoint;
use super::law::Law;
use super::laws::feedback::Feedback;
use super::piecewise_signal::PiecewiseSignal;
use crate::error::Error;

/// What turns a wheel.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::RigidBody;
/// use polhode::motion::loads::{Analytic, Drive, PiecewiseSignal, Wheel, wrench_at};
/// use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
///
/// // A satellite at rest, in which a motor of 0.02 N m spins up a wheel of 0.05 kg m² with dry friction of 0.005 N m.
/// let body = RigidBody::from_principal(90.0, &[8.0, 9.0, 10.0], &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
/// let motor = Drive::Torque(PiecewiseSignal::constant("torque", 0.02)?);
/// let wheel = Wheel::new(&Vector3::z(), 0.05, 0.0, 0.0, motor)?.with_dry_friction(0.005)?;
/// let terms = [wheel.into()];
/// let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() };
/// let tolerance = Tolerance::new(1e-10, 0.0)?;
/// let task = Task::free(&body, Phase::in_place(&state), &[0.0, 10.0], Method::Auto, tolerance);
/// let mut load = Analytic::new(&terms, task.body_at_point);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let run = simulate(&task, &mut load, &mut NoEvents::new(), go_on).into_result()?;
/// // What the wheel has, h = 0.15 N m s, the body lacks: (I − J) ω = −h.
/// assert!((run.phase.internal_state[0] - 0.15).abs() < 1e-10);
/// assert!((run.phase.omega.z + 0.15 / 9.95).abs() < 1e-10);
/// // The torque on the body at the end, beside the tensor without the wheel.
/// let torque = wrench_at(&mut load, &task.euler, 10.0, &run.phase)?.torque;
/// assert!((torque.z + 0.015).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// A motor whose torque τ on the wheel, about its axis, is known; no motor where it is zero.
    Torque(PiecewiseSignal),
    /// A motor that exerts on the body, about the wheel's axis, what a feedback asks for: `τ = −a·N`.
    Feedback(Feedback),
    /// The same, as far as the motor can: `|τ|` is at most the limit.
    Limited(Feedback, f64),
    /// A motor that gives the wheel a speed Ω relative to the body that is known: straight lines between times.
    Speed(PiecewiseSignal),
}

impl Drive {
    /// The feedback that a motor follows.
    pub(super) fn feedback(&self) -> Option<&Feedback> {
        match self {
            Self::Feedback(law) | Self::Limited(law, _) => Some(law),
            Self::Torque(_) | Self::Speed(_) => None,
        }
    }

    /// The times at which it is not smooth.
    pub(super) fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Torque(held) | Self::Speed(held) => held.times().to_vec(),
            Self::Feedback(law) | Self::Limited(law, _) => law.breaks(),
        }
    }

    /// Whether it is known from one time to another.
    pub(super) fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        match self {
            Self::Torque(held) => held.covers("torque", from, to, false),
            Self::Speed(held) => held.covers("speed", from, to, true),
            Self::Feedback(law) | Self::Limited(law, _) => law.check(body, from, to),
        }
    }
}
