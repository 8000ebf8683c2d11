//! Taylor series of a body that rolls or slips on a plane.
//!
//! The equations are recorded once, and their series come order by order from
//! [`power_series`](crate::numerics::power_series). Units of length, mass and time are powers of two near those of the motion, so that
//! no coefficient of high order overflows, and no digit is lost.
//!
//! Coulomb's friction has the direction of the slip, which a slip that begins at zero does not have yet. Its direction d(t) is then a
//! series too: in the first step, each of its coefficients follows from the condition that the slip, of which friction takes part, has
//! this direction, `s×d = 0` at every order.

use nalgebra::Vector3;

use super::taylor::{LAST_TERM, exp2, log2_step, order_of_least_work};
use crate::error::{Error, MotionFault};
use crate::mass::RigidBody;
use crate::motion::problem::{Effort, Tolerance};
use crate::motion::rolling::equations::{
    ContactState, Equations, OF_CONTACT, OF_ROLLING, VARIABLES, level_axes, normal_of,
};
use crate::motion::rolling::sliding::Slipping;
use crate::motion::rolling::{Contact, Friction, Law};
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;
use crate::numerics::power_of_two::power_below;
use crate::numerics::power_series::{Arithmetic, COUNT, PowerSeries, Recorder, dot};

/// A sum of a series that is so far from zero, relative to its first term, has its sign, whatever was left out.
const SURE: f64 = 1e-3;

/// The least order of a series.
const FEWEST_TERMS: usize = 6;

/// The equations that a body on a plane follows for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Regime {
    Rolling,
    Sliding,
    /// It slips from the start of a step on, in this direction; slowly, where friction was only just enough to roll.
    Parting {
        direction: [f64; 2],
        slowly: bool,
    },
    /// It has lifted off.
    Flying,
}

/// A motion of rolling or slipping under way, and its last step as polynomials in time.
pub(crate) struct RollingSeries {
    contact: Contact,
    regime: Regime,
    /// In the units of the run.
    friction: Friction,
    mass: f64,
    /// In the units of the run.
    equations: Equations,
    /// The units of length and of rates.
    length: f64,
    rate: f64,
    series: PowerSeries,
    /// The order of a series, and that of the last step: less where the coefficients of high order overflow, as those of a slip that
    /// ceases do.
    most_terms: usize,
    order: usize,
    last_term: f64,
    /// The least ω that errors are relative to, in the unit of rates.
    floor: f64,
    /// The state at the end of the last step, and its rounding errors.
    value: [f64; VARIABLES],
    rest: [f64; VARIABLES],
    /// The same at its start.
    before: [[f64; VARIABLES]; 2],
    /// The largest |ω|, distance and speed of slip so far, and the size of the surface.
    fastest: f64,
    farthest: f64,
    quickest: f64,
    size: f64,
    /// The time at the start and at the end of the last step, since the start of the run, with their rounding errors, in units.
    from: (f64, f64),
    now: (f64, f64),
    /// The end of the run in units, and as it was given.
    end: f64,
    elapsed_end: f64,
    steps: u64,
    /// Those with the present equations.
    steps_here: u64,
}

/// The number of the work among the variables.
const WORK: usize = 14;

/// Return whether the plane can do work: one that turns, or that a body slips on.
fn works(contact: &Contact) -> bool {
    contact.turntable != 0.0 || contact.law != Law::Rolling || contact.resistance.acts()
}

