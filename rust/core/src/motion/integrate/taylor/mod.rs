//! Taylor series.

mod course;
mod drive;
mod field;
mod pack;
mod series;
mod step;

use std::ops::ControlFlow;

pub use course::Problem;
use course::Course;
pub use drive::Outcome;
use drive::{Job, Settings, drive};
use field::Parts;
use series::{Abreast, Alone};

use crate::error::Error;
use crate::motion::simulate::{Effort, Failure, State, Tolerance};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;

/// Rows side by side.
const ROWS: usize = 8;

struct One<'a, 'b> {
    settings: Settings,
    blocks: usize,
    jobs: &'b mut dyn Iterator<Item = Job<'a>>,
    watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Kernel for One<'_, '_> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        match self.blocks {
            0 => drive::<L, Alone<L, 0, 4>, 0, 1>(self.settings, self.jobs, self.watch),
            _ => drive::<L, Alone<L, 1, 8>, 1, 1>(self.settings, self.jobs, self.watch),
        }
    }
}

struct Many<'a, 'b> {
    settings: Settings,
    blocks: usize,
    jobs: &'b mut dyn Iterator<Item = Job<'a>>,
    watch: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Kernel for Many<'_, '_> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lane>(self) -> ControlFlow<()> {
        match self.blocks {
            0 => drive::<L, Abreast<L, 0, ROWS>, 0, ROWS>(self.settings, self.jobs, self.watch),
            _ => drive::<L, Abreast<L, 1, ROWS>, 1, ROWS>(self.settings, self.jobs, self.watch),
        }
    }
}

/// One.
pub fn solve_one(
    problem: &Problem,
    times: &[f64],
    tolerance: Tolerance,
    samples: &mut [State],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Effort, Failure<Error>> {
    let mut outcome = Ok(Effort { steps: 0, evaluations: 0 });
    samples[0] = problem.initial;
    let course = Course::new(*problem, times).map_err(|e| Failure { time: times[0], state: problem.initial, cause: crate::motion::simulate::Cause::Failed(e) })?;
    let settings = Settings::new(tolerance.relative, tolerance.absolute, Parts::default());
    let mut jobs = std::iter::once(Job { course, samples, outcome: &mut outcome });
    let blocks = usize::from(!problem.terms.is_empty());
    let _ = dispatch(One { settings, blocks, jobs: &mut jobs, watch });
    outcome
}

/// Many.
pub fn solve_many(
    problems: &[Problem],
    times: &[f64],
    tolerance: Tolerance,
    samples: &mut [State],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Vec<Outcome> {
    let mut outcomes: Vec<Outcome> = vec![Ok(Effort { steps: 0, evaluations: 0 }); problems.len()];
    let settings = Settings::new(tolerance.relative, tolerance.absolute, Parts::default());
    let blocks = usize::from(!problems[0].terms.is_empty());
    let mut jobs = problems.iter().zip(samples.chunks_mut(times.len())).zip(&mut outcomes).filter_map(|((p, s), o)| {
        s[0] = p.initial;
        Some(Job { course: Course::new(*p, times).ok()?, samples: s, outcome: o })
    });
    let _ = dispatch(Many { settings, blocks, jobs: &mut jobs, watch });
    drop(jobs);
    outcomes
}
