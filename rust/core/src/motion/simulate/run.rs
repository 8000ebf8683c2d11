//! What a run gives, and how methods of steps get through it.

use std::ops::ControlFlow;

use super::events::{Crossing, Events, Lookout};
use super::method::Method;
use super::stepper::{self, Carry, Span, Stepper};
use super::task::Task;
use crate::motion::loads::Load;
use crate::motion::state::Phase;

/// What an integration took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Accepted steps.
    pub steps: u64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End<E> {
    /// At the last time.
    Complete,
    /// At an event that ends it.
    Event,
    /// Where the watch asked for it.
    Stopped,
    /// Where the equations or the load failed.
    Failed(E),
}

/// What a run gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<E> {
    /// The states at the times; not numbers after the end.
    pub samples: Vec<Phase>,
    /// The passages through zero, in the order of the run.
    pub crossings: Vec<Crossing>,
    /// What it took.
    pub effort: Effort,
    /// The time it came to.
    pub time: f64,
    /// The state then.
    pub phase: Phase,
    /// How it ended.
    pub end: End<E>,
}

impl<E> Run<E> {
    /// One that has come no further than the first time.
    pub(crate) fn at_start(task: &Task<'_>, end: End<E>) -> Self {
        let mut samples = vec![Phase::nan(); task.times.len()];
        samples[0] = task.initial;
        Self {
            samples,
            crossings: Vec::new(),
            effort: Effort::default(),
            time: task.times[0],
            phase: task.initial,
            end,
        }
    }

    /// The same run, its error through `f`.
    #[must_use]
    pub fn with_error<F>(self, f: impl FnOnce(E) -> F) -> Run<F> {
        Run {
            samples: self.samples,
            crossings: self.crossings,
            effort: self.effort,
            time: self.time,
            phase: self.phase,
            end: match self.end {
                End::Complete => End::Complete,
                End::Event => End::Event,
                End::Stopped => End::Stopped,
                End::Failed(error) => End::Failed(f(error)),
            },
        }
    }

    /// Goes by steps to the last time, or to where the run ends.
    pub(super) fn through<L: Load<Error = E>>(
        &mut self,
        method: Method,
        task: &Task<'_>,
        load: &mut L,
        events: &mut dyn Events<Error = E>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<End<E>, E> {
        let bounds = spans(task.times, load.breaks());
        for pair in bounds.windows(2) {
            load.enter(pair[0], pair[1])?; // refused before anything is computed
        }
        let (start, end) = (task.times[0], bounds[bounds.len() - 1]);
        let mut lookout = Lookout::new(events, start, &task.initial, end > start)?;
        let mut next = 1;
        let mut carry = Carry::default();
        for pair in bounds.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            load.enter(from, to)?;
            let span = Span {
                from,
                to,
                phase: self.phase,
                carry,
            };
            let mut stepper = stepper::start(method, task, &span, load)?;
            let before = self.effort;
            let mut watch = |elapsed: f64| watch((from - start + elapsed) / (end - start));
            let ended = self.span(
                task,
                &span,
                &mut *stepper,
                &mut next,
                &mut lookout,
                &mut watch,
            );
            let Effort { steps, evaluations } = stepper.effort();
            self.effort = Effort {
                steps: before.steps + steps,
                evaluations: before.evaluations + evaluations,
            };
            if let Some(end) = ended.transpose() {
                self.crossings = lookout.crossings;
                return end;
            }
            carry = stepper.carry();
        }
        self.crossings = lookout.crossings;
        Ok(End::Complete)
    }

    /// Steps to the end of a span; how the run ended if it did.
    fn span(
        &mut self,
        task: &Task<'_>,
        span: &Span,
        stepper: &mut dyn Stepper<Error = E>,
        next: &mut usize,
        lookout: &mut Lookout<'_, E>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Option<End<E>>, E> {
        let (from, length) = (span.from, span.to - span.from);
        loop {
            let before = stepper.elapsed();
            if before == length {
                return Ok(None);
            }
            stepper.advance()?;
            let reached = stepper.elapsed();
            let ended = lookout.look(stepper, from, before)?;
            let (last, phase) = ended.unwrap_or((reached, stepper.phase()));
            while let Some(elapsed) = task.times.get(*next).map(|t| t - from)
                && elapsed.abs() <= last.abs()
            {
                self.samples[*next] = if elapsed == last {
                    phase
                } else {
                    stepper.within(elapsed)?
                };
                *next += 1;
            }
            (self.time, self.phase) = (from + last, phase);
            if ended.is_some() {
                return Ok(Some(End::Event));
            }
            if watch(reached).is_break() {
                return Ok(Some(End::Stopped));
            }
        }
    }
}

/// The ends of the spans into which `breaks` cut the time from the first to the last of `times`.
pub(in crate::motion) fn spans(times: &[f64], mut breaks: Vec<f64>) -> Vec<f64> {
    let (start, end) = (times[0], times[times.len() - 1]);
    if start == end {
        return vec![start];
    }
    breaks.retain(|t| (t - start) * (t - end) < 0.0);
    breaks.extend([start, end]);
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    if end < start {
        breaks.reverse();
    }
    breaks
}
