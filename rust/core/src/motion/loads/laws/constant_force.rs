//! A constant force at a point of the body.

use nalgebra::Vector3;

use crate::error::{Error, all_finite};
use crate::motion::kinematics::Frame;
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::{Wrench, in_body, times};
use crate::motion::state::Phase;
use crate::numerics::quaternion::cross_matrix;

/// A force constant in `frame`, at a point of the body: `N = (p − P)×F` about the reference point P.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantForce {
    /// Its components.
    pub vector: Vector3<f64>,
    /// In which frame they are constant: the thrust of a nozzle turns with the body.
    pub frame: Frame,
    /// Where it acts, from the origin of B; at C where there is none.
    pub point: Option<Vector3<f64>>,
}

impl ConstantForce {
    /// With checked components, at `point` (from the origin of B), or at C.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn new(
        vector: &Vector3<f64>,
        frame: Frame,
        point: Option<&Vector3<f64>>,
    ) -> Result<Self, Error> {
        all_finite("vector", vector)?;
        all_finite("point", point.into_iter().flatten())?;
        Ok(Self {
            vector: *vector,
            frame,
            point: point.copied(),
        })
    }

    /// From the reference point to where it acts.
    fn arm(&self, body: &BodyAtPoint) -> Vector3<f64> {
        (self.point).map_or(body.center, |point| point - body.point)
    }

    /// Whether it may turn a body that is pivoted or free.
    fn turns(&self, pivoted: bool) -> bool {
        pivoted || self.point.is_some()
    }
}

#[cfg(feature = "serde")]
crate::numerics::stored_form::form! {
    Force of ConstantForce as it {
        vector: [f64; 3] = it.vector.into(),
        frame: Frame = it.frame,
        point: Option<[f64; 3]> = it.point.map(Into::into),
    } => {
        let point = it.point.map(|point| crate::numerics::stored_form::vector("point", point)).transpose()?;
        Self::new(&it.vector.into(), it.frame, point.as_ref())
    };
}

impl Law for ConstantForce {
    fn traits(&self, pivoted: bool) -> Traits {
        Traits {
            exerts_force: true,
            depends_on_rates: false,
            needs_body: true,
            needs_epoch: false,
            keeps: match self.frame {
                _ if !self.turns(pivoted) => ConservedMomentum::All,
                Frame::Space => ConservedMomentum::along(&self.vector),
                Frame::Body => ConservedMomentum::Nothing,
            },
            has_series: true,
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = vec![Parameter::new("vector", &[3])];
        if self.point.is_some() {
            parameters.push(Parameter::new("point", &[3]));
        }
        parameters
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

    fn wrench(&self, body: &BodyAtPoint, _: f64, phase: &Phase) -> Wrench {
        let force = match self.frame {
            Frame::Body => phase.attitude * self.vector,
            Frame::Space => self.vector,
        };
        Wrench {
            force,
            torque: (self.arm(body)).cross(&in_body(&self.vector, self.frame, &phase.attitude)),
        }
    }

    /// `−F·r` of a force constant in N at the point r, from the origin of N.
    fn potential(&self, body: &BodyAtPoint, phase: &Phase) -> Option<f64> {
        let place = || phase.position + phase.attitude * self.arm(body);
        (self.frame == Frame::Space).then(|| -self.vector.dot(&place()))
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        let arm = (self.point).map_or(axes.center(), |point| {
            axes.vector(&point, "point") - axes.point()
        });
        let vector = axes.vector(&self.vector, "vector");
        match self.frame {
            Frame::Body => {
                series.constant += axes.principal(&arm.cross(&vector));
                series.add_thrust(&axes.principal(&vector));
            }
            Frame::Space => {
                if self.turns(axes.body.pivoted) {
                    let lever = cross_matrix(&axes.principal(&arm));
                    series.on_space.push((vector, lever));
                }
                series.add_force(&vector);
            }
        }
    }
}
