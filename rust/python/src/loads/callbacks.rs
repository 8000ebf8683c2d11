//! Loads that are Python functions.

use std::sync::Arc;

use nalgebra::Vector3;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use polhode::motion::attitude::components;
use polhode::motion::loads::{Term, Windows, Wrench};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyList, PyTuple};
use pyo3::{PyTraverseError, PyVisit};

use super::clock::Clock;
use crate::arrays::{floats, list_floats, read};
use crate::errors::new;
use crate::shape::tuple;
use crate::stack::Stack;

/// A Python function as a term of a load.
pub(super) struct Callback {
    function: Py<PyAny>,
    gives: ReturnKind,
    pub(super) factor: f64,
    /// When it acts; always, where there are none.
    pub(super) windows: Option<Windows>,
}

/// What the function returns.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ReturnKind {
    /// A torque, given time, ω and attitude.
    Torque,
    /// A force and a torque, given position and velocity too.
    ForceAndTorque,
}

impl Callback {
    /// # Errors
    /// `TypeError` where it is no function.
    pub(super) fn new(function: &Bound<'_, PyAny>, gives: ReturnKind) -> PyResult<Self> {
        if !function.is_callable() {
            return Err(PyTypeError::new_err(format!(
                "function: expected a callable, got {}",
                function.get_type()
            )));
        }
        Ok(Self {
            function: function.clone().unbind(),
            gives,
            factor: 1.0,
            windows: None,
        })
    }

    pub(super) fn function(&self) -> &Py<PyAny> {
        &self.function
    }

    pub(super) fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            function: self.function.clone_ref(py),
            windows: self.windows.clone(),
            ..*self
        }
    }

    pub(super) fn exerts_force(&self) -> bool {
        self.gives == ReturnKind::ForceAndTorque
    }

    /// What the function says at a time and a state.
    pub(super) fn call(&self, py: Python<'_>, t: f64, phase: &Phase) -> PyResult<Wrench> {
        let array = |numbers: &[f64]| PyArray1::from_slice(py, numbers);
        let omega = array(phase.omega.as_slice());
        let quaternion = array(&components(&phase.attitude));
        let function = self.function.bind(py);
        let wrench = match self.gives {
            ReturnKind::Torque => {
                let returned = function.call1((t, omega, quaternion))?;
                Wrench::couple(vector(&returned, "torque", t)?)
            }
            ReturnKind::ForceAndTorque => {
                let position = array(phase.position.as_slice());
                let velocity = array(phase.velocity.as_slice());
                let returned = function.call1((t, omega, quaternion, position, velocity))?;
                let Ok((force, torque)) =
                    returned.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>()
                else {
                    return Err(PyTypeError::new_err(format!(
                        "the callback must return a pair (force in space, torque in the body), got {}",
                        returned.get_type()
                    )));
                };
                Wrench {
                    force: vector(&force, "force", t)?,
                    torque: vector(&torque, "torque", t)?,
                }
            }
        };
        Ok(if self.factor == 1.0 {
            wrench
        } else {
            Wrench {
                force: wrench.force * self.factor,
                torque: wrench.torque * self.factor,
            }
        })
    }
}

/// Three finite numbers from what a function returned; `what` they are.
pub(super) fn vector(returned: &Bound<'_, PyAny>, what: &str, t: f64) -> PyResult<Vector3<f64>> {
    let numbers = if let Some(numbers) = quickly(returned) {
        numbers
    } else {
        let name = format!("the {what} that the callback returned");
        let numbers: Stack<Vector3<f64>> = read(returned, &name)?;
        if !numbers.is_one() {
            let shape = tuple(&[&numbers.shape[..], &[3]].concat());
            return Err(PyValueError::new_err(format!(
                "{name}: expected shape (3,), got {shape}"
            )));
        }
        numbers[0]
    };
    if let Some(&value) = numbers.iter().find(|x| !x.is_finite()) {
        let message = format!(
            "the {what} that the callback returned must be finite, got {value} at t = {t:?}"
        );
        return Err(new(returned.py(), "PolhodeError", message));
    }
    Ok(numbers)
}

/// The numbers of the kinds of objects that functions return most: arrays of float64, tuples and lists of floats.
fn quickly(returned: &Bound<'_, PyAny>) -> Option<Vector3<f64>> {
    if let Ok(array) = returned.cast::<PyArray1<f64>>() {
        if array.len() != 3 {
            return None;
        }
        let at = |i: usize| array.get_owned(i);
        return Some(Vector3::new(at(0)?, at(1)?, at(2)?));
    }
    let number = |item: Bound<'_, PyAny>| item.cast_into_exact::<PyFloat>().ok().map(|x| x.value());
    let of = |item: &dyn Fn(usize) -> Option<f64>| Some(Vector3::new(item(0)?, item(1)?, item(2)?));
    if let Ok(tuple) = returned.cast_exact::<PyTuple>()
        && tuple.len() == 3
    {
        return of(&|i| tuple.get_item(i).ok().and_then(number));
    }
    if let Ok(list) = returned.cast_exact::<PyList>()
        && list.len() == 3
    {
        return of(&|i| list.get_item(i).ok().and_then(number));
    }
    None
}

