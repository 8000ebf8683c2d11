//! A motion under way with its derivatives by the variables of one block.

use std::ops::ControlFlow;

use nalgebra::Vector3;

use super::acts::{Act, Place};
use super::inertia::Inertia;
use super::motion::{Motion, Units};
use super::numbers::{
    Block, Columns, Number, ORDER, Quadruple, Vector, ZERO, add, apply, begin, dot, extend,
    increment, plus, quaternion_product, times, turn_product,
};
use super::orbit::Orbiting;
use super::pace::Pace;
use super::parameters::{ATTITUDE, LOAD, RATES, count};
use crate::error::{Error, MotionFault};
use crate::motion::attitude::from_axes;
use crate::motion::loads::{GravityGradient, Term};
use crate::motion::problem::Task;
use crate::motion::problem::limits::{HELD, check_steps, spans};
use crate::numerics::double_double::two_sum;
use crate::numerics::power_of_two::power_below;
use crate::numerics::sign_changes::sign_changes;

/// Steps between two looks at the watch.
const PATIENCE: u32 = 16;
/// How far ω may outgrow the unit of rates before another is taken.
const OUTGROWN: f64 = 65_536.0;

/// A motion between two breaks of its load. Times are since the start.
pub(super) struct Walk<'a> {
    pub(super) task: &'a Task<'a>,
    terms: &'a [Term],
    pub(super) block: Block,
    pub(super) inertia: Inertia,
    pub(super) units: Units,
    /// What rounding has left out of a number stands beside it.
    pub(super) omega: [Vector; 2],
    pub(super) attitude: [Quadruple; 2],
    now: (f64, f64),
    /// The terms that act, but for the gradients, which all go along: by the number of the term, and whether it acts.
    acts: Vec<Act>,
    orbits: Vec<(usize, bool, Orbiting<'a>)>,
    pub(super) motion: Motion,
    paces: [Pace; 2],
    fastest: f64,
}

impl<'a> Walk<'a> {
    /// At the start.
    pub(super) fn new(task: &'a Task<'a>, terms: &'a [Term], block: Block) -> Self {
        let inertia = Inertia::new(task, block);
        let units = Units {
            inertia: inertia.unit,
            rate: 1.0,
        };
        let q = (task.initial.attitude * from_axes(&inertia.axes)).into_inner();
        let q = [q.i, q.j, q.k, q.w].map(Number::constant);
        let tilt = inertia.principal(&block.vector(&Vector3::zeros(), ATTITUDE), 0.5);
        let one = Number::constant(1.0);
        let attitude = quaternion_product(&q, &[tilt[0], tilt[1], tilt[2], one]);
        let omega = inertia.principal(&block.vector(&task.initial.omega, RATES), 1.0);
        Self {
            task,
            terms,
            block,
            inertia,
            units,
            omega: [omega, [ZERO; 3]],
            attitude: [attitude, [ZERO; 4]],
            now: (0.0, 0.0),
            acts: Vec::new(),
            orbits: Vec::new(),
            motion: Motion::default(),
            paces: [Pace::default(); 2],
            fastest: 0.0,
        }
    }

    /// To the last time of the task; `give` gets the derivatives at each time after the first.
    ///
    /// # Errors
    /// When a term cannot act, the motion cannot go on, or `watch`, which gets the fraction done, stops it.
    pub(super) fn run(
        &mut self,
        give: &mut dyn FnMut(usize, &Columns),
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        let times = self.task.times;
        let bounds = spans(times, self.terms.iter().flat_map(Term::breaks).collect());
        let (start, end) = (times[0], times[times.len() - 1]);
        for pair in bounds.windows(2) {
            for term in self
                .terms
                .iter()
                .filter_map(|term| term.active(middle(pair)))
            {
                term.check(&self.task.subject, pair[0], pair[1])?;
            }
        }
        let (mut next, mut patience) = (1, PATIENCE);
        let (mut steps, mut held) = (0, 0);
        for pair in bounds.windows(2) {
            self.enter(pair)?;
            loop {
                self.expand();
                let left = self.since_now(pair[1]);
                let (h, flip) = self.length(left.abs())?;
                let h = h.copysign(left);
                while let Some(&t) = times.get(next)
                    && self.since_now(t).abs() <= h.abs()
                {
                    give(next, &self.columns(self.since_now(t)));
                    next += 1;
                }
                let least = 4.0 * f64::EPSILON * self.now.0.abs() * self.units.rate;
                self.step(h);
                steps += 1;
                if let Some(index) = flip {
                    self.flip(index);
                    held = if h.abs() > least { 0 } else { held + 1 };
                    if held > HELD {
                        let (time, step) = (self.time(), h / self.units.rate);
                        return Err(MotionFault::StepTooSmall { time, step }.into());
                    }
                } else if h == left {
                    self.now = two_sum(pair[1], -start);
                    break;
                }
                if self.omega[0].iter().any(|x| x.value.abs() > OUTGROWN) {
                    self.enter(pair)?;
                }
                patience -= 1;
                if patience == 0 {
                    patience = PATIENCE;
                    check_steps(steps, start, self.now.0, end - start)?;
                    if watch(self.now.0 / (end - start)).is_break() {
                        return Err(Error::Stopped);
                    }
                }
            }
        }
        Ok(())
    }

