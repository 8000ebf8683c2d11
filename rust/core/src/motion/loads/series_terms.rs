//! What acts between two breaks, as far as it is linear in what varies: what the laws of a load add up to in a series.

use nalgebra::{Matrix3, Matrix3x4, Vector3, Vector4};

use super::forcing::{Orbiting, Timed};
use super::formula::TorqueFormula;
use super::principal_frame::LawNumber;
use crate::motion::kinematics::Frame;

/// Torques about the reference point in principal axes, linear in what varies, and what is not linear besides. What no law has
/// stated is `None`, which is not the same as a zero that a law has stated: see [`Self::parts`].
#[derive(Clone, Debug)]
pub(crate) struct SeriesTerms<'a, X: LawNumber> {
    /// Constant in the body.
    pub constant: Vector3<X>,
    on_omega: Option<Matrix3<X>>,
    on_attitude: Option<Matrix3x4<X>>,
    /// Torques that are not linear in ω.
    pub formulas: Vec<TorqueFormula<X>>,
    /// Torques `M R_PN v` of vectors v fixed in space.
    pub on_space: Vec<(Vector3<X>, Matrix3<X>)>,
    force: Option<Vector3<X>>,
    thrust: Option<Vector3<X>>,
    /// Torques that depend on the time, each with the column of its first number.
    pub timed: Vec<(usize, &'a dyn Timed<X>)>,
    /// Gravity gradients, likewise.
    pub gradients: Vec<(usize, &'a dyn Orbiting<X>)>,
    /// The states that the load has of its own.
    pub internal_states: Vec<InternalState<X>>,
    /// Σ J a aᵀ of the wheels that turn freely, which is not part of the tensor of the equations, but is pulled by gravity.
    pub turning: Matrix3<X>,
}

impl<X: LawNumber> Default for SeriesTerms<'_, X> {
    fn default() -> Self {
        Self {
            constant: Vector3::zeros(),
            on_omega: None,
            on_attitude: None,
            formulas: Vec::new(),
            on_space: Vec::new(),
            force: None,
            thrust: None,
            timed: Vec::new(),
            gradients: Vec::new(),
            internal_states: Vec::new(),
            turning: Matrix3::zeros(),
        }
    }
}

impl<X: LawNumber> SeriesTerms<'_, X> {
    /// Adds a torque that is this matrix times ω.
    pub(crate) fn add_on_omega(&mut self, matrix: &Matrix3<X>) {
        *self.on_omega.get_or_insert_with(Matrix3::zeros) += matrix;
    }

    /// Adds a torque that is this matrix times the attitude (x, y, z, w) of the principal axes.
    pub(crate) fn add_on_attitude(&mut self, matrix: &Matrix3x4<X>) {
        *self.on_attitude.get_or_insert_with(Matrix3x4::zeros) += matrix;
    }

    /// Adds a force, components in N.
    pub(crate) fn add_force(&mut self, force: &Vector3<X>) {
        *self.force.get_or_insert_with(Vector3::zeros) += force;
    }

    /// Adds a force that is constant in the body, components in principal axes.
    pub(crate) fn add_thrust(&mut self, thrust: &Vector3<X>) {
        *self.thrust.get_or_insert_with(Vector3::zeros) += thrust;
    }

    /// The torque times ω.
    pub(crate) fn on_omega(&self) -> Matrix3<X> {
        self.on_omega.unwrap_or_else(Matrix3::zeros)
    }

    /// The torque times the attitude (x, y, z, w) of the principal axes.
    pub(crate) fn on_attitude(&self) -> Matrix3x4<X> {
        self.on_attitude.unwrap_or_else(Matrix3x4::zeros)
    }

    /// The force in N.
    pub(crate) fn force(&self) -> Vector3<X> {
        self.force.unwrap_or_else(Vector3::zeros)
    }

    /// The force constant in the body, in principal axes.
    pub(crate) fn thrust(&self) -> Vector3<X> {
        self.thrust.unwrap_or_else(Vector3::zeros)
    }

    /// What the laws have stated, be it zero; `has_path` where the path of a free body is part of the motion.
    pub(crate) fn structure(&self, has_path: bool) -> SeriesStructure {
        let is_upright = |vector: &Vector3<X>| vector.x == X::zero() && vector.y == X::zero();
        let sees_all = (self.timed.iter()).any(|(_, torque)| torque.frame() == Frame::Space)
            || has_path && self.thrust.is_some();
        let directions = match self.on_space.as_slice() {
            _ if sees_all => 3,
            [] => 0,
            fixed if fixed.iter().all(|(vector, _)| is_upright(vector)) => 1,
            _ => 3,
        };
        SeriesStructure {
            directions,
            on_omega: self.on_omega.is_some(),
            on_attitude: self.on_attitude.is_some(),
            quadratic: self.formulas.iter().any(TorqueFormula::has_speed),
            gradients: self.gradients.len(),
            is_timed: !self.timed.is_empty(),
            is_pushed: has_path && (self.force.is_some() || self.thrust.is_some()),
            internal_states: self.internal_states.len(),
        }
    }
}

