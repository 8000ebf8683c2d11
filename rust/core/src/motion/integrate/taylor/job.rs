//! What there is to do of a task, and how: settings and jobs.

use super::course::PiecewiseEquations;
use super::drive::{Job, Settings};
use super::principal_frame::Precision;
use super::series;
use crate::error::Error;
use crate::motion::loads::variables::Fixed;
use crate::motion::loads::{Parts, Term};
use crate::motion::problem::{End, Run, Task, check_times};

pub(super) fn choose_settings(task: &Task<'_>, parts: Parts) -> Settings {
    let tolerance = task.tolerance;
    let highest = if tolerance.is_beyond_doubles() {
        series::MAX_ORDER_DOUBLE_DOUBLE
    } else {
        series::MAX_ORDER_DOUBLE
    };
    Settings::new(tolerance.relative, tolerance.absolute, highest, parts)
}

/// The job of a motion, if there is anything to do and nothing against it.
pub(super) fn prepare_job<'a, X: Precision<Variables = Fixed>>(
    task: &Task<'a>,
    terms: &'a [Term],
    run: &'a mut Run<Error>,
) -> Option<Job<'a, X>> {
    if let Err(error) = check_times(task.times) {
        run.end = End::Failed(error);
        return None;
    }
    if task.times.len() == 1 {
        run.end = End::Complete;
        return None;
    }
    let equations = (task.clone())
        .carrying(terms.iter().filter_map(Term::carried))
        .and_then(|task| {
            (run.samples[0].own).clone_from(&task.initial.own);
            PiecewiseEquations::new(&task, terms, Fixed)
        });
    match equations {
        Ok(equations) => Some(Job {
            equations,
            run,
            sink: None,
        }),
        Err(error) => {
            run.end = End::Failed(error);
            None
        }
    }
}

/// The jobs of `runs`, the first of which is of the task `first`.
pub(super) fn prepare_jobs<'a, X: Precision<Variables = Fixed>>(
    first: usize,
    runs: &'a mut [Option<Run<Error>>],
    begin: &impl Fn(usize) -> (Task<'a>, &'a [Term]),
) -> impl Iterator<Item = Job<'a, X>> {
    (first..).zip(runs).filter_map(|(row, run)| {
        let (task, terms) = begin(row);
        prepare_job(&task, terms, run.insert(Run::at_start(&task, End::Stopped)))
    })
}
