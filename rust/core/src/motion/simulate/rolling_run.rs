//! The run of a body on a plane: its steps, outputs and events, where it lifts off, slips and rolls, and the extremes of its contact.
//!
//! The run follows one regime after the other. The functions that end a regime are looked at first in each step, and the events of the
//! caller up to the end that they find.

use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::ControlFlow;

use nalgebra::Vector3;

use super::events::{EventDetector, Events};
use super::stepper::Dense;
use crate::error::{Error, MotionFault};
use crate::motion::integrate::rolling::{Regime, RollingSeries};
use crate::motion::problem::limits::check_steps;
use crate::motion::problem::{
    ContactEvent, ContactExtremes, Crossing, Direction, End, Rule, Run, Task,
};
use crate::motion::rolling::equations::Equations;
use crate::motion::rolling::force::{Instant, instant_of, speed_of_contact};
use crate::motion::rolling::{Contact, ContactPhase, Law, LiftOff};
use crate::motion::state::Phase;

/// A slip that is no larger than that, relative to the speed of the contact, or than a part of the error that a step may have, has
/// ceased.
const CEASED: f64 = 64.0 * f64::EPSILON;
const OF_TOLERANCE: f64 = 0.01;
/// Where a slip is no larger than so many errors of a step, and a step in which it falls does not make it smaller, it has ceased too:
/// where friction is only just enough to brake it, the errors are as large as what a step brakes.
const OF_LOST_SLIP: f64 = 16.0;
/// A slip that falls and would be gone within that part of the time since the start has ceased: no step is so small.
const OF_TIME: f64 = 8.0 * f64::EPSILON;
/// How often the part of a step in which a slip or a height is looked for is made smaller.
const HALVINGS: usize = 12;
/// How near to the edge of the cone of friction it is not known whether a body rolls, relative to the force.
const EDGE: f64 = 1e-12;
/// Where the equation for the normal force multiplies it by less, a step that fails fails for that reason.
const SINGULAR: f64 = 1e-2;

/// A body on a plane under uniform gravity.
struct Rolling<'a> {
    task: &'a Task<'a>,
    contact: &'a Contact,
    equations: Equations,
    /// What the body does now, and in which direction it slips at the start of the step.
    phase: Cell<ContactPhase>,
    direction: Cell<[f64; 2]>,
    /// Whether the step is the first one of its regime, at whose start a slip or a height may be zero.
    is_fresh: Cell<bool>,
    /// The direction of the part of ω along the plane at the start of the step.
    turn: Cell<[f64; 2]>,
    /// How many functions of the caller there are.
    count: usize,
    /// Looks at parts of steps so far.
    looks: Cell<u64>,
}

/// A function whose passage from above through zero ends a regime.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Limit {
    /// The normal force.
    Pressure,
    /// How far the contact is from where it is lost.
    Margin,
    /// What multiplies the normal force in its equation.
    Bracket,
    /// What is left of dry friction.
    Hold,
    /// The slip in the direction that it has at the start of the step.
    Slip,
    /// The same of the part of ω along the plane.
    Turn,
    /// The height of the lowest point over the plane.
    Height,
}

