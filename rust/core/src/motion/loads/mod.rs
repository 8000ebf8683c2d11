//! What acts on a body: a closed set of analytic terms, and a trait for what only the caller knows.
//!
//! | term | law | file |
//! |---|---|---|
//! | constant torque, constant force, uniform gravity | N; `(p − P)×F`; m g at C | here |
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

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::iter::Sum;
use std::ops::{Add, AddAssign};

pub use self::damping::Damping;
pub use self::feedback::Feedback;
pub use self::gravity_gradient::GravityGradient;
pub use self::sampled::Sampled;
pub use self::schedule::Windows;
pub use super::kinematics::Frame;
use super::state::Phase;
use crate::error::{Error, all_finite, finite};
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

/// One analytic term of a load.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Term {
    /// A torque about the reference point of the motion, constant in `frame`.
    ConstantTorque {
        /// Its components.
        vector: Vector3<f64>,
        /// In which frame they are constant: a torque constant in B turns with the body.
        frame: Frame,
    },
    /// A force constant in `frame`, at a point of the body.
    ConstantForce {
        /// Its components.
        vector: Vector3<f64>,
        /// In which frame they are constant: the thrust of a nozzle turns with the body.
        frame: Frame,
        /// Where it acts, from the origin of B; at C where there is none.
        point: Option<Vector3<f64>>,
    },
    /// The weight m g at C.
    UniformGravity {
        /// g, in N.
        gravity: Vector3<f64>,
    },
    /// The torque of a distant attractor's field on a body in a Kepler orbit.
    GravityGradient(GravityGradient),
    /// A torque against ω.
    Damping(Damping),
    /// A torque known at some times.
    Sampled(Sampled),
    /// A torque that turns the body toward an attitude.
    Feedback(Feedback),
    /// A term that acts in some windows of time only.
    Scheduled {
        /// When.
        windows: Windows,
        /// Which.
        term: Box<Term>,
    },
}

