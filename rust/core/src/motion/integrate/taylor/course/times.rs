//! Times in units of the run, and of the task.

use super::segments::PiecewiseEquations;
use crate::error::Error;
use crate::motion::integrate::taylor::orbit_cache::CacheKey;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::problem::limits::check_steps;
use crate::numerics::double_double::two_sum;

impl<X: Precision> PiecewiseEquations<'_, X> {
    /// Time since the start of output `k`.
    pub(in crate::motion::integrate::taylor) fn output(&self, k: usize) -> (f64, f64) {
        self.since_start(self.task.times[k])
    }

    pub(in crate::motion::integrate::taylor) fn end_of_segment(&self) -> (f64, f64) {
        self.since_start(self.breaks[self.segment])
    }

    /// In units of the unit of rates, with what rounding leaves out.
    fn since_start(&self, t: f64) -> (f64, f64) {
        let (elapsed, rest) = two_sum(t, -self.task.times[0]);
        (elapsed * self.unit, rest * self.unit)
    }

    pub(in crate::motion::integrate::taylor) fn time(&self, now: (f64, f64)) -> f64 {
        self.task.times[0] + (now.0 + now.1) / self.unit
    }

    /// Where a step that begins at `now` stands in an almanac, and the unit of rates.
    #[inline(always)]
    pub(in crate::motion::integrate::taylor) fn cache_key(
        &self,
        now: (f64, f64),
    ) -> (CacheKey, f64) {
        let (start, unit) = (self.task.times[0], self.unit);
        let key = CacheKey {
            when: [now.0 / unit, now.1 / unit, start].map(f64::to_bits),
            terms: (self.terms.as_ptr().addr(), self.terms.len()),
        };
        (key, unit)
    }

    /// The whole length of the motion.
    pub(in crate::motion::integrate::taylor) fn last_elapsed(&self) -> f64 {
        self.last_time() - self.task.times[0]
    }

    /// The time of an output.
    pub(in crate::motion::integrate::taylor) fn time_of(&self, output: usize) -> f64 {
        self.task.times[output]
    }

    pub(in crate::motion::integrate::taylor) fn is_last(&self, output: usize) -> bool {
        output + 1 == self.task.times.len()
    }

    pub(in crate::motion::integrate::taylor) fn last_time(&self) -> f64 {
        self.task.times[self.task.times.len() - 1]
    }

    /// The most steps that it may take.
    pub(in crate::motion::integrate::taylor) fn most_steps(&self) -> u64 {
        self.task.tolerance.most_steps
    }

    /// Whether so many steps up to `now`, in units of the unit of rates, let the motion come to its end.
    pub(in crate::motion::integrate::taylor) fn check_steps(
        &self,
        steps: u64,
        now: f64,
    ) -> Result<(), Error> {
        check_steps(
            self.task.tolerance.most_steps,
            steps,
            self.task.times[0],
            now / self.unit,
            self.last_elapsed(),
        )
    }

    /// How much of the motion is done.
    pub(in crate::motion::integrate::taylor) fn fraction(&self, now: f64) -> f64 {
        let times = self.task.times;
        now / self.unit / (times[times.len() - 1] - times[0])
    }
}