impl Rolling<'_> {
    fn instant(&self, phase: &Phase) -> Instant {
        self.instant_in(phase, self.phase.get())
    }

    fn instant_in(&self, phase: &Phase, contact_phase: ContactPhase) -> Instant {
        let (body, contact) = (self.task.body, self.contact);
        instant_of(&self.equations, body, contact, phase, contact_phase)
    }

    fn margin(&self, phase: &Phase) -> f64 {
        let normal = phase.attitude.inverse() * *self.contact.normal;
        self.contact.surface.margin(&normal)
    }

    /// Compute a function that ends a regime.
    fn value(&self, limit: Limit, phase: &Phase) -> f64 {
        match limit {
            Limit::Pressure => self.instant(phase).normal_force,
            Limit::Margin => self.margin(phase),
            Limit::Bracket => self.instant(phase).bracket,
            Limit::Hold => self.hold(&self.instant(phase))[0],
            Limit::Slip => {
                let [x, y] = self.direction.get();
                let state = self.equations.state(self.contact, phase);
                let slip = state.slip;
                let speed = speed_of_contact(self.contact, &state, phase);
                self.without_rounding(x * slip[0] + y * slip[1], speed)
            }
            Limit::Turn => {
                let axes = self.contact.plane_axes();
                let turn = axes.transpose() * (phase.attitude * phase.omega);
                let [x, y] = self.turn.get();
                x * turn.x + y * turn.y
            }
            Limit::Height => {
                let far = (phase.position - self.contact.point).norm();
                let height = self.instant(phase).residual[0];
                self.without_rounding(height, 1.0 + far / self.contact.surface.size())
            }
        }
    }

    /// Return a value that rises from zero in the first step of a regime without its rounding errors, which have any sign.
    fn without_rounding(&self, value: f64, size: f64) -> f64 {
        if self.is_fresh.get() && value.abs() <= CEASED * size {
            f64::MIN_POSITIVE
        } else {
            value
        }
    }

    /// Compute what is left of dry friction, `μ N − |F_t|`, and `μ N`.
    fn hold(&self, instant: &Instant) -> [f64; 2] {
        let most = self.contact.friction().coefficient() * instant.normal_force;
        let across = instant.force - *self.contact.normal * instant.normal_force;
        [most - across.norm(), most]
    }

    /// Return the functions that end a regime.
    fn limits(&self, regime: Regime) -> Vec<Limit> {
        if regime == Regime::Flying {
            return vec![Limit::Height];
        }
        let mut limits = vec![Limit::Pressure, Limit::Margin];
        if self.contact.resistance.arm > 0.0 {
            limits.push(Limit::Turn);
        }
        match (regime, self.contact.law) {
            (Regime::Rolling, Law::Dry(_)) => limits.push(Limit::Hold),
            (Regime::Rolling, _) if self.contact.resistance.arm > 0.0 => {
                limits.push(Limit::Bracket);
            }
            (Regime::Rolling, _) => {}
            _ => {
                limits.push(Limit::Bracket);
                limits.extend(self.contact.friction().coulomb().map(|_| Limit::Slip));
            }
        }
        limits
    }

    /// Return what a body does at its start, or where its slip has ceased at `time`.
    fn regime_at(&self, time: f64, phase: &Phase, has_ceased: bool) -> Result<Regime, Error> {
        let state = self.equations.state(self.contact, phase);
        let turn = state.omega_along_plane();
        if self.contact.resistance.arm > 0.0 && turn <= CEASED * phase.omega.norm() {
            return Err(Error::Motion(MotionFault::ContactCannotServe {
                needs: "an omega with a part along the plane: a resistance with an arm has no direction without it; leave the arm out, or \
                        start the body turning",
            }));
        }
        if self.contact.law == Law::Rolling {
            return Ok(Regime::Rolling);
        }
        let slip = state.slip[0].hypot(state.slip[1]);
        let is_still = has_ceased || slip <= CEASED * speed_of_contact(self.contact, &state, phase);
        let friction = self.contact.friction();
        let Some(mu) = friction.coulomb().filter(|_| is_still) else {
            return Ok(Regime::Sliding);
        };
        let rolling = self.instant_in(phase, ContactPhase::Rolling);
        let [left, most] = self.hold(&rolling);
        if left.abs() <= EDGE * most {
            return Err(Error::Motion(MotionFault::OnFrictionCone {
                time,
                friction: mu,
                needed: rolling.friction_needed,
            }));
        }
        if left > 0.0 {
            return match self.contact.law {
                Law::Dry(_) => Ok(Regime::Rolling),
                _ => Err(Error::Motion(MotionFault::ContactCannotServe {
                    needs: "a body that slips: the law \"sliding\" with Coulomb's friction has no direction without a velocity of slip; \
                            give velocity, or the law \"dry\", under which it rolls",
                })),
            };
        }
        Ok(self.parting(phase, false))
    }

    /// Return how a body begins to slip.
    fn parting(&self, phase: &Phase, slowly: bool) -> Regime {
        let state = self.equations.state(self.contact, phase);
        let friction = self.contact.friction();
        let direction = self.equations.parting_direction(&state, friction);
        Regime::Parting { direction, slowly }
    }

    /// Set what the body does from a state on.
    fn begin(&self, regime: Regime) {
        self.is_fresh
            .set(matches!(regime, Regime::Parting { .. } | Regime::Flying));
        self.phase.set(match regime {
            Regime::Rolling => ContactPhase::Rolling,
            Regime::Sliding | Regime::Parting { .. } => ContactPhase::Sliding,
            Regime::Flying => ContactPhase::Flying,
        });
    }

    fn lost(&self, time: f64) -> Error {
        Error::Motion(MotionFault::NoPointOfContact {
            time: Some(time),
            law: self.contact.surface.beyond_margin(),
        })
    }
}

