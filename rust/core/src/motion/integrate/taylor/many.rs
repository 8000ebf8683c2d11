//! The motions of many tasks, on all cores.

use std::ops::{ControlFlow, Range};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::almanac::Almanac;
use super::course::parts;
use super::job::{rows, settings};
use super::kernels::{OneByOne, Precisely, ROWS, SideBySide};
use crate::error::Error;
use crate::motion::loads::variables::Fixed;
use crate::motion::loads::{Parts, Term};
use crate::motion::problem::{Run, Task};
use crate::numerics::dispatch::dispatch;
use crate::numerics::threads::{fill_blocks, lock, thread_count};

/// The most motions that a thread takes at a time.
const MOST: usize = 1024;
/// Fewer motions than this are sooner done one by one.
const FEW: usize = 4;

/// The motions of many tasks, each under its own terms, into `runs`; on all cores, eight side by side in the lanes of each,
/// or one by one where doubles do not serve the tolerance. Every motion has the bits of [`solve_one`](super::solve_one).
///
/// `task` gives the tasks and `terms` what acts in each. They may differ in body, state and numbers; times, tolerance,
/// whether the body is pivoted and the kinds of terms are the same for all. Every thread asks `watch` about every 64 steps, with the fraction of
/// motions that were begun; it may stop the run.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::integrate::taylor::{solve_many, solve_one};
/// use polhode::motion::loads::{Damping, Term};
/// use polhode::motion::simulate::{Method, Phase, Run, State, Task, Tolerance};
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
///
/// // A hundred balls that spin at different rates in oil.
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?; // I = 2
/// let terms: [Term; 1] = [Damping::new(&Matrix3::identity(), &Matrix3::zeros())?.into()];
/// let tolerance = Tolerance::new(1e-12, 0.0)?;
/// let task = |k: usize| {
///     let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::z() * (1 + k) as f64 };
///     Task::free(&ball, Phase::in_place(&state), &[0.0, 2.0], Method::Taylor, tolerance)
/// };
/// let mut runs: Vec<Option<Run<polhode::Error>>> = (0..100).map(|_| None).collect();
/// solve_many(&task, &|_| &terms, &mut runs, &|_| ControlFlow::Continue(()));
/// let found = runs[99].as_ref().map(|run| run.phase.omega.z);
/// assert!((found.unwrap() - 100.0 * (-1.0_f64).exp()).abs() < 1e-10);
/// // The bits of each alone.
/// let alone = solve_one(&task(99), &terms, &mut |_| ControlFlow::Continue(()));
/// assert_eq!(found, Some(alone.phase.omega.z));
/// # Ok::<(), polhode::Error>(())
/// ```
pub fn solve_many<'a, E: From<Error> + Send>(
    task: &(dyn Fn(usize) -> Task<'a> + Sync),
    terms: &(dyn Fn(usize) -> &'a [Term] + Sync),
    runs: &mut [Option<Run<E>>],
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
    let tasks = Tasks {
        task,
        terms,
        begun: &begun,
        ask: &ask,
        almanacs: &Mutex::default(),
    };
    // Where a run is stopped, what was done by then is kept.
    let _ended = fill_blocks(runs, block, &mut |_| ask(), |first, slots| {
        let (runs, flow) = tasks.solve(first..first + slots.len(), is_precise);
        for (slot, run) in slots.iter_mut().zip(runs) {
            *slot = run.map(|run| run.with_error(E::from));
        }
        if flow.is_break() {
            stopped.store(true, Ordering::Relaxed);
            return Err(());
        }
        Ok(())
    });
}

/// What is asked of the tasks of a call, and told of them.
struct Tasks<'a, 'b> {
    task: &'b (dyn Fn(usize) -> Task<'a> + Sync),
    terms: &'b (dyn Fn(usize) -> &'a [Term] + Sync),
    begun: &'b AtomicUsize,
    ask: &'b (dyn Fn() -> ControlFlow<()> + Sync),
    /// Those that no thread has in hand.
    almanacs: &'b Mutex<Vec<Almanac>>,
}

impl Tasks<'_, '_> {
    /// The motions of some of the tasks. It knows nothing of its caller's error, so that the series are compiled once.
    fn solve(
        &self,
        some: Range<usize>,
        is_precise: bool,
    ) -> (Vec<Option<Run<Error>>>, ControlFlow<()>) {
        let (first, count, example) = (some.start, some.len(), (self.task)(some.start));
        let mut runs = vec![None; count];
        let mut common = Parts::default();
        for row in some {
            let (terms, subject) = ((self.terms)(row), &example.subject);
            common = common.of_both(parts::<f64>(terms, subject, Fixed, !subject.pivoted));
        }
        let settings = settings(&example, common);
        let begin = |row: usize| {
            self.begun.fetch_add(1, Ordering::Relaxed);
            ((self.task)(row), (self.terms)(row))
        };
        let watch = &mut |_| (self.ask)();
        let flow = if is_precise {
            let jobs = &mut rows(first, &mut runs, &begin);
            dispatch(Precisely {
                settings,
                jobs,
                watch,
                see: None,
            })
        } else {
            let jobs = &mut rows(first, &mut runs, &begin);
            if count < FEW {
                dispatch(OneByOne {
                    settings,
                    jobs,
                    watch,
                    see: None,
                })
            } else {
                let mut almanac = lock(self.almanacs).pop().unwrap_or_default();
                let side_by_side = SideBySide {
                    settings,
                    jobs,
                    watch,
                    almanac: &mut almanac,
                };
                let flow = side_by_side.run();
                lock(self.almanacs).push(almanac);
                flow
            }
        };
        (runs, flow)
    }
}

/// Motions that a thread takes at a time: many, since lanes idle at the end of a block, but many blocks too, since the first is done
/// before the others begin.
fn block(count: usize) -> usize {
    let share = count.div_ceil(16 * thread_count());
    share.next_multiple_of(ROWS).clamp(2 * ROWS, MOST)
}
