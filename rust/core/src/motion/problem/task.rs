//! What is to be simulated, by which method and how accurately.

use std::sync::Arc;

use super::limits::{MOST_STEPS, check_times};
use crate::error::{Error, all_finite, finite};
use crate::mass::RigidBody;
use crate::mass::refined::RefinedPrincipal;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::{BodyAtPoint, CarriedMomentum};
use crate::motion::state::Phase;

/// A body and the point its motion refers to: what all motions of the body have in common.
#[derive(Clone, Copy, Debug)]
pub struct ReferencePoint {
    /// The body and its reference point, as a load sees them.
    pub body_at_point: BodyAtPoint,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
}

impl ReferencePoint {
    /// `body` free, its centre of mass the reference point, from the time `start` on.
    #[must_use]
    pub fn free(body: &RigidBody, start: f64) -> Self {
        Self::of(body, BodyAtPoint::free(body, start))
    }

    /// `body` with the origin of its frame fixed in N, from the time `start` on.
    #[must_use]
    pub fn pivoted(body: &RigidBody, start: f64) -> Self {
        Self::of(body, BodyAtPoint::pivoted(body, start))
    }

    fn of(body: &RigidBody, body_at_point: BodyAtPoint) -> Self {
        Self {
            euler: EulerEquations::refined_about(body, &body_at_point.point),
            body_at_point,
        }
    }
}

/// What is to be simulated: a body from a state through times, and how.
#[derive(Clone, Debug)]
pub struct Task<'a> {
    /// The body.
    pub body: &'a RigidBody,
    /// The body and its reference point, as a load sees them.
    pub body_at_point: BodyAtPoint,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
    /// The state at the first time.
    pub initial: Phase,
    /// When the state is asked for, the start first; see [`check_times`].
    pub times: &'a [f64],
    /// How.
    pub method: Method,
    /// How accurately.
    pub tolerance: Tolerance,
    /// Principal moments and axes about the reference point of a body whose wheels turn freely, without what turns.
    pub body_without_wheels: Option<Arc<RefinedPrincipal>>,
}

impl<'a> Task<'a> {
    /// `body` free, its centre of mass the reference point.
    #[must_use]
    pub fn free(
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        let start = times.first().copied().unwrap_or_default();
        let reference_point = ReferencePoint::free(body, start);
        Self::about(&reference_point, body, initial, times, method, tolerance)
    }

    /// `body` with the origin of its frame fixed in N.
    #[must_use]
    pub fn pivoted(
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        let start = times.first().copied().unwrap_or_default();
        let reference_point = ReferencePoint::pivoted(body, start);
        Self::about(&reference_point, body, initial, times, method, tolerance)
    }

    /// `body` about a reference point; the motion starts at the first time.
    #[must_use]
    pub fn about(
        reference_point: &ReferencePoint,
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        Self {
            body,
            body_at_point: reference_point.body_at_point,
            euler: reference_point.euler,
            initial,
            times,
            method,
            tolerance,
            body_without_wheels: None,
        }
    }

    /// Checks the times, and that the state at the first of them is one.
    ///
    /// # Errors
    /// As [`check_times`], and where a number of the state is not finite; a pivoted body needs neither position nor velocity.
    pub(in crate::motion) fn check_start(&self) -> Result<(), Error> {
        check_times(self.times)?;
        let Phase {
            attitude,
            omega,
            position,
            velocity,
            internal_state,
        } = &self.initial;
        all_finite("attitude", &attitude.coords)?;
        all_finite("omega", omega)?;
        if !self.body_at_point.pivoted {
            all_finite("position", position)?;
            all_finite("velocity", velocity)?;
        }
        all_finite("the states of the load", internal_state)
    }

    /// The task of a body that carries this along: its equations are those of the body without the wheels that turn freely. States of
    /// the load that are not given are what they begin with. A task that has these equations already keeps them.
    ///
    /// # Errors
    /// [`MotionFault::WheelsTooHeavy`](crate::error::MotionFault::WheelsTooHeavy).
    pub fn with_carried<'c>(
        mut self,
        carried: impl Iterator<Item = &'c dyn CarriedMomentum>,
    ) -> Result<Self, Error> {
        let carried: Vec<_> = carried.collect();
        if self.initial.internal_state.is_empty() {
            let omega = self.initial.omega;
            let begun = carried
                .iter()
                .flat_map(|it| it.begin(self.times[0], &omega));
            self.initial.internal_state = begun.collect();
        }
        if self.body_without_wheels.is_some() {
            return Ok(self);
        }
        let turning: Vec<_> = carried.iter().filter_map(|it| it.turning()).collect();
        if turning.is_empty() {
            return Ok(self);
        }
        let body_without_wheels =
            RefinedPrincipal::about(self.body, &self.body_at_point.point).without(&turning)?;
        Ok(Self {
            euler: EulerEquations::of_refined(&body_without_wheels),
            body_without_wheels: Some(Arc::new(body_without_wheels)),
            ..self
        })
    }
}

