//! Motions side by side.

use super::settings::Settings;
use crate::error::Error;
use crate::motion::integrate::taylor::batch::Batch;
use crate::motion::integrate::taylor::course::PiecewiseEquations;
use crate::motion::integrate::taylor::internal_states::InternalStates;
use crate::motion::integrate::taylor::linear_terms::LinearTerms;
use crate::motion::integrate::taylor::nonlinear::NonlinearTerms;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::integrate::taylor::step::Compensated;
use crate::motion::integrate::taylor::translation::Translation;
use crate::motion::loads::Forcing;
use crate::motion::problem::{Effort, Run};
use crate::numerics::number::{Number, Real};

/// How far ω may outgrow the unit of rates before another is taken: far below where its 26th power overflows.
pub(super) const MAX_RATE: f64 = 65_536.0;

/// Steps of a motion between two looks at whether it will ever end.
const STEPS_PER_CHECK: u64 = 64;

/// Gets the samples of a motion in the numbers of its run.
pub(in crate::motion::integrate::taylor) type SampleSink<'a, X> =
    &'a mut dyn FnMut(usize, &[X; 7], &[X]);

/// A motion to be run, and its run, which is at its start.
pub(in crate::motion::integrate::taylor) struct Job<'a, X: Precision> {
    pub(in crate::motion::integrate::taylor) equations: PiecewiseEquations<'a, X>,
    pub(in crate::motion::integrate::taylor) run: &'a mut Run<Error>,
    /// Gets each sample by its number: ω and (x, y, z, w) in body axes and real units, as the run has them, and what is reported of
    /// the states of the load.
    pub(in crate::motion::integrate::taylor) sink: Option<SampleSink<'a, X>>,
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
    Switch,
}

/// A motion under way.
pub(super) struct ActiveMotion<'a, X: Precision> {
    pub(super) job: Job<'a, X>,
    pub(super) stop: Stop,
    pub(super) steps: u64,
    /// Changes of the law without a step between them.
    pub(super) switches_without_step: u32,
}

impl<X: Precision> ActiveMotion<'_, X> {
    /// Whether it is to be judged by its steps: now and then, and when it has taken all it may.
    #[inline(always)]
    pub(super) fn is_due(&self) -> bool {
        self.steps >= self.job.equations.most_steps() || self.steps.is_multiple_of(STEPS_PER_CHECK)
    }
}

/// `R` motions under way. Times are since the start, in the unit of each motion.
pub(super) struct Lanes<'a, L: Number<Real: Precision>, S, const B: usize, const R: usize> {
    pub(super) settings: Settings,
    pub(super) series: S,
    pub(super) linear_terms: LinearTerms<Batch<L, R>, B>,
    pub(super) nonlinear: NonlinearTerms<Batch<L, R>>,
    /// What depends on the time in one of them: kept so that no step asks for memory.
    pub(super) forcing: Forcing<L::Real>,
    pub(super) directions: [[Batch<L, R>; 3]; B],
    pub(super) state: Compensated<Batch<L, R>>,
    pub(super) translation: Option<Box<Translation<Batch<L, R>>>>,
    pub(super) internal_states: Option<Box<InternalStates<Batch<L, R>>>>,
    pub(super) motions: [Option<ActiveMotion<'a, L::Real>>; R],
    /// The times now and of the next stop, each with what rounding has left out.
    pub(super) now: [(f64, f64); R],
    pub(super) stop: [(f64, f64); R],
    /// The largest |ω| so far, or what else counts as large, and 1 or −1 for backward in time.
    pub(super) fastest: [f64; R],
    pub(super) direction: [f64; R],
    /// The components of ω that are constant in each motion.
    pub(super) constant_components: [[bool; 3]; R],
}

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// All empty.
    #[inline(always)]
    pub(super) fn new(settings: Settings) -> Self {
        let zero = Batch::new(0.0);
        Self {
            settings,
            series: S::new(),
            linear_terms: LinearTerms::none(zero),
            nonlinear: NonlinearTerms::new(&settings.parts),
            forcing: Forcing::default(),
            directions: [[zero; 3]; B],
            state: Compensated::new(),
            translation: settings
                .parts
                .is_pushed
                .then(|| Box::new(Translation::new())),
            internal_states: match settings.parts.own {
                0 => None,
                count => Some(Box::new(InternalStates::new(count))),
            },
            motions: [const { None }; R],
            now: [(0.0, 0.0); R],
            stop: [(f64::INFINITY, 0.0); R],
            fastest: [1.0; R],
            direction: [1.0; R],
            constant_components: [[true; 3]; R],
        }
    }

    /// Tells the series which component of ω is constant in all motions.
    pub(super) fn update_constant_component(&mut self) {
        let is_constant = |n: &usize| self.constant_components.iter().all(|row| row[*n]);
        let constant = [0, 2].into_iter().find(is_constant);
        let is_autonomous = !self.nonlinear.is_timed() && self.internal_states.is_none();
        self.series
            .set_constant_component(constant.filter(|_| is_autonomous));
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
        let motion = self.motions[row].as_ref();
        motion.map_or(f64::NAN, |motion| motion.job.equations.time(self.now[row]))
    }

    pub(super) fn fraction(&self) -> f64 {
        let motion = self.motions[0].as_ref();
        motion.map_or(1.0, |motion| motion.job.equations.fraction(self.now[0].0))
    }
}

/// An evaluation is that of all coefficients of a step.
pub(super) fn effort(steps: u64) -> Effort {
    Effort {
        steps,
        evaluations: steps,
    }
}
