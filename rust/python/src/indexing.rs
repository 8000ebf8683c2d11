//! NumPy's indexing over a stack.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::{PyIndexError, PyMemoryError, PyOverflowError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{contiguous, numpy};
use crate::shape::tuple;

/// The rows of a stack that a key picks, as NumPy itself tells.
pub(crate) fn picked_by<'py>(
    py: Python<'py>,
    shape: &[usize],
    key: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let rows = numpy(py)?
        .call_method1("arange", (shape.iter().product::<usize>(),))?
        .call_method1("reshape", (PyTuple::new(py, shape)?,))?;
    picked_rows(&rows.get_item(key).map_err(|error| {
        if error.is_instance_of::<PyMemoryError>(py) {
            PyMemoryError::new_err(format!("key: {}", error.value(py)))
        } else if error.is_instance_of::<PyOverflowError>(py) {
            PyIndexError::new_err(format!(
                "key: a number beyond any index, in a stack of shape {}",
                tuple(shape)
            ))
        } else {
            error
        }
    })?)
}

/// The rows that NumPy picked of their numbers, C-ordered.
pub(crate) fn picked_rows<'py>(
    picked: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let picked = numpy(picked.py())?.call_method1("asarray", (picked,))?;
    let picked = contiguous(&picked, "key", "int64")?;
    picked.extract()
}

/// The number of a row that NumPy picked: never a negative one.
pub(crate) fn to_index(row: i64) -> usize {
    usize::try_from(row).unwrap_or_default()
}
