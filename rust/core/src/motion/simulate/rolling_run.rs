//! The run of a body that rolls on a plane: its steps, outputs and events, where it lifts off, and the extremes of its contact.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use nalgebra::Vector3;

use super::events::{EventDetector, Events};
use super::stepper::Dense;
use crate::error::{Error, MotionFault};
use crate::motion::integrate::rolling::RollingSeries;
use crate::motion::problem::limits::check_steps;
use crate::motion::problem::{
    ContactExtremes, Crossing, Direction, End, EventTrigger, Rule, Run, Task,
};
use crate::motion::rolling::equations::Equations;
use crate::motion::rolling::force::{Instant, instant_of};
use crate::motion::rolling::{Contact, LiftOff};
use crate::motion::state::Phase;

/// A body on a plane under uniform gravity.
struct Rolling<'a> {
    task: &'a Task<'a>,
    contact: &'a Contact,
    gravity: Vector3<f64>,
    equations: Equations,
}

impl Rolling<'_> {
    fn instant(&self, phase: &Phase) -> Instant {
        instant_of(&self.equations, self.task.body, self.contact, phase)
    }

    fn margin(&self, phase: &Phase) -> f64 {
        let normal = phase.attitude.inverse() * *self.contact.normal;
        self.contact.surface.margin(&normal)
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
        gravity: *gravity,
        equations: Equations::new(task.body, contact, gravity),
    };
    let mut run = Run::at_start(task, End::Complete);
    let mut extremes = Extremes::of(&rolling, task.times[0], &task.initial);
    let end = rolling.steps(&mut run, &mut extremes, events, watch);
    run.contact = Some(extremes.found);
    run.end = end.unwrap_or_else(End::Failed);
    run
}

impl Rolling<'_> {
    fn steps<E: From<Error>>(
        &self,
        run: &mut Run<E>,
        extremes: &mut Extremes,
        events: &mut dyn Events<Error = E>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<End<E>, E> {
        let Task {
            times, tolerance, ..
        } = self.task;
        let (start, span) = (times[0], times[times.len() - 1] - times[0]);
        let mut watched = WithContact::new(self, events);
        let count = watched.count;
        if self.contact.lift == LiftOff::Stop && extremes.found.normal_force[0] < 0.0 {
            run.crossings.push(Crossing {
                event: count,
                time: start,
                phase: self.task.initial.clone(),
            });
            return Ok(End::LiftOff);
        }
        let mut detector =
            EventDetector::new(&mut watched, start, &self.task.initial, span, &|_| -1.0)?;
        let mut dense = RollingStep {
            rolling: self,
            count,
            series: RollingSeries::new(
                self.task.body,
                self.contact,
                &self.gravity,
                &self.task.initial,
                span,
                tolerance,
            ),
            error: PhantomData,
        };
        let mut ended = None;
        let mut looks = 0;
        while ended.is_none() && dense.elapsed() != span {
            let from = dense.elapsed();
            if let Err(error) = dense.series.advance() {
                run.crossings = detector.crossings;
                return Err(error.into());
            }
            let reached = dense.elapsed();
            run.effort = dense.series.effort();
            let steps = run.effort.steps;
            let found = detector.search_step(&mut dense, start, [from, reached], |step, part| {
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
                }
                (run.time, run.phase) = (start + last, phase);
                if has_ended {
                    return Ok(ControlFlow::Break((last, End::Event)));
                }
                if watch(last / span).is_break() {
                    return Ok(ControlFlow::Break((last, End::Stopped)));
                }
                looks += u64::from(!part.is_last);
                check_steps(tolerance.most_steps, steps + looks, start, last, span)?;
                Ok(ControlFlow::Continue(()))
            });
            let last = match found {
                Ok(ControlFlow::Continue(())) => reached,
                Ok(ControlFlow::Break((last, end))) => {
                    ended = Some(end);
                    last
                }
                Err(error) => {
                    run.crossings = detector.crossings;
                    return Err(error);
                }
            };
            extremes.search(self, &dense.series, start, [from, last]);
        }
        run.crossings = detector.crossings;
        let Some(end) = ended else {
            return Ok(End::Complete);
        };
        match run.crossings.last().map(|crossing| crossing.event) {
            Some(event) if event == count && matches!(end, End::Event) => Ok(End::LiftOff),
            Some(event) if event > count && matches!(end, End::Event) => {
                run.crossings.pop();
                Err(Error::Motion(MotionFault::NoPointOfContact {
                    time: Some(run.time),
                    law: self.contact.surface.beyond_margin(),
                })
                .into())
            }
            _ => Ok(end),
        }
    }
}

/// Functions whose zeros are events, and after them the normal force and how far the contact is from where it is lost.
struct WithContact<'a, E> {
    events: &'a mut dyn Events<Error = E>,
    rules: Vec<Rule>,
    /// Of the functions.
    count: usize,
    rolling: &'a Rolling<'a>,
}

impl<'a, E> WithContact<'a, E> {
    fn new(rolling: &'a Rolling<'a>, events: &'a mut dyn Events<Error = E>) -> Self {
        let mut rules = events.rules().to_vec();
        let count = rules.len();
        let falling = |last| Rule {
            direction: Direction::Falling,
            last,
            trigger: EventTrigger::Function,
        };
        let ends = u64::from(rolling.contact.lift == LiftOff::Stop);
        rules.extend([falling(ends), falling(1)]);
        // Backward in time a body that lifts off comes down from where its force rises.
        let span = rolling.task.times[rolling.task.times.len() - 1] - rolling.task.times[0];
        if span < 0.0 {
            for rule in &mut rules[count..] {
                rule.direction = Direction::Rising;
            }
        }
        Self {
            events,
            rules,
            count,
            rolling,
        }
    }
}

impl<E> Events for WithContact<'_, E> {
    type Error = E;

    fn rules(&self) -> &[Rule] {
        &self.rules
    }

    fn value(&mut self, event: usize, t: f64, phase: &Phase) -> Result<f64, E> {
        match event.checked_sub(self.count) {
            None => self.events.value(event, t, phase),
            Some(0) => Ok(self.rolling.instant(phase).normal_force),
            Some(_) => Ok(self.rolling.margin(phase)),
        }
    }
}

/// A step as events see it.
struct RollingStep<'a, E> {
    rolling: &'a Rolling<'a>,
    /// Of the functions before the normal force.
    count: usize,
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
        let number = event.checked_sub(self.count)?;
        let surface = &self.rolling.contact.surface;
        let is_sure = match number {
            0 => self.series.is_pressed_until(to),
            _ => match surface.margin_slope() {
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
        Some(match number {
            0 => self.rolling.instant(&phase).normal_force,
            _ => self.rolling.margin(&phase),
        })
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
