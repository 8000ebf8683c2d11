//! Attitude feedback: a controller that turns the body toward a target and damps it.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::state::Phase;

/// `N = −K sign(w) vec(e) − D ω` with the error `e = q_target⁻¹ ∘ q` and w its scalar part.
///
/// K and D in B; ω of B relative to N, components in B. The sign takes the shorter way round; at w = 0, half a turn away,
/// both ways are as long, and the positive one is taken. For a small angle α about a unit vector n, `vec(e) = n α/2`.
/// Source: Wie, Weiss, Arapostathis, J. Guid. Control Dyn. 12 (1989) 375.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// K: torque.
    pub stiffness: Matrix3<f64>,
    /// D: torque over angular velocity.
    pub damping: Matrix3<f64>,
    /// `q_target`, of N from B.
    pub target: UnitQuaternion<f64>,
}

impl Feedback {
    /// Checked gains.
    ///
    /// # Errors
    /// When an element is not finite.
    pub fn new(
        stiffness: &Matrix3<f64>,
        damping: &Matrix3<f64>,
        target: &UnitQuaternion<f64>,
    ) -> Result<Self, Error> {
        all_finite("K", stiffness)?;
        all_finite("D", damping)?;
        Ok(Self {
            stiffness: *stiffness,
            damping: *damping,
            target: *target,
        })
    }

    /// `−K sign(w) vec(e) − D ω`.
    #[inline]
    #[must_use]
    pub fn torque(&self, attitude: &UnitQuaternion<f64>, omega: &Vector3<f64>) -> Vector3<f64> {
        let error = self.target.conjugate() * attitude;
        self.torque_on(if error.w < 0.0 { -1.0 } else { 1.0 }, attitude, omega)
    }

    /// As [`Self::torque`], with `side`, 1 or −1, for the sign of w.
    #[inline]
    #[must_use]
    pub fn torque_on(
        &self,
        side: f64,
        attitude: &UnitQuaternion<f64>,
        omega: &Vector3<f64>,
    ) -> Vector3<f64> {
        let error = self.target.conjugate() * attitude;
        -(self.stiffness * (error.imag() * side) + self.damping * omega)
    }

    /// `2k (1 − |w|)` where `K = k 1` and D = 0: the work that turning away from the target takes.
    ///
    /// From `ẇ = −½ vec(e)·ω` follows `d/dt 2k (1 − |w|) = k sign(w) vec(e)·ω = −N·ω`. Other gains have no potential.
    #[must_use]
    pub fn potential(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        let k = self.stiffness[(0, 0)];
        if self.stiffness != Matrix3::from_diagonal_element(k) || self.damping != Matrix3::zeros() {
            return None;
        }
        let error = self.target.conjugate() * attitude;
        // 1 − |w| = |vec|²/(1 + |w|), which loses nothing near the target.
        Some(2.0 * k * error.imag().norm_squared() / (1.0 + error.w.abs()))
    }

    pub(super) fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Self::new(
            &(self.stiffness * factor),
            &(self.damping * factor),
            &self.target,
        )
    }
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
    /// That of `feedback` at the attitude of `phase`.
    #[must_use]
    pub fn of(feedback: &Feedback, phase: &Phase) -> Self {
        let error = feedback.target.conjugate() * phase.attitude;
        Self {
            target: feedback.target,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_takes_the_shorter_way() {
        let feedback = Feedback::new(
            &Matrix3::identity(),
            &Matrix3::zeros(),
            &UnitQuaternion::identity(),
        )
        .expect("finite");
        for angle in [0.5_f64, -0.5, 2.0 * std::f64::consts::PI - 0.5] {
            let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            let torque = feedback.torque(&attitude, &Vector3::zeros()).z;
            let expected = if angle > 1.0 { 1.0 } else { -angle.signum() } * 0.25_f64.sin();
            assert!((torque - expected).abs() < 1e-15, "{angle} {torque}");
            let potential = feedback.potential(&attitude).expect("isotropic");
            assert!((potential - 2.0 * (1.0 - 0.25_f64.cos())).abs() < 1e-15);
        }
    }
}
