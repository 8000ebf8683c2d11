//! Principal axes and tops of bare tensors.

use nalgebra::Matrix3;
use polhode::PrincipalAxes;
use polhode::mass::validity::{ASYMMETRY, check_symmetry};
use polhode::principal::{classify, gaps, principal_axes as principal_axes_of};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::arrays::{numpy, read, write};
use crate::stack::{Broadcast, Stack};

/// Principal moments and axes of symmetric tensors.
///
/// Parameters
/// ----------
/// inertia : array_like, shape (..., 3, 3)
///     Symmetric to rounding, 8 ε of the largest element. Any scale from the smallest to the largest
///     floats. A tensor with an element that is not finite gives NaN in its own row only.
///
/// Returns
/// -------
/// PrincipalAxes
///     ``moments`` (..., 3), ascending, and ``axes`` (..., 3, 3), whose columns are the axes: right-handed,
///     ``inertia = axes @ diag(moments) @ axes.T``. In columns 0 and 1 the first component as large as
///     the largest (to 1e-8) is positive.
///
/// Raises
/// ------
/// InvalidInertiaError
///     Naming the row whose tensor is not symmetric.
///
/// Examples
/// --------
/// >>> from polhode import principal_axes
/// >>> found = principal_axes([(2, 1, 0), (1, 2, 0), (0, 0, 4)])
/// >>> found.moments
/// array([1., 3., 4.])
/// >>> found.top
/// 'asymmetric'
#[pyfunction]
pub(crate) fn principal_axes<'py>(
    py: Python<'py>,
    inertia: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let tensors: Stack<Matrix3<f64>> = read(inertia, "inertia")?;
    let grid = Broadcast::of(["inertia"], [&tensors.shape])?;
    let found = grid.try_map(py, |[i]| {
        check_symmetry("inertia", &tensors[i], ASYMMETRY)?;
        Ok(principal_axes_of(&tensors[i]))
    })?;
    to_python(py, &found)
}

/// As `polhode.results.PrincipalAxes`.
pub(crate) fn to_python<'py>(
    py: Python<'py>,
    found: &Stack<PrincipalAxes>,
) -> PyResult<Bound<'py, PyAny>> {
    let moments = write(py, &found.map(|principal| principal.moments))?;
    let axes = write(py, &found.map(|principal| principal.axes))?;
    py.import("polhode.results")?
        .getattr("PrincipalAxes")?
        .call1((moments, axes))
}

/// Relative gaps (I2 − I1)/I3 and (I3 − I2)/I3 of ascending moments, shape (..., 2).
#[pyfunction]
pub(crate) fn principal_gaps<'py>(
    py: Python<'py>,
    moments: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(write(py, &read::<[f64; 3]>(moments, "moments")?.map(gaps))?.into_any())
}

/// Class of the top with ascending moments, at a relative tolerance: a string, or an array of them.
#[pyfunction]
pub(crate) fn classify_tops<'py>(
    py: Python<'py>,
    moments: &Bound<'py, PyAny>,
    rtol: f64,
) -> PyResult<Bound<'py, PyAny>> {
    if rtol.is_nan() || rtol < 0.0 {
        let message = format!("rtol: expected zero or more, got {rtol}");
        return Err(PyValueError::new_err(message));
    }
    let classes =
        read::<[f64; 3]>(moments, "moments")?.map(|moments| classify(moments, rtol).as_str());
    if classes.is_one() {
        return Ok(PyString::new(py, classes[0]).into_any());
    }
    numpy(py)?
        .call_method1("array", (classes.rows,))?
        .call_method1("reshape", (classes.shape,))
}
