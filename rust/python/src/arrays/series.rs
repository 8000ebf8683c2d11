//! Vectors known at some times.

use nalgebra::Vector3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::reading::{list_floats, read_list};
use crate::stack::Stack;

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

/// Vectors of shape (..., n, 3) as a stack of series.
pub(crate) fn series(values: &Stack<Vector3<f64>>) -> Stack<&[Vector3<f64>]> {
    let (count, leading) = match values.shape.split_last() {
        Some((&count, leading)) => (count, leading.to_vec()),
        None => (0, Vec::new()),
    };
    Stack {
        shape: leading,
        rows: values.rows.chunks(count.max(1)).collect(),
    }
}
