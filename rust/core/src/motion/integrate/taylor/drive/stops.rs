//! What a motion comes to: outputs, breaks of its load, changes of its law.

use super::lanes::{Landing, Lanes, MAX_RATE, Stop, effort};
use crate::error::{Error, MotionFault};
use crate::motion::integrate::taylor::batch::Batch;
use crate::motion::integrate::taylor::course::{AuxiliaryState, PiecewiseEquations};
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::problem::End;
use crate::numerics::number::{Number, Real};

/// What a motion comes to within a step.
pub(super) enum Arrival<X> {
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
    /// What a motion comes to next in a step as long as `h`.
    #[inline(never)]
    pub(super) fn next_arrival(&mut self, row: usize, h: f64) -> Arrival<L::Real> {
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
    pub(super) fn record_sample(
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
}

/// The output `next` or the end of the segment, whichever comes first.
pub(super) fn next_stop<X: Precision>(
    equations: &PiecewiseEquations<X>,
    next: usize,
) -> ((f64, f64), Stop) {
    let (output, end) = (equations.output(next), equations.end_of_segment());
    // An output on a break belongs to the segment that ends there.
    let ahead = ((output.0 - end.0) + (output.1 - end.1)) * equations.direction();
    if ahead > 0.0 {
        (end, Stop::Break)
    } else {
        (output, Stop::Output)
    }
}
