//! Where within a step the law of a motion changes: at the zeros of its switching functions.
//!
//! These are the scalar part of each feedback's error and, under quadratic damping, `ω(0)·ω(t)`, which passes through zero with
//! ω. Both are linear in the state, so that their series are known with it, and all their zeros within a step are
//! found, however many and however close.

use super::lanes::{Landing, Lanes};
use crate::motion::integrate::taylor::batch::Batch;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::series::MAX_COUNT;
use crate::motion::integrate::taylor::series::Series;
use crate::numerics::number::Number;
use crate::numerics::sign_changes::sign_changes;

/// How far behind the zero of its series, relative to the step, a function is asked for its sign.
const HIDDEN_BY_ROUNDING: f64 = 1e-9;

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// The step `h` of one row, or what is left of it until the law changes.
    #[inline(always)]
    pub(super) fn until_switch(&self, row: usize, h: f64) -> (f64, Landing) {
        for place in self.switch_times(row, h) {
            // The state itself has to show the change, here or some last digits later; where rounding hides it, there is none.
            let (mut time, mut later) = (place, f64::EPSILON * place.max(f64::EPSILON * h));
            while time <= h && later <= HIDDEN_BY_ROUNDING * h {
                let (state, _) = self.within(row, L::Real::from(time * self.direction[row]));
                if self.has_switched(row, &state) {
                    return (time, Landing::Switch);
                }
                time = place + later;
                later *= 2.0;
            }
        }
        (h, Landing::None)
    }

    /// The times within the step `h` of one row at which the series of its switching functions pass through zero, ascending.
    #[inline(never)]
    fn switch_times(&self, row: usize, h: f64) -> Vec<f64> {
        let mut switch_times = Vec::new();
        let Some(motion) = &self.motions[row] else {
            return switch_times;
        };
        let equations = &motion.job.equations;
        let now = self.now[row];
        let end = equations.end_of_segment();
        let left = ((end.0 - now.0) + (end.1 - now.1)) * self.direction[row];
        let length = h.min(left);
        // The shortest step that advances the time.
        let least = 2.0 * f64::EPSILON * now.0.abs();
        // A step that is not a number, or advances nothing, is an error elsewhere.
        if !(h.is_finite() && length > least) {
            return switch_times;
        }
        let mut add_zeros = |value: &dyn Fn(usize) -> f64, side: f64| {
            let mut coefficients = [0.0; MAX_COUNT];
            let coefficients = &mut coefficients[..=self.settings.order];
            let mut power = 1.0;
            for (k, coefficient) in coefficients.iter_mut().enumerate() {
                *coefficient = value(k) * power;
                power *= length * self.direction[row];
            }
            switch_times.extend(sign_changes(coefficients, Some(side)));
        };
        for index in 0..equations.switch_count() {
            let value = |k: usize| {
                let q = self.series.get(k).q;
                equations.switch_value(index, &[0, 1, 2, 3].map(|i| q[i].real(row)))
            };
            add_zeros(&value, equations.side(index));
        }
        if self.nonlinear.formulas.may_reverse(row) {
            let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
            let along = |k: usize| {
                let w = self.series.get(k).w;
                (0..3).map(|i| start[i] * w[i].get(row)).sum()
            };
            add_zeros(&along, 1.0);
        }
        switch_times.sort_by(f64::total_cmp);
        (switch_times.into_iter())
            .map(|place| (place * length).max(least).max(f64::MIN_POSITIVE))
            .collect()
    }
}
