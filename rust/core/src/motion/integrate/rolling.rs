//! Taylor series of a body that rolls on a plane.
//!
//! The equations are recorded once, and their series come order by order from
//! [`power_series`](crate::numerics::power_series). Units of length, mass and time are powers of two near those of the motion, so that
//! no coefficient of high order overflows, and no digit is lost.

use nalgebra::Vector3;

use super::taylor::{LAST_TERM, exp2, log2_step, order_of_least_work};
use crate::error::{Error, MotionFault};
use crate::mass::RigidBody;
use crate::motion::problem::{Effort, Tolerance};
use crate::motion::rolling::Contact;
use crate::motion::rolling::equations::{ContactState, Equations, VARIABLES, normal_of};
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;
use crate::numerics::power_of_two::power_below;
use crate::numerics::power_series::{COUNT, PowerSeries, Recorder, dot};

/// A sum of a series that is so far from zero, relative to its first term, has its sign, whatever was left out.
const SURE: f64 = 1e-3;

/// A motion of rolling under way, and its last step as polynomials in time.
pub(crate) struct RollingSeries {
    contact: Contact,
    /// In the units of the run.
    equations: Equations,
    /// The units of length and of rates.
    length: f64,
    rate: f64,
    series: PowerSeries,
    order: usize,
    last_term: f64,
    /// The least ω that errors are relative to, in the unit of rates.
    floor: f64,
    /// The state at the end of the last step, and its rounding errors.
    value: [f64; VARIABLES],
    rest: [f64; VARIABLES],
    /// The same at its start.
    before: [[f64; VARIABLES]; 2],
    /// The largest |ω| and distance so far.
    fastest: f64,
    farthest: f64,
    /// The time at the start and at the end of the last step, since the start of the run, with their rounding errors, in units.
    from: (f64, f64),
    now: (f64, f64),
    /// The end of the run in units, and as it was given.
    end: f64,
    elapsed_end: f64,
    steps: u64,
}

impl RollingSeries {
    /// Begin at a state of motion; the run is `span` long.
    pub(crate) fn new(
        body: &RigidBody,
        contact: &Contact,
        gravity: &Vector3<f64>,
        start: &Phase,
        span: f64,
        tolerance: &Tolerance,
    ) -> Self {
        let equations = Equations::new(body, contact, gravity);
        let [mass, weight, turntable, size] = equations.scales();
        let length = power_below(size);
        let fastest = (start.omega.norm().max(turntable)).max((weight / size).sqrt());
        let rate = power_below(if fastest > 0.0 {
            fastest
        } else {
            1.0 / span.abs()
        });
        let state = equations.state(contact, start);
        let equations = equations.in_units(1.0 / length, 1.0 / power_below(mass), 1.0 / rate);
        let mut value = state.variables();
        for omega in &mut value[4..7] {
            *omega /= rate;
        }
        for place in &mut value[10..] {
            *place /= length;
        }
        let recorder = Recorder::default();
        let variables = std::array::from_fn(|number| recorder.variable(number));
        let motion = equations.motion(&ContactState::of(&variables));
        let normal = ContactState::of(&variables).normal;
        let force = [motion.level[0], motion.level[1], normal].map(|axis| dot(motion.lift, axis));
        Self {
            contact: *contact,
            series: PowerSeries::new(&recorder, &motion.rates.variables(), &force),
            equations,
            length,
            rate,
            order: order_of_least_work(tolerance.relative, COUNT - 1),
            last_term: (LAST_TERM * tolerance.relative).log2(),
            floor: tolerance.absolute / tolerance.relative / rate,
            value,
            rest: [0.0; VARIABLES],
            before: [value, [0.0; VARIABLES]],
            fastest: 0.0,
            farthest: size / length,
            from: (0.0, 0.0),
            now: (0.0, 0.0),
            end: span * rate,
            elapsed_end: span,
            steps: 0,
        }
    }

    /// Make one step toward the end of the run.
    pub(crate) fn advance(&mut self) -> Result<(), Error> {
        let state = ContactState::of(&self.value);
        let normal = Vector3::from(state.normal);
        if self.equations.surface().margin(&normal) <= 0.0 {
            return Err(self.lost());
        }
        let [.., x, y] = self.value;
        self.fastest = (self.fastest)
            .max(Vector3::from(state.omega).norm())
            .max(self.floor);
        self.farthest = self.farthest.max(x.hypot(y));
        self.series.expand(&self.value, self.order);
        let longest = self.longest_step();
        let left = (self.end - self.now.0) - self.now.1;
        let is_last = left.abs() <= longest;
        let step = if is_last {
            left
        } else {
            longest.copysign(left)
        };
        let (next, error) = two_sum(self.now.0, step + self.now.1);
        if !longest.is_finite() || (next == self.now.0 && !is_last) {
            let time = self.elapsed();
            return Err(Error::Motion(if longest.is_nan() {
                MotionFault::NotFiniteMotion { time }
            } else {
                let step = longest / self.rate;
                MotionFault::StepTooSmall { time, step }
            }));
        }
        self.before = [self.value, self.rest];
        self.from = self.now;
        self.now = if is_last {
            (self.end, 0.0)
        } else {
            (next, error)
        };
        let sums = self.increments(step);
        for (i, sum) in sums.into_iter().enumerate() {
            (self.value[i], self.rest[i]) = two_sum(self.value[i], sum + self.rest[i]);
        }
        self.normalize();
        self.steps += 1;
        Ok(())
    }

