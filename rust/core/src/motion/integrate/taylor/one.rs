//! The motion of one task, with its steps shown to whoever asks.

use std::ops::ControlFlow;

use super::course::parts;
use super::drive::{Observer, Step};
use super::job::{choose_settings, prepare_job};
use super::kernels::{InDoubleDouble, OneByOne};
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
    solve(task, terms, &mut run, watch, None);
    run
}

/// One motion, in the numbers that its tolerance needs.
fn solve(
    task: &Task<'_>,
    terms: &[Term],
    run: &mut Run<Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    observer: Option<Observer>,
) {
    let subject = &task.subject;
    let parts = parts::<f64>(terms, subject, Fixed, !subject.pivoted);
    let settings = choose_settings(task, parts);
    // How the run ended stands in it.
    if task.tolerance.is_beyond_doubles() {
        let jobs = &mut prepare_job(task, terms, run).into_iter();
        let observer = observer.map(|observer| observer as Observer);
        let _flow = dispatch(InDoubleDouble {
            settings,
            jobs,
            watch,
            observer,
        });
    } else {
        let jobs = &mut prepare_job(task, terms, run).into_iter();
        let observer = observer.map(|observer| observer as Observer);
        let _flow = dispatch(OneByOne {
            settings,
            jobs,
            watch,
            observer,
        });
    }
}

/// As [`solve_one`], with every step shown to `observer`, which may stop the run, as soon as it is made.
pub(crate) fn solve_with_observer(
    task: &Task<'_>,
    terms: &[Term],
    observer: &mut dyn FnMut(&Step) -> ControlFlow<()>,
) -> Run<Error> {
    let mut run = Run::at_start(task, End::Stopped);
    let watch = &mut |_| ControlFlow::Continue(());
    let mut last = None;
    let mut each = |step: Step, is_last| {
        if is_last {
            last = Some(step);
            return ControlFlow::Continue(());
        }
        observer(&step)
    };
    solve(task, terms, &mut run, watch, Some(&mut each));
    if let Some(last) = last
        && run.end == End::Complete
    {
        let _over = observer(&last);
    }
    run
}
