//! A medium that slows the body down.

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::series_terms::{OMEGA, Steps};
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::Wrench;
use crate::motion::state::Phase;

/// `N = −D ω − E |ω| ω`: linear damping, as of a viscous film, and quadratic, as of a stirred fluid.
///
/// D and E in B; ω of B relative to N, components in B. N about the reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping {
    /// D: torque over angular velocity.
    pub linear: Matrix3<f64>,
    /// E: torque over angular velocity squared.
    pub quadratic: Matrix3<f64>,
}

impl Damping {
    /// Checked matrices.
    ///
    /// # Errors
    /// When an element is not finite.
    pub fn new(linear: &Matrix3<f64>, quadratic: &Matrix3<f64>) -> Result<Self, Error> {
        all_finite("matrix", linear)?;
        all_finite("quadratic", quadratic)?;
        Ok(Self {
            linear: *linear,
            quadratic: *quadratic,
        })
    }

    /// `−D ω − E |ω| ω`.
    #[inline]
    #[must_use]
    pub fn torque(&self, omega: &Vector3<f64>) -> Vector3<f64> {
        -(self.linear * omega + self.quadratic * (omega * omega.norm()))
    }

    /// [`Self::torque`] with ω in registers. Loaded from memory, two of its numbers at a time would have to wait for the two
    /// stores that they have just come from.
    #[inline(never)]
    fn wrench_at(&self, x: f64, y: f64, z: f64) -> Wrench {
        Wrench::couple(self.torque(&Vector3::new(x, y, z)))
    }
}

#[cfg(feature = "serde")]
crate::numerics::stored_form::form! {
    Damper of Damping as it { linear: crate::numerics::stored_form::Rows = crate::numerics::stored_form::rows(&it.linear), quadratic: crate::numerics::stored_form::Rows = crate::numerics::stored_form::rows(&it.quadratic) }
        => Self::new(&crate::numerics::stored_form::matrix(&it.linear), &crate::numerics::stored_form::matrix(&it.quadratic));
}

impl Law for Damping {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: true,
            needs_body: false,
            needs_epoch: false,
            keeps: ConservedMomentum::Nothing,
            has_series: true,
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::new("matrix", &[3, 3]),
            Parameter::new("quadratic", &[3, 3]),
        ]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Self::new(&(self.linear * factor), &(self.quadratic * factor))
    }

    fn with_epoch(self, _: f64) -> Self {
        self
    }

    fn check(&self, _: &BodyAtPoint, _: f64, _: f64) -> Result<(), Error> {
        Ok(())
    }

    // Out of line in every build: where it is inlined, ω is loaded as other laws need it.
    #[inline(never)]
    fn wrench(&self, _: &BodyAtPoint, _: f64, phase: &Phase) -> Wrench {
        let omega = &phase.omega;
        self.wrench_at(omega.x, omega.y, omega.z)
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
        series.add_on_omega(&-axes.tensor(&axes.matrix(&self.linear, "matrix")));
        if self.quadratic != Matrix3::zeros() || axes.varies("quadratic") {
            let mut steps = Steps::default();
            let speed = steps.speed();
            let vector = steps.times(speed, OMEGA);
            let matrix = -axes.tensor(&axes.matrix(&self.quadratic, "quadratic"));
            series.formulas.push(steps.torque(matrix, vector));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_laws() {
        let damping = Damping::new(&Matrix3::from_diagonal_element(0.5), &Matrix3::identity());
        let torque = damping
            .expect("finite")
            .torque(&Vector3::new(3.0, 0.0, 4.0));
        assert_eq!(torque, Vector3::new(-16.5, 0.0, -22.0));
    }
}