/// Compute the motion of `task` on the plane of `contact`.
pub(super) fn solve<E: From<Error>>(
    task: &Task<'_>,
    contact: &Contact,
    gravity: &Vector3<f64>,
    events: &mut dyn Events<Error = E>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<E> {
    let rolling = Rolling {
        task,
        contact,
        equations: Equations::new(task.body, contact, gravity),
        phase: Cell::default(),
        direction: Cell::default(),
        is_fresh: Cell::default(),
        turn: Cell::default(),
        count: events.rules().len(),
        looks: Cell::default(),
    };
    let mut run = Run::at_start(task, End::Complete);
    let regime = match rolling.regime_at(task.times[0], &task.initial, false) {
        Ok(regime) => regime,
        Err(error) => return Run::at_start(task, End::Failed(error.into())),
    };
    rolling.begin(regime);
    run.contact_phases = vec![rolling.phase.get(); run.samples.len()];
    let mut extremes = Extremes::of(&rolling, task.times[0], &task.initial);
    let end = rolling.regimes(gravity, regime, &mut run, &mut extremes, (events, watch));
    run.contact = Some(extremes.found);
    run.end = end.unwrap_or_else(End::Failed);
    run
}

/// Where a regime ends: time since the start of the run.
enum Reached<E> {
    /// The end of the run, or an event of the caller.
    End(End<E>),
    /// The zero of a function.
    Limit(Limit, f64),
    /// A time in a step from which on the step is made anew.
    Cut(f64),
}

impl Rolling<'_> {
    /// Follow one regime after the other to the end of the run.
    fn regimes<E: From<Error>>(
        &self,
        gravity: &Vector3<f64>,
        mut regime: Regime,
        run: &mut Run<E>,
        extremes: &mut Extremes,
        (events, watch): (
            &mut dyn Events<Error = E>,
            &mut dyn FnMut(f64) -> ControlFlow<()>,
        ),
    ) -> Result<End<E>, E> {
        let task = self.task;
        let (start, span) = (
            task.times[0],
            task.times[task.times.len() - 1] - task.times[0],
        );
        let mut phase = task.initial.clone();
        if self.has_lifted(start, &phase)? {
            self.cross(run, ContactEvent::LiftOff, start, &phase);
            if self.contact.lift == LiftOff::Stop {
                return Ok(End::Contact(ContactEvent::LiftOff));
            }
            regime = Regime::Flying;
            self.begin(regime);
            run.contact_phases.fill(ContactPhase::Flying);
        }
        let mut detector = EventDetector::new(events, start, &phase, span, &|_| -1.0)?;
        let mut dense = RollingStep {
            rolling: self,
            limits: Vec::new(),
            looks_at_limits: false,
            series: RollingSeries::new(
                task.body,
                self.contact,
                gravity,
                &phase,
                span,
                &task.tolerance,
                regime,
            ),
            error: PhantomData,
        };
        loop {
            let reached = self.follow(
                regime,
                &phase,
                &mut dense,
                run,
                extremes,
                (&mut detector, &mut *watch),
            );
            run.crossings.append(&mut detector.crossings);
            // Those of a contact that holds are found before the others of a step.
            (run.crossings)
                .sort_by(|a, b| (a.time - start).abs().total_cmp(&(b.time - start).abs()));
            let (limit, elapsed) = match reached? {
                Reached::End(end) => return Ok(end),
                Reached::Limit(limit, elapsed) => (Some(limit), elapsed),
                Reached::Cut(elapsed) => (None, elapsed),
            };
            let time = start + elapsed;
            phase = run.phase.clone();
            let (next, ended) = match limit {
                None if matches!(regime, Regime::Parting { .. }) => (Regime::Sliding, None),
                None => (regime, None),
                Some(limit) => self.after(limit, run, time, &phase)?,
            };
            regime = next;
            if let Some(event) = ended {
                self.cross(run, event, time, &phase);
                if event != ContactEvent::LiftOff || self.contact.lift == LiftOff::Stop {
                    return Ok(End::Contact(event));
                }
            }
            self.begin(regime);
            self.is_fresh.set(self.is_fresh.get() && limit.is_some());
            dense.series.go_on(elapsed, regime);
            phase = dense.series.phase();
            if limit.is_some() && regime != Regime::Flying && self.has_lifted(time, &phase)? {
                self.cross(run, ContactEvent::LiftOff, time, &phase);
                if self.contact.lift == LiftOff::Stop {
                    return Ok(End::Contact(ContactEvent::LiftOff));
                }
                regime = Regime::Flying;
                self.begin(regime);
                dense.series.go_on(elapsed, regime);
                phase = dense.series.phase();
            }
        }
    }

    /// Return the regime after a function that ends the last one, and what ends the run there.
    fn after<E>(
        &self,
        limit: Limit,
        run: &mut Run<E>,
        time: f64,
        phase: &Phase,
    ) -> Result<(Regime, Option<ContactEvent>), Error> {
        let is_dry = matches!(self.contact.law, Law::Dry(_));
        Ok(match limit {
            Limit::Pressure => (Regime::Flying, Some(ContactEvent::LiftOff)),
            Limit::Height => (Regime::Flying, Some(ContactEvent::Landing)),
            Limit::Turn => (Regime::Rolling, Some(ContactEvent::Rest)),
            Limit::Slip if !is_dry => (Regime::Rolling, Some(ContactEvent::Roll)),
            Limit::Margin => return Err(self.lost(time)),
            Limit::Bracket => return Err(self.not_unique(time, phase)),
            Limit::Hold => {
                self.cross(run, ContactEvent::Slip, time, phase);
                (self.parting(phase, true), None)
            }
            Limit::Slip => {
                self.cross(run, ContactEvent::Roll, time, phase);
                let next = self.regime_at(time, phase, true)?;
                if next != Regime::Rolling {
                    self.cross(run, ContactEvent::Slip, time, phase);
                }
                (next, None)
            }
        })
    }

    /// Make a step, and return the functions that change with its start: their numbers and values there.
    fn step<E>(&self, dense: &mut RollingStep<'_, E>) -> Result<Vec<(usize, f64)>, Error> {
        let time = self.task.times[0] + dense.elapsed();
        if let Err(error) = dense.series.advance() {
            let phase = dense.series.phase();
            let is_singular = self.instant(&phase).bracket < SINGULAR;
            return Err(if is_singular {
                self.not_unique(time, &phase)
            } else {
                error
            });
        }
        self.is_fresh
            .set(self.is_fresh.get() && dense.series.is_fresh());
        let mut changed = Vec::new();
        for (number, limit) in dense.limits.iter().enumerate() {
            let (direction, (along, size)) = match limit {
                Limit::Slip => (&self.direction, dense.series.slip_before()),
                Limit::Turn => (&self.turn, dense.series.turn_before()),
                _ => continue,
            };
            direction.set(along);
            changed.push((number, size));
        }
        Ok(changed)
    }

    /// Follow one regime to its end.
    fn follow<E: From<Error>>(
        &self,
        regime: Regime,
        phase: &Phase,
        dense: &mut RollingStep<'_, E>,
        run: &mut Run<E>,
        extremes: &mut Extremes,
        (detector, watch): (
            &mut EventDetector<'_, E>,
            &mut dyn FnMut(f64) -> ControlFlow<()>,
        ),
    ) -> Result<Reached<E>, E> {
        let Task {
            times, tolerance, ..
        } = self.task;
        let (start, span) = (times[0], times[times.len() - 1] - times[0]);
        dense.limits = self.limits(regime);
        let mut limits = Limits::<E>::new(self, &dense.limits);
        let now = start + dense.elapsed();
        let mut own = EventDetector::<E>::new(&mut limits, now, phase, span, &|_| -1.0)?;
        while dense.elapsed() != span {
            let from = dense.elapsed();
            for (number, value) in self.step(dense)? {
                own.set_value(number, value);
            }
            run.effort = dense.series.effort();
            let steps = run.effort.steps;
            dense.looks_at_limits = true;
            let (to, risen) = (dense.elapsed(), self.end_of_rise(dense, from));
            let mut place = own.look(dense, start, from, risen);
            if matches!(place, Ok(None)) && risen != to {
                self.is_fresh.set(false);
                place = own.look(dense, start, risen, to);
            }
            dense.looks_at_limits = false;
            let place = place?;
            let mut held = std::mem::take(&mut own.crossings);
            let (mut reached, mut ends);
            if let Some((place, _)) = place
                && let Some(last) = held.pop()
            {
                let limit = dense.limits[last.event];
                (reached, ends) = (place, Some(Reached::Limit(limit, place)));
                let half = from + 0.5 * (place - from);
                if !self.has_ceased(limit, &dense.series, place) && half != from {
                    // It passes by zero, or the series does not reach so far.
                    (reached, ends) = (half, Some(Reached::Cut(half)));
                    if limit == Limit::Slip && self.is_lost(&dense.series, half) {
                        ends = Some(Reached::Limit(limit, half));
                    }
                }
            } else {
                let ceases = [Limit::Slip, Limit::Turn];
                let gone = ceases.into_iter().find(|limit| {
                    dense.limits.contains(limit)
                        && !self.is_fresh.get()
                        && (self.has_ceased(*limit, &dense.series, to)
                            || *limit == Limit::Slip && self.is_lost(&dense.series, to))
                });
                (reached, ends) = (to, gone.map(|limit| Reached::Limit(limit, to)));
            }
            let found = detector.search_step(dense, start, [from, reached], |step, part| {
                let has_ended = part.event.is_some();
                let (last, phase) = match part.event {
                    Some(event) => event,
                    None => (part.end, step.within(part.end)?),
                };
                while let Some(&time) = times.get(run.samples.len())
                    && (time - start).abs() <= last.abs()
                {
                    let sample = match time - start {
                        at if at == last => phase.clone(),
                        at => step.within(at)?,
                    };
                    if !sample.is_finite() {
                        return Err(Error::Motion(MotionFault::NotFiniteMotion { time }).into());
                    }
                    run.samples.push(sample);
                    run.contact_phases.push(self.phase.get());
                }
                (run.time, run.phase) = (start + last, phase);
                if has_ended {
                    return Ok(ControlFlow::Break((last, End::Event)));
                }
                if watch(last / span).is_break() {
                    return Ok(ControlFlow::Break((last, End::Stopped)));
                }
                let looks = self.looks.get() + u64::from(!part.is_last);
                self.looks.set(looks);
                check_steps(tolerance.most_steps, steps + looks, start, last, span)?;
                Ok(ControlFlow::Continue(()))
            })?;
            if let ControlFlow::Break((last, end)) = found {
                (reached, ends) = (last, Some(Reached::End(end)));
            }
            held.retain(|crossing| (crossing.time - start).abs() <= reached.abs());
            for crossing in held {
                self.cross(run, ContactEvent::LiftOff, crossing.time, &crossing.phase);
            }
            if regime != Regime::Flying {
                extremes.search(self, &dense.series, start, [from, reached]);
            }
            if let Some(ends) = ends {
                return Ok(ends);
            }
        }
        Ok(Reached::End(End::Complete))
    }

    /// Return where in the first step of a regime a slip or a height that rises from zero is the largest: up to there its rounding
    /// errors do not count, and from there on it may come back to zero. The end of other steps.
    fn end_of_rise<E>(&self, dense: &RollingStep<'_, E>, from: f64) -> f64 {
        let rises = |limit: &&Limit| matches!(limit, Limit::Slip | Limit::Height);
        let mut to = dense.series.elapsed();
        let Some(limit) = dense
            .limits
            .iter()
            .find(rises)
            .filter(|_| self.is_fresh.get())
        else {
            return to;
        };
        for _ in 0..HALVINGS {
            let place = |part: usize| from + (to - from) * (part as f64 / PARTS as f64);
            let values: [f64; PARTS] =
                std::array::from_fn(|part| self.value(*limit, &dense.series.at(place(part + 1))));
            let most = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            match values.iter().position(|value| *value == most) {
                Some(part) if part + 1 == PARTS => return to,
                Some(part) if most > f64::MIN_POSITIVE => return place(part + 1),
                _ => to = place(1),
            }
        }
        to
    }

    fn cross<E>(&self, run: &mut Run<E>, event: ContactEvent, time: f64, phase: &Phase) {
        run.crossings.push(Crossing {
            event: self.count + event as usize,
            time,
            phase: phase.clone(),
        });
    }

    /// Return whether a slip or a turn is zero as far as that is known at a time within the last step; true of other functions.
    fn has_ceased(&self, limit: Limit, series: &RollingSeries, elapsed: f64) -> bool {
        let ([x, y], size) = match limit {
            Limit::Slip => series.slip_at(elapsed),
            Limit::Turn => series.turn_at(elapsed),
            _ => return true,
        };
        let error = CEASED.max(OF_TOLERANCE * self.task.tolerance.relative);
        x.hypot(y) <= error * size
    }

    /// Return whether the errors of the last step, or the rounding of the time, hide how a slip that falls goes on.
    fn is_lost(&self, series: &RollingSeries, elapsed: f64) -> bool {
        let fall = series.fall_of_slip();
        if self.is_fresh.get() || fall <= 0.0 || fall.is_nan() {
            return false;
        }
        let ([x, y], size) = series.slip_at(elapsed);
        let now = x.hypot(y);
        now <= fall * OF_TIME * elapsed.abs()
            || now <= OF_LOST_SLIP * self.task.tolerance.relative * size
                && now >= series.slip_before().1
    }

    /// Return whether the plane would have to pull where a regime begins.
    fn has_lifted(&self, time: f64, phase: &Phase) -> Result<bool, Error> {
        let instant = self.instant(phase);
        if instant.bracket <= 0.0 {
            return Err(self.not_unique(time, phase));
        }
        Ok(self.contact.lift != LiftOff::Hold && instant.normal_force < 0.0)
    }

    fn not_unique(&self, time: f64, phase: &Phase) -> Error {
        let bracket = self.instant(phase).bracket;
        Error::Motion(MotionFault::NoUniqueForce { time, bracket })
    }
}

