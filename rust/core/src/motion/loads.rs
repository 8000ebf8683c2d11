//! What acts on a body: analytic terms, and one external term for what only the caller knows.

use nalgebra::{UnitQuaternion, Vector3};

pub use super::kinematics::Frame;
use crate::error::{Error, all_finite};

/// One analytic term of a load.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Term {
    /// A torque about the reference point of the motion, constant in `frame`.
    ConstantTorque {
        /// Its components.
        vector: Vector3<f64>,
        /// In which frame they are constant: a torque constant in B turns with the body.
        frame: Frame,
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

    /// The torque in B at the attitude `R_NB`.
    #[must_use]
    pub fn torque(&self, attitude: &UnitQuaternion<f64>) -> Vector3<f64> {
        match self {
            Self::ConstantTorque {
                vector,
                frame: Frame::Body,
            } => *vector,
            Self::ConstantTorque {
                vector,
                frame: Frame::Space,
            } => attitude.inverse_transform_vector(vector),
        }
    }
}

/// A torque about the reference point as a function of time and state, whoever computes it.
pub trait Torque {
    /// What may go wrong in it, besides what the equations of motion themselves may refuse.
    type Error: From<Error>;

    /// The torque in B at time `t`, with ω in B and the attitude `R_NB`.
    ///
    /// # Errors
    /// Ends the integration and comes back to the caller as it is.
    fn torque(
        &mut self,
        t: f64,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Vector3<f64>, Self::Error>;
}

/// The sum of analytic terms; empty for a free body.
impl Torque for &[Term] {
    type Error = Error;

    fn torque(
        &mut self,
        _t: f64,
        _omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Vector3<f64>, Error> {
        Ok(self.iter().map(|term| term.torque(attitude)).sum())
    }
}
