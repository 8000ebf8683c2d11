//! Thrusters as a part of a load, and the function that makes them, with its documentation.

use nalgebra::Vector3;
use numpy::PyUntypedArrayMethods;
use polhode::motion::loads::{BodyAtPoint, PiecewiseSignal, Pulses, Thrusters, Wrench};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pyo3::{PyTraverseError, PyVisit};

use super::callbacks::{MOST_STATES, Named, arguments, check_name, numbers};
use super::clock::Clock;
use super::load::{LoadPart, PyLoad};
use super::pickle_recipe::recipe;
use crate::arrays::{floats, list_floats, numpy, read, read_list, read_scalar, write};
use crate::errors::to_py;
use crate::shape::tuple;
use crate::stack::Stack;

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

/// Thrusters that fire in pulses: in each period from its start on, for a part of it.
///
/// Each exerts a force at a point of the body, so that it turns the body and pushes it. The duty of a thruster
/// is the part of a period in which it fires, from 0 to 1. The duties are known at the start of a period, and
/// with them the times at which the thrusters are switched off. A simulation ends a step at each switch, so the
/// times are exact.
///
/// Parameters
/// ----------
/// positions : array_like, shape (n, 3)
///     Points where the forces act, in the body frame. At most 25 thrusters.
/// directions : array_like, shape (n, 3)
///     Directions of the forces on the body, against the exhaust, in the body frame. The lengths do not count.
/// forces : array_like, shape () or (n,)
///     Force of a thruster that fires.
/// command : array_like, shape (n,) or (k, n), or callable
///     Duties. An array of shape (n,) is for all periods. Of an array of shape (k, n) each row is for the periods
///     that start at the same one of `times`, or later. A function
///     ``command(t, omega, quaternion, position, velocity, states)`` returns n numbers. It is called at the
///     start of each period, with the arguments of the functions of :func:`with_states`. Duties below 0 count
///     as 0, and those above 1 as 1.
/// period : float
///     Time from the start of one period to the next one. The first period starts with the motion.
/// min_on : float, optional
///     Shortest time for which a thruster can fire. If a pulse would be shorter, the thruster does not fire.
/// max_on : float, optional
///     Longest time for which a thruster can fire in a period; the period by default.
/// deadband : float, optional
///     With it the thrusters are on or off: one with a duty of `deadband` or more fires for `max_on`, one with
///     less does not fire.
/// times : array_like, shape (k,), optional
///     Times of a `command` of shape (k, n), ascending.
/// name : str, optional
///     Name of the states.
///
/// Returns
/// -------
/// Load
///     Its states in ``states`` of a trajectory are the impulses of the thrusters since the start, force times
///     time of firing, shape (n,), under `name`; and the lengths of the pulses of the period under way under
///     `name` with ``_pulse``.
///
/// Notes
/// -----
/// The mass of the propellant that a thruster has used is its impulse divided by its specific impulse (a
/// speed; of a value in seconds, that times 9.80665 m/s²). The mass of the body does not change.
///
/// :meth:`polhode.Event.pulse` finds when a thruster is switched on and off.
///
/// Examples
/// --------
/// A pair of thrusters turns a satellite. A controller asks every 0.1 s for the torque ``-0.4 ω``, of which each
/// thruster can do one sign:
///
/// >>> import numpy as np
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(90.0, (8.0, 9.0, 10.0))
/// >>> def duties(t, omega, *_):
/// ...     return np.array([-0.4, 0.4]) * omega[2] / (0.5 * 0.02)
/// >>> arms, along = [(0.5, 0, 0), (0.5, 0, 0)], [(0, 1, 0), (0, -1, 0)]
/// >>> jets = loads.thrusters(arms, along, 0.02, command=duties, period=0.1, min_on=0.01)
/// >>> motion = body.simulate([0, 120], omega=(0, 0, 0.05), load=jets)
/// >>> bool(abs(motion.omega[-1, 2]) < 0.0026)
/// True
/// >>> impulse = motion.states["thrusters"][-1]
/// >>> bool(np.isclose(0.5 * (impulse[1] - impulse[0]), 10.0 * (0.05 - motion.omega[-1, 2])))
/// True
/// >>> propellant = impulse.sum() / (70 * 9.80665)  # in kg, for a specific impulse of 70 s
#[pyfunction]
#[pyo3(signature = (positions, directions, forces, *, command, period, min_on=None, max_on=None, deadband=None, times=None,
                   name="thrusters"))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub(crate) fn thrusters(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
    forces: &Bound<'_, PyAny>,
    command: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] period: f64,
    #[pyo3(from_py_with = read_scalar)] min_on: Option<f64>,
    #[pyo3(from_py_with = read_scalar)] max_on: Option<f64>,
    #[pyo3(from_py_with = read_scalar)] deadband: Option<f64>,
    times: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<PyLoad> {
    check_name(name)?;
    let at: Stack<Vector3<f64>> = read_list(positions, "positions", "n")?;
    let along: Stack<Vector3<f64>> = read_list(directions, "directions", "n")?;
    let count = at.rows.len();
    let most = MOST_STATES / 2;
    if count == 0 || count > most {
        return Err(PyValueError::new_err(format!(
            "positions: expected from 1 to {most} thrusters, got {count}; loads with more of them can be added"
        )));
    }
    if along.rows.len() != count {
        return Err(PyValueError::new_err(format!(
            "directions: expected one for each of the {count} thrusters, got {}",
            along.rows.len()
        )));
    }
    let given: Stack<f64> = read(forces, "forces")?;
    let each = match given.shape[..] {
        [] => vec![given[0]; count],
        [found] if found == count => given.rows.clone(),
        _ => {
            return Err(PyValueError::new_err(format!(
                "forces: expected one number, or one for each of the {count} thrusters, got the shape {}",
                tuple(&given.shape)
            )));
        }
    };
    let core = |error: &polhode::Error| to_py(py, error);
    let pulses =
        Pulses::new(period, min_on.unwrap_or(0.0), max_on, deadband).map_err(|e| core(&e))?;
    let set = Thrusters::new(&at.rows, &along.rows, &each, pulses).map_err(|e| core(&e))?;
    let told = read_command(command, times, count)?;
    let firing = Firing {
        initial: set.begin(),
        scale: set.sizes(),
        thrusters: set,
        clock: Clock::new(period)?,
        command: told,
    };
    let options = PyDict::new(py);
    let copy = |given: &Bound<'_, PyAny>| -> PyResult<Py<PyAny>> {
        let array = numpy(py)?.call_method1("array", (given, "float64"))?;
        Ok(array.unbind())
    };
    if firing.calls_python() {
        options.set_item("command", command)?;
    } else {
        options.set_item("command", copy(command)?)?;
    }
    options.set_item("period", period)?;
    for (what, given) in [
        ("min_on", min_on),
        ("max_on", max_on),
        ("deadband", deadband),
    ] {
        options.set_item(what, given)?;
    }
    options.set_item("times", times.map(copy).transpose()?)?;
    options.set_item("name", name)?;
    let arguments = (write(py, &at)?, write(py, &along)?, copy(forces)?, options);
    let recipe = recipe(py, "thrusters", arguments)?;
    Ok(PyLoad::one(LoadPart::Thrusters(firing), recipe).with_name(name))
}

/// A function, duties for all times, or a row of them for each of the times.
fn read_command(
    command: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
    count: usize,
) -> PyResult<Command> {
    let py = command.py();
    if command.is_instance_of::<PyLoad>() {
        return Err(PyTypeError::new_err(
            "command: a load asks for a torque, not for duties; give a function \
             command(t, omega, quaternion, position, velocity, states) that returns the duty of each thruster",
        ));
    }
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