/// The functions that end a regime.
struct Limits<'a, E> {
    rolling: &'a Rolling<'a>,
    functions: Vec<Limit>,
    rules: Vec<Rule>,
    error: PhantomData<E>,
}

impl<'a, E> Limits<'a, E> {
    fn new(rolling: &'a Rolling<'a>, limits: &[Limit]) -> Self {
        // Backward in time a body that lifts off comes down from where its force rises.
        let times = rolling.task.times;
        let direction = if times[times.len() - 1] < times[0] {
            Direction::Rising
        } else {
            Direction::Falling
        };
        let rules = limits.iter().map(|limit| {
            let holds = rolling.contact.lift == LiftOff::Hold && *limit == Limit::Pressure;
            Rule {
                direction,
                last: u64::from(!holds),
                ..Rule::default()
            }
        });
        Self {
            rolling,
            functions: limits.to_vec(),
            rules: rules.collect(),
            error: PhantomData,
        }
    }
}

impl<E> Events for Limits<'_, E> {
    type Error = E;

    fn rules(&self) -> &[Rule] {
        &self.rules
    }

    fn value(&mut self, event: usize, _: f64, phase: &Phase) -> Result<f64, E> {
        Ok(self.rolling.value(self.functions[event], phase))
    }
}

/// A step as events see it.
struct RollingStep<'a, E> {
    rolling: &'a Rolling<'a>,
    /// Of the regime.
    limits: Vec<Limit>,
    /// Whether these are the functions that are looked at, and not those of the caller.
    looks_at_limits: bool,
    series: RollingSeries,
    error: PhantomData<E>,
}

