//! What a body carries: momentum and wheels, and the gyrostat that they make.
//!
//! With Ω the rate of a wheel relative to the body, a its axis, J its moment about a, its momentum along a is
//! `J (Ω + a·ω)`. The body's tensor I has the wheels in it as if they were locked.
//!
//! - A *held* wheel keeps Ω: `I ω̇ + ω × (I ω + J Ω a) = 0`.
//! - A *free* wheel keeps `h = J (Ω + a·ω)`: `(I − J a aᵀ) ω̇ + ω × ((I − J a aᵀ) ω + h a) = 0`.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::equilibria::{Equilibria, equilibria};
use super::motion::GyrostatMotion;
use super::start::{direction, dot};
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::mass::RigidBody;
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::exponent;

/// The momenta inside a body, components in B.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InternalMomentum {
    /// Σ J Ω a of all wheels at the start, and what else is given.
    pub momentum: Vector,
    /// Rows of `Σ J a aᵀ` of the free wheels.
    pub free: [Vector; 3],
}

impl InternalMomentum {
    /// With a constant momentum.
    ///
    /// # Errors
    /// [`Error::NonFinite`].
    pub fn of(momentum: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("momentum", momentum)?;
        Ok(Self {
            momentum: [momentum.x, momentum.y, momentum.z].map(DoubleDouble::from),
            ..Self::default()
        })
    }

    /// With one more wheel: its axis, of any length, J, and J Ω at the start.
    ///
    /// # Errors
    /// [`Error::NonFinite`], [`Error::OutOfDomain`] for an axis without direction or a negative J.
    pub fn with(
        mut self,
        axis: &Vector3<f64>,
        inertia: f64,
        momentum: f64,
        is_free: bool,
    ) -> Result<Self, Error> {
        all_finite("axis", axis)?;
        all_finite("inertia and momentum of a wheel", &[inertia, momentum])?;
        if inertia < 0.0 {
            return Err(Error::OutOfDomain {
                what: "inertia",
                law: "positive or zero",
                value: inertia,
            });
        }
        let parts = [axis.x, axis.y, axis.z].map(DoubleDouble::from);
        let Some((a, ..)) = direction(&parts) else {
            return Err(Error::NoDirection { what: "axis" });
        };
        for k in 0..3 {
            self.momentum[k] += DoubleDouble::from(momentum) * a[k];
            if is_free {
                for j in 0..3 {
                    self.free[k][j] += DoubleDouble::from(inertia) * (a[k] * a[j]);
                }
            }
        }
        Ok(self)
    }

    /// h, where ω is this at the start.
    #[must_use]
    pub fn rotor(&self, omega: &Vector3<f64>) -> Vector {
        let omega = [omega.x, omega.y, omega.z].map(DoubleDouble::from);
        [0, 1, 2].map(|k| self.momentum[k] + dot(&self.free[k], &omega))
    }
}

/// The least |L| over |h| for equilibria: what is over it must be a number.
const LEAST: f64 = 1e-290;

/// A body with momenta inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyrostat {
    /// What is inside.
    pub inside: InternalMomentum,
    /// Principal moments and axes of `I − Σ J a aᵀ`.
    principal: RefinedPrincipal,
}

impl Gyrostat {
    /// Of a body about its centre of mass.
    ///
    /// # Errors
    /// [`MotionFault::WheelsTooHeavy`] where `I − Σ J a aᵀ` is not positive definite.
    pub fn of(body: &RigidBody, inside: &InternalMomentum) -> Result<Self, Error> {
        let has_free = inside.free.iter().flatten().any(|x| x.high != 0.0);
        let principal = if has_free {
            RefinedPrincipal::of(body).less(&inside.free)?
        } else {
            RefinedPrincipal::of(body)
        };
        Ok(Self {
            inside: *inside,
            principal,
        })
    }

    /// Its steady rotations with `|I ω + h|` equal to `momentum`, h being what is inside and what free wheels keep where ω is
    /// `omega`; all directions in B.
    ///
    /// # Errors
    /// [`Error::OutOfDomain`] where `momentum` is not positive, [`MotionFault::MasslessGyrostat`].
    pub fn equilibria(&self, momentum: f64, omega: &Vector3<f64>) -> Result<Equilibria, Error> {
        finite("momentum", momentum)?;
        if momentum <= 0.0 {
            return Err(Error::OutOfDomain {
                what: "momentum",
                law: "positive: it is the length of L = I ω + h",
                value: momentum,
            });
        }
        let moment = self.principal.moments[0].high;
        if moment <= 0.0 {
            return Err(MotionFault::MasslessGyrostat { moment }.into());
        }
        let rotor = self.inside.rotor(omega);
        // In units of the largest component, whose products neither overflow nor underflow.
        let largest = (rotor.iter()).fold(0.0, |most: f64, x| most.max(x.high.abs()));
        if momentum < LEAST * largest {
            return Err(Error::OutOfDomain {
                what: "momentum",
                law: "at least 1e-290 times the momentum inside",
                value: momentum,
            });
        }
        let unit = exponent(largest);
        let scaled = rotor.map(|x| x.times_power_of_two(-unit));
        let along = (self.principal.along(&scaled)).map(|x| x.times_power_of_two(unit));
        let found = equilibria(&self.principal.moments, &along, momentum.into());
        Ok(found.rotate(&self.principal.rounded_axes()))
    }

    /// The tensor `I − Σ J a aᵀ` in B.
    #[must_use]
    pub fn inertia(&self) -> Matrix3<f64> {
        let axes = self.principal.axes();
        Matrix3::from_fn(|i, j| {
            let parts = (self.principal.moments.iter().enumerate())
                .map(|(k, moment)| *moment * (axes[(i, k)] * axes[(j, k)]));
            parts
                .fold(DoubleDouble::default(), |sum, part| sum + part)
                .rounded()
        })
    }

    /// Its motion from ω and the attitude at t = 0.
    ///
    /// # Errors
    /// As [`GyrostatMotion::of`].
    pub fn free_motion(
        &self,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<GyrostatMotion, Error> {
        all_finite("omega", omega)?;
        GyrostatMotion::of(&self.principal, &self.inside.rotor(omega), omega, attitude)
    }
}
