//! What a motion comes to: outputs, breaks of its load, changes of its law.
//!
//! The law of a motion changes at the zeros of its switching functions.
//! These are the scalar part of each feedback's error and, under quadratic damping, `ω(0)·ω(t)`, which passes through zero with
//! ω. Both are linear in the state, so that their series are known with it, and all their zeros within a step are
//! found, however many and however close.

use super::batch::Batch;
use super::driver::{Landing, Lanes, MAX_RATE, Stop, effort, next_stop};
use super::equations::AuxiliaryState;
use super::principal_frame::Precision;
use super::series::{MAX_COUNT, Series};
use crate::error::{Error, MotionFault};
use crate::motion::problem::End;
use crate::motion::problem::limits::HELD;
use crate::numerics::number::{Number, Real};
use crate::numerics::sign_changes::sign_changes;

/// How far behind the zero of its series, relative to the step, a function is asked for its sign.
const HIDDEN_BY_ROUNDING: f64 = 1e-9;

/// What a motion comes to within a step.
enum Arrival<X> {
    /// An output, at this time since the start of the step.
    Output(X),
    /// A break, after this time.
    Break(f64),
    Nothing,
    End,
}

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// Serves what a motion comes to within the step `h`: the step that is left, and what it lands on.
    #[inline(always)]
    pub(super) fn serve_stops(&mut self, row: usize, h: f64) -> (f64, Landing) {
        let (mut h, landing) = if self.settings.parts.may_flip() {
            self.until_switch(row, h)
        } else {
            (h, Landing::None)
        };
        if landing == Landing::Switch && self.is_sticking(row, h) {
            h = 0.0; // which advances nothing: an error
        }
        loop {
            let time = match self.next_arrival(row, h) {
                Arrival::Output(time) => time,
                Arrival::Break(gap) => return (gap, Landing::Break),
                Arrival::Nothing => return (h, landing),
                Arrival::End => return (0.0, Landing::None),
            };
            let (state, auxiliary) = self.within(row, time);
            self.record_sample(row, &state, &auxiliary);
        }
    }

    /// What a motion comes to next in a step as long as `h`.
    #[inline(never)]
    fn next_arrival(&mut self, row: usize, h: f64) -> Arrival<L::Real> {
        let gap = self.gap(row);
        let time = self.time(row);
        let Some(motion) = &self.motions[row] else {
            return Arrival::End;
        };
        let advances = h > f64::EPSILON * self.now[row].0.abs();
        if !advances {
            let error = if h.is_finite() {
                Error::Motion(MotionFault::StepTooSmall {
                    time,
                    step: h / motion.job.equations.unit(),
                })
            } else {
                Error::Motion(MotionFault::NotFiniteMotion { time })
            };
            self.end_motion(row, End::Failed(error));
            return Arrival::End;
        }
        match motion.stop {
            _ if gap > h => Arrival::Nothing,
            Stop::Output => Arrival::Output(self.time_to_stop(row)),
            Stop::Break => Arrival::Break(gap),
        }
    }

    /// Gives a sample to a motion; after the last one it ends.
    #[inline(never)]
    fn record_sample(
        &mut self,
        row: usize,
        state: &[L::Real; 7],
        auxiliary: &AuxiliaryState<L::Real>,
    ) {
        let now = self.stop[row];
        let Some(motion) = &mut self.motions[row] else {
            return;
        };
        let phase = motion.job.equations.phase(state, auxiliary, now);
        let run = &mut *motion.job.run;
        if !phase.is_finite() {
            // It came to the last state that is one.
            let before = run.samples.len() - 1;
            run.effort = effort(motion.steps);
            run.time = motion.job.equations.time_of(before);
            run.phase = run.samples[before].clone();
            let time = motion.job.equations.time_of(before + 1);
            run.end = End::Failed(Error::Motion(MotionFault::NotFiniteMotion { time }));
            self.motions[row] = None;
            return;
        }
        let number = run.samples.len();
        let is_last = motion.job.equations.is_last(number);
        if is_last {
            run.phase.clone_from(&phase);
        }
        run.samples.push(phase);
        if let Some(sink) = &mut motion.job.sink {
            let equations = &motion.job.equations;
            let own = equations.reported_internal_states(state, &auxiliary.internal_states);
            sink(number, &equations.in_body(state), &own);
        }
        if is_last {
            run.effort = effort(motion.steps + 1);
            run.time = motion.job.equations.last_time();
            run.end = End::Complete;
            self.motions[row] = None;
        } else {
            (self.stop[row], motion.stop) = next_stop(&motion.job.equations, number + 1);
        }
    }

    /// After a step: past a break or a flip the equations are others, and a motion that has become much faster takes
    /// another unit.
    #[inline(never)]
    pub(super) fn finish_step(&mut self, row: usize, landing: Landing) {
        let mut state = self.state.now(row);
        let mut own = match &self.internal_states {
            Some(internal_states) if L::VARIES => internal_states.now(row),
            _ => Vec::new(),
        };
        let Some(motion) = &mut self.motions[row] else {
            return;
        };
        let equations = &mut motion.job.equations;
        let changed = match landing {
            Landing::None => Ok(()),
            Landing::Break => {
                self.now[row] = self.stop[row];
                self.nonlinear.restart(row);
                equations.pass_break(&state)
            }
            Landing::Switch => equations.switch_laws(&mut state, &mut own),
        };
        if L::VARIES && landing == Landing::Switch {
            for i in 0..3 {
                self.state.value[i].put(row, state[i]);
            }
            if let Some(internal_states) = &mut self.internal_states {
                internal_states.put(row, &own);
            }
        }
        if let Err(error) = changed {
            self.end_motion(row, End::Failed(error));
        } else if landing != Landing::None
            || state[..3]
                .iter()
                .any(|w| w.rounded().abs() > 0.5 * MAX_RATE)
        {
            self.enter_segment(row);
        }
    }

    /// Whether the law of a motion, which changes after the step `h`, has changed on one spot again and again: then it holds the
    /// body there.
    fn is_sticking(&mut self, row: usize, h: f64) -> bool {
        let least = (4.0 * f64::EPSILON * self.now[row].0.abs()).max(f64::MIN_POSITIVE);
        let Some(motion) = &mut self.motions[row] else {
            return false;
        };
        motion.switches_without_step = if h > least {
            0
        } else {
            motion.switches_without_step + 1
        };
        motion.switches_without_step > HELD
    }

    /// The step `h` of one row, or what is left of it until the law changes.
    #[inline(always)]
    fn until_switch(&self, row: usize, h: f64) -> (f64, Landing) {
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

    /// Whether a feedback has another sign in the `state` later in the step than at its start, or ω has passed through zero
    /// under quadratic damping.
    #[inline(never)]
    fn has_switched(&self, row: usize, state: &[L::Real; 7]) -> bool {
        let motion = self.motions[row].as_ref();
        let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
        let omega = [0, 1, 2].map(|i| state[i].rounded());
        motion.is_some_and(|motion| motion.job.equations.has_switched(state))
            || (self.nonlinear.formulas).is_reversed(row, &start, &omega)
    }
}
