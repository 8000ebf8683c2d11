//! What all motions of a stack have in common, and the method that serves them.

use std::ops::ControlFlow;

use nalgebra::UnitQuaternion;

use super::choose::closed_top;
use crate::error::Error;
use crate::mass::RigidBody;
use crate::motion::loads::Term;
use crate::motion::problem::{Footing, Method, Task, Tolerance, check_scales};
use crate::motion::state::Phase;

/// Asked now and then whether to go on, with the fraction done where that is known.
pub type Ask<'a> = dyn Fn(Option<f64>) -> ControlFlow<()> + Sync + 'a;

/// Motions of bodies through the same times, by a method that serves them all.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    bodies: &'a [RigidBody],
    pivoted: bool,
    times: &'a [f64],
    method: Method,
    tolerance: Tolerance,
}

/// Why motions are not begun.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The number of the body that is at fault, where it is one of them.
    pub body: Option<usize>,
    /// What is wrong.
    pub error: Error,
}

impl<'a> Plan<'a> {
    /// Motions of `bodies`, all of them free or all with their origin fixed, by `method` or what [`Method::Auto`] chooses.
    ///
    /// `terms`: of the load on one of them, where all loads have analytic terms alone, of the same kinds. When `watch` says so while
    /// bodies are looked through, it is as if they had no closed form.
    ///
    /// # Errors
    /// When the method cannot serve, and for the first body whose equations of motion leave the range of float64.
    pub fn new(
        bodies: &'a [RigidBody],
        pivoted: bool,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
        terms: Option<&[Term]>,
        watch: &Ask<'_>,
    ) -> Result<Self, Refusal> {
        let are_tops =
            || (bodies.iter()).all(|body| watch(None).is_continue() && closed_top(body).is_ok());
        let method = method
            .serving(pivoted, terms, &tolerance, are_tops)
            .map_err(|error| Refusal { body: None, error })?;
        if method != Method::Exact {
            for (number, body) in bodies.iter().enumerate() {
                check_scales(body, pivoted, times).map_err(|error| Refusal {
                    body: Some(number),
                    error,
                })?;
            }
        }
        Ok(Self {
            bodies,
            pivoted,
            times,
            method,
            tolerance,
        })
    }

    /// Whether the origins of the bodies are fixed.
    #[must_use]
    pub fn pivoted(&self) -> bool {
        self.pivoted
    }

    /// When the states are asked for.
    #[must_use]
    pub fn times(&self) -> &'a [f64] {
        self.times
    }

    /// The method that serves them.
    #[must_use]
    pub fn method(&self) -> Method {
        self.method
    }

    /// The footing of the body, where there is one alone: its rows share it.
    pub(super) fn common(&self) -> Option<Footing> {
        match self.bodies {
            [body] => Some(self.footing(body)),
            _ => None,
        }
    }

    fn footing(&self, body: &RigidBody) -> Footing {
        let start = self.times.first().copied().unwrap_or_default();
        if self.pivoted {
            Footing::pivoted(body, start)
        } else {
            Footing::free(body, start)
        }
    }

    /// What is to be simulated of body number `body` from `given` on, whose attitude is of unit length to rounding alone.
    pub(super) fn task(&self, common: Option<&Footing>, body: usize, given: Phase) -> Task<'a> {
        let body = &self.bodies[body];
        // To these the attitude says more than its rounded length does.
        let is_exact =
            self.method == Method::Exact && self.pivoted || self.tolerance.is_beyond_doubles();
        let initial = Phase {
            attitude: if is_exact {
                given.attitude
            } else {
                UnitQuaternion::new_normalize(given.attitude.into_inner())
            },
            ..given
        };
        let footing = match common {
            Some(footing) => footing,
            None => &self.footing(body),
        };
        Task::on(
            footing,
            body,
            initial,
            self.times,
            self.method,
            self.tolerance,
        )
    }
}
