//! Stops within a step: outputs, breaks of the load, switches of its law.
//!
//! The law of a motion switches at the zeros of its switching functions. These are the scalar part of the error of each feedback and,
//! under quadratic damping, `ω(0)·ω(t)`, which passes through zero with ω. Both are linear in the state. So their series are known,
//! and all their zeros within a step are found, even if they are many or close to each other.

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

/// The largest distance behind a zero of the series, relative to the step, at which the sign of a function is checked.
const HIDDEN_BY_ROUNDING: f64 = 1e-9;

/// The next stop of a motion within a step.
enum Arrival<X> {
    /// An output at this time since the start of the step.
    Output(X),
    /// A break after this time.
    Break(f64),
    Nothing,
    End,
}

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// Record the outputs of a motion within the step `h`. Return the length of the step, up to a break or a switch, and its landing.
    #[inline(always)]
    pub(super) fn serve_stops(&mut self, row: usize, h: f64) -> (f64, Landing) {
        let (mut h, landing) = if self.settings.parts.may_flip() {
            self.until_switch(row, h)
        } else {
            (h, Landing::None)
        };
        if landing == Landing::Switch && self.is_sticking(row, h) {
            h = 0.0; // a step without length is an error
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

    /// Return the next stop of a motion in a step of length `h`.
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

    /// Record a sample of a motion; after the last sample the motion ends.
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
            // The run ends at its last finite sample.
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

    /// Finish a step: change the equations after a break or a switch, and the unit of a motion that has become much faster.
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

    /// Return whether the law of a motion, which switches after the step `h`, has switched many times without a step between: then it
    /// holds the body there.
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

    /// Return the length of the step of one row: `h`, or the time until the law switches.
    #[inline(always)]
    fn until_switch(&self, row: usize, h: f64) -> (f64, Landing) {
        for zero in self.switch_times(row, h) {
            // The state itself must have the new sign, here or a few last digits later. If rounding hides it, there is no switch.
            let (mut time, mut later) = (zero, f64::EPSILON * zero.max(f64::EPSILON * h));
            while time <= h && later <= HIDDEN_BY_ROUNDING * h {
                let (state, _) = self.within(row, L::Real::from(time * self.direction[row]));
                if self.has_switched(row, &state) {
                    return (time, Landing::Switch);
                }
                time = zero + later;
                later *= 2.0;
            }
        }
        (h, Landing::None)
    }

    /// Find the zeros of the series of the switching functions within the step `h` of one row: times, ascending.
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
        // A step that is NaN, or does not advance the time, is an error elsewhere.
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
            .map(|zero| (zero * length).max(least).max(f64::MIN_POSITIVE))
            .collect()
    }

    /// Return whether a feedback has changed its sign between the start of the step and `state`, or ω has passed through zero under
    /// quadratic damping.
    #[inline(never)]
    fn has_switched(&self, row: usize, state: &[L::Real; 7]) -> bool {
        let motion = self.motions[row].as_ref();
        let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
        let omega = [0, 1, 2].map(|i| state[i].rounded());
        motion.is_some_and(|motion| motion.job.equations.has_switched(state))
            || (self.nonlinear.formulas).is_reversed(row, &start, &omega)
    }
}
