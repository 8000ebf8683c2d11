//! A term of any law: how it is made, and what follows from its law.

use nalgebra::Vector3;

use super::carried::Carried;
use super::law::Kept;
use super::laws::{ConstantForce, ConstantTorque, Term, UniformGravity};
use super::parameter::Parameter;
use super::schedule::Windows;
use crate::error::{Error, MotionFault};
use crate::motion::kinematics::Frame;

impl Term {
    /// A torque constant in `frame`.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn constant_torque(vector: &Vector3<f64>, frame: Frame) -> Result<Self, Error> {
        ConstantTorque::new(vector, frame).map(Self::from)
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
        ConstantForce::new(vector, frame, point).map(Self::from)
    }

    /// The weight of the body in the field g (in N).
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn uniform_gravity(gravity: &Vector3<f64>) -> Result<Self, Error> {
        UniformGravity::new(gravity).map(Self::from)
    }

    /// The term in `windows` only; of a scheduled one, where both sets of windows are open.
    ///
    /// # Errors
    /// [`MotionFault::StatesStay`] for what the body carries along.
    pub fn scheduled(self, windows: &Windows) -> Result<Self, Error> {
        if self.carried().is_some() {
            return Err(MotionFault::StatesStay { what: "scheduled" }.into());
        }
        Ok(match self {
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
        })
    }

    /// The term as it acts throughout a span of time without breaks around `middle`: nothing where it is switched off,
    /// else never a scheduled one.
    #[must_use]
    pub fn active(&self, middle: f64) -> Option<&Self> {
        match self {
            Self::Scheduled { windows, term } => {
                (windows.contains(middle)).then(|| term.active(middle))?
            }
            law => Some(law),
        }
    }

    /// How many states it has of its own.
    #[must_use]
    pub fn internal_states(&self) -> usize {
        self.carried().map_or(0, Carried::count)
    }

    /// How many numbers it has.
    #[must_use]
    pub fn count(&self) -> usize {
        self.parameters().iter().map(Parameter::count).sum()
    }

    /// Whether it pushes, so that a free body's position depends on it.
    #[must_use]
    pub fn exerts_force(&self) -> bool {
        self.traits(false).exerts_force
    }

    /// Whether it depends on ω or on the velocity.
    #[must_use]
    pub fn depends_on_rates(&self) -> bool {
        self.traits(false).depends_on_rates
    }

    /// Whether it depends on the body it acts on.
    #[must_use]
    pub fn needs_body(&self) -> bool {
        self.traits(false).needs_body
    }

    /// Whether it begins with the motion, wherever in time that is.
    #[must_use]
    pub fn needs_epoch(&self) -> bool {
        self.traits(false).needs_epoch
    }

    /// What of the angular momentum about the reference point it leaves as it is, on a pivoted body or on a free one.
    #[must_use]
    pub fn keeps(&self, pivoted: bool) -> Kept {
        self.traits(pivoted).keeps
    }
}
