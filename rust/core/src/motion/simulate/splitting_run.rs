//! Splitting into kicks and free motions.

use super::stepper::{Carry, Dense, Span, Stepper};
use crate::error::{Error, MotionFault};
use crate::motion::integrate::Splitting;
use crate::motion::loads::{LawSwitch, Load};
use crate::motion::problem::{Effort, Task};
use crate::motion::state::Phase;

/// A run of [`Splitting`].
pub(super) struct SplittingRun<'a, L> {
    load: &'a mut L,
    carry: Carry,
    stepper: Splitting,
}

impl<'a, L: Load> SplittingRun<'a, L> {
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
            (!task.body_at_point.pivoted).then_some(task.body_at_point.mass),
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

impl<L: Load> Dense for SplittingRun<'_, L> {
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

impl<L: Load> Stepper for SplittingRun<'_, L> {
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

    fn law_switches(&self) -> Vec<LawSwitch> {
        self.load.law_switches()
    }
}
