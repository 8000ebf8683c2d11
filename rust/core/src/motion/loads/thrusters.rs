//! Thrusters that fire in pulses.

use nalgebra::Vector3;

use super::body_at_point::BodyAtPoint;
use super::laws::slug::positive;
use super::wrench::Wrench;
use crate::error::{Error, all_finite, finite};
use crate::motion::state::Phase;

/// A pulse that is shorter than the shortest one by less than this, relative to it, is the shortest one: the product of a duty and the
/// period is rounded.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// How long thrusters fire in each period, by their duties.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::Pulses;
///
/// // Pulses of 20 ms or more, of 80 ms at most, in periods of 100 ms.
/// let pulses = Pulses::new(0.1, 0.02, Some(0.08), None)?;
/// assert_eq!([0.19, 0.25, 0.5, 0.9, -1.0].map(|duty| pulses.length(duty)), [0.0, 0.025, 0.05, 0.08, 0.0]);
/// // On or off.
/// let switched = Pulses::new(0.1, 0.0, None, Some(0.25))?;
/// assert_eq!([0.2, 0.25, 1.0].map(|duty| switched.length(duty)), [0.0, 0.1, 0.1]);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulses {
    period: f64,
    /// A pulse that would be shorter is none.
    min_on: f64,
    max_on: f64,
    /// Where there is one: a duty below it is none, any other the longest pulse.
    deadband: Option<f64>,
}

impl Pulses {
    /// In periods of that length, pulses of at least `min_on` and at most `max_on`, which is the period by default; with a `deadband` on or off.
    ///
    /// # Errors
    /// For a period or a `max_on` that is not positive, for `min_on ≤ max_on ≤ period` that does not hold, for a `deadband` outside (0, 1], and
    /// for one beside a `min_on`.
    pub fn new(
        period: f64,
        min_on: f64,
        max_on: Option<f64>,
        deadband: Option<f64>,
    ) -> Result<Self, Error> {
        positive("period", period)?;
        let refuse = |what, law, value| Err(Error::OutOfDomain { what, law, value });
        let most = max_on.unwrap_or(period);
        positive("max_on", most)?;
        if most > period {
            return refuse("max_on", "the period or less", most);
        }
        finite("min_on", min_on)?;
        if !(0.0..=most).contains(&min_on) {
            let law = "zero or more, and max_on (the period by default) or less";
            return refuse("min_on", law, min_on);
        }
        if let Some(least) = deadband {
            finite("deadband", least)?;
            if !(least > 0.0 && least <= 1.0) {
                return refuse("deadband", "above 0, and 1 or less", least);
            }
            if min_on > 0.0 {
                let law = "left out beside deadband, with which a thruster fires for max_on or not at all";
                return refuse("min_on", law, min_on);
            }
        }
        Ok(Self {
            period,
            min_on,
            max_on: most,
            deadband,
        })
    }

    /// The time from one pulse to the next.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.period
    }

    /// How long a thruster fires from the start of a period on, with this duty, which is clipped to 0..1.
    #[must_use]
    pub fn length(&self, duty: f64) -> f64 {
        let duty = duty.clamp(0.0, 1.0);
        match self.deadband {
            Some(least) if duty >= least => self.max_on,
            Some(_) => 0.0,
            None => {
                let length = (duty * self.period).min(self.max_on);
                if length < self.min_on * (1.0 - ROUNDING) {
                    0.0
                } else {
                    length
                }
            }
        }
    }
}

/// A set of thrusters at points of a body, each of which fires in each period from its start on.
///
/// ```text
/// F = Σ Fₖ dₖ,   N = Σ (pₖ − P) × Fₖ dₖ   over the thrusters that fire,   Jₖ = ∫ Fₖ dt
/// ```
///
/// with the directions d of the forces on the body, and P the reference point. A set of n has 2n states: the impulse J of each
/// since the start, and the length of the pulse of each in the period under way.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{BodyAtPoint, Pulses, Thrusters};
/// use polhode::motion::simulate::{Phase, State};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // Two thrusters on opposite sides; of the pulse of the second is 30 ms of 100 ms.
/// let arms = [Vector3::x(), -Vector3::x()];
/// let set = Thrusters::new(&arms, &[Vector3::y(), -Vector3::y()], &[2.0, 2.0], Pulses::new(0.1, 0.0, None, None)?)?;
/// let mut states = set.begin();
/// set.command(&[1.0, 0.3], &mut states);
/// assert_eq!((set.count(), set.pulses().period(), set.sizes()), (2, 0.1, vec![0.2, 0.2, 0.1, 0.1]));
/// assert_eq!(set.switches(5.0, &states), [5.1, 5.03]);
/// assert_eq!(set.fires(5.0, 5.04, &states), [true, false]);
/// let body = BodyAtPoint::free(&solids::sphere(1.0, Amount::Mass(5.0))?, 0.0);
/// let rest = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() });
/// let both = set.wrench(&set.fires(5.0, 5.01, &states), &body, &rest);
/// assert_eq!((both.force, both.torque.z), (Vector3::zeros(), 4.0));
/// let mut rates = set.begin();
/// set.rates(&[true, false], &mut rates);
/// assert_eq!(rates, [2.0, 0.0, 0.0, 0.0]);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Thrusters {
    positions: Vec<Vector3<f64>>,
    /// Of the force of each on the body.
    directions: Vec<Vector3<f64>>,
    forces: Vec<f64>,
    pulses: Pulses,
}

