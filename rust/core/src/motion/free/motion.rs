//! A free motion from its start, and the states at any time.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::mode::Mode;
use super::propagator::Propagator;
use super::propagator::Secular;
use super::separation::Separation;
use super::steady_or_symmetric;
use super::tumbling::TumblingMotion;
use crate::error::{Error, all_finite};
use crate::mass::RigidBody;
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::motion::closed_form::{self, ClosedForm};
use crate::motion::state::State;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::power_below;

/// The motion of a body on which no torque acts about its centre of mass, from its state at t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "Euler top")]
pub struct FreeMotion {
    /// How the body moves.
    pub mode: Mode,
    /// The state at t = 0.
    pub initial: State,
    /// Principal moments, ascending, to twice the precision.
    pub moments: [DoubleDouble; 3],
    /// The principal axes as columns, components in B.
    pub axes: Matrix3<f64>,
    /// ω at t = 0 along the principal axes.
    pub principal_omega: [DoubleDouble; 3],
    /// The constants of the theta functions.
    pub secular: Secular,
    pub(super) separation: Separation,
    pub(super) propagator: Propagator,
}

impl FreeMotion {
    /// From ω (of B relative to N, components in B) and attitude at t = 0, about the centre of mass.
    ///
    /// # Errors
    /// [`Error::NonFinite`] when `omega` is not finite.
    pub fn of(
        body: &RigidBody,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Self, Error> {
        Self::from_refined(&RefinedPrincipal::of(body), omega, attitude)
    }

    /// As [`Self::of`], for principal moments and axes already refined: many states of one body.
    ///
    /// # Errors
    /// [`Error::NonFinite`] when `omega` is not finite.
    pub fn from_refined(
        principal: &RefinedPrincipal,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Self, Error> {
        all_finite("omega", omega)?;
        let initial = State {
            attitude: *attitude,
            omega: *omega,
        };
        let axes = principal.rounded_axes();
        // Products of ratios alone: powers of two bring the largest moment and rate near one.
        let inertia_unit = power_below(principal.moments[2].high);
        let rate_unit = power_below(omega.amax());
        let moments = (principal.moments).map(|moment| moment.scaled(1.0 / inertia_unit));
        let scaled_omega = omega / rate_unit;
        let mut w = principal.components(&scaled_omega);
        let mut separation = Separation::of(&moments, &w);

        let [i1, i2, i3] = moments;
        let is_steady = |w: &Vector| w.iter().filter(|rate| rate.high == 0.0).count() >= 2;
        let (mode, (propagator, secular)) = if i1 == i3 {
            (
                Mode::Spherical,
                steady_or_symmetric::steady_spin(&scaled_omega, attitude),
            )
        } else if i1 == i2 || i2 == i3 || i1.high == 0.0 {
            let motion = steady_or_symmetric::symmetric_body(&moments, &w, &axes, attitude);
            (Mode::Symmetric, motion)
        } else {
            (separation, w) = separation.with_digits(principal, &scaled_omega, &moments, &w);
            if is_steady(&w) {
                (
                    Mode::Steady,
                    steady_or_symmetric::steady_spin(&scaled_omega, attitude),
                )
            } else {
                let tumbling = TumblingMotion::of(&moments, &w, &separation);
                (tumbling.mode, tumbling.motion(&axes, attitude))
            }
        };
        Ok(Self {
            mode,
            initial,
            moments: principal.moments,
            axes,
            principal_omega: w.map(|rate| rate.scaled(rate_unit)),
            secular: secular.in_units_of(rate_unit),
            separation: separation.in_units_of(rate_unit),
            propagator: propagator.in_units_of(rate_unit),
        })
    }

    /// Attitude and ω at the time t; NaN for a t that is not finite, or beyond [`Self::reach`].
    ///
    /// The attitude is continuous in t as a quaternion, not only as a rotation.
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        closed_form::at(&self.propagator, t)
    }

    /// The states at many times on the calling thread, quaternions as (x, y, z, w): the bits of [`Self::at`].
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        closed_form::sample(&self.propagator, times, attitudes, omegas);
    }
}

impl ClosedForm for FreeMotion {
    fn reach(&self) -> f64 {
        self.propagator.reach
    }

    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        Self::sample(self, times, attitudes, omegas);
    }
}
