//! Until all motions are done.

use std::mem::swap;
use std::ops::ControlFlow;

use super::lanes::{Job, Lanes};
use super::settings::Settings;
use super::shown::Observer;
use crate::motion::integrate::taylor::batch::Batch;
use crate::motion::integrate::taylor::orbit_cache::OrbitSeriesCache;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::problem::End;
use crate::numerics::number::Number;

/// Steps between two looks at the watch, and of motions with derivatives, which take longer.
const STEPS_PER_PROGRESS: u32 = 64;
const VARIATIONAL_STEPS_PER_PROGRESS: u32 = 4;

/// Runs all motions that `jobs` gives. About every 64 steps `watch` gets the fraction of the first lane's motion that is
/// done, and may stop them. `observer` is for motions one after the other; orbits are looked up in the almanac and put down there.
#[inline(always)]
pub(in crate::motion::integrate::taylor) fn drive<
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
    const B: usize,
    const R: usize,
>(
    settings: Settings,
    jobs: &mut dyn Iterator<Item = Job<'_, L::Real>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    observer: Option<Observer>,
    cache: &mut OrbitSeriesCache,
) -> ControlFlow<()> {
    let mut lanes = Lanes::<L, S, B, R>::new(settings);
    swap(&mut lanes.nonlinear.cache, cache);
    let flow = run(&mut lanes, jobs, watch, observer);
    swap(&mut lanes.nonlinear.cache, cache);
    flow
}

#[inline(always)]
fn run<
    'a,
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
    const B: usize,
    const R: usize,
>(
    lanes: &mut Lanes<'a, L, S, B, R>,
    jobs: &mut dyn Iterator<Item = Job<'a, L::Real>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    mut observer: Option<Observer>,
) -> ControlFlow<()> {
    let steps_per_progress = if L::VARIES {
        VARIATIONAL_STEPS_PER_PROGRESS
    } else {
        STEPS_PER_PROGRESS
    };
    let mut steps_left = steps_per_progress;
    let mut idle = true;
    loop {
        if idle {
            for row in 0..R {
                if lanes.motions[row].is_none() {
                    lanes.load_next(row, jobs);
                }
            }
            if lanes.motions.iter().all(Option::is_none) {
                return ControlFlow::Continue(());
            }
        }
        let before = if R == 1 && observer.is_some() {
            lanes.step_start()
        } else {
            None
        };
        idle = lanes.step();
        idle |= lanes.end_overlong();
        // The last step of a motion that was refused ends at a wrong time. It is not used: `solve_with_observer` shows the last step of a
        // complete run only.
        if let (Some(observer), Some(before)) = (&mut observer, before)
            && observer(lanes.finished_step(before), idle).is_break()
        {
            lanes.end_motion(0, End::Stopped);
            return ControlFlow::Break(());
        }
        steps_left -= 1;
        if steps_left == 0 {
            steps_left = steps_per_progress;
            if watch(lanes.fraction()).is_break() {
                for row in 0..R {
                    lanes.end_motion(row, End::Stopped);
                }
                return ControlFlow::Break(());
            }
        }
    }
}
