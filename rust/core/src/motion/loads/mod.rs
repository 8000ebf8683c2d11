//! What acts on a body: a closed set of analytic terms, and a trait for what only the caller knows.
//!
//! | term | law | file |
//! |---|---|---|
//! | constant torque, constant force, uniform gravity | N; `(p − P)×F`; m g at C | [`Term`] |
//! | gravity gradient | `N = 3μ/r⁵ r×(I_C r)` on a Kepler orbit | [`gravity_gradient`], [`kepler`] |
//! | damping | `N = −D ω − E \|ω\| ω` | [`damping`] |
//! | attitude feedback | `N = −K sign(w) vec(q_target⁻¹∘q) − D ω` | [`feedback`] |
//! | a torque sampled in time | cubic spline | [`sampled`] |
//! | any of them on and off | windows of time | [`schedule`] |

pub mod damping;
pub mod feedback;
pub mod gravity_gradient;
pub mod kepler;
pub mod sampled;
pub mod schedule;
mod term;

use nalgebra::{Matrix3, Vector3};
use std::iter::Sum;
use std::ops::{Add, AddAssign};

pub use self::damping::Damping;
pub use self::feedback::{Feedback, Switch};
pub use self::gravity_gradient::GravityGradient;
pub use self::sampled::Sampled;
pub use self::schedule::Windows;
pub use self::term::Term;
pub use super::kinematics::Frame;
use super::state::Phase;
use crate::error::Error;
use crate::mass::RigidBody;

/// A force through the reference point together with a torque about it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Components in N.
    pub force: Vector3<f64>,
    /// Components in B.
    pub torque: Vector3<f64>,
}

impl Wrench {
    /// A torque alone.
    #[must_use]
    pub fn couple(torque: Vector3<f64>) -> Self {
        Self {
            force: Vector3::zeros(),
            torque,
        }
    }
}

impl Add for Wrench {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            force: self.force + other.force,
            torque: self.torque + other.torque,
        }
    }
}

impl AddAssign for Wrench {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for Wrench {
    fn sum<I: Iterator<Item = Self>>(wrenches: I) -> Self {
        wrenches.fold(Self::default(), Add::add)
    }
}

/// What a load acts on: a body, its reference point P, and when the motion starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subject {
    /// m.
    pub mass: f64,
    /// `I_C` in B.
    pub inertia: Matrix3<f64>,
    /// P from the origin of B.
    pub point: Vector3<f64>,
    /// `c_P = C − P`, in B; exactly zero when P is C.
    pub center: Vector3<f64>,
    /// Whether P is fixed in N; else P is C, and the body is free.
    pub pivoted: bool,
    /// The time at which the motion starts.
    pub start: f64,
}

impl Subject {
    /// `body` free, about its centre of mass.
    #[must_use]
    pub fn free(body: &RigidBody, start: f64) -> Self {
        Self {
            mass: body.mass(),
            inertia: body.inertia(),
            point: body.center_of_mass(),
            center: Vector3::zeros(),
            pivoted: false,
            start,
        }
    }

    /// `body` with the origin of its frame fixed in N.
    #[must_use]
    pub fn pivoted(body: &RigidBody, start: f64) -> Self {
        Self {
            point: Vector3::zeros(),
            center: body.center_of_mass(),
            pivoted: true,
            ..Self::free(body, start)
        }
    }
}

/// What of the angular momentum about the reference point a load leaves as it is.
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

    fn along(direction: &Vector3<f64>) -> Self {
        direction.try_normalize(0.0).map_or(Self::All, Self::Along)
    }
}

/// A load as a function of time and state, whoever computes it.
pub trait Load {
    /// What may go wrong in it, besides what the equations of motion themselves may refuse.
    type Error: From<Error>;

    /// Its terms, when it is a sum of analytic terms and nothing else.
    fn analytic(&self) -> Option<&[Term]> {
        None
    }

    /// Whether it may push, so that a free body's position depends on it.
    fn exerts_force(&self) -> bool;

