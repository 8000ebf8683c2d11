//! A spherical damper: a slug in a viscous fluid.

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, MotionFault, finite};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::carried_momentum::CarriedMomentum;
use crate::motion::loads::carried_momentum::LawContext;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::{InternalState, SeriesTerms};
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::Wrench;
use crate::motion::state::Phase;

/// A sphere that turns in the body with the angular velocity σ (of the sphere relative to N, components in B), slowed by the fluid
/// around it:
///
/// ```text
/// N = k (σ − ω),   J σ̇ + ω × J σ = −k (σ − ω)
/// ```
///
/// J is its moment of inertia, which is not part of the body's. Its states are σ, at the start ω. The momentum `I ω + J σ` is
/// constant where nothing else acts, and the energy falls: a model of what is loose or flexible in the body.
/// Source: Kane, Levinson, Journal of Applied Mechanics 45 (1978) 903; Rahn, Barba, Journal of Guidance 14 (1991) 424.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slug {
    /// J.
    pub inertia: f64,
    /// k: torque over angular velocity.
    pub damping: f64,
}

impl Slug {
    /// Checked numbers.
    ///
    /// # Errors
    /// For a moment that is not positive, for damping that is negative, for what is not finite.
    pub fn new(inertia: f64, damping: f64) -> Result<Self, Error> {
        positive("inertia", inertia)?;
        not_negative("damping", damping)?;
        Ok(Self { inertia, damping })
    }

    /// k (σ − ω).
    #[inline]
    fn drag(&self, omega: &Vector3<f64>, state: &[f64]) -> Vector3<f64> {
        (Vector3::from_column_slice(state) - omega) * self.damping
    }
}

#[cfg(feature = "serde")]
crate::numerics::stored_form::form! {
    Sphere of Slug as it { inertia: f64 = it.inertia, damping: f64 = it.damping }
        => Self::new(it.inertia, it.damping);
}

impl Law for Slug {
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
        vec![
            Parameter::new("inertia", &[]),
            Parameter::new("damping", &[]),
        ]
    }

    fn scaled(&self, _: f64) -> Result<Self, Error> {
        Err(MotionFault::StatesStay { what: "scaled" }.into())
    }

    fn with_epoch(self, _: f64) -> Self {
        self
    }

    fn check(&self, _: &BodyAtPoint, _: f64, _: f64) -> Result<(), Error> {
        Ok(())
    }

    /// At a start: σ = ω.
    fn wrench(&self, _: &BodyAtPoint, _: f64, _: &Phase) -> Wrench {
        Wrench::default()
    }

    /// It takes energy, but without damping.
    fn potential(&self, _: &BodyAtPoint, _: &Phase) -> Option<f64> {
        (self.damping == 0.0).then_some(0.0)
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        let inertia = axes.number(self.inertia, "inertia");
        let damping = axes.number(self.damping, "damping");
        let rate = damping / inertia;
        series.add_on_omega(&Matrix3::from_diagonal_element(-damping));
        let first = series.internal_states.len();
        for component in 0..3 {
            let unit = Vector3::from_fn(|i, _| if i == component { X::one() } else { X::zero() });
            series.internal_states.push(InternalState {
                torque: unit * damping,
                on_itself: -rate,
                on_omega: unit * rate,
                turned: Some((first, component)),
                size: 1.0,
                ..InternalState::default()
            });
        }
    }

    fn carried(&self) -> Option<&dyn CarriedMomentum> {
        Some(self)
    }
}

impl CarriedMomentum for Slug {
    fn count(&self) -> usize {
        3
    }

    fn size(&self) -> f64 {
        1.0
    }

    fn begin(&self, _: f64, omega: &Vector3<f64>) -> Vec<f64> {
        omega.as_slice().to_vec()
    }

    fn beginning(&self, _: f64, _: &Vector3<f64>) -> Vec<(Vector3<f64>, Vec<f64>)> {
        let identity = Matrix3::identity();
        (0..3)
            .map(|i| (identity.column(i).into(), vec![0.0; 2]))
            .collect()
    }

    fn report_states(&self, _: &mut [f64], _: &Vector3<f64>) {}

    fn resume_states(&self, _: &mut [f64], _: f64, _: &Vector3<f64>) {}

    fn turning(&self) -> Option<(Vector3<f64>, f64)> {
        None
    }

    fn torque(
        &self,
        now: &LawContext<'_>,
        state: &[f64],
        rates: Option<&mut [f64]>,
    ) -> Vector3<f64> {
        let (sigma, omega) = (Vector3::from_column_slice(state), &now.phase.omega);
        let drag = self.drag(omega, state);
        if let Some(rates) = rates {
            let rate = -drag / self.inertia - omega.cross(&sigma);
            rates.copy_from_slice(rate.as_slice());
        }
        drag
    }

    fn momentum(&self, state: &[f64], _: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from_column_slice(state) * self.inertia
    }

    fn energy(&self, state: &[f64], _: &Vector3<f64>) -> f64 {
        0.5 * self.inertia * Vector3::from_column_slice(state).norm_squared()
    }
}

/// That a number is positive.
pub(in crate::motion::loads) fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    finite(what, value)?;
    if value > 0.0 {
        return Ok(());
    }
    Err(Error::OutOfDomain {
        what,
        law: "positive",
        value,
    })
}

/// That a number is positive or zero.
pub(super) fn not_negative(what: &'static str, value: f64) -> Result<(), Error> {
    finite(what, value)?;
    if value >= 0.0 {
        return Ok(());
    }
    Err(Error::OutOfDomain {
        what,
        law: "positive or zero",
        value,
    })
}
