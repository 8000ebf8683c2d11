//! What is to be simulated, and how.

use super::method::Method;
use super::tolerance::Tolerance;
use crate::mass::RigidBody;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::Subject;
use crate::motion::state::Phase;

/// A body and the point its motion refers to: what all motions of the body have in common.
#[derive(Clone, Copy, Debug)]
pub struct Footing {
    /// The body and its reference point, as a load sees them.
    pub subject: Subject,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
}

impl Footing {
    /// `body` free, its centre of mass the reference point, from the time `start` on.
    #[must_use]
    pub fn free(body: &RigidBody, start: f64) -> Self {
        Self::of(body, Subject::free(body, start))
    }

    /// `body` with the origin of its frame fixed in N, from the time `start` on.
    #[must_use]
    pub fn pivoted(body: &RigidBody, start: f64) -> Self {
        Self::of(body, Subject::pivoted(body, start))
    }

    fn of(body: &RigidBody, subject: Subject) -> Self {
        Self {
            subject,
            euler: EulerEquations::refined_about(body, &subject.point),
        }
    }
}

/// What is to be simulated: a body from a state through times, and how.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The body.
    pub body: &'a RigidBody,
    /// The body and its reference point, as a load sees them.
    pub subject: Subject,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
    /// The state at the first time.
    pub initial: Phase,
    /// When the state is asked for, the start first; see [`check_times`](super::limits::check_times).
    pub times: &'a [f64],
    /// How.
    pub method: Method,
    /// How accurately.
    pub tolerance: Tolerance,
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
        let footing = Footing::free(body, start);
        Self::on(&footing, body, initial, times, method, tolerance)
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
        let footing = Footing::pivoted(body, start);
        Self::on(&footing, body, initial, times, method, tolerance)
    }

    /// `body` on a footing of its own, which starts at the first time.
    #[must_use]
    pub fn on(
        footing: &Footing,
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        Self {
            body,
            subject: footing.subject,
            euler: footing.euler,
            initial,
            times,
            method,
            tolerance,
        }
    }
}
