//! The times of a run.

use polhode::motion::simulate::check_times;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::read;
use crate::errors::to_py;
use crate::stack::Stack;

/// Times in one row, strictly monotone.
pub(crate) fn read_times(py: Python<'_>, t: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let times: Stack<f64> = read(t, "t")?;
    if times.shape.len() != 1 {
        return Err(PyValueError::new_err(format!(
            "t: expected shape (T,), got {}; the first time is the start: [0, 10], or numpy.linspace(0, 10, 1001)",
            crate::shape::tuple(&times.shape)
        )));
    }
    check_times(&times.rows).map_err(|error| to_py(py, &error))?;
    Ok(times.rows)
}
