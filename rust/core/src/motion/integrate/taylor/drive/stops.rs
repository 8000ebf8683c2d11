//! What a motion comes to: outputs, breaks of its load, changes of its law.

use super::lanes::{Landing, Lanes, OUTGROWN, Stop, effort};
use crate::error::{Error, MotionFault};
use crate::motion::integrate::taylor::course::{Besides, Course};
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::batch::Pack;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::problem::End;
use crate::numerics::number::{Number, Real};

/// What a motion comes to within a step.
pub(super) enum Meeting<X> {
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
    S: Series<Pack<L, R>, B>,
{
    /// What a motion comes to next in a step as long as `h`.
    #[inline(never)]
    pub(super) fn meet(&mut self, row: usize, h: f64) -> Meeting<L::Real> {
        let gap = self.gap(row);
        let time = self.time(row);
        let Some(lead) = &self.leads[row] else {
            return Meeting::End;
        };
        let advances = h > f64::EPSILON * self.now[row].0.abs();
        if !advances {
            let error = if h.is_finite() {
                Error::Motion(MotionFault::StepTooSmall {
                    time,
                    step: h / lead.job.course.unit(),
                })
            } else {
                Error::Motion(MotionFault::NotFiniteMotion { time })
            };
            self.end(row, End::Failed(error));
            return Meeting::End;
        }
        match lead.stop {
            _ if gap > h => Meeting::Nothing,
            Stop::Output => Meeting::Output(self.time_to_stop(row)),
            Stop::Break => Meeting::Break(gap),
        }
    }

    /// Gives a sample to a motion; after the last one it ends.
    #[inline(never)]
    pub(super) fn give(&mut self, row: usize, state: &[L::Real; 7], besides: &Besides<L::Real>) {
        let now = self.stop[row];
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        let phase = lead.job.course.phase(state, besides, now);
        let run = &mut *lead.job.run;
        if !phase.is_finite() {
            // It came to the last state that is one.
            let before = run.samples.len() - 1;
            run.effort = effort(lead.steps);
            run.time = lead.job.course.time_of(before);
            run.phase = run.samples[before].clone();
            let time = lead.job.course.time_of(before + 1);
            run.end = End::Failed(Error::Motion(MotionFault::NotFiniteMotion { time }));
            self.leads[row] = None;
            return;
        }
        let number = run.samples.len();
        let is_last = lead.job.course.is_last(number);
        if is_last {
            run.phase.clone_from(&phase);
        }
        run.samples.push(phase);
        if let Some(tell) = &mut lead.job.tell {
            let course = &lead.job.course;
            let own = course.own_reported(state, &besides.own);
            tell(number, &course.in_body(state), &own);
        }
        if is_last {
            run.effort = effort(lead.steps + 1);
            run.time = lead.job.course.last_time();
            run.end = End::Complete;
            self.leads[row] = None;
        } else {
            (self.stop[row], lead.stop) = next_stop(&lead.job.course, number + 1);
        }
    }

    /// After a step: past a break or a flip the equations are others, and a motion that has become much faster takes
    /// another unit.
    #[inline(never)]
    pub(super) fn settle(&mut self, row: usize, landing: Landing) {
        let mut state = self.state.now(row);
        let mut own = match &self.carried {
            Some(carried) if L::VARIES => carried.now(row),
            _ => Vec::new(),
        };
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        let course = &mut lead.job.course;
        let changed = match landing {
            Landing::None => Ok(()),
            Landing::Break => {
                self.now[row] = self.stop[row];
                self.extras.restart(row);
                course.pass_break(&state)
            }
            Landing::Flip => course.flip(&mut state, &mut own),
        };
        if L::VARIES && landing == Landing::Flip {
            for i in 0..3 {
                self.state.value[i].put(row, state[i]);
            }
            if let Some(carried) = &mut self.carried {
                carried.put(row, &own);
            }
        }
        if let Err(error) = changed {
            self.end(row, End::Failed(error));
        } else if landing != Landing::None
            || state[..3]
                .iter()
                .any(|w| w.rounded().abs() > 0.5 * OUTGROWN)
        {
            self.enter(row);
        }
    }
}

/// The output `next` or the end of the segment, whichever comes first.
pub(super) fn next_stop<X: Precision>(course: &Course<X>, next: usize) -> ((f64, f64), Stop) {
    let (output, end) = (course.output(next), course.end_of_segment());
    // An output on a break belongs to the segment that ends there.
    let ahead = ((output.0 - end.0) + (output.1 - end.1)) * course.direction();
    if ahead > 0.0 {
        (end, Stop::Break)
    } else {
        (output, Stop::Output)
    }
}