impl Term {
    /// A torque constant in `frame`.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn constant_torque(vector: &Vector3<f64>, frame: Frame) -> Result<Self, Error> {
        all_finite("vector", vector)?;
        Ok(Self::ConstantTorque {
            vector: *vector,
            frame,
        })
    }

    /// A force constant in `frame` at `point` (from the origin of B), or at C.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn constant_force(
        vector: &Vector3<f64>,
        frame: Frame,
        point: Option<&Vector3<f64>>,
    ) -> Result<Self, Error> {
        all_finite("vector", vector)?;
        all_finite("point", point.into_iter().flatten())?;
        Ok(Self::ConstantForce {
            vector: *vector,
            frame,
            point: point.copied(),
        })
    }

    /// The weight of the body in the field g (in N).
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn uniform_gravity(gravity: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("gravity", gravity)?;
        Ok(Self::UniformGravity { gravity: *gravity })
    }

    /// The term that exerts `factor` times as much.
    ///
    /// # Errors
    /// When `factor` or what it makes is not finite.
    pub fn scaled(&self, factor: f64) -> Result<Self, Error> {
        finite("the factor of a load", factor)?;
        let times = |vector: &Vector3<f64>| {
            let product = vector * factor;
            all_finite("the load times its factor", &product).map(|()| product)
        };
        Ok(match self {
            Self::ConstantTorque { vector, frame } => Self::ConstantTorque {
                vector: times(vector)?,
                frame: *frame,
            },
            Self::ConstantForce {
                vector,
                frame,
                point,
            } => Self::ConstantForce {
                vector: times(vector)?,
                frame: *frame,
                point: *point,
            },
            Self::UniformGravity { gravity } => Self::UniformGravity {
                gravity: times(gravity)?,
            },
            Self::GravityGradient(term) => Self::GravityGradient(term.scaled(factor)),
            Self::Damping(term) => Self::Damping(term.scaled(factor)?),
            Self::Sampled(term) => Self::Sampled(term.scaled(factor)?),
            Self::Feedback(term) => Self::Feedback(term.scaled(factor)?),
            Self::Scheduled { windows, term } => Self::Scheduled {
                windows: windows.clone(),
                term: Box::new(term.scaled(factor)?),
            },
        })
    }

    /// The term in `windows` only; of a scheduled one, where both sets of windows are open.
    #[must_use]
    pub fn scheduled(self, windows: &Windows) -> Self {
        match self {
            Self::Scheduled {
                windows: own,
                term: inner,
            } => Self::Scheduled {
                windows: own.within(windows),
                term: inner,
            },
            term => Self::Scheduled {
                windows: windows.clone(),
                term: Box::new(term),
            },
        }
    }

    /// Whether it pushes, so that a free body's position depends on it.
    #[must_use]
    pub fn exerts_force(&self) -> bool {
        match self {
            Self::ConstantForce { .. } | Self::UniformGravity { .. } => true,
            Self::Scheduled { term, .. } => term.exerts_force(),
            _ => false,
        }
    }

    /// The times at which it is not smooth, where a step must end; not sorted.
    #[must_use]
    pub fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Sampled(sampled) => sampled.knots().to_vec(),
            Self::Scheduled { windows, term } => {
                let mut breaks = windows.switches();
                breaks.extend(term.breaks());
                breaks
            }
            _ => Vec::new(),
        }
    }

    /// The term as it acts throughout a span of time without breaks around `middle`: nothing where it is switched off,
    /// else never a scheduled one.
    #[must_use]
    pub fn active(&self, middle: f64) -> Option<&Self> {
        match self {
            Self::Scheduled { windows, term } => {
                (windows.contains(middle)).then(|| term.active(middle))?
            }
            _ => Some(self),
        }
    }

    /// Checks that the term, which is not a scheduled one, can act on `subject` from one time to another.
    ///
    /// # Errors
    /// [`Error::OutsideSamples`]; [`Error::PivotedInOrbit`].
    pub fn check(&self, subject: &Subject, from: f64, to: f64) -> Result<(), Error> {
        match self {
            Self::Sampled(sampled) => sampled.check(from).and_then(|()| sampled.check(to)),
            Self::GravityGradient(_) if subject.pivoted => Err(Error::PivotedInOrbit),
            _ => Ok(()),
        }
    }

    /// Force in N and torque in B about the reference point at time `t`. A scheduled term counts as switched on or off by
    /// the time; in a run by [`Term::active`].
    #[must_use]
    pub fn wrench(&self, subject: &Subject, t: f64, phase: &Phase) -> Wrench {
        let attitude = &phase.attitude;
        match self {
            Self::ConstantTorque { vector, frame } => {
                Wrench::couple(in_body(vector, *frame, attitude))
            }
            Self::ConstantForce {
                vector,
                frame,
                point,
            } => {
                let arm = point.map_or(subject.center, |point| point - subject.point);
                let force = match frame {
                    Frame::Body => attitude * vector,
                    Frame::Space => *vector,
                };
                Wrench {
                    force,
                    torque: arm.cross(&in_body(vector, *frame, attitude)),
                }
            }
            Self::UniformGravity { gravity } => {
                let weight = gravity * subject.mass;
                Wrench {
                    force: weight,
                    torque: (subject.center).cross(&attitude.inverse_transform_vector(&weight)),
                }
            }
            Self::GravityGradient(term) => Wrench::couple(term.torque(subject, t, attitude)),
            Self::Damping(damping) => Wrench::couple(damping.torque(&phase.omega)),
            Self::Sampled(sampled) => {
                Wrench::couple(in_body(&sampled.at(t), sampled.frame(), attitude))
            }
            Self::Feedback(feedback) => Wrench::couple(feedback.torque(attitude, &phase.omega)),
            Self::Scheduled { windows, term } => {
                if windows.contains(t) {
                    term.wrench(subject, t, phase)
                } else {
                    Wrench::default()
                }
            }
        }
    }

    /// The energy of position that the body has in the term's field, when it has one: force and torque are what it loses.
    ///
    /// `−m g·r_C` in uniform gravity, `−F·r` of a force constant in N at a point r, and that of [`Feedback::potential`]
    /// without damping. Positions from the origin of N. A term that depends on time has none.
    #[must_use]
    pub fn potential(&self, subject: &Subject, phase: &Phase) -> Option<f64> {
        let place = |arm: &Vector3<f64>| phase.position + phase.attitude * arm;
        match self {
            Self::UniformGravity { gravity } => {
                Some(-subject.mass * gravity.dot(&place(&subject.center)))
            }
            Self::ConstantForce {
                vector,
                frame: Frame::Space,
                point,
            } => {
                let arm = point.map_or(subject.center, |point| point - subject.point);
                Some(-vector.dot(&place(&arm)))
            }
            Self::Feedback(feedback) => feedback.potential(&phase.attitude),
            _ => None,
        }
    }
}

/// A vector constant in `frame`, components in B.
#[inline]
fn in_body(vector: &Vector3<f64>, frame: Frame, attitude: &UnitQuaternion<f64>) -> Vector3<f64> {
    match frame {
        Frame::Body => *vector,
        Frame::Space => attitude.inverse_transform_vector(vector),
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

    /// The times at which it is not smooth, where a step must end; in any order.
    fn breaks(&self) -> Vec<f64>;

    /// From now on it is asked for times within from..to alone, both ends included, between which there are no breaks.
    ///
    /// # Errors
    /// When it cannot act there.
    fn enter(&mut self, from: f64, to: f64) -> Result<(), Self::Error>;

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
}

impl<'a> Analytic<'a> {
    /// The sum of `terms` acting on `subject`.
    #[must_use]
    pub fn new(terms: &'a [Term], subject: Subject) -> Self {
        Self {
            subject,
            terms,
            active: terms.iter().collect(),
        }
    }

    /// What it acts on.
    #[must_use]
    pub fn subject(&self) -> &Subject {
        &self.subject
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

    fn breaks(&self) -> Vec<f64> {
        self.terms.iter().flat_map(Term::breaks).collect()
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), Error> {
        let middle = from + 0.5 * (to - from);
        self.active.clear();
        for term in self.terms.iter().filter_map(|term| term.active(middle)) {
            term.check(&self.subject, from, to)?;
            self.active.push(term);
        }
        Ok(())
    }

    #[inline]
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Error> {
        let wrenches = self
            .active
            .iter()
            .map(|term| term.wrench(&self.subject, t, phase));
        Ok(wrenches.sum())
    }
}