// Loads that are Python functions with states of their own.

/// Python functions that give the rates of states, their jumps, and force and torque.
pub(super) struct WithStates {
    pub(super) initial: Vec<f64>,
    /// What counts as large of each state besides the largest it has been.
    pub(super) scale: Vec<f64>,
    rates: Option<Py<PyAny>>,
    wrench: Option<Py<PyAny>>,
    update: Option<Py<PyAny>>,
    /// When updates are; none without `update`.
    clock: Option<Clock>,
}

impl WithStates {
    /// # Errors
    /// Where a function is none, or `update` and `period` do not stand together.
    pub(super) fn new(
        [rates, wrench, update]: [Option<&Bound<'_, PyAny>>; 3],
        period: Option<f64>,
        (initial, scale): (Vec<f64>, Vec<f64>),
    ) -> PyResult<Self> {
        for (what, function) in [("rates", rates), ("wrench", wrench), ("update", update)] {
            if let Some(function) = function.filter(|function| !function.is_callable()) {
                return Err(PyTypeError::new_err(format!(
                    "{what}: expected a callable, got {}",
                    function.get_type()
                )));
            }
        }
        if update.is_some() != period.is_some() {
            return Err(PyTypeError::new_err(
                "update: give update= and period= together, or neither",
            ));
        }
        let kept = |function: Option<&Bound<'_, PyAny>>| function.map(|it| it.clone().unbind());
        Ok(Self {
            initial,
            scale,
            rates: kept(rates),
            wrench: kept(wrench),
            update: kept(update),
            clock: period.map(Clock::new).transpose()?,
        })
    }

    pub(super) fn clone_ref(&self, py: Python<'_>) -> Self {
        let cloned = |function: &Option<Py<PyAny>>| function.as_ref().map(|it| it.clone_ref(py));
        Self {
            initial: self.initial.clone(),
            scale: self.scale.clone(),
            rates: cloned(&self.rates),
            wrench: cloned(&self.wrench),
            update: cloned(&self.update),
            ..*self
        }
    }

    pub(super) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        for function in [&self.rates, &self.wrench, &self.update]
            .into_iter()
            .flatten()
        {
            visit.call(function)?;
        }
        Ok(())
    }

    /// Whether updates count from where the run begins.
    pub(super) fn needs_epoch(&self) -> bool {
        self.clock.as_ref().is_some_and(Clock::needs_epoch)
    }

    pub(super) fn start_at(&mut self, t: f64) {
        if let Some(clock) = &mut self.clock {
            clock.start_at(t);
        }
    }

    /// The times of updates after `from`, until `to`, of a run that begins at `from`.
    pub(super) fn times(&self, from: f64, to: f64) -> Vec<f64> {
        (self.clock).map_or_else(Vec::new, |clock| clock.times(from, to))
    }

    /// Why a run from one time to another cannot be, if it cannot.
    pub(super) fn check(&self, from: f64, to: f64) -> PyResult<()> {
        self.clock.map_or(Ok(()), |clock| {
            clock.check((from, to), "a load with update=", "an update")
        })
    }

    /// Whether an update is due at time `t` of a run that began at `start`.
    fn is_due(&self, t: f64, start: f64) -> bool {
        self.clock.is_some_and(|clock| clock.is_due(t, start))
    }

    /// The states after an update that is due, if one is.
    pub(super) fn update(
        &self,
        py: Python<'_>,
        (t, start): (f64, f64),
        phase: &Phase,
        states: &Named<'_>,
    ) -> PyResult<Option<Vec<f64>>> {
        let Some(update) = self.update.as_ref().filter(|_| self.is_due(t, start)) else {
            return Ok(None);
        };
        let returned = update.bind(py).call1(arguments(py, t, phase, states)?)?;
        numbers(
            &returned,
            "states that update",
            (self.initial.len(), "states"),
            t,
        )
        .map(Some)
    }

    /// The rates of the states, into `rates`.
    pub(super) fn rates(
        &self,
        py: Python<'_>,
        t: f64,
        phase: &Phase,
        states: &Named<'_>,
        rates: &mut [f64],
    ) -> PyResult<()> {
        if let Some(function) = &self.rates {
            let returned = function.bind(py).call1(arguments(py, t, phase, states)?)?;
            rates.copy_from_slice(&numbers(
                &returned,
                "rates that rates",
                (rates.len(), "states"),
                t,
            )?);
        }
        Ok(())
    }

    /// Force and torque.
    pub(super) fn call(
        &self,
        py: Python<'_>,
        t: f64,
        phase: &Phase,
        states: &Named<'_>,
    ) -> PyResult<Wrench> {
        let Some(function) = &self.wrench else {
            return Ok(Wrench::default());
        };
        let returned = function.bind(py).call1(arguments(py, t, phase, states)?)?;
        let Ok((force, torque)) = returned.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>() else {
            return Err(PyTypeError::new_err(format!(
                "wrench must return a pair (force in space, torque in the body), got {}",
                returned.get_type()
            )));
        };
        Ok(Wrench {
            force: vector(&force, "force", t)?,
            torque: vector(&torque, "torque", t)?,
        })
    }

