//! Dry friction in the bearing of a wheel (Coulomb's law): against the rate of a wheel that turns, and whatever it takes, up to its most,
//! to keep one at rest that rests.
//!
//! At rest the torque of the bearing follows from all other torques and from the body. With the wheels of a set at rest relative to
//! the body
//!
//! ```text
//! (I' + Σ J a aᵀ) ω̇ = N' + Σ a τ − ω × I'ω,   f = J a·ω̇ − τ
//! ```
//!
//! A wheel at the limit of its rate is held in the same way, at the rate Ω of the limit: its motor exerts what that takes, as long as it is
//! asked for more.
//!
//! Here I' is the tensor without the wheels, N' the torque beside it, which counts `−a τ` of the motors and `−ω × h a` of the
//! wheels, and f the torque of the bearing on the wheel. A wheel rests as long as |f| is at most that of the friction.

use nalgebra::{Matrix3, Vector3};

use crate::motion::euler_equations::EulerEquations;
use crate::motion::state::Phase;

/// A wheel whose rate is that small, relative to the terms that it is the difference of, rests: some roundings.
const REST: f64 = 16.0 * f64::EPSILON;
/// A bearing holds that much more than the most of its friction, relative to it, so that what has just been found to hold does.
const GRIP: f64 = 1e-13;

/// The bearing of a wheel, and how the wheel turns in it; or the limit of the wheel's rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Which of the states of the load is the momentum h of the wheel.
    pub(super) index: usize,
    /// a, in B.
    pub(super) axis: Vector3<f64>,
    /// J.
    pub(super) inertia: f64,
    /// The torque of its dry friction, positive; zero of a limit.
    pub(super) most: f64,
    /// The largest |Ω| of a limit; zero of dry friction.
    pub(super) reach: f64,
    /// The sign of Ω; zero at rest, and at the limit.
    pub(super) turns: f64,
    /// At the limit the sign of Ω.
    pub(super) side: f64,
}

impl Bearing {
    /// Of the state number `index` as it is at `phase`.
    pub(super) fn at(
        index: usize,
        axis: Vector3<f64>,
        inertia: f64,
        most: f64,
        phase: &Phase,
    ) -> Self {
        let bearing = Self {
            index,
            axis,
            inertia,
            most,
            reach: 0.0,
            turns: 0.0,
            side: 0.0,
        };
        let [rate, noise] = bearing.rate(phase);
        Self {
            turns: if rate.abs() <= noise {
                0.0
            } else {
                rate.signum()
            },
            ..bearing
        }
    }

    /// The limit of the rate of the wheel that is state number `index`, as it is at `phase`.
    pub(super) fn limit(
        index: usize,
        axis: Vector3<f64>,
        inertia: f64,
        reach: f64,
        phase: &Phase,
    ) -> Self {
        let limit = Self {
            index,
            axis,
            inertia,
            most: 0.0,
            reach,
            turns: 1.0,
            side: 0.0,
        };
        let [rate, noise] = limit.rate(phase);
        if rate.abs() < reach - noise {
            return limit;
        }
        Self {
            turns: 0.0,
            ..limit.on_side(phase)
        }
    }

    /// Whether it is the limit of a rate.
    pub(crate) fn is_limit(&self) -> bool {
        self.reach > 0.0
    }

    /// Whether it is the same bearing, or limit, however the wheel turns.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.index == other.index && self.is_limit() == other.is_limit()
    }

    /// A limit at the side to which the wheel turns.
    pub(crate) fn on_side(&self, phase: &Phase) -> Self {
        Self {
            side: self.rate(phase)[0].signum(),
            ..*self
        }
    }

    /// Ω, and how much of it may be rounding.
    fn rate(&self, phase: &Phase) -> [f64; 2] {
        let (wheel, body) = (
            phase.internal_state[self.index] / self.inertia,
            self.axis.dot(&phase.omega),
        );
        [wheel - body, REST * (wheel.abs() + body.abs())]
    }

    /// The torque of the dry friction on a wheel that turns.
    pub(super) fn friction(&self) -> f64 {
        -self.turns * self.most
    }

    /// Of a wheel that turns: negative as soon as it turns the other way, or beyond its limit.
    pub(crate) fn until_stop(&self, phase: &Phase) -> f64 {
        let [rate, noise] = self.rate(phase);
        if self.is_limit() {
            // Smooth where the wheel rests.
            return (self.reach - rate) * (self.reach + rate) / (2.0 * self.reach) + noise;
        }
        self.turns * rate + noise
    }

    /// Of a wheel at rest, which takes the torque f: negative as soon as the friction cannot hold it. Of one at its limit, whose motor
    /// exerts f more than it is asked for: negative as soon as it is asked for less.
    pub(crate) fn until_slip(&self, f: f64) -> f64 {
        if self.is_limit() {
            return f64::EPSILON * self.inertia * self.reach * self.reach - f * self.side;
        }
        // Smooth where f is zero.
        let (most, share) = (1.0 + GRIP, f / self.most);
        (most - share) * (most + share)
    }

    /// At rest.
    pub(super) fn at_rest(&self) -> Self {
        Self {
            turns: 0.0,
            ..*self
        }
    }

    /// The wheel has the momentum that it has at rest, or at its limit.
    pub(super) fn keep(&self, phase: &mut Phase) {
        phase.internal_state[self.index] = self.inertia * self.axis.dot(&phase.omega) + self.held();
    }

    /// J Ω at which it is held.
    fn held(&self) -> f64 {
        self.inertia * (self.reach * self.side)
    }

    /// Of a wheel at rest, which takes the torque f: as it turns when it slips.
    pub(crate) fn in_slip(&self, f: f64) -> Self {
        Self {
            turns: if self.is_limit() { 1.0 } else { -f.signum() },
            ..*self
        }
    }

    /// Which of the states of the load is the momentum of its wheel.
    pub(crate) fn index(&self) -> usize {
        self.index
    }
}

