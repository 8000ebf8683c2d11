//! Attitude feedback: a controller that turns the body toward a target and damps it.

use std::sync::Arc;

use nalgebra::{Matrix3, Matrix3x4, UnitQuaternion, Vector3, Vector4};

use crate::error::{Error, all_finite};
use crate::motion::loads::attitude_target::AttitudeTarget;
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::carried_momentum::LawContext;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::spline::within;
use crate::motion::loads::switch::{Switch, attitude_error};
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::variables::Variables;
use crate::motion::loads::wrench::Wrench;
use crate::motion::state::Phase;
use crate::numerics::quaternion::{conjugate, product};

/// `N = −K sign(w) vec(e) − D (ω − ω_target)` with the error `e = q_target⁻¹ ∘ q` and w its scalar part.
///
/// K and D in B; ω of B and of the target relative to N, components in B. The sign takes the shorter way round; at w = 0, half a turn away,
/// both ways are as long, and the positive one is taken. For a small angle α about a unit vector n, `vec(e) = n α/2`.
/// Source: Wie, Weiss, Arapostathis, J. Guid. Control Dyn. 12 (1989) 375.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// K: torque.
    pub stiffness: Matrix3<f64>,
    /// D: torque over angular velocity.
    pub damping: Matrix3<f64>,
    /// `q_target`.
    pub target: Arc<AttitudeTarget>,
}

impl Feedback {
    /// Checked gains, toward an attitude that stays.
    ///
    /// # Errors
    /// When an element is not finite.
    pub fn new(
        stiffness: &Matrix3<f64>,
        damping: &Matrix3<f64>,
        target: &UnitQuaternion<f64>,
    ) -> Result<Self, Error> {
        Self::toward(stiffness, damping, AttitudeTarget::Fixed(*target))
    }

    /// Checked gains, toward any target.
    ///
    /// # Errors
    /// When an element is not finite.
    pub fn toward(
        stiffness: &Matrix3<f64>,
        damping: &Matrix3<f64>,
        target: AttitudeTarget,
    ) -> Result<Self, Error> {
        all_finite("K", stiffness)?;
        all_finite("D", damping)?;
        Ok(Self {
            stiffness: *stiffness,
            damping: *damping,
            target: Arc::new(target),
        })
    }

    /// `−K sign(w) vec(e) − D ω` with `side`, 1 or −1, for the sign of w; ω relative to the target.
    #[inline]
    fn torque(&self, side: f64, error: &UnitQuaternion<f64>, omega: &Vector3<f64>) -> Vector3<f64> {
        -(self.stiffness * (error.imag() * side) + self.damping * omega)
    }

    /// The torque that it asks for, with the sign of w that it is taken for.
    #[inline]
    pub(super) fn torque_on(&self, now: &LawContext<'_>) -> Vector3<f64> {
        let (error, omega) = attitude_error(&self.target, now.body.start, now.t, now.phase);
        self.torque(now.side, &error, &omega)
    }

    /// `2k (1 − |w|)` where `K = k 1` and D = 0: the work that turning away from the target takes.
    ///
    /// From `ẇ = −½ vec(e)·ω` follows `d/dt 2k (1 − |w|) = k sign(w) vec(e)·ω = −N·ω`. Other gains have no potential.
    #[must_use]
    pub fn energy(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        let k = self.stiffness[(0, 0)];
        if self.stiffness != Matrix3::from_diagonal_element(k) || self.damping != Matrix3::zeros() {
            return None;
        }
        let error = self.target.as_fixed()?.conjugate() * attitude;
        // 1 − |w| = |vec|²/(1 + |w|), which loses nothing near the target.
        Some(2.0 * k * error.imag().norm_squared() / (1.0 + error.w.abs()))
    }

    /// `q_target⁻¹ ∘ q_NP ∘ q_PB` is linear in (x, y, z, w) of `q_NP`: its column for each of them.
    fn error_columns<X: LawNumber>(&self, axes: &PrincipalFrame<'_, X>) -> [[X; 4]; 4] {
        // One that moves has no series: the law toward the attitude that it has at the start.
        let (target, _) = self.target.at(axes.body.start, axes.body.start);
        let left = (axes.variables)
            .vary_attitude(X::quaternion(&target), axes.parameters.of("target").start);
        let [o, l] = [X::zero(), X::one()];
        let units = [[l, o, o, o], [o, l, o, o], [o, o, l, o], [o, o, o, l]];
        units.map(|unit| product(product(conjugate(left), unit), conjugate(*axes.q_bp)))
    }
}

