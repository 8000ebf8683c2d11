//! The motions of tasks: one task, many tasks on all cores, one task with derivatives.

use std::iter::once;
use std::ops::{ControlFlow, Range};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::batch_series::{BatchSeries, ROWS};
use super::double_double::DoubleDoubleSeries;
use super::driver::{Job, SampleSink, Settings, drive};
use super::equations::{PiecewiseEquations, Precision, parts};
use super::orbit_cache::OrbitSeriesCache;
use super::series;
use super::single::SingleMotionSeries;
use super::step::{Observer, Step};
use super::variational::{ORDER, VariationalSeries};
use crate::error::{Error, MotionFault};
use crate::motion::loads::variables::{Block, Fixed, VariationJet};
use crate::motion::loads::{SeriesStructure, Term};
use crate::motion::problem::{End, Run, Task, check_times};
use crate::numerics::dispatch::{Kernel, dispatch, dispatch_fused};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::Lane;
use crate::numerics::threads::{fill_blocks, lock, thread_count};
use crate::numerics::twofold::Twofold;

/// Compute the motion of `task` under `terms`.
///
/// About every 64 steps `watch` gets the fraction done and may stop the run.
/// An error in the times ends the run before its first step.
pub fn solve_one(
    task: &Task<'_>,
    terms: &[Term],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<Error> {
    let mut run = Run::at_start(task, End::Stopped);
    solve(task, terms, &mut run, watch, None);
    run
}

/// Compute one motion, in the numbers that its tolerance needs.
fn solve(
    task: &Task<'_>,
    terms: &[Term],
    run: &mut Run<Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    observer: Option<Observer>,
) {
    let subject = &task.body_at_point;
    let parts = parts::<f64>(terms, subject, Fixed, !subject.pivoted);
    let settings = choose_settings(task, parts);
    // The run contains how it ended.
    if task.tolerance.is_beyond_doubles() {
        let jobs = &mut prepare_job(task.clone(), terms, run).into_iter();
        let observer = observer.map(|observer| observer as Observer);
        let motions = Motions {
            settings,
            jobs,
            watch,
            observer,
        };
        let _flow = motions.run_in_double_double();
    } else {
        let jobs = &mut prepare_job(task.clone(), terms, run).into_iter();
        let observer = observer.map(|observer| observer as Observer);
        let motions = Motions {
            settings,
            jobs,
            watch,
            observer,
        };
        let _flow = motions.run_one_by_one();
    }
}

/// Compute the motion of `task` under `terms`; `observer` gets every step as soon as it is made, and may stop the run.
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

/// The largest number of motions that a thread takes at a time.
const MOST: usize = 1024;
/// Fewer motions than this take less time one by one.
const FEW: usize = 4;

/// Compute the motions of many tasks, each under its own terms, into `runs`: on all cores, with eight side by side in the lanes of
/// each, or one by one if the tolerance needs more than doubles. Every motion has the bits of [`solve_one`].
///
/// `task` returns the tasks, and `terms` the load of each. They may differ in body, state and numbers. Times, tolerance, the kinds of
/// terms, and whether the body is pivoted are the same for all. Every thread calls `watch` about every 64 steps with the fraction of
/// motions that have begun; it may stop the run.
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
    let in_double_double = !runs.is_empty() && task(0).tolerance.is_beyond_doubles();
    let block = if in_double_double {
        1
    } else {
        block(runs.len())
    };
    let tasks = Tasks {
        task,
        terms,
        begun: &begun,
        ask: &ask,
        caches: &Mutex::default(),
    };
    // If the run is stopped, the motions that were computed remain.
    let _ended = fill_blocks(runs, block, &mut |_| ask(), |first, slots| {
        let (runs, flow) = tasks.solve(first..first + slots.len(), in_double_double);
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

/// The tasks of a call, and what its threads share.
struct Tasks<'a, 'b> {
    task: &'b (dyn Fn(usize) -> Task<'a> + Sync),
    terms: &'b (dyn Fn(usize) -> &'a [Term] + Sync),
    begun: &'b AtomicUsize,
    ask: &'b (dyn Fn() -> ControlFlow<()> + Sync),
    /// The caches that no thread uses at present.
    caches: &'b Mutex<Vec<OrbitSeriesCache>>,
}

impl Tasks<'_, '_> {
    /// Compute the motions of some of the tasks. The type of the caller's error does not occur here, so the series are compiled once.
    fn solve(
        &self,
        some: Range<usize>,
        in_double_double: bool,
    ) -> (Vec<Option<Run<Error>>>, ControlFlow<()>) {
        let (first, count, example) = (some.start, some.len(), (self.task)(some.start));
        let mut runs = vec![None; count];
        let mut common = SeriesStructure::default();
        for row in some {
            let (terms, subject) = ((self.terms)(row), &example.body_at_point);
            common = common.of_both(parts::<f64>(terms, subject, Fixed, !subject.pivoted));
        }
        let settings = choose_settings(&example, common);
        let begin = |row: usize| {
            self.begun.fetch_add(1, Ordering::Relaxed);
            ((self.task)(row), (self.terms)(row))
        };
        let watch = &mut |_| (self.ask)();
        let flow = if in_double_double {
            let jobs = &mut prepare_jobs(first, &mut runs, &begin);
            let motions = Motions {
                settings,
                jobs,
                watch,
                observer: None,
            };
            motions.run_in_double_double()
        } else {
            let jobs = &mut prepare_jobs(first, &mut runs, &begin);
            let motions = Motions {
                settings,
                jobs,
                watch,
                observer: None,
            };
            if count < FEW {
                motions.run_one_by_one()
            } else {
                let mut cache = lock(self.caches).pop().unwrap_or_default();
                let flow = motions.run_side_by_side(&mut cache);
                lock(self.caches).push(cache);
                flow
            }
        };
        (runs, flow)
    }
}

/// Choose the number of motions that a thread takes at a time: large, because lanes are idle at the end of a block, but with many
/// blocks, because the first one is computed before the others begin.
fn block(count: usize) -> usize {
    let share = count.div_ceil(16 * thread_count());
    share.next_multiple_of(ROWS).clamp(2 * ROWS, MOST)
}

/// Compute the motion of `task` under `terms` with its derivatives by the variables of a block. The task contains the states of the
/// terms. `sink` gets the number of each time, ω and (x, y, z, w) in B, and the states of the load. The tolerance does not matter.
/// `watch` gets the fraction done and may stop the run.
///
/// # Errors
/// When a term cannot act, the motion cannot go on, or [`Error::Stopped`].
pub(in crate::motion::integrate) fn solve_variational(
    task: &Task<'_>,
    terms: &[Term],
    block: Block,
    sink: SampleSink<'_, VariationJet>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Error> {
    let mut run = Run::at_start(task, End::Stopped);
    let equations = PiecewiseEquations::new(task.clone(), terms, block)?;
    let start = equations.start();
    let own = equations.reported_internal_states(&start, &equations.internal_states_at_start());
    sink(0, &equations.in_body(&start), &own);
    if task.times.len() == 1 {
        return Ok(());
    }
    let mut next = 1;
    let mut sink = |k: usize, state: &[VariationJet; 7], own: &[VariationJet]| {
        next = k + 1;
        sink(k, state, own);
    };
    // The path of the body is not part of the motion here.
    let parts = parts::<VariationJet>(terms, &task.body_at_point, block, false);
    let settings = Settings::of_derivatives(ORDER, parts);
    let job = Job {
        equations,
        run: &mut run,
        sink: Some(&mut sink),
    };
    let jobs = &mut once(job);
    let cache = &mut OrbitSeriesCache::default();
    let _stopped =
        drive::<VariationJet, VariationalSeries, 3, 1>(settings, jobs, watch, None, cache);
    match run.end {
        End::Complete => Ok(()),
        // The motion is finite, its derivatives are not.
        End::Failed(Error::Motion(MotionFault::NotFiniteMotion { .. }))
            if run.phase.is_finite() =>
        {
            let time = task.times[next];
            Err(MotionFault::NotFiniteDerivative { time }.into())
        }
        End::Failed(error) => Err(error),
        _ => Err(Error::Stopped),
    }
}

fn choose_settings(task: &Task<'_>, parts: SeriesStructure) -> Settings {
    let tolerance = task.tolerance;
    let highest = if tolerance.is_beyond_doubles() {
        series::MAX_ORDER_DOUBLE_DOUBLE
    } else {
        series::MAX_ORDER_DOUBLE
    };
    Settings::new(tolerance.relative, tolerance.absolute, highest, parts)
}

/// Prepare the job of a motion; none if the run ends at once.
fn prepare_job<'a, X: Precision<Variables = Fixed>>(
    task: Task<'a>,
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
    let equations = task
        .with_carried(terms.iter().filter_map(Term::carried))
        .and_then(|task| {
            (run.samples[0].internal_state).clone_from(&task.initial.internal_state);
            PiecewiseEquations::new(task, terms, Fixed)
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

/// Prepare the jobs of `runs`, the first of which belongs to the task `first`.
fn prepare_jobs<'a, X: Precision<Variables = Fixed>>(
    first: usize,
    runs: &'a mut [Option<Run<Error>>],
    begin: &impl Fn(usize) -> (Task<'a>, &'a [Term]),
) -> impl Iterator<Item = Job<'a, X>> {
    (first..).zip(runs).filter_map(|(row, run)| {
        let (task, terms) = begin(row);
        let run = run.insert(Run::at_start(&task, End::Stopped));
        prepare_job(task, terms, run)
    })
}

/// Motions to run, and what watches them.
struct Motions<'a, 'b, X: Precision> {
    settings: Settings,
    jobs: &'b mut dyn Iterator<Item = Job<'a, X>>,
    watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
    observer: Option<Observer<'b>>,
}

// A separate kernel for each number of directions: all in one take megabytes of the stack without optimization.

impl Motions<'_, '_, DoubleDouble> {
    fn run_in_double_double(self) -> ControlFlow<()> {
        match self.settings.parts.directions {
            0 => dispatch(InDoubleDouble::<0, 4>(self)),
            1 => dispatch(InDoubleDouble::<1, 8>(self)),
            _ => dispatch(InDoubleDouble::<3, 16>(self)),
        }
    }
}

impl<'b> Motions<'_, 'b, f64> {
    fn run_one_by_one(self) -> ControlFlow<()> {
        match self.settings.parts.directions {
            0 => dispatch(OneByOne::<0>(self)),
            1 => dispatch(OneByOne::<1>(self)),
            _ => dispatch(OneByOne::<3>(self)),
        }
    }

    /// Run them side by side; at the baseline of x86-64 one by one, with the same bits.
    fn run_side_by_side(self, cache: &'b mut OrbitSeriesCache) -> ControlFlow<()> {
        let motions = match self.settings.parts.directions {
            0 => dispatch_fused(SideBySide::<0>(self, cache)).map_err(|it| it.0),
            1 => dispatch_fused(SideBySide::<1>(self, cache)).map_err(|it| it.0),
            _ => dispatch_fused(SideBySide::<3>(self, cache)).map_err(|it| it.0),
        };
        motions.unwrap_or_else(Self::run_one_by_one)
    }
}