/// What moves a body with wheels at rest in their bearings.
#[derive(Clone, Debug)]
pub(crate) struct Stiction {
    euler: EulerEquations,
    wheels: Vec<Bearing>,
    /// (I' + Σ J a aᵀ)⁻¹, in B.
    inverse: Matrix3<f64>,
}

impl Stiction {
    /// Of those of the `bearings` that rest, in a body with these equations; nothing where all turn.
    pub(crate) fn of(euler: &EulerEquations, bearings: &[Bearing]) -> Option<Self> {
        let wheels: Vec<_> = bearings
            .iter()
            .filter(|bearing| bearing.turns == 0.0)
            .copied()
            .collect();
        if wheels.is_empty() {
            return None;
        }
        let moments = Matrix3::from_diagonal(&Vector3::from(euler.moments()));
        let mut tensor = euler.axes() * moments * euler.axes().transpose();
        for wheel in &wheels {
            tensor += wheel.axis * wheel.axis.transpose() * wheel.inertia;
        }
        Some(Self {
            euler: *euler,
            // Not a number where there is none: the run says so.
            inverse: tensor
                .cholesky()
                .map_or_else(|| Matrix3::repeat(f64::NAN), |factors| factors.inverse()),
            wheels,
        })
    }

    /// Brings the wheels, which turn by some roundings, to rest without a change of the momentum of all.
    pub(crate) fn stop(&self, phase: &mut Phase) {
        let axes = self.euler.axes();
        let moments = Vector3::from(self.euler.moments());
        let mut momentum = axes * moments.component_mul(&axes.tr_mul(&phase.omega));
        for wheel in &self.wheels {
            momentum += wheel.axis * (phase.internal_state[wheel.index] - wheel.held());
        }
        phase.omega = self.inverse * momentum;
        self.keep(phase);
    }

    /// Keeps the wheels at rest to the last digit.
    pub(crate) fn keep(&self, phase: &mut Phase) {
        for wheel in &self.wheels {
            wheel.keep(phase);
        }
    }

    /// The torque, beside the tensor without the wheels, with that of the bearings at rest in it; their rates ḣ into `rates`,
    /// where those of their motors are.
    pub(crate) fn hold(
        &self,
        omega: &Vector3<f64>,
        torque: &Vector3<f64>,
        rates: &mut [f64],
    ) -> Vector3<f64> {
        let mut all = torque - self.euler.torque(omega, &Vector3::zeros());
        for wheel in &self.wheels {
            all += wheel.axis * rates[wheel.index];
        }
        let acceleration = self.inverse * all;
        let mut torque = *torque;
        for wheel in &self.wheels {
            let rate = wheel.inertia * wheel.axis.dot(&acceleration);
            torque -= wheel.axis * (rate - rates[wheel.index]);
            rates[wheel.index] = rate;
        }
        torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_of_some_roundings_is_rest() {
        let (inertia, omega) = (0.5, Vector3::new(0.0, 0.0, 0.7));
        for (roundings, turns) in [(8.0, 0.0), (128.0, 1.0), (-128.0, -1.0)] {
            let rate = roundings * f64::EPSILON * omega.z;
            let phase = Phase {
                omega,
                internal_state: [inertia * (omega.z + rate)].into(),
                ..Phase::nan()
            };
            let bearing = Bearing::at(0, Vector3::z(), inertia, 1.0, &phase);
            assert!(bearing.turns == turns, "{roundings}");
        }
    }
}
