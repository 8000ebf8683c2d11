//! Taylor series: each step sums the power series of the motion in time, to the order at which the work is least.
//!
//! | file | what it knows |
//! |---|---|
//! | `frame` | the principal axes, in doubles or in numbers of twice the precision |
//! | `course` | one motion: its load in principal axes, from break to break, in a unit of its own |
//! | `field` | the equations that are linear in the coefficients of one order |
//! | `terms`, `extras` | the recurrences of terms that are not |
//! | `series` | the coefficients, and what is asked of the sums of their products |
//! | `alone`, `abreast` | these sums, the lanes over the components of one motion or over motions |
//! | `twin` | these sums in numbers of twice the precision |
//! | `directions` | directions of space as seen from the body |
//! | `push` | the path of a body that forces act on |
//! | `step` | the length of a step, the state at its end or within |
//! | `drive` | steps, outputs, breaks, until all motions are done; `seen`: each step as it is made |
//! | `pack` | one number of several motions |
//!
//! Sources: Jorba & Zou, Experimental Mathematics 14 (2005) 99; Hairer, Nørsett & Wanner, Solving ODEs I, §I.8.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and components are indices of several arrays at once"
)]

mod abreast;
mod alone;
mod course;
mod directions;
mod drive;
mod extras;
mod field;
mod frame;
mod pack;
mod push;
mod series;
mod step;
mod terms;
mod twin;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use abreast::Abreast;
use alone::Alone;
use course::{Course, parts};
pub(crate) use drive::Step;
use drive::{Job, See, Settings, drive};
use frame::Precision;
use twin::Twin;

use crate::error::Error;
use crate::motion::loads::{Parts, Term};
use crate::motion::problem::{End, Run, Task};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::Lane;
use crate::numerics::threads::{fill_blocks, thread_count};
use crate::numerics::twofold::Twofold;

/// Motions side by side: a register of the widest machines.
const ROWS: usize = 8;
/// The most motions that a thread takes at a time.
const MOST: usize = 1024;
/// Fewer motions than this are sooner done one by one.
const FEW: usize = 4;

/// The motion of `task` under `terms`.
///
/// About every 64 steps `watch` gets the fraction done and may stop the run.
///
/// # Panics
/// When there are no times; see [`check_times`](crate::motion::problem::check_times).
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
    let settings = settings(task, parts(terms, task.subject.pivoted));
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

/// Motions that a thread takes at a time: many, since lanes idle at the end of a block, but some for every thread.
fn block(count: usize) -> usize {
    let share = count.div_ceil(4 * thread_count());
    share.next_multiple_of(ROWS).clamp(2 * ROWS, MOST)
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

/// The motions of many tasks, each under its own terms, into `runs`; on all cores, eight side by side in the lanes of each,
/// or one by one where doubles do not serve the tolerance. Every motion has the bits of [`solve_one`].
///
/// `task` gives the tasks and `terms` what acts in each. They may differ in body, state and numbers; times, tolerance,
/// whether the body is pivoted and the kinds of terms are the same for all. Every thread asks `watch` about every 64 steps, with the fraction of
/// motions that were begun; it may stop the run.
///
/// # Panics
/// As [`solve_one`].
pub fn solve_many<'a>(
    task: &(dyn Fn(usize) -> Task<'a> + Sync),
    terms: &(dyn Fn(usize) -> &'a [Term] + Sync),
    runs: &mut [Option<Run<Error>>],
    watch: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) {
    let all = runs.len() as f64;
    let begun = AtomicUsize::new(0);
    let stopped = AtomicBool::new(false);
    let ask = || {
        if stopped.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            watch(begun.load(Ordering::Relaxed) as f64 / all)
        }
    };
    let is_precise = !runs.is_empty() && task(0).tolerance.is_beyond_doubles();
    let block = if is_precise { 1 } else { block(runs.len()) };
    // Where a run is stopped, what was done by then is kept.
    let _ended = fill_blocks(runs, block, &mut |_| ask(), |first, runs| {
        let (count, example) = (runs.len(), task(first));
        let mut common = Parts::default();
        for row in first..first + count {
            common = common.with(&parts(terms(row), example.subject.pivoted));
        }
        let settings = settings(&example, common);
        let begin = |row: usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            (task(row), terms(row))
        };
        let watch = &mut |_| ask();
        let flow = if is_precise {
            let jobs = &mut rows(first, runs, &begin);
            dispatch(Precisely {
                settings,
                jobs,
                watch,
                see: None,
            })
        } else {
            let jobs = &mut rows(first, runs, &begin);
            if count < FEW {
                dispatch(OneByOne {
                    settings,
                    jobs,
                    watch,
                    see: None,
                })
            } else {
                dispatch(SideBySide {
                    settings,
                    jobs,
                    watch,
                })
            }
        };
        if flow.is_break() {
            stopped.store(true, Ordering::Relaxed);
            return Err(());
        }
        Ok(())
    });
}

