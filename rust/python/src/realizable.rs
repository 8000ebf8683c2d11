//! Which tensors belong to bodies.

use nalgebra::{Matrix3, Vector3};
use numpy::PyArrayDyn;
use polhode::mass::realizable;
use pyo3::prelude::*;

use crate::arrays::{read, try_rows, write_numbers_of, write_of};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

/// The nearest tensors that bodies have, and their distances.
#[pyfunction]
pub(crate) fn nearest_valid<'py>(
    py: Python<'py>,
    inertia: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyArrayDyn<f64>>, Bound<'py, PyAny>)> {
    let tensors: Stack<Matrix3<f64>> = read(inertia, "inertia")?;
    let nearest = try_rows(py, &tensors, realizable::nearest_valid)?;
    Ok((
        write_of(py, &nearest, |(tensor, _)| *tensor)?,
        write_numbers_of(py, &nearest, |(_, distance)| *distance)?,
    ))
}

/// The room that the tightest condition leaves, and the two axes it is about.
#[pyfunction]
pub(crate) fn within_box<'py>(
    py: Python<'py>,
    body: &PyRigidBody,
    low: &Bound<'py, PyAny>,
    high: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyArrayDyn<f64>>)> {
    let (low, high): (Stack<Vector3<f64>>, Stack<Vector3<f64>>) =
        (read(low, "low")?, read(high, "high")?);
    let grid = Broadcast::of(
        ["body", "low", "high"],
        [&body.bodies.shape, &low.shape, &high.shape],
    )?;
    let verdicts = grid.try_map(py, |[b, l, h]| {
        realizable::within_box(&body.bodies[b], &low[l], &high[h])
    })?;
    let axes = |verdict: &realizable::BoxVerdict| verdict.axes.map(|axis| [0.0, 1.0, 2.0][axis]);
    Ok((
        write_numbers_of(py, &verdicts, |verdict| verdict.margin)?,
        write_of(py, &verdicts, axes)?,
    ))
}
