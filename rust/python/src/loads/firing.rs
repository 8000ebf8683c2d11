//! Thrusters as a part of a load, and what they are told.

use numpy::PyUntypedArrayMethods;
use polhode::motion::loads::{BodyAtPoint, PiecewiseSignal, Thrusters, Wrench};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::{PyTraverseError, PyVisit};

use super::callbacks::{Named, arguments, numbers};
use super::clock::Clock;
use crate::arrays::{floats, list_floats};
use crate::errors::to_py;
use crate::shape::tuple;

/// Thrusters, and what they are told.
pub(super) struct Firing {
    thrusters: Thrusters,
    command: Command,
    clock: Clock,
    /// The states at a start, and what counts as large of each.
    pub(super) initial: Vec<f64>,
    pub(super) scale: Vec<f64>,
}

/// The duties of thrusters.
enum Command {
    /// Given: of each.
    Given(Vec<PiecewiseSignal>),
    /// A function of Python returns them.
    Asked(Py<PyAny>),
}

impl Firing {
    /// # Errors
    /// Where `command` is neither a function nor duties of the right shape, for a period that is not positive.
    pub(super) fn new(
        thrusters: Thrusters,
        command: &Bound<'_, PyAny>,
        times: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Ok(Self {
            initial: thrusters.begin(),
            scale: thrusters.sizes(),
            clock: Clock::new(thrusters.pulses().period())?,
            command: read_command(command, times, thrusters.count())?,
            thrusters,
        })
    }

    pub(super) fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            thrusters: self.thrusters.clone(),
            command: match &self.command {
                Command::Given(duties) => Command::Given(duties.clone()),
                Command::Asked(function) => Command::Asked(function.clone_ref(py)),
            },
            initial: self.initial.clone(),
            scale: self.scale.clone(),
            clock: self.clock,
        }
    }

    pub(super) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        match &self.command {
            Command::Given(_) => Ok(()),
            Command::Asked(function) => visit.call(function),
        }
    }

    /// How many thrusters there are.
    pub(super) fn count(&self) -> usize {
        self.thrusters.count()
    }

    /// Whether a function of Python commands them.
    pub(super) fn calls_python(&self) -> bool {
        matches!(self.command, Command::Asked(_))
    }

    pub(super) fn needs_epoch(&self) -> bool {
        self.clock.needs_epoch()
    }

    pub(super) fn start_at(&mut self, t: f64) {
        self.clock.start_at(t);
    }

    /// The starts of periods within a run.
    pub(super) fn times(&self, from: f64, to: f64) -> Vec<f64> {
        self.clock.times(from, to)
    }

    /// Why a run from one time to another cannot be, if it cannot.
    pub(super) fn check(&self, py: Python<'_>, from: f64, to: f64) -> PyResult<()> {
        (self.clock).check((from, to), "a load with thrusters", "a period")?;
        if let Command::Given(duties) = &self.command
            && let [Some(&first), Some(&last)] =
                [duties[0].times().first(), duties[0].times().last()]
            && from < first
        {
            let what = "command";
            let error = polhode::error::MotionFault::OutsideTimes {
                what,
                t: from,
                first,
                last,
            };
            return Err(to_py(py, &error.into()));
        }
        Ok(())
    }

    /// The states at the start of a period, if one begins at the time `t` of a run that began at `start`.
    pub(super) fn begin_period(
        &self,
        py: Option<Python<'_>>,
        (t, start): (f64, f64),
        phase: &Phase,
        states: Option<&Named<'_>>,
        own: &[f64],
    ) -> PyResult<Option<Vec<f64>>> {
        if !self.clock.is_due(t, start) {
            return Ok(None);
        }
        let duties = match (&self.command, py, states) {
            (Command::Given(duties), ..) => duties.iter().map(|duty| duty.value(t)).collect(),
            (Command::Asked(function), Some(py), Some(states)) => {
                let returned = function.bind(py).call1(arguments(py, t, phase, states)?)?;
                numbers(
                    &returned,
                    "duties that command",
                    (self.count(), "thrusters"),
                    t,
                )?
            }
            (Command::Asked(_), ..) => return Ok(None), // a run that calls Python has both
        };
        let mut after = own.to_vec();
        self.thrusters.command(&duties, &mut after);
        Ok(Some(after))
    }

    /// The times within a span of a run that began at `start` at which thrusters are switched off.
    pub(super) fn cuts(&self, (from, to): (f64, f64), start: f64, own: &[f64]) -> Vec<f64> {
        let ends = self.thrusters.switches(self.clock.last(from, start), own);
        ends.into_iter()
            .filter(|end| *end > from && *end < to)
            .collect()
    }

    /// Which of them fire around the time `middle` of a run that began at `start`.
    pub(super) fn fires(&self, middle: f64, start: f64, own: &[f64]) -> Vec<bool> {
        (self.thrusters).fires(self.clock.last(middle, start), middle, own)
    }

    /// Which of them fire just before `t`, where the states have not changed yet.
    pub(super) fn fired(&self, t: f64, start: f64, own: &[f64]) -> Vec<bool> {
        let lengths = own[self.count()..].iter();
        let period = self.thrusters.pulses().period();
        if self.clock.is_due(t, start) {
            // The end of the period before.
            return lengths.map(|length| *length >= period).collect();
        }
        let begun = self.clock.last(t, start);
        lengths
            .map(|length| *length > 0.0 && t <= begun + length)
            .collect()
    }

    pub(super) fn wrench(&self, fires: &[bool], body: &BodyAtPoint, phase: &Phase) -> Wrench {
        self.thrusters.wrench(fires, body, phase)
    }

    pub(super) fn rates(&self, fires: &[bool], rates: &mut [f64]) {
        self.thrusters.rates(fires, rates);
    }
}

/// A function, duties for all times, or a row of them for each of the times.
fn read_command(
    command: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
    count: usize,
) -> PyResult<Command> {
    let py = command.py();
    if command.is_callable() {
        if times.is_some() {
            return Err(PyTypeError::new_err(
                "times: not beside a function, which is called at the start of each period",
            ));
        }
        return Ok(Command::Asked(command.clone().unbind()));
    }
    let duties = floats(command, "command")?;
    let (shape, values) = (duties.shape().to_vec(), duties.as_slice()?);
    let times = match times {
        Some(times) => Some(list_floats(times, "times", "k", &[])?.as_slice()?.to_vec()),
        None => None,
    };
    let expected = times
        .as_ref()
        .map_or_else(|| vec![count], |times| vec![times.len(), count]);
    if shape != expected {
        let beside = if times.is_some() {
            "a row of duties for each of the times"
        } else {
            "the duty of each thruster; rows of duties need times="
        };
        return Err(PyValueError::new_err(format!(
            "command: expected the shape {}, {beside}, got {}",
            tuple(&expected),
            tuple(&shape)
        )));
    }
    let of = |k: usize| match &times {
        None => PiecewiseSignal::constant("command", values[k]),
        Some(times) => {
            let column: Vec<f64> = values.iter().skip(k).step_by(count).copied().collect();
            PiecewiseSignal::table("command", times, &column)
        }
    };
    let signals = (0..count).map(of).collect::<Result<_, _>>();
    Ok(Command::Given(signals.map_err(|error| to_py(py, &error))?))
}
