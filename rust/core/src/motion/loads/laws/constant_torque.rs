//! A constant torque.

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::kinematics::Frame;
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::{Wrench, in_body, times};
use crate::motion::state::Phase;

/// A torque about the reference point of the motion, constant in `frame`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantTorque {
    /// Its components.
    pub vector: Vector3<f64>,
    /// In which frame they are constant: a torque constant in B turns with the body.
    pub frame: Frame,
}

impl ConstantTorque {
    /// With checked components.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn new(vector: &Vector3<f64>, frame: Frame) -> Result<Self, Error> {
        all_finite("vector", vector)?;
        Ok(Self {
            vector: *vector,
            frame,
        })
    }
}

#[cfg(feature = "serde")]
crate::numerics::stored_form::form! {
    Torque of ConstantTorque as it { vector: [f64; 3] = it.vector.into(), frame: Frame = it.frame }
        => Self::new(&it.vector.into(), it.frame);
}

impl Law for ConstantTorque {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: false,
            needs_body: false,
            needs_epoch: false,
            keeps: ConservedMomentum::Nothing,
            has_series: true,
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("vector", &[3])]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Ok(Self {
            vector: times(&self.vector, factor)?,
            ..*self
        })
    }

    fn with_epoch(self, _: f64) -> Self {
        self
    }

    fn check(&self, _: &BodyAtPoint, _: f64, _: f64) -> Result<(), Error> {
        Ok(())
    }

    fn wrench(&self, _: &BodyAtPoint, _: f64, phase: &Phase) -> Wrench {
        Wrench::couple(in_body(&self.vector, self.frame, &phase.attitude))
    }

    fn potential(&self, _: &BodyAtPoint, _: &Phase) -> Option<f64> {
        None
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        let vector = axes.vector(&self.vector, "vector");
        match self.frame {
            Frame::Body => series.constant += axes.principal(&vector),
            Frame::Space => series.on_space.push((vector, Matrix3::identity())),
        }
    }
}
