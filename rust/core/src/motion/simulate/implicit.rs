//! Radau IIA on the equations in principal axes.

use super::equations::Equations;
use super::stepper::{Carry, Dense, Span, Stepper};
use super::{Effort, Task};
use crate::motion::integrate::Radau;
use crate::motion::loads::{Load, Switch};
use crate::motion::state::Phase;

/// A run of [`Radau`].
pub(super) struct Implicit<'a, L, const N: usize> {
    equations: Equations<'a, L, N>,
    start: f64,
    stepper: Radau<N>,
}

impl<'a, L: Load, const N: usize> Implicit<'a, L, N> {
    pub(super) fn new(task: &Task<'_>, span: &Span, load: &'a mut L) -> Result<Self, L::Error> {
        let mut equations = Equations::new(
            &task.euler,
            task.subject.mass,
            span.from,
            &span.phase,
            load,
            task.tolerance,
            span.carry.scales,
        );
        let y = equations.principal(&span.phase);
        let stepper = Radau::new(&mut equations, span.from, span.to, y, span.carry.step)?;
        Ok(Self {
            equations,
            start: span.from,
            stepper,
        })
    }
}

impl<L: Load, const N: usize> Dense for Implicit<'_, L, N> {
    type Error = L::Error;

    fn elapsed(&self) -> f64 {
        self.stepper.elapsed()
    }

    fn phase(&self) -> Phase {
        self.equations
            .phase(self.start + self.elapsed(), self.stepper.state())
    }

    fn within(&mut self, elapsed: f64) -> Result<Phase, L::Error> {
        let y = (self.stepper.dense()).map_or(*self.stepper.state(), |dense| dense.at(elapsed));
        Ok(self.equations.phase(self.start + elapsed, &y))
    }
}

impl<L: Load, const N: usize> Stepper for Implicit<'_, L, N> {
    fn advance(&mut self) -> Result<(), L::Error> {
        self.stepper.advance(&mut self.equations)
    }

    fn effort(&self) -> Effort {
        Effort {
            steps: self.stepper.steps,
            evaluations: self.stepper.evaluations,
        }
    }

    fn carry(&self) -> Carry {
        Carry {
            scales: self.equations.scales,
            step: Some(self.stepper.step()),
            scheme: None,
        }
    }

    fn switches(&self) -> Vec<Switch> {
        self.equations.switches()
    }
}
