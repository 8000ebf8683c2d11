//! The class `Load`: sums of analytic terms, of Python functions and of compiled ones.
//!
//! | file | what it knows |
//! |---|---|
//! | `terms` | the functions that make analytic terms |
//! | `called` | Python functions |
//! | `address` | functions at an address |
//! | `part` | one term, scaled, scheduled, picked, pickled |
//! | `evaluate` | what a load exerts at a time and a state |
//! | `acting` | a load at work on a body |

mod acting;
mod address;
mod called;
mod evaluate;
mod part;
mod terms;

use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use polhode::motion::loads::Term;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyNotImplemented, PyTuple};
use pyo3::{PyTraverseError, PyVisit};

pub(crate) use self::acting::{Acting, Cause, Fault};
use self::address::Compiled;
pub(crate) use self::address::compiled;
use self::called::Callback;
pub(crate) use self::called::{callback, torque_callback};
use self::part::{Acts, Part, described, made, recipe};
pub(crate) use self::terms::{
    constant_force, constant_torque, damping, feedback, gravity_gradient, sampled, schedule,
    uniform_gravity,
};
use crate::stack::{Broadcast, Stack, tuple};

/// What acts on a body: a sum of terms. Made by the functions of :mod:`polhode.loads`.
///
/// Loads add and scale: ``a + b``, ``a - b``, ``2 * a``, ``-a``, ``sum(loads)``. Arguments with leading axes make a stack of
/// loads, which broadcasts against bodies and states.
///
/// Examples
/// --------
/// >>> from polhode import loads
/// >>> loads.constant_torque((0, 0, 1)) + 2 * loads.constant_torque((0, 2, 0), frame="space")
/// <Load: constant_torque + 2.0 * constant_torque>
#[pyclass(name = "Load", module = "polhode.loads", frozen)]
#[derive(Default)]
pub(crate) struct PyLoad {
    parts: Vec<Part>,
}

impl PyLoad {
    fn one(acts: Acts, recipe: Py<PyTuple>) -> Self {
        Self {
            parts: vec![Part { acts, recipe }],
        }
    }

    pub(crate) fn copied(&self, py: Python<'_>) -> PyResult<Self> {
        self.map(|part| part.copied(py))
    }

    fn plus(&self, py: Python<'_>, other: &Self) -> PyResult<Self> {
        let mut sum = self.copied(py)?;
        sum.parts.append(&mut other.copied(py)?.parts);
        sum.stack_shape()?;
        Ok(sum)
    }

    fn map(&self, f: impl Fn(&Part) -> PyResult<Part>) -> PyResult<Self> {
        let parts = self.parts.iter().map(f).collect::<PyResult<_>>()?;
        Ok(Self { parts })
    }

    /// The shape to which the terms broadcast.
    fn stack_shape(&self) -> PyResult<Vec<usize>> {
        self.parts.iter().try_fold(Vec::new(), |shape, part| {
            Ok(Broadcast::of(["load", "load"], [&shape, part.shape()])?.shape)
        })
    }

    /// The analytic terms of each row.
    pub(crate) fn terms(&self, py: Python<'_>) -> PyResult<Stack<Vec<Term>>> {
        let shape = self.stack_shape()?;
        let analytic = self.parts.iter().filter_map(|part| match &part.acts {
            Acts::Term(terms) => Some(terms),
            _ => None,
        });
        let parts = analytic
            .map(|terms| {
                Ok((
                    terms,
                    Broadcast::of(["load", "load"], [&shape, &terms.shape])?,
                ))
            })
            .collect::<PyResult<Vec<_>>>()?;
        Broadcast::of(["load"], [&shape])?.try_map(py, |[row]| {
            let terms = parts.iter().map(|(terms, grid)| {
                let [_, own] = grid.operands(row);
                terms[own].clone()
            });
            Ok(terms.collect())
        })
    }

    fn callbacks(&self) -> impl Iterator<Item = &Callback> {
        self.parts.iter().filter_map(|part| match &part.acts {
            Acts::Callback(callback) => Some(callback),
            _ => None,
        })
    }

    fn compiled(&self) -> impl Iterator<Item = &Compiled> {
        self.parts.iter().filter_map(|part| match &part.acts {
            Acts::Compiled(compiled) => Some(compiled),
            _ => None,
        })
    }

    /// Whether it has analytic terms alone.
    pub(crate) fn is_analytic(&self) -> bool {
        (self.parts.iter()).all(|part| matches!(part.acts, Acts::Term(_)))
    }

    /// Whether it calls Python.
    pub(crate) fn calls_python(&self) -> bool {
        self.callbacks().next().is_some()
    }
}