/// Runs motions one after the other in double-double, with `B` directions in `W` lanes.
struct InDoubleDouble<'a, 'b, const B: usize, const W: usize>(Motions<'a, 'b, DoubleDouble>);

impl<const B: usize, const W: usize> Kernel for InDoubleDouble<'_, '_, B, W> {
    type Output = ControlFlow<()>;

    const IS_WIDE: bool = false;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Motions {
            settings,
            jobs,
            watch,
            observer,
        } = self.0;
        let cache = &mut OrbitSeriesCache::default();
        drive::<Twofold<L>, DoubleDoubleSeries<L, B, W>, B, 1>(
            settings, jobs, watch, observer, cache,
        )
    }
}

/// Runs motions one after the other in doubles with `B` directions, the components of each in the lanes.
struct OneByOne<'a, 'b, const B: usize>(Motions<'a, 'b, f64>);

impl<const B: usize> Kernel for OneByOne<'_, '_, B> {
    type Output = ControlFlow<()>;

    const IS_WIDE: bool = false;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Motions {
            settings,
            jobs,
            watch,
            observer,
        } = self.0;
        let cache = &mut OrbitSeriesCache::default();
        drive::<L, SingleMotionSeries<L, B>, B, 1>(settings, jobs, watch, observer, cache)
    }
}

/// Runs motions side by side with `B` directions, one in each lane.
struct SideBySide<'a, 'b, const B: usize>(Motions<'a, 'b, f64>, &'b mut OrbitSeriesCache);

impl<const B: usize> Kernel for SideBySide<'_, '_, B> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Self(motions, cache) = self;
        let Motions {
            settings,
            jobs,
            watch,
            ..
        } = motions;
        drive::<L, BatchSeries<L, B, ROWS>, B, ROWS>(settings, jobs, watch, None, cache)
    }
}
