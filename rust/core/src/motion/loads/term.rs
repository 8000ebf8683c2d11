//! The analytic terms of loads, and what each of them is asked.

use nalgebra::{UnitQuaternion, Vector3};

use super::{Damping, Feedback, Frame, GravityGradient, Kept, Sampled, Subject, Windows, Wrench};
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::motion::state::Phase;

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

    /// Whether it depends on ω or on the velocity.
    #[must_use]
    pub fn depends_on_rates(&self) -> bool {
        match self {
            Self::Damping(_) => true,
            Self::Feedback(feedback) => feedback.damping.iter().any(|&x| x != 0.0),
            Self::Scheduled { term, .. } => term.depends_on_rates(),
            _ => false,
        }
    }

    /// Whether it depends on the body it acts on.
    #[must_use]
    pub fn needs_body(&self) -> bool {
        match self {
            Self::ConstantForce { .. } | Self::UniformGravity { .. } | Self::GravityGradient(_) => {
                true
            }
            Self::Scheduled { term, .. } => term.needs_body(),
            _ => false,
        }
    }

    /// Whether it begins with the motion, wherever in time that is.
    #[must_use]
    pub fn needs_epoch(&self) -> bool {
        match self {
            Self::GravityGradient(term) => term.needs_epoch(),
            Self::Scheduled { term, .. } => term.needs_epoch(),
            _ => false,
        }
    }

    /// The term of a motion that began at `t`, for the rest of it.
    #[must_use]
    pub fn anchored(self, t: f64) -> Self {
        match self {
            Self::GravityGradient(term) => Self::GravityGradient(term.anchored(t)),
            Self::Scheduled { windows, term } => Self::Scheduled {
                windows,
                term: Box::new(term.anchored(t)),
            },
            term => term,
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
    /// [`MotionFault::OutsideSamples`]; [`MotionFault::PivotedInOrbit`].
    pub fn check(&self, subject: &Subject, from: f64, to: f64) -> Result<(), Error> {
        match self {
            Self::Sampled(sampled) => sampled.check(from).and_then(|()| sampled.check(to)),
            Self::GravityGradient(_) if subject.pivoted => Err(MotionFault::PivotedInOrbit.into()),
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

    /// What of the angular momentum about the reference point it leaves as it is, on a pivoted body or on a free one.
    #[must_use]
    pub fn keeps(&self, pivoted: bool) -> Kept {
        match self {
            Self::UniformGravity { gravity } if pivoted => Kept::along(gravity),
            Self::UniformGravity { .. } => Kept::All,
            Self::ConstantForce { point: None, .. } if !pivoted => Kept::All,
            Self::ConstantForce {
                vector,
                frame: Frame::Space,
                ..
            } => Kept::along(vector),
            Self::Scheduled { term, .. } => term.keeps(pivoted),
            _ => Kept::Nothing,
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