/// What scales a load: a real number of Python or NumPy, also one in an array without axes; `None` of anything else.
fn real_number(factor: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    if factor.is_instance_of::<PyFloat>() || factor.is_instance_of::<PyInt>() {
        return factor.extract().map(Some);
    }
    let py = factor.py();
    if let Ok(array) = factor.cast::<PyUntypedArray>() {
        if array.ndim() == 0 && factor.is_exact_instance_of::<PyUntypedArray>() {
            return real_number(&array.call_method0("item")?);
        }
        // NumPy's own answer would be about anything but loads.
        return Err(PyTypeError::new_err(
            "a load is scaled by one number, not by an array: for a stack of loads give the function that makes it a stack \
             of arguments",
        ));
    }
    let real = py.import("numbers")?.getattr("Real")?;
    if factor.is_instance(&real)? {
        return factor.extract().map(Some);
    }
    Ok(None)
}

/// Whether the word `about` fixes the origin.
pub(crate) fn is_pivot(about: &str) -> PyResult<bool> {
    match about {
        "origin" => Ok(true),
        "center_of_mass" => Ok(false),
        _ => Err(PyValueError::new_err(format!(
            "about: expected \"center_of_mass\" or \"origin\", got \"{about}\"; to fix another point move the body with translated()"
        ))),
    }
}

#[pymethods]
impl PyLoad {
    /// What the garbage collector may find a cycle through: a function that knows the load it is part of.
    ///
    /// Nothing is cleared here: a load never changes, so that every cycle passes through something else that does.
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.parts.iter().try_for_each(|part| part.traverse(&visit))
    }

    fn __getitem__(&self, py: Python<'_>, key: &Bound<'_, PyAny>) -> PyResult<Self> {
        let shape = self.stack_shape()?;
        self.map(|part| part.picked(py, &shape, key))
    }

    /// Shape of the stack of loads; empty for one.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.stack_shape()?)
    }

    /// The load with orbits that have no epoch beginning at `t`: for the rest of a motion that started then.
    fn anchored(&self, py: Python<'_>, t: f64) -> PyResult<Self> {
        self.map(|part| {
            let mut part = part.copied(py)?;
            if let Acts::Term(terms) = &part.acts
                && terms.rows.iter().any(Term::needs_epoch)
            {
                part.recipe = recipe(py, "_anchored", (&part.recipe, t))?;
                part.acts = Acts::Term(terms.map(py, |term| term.clone().anchored(t))?);
            }
            Ok(part)
        })
    }

    fn __add__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        Ok(self.plus(py, other.get())?.into_pyobject(py)?.into_any())
    }

    /// `sum(loads)` starts from the number 0.
    fn __radd__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if other.is_exact_instance_of::<PyInt>()
            && other.extract::<i64>().is_ok_and(|zero| zero == 0)
        {
            return Ok(self.copied(py)?.into_pyobject(py)?.into_any());
        }
        Ok(PyNotImplemented::get(py).to_owned().into_any())
    }

    fn __sub__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let negative = other.get().__neg__(py)?;
        Ok(self.plus(py, &negative)?.into_pyobject(py)?.into_any())
    }

    fn __neg__(&self, py: Python<'_>) -> PyResult<Self> {
        self.map(|part| part.scaled(py, -1.0))
    }

    fn __mul__<'py>(
        &self,
        py: Python<'py>,
        factor: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Some(factor) = real_number(factor)? else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let scaled = self.map(|part| part.scaled(py, factor))?;
        Ok(scaled.into_pyobject(py)?.into_any())
    }

    fn __rmul__<'py>(
        &self,
        py: Python<'py>,
        factor: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.__mul__(py, factor)
    }

    /// A load is no array: NumPy leaves ``2.0 * load`` to the load, also where the number is one of NumPy's.
    #[classattr]
    fn __array_ufunc__() -> Option<bool> {
        None
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        self.copied(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.copied(py)
    }

    /// The terms as the functions that make them, with their arguments; for pickle.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        if self.compiled().next().is_some() {
            return Err(PyTypeError::new_err(
                "a load with a compiled function cannot be pickled: its address holds in this process alone",
            ));
        }
        let restore = py.get_type::<Self>().getattr("_from_parts")?;
        let parts: Vec<_> = self.parts.iter().map(|part| part.recipe.bind(py)).collect();
        Ok((restore, PyTuple::new(py, [parts])?))
    }

    /// The load that `__reduce__` took apart.
    #[staticmethod]
    fn _from_parts(py: Python<'_>, parts: Vec<Bound<'_, PyTuple>>) -> PyResult<Self> {
        let mut sum = Self::default();
        for recipe in parts {
            sum.parts.extend(made(py, &recipe)?.parts);
        }
        Ok(sum)
    }

    /// The functions that made its terms; a stack also by its shape.
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shape = self.stack_shape()?;
        let terms = (self.parts.iter())
            .map(|part| described(part.recipe.bind(py)))
            .collect::<PyResult<Vec<_>>>()?
            .join(" + ");
        Ok(if shape.is_empty() {
            format!("<Load: {terms}>")
        } else {
            format!("<Load stack of shape {}: {terms}>", tuple(&shape))
        })
    }
}