impl<E> Dense for RollingStep<'_, E> {
    type Error = E;

    fn elapsed(&self) -> f64 {
        self.series.elapsed()
    }

    fn phase(&self) -> Phase {
        self.series.phase()
    }

    fn within(&mut self, elapsed: f64) -> Result<Phase, E> {
        Ok(if elapsed == self.series.elapsed() {
            self.series.phase()
        } else {
            self.series.at(elapsed)
        })
    }

    fn stays_positive(&mut self, event: usize, _: f64, to: f64) -> Option<f64> {
        let limit = *self.limits.get(event).filter(|_| self.looks_at_limits)?;
        let surface = &self.rolling.contact.surface;
        let is_sure = match limit {
            Limit::Pressure => self.series.is_pressed_until(to),
            Limit::Bracket => self.series.is_unique_until(to),
            Limit::Hold => {
                let mu = self.rolling.contact.friction().coefficient();
                self.series.is_held_until(mu, to)
            }
            Limit::Slip => self.series.slips_until(to),
            Limit::Turn | Limit::Height => false,
            Limit::Margin => match surface.margin_slope() {
                0.0 => return Some(surface.margin(&self.series.normal_before())),
                slope => {
                    let change = slope * self.series.most_change_of_normal(to);
                    surface.margin(&self.series.normal_before()) > change
                }
            },
        };
        if !is_sure {
            return None;
        }
        let phase = self.within(to).ok()?;
        Some(self.rolling.value(limit, &phase))
    }
}