    pub(super) fn exerts_force(&self) -> bool {
        self.wrench.is_some()
    }
}

pub(super) type Arguments<'py> = (
    f64,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyDict>,
);

/// What every function is called with.
pub(super) fn arguments<'py>(
    py: Python<'py>,
    t: f64,
    phase: &Phase,
    states: &Named<'_>,
) -> PyResult<Arguments<'py>> {
    let array = |numbers: &[f64]| PyArray1::from_slice(py, numbers);
    Ok((
        t,
        array(phase.omega.as_slice()),
        array(&components(&phase.attitude)),
        array(phase.position.as_slice()),
        array(phase.velocity.as_slice()),
        states.dict(py)?,
    ))
}

/// So many finite numbers from what a function returned, as many as there are `of`.
pub(super) fn numbers(
    returned: &Bound<'_, PyAny>,
    what: &str,
    (count, of): (usize, &str),
    t: f64,
) -> PyResult<Vec<f64>> {
    let what = format!("the {what} returned");
    let array = floats(returned, &what)?;
    let found = array.as_slice()?;
    if found.len() != count {
        return Err(PyValueError::new_err(format!(
            "{what}: expected {count}, as many as there are {of}, got {}",
            found.len()
        )));
    }
    if let Some(value) = found.iter().find(|x| !x.is_finite()) {
        let message = format!("{what} must be finite, got {value} at t = {t:?}");
        return Err(new(returned.py(), "PolhodeError", message));
    }
    Ok(found.to_vec())
}

/// Initial values and scales of states.
pub(super) fn initial_values(
    initial: &Bound<'_, PyAny>,
    scale: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<f64>, Vec<f64>)> {
    let values = list_floats(initial, "initial", "k", &[])?
        .as_slice()?
        .to_vec();
    if let Some(bad) = values.iter().find(|x| !x.is_finite()) {
        return Err(PyValueError::new_err(format!(
            "initial: must be finite, got {bad}"
        )));
    }
    if values.is_empty() || values.len() > MOST_STATES {
        return Err(PyValueError::new_err(format!(
            "initial: expected from 1 to {MOST_STATES} states, got {}",
            values.len()
        )));
    }
    let scales = match scale {
        None => vec![0.0; values.len()],
        Some(scale) => {
            let given = floats(scale, "scale")?;
            let given = given.as_slice()?;
            match given.len() {
                1 => vec![given[0]; values.len()],
                count if count == values.len() => given.to_vec(),
                count => {
                    return Err(PyValueError::new_err(format!(
                        "scale: expected one number or {}, one for each state, got {count}",
                        values.len()
                    )));
                }
            }
        }
    };
    if let Some(bad) = scales.iter().find(|x| !(**x >= 0.0 && x.is_finite())) {
        return Err(PyValueError::new_err(format!(
            "scale: must be positive or zero, got {bad}"
        )));
    }
    Ok((values, scales))
}

/// The most states of a load.
pub(crate) const MOST_STATES: usize = 51;

/// What the motion itself has, in tables and datasets.
const TAKEN: [&str; 8] = [
    "t",
    "time",
    "omega",
    "quaternion",
    "position",
    "velocity",
    "component",
    "quaternion_component",
];

/// That a name is one.
pub(super) fn check_name(name: &str) -> PyResult<()> {
    if name.is_empty() || name.contains('\0') {
        return Err(PyValueError::new_err(
            "name: must not be empty, nor hold the character 0",
        ));
    }
    if TAKEN.contains(&name) {
        return Err(PyValueError::new_err(format!(
            "name: {name:?} is a name of the motion itself; take another"
        )));
    }
    Ok(())
}

// States by name, as functions of Python get them.

/// The states of one part of a load among those of all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Slot {
    pub(crate) name: Arc<str>,
    pub(crate) first: usize,
    pub(crate) count: usize,
}

impl Slot {
    pub(crate) fn of<'a>(&self, all: &'a [f64]) -> &'a [f64] {
        &all[self.first..self.first + self.count]
    }
}

/// The names and numbers of the states of a phase, for functions of Python.
pub(crate) struct Named<'a> {
    slots: &'a [Slot],
    states: Vec<f64>,
}

impl<'a> Named<'a> {
    pub(crate) fn of(slots: &'a [Slot], terms: &[Term], phase: &Phase) -> Self {
        Self {
            slots,
            states: report_states(terms, phase),
        }
    }

    /// A dict for one call: a function may write into it what it likes.
    pub(crate) fn dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for slot in self.slots {
            dict.set_item(&*slot.name, PyArray1::from_slice(py, slot.of(&self.states)))?;
        }
        Ok(dict)
    }
}

/// The states of a phase as they are reported.
pub(crate) fn report_states(terms: &[Term], phase: &Phase) -> Vec<f64> {
    let mut states = phase.internal_state.to_vec();
    let mut first = 0;
    for carried in terms.iter().filter_map(Term::carried) {
        let mine = first..first + carried.count();
        if let Some(own) = states.get_mut(mine.clone()) {
            carried.report_states(own, &phase.omega);
        }
        first = mine.end;
    }
    states
}
