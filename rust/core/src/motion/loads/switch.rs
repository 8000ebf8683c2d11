//! Signs that change the law of a load.

use nalgebra::UnitQuaternion;

use super::bearing::Bearing;
use crate::motion::state::Phase;

/// What may change the law of a load within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// The sign in the law of a feedback.
    Sign(Switch),
    /// A wheel that turns stops.
    Stop(Bearing),
    /// A wheel at rest begins to turn: the way that it turns then, once that is known.
    Slip(Bearing),
}

/// What changes the law of a feedback: the sign of the scalar part w of its error. Both w and its rate `ẇ = −½ vec(e)·ω` are continuous
/// where it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    target: UnitQuaternion<f64>,
    /// The sign that the law has been taken for.
    pub side: f64,
}

impl Switch {
    /// That of a feedback toward `target`, at the attitude of `phase`.
    #[must_use]
    pub fn toward(target: &UnitQuaternion<f64>, phase: &Phase) -> Self {
        let error = target.conjugate() * phase.attitude;
        Self {
            target: *target,
            side: if error.w < 0.0 { -1.0 } else { 1.0 },
        }
    }

    /// w and ẇ, each times the side: the law changes where the first becomes negative.
    #[must_use]
    pub fn value_and_rate(&self, phase: &Phase) -> [f64; 2] {
        let error = self.target.conjugate() * phase.attitude;
        let rate = -0.5 * error.imag().dot(&phase.omega);
        [error.w * self.side, rate * self.side]
    }
}
