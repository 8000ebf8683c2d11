//! Events: the times at which a function of time and state passes through zero, and the search for them, step by step.

use std::ops::ControlFlow;

use super::roots_in_step::{Look, MOST_LOOKS, RootSearch, sign};
use super::stepper::Dense;
use crate::error::{Error, MotionFault};
use crate::motion::loads::LawSwitch;
use crate::motion::problem::{Crossing, Direction, EventTrigger, Rule};
use crate::motion::state::Phase;

/// Functions whose passages through zero are events.
pub trait Events {
    /// As of the load.
    type Error;

    /// One rule for each function.
    fn rules(&self) -> &[Rule];

    /// The function of number `event` at time `t`.
    ///
    /// # Errors
    /// Ends the run and comes back to the caller as it is.
    fn value(&mut self, event: usize, t: f64, phase: &Phase) -> Result<f64, Self::Error>;
}

/// No events.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoEvents<E>(std::marker::PhantomData<E>);

impl<E> NoEvents<E> {
    /// None of them.
    #[must_use]
    pub fn new() -> Self {
        Self(std::marker::PhantomData)
    }
}

impl<E> Events for NoEvents<E> {
    type Error = E;

    fn rules(&self) -> &[Rule] {
        &[]
    }

    fn value(&mut self, _: usize, _: f64, _: &Phase) -> Result<f64, E> {
        Ok(f64::NAN)
    }
}

/// How far the body turns in a part of a step, in radians.
const PART_OF_STEP: f64 = 100.0;
/// Parts of the run in each of which every function is looked at, however still the body is.
const PARTS_OF_RUN: f64 = 16.0;

/// A change of the law so near to the start of a run, relative to its length, is the one at which the run before ended.
const AT_ONCE: f64 = 1e-9;

/// A part of a step that was searched for events.
pub(super) struct PartOfStep {
    /// Its end: time since the start of the span.
    pub(super) end: f64,
    /// Whether the step ends there too.
    pub(super) is_last: bool,
    /// The event at which the run is to end, if one is within the part: time since the start of the span, and the state then.
    pub(super) event: Option<(f64, Phase)>,
}

/// The functions as a run goes on.
pub(super) struct EventDetector<'a, E> {
    events: &'a mut dyn Events<Error = E>,
    rules: Vec<Rule>,
    /// The sign each function had when it was last not zero, and zero after it was found at zero.
    signs: Vec<f64>,
    /// Its value where the last step ended.
    values: Vec<f64>,
    counts: Vec<u64>,
    /// How many looks at parts that were halved are left for each.
    left: Vec<u64>,
    /// When the run begins.
    start: f64,
    /// The length of the run, negative where it goes back in time.
    span: f64,
    pub(super) crossings: Vec<Crossing>,
}

impl<'a, E: From<Error>> EventDetector<'a, E> {
    pub(super) fn new(
        events: &'a mut dyn Events<Error = E>,
        t: f64,
        phase: &Phase,
        span: f64,
        over_limit: &dyn Fn(Option<usize>) -> f64,
    ) -> Result<Self, E> {
        let rules = events.rules().to_vec();
        let values = (0..rules.len())
            .map(|event| match rules[event].trigger {
                EventTrigger::Function => events.value(event, t, phase),
                EventTrigger::Limit(state) => Ok(over_limit(Some(state))),
                EventTrigger::DipoleLimit => Ok(over_limit(None)),
                _ => Ok(f64::NAN),
            })
            .collect::<Result<Vec<_>, E>>()?;
        Ok(Self {
            events,
            signs: (values.iter().zip(&rules))
                .map(|(value, rule)| if rule.has_passed { 0.0 } else { sign(*value) })
                .collect(),
            start: t,
            values,
            counts: vec![0; rules.len()],
            left: vec![MOST_LOOKS; rules.len()],
            rules,
            span,
            crossings: Vec::new(),
        })
    }

