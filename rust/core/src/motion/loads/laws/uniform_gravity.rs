//! Weight in a uniform field.

use nalgebra::Vector3;

use crate::error::{Error, all_finite};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::{Wrench, times};
use crate::motion::state::Phase;
use crate::numerics::quaternion::cross_matrix;

/// The weight m g at C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformGravity {
    /// g, in N.
    pub gravity: Vector3<f64>,
}

impl UniformGravity {
    /// In the field g (in N).
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn new(gravity: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("gravity", gravity)?;
        Ok(Self { gravity: *gravity })
    }
}

#[cfg(feature = "serde")]
crate::numerics::stored_form::form! {
    Gravity of UniformGravity as it { gravity: [f64; 3] = it.gravity.into() }
        => Self::new(&it.gravity.into());
}

impl Law for UniformGravity {
    fn traits(&self, pivoted: bool) -> Traits {
        Traits {
            exerts_force: true,
            depends_on_rates: false,
            needs_body: true,
            needs_epoch: false,
            keeps: if pivoted {
                ConservedMomentum::along(&self.gravity)
            } else {
                ConservedMomentum::All
            },
            has_series: true,
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("gravity", &[3])]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Ok(Self {
            gravity: times(&self.gravity, factor)?,
        })
    }

    fn with_epoch(self, _: f64) -> Self {
        self
    }

    fn check(&self, _: &BodyAtPoint, _: f64, _: f64) -> Result<(), Error> {
        Ok(())
    }

    fn wrench(&self, body: &BodyAtPoint, _: f64, phase: &Phase) -> Wrench {
        let weight = self.gravity * body.mass;
        let in_body = phase.attitude.inverse_transform_vector(&weight);
        Wrench {
            force: weight,
            torque: body.center.cross(&in_body),
        }
    }

    /// `−m g·r_C`, from the origin of N.
    fn potential(&self, body: &BodyAtPoint, phase: &Phase) -> Option<f64> {
        let place = phase.position + phase.attitude * body.center;
        Some(-body.mass * self.gravity.dot(&place))
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        let (gravity, mass) = (axes.vector(&self.gravity, "gravity"), axes.mass());
        if axes.body.pivoted {
            let lever = axes.center() * mass;
            let lever = cross_matrix(&axes.principal(&lever));
            series.on_space.push((gravity, lever));
        }
        series.add_force(&(gravity * mass));
    }
}
