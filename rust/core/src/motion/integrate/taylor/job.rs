//! What there is to do of a task, and how: settings and jobs.

use super::course::Course;
use super::drive::{Job, Settings};
use super::frame::Precision;
use super::{series, twin};
use crate::error::Error;
use crate::motion::loads::variables::Fixed;
use crate::motion::loads::{SeriesStructure, Term};
use crate::motion::problem::{End, Run, Task, check_times};

pub(super) fn settings(task: &Task<'_>, parts: SeriesStructure) -> Settings {
    let tolerance = task.tolerance;
    let highest = if tolerance.is_beyond_doubles() {
        twin::HIGHEST_ORDER
    } else {
        series::HIGHEST_ORDER
    };
    Settings::new(tolerance.relative, tolerance.absolute, highest, parts)
}

/// The job of a motion, if there is anything to do and nothing against it.
pub(super) fn job<'a, X: Precision<Variables = Fixed>>(
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
    let course = (task.clone())
        .with_carried(terms.iter().filter_map(Term::carried))
        .and_then(|task| {
            (run.samples[0].internal_state).clone_from(&task.initial.internal_state);
            Course::new(&task, terms, Fixed)
        });
    match course {
        Ok(course) => Some(Job {
            course,
            run,
            tell: None,
        }),
        Err(error) => {
            run.end = End::Failed(error);
            None
        }
    }
}

/// The jobs of `runs`, the first of which is of the task `first`.
pub(super) fn rows<'a, X: Precision<Variables = Fixed>>(
    first: usize,
    runs: &'a mut [Option<Run<Error>>],
    begin: &impl Fn(usize) -> (Task<'a>, &'a [Term]),
) -> impl Iterator<Item = Job<'a, X>> {
    (first..).zip(runs).filter_map(|(row, run)| {
        let (task, terms) = begin(row);
        job(&task, terms, run.insert(Run::at_start(&task, End::Stopped)))
    })
}
