//! A rotor that keeps its angular momentum in the body: the gyrostat.

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::carried_momentum::CarriedMomentum;
use crate::motion::loads::carried_momentum::LawContext;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::{Wrench, times};
use crate::motion::state::Phase;

/// `N = −ω × h`: what a wheel that turns at constant speed relative to the body does to it, h its momentum relative to the body,
/// constant in B.
///
/// Source: Volterra, Acta Mathematica 22 (1899) 201; Hughes, Spacecraft Attitude Dynamics, §3.5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotor {
    /// h.
    pub momentum: Vector3<f64>,
}

impl Rotor {
    /// A checked momentum.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn new(momentum: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("momentum", momentum)?;
        Ok(Self {
            momentum: *momentum,
        })
    }
}

#[cfg(feature = "serde")]
crate::numerics::stored_form::form! {
    Momentum of Rotor as it { momentum: [f64; 3] = it.momentum.into() }
        => Self::new(&it.momentum.into());
}

impl Law for Rotor {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: true,
            needs_body: false,
            needs_epoch: false,
            keeps: ConservedMomentum::All,
            has_series: true,
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("momentum", &[3])]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        times(&self.momentum, factor).map(|momentum| Self { momentum })
    }

    fn with_epoch(self, _: f64) -> Self {
        self
    }

    fn check(&self, _: &BodyAtPoint, _: f64, _: f64) -> Result<(), Error> {
        Ok(())
    }

    #[inline]
    fn wrench(&self, _: &BodyAtPoint, _: f64, phase: &Phase) -> Wrench {
        Wrench::couple(self.momentum.cross(&phase.omega))
    }

    /// It does no work.
    fn potential(&self, _: &BodyAtPoint, _: &Phase) -> Option<f64> {
        Some(0.0)
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        let [x, y, z] = axes
            .principal(&axes.vector(&self.momentum, "momentum"))
            .into();
        let o = X::zero();
        // h × ω.
        series.add_on_omega(&Matrix3::new(o, -z, y, z, o, -x, -y, x, o));
    }

    fn carried(&self) -> Option<&dyn CarriedMomentum> {
        Some(self)
    }
}

impl CarriedMomentum for Rotor {
    fn count(&self) -> usize {
        0
    }

    fn size(&self) -> f64 {
        0.0
    }

    fn begin(&self, _: f64, _: &Vector3<f64>) -> Vec<f64> {
        Vec::new()
    }

    fn beginning(&self, _: f64, _: &Vector3<f64>) -> Vec<(Vector3<f64>, Vec<f64>)> {
        Vec::new()
    }

    fn report_states(&self, _: &mut [f64], _: &Vector3<f64>) {}

    fn resume_states(&self, _: &mut [f64], _: f64, _: &Vector3<f64>) {}

    fn turning(&self) -> Option<(Vector3<f64>, f64)> {
        None
    }

    fn torque(&self, now: &LawContext<'_>, _: &[f64], _: Option<&mut [f64]>) -> Vector3<f64> {
        self.momentum.cross(&now.phase.omega)
    }

    fn momentum(&self, _: &[f64], _: &Vector3<f64>) -> Vector3<f64> {
        self.momentum
    }

    /// That of a wheel at constant speed Ω is `JΩ a·ω` and a constant; the energy that the motion keeps has neither.
    fn energy(&self, _: &[f64], _: &Vector3<f64>) -> f64 {
        0.0
    }
}