    /// The time from now to `t`, in units of time.
    fn since_now(&self, t: f64) -> f64 {
        let (elapsed, rest) = two_sum(t, -self.task.times[0]);
        ((elapsed - self.now.0) + (rest - self.now.1)) * self.units.rate
    }

    fn time(&self) -> f64 {
        self.task.times[0] + (self.now.0 + self.now.1)
    }

    /// Takes a unit of rates and the terms that act in a span.
    fn enter(&mut self, span: &[f64]) -> Result<(), Error> {
        let rate = self.fastest_rate(span)?;
        let ratio = self.units.rate / rate;
        self.omega = self.omega.map(|omega| times(&omega, ratio));
        self.fastest *= ratio;
        self.units.rate = rate;
        self.paces = [Pace::default(); 2];
        let (q, middle) = (self.attitude[0], middle(span));
        let is_first = self.orbits.is_empty();
        for (_, acts, orbit) in &mut self.orbits {
            orbit.rescale(rate);
            *acts = false;
        }
        self.acts.clear();
        let mut first = LOAD;
        for (index, term) in self.terms.iter().enumerate() {
            let subject = &self.task.subject;
            if is_first && let Some(gradient) = gradient(term) {
                let mut orbit = Orbiting::new(gradient, subject, self.block, first, rate);
                orbit.board(&q);
                self.orbits.push((index, false, orbit));
            }
            if let Some(active) = term.active(middle) {
                let place = Place {
                    block: self.block,
                    first,
                    middle,
                    inertia: &self.inertia,
                    subject,
                    units: self.units,
                };
                self.acts.extend(place.acts(active)?);
                for (own, acts, _) in &mut self.orbits {
                    *acts |= *own == index;
                }
            }
            first += count(term);
        }
        for act in &mut self.acts {
            act.take_sign(&q);
        }
        Ok(())
    }

    /// The power of two at or below the fastest rate of the motion.
    fn fastest_rate(&self, span: &[f64]) -> Result<f64, Error> {
        let (t, phase, subject) = (self.time(), self.phase(), &self.task.subject);
        let euler = &self.task.euler;
        let acting = || {
            self.terms
                .iter()
                .filter_map(|term| term.active(middle(span)))
        };
        let torque = acting().map(|term| term.wrench(subject, t, &phase).torque);
        let (w, n) = (
            self.inertia.axes.tr_mul(&phase.omega),
            self.inertia.axes.tr_mul(&torque.sum::<Vector3<f64>>()),
        );
        let mut rate = (w.norm()).max(euler.principal_acceleration(&w, &n)?.norm().sqrt());
        let least = euler.moments().into_iter().find(|moment| *moment > 0.0);
        let over_moment = least.map_or(0.0, |moment| 1.0 / moment);
        for term in acting() {
            rate = rate.max(match term {
                Term::Damping(damping) => damping.linear.amax() * over_moment,
                Term::Feedback(feedback) => (feedback.stiffness.amax() * over_moment)
                    .sqrt()
                    .max(feedback.damping.amax() * over_moment),
                _ => 0.0,
            });
        }
        for gradient in self.terms.iter().filter_map(gradient) {
            let (r, v) = gradient.orbit_at(subject, t);
            rate = rate.max(v.norm() / r.norm());
        }
        Ok(power_below(if rate > 0.0 {
            rate
        } else {
            1.0 / (span[1] - span[0]).abs()
        }))
    }