/// The parts into which a step is cut to look for extremes.
const PARTS: usize = 8;
/// A place that is below the extreme so far by more than that, relative to the range in the step, is not looked at closer.
const NEAR: f64 = 0.3;
/// An extreme of the series that is no larger than the extreme so far by that, relative to it, is none of the state either.
const CLOSE: f64 = 1e-3;
/// How often a bracket is made smaller: by the golden section 1e-8 of a part is left, where an extreme is flat to rounding.
const SECTIONS: usize = 40;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The extremes of the contact so far.
struct Extremes {
    found: ContactExtremes,
}

impl Extremes {
    fn of(rolling: &Rolling<'_>, time: f64, phase: &Phase) -> Self {
        let Instant {
            friction_needed,
            normal_force,
            ..
        } = rolling.instant(phase);
        Self {
            found: ContactExtremes {
                friction_needed: [friction(friction_needed), time],
                normal_force: [normal_force, time],
            },
        }
    }

    /// Look for larger ones in a part of the last step.
    fn search(
        &mut self,
        rolling: &Rolling<'_>,
        series: &RollingSeries,
        start: f64,
        [from, to]: [f64; 2],
    ) {
        let values = |at: f64| {
            let found = rolling.instant(&series.at(at));
            [friction(found.friction_needed), -found.normal_force]
        };
        // The series of the force tells where to look, and the state what is there.
        let mass = rolling.task.body.mass();
        let near = |at: f64| {
            let [x, y, normal] = series.force_over_mass(at);
            let tangential = x.hypot(y);
            let needed = if tangential == 0.0 {
                0.0
            } else {
                tangential / normal
            };
            [friction(needed), -normal * mass]
        };
        let place = |part: usize| from + (to - from) * (part as f64 / PARTS as f64);
        let nodes: [[f64; 2]; PARTS + 1] = std::array::from_fn(|part| near(place(part)));
        let best = [
            self.found.friction_needed,
            self.found.normal_force.map(|x| x),
        ];
        let mut best = [best[0], [-best[1][0], best[1][1]]];
        for which in 0..2 {
            let value = |part: usize| nodes[part][which];
            let (low, high) = (0..=PARTS).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), i| {
                (l.min(value(i)), h.max(value(i)))
            });
            for part in 0..=PARTS {
                let (before, after) = (part.saturating_sub(1), (part + 1).min(PARTS));
                let is_peak = value(part) >= value(before) && value(part) >= value(after);
                if !is_peak || value(part) < best[which][0] - NEAR * (high - low) {
                    continue;
                }
                let function = |at: f64| near(at)[which];
                let (at, peak) = largest(&function, place(before), place(after));
                for (at, peak) in [(at, peak), (place(part), value(part))] {
                    if peak <= best[which][0] - CLOSE * peak.abs() {
                        continue;
                    }
                    let peak = values(at)[which];
                    if peak > best[which][0] {
                        best[which] = [peak, start + at];
                    }
                }
            }
        }
        self.found = ContactExtremes {
            friction_needed: best[0],
            normal_force: [-best[1][0], best[1][1]],
        };
    }
}

/// Return the friction needed: infinite where the plane would have to pull.
fn friction(needed: f64) -> f64 {
    if needed >= 0.0 { needed } else { f64::INFINITY }
}

/// Compute the largest value in a bracket by the golden section, and where it is.
fn largest(function: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
    let at = |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let [mut a, mut b] = at(low, high);
    let (mut f_a, mut f_b) = (function(a), function(b));
    for _ in 0..SECTIONS {
        if f_a > f_b {
            (high, b, f_b) = (b, a, f_a);
            [a, _] = at(low, high);
            f_a = function(a);
        } else {
            (low, a, f_a) = (a, b, f_b);
            [_, b] = at(low, high);
            f_b = function(b);
        }
    }
    if f_a > f_b { (a, f_a) } else { (b, f_b) }
}
