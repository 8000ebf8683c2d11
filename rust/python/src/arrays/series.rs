//! Vectors known at some times.

use nalgebra::Vector3;
use polhode::Error;
use polhode::parallel::Watch;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::reading::{list_floats, read_list};
use crate::stack::{Stack, try_watched};

/// Times, and the vectors of shape (..., n, 3) that belong to them; their names are those of the arguments.
pub(crate) fn samples(
    [times, values]: [&Bound<'_, PyAny>; 2],
    [when, what]: [&'static str; 2],
) -> PyResult<(Vec<f64>, Stack<Vector3<f64>>)> {
    let times: Vec<f64> = list_floats(times, when, "n", &[])?.as_slice()?.to_vec();
    let values: Stack<Vector3<f64>> = read_list(values, what, "..., n")?;
    let count = values.shape.last().copied().unwrap_or(0);
    if count != times.len() {
        return Err(PyValueError::new_err(format!(
            "{what}: expected one for each of the {} times, got {count}",
            times.len()
        )));
    }
    Ok((times, values))
}

/// `f` of each series of vectors of shape (..., n, 3), while other threads of Python go on; names the series that fails.
pub(crate) fn try_series<R: Send>(
    py: Python<'_>,
    values: &Stack<Vector3<f64>>,
    f: impl Fn(&[Vector3<f64>], &mut Watch<'_>) -> Result<R, Error> + Sync,
) -> PyResult<Stack<R>> {
    let (count, shape) = match values.shape.split_last() {
        Some((&count, leading)) => (count, leading.to_vec()),
        None => (0, Vec::new()),
    };
    try_watched(py, shape, values.rows.chunks(count.max(1)), f)
}
