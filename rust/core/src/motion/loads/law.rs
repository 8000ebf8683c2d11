//! The trait `Law`: the questions that every analytic law of a load answers.

use nalgebra::Vector3;

use super::body_at_point::BodyAtPoint;
use super::carried_momentum::CarriedMomentum;
use super::principal_frame::{LawNumber, PrincipalFrame};
use super::series_terms::SeriesTerms;
use super::switch::Switch;
use super::variables::Parameter;
use super::wrench::Wrench;
use crate::error::Error;
use crate::motion::state::Phase;

/// What of the angular momentum about the reference point a load leaves as it is.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::{ConservedMomentum, Term};
/// use polhode::nalgebra::Vector3;
///
/// // Gravity leaves the angular momentum of a pivoted body about the vertical, and all of a free one's.
/// let weight = Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81))?;
/// assert!(matches!(weight.keeps(true), ConservedMomentum::Along(axis) if axis.z.abs() == 1.0));
/// assert_eq!(weight.keeps(false), ConservedMomentum::All);
/// assert_eq!(ConservedMomentum::All.and(ConservedMomentum::Nothing), ConservedMomentum::Nothing);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConservedMomentum {
    /// All of it: the load has no torque.
    All,
    /// Its component along a unit vector, in N: the torque of a uniform field is across the field.
    Along(Vector3<f64>),
    /// Nothing that is known.
    Nothing,
}

impl ConservedMomentum {
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
pub struct Traits {
    /// Whether it pushes, so that a free body's position depends on it.
    pub exerts_force: bool,
    /// Whether it depends on ω or on the velocity.
    pub depends_on_rates: bool,
    /// Whether it depends on the body it acts on.
    pub needs_body: bool,
    /// Whether it begins with the motion, wherever in time that is.
    pub needs_epoch: bool,
    /// What of the angular momentum about the reference point it leaves as it is.
    pub keeps: ConservedMomentum,
    /// Whether [`Law::add_to`] states it: a method that needs series cannot serve a load without them.
    pub has_series: bool,
}

/// An analytic law of a load: one file each.
pub(super) trait Law: Sized {
    /// What it depends on and does, on a pivoted body or on a free one.
    fn traits(&self, pivoted: bool) -> Traits;

    /// Its numbers. After [`Self::scaled`], they are the scaled values.
    fn parameters(&self) -> Vec<Parameter>;

    /// The law that exerts `factor`, which is finite, times as much.
    ///
    /// # Errors
    /// When a number of it is not finite.
    fn scaled(&self, factor: f64) -> Result<Self, Error>;

    /// The law of a motion that began at `t`, for the rest of it.
    #[must_use]
    fn with_epoch(self, t: f64) -> Self;

    /// The times in a run from one time to another at which it is not smooth, where a step must end; not sorted.
    fn breaks(&self, _from: f64, _to: f64) -> Vec<f64> {
        Vec::new()
    }

    /// Checks that it can act on `body` from one time to another.
    ///
    /// # Errors
    /// When it cannot.
    fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error>;

    /// Force in N and torque in B about the reference point at time `t`.
    fn wrench(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench;

    /// The energy of position that the body has in its field, when it has one: force and torque are what it loses. A law that
    /// depends on time has none.
    fn potential(&self, body: &BodyAtPoint, phase: &Phase) -> Option<f64>;

    /// Adds what it does to the equations of a series, in numbers of any precision; `side` is the sign that the law is taken
    /// for. Which parts ([`SeriesStructure`](super::SeriesStructure)) it adds depends neither on the time nor on the side: the driver has room for those.
    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        side: f64,
    );

    /// Whether its law has a sign that changes with the state.
    fn may_switch(&self) -> bool {
        false
    }

    /// What changes its law at a time and `phase`, for a law that [may switch](Self::may_switch).
    fn switch(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Option<Switch> {
        let _ = (body, t, phase);
        None
    }

    /// As [`Self::wrench`], with the law on one side of its switch.
    fn settled_wrench(&self, side: f64, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        let _ = side;
        self.wrench(body, t, phase)
    }

    /// The function of the attitude (x, y, z, w), linear in it, whose sign the law has.
    fn switch_function<X: LawNumber>(
        &self,
        axes: &PrincipalFrame<'_, X>,
    ) -> Option<nalgebra::Vector4<X>> {
        let _ = axes;
        None
    }

    /// What it carries along in the body. [`Self::wrench`] of a law with states is that where a motion starts.
    fn carried(&self) -> Option<&dyn CarriedMomentum> {
        None
    }
}
