//! Splitting into kicks and free motions.

use super::stepper::{Carry, Dense, Span, Stepper};
use crate::error::{Error, MotionFault};
use crate::motion::integrate::Splitting;
use crate::motion::loads::{Change, Load};
use crate::motion::problem::{Effort, Task};
use crate::motion::state::Phase;

/// A run of [`Splitting`].
pub(super) struct Kicked<'a, L> {
    load: &'a mut L,
    carry: Carry,
    stepper: Splitting,
}

impl<'a, L: Load> Kicked<'a, L> {
    pub(super) fn new(task: &Task<'_>, span: &Span, load: &'a mut L) -> Result<Self, L::Error> {
        if load.depends_on_rates() {
            return Err(Error::Motion(MotionFault::MethodCannotServe {
                method: "splitting",
                needs: "a load that does not depend on the angular velocity, and calls no function",
                instead: "dop853",
            })
            .into());
        }
        let stepper = Splitting::new(
            &task.euler,
            (!task.subject.pivoted).then_some(task.subject.mass),
            [span.from, span.to],
            &span.phase,
            load,
            task.tolerance.relative,
            span.carry.scheme.zip(span.carry.step),
        )?;
        Ok(Self {
            load,
            carry: span.carry.clone(),
            stepper,
        })
    }
}

impl<L: Load> Dense for Kicked<'_, L> {
    type Error = L::Error;

    fn elapsed(&self) -> f64 {
        self.stepper.elapsed()
    }

    fn phase(&self) -> Phase {
        self.stepper.phase()
    }

    fn within(&mut self, elapsed: f64) -> Result<Phase, L::Error> {
        self.stepper.within(elapsed, self.load)
    }
}

impl<L: Load> Stepper for Kicked<'_, L> {
    fn advance(&mut self) -> Result<(), L::Error> {
        self.stepper.advance(self.load)
    }

    fn effort(&self) -> Effort {
        Effort {
            steps: self.stepper.steps(),
            evaluations: self.stepper.evaluations,
        }
    }

    fn carry(&self) -> Carry {
        let (scheme, step) = self.stepper.step();
        Carry {
            scheme: Some(scheme),
            step: Some(step),
            ..self.carry.clone()
        }
    }

    fn changes(&self) -> Vec<Change> {
        self.load.changes()
    }
}
