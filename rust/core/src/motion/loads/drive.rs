//! What turns a wheel.

use super::feedback::Feedback;
use super::held::Held;
use super::law::Law;
use super::subject::Subject;
use crate::error::Error;

/// What turns a wheel.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// A motor whose torque τ on the wheel, about its axis, is known; no motor where it is zero.
    Torque(Held),
    /// A motor that exerts on the body, about the wheel's axis, what a feedback asks for: `τ = −a·N`.
    Feedback(Feedback),
    /// The same, as far as the motor can: `|τ|` is at most the limit.
    Limited(Feedback, f64),
    /// A motor that gives the wheel a speed Ω relative to the body that is known: straight lines between times.
    Speed(Held),
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
    pub(super) fn check(&self, subject: &Subject, from: f64, to: f64) -> Result<(), Error> {
        match self {
            Self::Torque(held) => held.covers("torque", from, to, false),
            Self::Speed(held) => held.covers("speed", from, to, true),
            Self::Feedback(law) | Self::Limited(law, _) => law.check(subject, from, to),
        }
    }
}