impl Law for Feedback {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: self.damping.iter().any(|&x| x != 0.0),
            needs_body: false,
            needs_epoch: self.target.needs_epoch(),
            keeps: ConservedMomentum::Nothing,
            has_series: self.target.as_fixed().is_some(),
        }
    }

    /// A target has three: a small rotation of it, `R → R exp(δ×)`.
    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::new("K", &[3, 3]),
            Parameter::new("D", &[3, 3]),
            Parameter::new("target", &[3]),
        ]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Self::toward(
            &(self.stiffness * factor),
            &(self.damping * factor),
            (*self.target).clone(),
        )
    }

    fn with_epoch(self, t: f64) -> Self {
        if !self.target.needs_epoch() {
            return self;
        }
        Self {
            target: Arc::new((*self.target).clone().with_epoch(t)),
            ..self
        }
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        within(self.target.breaks(), from, to).to_vec()
    }

    fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        self.target.check(body.start, from, to)
    }

    #[inline]
    fn wrench(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        let (error, omega) = attitude_error(&self.target, body.start, t, phase);
        let side = if error.w < 0.0 { -1.0 } else { 1.0 };
        Wrench::couple(self.torque(side, &error, &omega))
    }

    fn potential(&self, _: &BodyAtPoint, phase: &Phase) -> Option<f64> {
        self.energy(&phase.attitude)
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        side: f64,
    ) {
        series.add_on_omega(&-axes.tensor(&axes.matrix(&self.damping, "D")));
        let stiffness = (axes.columns).tr_mul(&axes.matrix(&self.stiffness, "K"));
        let columns = self.error_columns(axes);
        let vector = Matrix3x4::from_columns(&columns.map(|[x, y, z, _]| Vector3::new(x, y, z)));
        series.add_on_attitude(&-(stiffness * vector * X::from(side)));
    }

    fn may_switch(&self) -> bool {
        true
    }

    fn switch(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Option<Switch> {
        Some(Switch::toward(&self.target, body.start, t, phase))
    }

    #[inline]
    fn settled_wrench(&self, side: f64, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        let (error, omega) = attitude_error(&self.target, body.start, t, phase);
        Wrench::couple(self.torque(side, &error, &omega))
    }

    fn switch_function<X: LawNumber>(&self, axes: &PrincipalFrame<'_, X>) -> Option<Vector4<X>> {
        let columns = self.error_columns(axes);
        Some(Vector4::from(columns.map(|[_, _, _, w]| w)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::state::State;

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
            let side = if attitude.w < 0.0 { -1.0 } else { 1.0 };
            let torque = feedback.torque(side, &attitude, &Vector3::zeros()).z;
            let expected = if angle > 1.0 { 1.0 } else { -angle.signum() } * 0.25_f64.sin();
            assert!((torque - expected).abs() < 1e-15, "{angle} {torque}");
            let potential = feedback.energy(&attitude).expect("isotropic");
            assert!((potential - 2.0 * (1.0 - 0.25_f64.cos())).abs() < 1e-15);
        }
    }

    #[test]
    fn half_a_turn_away_it_takes_the_positive_way_in_every_form() {
        let attitude = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0));
        let (spring, still) = (Matrix3::identity(), Matrix3::zeros());
        let feedback = Feedback::new(&spring, &still, &UnitQuaternion::identity()).expect("finite");
        let body = crate::mass::RigidBody::new(1.0, &spring, &Vector3::zeros(), 0.0);
        let body = BodyAtPoint::free(&body.expect("a ball"), 0.0);
        let omega = Vector3::zeros();
        let phase = Phase::in_place(&State { attitude, omega });
        let side = Switch::toward(&feedback.target, 0.0, 0.0, &phase).side;
        assert_eq!((attitude.w, side), (0.0, 1.0));
        let torques = [
            feedback.wrench(&body, 0.0, &phase).torque,
            feedback.settled_wrench(side, &body, 0.0, &phase).torque,
        ];
        assert_eq!(torques, [Vector3::new(-1.0, 0.0, 0.0); 2]);
    }
}