/// Which parts the equations of a series have; the others are left out.
#[expect(
    clippy::struct_excessive_bools,
    reason = "the parts come in every combination"
)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SeriesStructure {
    /// How many directions fixed in space its torques and forces are made of: none, the vertical axis, or all three.
    pub directions: usize,
    /// Whether a torque is linear in ω.
    pub on_omega: bool,
    /// Whether a torque is linear in the attitude's quaternion.
    pub on_attitude: bool,
    /// Whether a torque goes with |ω|, which changes its law where ω passes through zero.
    pub quadratic: bool,
    /// How many gravity gradients.
    pub gradients: usize,
    /// Whether torques depend on time.
    pub is_timed: bool,
    /// Whether a force acts on a free body.
    pub is_pushed: bool,
    /// How many states the laws have of their own.
    pub internal_states: usize,
}

impl SeriesStructure {
    /// Those of either of two motions.
    #[must_use]
    pub(crate) fn of_both(self, other: Self) -> Self {
        Self {
            directions: self.directions.max(other.directions),
            on_omega: self.on_omega || other.on_omega,
            on_attitude: self.on_attitude || other.on_attitude,
            quadratic: self.quadratic || other.quadratic,
            gradients: self.gradients.max(other.gradients),
            is_timed: self.is_timed || other.is_timed,
            is_pushed: self.is_pushed || other.is_pushed,
            internal_states: self.internal_states.max(other.internal_states),
        }
    }

    /// Whether the law may change with the state: by the sign of a feedback, or of ω that passes through zero.
    #[must_use]
    pub(crate) fn may_flip(&self) -> bool {
        self.on_attitude || self.quadratic
    }
}

/// A state z of the load's own: what it does to the body, and what becomes of it. Vectors in principal axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InternalState<X: LawNumber> {
    /// The torque `z p` about the reference point.
    pub torque: Vector3<X>,
    /// The momentum `z g` that turns with the body: a torque `−ω × z g`.
    pub momentum: Vector3<X>,
    /// Its rate: constant, times itself, times ω, times the attitude (x, y, z, w).
    pub constant: X,
    /// Times itself.
    pub on_itself: X,
    /// Times ω.
    pub on_omega: Vector3<X>,
    /// Times the attitude (x, y, z, w).
    pub on_attitude: Vector4<X>,
    /// Of a component of a vector s that has the rate `−ω × s` besides: the number of the state that is its first, and which
    /// component it is.
    pub turned: Option<(usize, usize)>,
    /// What counts as large is that times the largest |ω|, or what it has come to.
    pub size: f64,
    /// What is reported of it is the state itself and that times ω.
    pub reported_on_omega: Vector3<X>,
}

