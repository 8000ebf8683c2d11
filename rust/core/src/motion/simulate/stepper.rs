//! What the run needs of a method, and the one place where a method is chosen.

use super::equations::{Equations, MOVING, Scales, TURNING};
use super::exact::Exact;
use super::implicit::Implicit;
use super::kicked::Kicked;
use super::{Effort, Method, Task};
use crate::motion::integrate::Dop853;
use crate::motion::integrate::dop853::Dense as Polynomial;
use crate::motion::integrate::splitting::Scheme;
use crate::motion::loads::{Load, Switch};
use crate::motion::state::Phase;

/// The motion within the last step that was made.
pub(super) trait Dense {
    /// As of the load.
    type Error;

    /// The end of the step: time since the start of the span; its whole length, to the bit, when it is over.
    fn elapsed(&self) -> f64;

    /// The state then.
    fn phase(&self) -> Phase;

    /// The state at a time since the start of the span that is within the step.
    fn within(&mut self, elapsed: f64) -> Result<Phase, Self::Error>;

    /// How far the body turns in the step, which was as long as `length`: about, in radians.
    fn turn(&self, length: f64) -> f64 {
        self.phase().omega.norm() * length.abs()
    }
}

/// A method under way through a span of time in which the load is smooth.
pub(super) trait Stepper: Dense {
    /// One step toward the end.
    fn advance(&mut self) -> Result<(), Self::Error>;

    /// What the span has taken so far.
    fn effort(&self) -> Effort;

    /// What the next span may go on with.
    fn carry(&self) -> Carry;

    /// What may change the law of its load within a step.
    fn switches(&self) -> Vec<Switch>;
}

/// What one span leaves to the next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Carry {
    pub(super) scales: Scales,
    /// The length of step that the method would try next.
    pub(super) step: Option<f64>,
    /// Of a splitting.
    pub(super) scheme: Option<Scheme>,
}

/// Where a span of smooth load begins and ends, and in which state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) phase: Phase,
    pub(super) carry: Carry,
}

/// A method of steps at the start of `span`.
///
/// A stepper more is an arm more here, and its row in [`Method`].
pub(super) fn start<'a, L: Load>(
    method: Method,
    task: &Task<'_>,
    span: &Span,
    load: &'a mut L,
) -> Result<Box<dyn Stepper<Error = L::Error> + 'a>, L::Error>
where
    L::Error: 'a,
{
    let moves = !task.subject.pivoted && load.exerts_force();
    Ok(match method {
        Method::Exact => Box::new(Exact::<L::Error>::new(task, span, load.analytic())?),
        Method::Radau if moves => Box::new(Implicit::<L, MOVING>::new(task, span, load)?),
        Method::Radau => Box::new(Implicit::<L, TURNING>::new(task, span, load)?),
        Method::Splitting => Box::new(Kicked::new(task, span, load)?),
        _ if moves => Box::new(Explicit::<L, MOVING>::new(task, span, load)?),
        _ => Box::new(Explicit::<L, TURNING>::new(task, span, load)?),
    })
}

/// DOP853 on the equations in principal axes.
struct Explicit<'a, L, const N: usize> {
    equations: Equations<'a, L, N>,
    start: f64,
    stepper: Dop853<N>,
    /// Of the last step, once it is asked for.
    dense: Option<Polynomial<N>>,
}

impl<'a, L: Load, const N: usize> Explicit<'a, L, N> {
    fn new(task: &Task<'_>, span: &Span, load: &'a mut L) -> Result<Self, L::Error> {
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
        let stepper = Dop853::new(&mut equations, span.from, span.to, y, span.carry.step)?;
        Ok(Self {
            equations,
            start: span.from,
            stepper,
            dense: None,
        })
    }
}

impl<L: Load, const N: usize> Dense for Explicit<'_, L, N> {
    type Error = L::Error;

    fn elapsed(&self) -> f64 {
        self.stepper.elapsed()
    }

    fn phase(&self) -> Phase {
        self.equations
            .phase(self.start + self.elapsed(), self.stepper.state())
    }

    fn within(&mut self, elapsed: f64) -> Result<Phase, L::Error> {
        if self.dense.is_none() {
            self.dense = Some(self.stepper.dense(&mut self.equations)?);
        }
        let y = (self.dense.as_ref()).map_or(*self.stepper.state(), |dense| dense.at(elapsed));
        Ok(self.equations.phase(self.start + elapsed, &y))
    }
}

impl<L: Load, const N: usize> Stepper for Explicit<'_, L, N> {
    fn advance(&mut self) -> Result<(), L::Error> {
        self.dense = None;
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