impl Thrusters {
    /// Of thrusters at `positions` (from the origin of B), with these `directions` of the force on the body, of any length, and these `forces`.
    ///
    /// # Errors
    /// For a direction that is zero, a force that is not positive, what is not finite.
    ///
    /// # Panics
    /// When these are not of the same number.
    pub fn new(
        positions: &[Vector3<f64>],
        directions: &[Vector3<f64>],
        forces: &[f64],
        pulses: Pulses,
    ) -> Result<Self, Error> {
        assert!(
            positions.len() == directions.len() && positions.len() == forces.len(),
            "a position, a direction and a force for each thruster"
        );
        let mut units = Vec::with_capacity(directions.len());
        for direction in directions {
            all_finite("directions", direction)?;
            let unit = (direction / direction.amax()).try_normalize(0.0);
            let unit = unit.filter(|_| direction.amax() > 0.0);
            units.push(unit.ok_or(Error::NoDirection { what: "directions" })?);
        }
        for position in positions {
            all_finite("positions", position)?;
        }
        for &force in forces {
            positive("forces", force)?;
        }
        Ok(Self {
            positions: positions.to_vec(),
            directions: units,
            forces: forces.to_vec(),
            pulses,
        })
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.forces.len()
    }

    /// Their pulses.
    #[must_use]
    pub fn pulses(&self) -> &Pulses {
        &self.pulses
    }

    /// The states at a start: no impulse, no pulse.
    #[must_use]
    pub fn begin(&self) -> Vec<f64> {
        vec![0.0; 2 * self.count()]
    }

    /// What counts as large of each state: that of a period.
    #[must_use]
    pub fn sizes(&self) -> Vec<f64> {
        let period = self.pulses.period;
        let impulses = self.forces.iter().map(|force| force * period);
        impulses.chain(self.forces.iter().map(|_| period)).collect()
    }

    /// At the start of a period: the lengths of the pulses of these duties, into the states.
    pub fn command(&self, duties: &[f64], states: &mut [f64]) {
        for (length, duty) in states[self.count()..].iter_mut().zip(duties) {
            *length = self.pulses.length(*duty);
        }
    }

    /// When each is switched off in a period that begins at `start`: its pulse of no length ends there.
    #[must_use]
    pub fn switches(&self, start: f64, states: &[f64]) -> Vec<f64> {
        let lengths = states[self.count()..].iter();
        lengths.map(|length| start + length).collect()
    }

    /// Which of them fire at the time `t` in a period that begins at `start`.
    #[must_use]
    pub fn fires(&self, start: f64, t: f64, states: &[f64]) -> Vec<bool> {
        let lengths = states[self.count()..].iter();
        lengths.map(|length| t < start + length).collect()
    }

    /// Force in N and torque in B about the reference point of those that fire.
    #[must_use]
    pub fn wrench(&self, fires: &[bool], body: &BodyAtPoint, phase: &Phase) -> Wrench {
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (k, _) in fires.iter().enumerate().filter(|(_, fires)| **fires) {
            let thrust = self.directions[k] * self.forces[k];
            force += thrust;
            torque += (self.positions[k] - body.point).cross(&thrust);
        }
        Wrench {
            force: phase.attitude * force,
            torque,
        }
    }

    /// The rates of the states: of the impulse the force of each that fires.
    pub fn rates(&self, fires: &[bool], rates: &mut [f64]) {
        for (k, rate) in rates.iter_mut().enumerate() {
            let is_on = fires.get(k).is_some_and(|fires| *fires);
            *rate = if is_on { self.forces[k] } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulse_of_the_least_length_is_one_and_a_shorter_one_none() {
        let pulses = Pulses::new(0.1, 0.07, None, None).expect("in order");
        // 0.7 · 0.1 is rounded below 0.07.
        assert_eq!(pulses.length(0.7), 0.7 * 0.1);
        assert_eq!(pulses.length(0.7 * (1.0 - 1e-14)), 0.0);
        let none = Pulses::new(0.5, 0.0, None, None).expect("in order");
        assert_eq!([0.0, 1e-9].map(|duty| none.length(duty)), [0.0, 5e-10]);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        assert!(Pulses::new(0.1, 0.1, Some(0.1), None).is_ok());
        for (period, least, most, deadband) in [
            (0.0, 0.0, None, None),
            (f64::INFINITY, 0.0, None, None),
            (0.1, -1e-9, None, None),
            (0.1, 0.11, None, None),
            (0.1, 0.06, Some(0.05), None),
            (0.1, 0.0, Some(0.11), None),
            (0.1, 0.0, Some(0.0), None),
            (0.1, 0.0, None, Some(0.0)),
            (0.1, 0.0, None, Some(1.1)),
            (0.1, 0.01, None, Some(0.5)),
        ] {
            assert!(Pulses::new(period, least, most, deadband).is_err());
        }
        let pulses = Pulses::new(0.1, 0.0, None, None).expect("in order");
        let (at, along) = ([Vector3::x()], [Vector3::y()]);
        for force in [0.0, -1.0, f64::NAN] {
            assert!(Thrusters::new(&at, &along, &[force], pulses).is_err());
        }
        assert!(Thrusters::new(&at, &[Vector3::zeros()], &[1.0], pulses).is_err());
    }
}
