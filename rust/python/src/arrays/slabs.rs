//! Large arrays in pickles, in slabs: nobody looks for Ctrl-C while pickle copies an array, so each slab does.

use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::foreign::slice;
use crate::interrupt::Beat;
use crate::memory;
use crate::stack::BLOCK;

/// Numbers of a slab, which a few milliseconds copy.
const SLAB: usize = 1 << 20;

/// What a pickle takes in place of an array: a large one in slabs, a small one as it is.
pub(crate) fn in_slabs(array: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    match array.cast::<PyArrayDyn<f64>>() {
        Ok(large) if large.len() > SLAB => {
            let py = array.py();
            Ok(Bound::new(py, Slabs(large.clone().unbind()))?.into_any())
        }
        _ => Ok(array),
    }
}

/// As [`in_slabs`] of all arrays of a dictionary.
pub(crate) fn all_in_slabs(arrays: &Bound<'_, PyDict>) -> PyResult<()> {
    for (name, array) in arrays.copy()? {
        arrays.set_item(name, in_slabs(array)?)?;
    }
    Ok(())
}

/// A large array on its way into a pickle, or one of its slabs.
#[pyclass(frozen, name = "Slabs", module = "polhode._core")]
pub(crate) struct Slabs(Py<PyArrayDyn<f64>>);

#[pymethods]
impl Slabs {
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        py.check_signals()?;
        let restore = py.get_type::<Self>().getattr("_joined")?;
        let array = self.0.bind(py);
        let shape = PyTuple::new(py, array.shape())?;
        if array.len() <= SLAB {
            return Ok((restore, (shape, array).into_pyobject(py)?));
        }
        let flat = array.reshape([array.len()])?;
        let mut parts = vec![shape.into_any()];
        for from in (0..flat.len()).step_by(SLAB) {
            let to = flat.len().min(from + SLAB);
            let slab = flat.get_item(slice(py, from, to)?)?.cast_into()?;
            parts.push(Bound::new(py, Self(slab.unbind()))?.into_any());
        }
        Ok((restore, PyTuple::new(py, parts)?))
    }

    /// The array of these slabs, one after the other; a single one is the array.
    #[staticmethod]
    #[pyo3(signature = (shape, *slabs))]
    fn _joined<'py>(
        py: Python<'py>,
        shape: Vec<usize>,
        slabs: &Bound<'py, PyTuple>,
    ) -> PyResult<Bound<'py, PyAny>> {
        py.check_signals()?;
        if let Ok((slab,)) = slabs.extract() {
            return Ok(slab);
        }
        let mut numbers = memory::vector("pickle", &shape, 0)?;
        let mut beat = Beat::new(py);
        for slab in slabs {
            let slab: PyReadonlyArray1<'_, f64> = slab.extract()?;
            for block in slab.as_slice()?.chunks(BLOCK) {
                beat.mark()?;
                numbers.extend_from_slice(block);
            }
        }
        Ok(numbers.into_pyarray(py).reshape(shape)?.into_any())
    }
}