fn settings(task: &Task<'_>, parts: Parts) -> Settings {
    let tolerance = task.tolerance;
    let highest = if tolerance.is_beyond_doubles() {
        twin::HIGHEST_ORDER
    } else {
        series::HIGHEST_ORDER
    };
    Settings::new(tolerance.relative, tolerance.absolute, highest, parts)
}

/// The job of a motion, if there is anything to do and nothing against it.
fn job<'a, X: Precision>(
    task: &Task<'a>,
    terms: &'a [Term],
    run: &'a mut Run<Error>,
) -> Option<Job<'a, X>> {
    if run.samples.len() == 1 {
        run.end = End::Complete;
        return None;
    }
    match Course::new(task, terms) {
        Ok(course) => Some(Job { course, run }),
        Err(error) => {
            run.end = End::Failed(error);
            None
        }
    }
}

/// The jobs of `runs`, the first of which is of the task `first`.
fn rows<'a, X: Precision>(
    first: usize,
    runs: &'a mut [Option<Run<Error>>],
    begin: &impl Fn(usize) -> (Task<'a>, &'a [Term]),
) -> impl Iterator<Item = Job<'a, X>> {
    (first..).zip(runs).filter_map(|(row, run)| {
        let (task, terms) = begin(row);
        job(&task, terms, run.insert(Run::at_start(&task, End::Stopped)))
    })
}

/// Motions one after the other in numbers of twice the precision.
struct Precisely<'a, 'b> {
    settings: Settings,
    jobs: &'b mut dyn Iterator<Item = Job<'a, DoubleDouble>>,
    watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
    see: Option<See<'b>>,
}

impl Kernel for Precisely<'_, '_> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Self {
            settings,
            jobs,
            watch,
            see,
        } = self;
        match settings.parts.directions {
            0 => drive::<Twofold<L>, Twin<L, 0, 4>, 0, 1>(settings, jobs, watch, see),
            1 => drive::<Twofold<L>, Twin<L, 1, 8>, 1, 1>(settings, jobs, watch, see),
            _ => drive::<Twofold<L>, Twin<L, 3, 16>, 3, 1>(settings, jobs, watch, see),
        }
    }
}

/// Motions one after the other, the lanes over the components of each.
struct OneByOne<'a, 'b> {
    settings: Settings,
    jobs: &'b mut dyn Iterator<Item = Job<'a, f64>>,
    watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
    see: Option<See<'b>>,
}

impl Kernel for OneByOne<'_, '_> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Self {
            settings,
            jobs,
            watch,
            see,
        } = self;
        match settings.parts.directions {
            0 => drive::<L, Alone<L, 0>, 0, 1>(settings, jobs, watch, see),
            1 => drive::<L, Alone<L, 1>, 1, 1>(settings, jobs, watch, see),
            _ => drive::<L, Alone<L, 3>, 3, 1>(settings, jobs, watch, see),
        }
    }
}

/// Motions side by side, the lanes over the motions.
struct SideBySide<'a, 'b> {
    settings: Settings,
    jobs: &'b mut dyn Iterator<Item = Job<'a, f64>>,
    watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Kernel for SideBySide<'_, '_> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Self {
            settings,
            jobs,
            watch,
        } = self;
        match settings.parts.directions {
            0 => drive::<L, Abreast<L, 0, ROWS>, 0, ROWS>(settings, jobs, watch, None),
            1 => drive::<L, Abreast<L, 1, ROWS>, 1, ROWS>(settings, jobs, watch, None),
            _ => drive::<L, Abreast<L, 3, ROWS>, 3, ROWS>(settings, jobs, watch, None),
        }
    }
}
