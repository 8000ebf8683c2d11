//! The motion of one task with its derivatives by the variables of a block.

use std::iter::once;
use std::ops::ControlFlow;

use super::course::{PiecewiseEquations, parts};
use super::drive::{Job, SampleSink, Settings, drive};
use super::orbit_cache::OrbitSeriesCache;
use super::variational_series::ORDER;
use super::variational_series::VariationalSeries;
use crate::error::{Error, MotionFault};
use crate::motion::loads::Term;
use crate::motion::loads::variables::{Block, Varied};
use crate::motion::problem::{End, Run, Task};

/// Runs `task`, which carries what `terms` carry along, under these to its last time; `sink` gets ω and (x, y, z, w) in B and the
/// states of the load at each time, by the number of the time. Tolerances do not matter. `watch` gets the fraction done and may
/// stop it.
///
/// # Errors
/// When a term cannot act, the motion cannot go on, or [`Error::Stopped`].
pub(in crate::motion::integrate) fn solve_variational(
    task: &Task<'_>,
    terms: &[Term],
    block: Block,
    sink: SampleSink<'_, Varied>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Error> {
    let mut run = Run::at_start(task, End::Stopped);
    let equations = PiecewiseEquations::new(task, terms, block)?;
    let start = equations.start();
    let own = equations.reported_internal_states(&start, &equations.internal_states_at_start());
    sink(0, &equations.in_body(&start), &own);
    if task.times.len() == 1 {
        return Ok(());
    }
    let mut next = 1;
    let mut sink = |k: usize, state: &[Varied; 7], own: &[Varied]| {
        next = k + 1;
        sink(k, state, own);
    };
    // The path of the body is left out.
    let parts = parts::<Varied>(terms, &task.subject, block, false);
    let settings = Settings::of_derivatives(ORDER, parts);
    let job = Job {
        equations,
        run: &mut run,
        sink: Some(&mut sink),
    };
    let jobs = &mut once(job);
    let cache = &mut OrbitSeriesCache::default();
    let _stopped = match parts.directions {
        0 => drive_directions::<0>(settings, jobs, watch, cache),
        1 => drive_directions::<1>(settings, jobs, watch, cache),
        _ => drive_directions::<3>(settings, jobs, watch, cache),
    };
    match run.end {
        End::Complete => Ok(()),
        // The motion goes on where its derivatives do not.
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

/// Out of line: without optimization the three take a megabyte of the stack each.
#[inline(never)]
fn drive_directions<const B: usize>(
    settings: Settings,
    jobs: &mut dyn Iterator<Item = Job<'_, Varied>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    cache: &mut OrbitSeriesCache,
) -> ControlFlow<()> {
    drive::<Varied, VariationalSeries<B>, B, 1>(settings, jobs, watch, None, cache)
}
