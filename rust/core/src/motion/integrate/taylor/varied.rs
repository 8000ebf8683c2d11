//! The motion of one task with its derivatives by the variables of a block.

use std::iter::once;
use std::ops::ControlFlow;

use super::almanac::Almanac;
use super::course::{Course, parts};
use super::derived::Derived;
use super::drive::{Job, Settings, Tell, drive};
use super::row::ORDER;
use crate::error::{Error, MotionFault};
use crate::motion::loads::Term;
use crate::motion::loads::variables::{Block, Varied};
use crate::motion::problem::{End, Run, Task};

/// Runs `task`, which carries what `terms` carry along, under these to its last time; `tell` gets ω and (x, y, z, w) in B and the
/// states of the load at each time, by the number of the time. Tolerances do not matter. `watch` gets the fraction done and may
/// stop it.
///
/// # Errors
/// When a term cannot act, the motion cannot go on, or [`Error::Stopped`].
pub(in crate::motion::integrate) fn run_varied(
    task: &Task<'_>,
    terms: &[Term],
    block: Block,
    tell: Tell<'_, Varied>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Error> {
    let mut run = Run::at_start(task, End::Stopped);
    let course = Course::new(task, terms, block)?;
    let start = course.start();
    let own = course.own_reported(&start, &course.own_at_start());
    tell(0, &course.in_body(&start), &own);
    if task.times.len() == 1 {
        return Ok(());
    }
    let mut next = 1;
    let mut tell = |k: usize, state: &[Varied; 7], own: &[Varied]| {
        next = k + 1;
        tell(k, state, own);
    };
    // The path of the body is left out.
    let parts = parts::<Varied>(terms, &task.body_at_point, block, false);
    let settings = Settings::of_derivatives(ORDER, parts);
    let job = Job {
        course,
        run: &mut run,
        tell: Some(&mut tell),
    };
    let jobs = &mut once(job);
    let almanac = &mut Almanac::default();
    let _stopped = match parts.directions {
        0 => directed::<0>(settings, jobs, watch, almanac),
        1 => directed::<1>(settings, jobs, watch, almanac),
        _ => directed::<3>(settings, jobs, watch, almanac),
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
fn directed<const B: usize>(
    settings: Settings,
    jobs: &mut dyn Iterator<Item = Job<'_, Varied>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    almanac: &mut Almanac,
) -> ControlFlow<()> {
    drive::<Varied, Derived<B>, B, 1>(settings, jobs, watch, None, almanac)
}