    /// Compute the longest step for which the last two terms of the series are as small as the tolerance says.
    fn longest_step(&self) -> f64 {
        let coefficients = self.series.coefficients();
        let scale = |number: usize| match number {
            4..7 if self.fastest > 0.0 => self.fastest,
            10.. => self.farthest,
            _ => 1.0,
        };
        let mut longest = f64::INFINITY;
        for order in [self.order - 1, self.order] {
            let (mut largest, mut sum) = (0.0, 0.0);
            for (number, variable) in coefficients.iter().enumerate() {
                let size = variable[order].abs() / scale(number);
                largest = f64::max(largest, size);
                sum += size;
            }
            // A NaN is lost in the maximum, but not in the sum.
            let log = log2_step(largest, order, self.last_term) + 0.0 * sum;
            let step = exp2(log) + 0.0 * log;
            longest = if step < longest || step.is_nan() {
                step
            } else {
                longest
            };
        }
        longest
    }

    /// Compute the change of each variable in a part of the last step.
    fn increments(&self, part: f64) -> [f64; VARIABLES] {
        let mut sums = [0.0; VARIABLES];
        for (sum, coefficients) in sums.iter_mut().zip(self.series.coefficients()) {
            for coefficient in coefficients[1..=self.order].iter().rev() {
                *sum = (*sum + coefficient) * part;
            }
        }
        sums
    }

    /// Make the quaternion one of unit length by ½ (1 − |q|²), and the normal that of the attitude.
    fn normalize(&mut self) {
        let mut lack = 1.0;
        for i in 0..4 {
            let (q, left_out) = (self.value[i], self.rest[i]);
            lack -= q * (q + left_out + left_out);
        }
        for i in 0..4 {
            let change = 0.5 * lack * self.value[i];
            (self.value[i], self.rest[i]) = two_sum(self.value[i], change + self.rest[i]);
        }
        let [x, y, z, w, ..] = self.value;
        let normal = normal_of([x, y, z, w]);
        self.value[7..10].copy_from_slice(&normal);
        self.rest[7..10].fill(0.0);
    }

    /// Return the end of the last step: time since the start of the run.
    pub(crate) fn elapsed(&self) -> f64 {
        if self.now == (self.end, 0.0) {
            self.elapsed_end
        } else {
            self.now.0 / self.rate
        }
    }

    /// Return the state at the end of the last step.
    pub(crate) fn phase(&self) -> Phase {
        self.to_phase(&self.value)
    }

    /// Compute the state at a time within the last step.
    pub(crate) fn at(&self, elapsed: f64) -> Phase {
        let part = (elapsed * self.rate - self.from.0) - self.from.1;
        let sums = self.increments(part);
        let [start, rest] = &self.before;
        let mut value = [0.0; VARIABLES];
        for i in 0..VARIABLES {
            value[i] = start[i] + (sums[i] + rest[i]);
        }
        let length = value[..4].iter().map(|x| x * x).sum::<f64>().sqrt();
        for q in &mut value[..4] {
            *q /= length;
        }
        let [x, y, z, w, ..] = value;
        value[7..10].copy_from_slice(&normal_of([x, y, z, w]));
        self.to_phase(&value)
    }

    /// Compute the force of the plane over the mass at a time within the last step, from its series: two components in the plane and
    /// the one along the normal.
    pub(crate) fn force_over_mass(&self, elapsed: f64) -> [f64; 3] {
        let part = (elapsed * self.rate - self.from.0) - self.from.1;
        let unit = self.length * self.rate * self.rate;
        [0, 1, 2].map(|number| {
            let terms = &self.series.output(number)[..self.order];
            terms.iter().rfold(0.0, |sum, term| sum * part + term) * unit
        })
    }

    /// Return whether the normal force stays positive up to a time within the last step, for certain.
    pub(crate) fn is_pressed_until(&self, elapsed: f64) -> bool {
        let part = ((elapsed * self.rate - self.from.0) - self.from.1).abs();
        let terms = &self.series.output(2)[..self.order];
        let change = terms[1..]
            .iter()
            .rfold(0.0, |sum, term| (sum + term.abs()) * part);
        terms[0] > 1.01 * change + SURE * terms[0].abs()
    }

    /// Return by how much the normal changes in body axes up to a time within the last step, at most.
    pub(crate) fn most_change_of_normal(&self, elapsed: f64) -> f64 {
        let part = ((elapsed * self.rate - self.from.0) - self.from.1).abs();
        let changes = self.series.coefficients()[7..10].iter().map(|terms| {
            let terms = terms[1..=self.order].iter();
            terms.rfold(0.0, |sum, term| (sum + term.abs()) * part)
        });
        changes.sum::<f64>() * 1.01
    }

    /// Return the normal in body axes at the start of the last step.
    pub(crate) fn normal_before(&self) -> Vector3<f64> {
        ContactState::of(&self.before[0]).normal.into()
    }

    fn to_phase(&self, value: &[f64; VARIABLES]) -> Phase {
        let mut state = ContactState::of(value);
        let contact = Contact {
            point: self.contact.point / self.length,
            ..self.contact
        };
        let phase = self.equations.phase(&contact, &state);
        state.omega = state.omega.map(|x| x * self.rate);
        Phase {
            omega: state.omega.into(),
            position: phase.position * self.length,
            velocity: phase.velocity * (self.length * self.rate),
            ..phase
        }
    }

    /// Return the error of a contact that is no point of the surface any more.
    pub(crate) fn lost(&self) -> Error {
        Error::Motion(MotionFault::NoPointOfContact {
            time: Some(self.elapsed()),
            law: self.contact.surface.beyond_margin(),
        })
    }

    /// Return the steps so far; each computes one series.
    pub(crate) fn effort(&self) -> Effort {
        Effort {
            steps: self.steps,
            evaluations: self.steps,
        }
    }
}
