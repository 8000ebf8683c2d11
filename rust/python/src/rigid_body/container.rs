//! A stack as a container: shape, indexing, iteration, hash, pickle, repr.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyList, PyTuple};

use super::PyRigidBody;
use crate::arrays::{numpy, read, write};
use crate::stack::{Stack, tuple};

#[pymethods]
impl PyRigidBody {
    /// Shape of the stack; ``()`` for one body.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.bodies.shape)
    }

    fn __len__(&self) -> PyResult<usize> {
        self.bodies
            .shape
            .first()
            .copied()
            .ok_or_else(|| PyTypeError::new_err("one body has no length: it is not a stack"))
    }

    /// A body is always true: `len` is about the shape of the stack.
    #[expect(clippy::unused_self, reason = "Python asks an instance")]
    fn __bool__(&self) -> bool {
        true
    }

    /// NumPy's indexing over the stack: integers, slices, masks, arrays, ``...`` and ``None``.
    fn __getitem__(&self, py: Python<'_>, key: &Bound<'_, PyAny>) -> PyResult<Self> {
        let np = numpy(py)?;
        // NumPy itself tells which rows the key picks.
        let rows = np
            .call_method1("arange", (self.bodies.rows.len(),))?
            .call_method1("reshape", (self.shape(py)?,))?;
        let picked = np
            .call_method1("asarray", (rows.get_item(key)?, "int64"))?
            .cast_into::<PyArrayDyn<i64>>()?;
        let shape = picked.shape().to_vec();
        let rows = picked
            .readonly()
            .as_array()
            .iter()
            .filter_map(|&row| usize::try_from(row).ok())
            .map(|row| self.bodies[row])
            .collect();
        Ok(Stack { shape, rows }.into())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        if self.bodies.is_one() {
            return Err(PyTypeError::new_err(
                "one body cannot be iterated over: it is not a stack",
            ));
        }
        let shape = self.bodies.shape[1..].to_vec();
        let size = shape.iter().product::<usize>();
        let parts = (0..self.bodies.shape[0]).map(|i| {
            let rows = self.bodies.rows[i * size..(i + 1) * size].to_vec();
            Self::from(Stack {
                shape: shape.clone(),
                rows,
            })
        });
        PyList::new(
            py,
            parts
                .map(|part| Py::new(py, part))
                .collect::<PyResult<Vec<_>>>()?,
        )?
        .try_iter()
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.bodies.shape.hash(&mut hasher);
        for row in &self.numbers().rows {
            // Equal bodies have equal hashes: zero is one number.
            row[..22]
                .iter()
                .for_each(|x| (x + 0.0).to_bits().hash(&mut hasher)); // without the bounds, as ==
        }
        hasher.finish()
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_numbers")?;
        Ok((restore, PyTuple::new(py, [write(py, &self.numbers())?])?))
    }

    /// The bodies that `__reduce__` took apart, shape (..., 34), or (..., 33) without the rounding of coordinates, as before
    /// it was kept; for pickle.
    #[staticmethod]
    fn _from_numbers(py: Python<'_>, numbers: &Bound<'_, PyAny>) -> PyResult<Self> {
        let all = read::<[f64; 34]>(numbers, "numbers").or_else(|fault| {
            let before = read::<[f64; 33]>(numbers, "numbers").map_err(|_| fault)?;
            Ok::<_, PyErr>(
                before.map(|row| std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))),
            )
        })?;
        Self::from_numbers(&all, py)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// One body as an expression that makes it; a stack by its shape.
    fn __repr__(&self) -> String {
        if !self.bodies.is_one() {
            let count = self.bodies.rows.len();
            return format!(
                "<RigidBody stack of shape {}: {count} bodies>",
                tuple(&self.bodies.shape)
            );
        }
        let body = &self.bodies[0];
        let row =
            |numbers: [f64; 3]| format!("[{:?}, {:?}, {:?}]", numbers[0], numbers[1], numbers[2]);
        let inertia = body.inertia();
        let rows = [0, 1, 2].map(|i| row([0, 1, 2].map(|j| inertia[(i, j)])));
        let center = row(body.center_of_mass().into());
        format!(
            "RigidBody(mass={:?}, inertia=[{}], center_of_mass={center})",
            body.mass(),
            rows.join(", ")
        )
    }
}
