//! Motions in the lanes that serve them: one after the other or side by side, in doubles or in numbers of twice the precision.

use std::ops::ControlFlow;

use super::batch_series::BatchSeries;
use super::double_double_series::DoubleDoubleSeries;
use super::drive::{Job, Observer, Settings, drive};
use super::orbit_cache::OrbitSeriesCache;
use super::single_series::SingleMotionSeries;
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::Lane;
use crate::numerics::twofold::Twofold;

/// Motions side by side: a register of the widest machines.
pub(super) const ROWS: usize = 8;

/// Motions one after the other in numbers of twice the precision.
pub(super) struct InDoubleDouble<'a, 'b> {
    pub(super) settings: Settings,
    pub(super) jobs: &'b mut dyn Iterator<Item = Job<'a, DoubleDouble>>,
    pub(super) watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
    pub(super) observer: Option<Observer<'b>>,
}

impl Kernel for InDoubleDouble<'_, '_> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Self {
            settings,
            jobs,
            watch,
            observer,
        } = self;
        let cache = &mut OrbitSeriesCache::default();
        match settings.parts.directions {
            0 => drive::<Twofold<L>, DoubleDoubleSeries<L, 0, 4>, 0, 1>(
                settings, jobs, watch, observer, cache,
            ),
            1 => drive::<Twofold<L>, DoubleDoubleSeries<L, 1, 8>, 1, 1>(
                settings, jobs, watch, observer, cache,
            ),
            _ => drive::<Twofold<L>, DoubleDoubleSeries<L, 3, 16>, 3, 1>(
                settings, jobs, watch, observer, cache,
            ),
        }
    }
}

/// Motions one after the other, the lanes over the components of each.
pub(super) struct OneByOne<'a, 'b> {
    pub(super) settings: Settings,
    pub(super) jobs: &'b mut dyn Iterator<Item = Job<'a, f64>>,
    pub(super) watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
    pub(super) observer: Option<Observer<'b>>,
}

impl Kernel for OneByOne<'_, '_> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let Self {
            settings,
            jobs,
            watch,
            observer,
        } = self;
        let cache = &mut OrbitSeriesCache::default();
        match settings.parts.directions {
            0 => drive::<L, SingleMotionSeries<L, 0>, 0, 1>(settings, jobs, watch, observer, cache),
            1 => drive::<L, SingleMotionSeries<L, 1>, 1, 1>(settings, jobs, watch, observer, cache),
            _ => drive::<L, SingleMotionSeries<L, 3>, 3, 1>(settings, jobs, watch, observer, cache),
        }
    }
}

/// Motions side by side, the lanes over the motions.
pub(super) struct SideBySide<'a, 'b> {
    pub(super) settings: Settings,
    pub(super) jobs: &'b mut dyn Iterator<Item = Job<'a, f64>>,
    pub(super) watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
    pub(super) cache: &'b mut OrbitSeriesCache,
}

impl SideBySide<'_, '_> {
    /// Runs them, in a function for each number of directions: all in one take four megabytes of the stack without
    /// optimization.
    pub(super) fn run(self) -> ControlFlow<()> {
        match self.settings.parts.directions {
            0 => dispatch(Directed::<0>(self)),
            1 => dispatch(Directed::<1>(self)),
            _ => dispatch(Directed::<3>(self)),
        }
    }
}

/// With this number of directions.
struct Directed<'a, 'b, const B: usize>(SideBySide<'a, 'b>);

impl<const B: usize> Kernel for Directed<'_, '_, B> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        let SideBySide {
            settings,
            jobs,
            watch,
            cache,
        } = self.0;
        drive::<L, BatchSeries<L, B, ROWS>, B, ROWS>(settings, jobs, watch, None, cache)
    }
}
