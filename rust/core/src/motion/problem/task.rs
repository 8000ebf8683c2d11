//! What is to be simulated, and how.

use super::limits::check_times;
use super::method::Method;
use super::tolerance::Tolerance;
use crate::error::{Error, all_finite};
use crate::mass::RigidBody;
use crate::mass::refined::RefinedPrincipal;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::{BodyAtPoint, Carried};
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
    pub body_without_wheels: Option<Box<RefinedPrincipal>>,
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

    /// `body` on a reference point of its own, which starts at the first time.
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
    /// the load that are not given are what they begin with.
    ///
    /// # Errors
    /// [`MotionFault::WheelsTooHeavy`](crate::error::MotionFault::WheelsTooHeavy).
    pub fn carrying<'c>(
        mut self,
        carried: impl Iterator<Item = &'c dyn Carried>,
    ) -> Result<Self, Error> {
        let carried: Vec<_> = carried.collect();
        if self.initial.internal_state.is_empty() {
            let omega = self.initial.omega;
            let begun = carried
                .iter()
                .flat_map(|it| it.begin(self.times[0], &omega));
            self.initial.internal_state = begun.collect();
        }
        let turning: Vec<_> = carried.iter().filter_map(|it| it.turning()).collect();
        if turning.is_empty() {
            return Ok(self);
        }
        let body_without_wheels =
            RefinedPrincipal::about(self.body, &self.body_at_point.point).without(&turning)?;
        Ok(Self {
            euler: EulerEquations::of_refined(&body_without_wheels),
            body_without_wheels: Some(Box::new(body_without_wheels)),
            ..self
        })
    }
}
