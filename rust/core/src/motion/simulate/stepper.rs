//! What a run needs of a method of steps.

use crate::motion::integrate::splitting::Scheme;
use crate::motion::loads::{Bearing, LawSwitch};
use crate::motion::problem::Effort;
use crate::motion::state::Phase;

/// The motion within the last step that was made.
pub(super) trait Dense {
    /// As of the load.
    type Error;

    /// Time from the start of the span to the end of the last step; at the end exactly the length of the span.
    fn elapsed(&self) -> f64;

    /// The state then.
    fn phase(&self) -> Phase;

    /// The state at a time since the start of the span that is within the step.
    fn within(&mut self, elapsed: f64) -> Result<Phase, Self::Error>;

    /// The torque that a bearing at rest takes at a time since the start of the span and the state then; only what carries wheels
    /// has bearings.
    fn bearing_torque(
        &mut self,
        bearing: &Bearing,
        elapsed: f64,
        phase: &Phase,
    ) -> Result<f64, Self::Error> {
        let _ = (bearing, elapsed, phase);
        Ok(0.0)
    }

    /// By how much more than its limit a motor, or coils, are asked for at a time since the start of the span and the state then; only
    /// what carries wheels has motors, and coils with a limit have no series.
    fn over_limit(&self, wheel: Option<usize>, elapsed: f64, phase: &Phase) -> f64 {
        let _ = (wheel, elapsed, phase);
        -1.0
    }

    /// The value of an event's function at the end of a part of the step, where the function is positive in all of it for certain, so
    /// that no passage has to be looked for; from `from` to `to` since the start of the span.
    fn stays_positive(&mut self, event: usize, from: f64, to: f64) -> Option<f64> {
        let _ = (event, from, to);
        None
    }

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
    fn law_switches(&self) -> Vec<LawSwitch>;
}

/// The largest |ω|, |r|, |v| and internal states of the load so far: what errors are relative to.
#[derive(Clone, Debug, Default)]
pub(super) struct Scales {
    pub(super) omega: f64,
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) internal_state: Vec<f64>,
}

/// What one span leaves to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Carry {
    pub(super) scales: Scales,
    /// The length of step that the method would try next.
    pub(super) step: Option<f64>,
    /// Of a splitting.
    pub(super) scheme: Option<Scheme>,
}

/// Where a span of smooth load begins and ends, and in which state.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) phase: Phase,
    pub(super) carry: Carry,
}
