//! Loads that are Python functions.

use nalgebra::Vector3;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use polhode::motion::attitude::components;
use polhode::motion::loads::{Windows, Wrench};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyList, PyTuple};

use crate::arrays::read;
use crate::errors::new;
use crate::shape::tuple;
use crate::stack::Stack;

/// A Python function as a term of a load.
pub(super) struct Callback {
    function: Py<PyAny>,
    gives: Gives,
    pub(super) factor: f64,
    /// When it acts; always, where there are none.
    pub(super) windows: Option<Windows>,
}

/// What the function returns.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Gives {
    /// A torque, given time, ω and attitude.
    Torque,
    /// A force and a torque, given position and velocity too.
    ForceAndTorque,
}

impl Callback {
    /// # Errors
    /// `TypeError` where it is no function.
    pub(super) fn new(function: &Bound<'_, PyAny>, gives: Gives) -> PyResult<Self> {
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

    pub(super) fn copied(&self, py: Python<'_>) -> Self {
        Self {
            function: self.function.clone_ref(py),
            windows: self.windows.clone(),
            ..*self
        }
    }

    pub(super) fn exerts_force(&self) -> bool {
        self.gives == Gives::ForceAndTorque
    }

    /// What the function says at a time and a state.
    pub(super) fn call(&self, py: Python<'_>, t: f64, phase: &Phase) -> PyResult<Wrench> {
        let array = |numbers: &[f64]| PyArray1::from_slice(py, numbers);
        let omega = array(phase.omega.as_slice());
        let quaternion = array(&components(&phase.attitude));
        let function = self.function.bind(py);
        let wrench = match self.gives {
            Gives::Torque => {
                let returned = function.call1((t, omega, quaternion))?;
                Wrench::couple(vector(&returned, "torque", t)?)
            }
            Gives::ForceAndTorque => {
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
