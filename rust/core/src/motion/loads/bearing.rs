//! Dry friction in the bearing of a wheel (Coulomb's law): against the rate of a wheel that turns, and whatever it takes, up to its most,
//! to keep one at rest that rests.

use nalgebra::Vector3;

use crate::motion::state::Phase;

/// A wheel whose rate is that small, relative to the terms that it is the difference of, rests: some roundings.
const REST: f64 = 16.0 * f64::EPSILON;
/// A bearing holds that much more than the most of its friction, relative to it, so that what has just been found to hold does.
const GRIP: f64 = 1e-13;

/// The bearing of a wheel, and how the wheel turns in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Which of the states of the load is the momentum h of the wheel.
    pub(super) index: usize,
    /// a, in B.
    pub(super) axis: Vector3<f64>,
    /// J.
    pub(super) inertia: f64,
    /// The torque of its dry friction, positive.
    pub(super) most: f64,
    /// The sign of Ω; zero at rest.
    pub(super) turns: f64,
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
            turns: 0.0,
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

    /// Of a wheel that turns: negative as soon as it turns the other way.
    pub(crate) fn until_stop(&self, phase: &Phase) -> f64 {
        let [rate, noise] = self.rate(phase);
        self.turns * rate + noise
    }

    /// Of a wheel at rest, which takes the torque f: negative as soon as the friction cannot hold it.
    pub(crate) fn until_slip(&self, f: f64) -> f64 {
        // Smooth where f is zero.
        let (most, share) = (1.0 + GRIP, f / self.most);
        (most - share) * (most + share)
    }

    /// At rest.
    pub(super) fn stopped(&self) -> Self {
        Self {
            turns: 0.0,
            ..*self
        }
    }

    /// The wheel has the momentum that it has at rest.
    pub(super) fn keep(&self, phase: &mut Phase) {
        phase.internal_state[self.index] = self.inertia * self.axis.dot(&phase.omega);
    }

    /// Of a wheel at rest, which takes the torque f: as it turns when it slips.
    pub(crate) fn slipping(&self, f: f64) -> Self {
        Self {
            turns: -f.signum(),
            ..*self
        }
    }

    /// Which of the states of the load is the momentum of its wheel.
    pub(crate) fn index(&self) -> usize {
        self.index
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
