//! The motion of a heavy top, made of its state and asked for its states at other times.

use nalgebra::{UnitQuaternion, Vector3};

use super::nutation::Nutation;
use super::pivoted_top::PivotedTop;
use super::propagator::TopConstants;
use crate::error::{Error, all_finite};
use crate::motion::closed_form::{self, ClosedForm};
use crate::motion::state::State;

/// The motion of a heavy symmetric top about a fixed point O on its axis, exact at any time.
///
/// Times count from the state it was made of. What grows with time, three phases and the number of periods, is known to
/// twice the precision, so that a state after 10¹² turns costs as much and is as good as one after the first.
/// Source: part II; F. Klein and A. Sommerfeld, Über die Theorie des Kreisels, chapters IV and VI; E. T. Whittaker,
/// A Treatise on the Analytical Dynamics, §71 to §73.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "Lagrange top")]
#[doc(alias = "spherical pendulum")]
pub struct HeavyTop {
    constants: TopConstants,
    nutation: Nutation,
}

impl HeavyTop {
    /// The top with this state at time zero. `omega`: of B relative to N, components in B. `attitude`: `R_NB`. `gravity`: g, in N.
    ///
    /// The quaternion counts as it is, to its last bit, and is made a unit one in double-double.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn of(
        top: &PivotedTop,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
        gravity: &Vector3<f64>,
    ) -> Result<Self, Error> {
        all_finite("omega", omega)?;
        all_finite("gravity", gravity)?;
        all_finite("attitude", attitude.coords.iter())?;
        let (constants, nutation) = TopConstants::of(top, omega, attitude, gravity);
        Ok(Self {
            constants,
            nutation,
        })
    }

    /// The state at time `t`; NaN at a time that is not finite, or beyond [`ClosedForm::reach`].
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        closed_form::at(&self.constants, t)
    }

    /// Attitudes as (x, y, z, w) and ω at many times, several side by side; each with the bits of [`HeavyTop::at`].
    ///
    /// Of slices of different lengths the shortest counts.
    pub fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        let count = times.len().min(attitudes.len()).min(omegas.len());
        let (attitudes, omegas) = (&mut attitudes[..count], &mut omegas[..count]);
        closed_form::sample(&self.constants, &times[..count], attitudes, omegas);
    }

    /// How the axis moves.
    #[must_use]
    pub fn nutation(&self) -> &Nutation {
        &self.nutation
    }
}

impl ClosedForm for HeavyTop {
    fn reach(&self) -> f64 {
        self.constants.reach
    }

    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        Self::sample(self, times, attitudes, omegas);
    }
}