impl<X: LawNumber> Default for InternalState<X> {
    fn default() -> Self {
        Self {
            torque: Vector3::zeros(),
            momentum: Vector3::zeros(),
            constant: X::zero(),
            on_itself: X::zero(),
            on_omega: Vector3::zeros(),
            on_attitude: Vector4::zeros(),
            turned: None,
            size: 1.0,
            reported_on_omega: Vector3::zeros(),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::motion::loads::variables::Fixed;
    use crate::motion::loads::{
        BodyAtPoint, Damping, Drive, Feedback, GravityGradient, PiecewiseSignal, PrincipalFrame,
        Rotor, Sampled, Slug, Term, Wheel,
    };

    /// What a term alone adds to the equations of a body, at a time and on a side of its switch.
    fn structure(term: &Term, pivoted: bool, middle: f64, side: f64) -> SeriesStructure {
        let body = BodyAtPoint {
            mass: 2.0,
            inertia: Matrix3::identity(),
            point: Vector3::zeros(),
            center: Vector3::new(0.0, 0.1, 0.2),
            pivoted,
            start: 0.0,
        };
        let axes = PrincipalFrame {
            body: &body,
            columns: &Matrix3::identity(),
            q_bp: &[0.0, 0.0, 0.0, 1.0],
            variables: Fixed,
            first: 0,
            middle,
        };
        let mut series = SeriesTerms::<f64>::default();
        term.add_to(&mut series, &axes, side);
        series.structure(!pivoted)
    }

    #[test]
    fn parts_are_what_the_laws_add_at_any_time_and_on_either_side() {
        let (up, aside) = (Vector3::z(), Vector3::new(0.1, 0.0, 1.0));
        let (zero, one) = (Matrix3::zeros(), Matrix3::identity());
        let torque = |vector, frame| Term::constant_torque(vector, frame).expect("finite");
        let force = |frame| Term::constant_force(&aside, frame, Some(&aside)).expect("finite");
        let feedback =
            || Feedback::new(&one, &zero, &UnitQuaternion::identity()).expect("a feedback");
        let samples = |frame| Sampled::new(&[0.0, 9.0], &[up, aside], frame).expect("ascending");
        let orbit = GravityGradient::new(1.0, &aside, &Vector3::x(), None).expect("an orbit");
        let speeds =
            PiecewiseSignal::table("speed", &[0.0, 3.0, 9.0], &[0.0, 1.0, 0.0]).expect("ascending");
        let wheel = |drive| Term::from(Wheel::new(&up, 0.1, 0.0, 0.0, drive).expect("a wheel"));
        let none = SeriesStructure::default();
        let on_omega = SeriesStructure {
            on_omega: true,
            ..none
        };
        let along = |directions| SeriesStructure { directions, ..none };
        let pushed = |directions| SeriesStructure {
            is_pushed: true,
            ..along(directions)
        };
        let is_timed = |directions| SeriesStructure {
            is_timed: true,
            ..along(directions)
        };
        let asked = SeriesStructure {
            on_attitude: true,
            ..on_omega
        };
        let with_states = |internal_states: usize, structure: SeriesStructure| SeriesStructure {
            internal_states,
            ..structure
        };
        let alike = |term: Term, structure: SeriesStructure| (term, structure, structure);
        let damping = |quadratic| Term::from(Damping::new(&zero, quadratic).expect("finite"));
        let gravity = Term::uniform_gravity(&up).expect("finite");
        // Free, and pivoted.
        for (term, free, pivoted) in [
            alike(torque(&up, Frame::Body), none),
            alike(torque(&up, Frame::Space), along(1)),
            alike(torque(&aside, Frame::Space), along(3)),
            (force(Frame::Space), pushed(3), along(3)),
            (force(Frame::Body), pushed(3), none),
            (gravity, pushed(0), along(1)),
            alike(damping(&zero), on_omega),
            alike(
                damping(&one),
                SeriesStructure {
                    quadratic: true,
                    ..on_omega
                },
            ),
            alike(Rotor::new(&up).expect("finite").into(), on_omega),
            alike(feedback().into(), asked),
            alike(samples(Frame::Body).into(), is_timed(0)),
            alike(samples(Frame::Space).into(), is_timed(3)),
            alike(
                orbit.into(),
                SeriesStructure {
                    gradients: 1,
                    ..none
                },
            ),
            alike(
                Slug::new(0.1, 0.2).expect("positive").into(),
                with_states(3, on_omega),
            ),
            alike(wheel(Drive::Speed(speeds)), with_states(1, on_omega)),
            alike(wheel(Drive::Feedback(feedback())), with_states(1, asked)),
        ] {
            for (middle, side) in [(0.0, 1.0), (1.5, -1.0), (6.0, 1.0), (6.0, -1.0)] {
                assert_eq!(structure(&term, false, middle, side), free, "{term:?}");
                assert_eq!(structure(&term, true, middle, side), pivoted, "{term:?}");
            }
        }
    }

    #[test]
    fn the_parts_of_two_motions_are_those_of_either() {
        let one = SeriesStructure {
            directions: 1,
            is_timed: true,
            internal_states: 2,
            ..SeriesStructure::default()
        };
        let other = SeriesStructure {
            directions: 3,
            on_attitude: true,
            internal_states: 2,
            ..SeriesStructure::default()
        };
        let both = SeriesStructure {
            directions: 3,
            is_timed: true,
            on_attitude: true,
            internal_states: 2,
            ..SeriesStructure::default()
        };
        assert_eq!((one.of_both(other), other.of_both(one)), (both, both));
        assert!(both.may_flip() && !one.may_flip());
    }
}