    /// The series of a step that begins now.
    fn expand(&mut self) {
        let (t, q) = (self.time(), self.attitude[0]);
        let speed = dot(&self.omega[0], &self.omega[0]).value.sqrt();
        self.fastest = self.fastest.max(speed);
        // At rest, what the load makes of it is large.
        let fastest = if self.fastest > 0.0 {
            self.fastest
        } else {
            1.0
        };
        begin(&mut self.motion.omega, &self.omega[0]);
        begin(&mut self.motion.attitude, &q);
        for act in &mut self.acts {
            act.start(t, &self.inertia, &q);
        }
        for (_, _, orbit) in &mut self.orbits {
            orbit.settle(&self.task.subject, t, &q);
            orbit.start();
        }
        for k in 0..ORDER {
            let mut torque = self.inertia.gyration(&self.motion.omega, k);
            for act in &mut self.acts {
                torque = plus(&torque, &act.coefficient(k, &self.motion, fastest));
            }
            for (_, acts, orbit) in &mut self.orbits {
                orbit.advance(k, &self.motion.omega);
                if *acts {
                    torque = plus(&torque, &orbit.torque(k, &self.inertia));
                }
            }
            let turn = turn_product(&self.motion.attitude, &self.motion.omega, k);
            extend(
                &mut self.motion.omega,
                &apply(&self.inertia.inverse, &torque),
            );
            extend(&mut self.motion.attitude, &times(&turn, 0.5));
        }
    }

    /// How long the step is, at most `left`, and which act changes its law at its end.
    fn length(&mut self, left: f64) -> Result<(f64, Option<usize>), Error> {
        let [pace, turning] = &mut self.paces;
        let mut h = pace.longest(&[&self.motion.omega]);
        // Not a number wherever one of them is not.
        let mut within = |other: f64| h = if other >= h { h } else { other };
        within(turning.longest(&[&self.motion.attitude]));
        for (_, _, orbit) in &mut self.orbits {
            within(orbit.longest());
        }
        let fastest = if self.fastest > 0.0 {
            self.fastest
        } else {
            1.0
        };
        for act in &self.acts {
            within(act.limit(&self.motion, fastest));
        }
        if h.is_nan() {
            return Err(MotionFault::NotFiniteMotion { time: self.time() }.into());
        }
        if h < left && h / self.units.rate <= f64::EPSILON * self.now.0.abs() {
            return Err(MotionFault::StepTooSmall {
                time: self.time(),
                step: h / self.units.rate,
            }
            .into());
        }
        h = h.min(left);
        let sense = if self.direction() { 1.0 } else { -1.0 };
        let mut flip = (h, None);
        for (index, act) in self.acts.iter().enumerate() {
            let Some((mut series, side)) = act.switch(&self.motion) else {
                continue;
            };
            let mut power = 1.0;
            for coefficient in &mut series {
                *coefficient *= power;
                power *= h * sense;
            }
            if let Some(place) = sign_changes(&series, Some(side)).first()
                && place * h < flip.0
            {
                flip = (place * h, Some(index));
            }
        }
        Ok(flip)
    }

    /// Whether the motion goes forward in time.
    fn direction(&self) -> bool {
        let times = self.task.times;
        times[times.len() - 1] >= times[0]
    }

    /// By the time `h`.
    fn step(&mut self, h: f64) {
        add(
            &mut self.omega,
            &[0, 1, 2].map(|i| increment(&self.motion.omega[i], h)),
        );
        add(
            &mut self.attitude,
            &[0, 1, 2, 3].map(|i| increment(&self.motion.attitude[i], h)),
        );
        // Back to unit length, to first order.
        let q = self.attitude[0];
        let excess = dot(&q, &q) - Number::constant(1.0);
        add(&mut self.attitude, &q.map(|x| -(x * excess * 0.5)));
        for (_, _, orbit) in &mut self.orbits {
            orbit.step(h);
        }
        let (now, rest) = self.now;
        self.now = two_sum(now, rest + h / self.units.rate);
    }

    /// Past the change of the law of one act: beyond it a neighbour that comes to it later by δτ has been `δτ (ω̇₋ − ω̇₊)` longer under
    /// the old one.
    fn flip(&mut self, index: usize) {
        if let Some((torque, delay)) = self.acts[index].flip(&self.omega[0], &self.attitude[0]) {
            let jump = apply(&self.inertia.inverse, &torque);
            for (omega, jump) in self.omega[0].iter_mut().zip(jump) {
                for (slope, delay) in omega.slopes.iter_mut().zip(delay) {
                    *slope += jump.value * delay;
                }
            }
        }
    }
}

/// The gravity gradient that a term is, or would be when it is switched on.
fn gradient(term: &Term) -> Option<&GravityGradient> {
    match term {
        Term::GravityGradient(gradient) => Some(gradient),
        Term::Scheduled { term, .. } => gradient(term),
        _ => None,
    }
}

/// A time within a span.
fn middle(span: &[f64]) -> f64 {
    span[0] + 0.5 * (span[1] - span[0])
}
