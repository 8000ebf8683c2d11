//! Many motions, each a row: by the method that serves them all, on as many cores as may take part.

use std::ops::ControlFlow;

use super::events::Events;
use super::one::by_method;
use super::plan::{Ask, Plan};
use crate::error::Error;
use crate::motion::integrate::taylor;
use crate::motion::loads::{Load, Subject, Term};
use crate::motion::problem::{End, Method, Run, Task};
use crate::motion::state::Phase;
use crate::numerics::threads::fill_blocks;

/// What is called as rows run, besides the analytic terms of their loads: other loads, and events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Calls {
    /// Nothing.
    Nothing,
    /// What any thread may call.
    OnAnyThread,
    /// What the calling thread alone may call.
    OnThisThread,
}

/// The rows of a stack: where each begins, what acts on it and what is looked for.
pub trait Rows: Sync {
    /// As of the loads.
    type Error: From<Error> + Send;

    /// What is called as they run.
    fn calls(&self) -> Calls;

    /// The number of the body of a row, and its state at the first time with the attitude as given: of unit length to rounding
    /// alone.
    fn start(&self, row: usize) -> (usize, Phase);

    /// The analytic terms of the load in a row; their kinds are the same in all rows.
    fn terms(&self, row: usize) -> &[Term];

    /// Runs a row: calls [`Row::under`] with what acts on it and with what is looked for.
    fn run(&self, row: Row<'_>) -> Run<Self::Error>;

    /// Whether no further row is begun after one that failed like this.
    fn ends_all(&self, error: &Self::Error) -> bool;
}

/// A row that is about to be run.
pub struct Row<'r> {
    /// Its number in the stack.
    pub number: usize,
    task: &'r Task<'r>,
    watch: &'r mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Row<'_> {
    /// What its load acts on.
    #[must_use]
    pub fn subject(&self) -> Subject {
        self.task.subject
    }

    /// Its motion under `load`.
    pub fn under<L: Load>(
        self,
        load: &mut L,
        events: &mut dyn Events<Error = L::Error>,
    ) -> Run<L::Error> {
        by_method(self.task, load, events, self.watch)
    }
}

/// The motions of `rows` as `plan` says, into `runs`; every one has the bits of its [`simulate`](super::simulate).
///
/// Rows that call on this thread go one after the other, all others to all cores, and Taylor series that call nothing side by side
/// in the lanes of each core. `watch` gets the fraction done, but from within rows on several cores none, and may stop all.
/// Then, and where a row [ends all](Rows::ends_all), no further row is begun, and those begun are kept. Lanes do not ask whether
/// a row ends all.
///
/// # Panics
/// When there are no times; see [`check_times`](super::check_times).
pub fn simulate_many<R: Rows>(
    plan: &Plan<'_>,
    rows: &R,
    runs: &mut [Option<Run<R::Error>>],
    watch: &Ask<'_>,
) {
    let (count, calls) = (runs.len(), rows.calls());
    let common = plan.common();
    let task = |row| {
        let (body, initial) = rows.start(row);
        plan.task(common.as_ref(), body, initial)
    };
    let fill = |row, slot: &mut Option<Run<R::Error>>, fraction: &dyn Fn(f64) -> Option<f64>| {
        let run = slot.insert(rows.run(Row {
            number: row,
            task: &task(row),
            watch: &mut |part| watch(fraction(part)),
        }));
        let is_over = match &run.end {
            End::Stopped => true,
            End::Failed(error) => rows.ends_all(error),
            End::Complete | End::Event => false,
        };
        if is_over { Err(()) } else { Ok(()) }
    };
    if count == 1 || calls == Calls::OnThisThread {
        for (row, slot) in runs.iter_mut().enumerate() {
            let fraction = |part| Some((row as f64 + part) / count as f64);
            if fill(row, slot, &fraction).is_err() {
                break;
            }
        }
    } else if calls == Calls::Nothing && plan.method() == Method::Taylor {
        taylor::solve_many(&task, &|row| rows.terms(row), runs, &|begun| {
            watch(Some(begun))
        });
    } else {
        let look = &mut |done| watch(Some(done));
        // Where a row ends all, those begun are kept.
        let _ended = fill_blocks(runs, 1, look, |row, slot| {
            fill(row, &mut slot[0], &|_| None)
        });
    }
}
