//! Motions side by side.

use super::settings::Settings;
use crate::error::Error;
use crate::motion::integrate::taylor::carried::Carried;
use crate::motion::integrate::taylor::course::Course;
use crate::motion::integrate::taylor::extras::Extras;
use crate::motion::integrate::taylor::field::Field;
use crate::motion::integrate::taylor::frame::Precision;
use crate::motion::integrate::taylor::pack::Pack;
use crate::motion::integrate::taylor::push::Push;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::integrate::taylor::step::Compensated;
use crate::motion::loads::Forcing;
use crate::motion::problem::{Effort, Run};
use crate::numerics::number::{Number, Real};

/// How far ω may outgrow the unit of rates before another is taken: far below where its 26th power overflows.
pub(super) const OUTGROWN: f64 = 65_536.0;

/// Steps of a motion between two looks at whether it will ever end.
const JUDGED_EVERY: u64 = 64;

/// Gets the samples of a motion in the numbers of its run.
pub(in crate::motion::integrate::taylor) type Tell<'a, X> = &'a mut dyn FnMut(usize, &[X; 7], &[X]);

/// A motion to be run, and its run, which is at its start.
pub(in crate::motion::integrate::taylor) struct Job<'a, X: Precision> {
    pub(in crate::motion::integrate::taylor) course: Course<'a, X>,
    pub(in crate::motion::integrate::taylor) run: &'a mut Run<Error>,
    /// Gets each sample by its number: ω and (x, y, z, w) in body axes and real units, as the run has them, and what is reported of
    /// the states of the load.
    pub(in crate::motion::integrate::taylor) tell: Option<Tell<'a, X>>,
}

/// What a motion comes to next.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// A time of output.
    Output,
    /// A break of its load.
    Break,
}

/// Why the equations of a motion change after a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Landing {
    None,
    Break,
    Flip,
}

/// A motion under way.
pub(super) struct Lead<'a, X: Precision> {
    pub(super) job: Job<'a, X>,
    pub(super) stop: Stop,
    pub(super) steps: u64,
    /// Changes of the law without a step between them.
    pub(super) flips_at_once: u32,
}

impl<X: Precision> Lead<'_, X> {
    /// Whether it is to be judged by its steps: now and then, and when it has taken all it may.
    #[inline(always)]
    pub(super) fn is_due(&self) -> bool {
        self.steps >= self.job.course.most_steps() || self.steps.is_multiple_of(JUDGED_EVERY)
    }
}

/// `R` motions under way. Times are since the start, in the unit of each motion.
pub(super) struct Lanes<'a, L: Number<Real: Precision>, S, const B: usize, const R: usize> {
    pub(super) settings: Settings,
    pub(super) series: S,
    pub(super) field: Field<Pack<L, R>, B>,
    pub(super) extras: Extras<Pack<L, R>>,
    /// What depends on the time in one of them: kept so that no step asks for memory.
    pub(super) forcing: Forcing<L::Real>,
    pub(super) directions: [[Pack<L, R>; 3]; B],
    pub(super) state: Compensated<Pack<L, R>>,
    pub(super) push: Option<Box<Push<Pack<L, R>>>>,
    pub(super) carried: Option<Box<Carried<Pack<L, R>>>>,
    pub(super) leads: [Option<Lead<'a, L::Real>>; R],
    /// The times now and of the next stop, each with what rounding has left out.
    pub(super) now: [(f64, f64); R],
    pub(super) stop: [(f64, f64); R],
    /// The largest |ω| so far, or what else counts as large, and 1 or −1 for backward in time.
    pub(super) fastest: [f64; R],
    pub(super) direction: [f64; R],
    /// The components of ω that are constant in each motion.
    pub(super) still: [[bool; 3]; R],
}

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Pack<L, R>, B>,
{
    /// All empty.
    #[inline(always)]
    pub(super) fn new(settings: Settings) -> Self {
        let zero = Pack::new(0.0);
        Self {
            settings,
            series: S::new(),
            field: Field::none(zero),
            extras: Extras::new(&settings.parts),
            forcing: Forcing::default(),
            directions: [[zero; 3]; B],
            state: Compensated::new(),
            push: settings.parts.is_pushed.then(|| Box::new(Push::new())),
            carried: match settings.parts.internal_states {
                0 => None,
                count => Some(Box::new(Carried::new(count))),
            },
            leads: [const { None }; R],
            now: [(0.0, 0.0); R],
            stop: [(f64::INFINITY, 0.0); R],
            fastest: [1.0; R],
            direction: [1.0; R],
            still: [[true; 3]; R],
        }
    }

    /// Tells the series which component of ω is constant in all motions.
    pub(super) fn hold(&mut self) {
        let is_still = |n: &usize| self.still.iter().all(|row| row[*n]);
        let still = [0, 2].into_iter().find(is_still);
        let goes_by_itself = !self.extras.is_timed() && self.carried.is_none();
        self.series.hold(still.filter(|_| goes_by_itself));
    }

    /// The time from now to the next stop, positive also backward in time.
    #[inline(always)]
    pub(super) fn gap(&self, row: usize) -> f64 {
        let ((now, now_rest), (stop, stop_rest)) = (self.now[row], self.stop[row]);
        ((stop - now) + (stop_rest - now_rest)) * self.direction[row]
    }

    /// The time from now to the next stop. Not inlined: the compiler would compute it in every step, though only a break or an
    /// output needs it.
    #[inline(never)]
    pub(super) fn time_to_stop(&self, row: usize) -> L::Real {
        let ((now, now_rest), (stop, stop_rest)) = (self.now[row], self.stop[row]);
        L::Real::pair(stop, -now) + L::Real::pair(stop_rest, -now_rest)
    }

    pub(super) fn time(&self, row: usize) -> f64 {
        let lead = self.leads[row].as_ref();
        lead.map_or(f64::NAN, |lead| lead.job.course.time(self.now[row]))
    }

    pub(super) fn fraction(&self) -> f64 {
        let lead = self.leads[0].as_ref();
        lead.map_or(1.0, |lead| lead.job.course.fraction(self.now[0].0))
    }
}

/// An evaluation is that of all coefficients of a step.
pub(super) fn effort(steps: u64) -> Effort {
    Effort {
        steps,
        evaluations: steps,
    }
}
