//! What the laws of a load add to the equations of a series between two breaks: terms that are linear in what varies, formulas of ω,
//! and what depends on the time alone.

use std::fmt::Debug;

use nalgebra::{Matrix3, Matrix3x4, Vector3, Vector4};

use super::body_at_point::BodyAtPoint;
use super::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::kinematics::Frame;
use crate::numerics::number::Real;

/// Torques about the reference point in principal axes, linear in what varies, and what is not linear besides. What no law has
/// stated is `None`, which is not the same as a zero that a law has stated: see [`Self::structure`].
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
    /// Torques that depend on the time, each with the index of its term.
    pub timed: Vec<(usize, &'a dyn CubicTorque<X>)>,
    /// Gravity gradients, likewise.
    pub gradients: Vec<(usize, &'a dyn OrbitTorque<X>)>,
    /// The internal states of the load.
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
    /// How many internal states the laws have.
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

/// An internal state z of the load: what it does to the body, and what becomes of it. Vectors in principal axes.
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

/// A step of a formula. Scalars and vectors are numbered in the order of the steps that make them; the vector 0 is ω.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FormulaStep {
    /// The scalar ω·ω.
    Square,
    /// The scalar |ω|, the root of the scalar of this number, which is ω·ω.
    Speed(usize),
    /// A scalar times a vector.
    Times(usize, usize),
}

/// A scalar of a formula, and its degree in ω.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar {
    number: usize,
    degree: i32,
}

/// A vector of a formula, and its degree in ω.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vector {
    number: usize,
    degree: i32,
}

/// ω.
pub(crate) const OMEGA: Vector = Vector {
    number: 0,
    degree: 1,
};

/// The torque `M v` about the reference point: a matrix, and a vector that is made of ω step by step; in principal axes.
#[derive(Clone, Debug)]
pub(crate) struct TorqueFormula<X: LawNumber> {
    /// How the vector is made.
    pub steps: Vec<FormulaStep>,
    /// The number of the vector.
    pub vector: usize,
    /// Its degree in ω, so that the torque is known in every unit of rates.
    pub degree: i32,
    /// M.
    pub matrix: Matrix3<X>,
}

impl<X: LawNumber> TorqueFormula<X> {
    /// Whether |ω| is a step of it.
    pub(super) fn has_speed(&self) -> bool {
        self.steps
            .iter()
            .any(|step| matches!(step, FormulaStep::Speed(_)))
    }
}

/// A formula as a law states it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steps {
    list: Vec<FormulaStep>,
    scalars: usize,
    vectors: usize,
}

impl Steps {
    fn scalar(&mut self, step: FormulaStep, degree: i32) -> Scalar {
        self.list.push(step);
        self.scalars += 1;
        Scalar {
            number: self.scalars - 1,
            degree,
        }
    }

    /// `ω·ω`.
    pub(crate) fn square(&mut self) -> Scalar {
        self.scalar(FormulaStep::Square, 2)
    }

    /// |ω|. Where ω passes through zero, a step must end: see [`TorqueFormula::has_speed`].
    pub(crate) fn speed(&mut self) -> Scalar {
        let square = self.square();
        self.scalar(FormulaStep::Speed(square.number), 1)
    }

    /// A scalar times a vector.
    pub(crate) fn times(&mut self, factor: Scalar, vector: Vector) -> Vector {
        self.list
            .push(FormulaStep::Times(factor.number, vector.number));
        self.vectors += 1;
        Vector {
            number: self.vectors,
            degree: factor.degree + vector.degree,
        }
    }

    /// The torque `matrix · vector`, the matrix in principal axes.
    pub(crate) fn torque<X: LawNumber>(
        self,
        matrix: Matrix3<X>,
        vector: Vector,
    ) -> TorqueFormula<X> {
        TorqueFormula {
            steps: self.list,
            vector: vector.number,
            degree: vector.degree,
            matrix,
        }
    }
}

/// The parts of a load that go with the time, around one time; times and rates in units of the unit of rates.
#[derive(Clone, Debug)]
pub(crate) struct Forcing<X> {
    /// Torques in principal axes over the moments: coefficients of a cubic.
    pub in_body: [Vector3<X>; 4],
    /// Torques in N: coefficients of a cubic.
    pub in_space: [Vector3<X>; 4],
    /// One for each gravity gradient that acts.
    pub orbits: Vec<OrbitState<X>>,
    /// Whether these are known already and not asked for.
    pub has_orbits: bool,
}

