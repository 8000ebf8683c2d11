//! What every analytic law of a load is asked.

use nalgebra::Vector3;

use super::axes::{Axes, Exact};
use super::carried::Carried;
use super::linear::Linear;
use super::parameter::Parameter;
use super::subject::Subject;
use super::switch::Switch;
use super::wrench::Wrench;
use crate::error::Error;
use crate::motion::state::Phase;

/// What of the angular momentum about the reference point a load leaves as it is.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::{Kept, Term};
/// use polhode::nalgebra::Vector3;
///
/// // Gravity leaves the angular momentum of a pivoted body about the vertical, and all of a free one's.
/// let weight = Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81))?;
/// assert!(matches!(weight.keeps(true), Kept::Along(axis) if axis.z.abs() == 1.0));
/// assert_eq!(weight.keeps(false), Kept::All);
/// assert_eq!(Kept::All.and(Kept::Nothing), Kept::Nothing);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kept {
    /// All of it: the load has no torque.
    All,
    /// Its component along a unit vector, in N: the torque of a uniform field is across the field.
    Along(Vector3<f64>),
    /// Nothing that is known.
    Nothing,
}

impl Kept {
    /// What two loads together leave.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::All, kept) | (kept, Self::All) => kept,
            (Self::Along(a), Self::Along(b)) if a == b || a == -b => self,
            _ => Self::Nothing,
        }
    }

    pub(super) fn along(direction: &Vector3<f64>) -> Self {
        direction.try_normalize(0.0).map_or(Self::All, Self::Along)
    }
}

/// What a law depends on and does. It has no defaults: who writes a law answers all of it.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a question of its own"
)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Character {
    /// Whether it pushes, so that a free body's position depends on it.
    pub exerts_force: bool,
    /// Whether it depends on ω or on the velocity.
    pub depends_on_rates: bool,
    /// Whether it depends on the body it acts on.
    pub needs_body: bool,
    /// Whether it begins with the motion, wherever in time that is.
    pub needs_epoch: bool,
    /// What of the angular momentum about the reference point it leaves as it is.
    pub keeps: Kept,
    /// Whether [`Law::add_to`] states it: a method that needs series cannot serve a load without them.
    pub has_series: bool,
    /// What the equations of its series are made of.
    pub parts: Parts,
}

/// Which parts the equations of a series have; the others are zero, and are left out.
#[expect(
    clippy::struct_excessive_bools,
    reason = "the parts come in every combination"
)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// How many directions fixed in space its torques are made of: none, the vertical axis, or all three.
    pub directions: usize,
    /// As many for its forces.
    pub directions_of_path: usize,
    /// Whether a torque is linear in ω.
    pub on_omega: bool,
    /// Whether a torque is linear in the attitude's quaternion.
    pub on_attitude: bool,
    /// Whether a torque goes with |ω|, which changes its law where ω passes through zero.
    pub quadratic: bool,
    /// Whether it would with other numbers of the law.
    pub may_be_quadratic: bool,
    /// How many gravity gradients.
    pub gradients: usize,
    /// Whether parts depend on time.
    pub is_timed: bool,
    /// Whether a force acts on a free body.
    pub is_pushed: bool,
    /// How many states the laws have of their own.
    pub own: usize,
}

impl Parts {
    /// Those of two laws that act together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            directions: self.directions.max(other.directions),
            directions_of_path: self.directions_of_path.max(other.directions_of_path),
            on_omega: self.on_omega || other.on_omega,
            on_attitude: self.on_attitude || other.on_attitude,
            quadratic: self.quadratic || other.quadratic,
            may_be_quadratic: self.may_be_quadratic || other.may_be_quadratic,
            gradients: self.gradients + other.gradients,
            is_timed: self.is_timed || other.is_timed,
            is_pushed: self.is_pushed || other.is_pushed,
            own: self.own + other.own,
        }
    }

    /// The parts of two motions under terms of the same kinds: of these only the directions and quadratic damping depend on
    /// the numbers in them.
    #[must_use]
    pub fn with(self, other: &Self) -> Self {
        Self {
            directions: self.directions.max(other.directions),
            quadratic: self.quadratic || other.quadratic,
            ..*other
        }
    }

    /// The parts of motions under the same terms with any numbers in them.
    #[must_use]
    pub fn with_all_numbers(self) -> Self {
        Self {
            directions: if self.directions > 0 { 3 } else { 0 },
            quadratic: self.may_be_quadratic,
            ..self
        }
    }

    /// Whether the law may change with the state: by the sign of a feedback, or of ω that passes through zero.
    #[must_use]
    pub fn may_flip(&self) -> bool {
        self.on_attitude || self.quadratic
    }
}

/// An analytic law of a load: one file each.
pub(super) trait Law: Sized {
    /// What it depends on and does, on a pivoted body or on a free one.
    fn character(&self, pivoted: bool) -> Character;

    /// Its numbers. Those that were multiplied by a factor are those after it.
    fn parameters(&self) -> Vec<Parameter>;

    /// The law that exerts `factor`, which is finite, times as much.
    ///
    /// # Errors
    /// When a number of it is not finite.
    fn scaled(&self, factor: f64) -> Result<Self, Error>;

    /// The law of a motion that began at `t`, for the rest of it.
    #[must_use]
    fn anchored(self, t: f64) -> Self;

    /// The times at which it is not smooth, where a step must end; not sorted.
    fn breaks(&self) -> Vec<f64>;

    /// Checks that it can act on `subject` from one time to another.
    ///
    /// # Errors
    /// When it cannot.
    fn check(&self, subject: &Subject, from: f64, to: f64) -> Result<(), Error>;

    /// Force in N and torque in B about the reference point at time `t`.
    fn wrench(&self, subject: &Subject, t: f64, phase: &Phase) -> Wrench;

    /// The energy of position that the body has in its field, when it has one: force and torque are what it loses. A law that
    /// depends on time has none.
    fn potential(&self, subject: &Subject, phase: &Phase) -> Option<f64>;

    /// Adds what it does to the equations of a series, in numbers of any precision; `side` is the sign that the law is taken
    /// for.
    fn add_to<'a, X: Exact>(&'a self, linear: &mut Linear<'a, X>, axes: &Axes<'_, X>, side: f64);

    /// Whether its law has a sign that changes with the state.
    fn may_switch(&self) -> bool {
        false
    }

    /// What changes its law at a time and `phase`, for a law that [may switch](Self::may_switch).
    fn switch(&self, subject: &Subject, t: f64, phase: &Phase) -> Option<Switch> {
        let _ = (subject, t, phase);
        None
    }

    /// As [`Self::wrench`], with the law on one side of its switch.
    fn settled_wrench(&self, side: f64, subject: &Subject, t: f64, phase: &Phase) -> Wrench {
        let _ = side;
        self.wrench(subject, t, phase)
    }

    /// The function of the attitude (x, y, z, w), linear in it, whose sign the law has.
    fn switching<X: Exact>(&self, axes: &Axes<'_, X>) -> Option<nalgebra::Vector4<X>> {
        let _ = axes;
        None
    }

    /// What it carries along in the body. [`Self::wrench`] of a law with states is that where a motion starts.
    fn carried(&self) -> Option<&dyn Carried> {
        None
    }
}

/// Whether a vector is along the axis 3 of its frame: how many directions of space its series take.
pub(super) fn directions_of(vector: &Vector3<f64>) -> usize {
    if vector.x == 0.0 && vector.y == 0.0 {
        1
    } else {
        3
    }
}
