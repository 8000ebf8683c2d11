//! Runge-Kutta methods on the equations in principal axes.

use super::equations::Equations;
use super::stepper::{Carry, Dense, Span, Stepper};
use crate::motion::integrate::RungeKutta;
use crate::motion::loads::{Bearing, LawSwitch, Load};
use crate::motion::problem::{Effort, Task};
use crate::motion::state::Phase;

/// A run of the method `M`, whose state has `N` numbers.
pub(super) struct RungeKuttaRun<'a, L, M, const N: usize> {
    equations: Equations<'a, L, N>,
    start: f64,
    method: M,
}

impl<'a, L: Load, M: RungeKutta<N>, const N: usize> RungeKuttaRun<'a, L, M, N> {
    pub(super) fn new(task: &Task<'_>, span: &Span, load: &'a mut L) -> Result<Self, L::Error> {
        let mut equations = Equations::new(
            &task.euler,
            &task.body_at_point,
            span.from,
            &span.phase,
            load,
            task.tolerance,
            span.carry.scales.clone(),
        );
        let y = equations.principal(&span.phase);
        let method = M::new(&mut equations, span.from, span.to, y, span.carry.step)?;
        Ok(Self {
            equations,
            start: span.from,
            method,
        })
    }
}

impl<L: Load, M: RungeKutta<N>, const N: usize> Dense for RungeKuttaRun<'_, L, M, N> {
    type Error = L::Error;

    #[inline]
    fn elapsed(&self) -> f64 {
        self.method.elapsed()
    }

    #[inline]
    fn phase(&self) -> Phase {
        (self.equations).phase(self.start + self.elapsed(), self.method.state())
    }

    #[inline]
    fn within(&mut self, elapsed: f64) -> Result<Phase, L::Error> {
        let y = self.method.within(&mut self.equations, elapsed)?;
        Ok(self.equations.phase(self.start + elapsed, &y))
    }

    #[inline]
    fn over_limit(&self, state: usize, elapsed: f64, phase: &Phase) -> f64 {
        (self.equations).over_limit(state, self.start + elapsed, phase)
    }

    #[inline]
    fn held(&mut self, bearing: &Bearing, elapsed: f64, phase: &Phase) -> Result<f64, L::Error> {
        self.equations.held(bearing, self.start + elapsed, phase)
    }
}

impl<L: Load, M: RungeKutta<N>, const N: usize> Stepper for RungeKuttaRun<'_, L, M, N> {
    #[inline]
    fn advance(&mut self) -> Result<(), L::Error> {
        self.method.advance(&mut self.equations)
    }

    #[inline]
    fn effort(&self) -> Effort {
        let progress = self.method.progress();
        Effort {
            steps: progress.steps,
            evaluations: progress.evaluations,
        }
    }

    #[inline]
    fn carry(&self) -> Carry {
        Carry {
            scales: self.equations.scales.clone(),
            step: Some(self.method.step()),
            scheme: None,
        }
    }

    #[inline]
    fn law_switches(&self) -> Vec<LawSwitch> {
        self.equations.law_switches()
    }
}
