//! The heavy symmetric top about a fixed point on its axis: its motion at any time, in closed form (part II).
//!
//! | file | what it holds |
//! |---|---|
//! | [`pivoted_top`] | which bodies are such tops; steady precession and the sleeping limit |
//! | `reduced` | the state in its own units and axes |
//! | `turning_points` | the cubic of `cos θ` and the distances between what is singular |
//! | `phases` | the steady rates of the phases and the shifts of the theta functions |
//! | `course` | all of these as numbers ready for vector lanes |
//! | `sampling` | the motion at one time or many |
//! | [`nutation`] | limits, period, mean rates and the kind of path |

mod course;
pub mod nutation;
mod phases;
pub mod pivoted_top;
mod reduced;
mod sampling;
mod scaled;
mod source;
#[cfg(test)]
mod tests;
mod turning_points;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::state::{ClosedForm, State};
pub use nutation::{Nutation, Path};
pub use pivoted_top::PivotedTop;
use sampling::Course;

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
    course: Course,
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
        let (course, nutation) = Course::of(top, omega, attitude, gravity);
        Ok(Self { course, nutation })
    }

    /// The state at time `t`; NaN at a time that is not finite, or beyond [`ClosedForm::reach`].
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        let (mut attitude, mut omega) = ([[0.0; 4]], [[0.0; 3]]);
        self.sample(&[t], &mut attitude, &mut omega);
        let [[x, y, z, w]] = attitude;
        State {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
            omega: Vector3::from(omega[0]),
        }
    }

    /// Attitudes as (x, y, z, w) and ω at many times, several side by side; each with the bits of [`HeavyTop::at`].
    ///
    /// Of slices of different lengths the shortest counts.
    pub fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        self.course.sample(times, attitudes, omegas);
    }

    /// How the axis moves.
    #[must_use]
    pub fn nutation(&self) -> &Nutation {
        &self.nutation
    }
}

impl ClosedForm for HeavyTop {
    fn reach(&self) -> f64 {
        self.course.reach
    }

    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        Self::sample(self, times, attitudes, omegas);
    }
}
