//! Until all motions are done.

use std::mem::swap;
use std::ops::ControlFlow;

use super::lanes::{Job, Lanes};
use super::settings::Settings;
use super::shown::See;
use crate::motion::integrate::taylor::orbit_cache::Almanac;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::batch::Pack;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::problem::End;
use crate::numerics::number::Number;

/// Steps between two looks at the watch, and of motions with derivatives, which take longer.
const PATIENCE: u32 = 64;
const PATIENCE_OF_DERIVATIVES: u32 = 4;

/// Runs all motions that `jobs` gives. About every 64 steps `watch` gets the fraction of the first lane's motion that is
/// done, and may stop them. `see` is for motions one after the other; orbits are looked up in the almanac and put down there.
#[inline(always)]
pub(in crate::motion::integrate::taylor) fn drive<
    L: Number<Real: Precision>,
    S: Series<Pack<L, R>, B>,
    const B: usize,
    const R: usize,
>(
    settings: Settings,
    jobs: &mut dyn Iterator<Item = Job<'_, L::Real>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    see: Option<See>,
    almanac: &mut Almanac,
) -> ControlFlow<()> {
    let mut lanes = Lanes::<L, S, B, R>::new(settings);
    swap(&mut lanes.extras.almanac, almanac);
    let flow = run(&mut lanes, jobs, watch, see);
    swap(&mut lanes.extras.almanac, almanac);
    flow
}

#[inline(always)]
fn run<'a, L: Number<Real: Precision>, S: Series<Pack<L, R>, B>, const B: usize, const R: usize>(
    lanes: &mut Lanes<'a, L, S, B, R>,
    jobs: &mut dyn Iterator<Item = Job<'a, L::Real>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    mut see: Option<See>,
) -> ControlFlow<()> {
    let looks_after = if L::VARIES {
        PATIENCE_OF_DERIVATIVES
    } else {
        PATIENCE
    };
    let mut patience = looks_after;
    let mut idle = true;
    loop {
        if idle {
            for row in 0..R {
                if lanes.leads[row].is_none() {
                    lanes.load(row, jobs);
                }
            }
            if lanes.leads.iter().all(Option::is_none) {
                return ControlFlow::Continue(());
            }
        }
        let before = if R == 1 && see.is_some() {
            lanes.before()
        } else {
            None
        };
        idle = lanes.step();
        idle |= lanes.refuse_endless();
        // The last step of a motion that was refused ends at a wrong time. It is not used: `solve_seen` shows the last step of a
        // complete run only.
        if let (Some(see), Some(before)) = (&mut see, before)
            && see(lanes.seen(before), idle).is_break()
        {
            lanes.end(0, End::Stopped);
            return ControlFlow::Break(());
        }
        patience -= 1;
        if patience == 0 {
            patience = looks_after;
            if watch(lanes.fraction()).is_break() {
                for row in 0..R {
                    lanes.end(row, End::Stopped);
                }
                return ControlFlow::Break(());
            }
        }
    }
}
