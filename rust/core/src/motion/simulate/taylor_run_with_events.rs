//! Taylor series with events: each step is searched as it is made.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::events::{EventDetector, Events};
use super::stepper::Dense;
use crate::error::Error;
use crate::motion::integrate::taylor::{Step, solve_with_observer};
use crate::motion::loads::Term;
use crate::motion::problem::limits::check_steps;
use crate::motion::problem::{End, Run, Task};
use crate::motion::state::Phase;

/// The motion of `task` under `terms`.
pub(super) fn solve<E: From<Error>>(
    task: &Task<'_>,
    terms: &[Term],
    events: &mut dyn Events<Error = E>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<E> {
    let (start, end) = (task.times[0], task.times[task.times.len() - 1]);
    let mut halt = None;
    let mut detector =
        match EventDetector::new(events, start, &task.initial, end - start, &|_| -1.0) {
            Ok(detector) => detector,
            Err(error) => return Run::at_start(task, End::Failed(error)),
        };
    // Looks for events within a step of many turns count as steps.
    let (most, mut looks) = (task.tolerance.most_steps, 0);
    let mut run = solve_with_observer(task, terms, &mut |step| {
        let mut dense = TaylorStep {
            step,
            error: PhantomData,
        };
        let [from, to] = step.ends;
        let found = detector.search_step(&mut dense, start, step.ends, |_, part| {
            let reached = part.end;
            if let Some((elapsed, phase)) = part.event {
                return Ok(ControlFlow::Break(Some((elapsed, phase, End::Event))));
            }
            if watch(reached / (end - start)).is_break() {
                // At its end the driver stops by itself.
                let is_within = reached != to;
                let halt = is_within.then(|| (reached, step.at(reached), End::Stopped));
                return Ok(ControlFlow::Break(halt));
            }
            looks += 1;
            let checked = check_steps(most, looks, start, reached, end - start);
            Ok(match checked {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    let failed = End::Failed(error.into());
                    ControlFlow::Break(Some((reached, step.at(reached), failed)))
                }
            })
        });
        halt = match found {
            Ok(ControlFlow::Continue(())) => return ControlFlow::Continue(()),
            Ok(ControlFlow::Break(halt)) => halt,
            Err(error) => Some((from, step.at(from), End::Failed(error))),
        };
        ControlFlow::Break(())
    })
    .with_error(E::from);
    run.crossings = detector.crossings;
    if let Some((elapsed, phase, end)) = halt {
        // The last step went further.
        let is_beyond = |t: &f64| (t - start).abs() > elapsed.abs();
        run.samples
            .truncate(task.times.partition_point(|t| !is_beyond(t)));
        if let Some(last) = run.samples.len().checked_sub(1)
            && last > 0
            && task.times[last] - start == elapsed
        {
            run.samples[last] = phase.clone();
        }
        (run.time, run.phase, run.end) = (start + elapsed, phase, end);
    }
    run
}

/// A step of Taylor series as events see it.
struct TaylorStep<'a, E> {
    step: &'a Step,
    error: PhantomData<E>,
}

impl<E> Dense for TaylorStep<'_, E> {
    type Error = E;

    fn elapsed(&self) -> f64 {
        self.step.ends[1]
    }

    fn phase(&self) -> Phase {
        self.step.at(self.step.ends[1])
    }

    fn within(&mut self, elapsed: f64) -> Result<Phase, E> {
        Ok(self.step.at(elapsed))
    }

    fn turn(&self, length: f64) -> f64 {
        let [from, to] = self.step.ends;
        self.step.turn() * (length / (to - from)).abs()
    }
}
