//! What Python's operators and pickle do with a load.

use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyNotImplemented, PyTuple};
use pyo3::{PyTraverseError, PyVisit};

use super::load::{PyLoad, made};
use super::recipe::described;
use crate::arrays::read_scalar;
use crate::shape::tuple;

/// What scales a load: a real number of Python or NumPy, also one in an array without axes; `None` of anything else.
fn real_number(factor: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    if factor.is_instance_of::<PyFloat>() || factor.is_instance_of::<PyInt>() {
        return read_scalar(factor).map(Some);
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
        return read_scalar(factor).map(Some);
    }
    Ok(None)
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

    /// Return the same load for a motion that is continued and that had started at `t`. Orbits without an epoch
    /// get `t` as their epoch.
    fn with_epoch(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = read_scalar)] t: f64,
    ) -> PyResult<Self> {
        self.copy_with_epoch(py, t)
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