/// How a motion is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The first of exact, Taylor and DOP853 that can serve the run.
    #[default]
    Auto,
    /// In closed form: a free body without a load, and a symmetric top pivoted on its axis under uniform gravity.
    Exact,
    /// Taylor series of the order at which the work is least: analytic loads. At tolerances that doubles cannot serve in numbers
    /// of twice their precision.
    Taylor,
    /// The explicit Runge-Kutta method of order 8 by Dormand and Prince: every load.
    Dop853,
    /// The implicit Runge-Kutta method Radau IIA of order 5: every load, for those that are stiff.
    Radau,
    /// Kicks between exact free motions at equal steps: loads that do not depend on rates, for long times.
    Splitting,
}

impl Method {
    /// Every method, in the order of this page.
    ///
    /// ```
    /// use polhode::motion::simulate::Method;
    ///
    /// let named = |name| Method::ALL.iter().find(|method| method.name() == name);
    /// assert_eq!(named("radau"), Some(&Method::Radau));
    /// assert_eq!(named("euler"), None);
    /// ```
    pub const ALL: &'static [Self] = &[
        Self::Auto,
        Self::Exact,
        Self::Taylor,
        Self::Dop853,
        Self::Radau,
        Self::Splitting,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Exact => "exact",
            Self::Taylor => "taylor",
            Self::Dop853 => "dop853",
            Self::Radau => "radau",
            Self::Splitting => "splitting",
        }
    }
}

/// The tightest relative tolerance that float64 can serve.
pub const TIGHTEST: f64 = 10.0 * f64::EPSILON;
/// The tightest relative tolerance that numbers of twice the precision can serve.
pub const TIGHTEST_TWOFOLD: f64 = 1e-28;

/// How accurate each step is to be, and how many there may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the attitude in radians (half), and of ω, position and velocity relative to the largest so far.
    pub relative: f64,
    /// Of ω, added to the relative one.
    pub absolute: f64,
    /// Steps of a run at most, [`MOST_STEPS`] or fewer.
    pub most_steps: u64,
}

impl Tolerance {
    /// Checked tolerances.
    ///
    /// # Errors
    /// When `relative` is not within [`TIGHTEST_TWOFOLD`]..0.1 or `absolute` is negative.
    pub fn new(relative: f64, absolute: f64) -> Result<Self, Error> {
        finite("rtol", relative)?;
        finite("atol", absolute)?;
        if !(TIGHTEST_TWOFOLD..=0.1).contains(&relative) {
            let law = "between 1e-28 and 0.1; below 2.3e-15 (ten units of rounding) the method \"taylor\" alone serves it";
            return Err(Error::OutOfDomain {
                what: "rtol",
                law,
                value: relative,
            });
        }
        if absolute < 0.0 {
            return Err(Error::OutOfDomain {
                what: "atol",
                law: "zero or more",
                value: absolute,
            });
        }
        Ok(Self {
            relative,
            absolute,
            most_steps: MOST_STEPS,
        })
    }

    /// The same with fewer steps at most.
    #[must_use]
    #[inline]
    pub fn within(self, most_steps: u64) -> Self {
        Self {
            most_steps: most_steps.min(MOST_STEPS),
            ..self
        }
    }

    /// Whether it is tighter than doubles can serve.
    #[must_use]
    #[inline]
    pub fn is_beyond_doubles(&self) -> bool {
        self.relative < TIGHTEST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_serve_down_to_the_tightest() {
        let is_beyond =
            |relative| Tolerance::new(relative, 0.0).map(|found| found.is_beyond_doubles());
        assert_eq!(is_beyond(TIGHTEST), Ok(false));
        assert_eq!(is_beyond(0.999 * TIGHTEST), Ok(true));
        assert!(is_beyond(0.999 * TIGHTEST_TWOFOLD).is_err());
    }
}
