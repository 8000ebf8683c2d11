//! The heavy symmetric top about a fixed point on its axis: its motion at any time, in closed form (part II).
//!
//! | file | what it holds |
//! |---|---|
//! | [`pivoted_top`] | which bodies are such tops; steady precession and the sleeping limit |
//! | `reduced` | the state in its own units and axes |
//! | `turning_points` | the cubic of `cos θ` and the distances between what is singular |
//! | `phases` | the steady rates of the phases and the shifts of the theta functions |
//! | `course` | the motion as numbers ready for vector lanes |
//! | [`nutation`] | limits, period, mean rates and the kind of path |

mod course;
pub mod nutation;
mod phases;
pub mod pivoted_top;
mod reduced;
mod turning_points;

use nalgebra::{UnitQuaternion, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::simulate::State;
use course::Course;
pub use nutation::{Nutation, Path};
pub use pivoted_top::PivotedTop;

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

    /// The state at time `t`; NaN at a time that is not finite.
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        let mut state = [State::nan()];
        self.fill(&[t], &mut state);
        state[0]
    }

    /// The states at many times, several side by side.
    pub fn fill(&self, times: &[f64], states: &mut [State]) {
        self.course.fill(times, states);
    }

    /// How the axis moves.
    #[must_use]
    pub fn nutation(&self) -> &Nutation {
        &self.nutation
    }
}
