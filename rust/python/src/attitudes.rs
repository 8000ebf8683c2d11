//! Attitudes in: quaternions, rotation matrices, and what SciPy and others make.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion};
use numpy::PyUntypedArray;
use polhode::motion::attitude::from_components;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::arrays::{as_array, read, try_rows};
use crate::depth::RecursionGuard;
use crate::stack::Stack;

/// Attitudes: quaternions (..., 4) as (x, y, z, w), or whatever has `as_quat()`; nothing is the identity.
pub(crate) fn read_attitude(
    object: Option<&Bound<'_, PyAny>>,
    name: &'static str,
) -> PyResult<Stack<UnitQuaternion<f64>>> {
    let Some(object) = object.filter(|object| !object.is_none()) else {
        return Ok(Stack::one(UnitQuaternion::identity()));
    };
    let components = read_quaternion(object, name)?;
    try_rows(object.py(), &components, |q| from_components(name, q))
}

/// As [`read_attitude`], to the last bit and of unit length to rounding alone, for motions that make it a unit quaternion in
/// double-double: rounded, it would be another top's, 1e-10 rad away after a million turns.
pub(crate) fn read_attitude_exactly(
    object: Option<&Bound<'_, PyAny>>,
    name: &'static str,
) -> PyResult<Stack<UnitQuaternion<f64>>> {
    let Some(object) = object.filter(|object| !object.is_none()) else {
        return Ok(Stack::one(UnitQuaternion::identity()));
    };
    let given = read_quaternion(object, name)?;
    try_rows(object.py(), &given, |q| {
        from_components(name, q)?;
        let [x, y, z, w] = *q;
        Ok(UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)))
    })
}

/// Quaternions (..., 4), unchecked, or what `as_quat()` returns.
pub(crate) fn read_quaternion(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Stack<[f64; 4]>> {
    match as_quaternion(object)? {
        Some(quaternion) => read(&quaternion, name),
        None => read(object, name),
    }
}

/// Rotation matrices: (..., 3, 3), quaternions (..., 4), or whatever has `as_quat()`.
pub(crate) fn read_rotation(
    object: &Bound<'_, PyAny>,
    name: &'static str,
) -> PyResult<Stack<Matrix3<f64>>> {
    if as_quaternion(object)?.is_none() {
        let shape: Vec<usize> = as_array(object, name)?.getattr("shape")?.extract()?;
        if !matches!(shape[..], [.., 4]) {
            return read(object, name);
        }
    }
    read_attitude(Some(object), name)?.map(object.py(), |q| q.to_rotation_matrix().into_inner())
}

/// What `as_quat()` returns, where there is such a method.
fn as_quaternion<'py>(object: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let has_none = object.is_exact_instance_of::<PyUntypedArray>()
        || object.is_exact_instance_of::<PyTuple>()
        || object.is_exact_instance_of::<PyList>();
    if has_none {
        return Ok(None);
    }
    let _guard = RecursionGuard::argument("as_quat")?;
    object
        .getattr_opt("as_quat")?
        .map(|method| method.call0())
        .transpose()
}