/// A state on an orbit, lengths over the distance r₀ of this time, times in the unit of rates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrbitState<X> {
    /// From the attractor, in N: a unit vector.
    pub position: Vector3<X>,
    /// In N.
    pub velocity: Vector3<X>,
    /// μ/r₀³.
    pub pull: X,
    /// 3μ/r₀³ times the factor of the load.
    pub strength: X,
}

impl<X: Real> Default for Forcing<X> {
    fn default() -> Self {
        Self {
            in_body: [Vector3::zeros(); 4],
            in_space: [Vector3::zeros(); 4],
            orbits: Vec::new(),
            has_orbits: false,
        }
    }
}

impl<X: Real> Forcing<X> {
    /// Nothing acts, and nothing is known.
    pub(crate) fn clear(&mut self) {
        self.in_body = [Vector3::zeros(); 4];
        self.in_space = [Vector3::zeros(); 4];
        self.orbits.clear();
        self.has_orbits = false;
    }
}

impl<X: Real> OrbitState<X> {
    /// That of a term that does not act.
    #[must_use]
    pub(crate) fn none() -> Self {
        Self {
            position: Vector3::new(X::zero(), X::zero(), X::one()),
            velocity: Vector3::zeros(),
            pull: X::zero(),
            strength: X::zero(),
        }
    }
}

/// A time at which a step begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepTime<X> {
    /// Since the start of the motion, and when that was.
    pub elapsed: X,
    /// The start of the motion.
    pub start: f64,
    /// The time as a double.
    pub time: f64,
    /// A time within the segment, which has no breaks.
    pub middle: f64,
    /// The unit of rates.
    pub unit: f64,
}

/// A torque that depends on the time: a cubic between two breaks.
pub(crate) trait CubicTorque<X: LawNumber>: Debug {
    /// The frame that its components are in.
    fn frame(&self) -> Frame;

    /// The coefficients of the cubic around a time, in the body's axes or in N, in units of the unit of rates.
    fn cubic(&self, axes: &PrincipalFrame<'_, X>, when: &StepTime<X>) -> [Vector3<X>; 4];

    /// About the square of the fastest rate that it makes in a segment with the time `middle` in it; `over_moment` is one over the
    /// least moment of inertia.
    fn square_of_rate(&self, body: &BodyAtPoint, middle: f64, over_moment: f64) -> f64;

    /// The sizes of its torques around a time along a unit vector of B, and in all.
    fn torques_along(&self, axis: &Vector3<f64>, middle: f64) -> Vec<(f64, f64)>;
}

/// A gravity gradient, whose torque `r×I r` has no component along an axis without a moment.
pub(crate) trait OrbitTorque<X: LawNumber>: Debug {
    /// Where the body is at a time.
    fn on_orbit(&self, axes: &PrincipalFrame<'_, X>, when: &StepTime<X>) -> OrbitState<X>;

    /// About the square of the fastest rate that it makes.
    fn square_of_rate(&self, body: &BodyAtPoint) -> f64;
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::motion::loads::variables::Fixed;
    use crate::motion::loads::{
        BodyAtPoint, Damping, Drive, Feedback, GravityGradient, ParameterColumns, PiecewiseSignal,
        PrincipalFrame, Rotor, Sampled, Slug, Term, Wheel,
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
            parameters: ParameterColumns::NONE,
            term: 0,
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

    #[test]
    fn degrees_are_counted() {
        let mut steps = Steps::default();
        let (speed, square) = (steps.speed(), steps.square());
        let once = steps.times(speed, OMEGA);
        let twice = steps.times(square, once);
        let formula = steps.torque(Matrix3::<f64>::identity(), twice);
        assert_eq!((formula.degree, formula.vector), (4, 2));
        let all = [
            FormulaStep::Square,
            FormulaStep::Speed(0),
            FormulaStep::Square,
            FormulaStep::Times(1, 0),
            FormulaStep::Times(2, 1),
        ];
        assert_eq!(formula.steps, all);
        assert!(formula.has_speed());
        let mut steps = Steps::default();
        let square = steps.square();
        let cubic = steps.times(square, OMEGA);
        assert!(!steps.torque(Matrix3::<f64>::identity(), cubic).has_speed());
    }
}
