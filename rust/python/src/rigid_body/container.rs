//! A stack as a container: shape, indexing, iteration, hash, pickle, repr.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use numpy::PyUntypedArrayMethods;
use polhode::RigidBody;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList, PyTuple};

use crate::arrays::{all_in_slabs, floats, in_slabs, try_items, write_of};
use crate::body::PyRigidBody;
use crate::hints::no_attribute;
use crate::indexing::{picked_by, to_index};
use crate::interrupt::Beat;
use crate::memory;
use crate::shape::tuple;
use crate::stack::{BLOCK, Broadcast, Stack, extend};

#[pymethods]
impl PyRigidBody {
    /// Shape of the stack; ``()`` for one body.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.bodies.shape)
    }

    /// Asked where there is no such attribute.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<Py<PyAny>> {
        Err(no_attribute(slf.as_any(), name))
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
        let picked = picked_by(py, &self.bodies.shape, key)?;
        let shape = picked.shape().to_vec();
        let grid = Broadcast::of(["key"], [&shape])?;
        let picked = picked.as_slice()?;
        let bodies = grid.try_map(py, |[k]| Ok(self.bodies[to_index(picked[k])]))?;
        let rows = picked.iter().map(|&row| to_index(row));
        let doubts = self.doubts_of(rows.clone());
        Ok(Self::doubtful(bodies, doubts).looking(self.figures_of(rows)))
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        if self.bodies.is_one() {
            return Err(PyTypeError::new_err(
                "one body cannot be iterated over: it is not a stack",
            ));
        }
        let shape = self.bodies.shape[1..].to_vec();
        let size = shape.iter().product::<usize>();
        let parts = PyList::empty(py);
        let mut beat = Beat::new(py);
        for i in 0..self.bodies.shape[0] {
            if (i * size.max(1)) % BLOCK < size.max(1) {
                beat.mark()?;
            }
            let mut rows = memory::vector("bodies", &shape, 0)?;
            extend(
                py,
                &mut rows,
                &self.bodies.rows[i * size..(i + 1) * size],
                |body| *body,
            )?;
            let shape = shape.clone();
            let own = i * size..(i + 1) * size;
            let part = Self::doubtful(Stack { shape, rows }, self.doubts_of(own.clone()))
                .looking(self.figures_of(own));
            parts.append(Py::new(py, part)?)?;
        }
        parts.try_iter()
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<u64> {
        let mut hasher = DefaultHasher::new();
        self.bodies.shape.hash(&mut hasher);
        let mut beat = Beat::new(py);
        for (row, body) in self.bodies.rows.iter().enumerate() {
            if row % BLOCK == 0 {
                beat.mark()?;
            }
            // Equal bodies have equal hashes: zero is one number.
            (body.to_array()[..22].iter()).for_each(|x| (x + 0.0).to_bits().hash(&mut hasher)); // without the bounds, as ==
        }
        Ok(hasher.finish())
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_numbers")?;
        let numbers = in_slabs(write_of(py, &self.bodies, RigidBody::to_array)?.into_any())?;
        let doubts = self.stored_doubts(py)?;
        doubts.as_ref().map_or(Ok(()), all_in_slabs)?;
        let state = match self.stored_figures(py)? {
            None => match doubts {
                None => (numbers,).into_pyobject(py)?,
                Some(doubts) => (numbers, doubts).into_pyobject(py)?,
            },
            Some(figures) => (numbers, doubts, figures).into_pyobject(py)?,
        };
        Ok((restore, state))
    }

    /// The bodies that `__reduce__` took apart, shape (..., 34), or (..., 33) without the rounding of coordinates, as before
    /// it was kept, their doubts if they have some, and their shapes if those are known; for pickle.
    #[staticmethod]
    #[pyo3(signature = (numbers, doubts=None, figures=None))]
    fn _from_numbers(
        numbers: &Bound<'_, PyAny>,
        doubts: Option<&Bound<'_, PyDict>>,
        figures: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let array = floats(numbers, "numbers")?;
        let bodies = Self::from(if array.shape().last() == Some(&33) {
            try_items(&array, "numbers", |row: &[f64; 33]| {
                RigidBody::from_array(&std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0)))
            })?
        } else {
            try_items(&array, "numbers", RigidBody::from_array)?
        });
        let bodies = doubts.map_or(Ok(bodies.clone()), |doubts| bodies.with_doubts(doubts))?;
        match figures {
            None => Ok(bodies),
            Some(figures) => bodies.with_figures(figures),
        }
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
