//! The motion of one task, with its steps shown to whoever asks.

use std::ops::ControlFlow;

use super::course::parts;
use super::drive::{See, Step};
use super::job::{job, settings};
use super::kernels::{OneByOne, Precisely};
use crate::error::Error;
use crate::motion::loads::Term;
use crate::motion::loads::variables::Fixed;
use crate::motion::problem::{End, Run, Task};
use crate::numerics::dispatch::dispatch;

/// The motion of `task` under `terms`.
///
/// About every 64 steps `watch` gets the fraction done and may stop the run.
/// What is wrong with the times ends the run before its first step.
pub fn solve_one(
    task: &Task<'_>,
    terms: &[Term],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<Error> {
    let mut run = Run::at_start(task, End::Stopped);
    go(task, terms, &mut run, watch, None);
    run
}

/// One motion, in the numbers that its tolerance needs.
fn go(
    task: &Task<'_>,
    terms: &[Term],
    run: &mut Run<Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    see: Option<See>,
) {
    let subject = &task.body_at_point;
    let parts = parts::<f64>(terms, subject, Fixed, !subject.pivoted);
    let settings = settings(task, parts);
    // How the run ended stands in it.
    if task.tolerance.is_beyond_doubles() {
        let jobs = &mut job(task, terms, run).into_iter();
        let see = see.map(|see| see as See);
        let _flow = dispatch(Precisely {
            settings,
            jobs,
            watch,
            see,
        });
    } else {
        let jobs = &mut job(task, terms, run).into_iter();
        let see = see.map(|see| see as See);
        let _flow = dispatch(OneByOne {
            settings,
            jobs,
            watch,
            see,
        });
    }
}

/// As [`solve_one`], with every step shown to `see`, which may stop the run, as soon as it is made.
pub(crate) fn solve_seen(
    task: &Task<'_>,
    terms: &[Term],
    see: &mut dyn FnMut(&Step) -> ControlFlow<()>,
) -> Run<Error> {
    let mut run = Run::at_start(task, End::Stopped);
    let watch = &mut |_| ControlFlow::Continue(());
    let mut last = None;
    let mut each = |step: Step, is_last| {
        if is_last {
            last = Some(step);
            return ControlFlow::Continue(());
        }
        see(&step)
    };
    go(task, terms, &mut run, watch, Some(&mut each));
    if let Some(last) = last
        && run.end == End::Complete
    {
        let _over = see(&last);
    }
    run
}
