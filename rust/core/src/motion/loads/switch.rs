//! What changes the law of a load within a step: the sign of a feedback, a wheel that stops or begins to slip.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

use super::attitude_target::AttitudeTarget;
use super::stiction::Bearing;
use crate::motion::state::Phase;

/// What may change the law of a load within a step.
#[derive(Clone, Debug, PartialEq)]
pub enum LawSwitch {
    /// The sign in the law of a feedback.
    Sign(Switch),
    /// A wheel that turns stops.
    Stop(Bearing),
    /// A wheel at rest begins to turn: the way that it turns then, once that is known.
    Slip(Bearing),
}

/// What changes the law of a feedback: the sign of the scalar part w of its error. Both w and its rate `ẇ = −½ vec(e)·(ω − ω_target)` are
/// continuous where it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Switch {
    target: Arc<AttitudeTarget>,
    /// When the motion began.
    start: f64,
    /// The sign that the law has been taken for.
    pub side: f64,
}

impl Switch {
    /// That of a feedback toward `target` in a motion that began at `start`, at time `t` and `phase`.
    #[must_use]
    pub fn toward(target: &Arc<AttitudeTarget>, start: f64, t: f64, phase: &Phase) -> Self {
        let mut switch = Self {
            target: Arc::clone(target),
            start,
            side: 1.0,
        };
        let [w, _] = switch.value_and_rate(t, phase);
        if w < 0.0 {
            switch.side = -1.0;
        }
        switch
    }

    /// w and ẇ, each times the side: the law changes where the first becomes negative.
    #[must_use]
    pub fn value_and_rate(&self, t: f64, phase: &Phase) -> [f64; 2] {
        let (error, omega) = attitude_error(&self.target, self.start, t, phase);
        let rate = -0.5 * error.imag().dot(&omega);
        [error.w * self.side, rate * self.side]
    }
}

/// What is left to turn, `e = q_target⁻¹ ∘ q`, and the angular velocity relative to the target, in B.
#[inline]
pub(super) fn attitude_error(
    target: &AttitudeTarget,
    start: f64,
    t: f64,
    phase: &Phase,
) -> (UnitQuaternion<f64>, Vector3<f64>) {
    if let AttitudeTarget::Fixed(target) = target {
        return (target.conjugate() * phase.attitude, phase.omega);
    }
    let (target, rate) = target.at(start, t);
    let error = target.conjugate() * phase.attitude;
    (error, phase.omega - error.inverse_transform_vector(&rate))
}