    /// Whether it may depend on ω or on the velocity: whether it can do else than exchange the energy of motion for that of
    /// position.
    fn depends_on_rates(&self) -> bool;

    /// The times at which it is not smooth, where a step must end; in any order.
    fn breaks(&self) -> Vec<f64>;

    /// From now on it is asked for times within from..to alone, both ends included, between which there are no breaks.
    ///
    /// # Errors
    /// When it cannot act there.
    fn enter(&mut self, from: f64, to: f64) -> Result<(), Self::Error>;

    /// From now on its law is the one that it has at `phase`, on both sides of where a sign in it changes, until it is told again: so that
    /// it is smooth over a step. Before it is told for the first time in a span, the law changes with the state.
    fn settle(&mut self, phase: &Phase) {
        let _ = phase;
    }

    /// The signs that it was settled for; none of a law without such signs.
    fn switches(&self) -> Vec<Switch> {
        Vec::new()
    }

    /// Changes its law to that beyond the zero of switch number `index`.
    fn flip(&mut self, index: usize) {
        let _ = index;
    }

    /// Force in N and torque in B about the reference point.
    ///
    /// # Errors
    /// Ends the integration and comes back to the caller as it is.
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Self::Error>;
}

/// A sum of analytic terms that acts on a body; without terms the body is free.
#[derive(Clone, Debug)]
pub struct Analytic<'a> {
    subject: Subject,
    terms: &'a [Term],
    active: Vec<&'a Term>,
    /// One for each feedback among those that act, once they are settled.
    switches: Vec<Switch>,
}

impl<'a> Analytic<'a> {
    /// The sum of `terms` acting on `subject`.
    #[must_use]
    pub fn new(terms: &'a [Term], subject: Subject) -> Self {
        Self {
            subject,
            terms,
            active: terms.iter().collect(),
            switches: Vec::new(),
        }
    }

    /// What it acts on.
    #[must_use]
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// The terms.
    #[must_use]
    pub fn terms(&self) -> &'a [Term] {
        self.terms
    }

    /// The terms that act in the span of time last entered; of scheduled ones what they switch.
    #[must_use]
    pub fn active(&self) -> &[&'a Term] {
        &self.active
    }
}

impl Load for Analytic<'_> {
    type Error = Error;

    fn analytic(&self) -> Option<&[Term]> {
        Some(self.terms)
    }

    fn exerts_force(&self) -> bool {
        self.terms.iter().any(Term::exerts_force)
    }

    fn depends_on_rates(&self) -> bool {
        self.terms.iter().any(Term::depends_on_rates)
    }

    fn breaks(&self) -> Vec<f64> {
        self.terms.iter().flat_map(Term::breaks).collect()
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), Error> {
        let middle = from + 0.5 * (to - from);
        self.active.clear();
        self.switches.clear();
        for term in self.terms.iter().filter_map(|term| term.active(middle)) {
            term.check(&self.subject, from, to)?;
            self.active.push(term);
        }
        Ok(())
    }

    fn settle(&mut self, phase: &Phase) {
        self.switches.clear();
        for term in &self.active {
            if let Term::Feedback(feedback) = term {
                self.switches.push(Switch::of(feedback, phase));
            }
        }
    }

    fn switches(&self) -> Vec<Switch> {
        self.switches.clone()
    }

    fn flip(&mut self, index: usize) {
        self.switches[index].side *= -1.0;
    }

    #[inline]
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Error> {
        let mut switches = self.switches.iter();
        let wrenches = (self.active.iter()).map(|term| match term {
            Term::Feedback(feedback) => Wrench::couple(match switches.next() {
                Some(switch) => feedback.torque_on(switch.side, &phase.attitude, &phase.omega),
                None => feedback.torque(&phase.attitude, &phase.omega),
            }),
            term => term.wrench(&self.subject, t, phase),
        });
        Ok(wrenches.sum())
    }
}