    /// Search the last step for events, in parts so that the run can be stopped between them. `visit` gets each part after it was
    /// searched; where it breaks, the rest of the step is left.
    #[inline]
    pub(super) fn search_step<B>(
        &mut self,
        step: &mut dyn Dense<Error = E>,
        start: f64,
        [from, to]: [f64; 2],
        mut visit: impl FnMut(&mut dyn Dense<Error = E>, PartOfStep) -> Result<ControlFlow<B>, E>,
    ) -> Result<ControlFlow<B>, E> {
        let parts = self.parts(step.turn(to - from));
        let (mut part, mut begin) = (0.0, from);
        while part < parts {
            part += 1.0;
            let is_last = part == parts;
            let end = if is_last {
                to
            } else {
                from + (to - from) * (part / parts)
            };
            let event = self.look(step, start, begin, end)?;
            let visited = PartOfStep {
                end,
                is_last,
                event,
            };
            if let ControlFlow::Break(value) = visit(step, visited)? {
                return Ok(ControlFlow::Break(value));
            }
            begin = end;
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Into how many parts a step is cut in which the body turns by so many radians.
    fn parts(&self, turn: f64) -> f64 {
        if self.rules.is_empty() || turn.is_nan() {
            return 1.0;
        }
        (turn / PART_OF_STEP).ceil().max(1.0)
    }

    /// Looks through the last step, or a part of it; where the run is to end, if it is, as time since the span's start and the
    /// state there.
    pub(super) fn look(
        &mut self,
        stepper: &mut dyn Dense<Error = E>,
        start: f64,
        from: f64,
        to: f64,
    ) -> Result<Option<(f64, Phase)>, E> {
        if self.rules.is_empty() {
            return Ok(None);
        }
        // Where a function ends the run, the others are looked at no further.
        let (mut found, mut to) = (Vec::new(), to);
        for event in 0..self.rules.len() {
            let (events, rule) = (&mut *self.events, self.rules[event]);
            let trigger = rule.trigger;
            if !trigger.is_searched() {
                continue; // told by the load
            }
            if self.signs[event] > 0.0
                && let Some(value) = stepper.stays_positive(event, from, to)
            {
                self.values[event] = value;
                continue;
            }
            let turn = stepper.turn(to - from);
            let mut search = RootSearch {
                function: &mut |stepper, at, phase| match trigger {
                    EventTrigger::Limit(state) => Ok(stepper.over_limit(Some(state), at, phase)),
                    EventTrigger::DipoleLimit => Ok(stepper.over_limit(None, at, phase)),
                    _ => events.value(event, start + at, phase),
                },
                event: Some(event),
                stepper: &mut *stepper,
                start,
                end: to,
                longest: self.span.abs() / PARTS_OF_RUN,
                halved: None,
                left: &mut self.left[event],
            };
            let mut before = Look {
                at: from,
                value: self.values[event],
            };
            let (last_sign, mut count) = (&mut self.signs[event], self.counts[event]);
            let forward = self.span > 0.0;
            search.visit_looks(before, turn, &mut |search, after| {
                let (was, is) = (*last_sign, sign(after.value));
                let bracket = [before, after];
                before = after;
                if was * is > 0.0 || was == 0.0 {
                    *last_sign = if was == 0.0 { is } else { was };
                    return Ok(ControlFlow::Continue(()));
                }
                *last_sign = is;
                if is.is_nan() || was.is_nan() {
                    return Ok(ControlFlow::Continue(()));
                }
                let rising = (was < 0.0) == forward;
                let counts = match rule.direction {
                    Direction::Any => true,
                    Direction::Rising => rising,
                    Direction::Falling => !rising,
                };
                if counts {
                    let place = if is == 0.0 {
                        after.at
                    } else {
                        search.locate(bracket, was)?
                    };
                    found.push((place, event));
                    count += 1;
                    if count == rule.last {
                        to = place;
                        return Ok(ControlFlow::Break(()));
                    }
                }
                Ok(ControlFlow::Continue(()))
            })?;
            self.values[event] = before.value;
        }
        found.sort_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()));
        for (place, event) in found {
            let phase = if place == stepper.elapsed() {
                stepper.phase()
            } else {
                stepper.within(place)?
            };
            let time = start + place;
            if !phase.is_finite() {
                return Err(Error::Motion(MotionFault::NotFiniteMotion { time }).into());
            }
            if self.count(event, time, &phase) {
                return Ok(Some((place, phase)));
            }
        }
        Ok(None)
    }

    /// Set the value of a function at the start of the next step, where its definition changes there.
    pub(super) fn set_value(&mut self, event: usize, value: f64) {
        self.values[event] = value;
    }

    /// Counts an event; whether the run is to end there.
    fn count(&mut self, event: usize, time: f64, phase: &Phase) -> bool {
        self.crossings.push(Crossing {
            event,
            time,
            phase: phase.clone(),
        });
        self.counts[event] += 1;
        self.counts[event] == self.rules[event].last
    }

    /// A change of the law of the load, at this time and state; whether the run is to end there.
    pub(super) fn note(&mut self, change: &LawSwitch, time: f64, phase: &Phase) -> bool {
        let (trigger, other) = match change {
            LawSwitch::Stop(limit) if limit.is_limit() => (
                EventTrigger::RateLimit(limit.index()),
                Some(Direction::Falling),
            ),
            LawSwitch::Slip(limit) if limit.is_limit() => (
                EventTrigger::RateLimit(limit.index()),
                Some(Direction::Rising),
            ),
            LawSwitch::Stop(bearing) => (EventTrigger::Stop(bearing.index()), None),
            LawSwitch::Slip(bearing) => (EventTrigger::Slip(bearing.index()), None),
            LawSwitch::Sign(_) => return false,
        };
        self.note_trigger(trigger, other, time, phase)
    }

    /// The thruster whose impulse is the state of that number is switched on, or off, at this time and state; whether the run is to end
    /// there.
    pub(super) fn note_pulse(
        &mut self,
        state: usize,
        is_on: bool,
        time: f64,
        phase: &Phase,
    ) -> bool {
        let other = if is_on {
            Direction::Falling
        } else {
            Direction::Rising
        };
        self.note_trigger(EventTrigger::Pulse(state), Some(other), time, phase)
    }

    /// What the load tells; it does not count where the `other` direction is looked for.
    fn note_trigger(
        &mut self,
        trigger: EventTrigger,
        other: Option<Direction>,
        time: f64,
        phase: &Phase,
    ) -> bool {
        let mut is_last = false;
        let is_at_once = (time - self.start).abs() <= AT_ONCE * self.span.abs();
        for event in 0..self.rules.len() {
            let rule = &mut self.rules[event];
            if rule.trigger != trigger || Some(rule.direction) == other {
                continue;
            }
            let is_known = std::mem::take(&mut rule.has_passed) && is_at_once;
            if !is_known {
                is_last |= self.count(event, time, phase);
            }
        }
        is_last
    }
}
