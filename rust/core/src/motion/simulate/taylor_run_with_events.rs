//! Taylor series with events: each step is looked through as it is made.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::events::EventDetector;
use super::events::Events;
use super::stepper::Dense;
use crate::error::Error;
use crate::motion::integrate::taylor::{Step, solve_seen};
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
    let mut lookout = match EventDetector::new(events, start, &task.initial, end - start, &|_| -1.0)
    {
        Ok(lookout) => lookout,
        Err(error) => return Run::at_start(task, End::Failed(error)),
    };
    // Looks for events within a step of many turns count as steps.
    let (most, mut looks) = (task.tolerance.most_steps, 0);
    let mut run = solve_seen(task, terms, &mut |step| {
        let mut summed = TaylorStep {
            step,
            error: PhantomData,
        };
        let [from, to] = step.ends;
        let stages = lookout.stages(step.turn());
        let (mut stage, mut begin) = (0.0, from);
        while stage < stages {
            stage += 1.0;
            let reached = if stage == stages {
                to
            } else {
                from + (to - from) * (stage / stages)
            };
            halt = match lookout.look(&mut summed, start, begin, reached) {
                Ok(None) if watch(reached / (end - start)).is_continue() => None,
                Ok(None) if reached == to => return ControlFlow::Break(()),
                Ok(None) => Some((reached, step.at(reached), End::Stopped)),
                Ok(Some((elapsed, phase))) => Some((elapsed, phase, End::Event)),
                Err(error) => Some((from, step.at(from), End::Failed(error))),
            };
            if halt.is_some() {
                return ControlFlow::Break(());
            }
            looks += 1;
            if let Err(error) = check_steps(most, looks, start, reached, end - start) {
                halt = Some((reached, step.at(reached), End::Failed(error.into())));
                return ControlFlow::Break(());
            }
            begin = reached;
        }
        ControlFlow::Continue(())
    })
    .with_error(E::from);
    run.crossings = lookout.crossings;
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
