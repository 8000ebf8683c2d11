//! States, methods, events.

use serde::{Deserialize, Serialize};

use super::names::{attitude, named};
use crate::error::{Error, all_finite, finite};
use crate::motion::attitude::components;
use crate::motion::euler_angles::Sequence;
use crate::motion::free::Mode;
use crate::motion::kinematics::Frame;
use crate::motion::simulate::{Crossing, Direction, Effort, Method, Phase, State, Tolerance};
use crate::numerics::stored_form::{stored, vector};
use crate::principal::Top;

named! {
    Frame { Frame::Body => "body", Frame::Space => "space" }
    Method {
        Method::Auto => "auto",
        Method::Exact => "exact",
        Method::Taylor => "taylor",
        Method::Dop853 => "dop853",
        Method::Radau => "radau",
        Method::Splitting => "splitting",
    }
    Direction {
        Direction::Any => "any",
        Direction::Rising => "rising",
        Direction::Falling => "falling",
    }
    Mode {
        Mode::Spherical => "spherical",
        Mode::Symmetric => "symmetric",
        Mode::Steady => "steady",
        Mode::Separatrix => "separatrix",
        Mode::LongAxis => "long-axis",
        Mode::ShortAxis => "short-axis",
    }
    Top {
        Top::Spherical => "spherical",
        Top::Oblate => "oblate",
        Top::Prolate => "prolate",
        Top::Asymmetric => "asymmetric",
        Top::Linear => "linear",
        Top::Point => "point",
        Top::None => "none",
    }
}

stored!(
    State as Turning,
    Phase as PhaseForm,
    Tolerance as Accuracy,
    Sequence as String,
    Effort as Work,
    Crossing as Passage,
);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Turning {
    attitude: [f64; 4],
    omega: [f64; 3],
}

impl From<&State> for Turning {
    fn from(state: &State) -> Self {
        Self {
            attitude: components(&state.attitude),
            omega: state.omega.into(),
        }
    }
}

impl TryFrom<Turning> for State {
    type Error = Error;

    fn try_from(stored: Turning) -> Result<Self, Error> {
        Ok(Self {
            attitude: attitude(stored.attitude)?,
            omega: vector("omega", stored.omega)?,
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PhaseForm {
    attitude: [f64; 4],
    omega: [f64; 3],
    position: [f64; 3],
    velocity: [f64; 3],
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    own: Vec<f64>,
}

impl From<&Phase> for PhaseForm {
    fn from(phase: &Phase) -> Self {
        Self {
            attitude: components(&phase.attitude),
            omega: phase.omega.into(),
            position: phase.position.into(),
            velocity: phase.velocity.into(),
            own: phase.internal_state.to_vec(),
        }
    }
}

impl TryFrom<PhaseForm> for Phase {
    type Error = Error;

    fn try_from(stored: PhaseForm) -> Result<Self, Error> {
        all_finite("own", &stored.own)?;
        Ok(Self {
            attitude: attitude(stored.attitude)?,
            omega: vector("omega", stored.omega)?,
            position: vector("position", stored.position)?,
            velocity: vector("velocity", stored.velocity)?,
            internal_state: stored.own.into(),
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Accuracy {
    relative: f64,
    absolute: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    most_steps: Option<u64>,
}

impl From<&Tolerance> for Accuracy {
    fn from(tolerance: &Tolerance) -> Self {
        Self {
            relative: tolerance.relative,
            absolute: tolerance.absolute,
            most_steps: Some(tolerance.most_steps),
        }
    }
}

impl TryFrom<Accuracy> for Tolerance {
    type Error = Error;

    fn try_from(stored: Accuracy) -> Result<Self, Error> {
        let tolerance = Self::new(stored.relative, stored.absolute)?;
        Ok(tolerance.within(stored.most_steps.unwrap_or(u64::MAX)))
    }
}

impl From<&Sequence> for String {
    fn from(sequence: &Sequence) -> Self {
        sequence.to_string()
    }
}

impl TryFrom<String> for Sequence {
    type Error = Error;

    fn try_from(name: String) -> Result<Self, Error> {
        name.parse()
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Work {
    steps: u64,
    evaluations: u64,
}

impl From<&Effort> for Work {
    fn from(effort: &Effort) -> Self {
        Self {
            steps: effort.steps,
            evaluations: effort.evaluations,
        }
    }
}

impl From<Work> for Effort {
    fn from(Work { steps, evaluations }: Work) -> Self {
        Self { steps, evaluations }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Passage {
    event: usize,
    time: f64,
    phase: Phase,
}

impl From<&Crossing> for Passage {
    fn from(crossing: &Crossing) -> Self {
        Self {
            event: crossing.event,
            time: crossing.time,
            phase: crossing.phase.clone(),
        }
    }
}

impl TryFrom<Passage> for Crossing {
    type Error = Error;

    fn try_from(Passage { event, time, phase }: Passage) -> Result<Self, Error> {
        finite("time", time)?;
        Ok(Self { event, time, phase })
    }
}