/// Record the equations.
fn series_of(
    equations: &Equations,
    contact: &Contact,
    friction: Friction,
    regime: Regime,
) -> PowerSeries {
    let recorder = Recorder::default();
    let count = match regime {
        Regime::Rolling if !works(contact) => OF_ROLLING,
        Regime::Flying => VARIABLES,
        _ => OF_CONTACT,
    };
    let zero = recorder.variable(0) * 0.0;
    let variables: [_; VARIABLES] = std::array::from_fn(|number| {
        if number < count {
            recorder.variable(number)
        } else {
            zero
        }
    });
    let state = ContactState::of(&variables);
    let direction = if let Regime::Parting {
        direction: [x, y], ..
    } = regime
    {
        let across = recorder.variable(OF_CONTACT);
        let length = (across * across + 1.0).root();
        Some([(across * -y + x) / length, (across * x + y) / length])
    } else {
        None
    };
    let slipping = Slipping {
        friction,
        direction,
    };
    let motion = match regime {
        Regime::Rolling => equations.motion(&state),
        Regime::Flying => equations.flying(&state),
        Regime::Sliding | Regime::Parting { .. } => equations.sliding(&state, slipping),
    };
    let force = [motion.level[0], motion.level[1], state.normal].map(|axis| dot(motion.lift, axis));
    let mut rates = motion.rates.variables()[..count].to_vec();
    if direction.is_some() {
        rates.push(zero);
    }
    if regime == Regime::Rolling && !contact.resistance.acts() {
        PowerSeries::new(&recorder, &rates, &force)
    } else {
        let [x, y, normal] = force;
        PowerSeries::new(&recorder, &rates, &[x, y, normal, motion.bracket])
    }
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
        regime: Regime,
    ) -> Self {
        let equations = Equations::new(body, contact, gravity);
        let [mass, weight, turntable, size] = equations.scales();
        let length = power_below(size);
        let mut fastest = (start.omega.norm().max(turntable)).max((weight / size).sqrt());
        let state = if regime == Regime::Flying {
            equations.flying_state(contact, start)
        } else {
            equations.state(contact, start)
        };
        if regime == Regime::Sliding {
            fastest = fastest.max(state.slip[0].hypot(state.slip[1]) / size);
        }
        let rate = power_below(if fastest > 0.0 {
            fastest
        } else {
            1.0 / span.abs()
        });
        let mass = power_below(mass);
        let equations = equations.in_units(1.0 / length, 1.0 / mass, 1.0 / rate);
        let friction = (contact.friction()).in_units(1.0 / length, 1.0 / mass, 1.0 / rate);
        let mut value = state.variables();
        for omega in &mut value[4..7] {
            *omega /= rate;
        }
        for place in &mut value[10..12] {
            *place /= length;
        }
        for slip in &mut value[12..14] {
            *slip = if matches!(regime, Regime::Sliding | Regime::Flying) {
                *slip / (length * rate)
            } else {
                0.0
            };
        }
        (value[15], value[16]) = (value[15] / length, value[16] / (length * rate));
        Self {
            contact: *contact,
            regime,
            series: series_of(&equations, contact, friction, regime),
            equations,
            friction,
            mass,
            length,
            rate,
            most_terms: order_of_least_work(tolerance.relative, COUNT - 1),
            order: 0,
            last_term: (LAST_TERM * tolerance.relative).log2(),
            floor: tolerance.absolute / tolerance.relative / rate,
            value,
            rest: [0.0; VARIABLES],
            before: [value, [0.0; VARIABLES]],
            fastest: 0.0,
            farthest: size / length,
            quickest: 0.0,
            size: size / length,
            from: (0.0, 0.0),
            now: (0.0, 0.0),
            end: span * rate,
            elapsed_end: span,
            steps: 0,
            steps_here: 0,
        }
    }

    /// Go on from a time within the last step with other equations. A body that does not slip any more, or not yet, has no slip.
    pub(crate) fn go_on(&mut self, elapsed: f64, regime: Regime) {
        if elapsed != self.elapsed() {
            self.value = self.value_at(elapsed);
            self.rest = [0.0; VARIABLES];
            self.now = (elapsed * self.rate, 0.0);
        }
        if regime == Regime::Flying {
            if self.regime != Regime::Flying {
                self.take_off();
            }
        } else if regime != Regime::Sliding {
            self.value[12..14].fill(0.0);
            self.rest[12..14].fill(0.0);
        }
        self.steps_here = 0;
        self.follow(regime);
    }

    /// Go over from the variables of a contact to those of flight.
    fn take_off(&mut self) {
        let contact = self.contact_in_units();
        let phase = (self.equations).phase(&contact, &ContactState::of(&self.value));
        let state = self.equations.flying_state(&contact, &phase);
        for (number, value) in state.variables().into_iter().enumerate() {
            if (10..14).contains(&number) || number >= OF_CONTACT {
                (self.value[number], self.rest[number]) = (value, 0.0);
            }
        }
    }

    fn contact_in_units(&self) -> Contact {
        Contact {
            point: self.contact.point / self.length,
            ..self.contact
        }
    }

    fn follow(&mut self, regime: Regime) {
        if regime != self.regime {
            self.series = series_of(&self.equations, &self.contact, self.friction, regime);
            self.regime = regime;
        }
    }

    /// Make one step toward the end of the run.
    pub(crate) fn advance(&mut self) -> Result<(), Error> {
        if matches!(self.regime, Regime::Parting { .. }) && self.steps_here > 0 {
            self.follow(Regime::Sliding);
        }
        let state = ContactState::of(&self.value);
        let normal = Vector3::from(state.normal);
        if self.equations.surface().margin(&normal) <= 0.0 {
            return Err(self.lost());
        }
        let [x, y] = state.place;
        self.fastest = (self.fastest)
            .max(Vector3::from(state.omega).norm())
            .max(self.floor);
        self.farthest = self.farthest.max(x.hypot(y));
        let slip = state.slip[0].hypot(state.slip[1]);
        self.quickest = self.quickest.max(slip).max(self.fastest * self.size);
        self.order = self.most_terms;
        let mut longest = self.expand();
        while longest.is_nan() && self.order > FEWEST_TERMS {
            self.order = FEWEST_TERMS.max(self.order / 2);
            longest = self.expand();
        }
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
        self.steps_here += 1;
        Ok(())
    }

    /// Compute the series at the end of the last step, and the longest step for it.
    fn expand(&mut self) -> f64 {
        if let Regime::Parting { direction, slowly } = self.regime {
            self.expand_from_rest(direction, slowly);
        } else {
            self.series.expand(&self.value, self.order);
        }
        self.longest_step()
    }

    /// Compute the series of a slip that begins: `s = d⊥ η + d` times its length, with the unknown series η(t) of its direction.
    fn expand_from_rest(&mut self, [x, y]: [f64; 2], slowly: bool) {
        let mut start = [0.0; OF_CONTACT + 1];
        start[..OF_CONTACT].copy_from_slice(&self.value[..OF_CONTACT]);
        let (mut yields, mut defect) = (0.0, 0.0);
        self.series
            .expand_with_unknown(&start, self.order, OF_CONTACT, |order, trial, series| {
                if order == 0 {
                    if slowly {
                        series[12][1] = 0.0;
                        series[13][1] = 0.0;
                    }
                    return None;
                }
                let along = |k: usize| x * series[12][k] + y * series[13][k];
                let across = x * series[13][order + 1] - y * series[12][order + 1];
                let known = (1..order).map(|j| series[OF_CONTACT][j] * along(order + 1 - j));
                let off = across - known.sum::<f64>();
                match trial {
                    // By how much a turn of the direction changes the slip across it is the same at every order.
                    0 if order == 1 => {
                        defect = off;
                        Some(1.0)
                    }
                    1 if order == 1 => {
                        yields = 2.0 * (defect - off);
                        Some(defect / (0.5 * yields + along(1)))
                    }
                    0 => Some(off / (yields / (order + 1) as f64 + along(1))),
                    _ => None,
                }
            });
    }

    /// Compute the longest step for which the last two terms of the series are as small as the tolerance says.
    fn longest_step(&self) -> f64 {
        let coefficients = self.series.coefficients();
        let scale = |number: usize| match number {
            4..7 if self.fastest > 0.0 => self.fastest,
            10 | 11 => self.farthest,
            12 | 13 | 16 if self.quickest > 0.0 => self.quickest,
            15 if self.regime == Regime::Flying => self.farthest,
            WORK => f64::INFINITY,
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
        self.to_phase(&self.value_at(elapsed))
    }

    fn value_at(&self, elapsed: f64) -> [f64; VARIABLES] {
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
        value
    }

    /// Return the slip at the end of the last step or at a time within it, and the largest speed of the contact so far.
    pub(crate) fn slip_at(&self, elapsed: f64) -> ([f64; 2], f64) {
        let value = if elapsed == self.elapsed() {
            self.value
        } else {
            self.value_at(elapsed)
        };
        let unit = self.length * self.rate;
        (
            ContactState::of(&value).slip.map(|x| x * unit),
            self.quickest * unit,
        )
    }

    /// Return the part of ω along the plane at the end of the last step or at a time within it, and the largest |ω| so far.
    pub(crate) fn turn_at(&self, elapsed: f64) -> ([f64; 2], f64) {
        let value = if elapsed == self.elapsed() {
            self.value
        } else {
            self.value_at(elapsed)
        };
        (self.turn_of(&value), self.fastest * self.rate)
    }

    fn turn_of(&self, value: &[f64; VARIABLES]) -> [f64; 2] {
        let state = ContactState::of(value);
        level_axes(state.attitude).map(|axis| dot(axis, state.omega) * self.rate)
    }

    /// Return the direction of that part of ω at the start of the last step, and its size.
    pub(crate) fn turn_before(&self) -> ([f64; 2], f64) {
        let [x, y] = self.turn_of(&self.before[0]);
        let rate = x.hypot(y);
        ([x / rate, y / rate], rate)
    }

    /// Return whether the last step is the first one with its equations.
    pub(crate) fn is_fresh(&self) -> bool {
        self.steps_here == 1
    }

    /// Return the direction of the slip at the start of the last step, and its speed.
    pub(crate) fn slip_before(&self) -> ([f64; 2], f64) {
        if let Regime::Parting { direction, .. } = self.regime {
            return (direction, 0.0);
        }
        let [x, y] = ContactState::of(&self.before[0]).slip;
        let speed = x.hypot(y);
        ([x / speed, y / speed], speed * self.length * self.rate)
    }

    /// Return how fast the speed of the slip falls at the start of the last step, in the direction of the run.
    pub(crate) fn fall_of_slip(&self) -> f64 {
        let [x, y] = ContactState::of(&self.before[0]).slip;
        let [x_rate, y_rate] = [12, 13].map(|i| self.series.coefficients()[i][1]);
        let fall = -(x * x_rate + y * y_rate) / x.hypot(y) * self.end.signum();
        fall * self.length * self.rate * self.rate
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
        let [value, change] = self.output_until(2, elapsed);
        value > 1.01 * change + SURE * value.abs()
    }

    /// The same for what multiplies the normal force in its equation.
    pub(crate) fn is_unique_until(&self, elapsed: f64) -> bool {
        let [value, change] = self.output_until(3, elapsed);
        value > 1.01 * change + SURE
    }

    /// The same for what is left of dry friction, `μ N − |F_t|`.
    pub(crate) fn is_held_until(&self, mu: f64, elapsed: f64) -> bool {
        let [x, y, normal] = [0, 1, 2].map(|number| self.output_until(number, elapsed));
        let least = mu * (normal[0] - 1.01 * normal[1]);
        let most = x[0].hypot(y[0]) + 1.01 * (x[1] + y[1]);
        least > most + SURE * least.abs()
    }

    /// The same for the slip in the direction that it has at the start of the step.
    pub(crate) fn slips_until(&self, elapsed: f64) -> bool {
        let [x, y] = ContactState::of(&self.before[0]).slip;
        let change = 1.01 * self.most_change(12..14, elapsed);
        x.hypot(y) * (1.0 - SURE) > change
    }

    /// Return an output at the start of the last step, and by how much it changes up to a time within the step, at most.
    fn output_until(&self, number: usize, elapsed: f64) -> [f64; 2] {
        let part = ((elapsed * self.rate - self.from.0) - self.from.1).abs();
        let terms = &self.series.output(number)[..self.order];
        let change = terms[1..]
            .iter()
            .rfold(0.0, |sum, term| (sum + term.abs()) * part);
        [terms[0], change]
    }

    /// Return by how much the normal changes in body axes up to a time within the last step, at most.
    pub(crate) fn most_change_of_normal(&self, elapsed: f64) -> f64 {
        self.most_change(7..10, elapsed) * 1.01
    }

    fn most_change(&self, variables: std::ops::Range<usize>, elapsed: f64) -> f64 {
        let part = ((elapsed * self.rate - self.from.0) - self.from.1).abs();
        let changes = self.series.coefficients()[variables].iter().map(|terms| {
            let terms = terms[1..=self.order].iter();
            terms.rfold(0.0, |sum, term| (sum + term.abs()) * part)
        });
        changes.sum()
    }

    /// Return the normal in body axes at the start of the last step.
    pub(crate) fn normal_before(&self) -> Vector3<f64> {
        ContactState::of(&self.before[0]).normal.into()
    }

    fn to_phase(&self, value: &[f64; VARIABLES]) -> Phase {
        let mut state = ContactState::of(value);
        let contact = self.contact_in_units();
        let phase = if self.regime == Regime::Flying {
            self.equations.flying_phase(&contact, &state)
        } else {
            self.equations.phase(&contact, &state)
        };
        state.omega = state.omega.map(|x| x * self.rate);
        let speed = self.length * self.rate;
        Phase {
            omega: state.omega.into(),
            position: phase.position * self.length,
            velocity: phase.velocity * speed,
            internal_state: if works(&self.contact) {
                Box::new([state.work * (self.mass * speed * speed)])
            } else {
                Box::default()
            },
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
