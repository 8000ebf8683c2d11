//! Attitudes: Euler angles, quaternions, matrices.

use nalgebra::{Matrix3, Vector3};
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::error::MotionFault;
use polhode::motion::attitude::{components, from_components, from_matrix};
use polhode::motion::euler_angles::Sequence;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{read, read_scalar, try_rows, write, write_of};
use crate::attitudes::read_quaternion;
use crate::errors::to_py;
use crate::stack::{Broadcast, Stack};

type Array<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

pub(crate) fn parse_sequence(py: Python<'_>, sequence: &str) -> PyResult<Sequence> {
    sequence.parse().map_err(|error: Error| to_py(py, &error))
}

/// Angles in radians, of which a caller may have given degrees.
pub(crate) fn in_radians<const N: usize>(
    mut angles: Stack<[f64; N]>,
    degrees: bool,
) -> Stack<[f64; N]> {
    if degrees {
        for angle in angles.rows.as_flattened_mut() {
            *angle = angle.to_radians();
        }
    }
    angles
}

/// Angles as a caller asked for them, from radians.
pub(crate) fn out_of_radians(mut angles: Stack<[f64; 3]>, degrees: bool) -> Stack<[f64; 3]> {
    if degrees {
        for angle in angles.rows.as_flattened_mut() {
            *angle = angle.to_degrees();
        }
    }
    angles
}

/// What the argument `singular` asks for.
pub(crate) fn raises_where_singular(word: &str) -> PyResult<bool> {
    match word {
        "raise" => Ok(true),
        "nan" => Ok(false),
        other => Err(PyValueError::new_err(format!(
            "singular: expected \"raise\" or \"nan\", got \"{other}\""
        ))),
    }
}

/// Unit quaternions of attitudes given by Euler angles.
///
/// Parameters
/// ----------
/// angles : array_like, shape (..., 3)
///     Angles in radians unless `degrees`, in the order in which the sequence names its axes.
/// sequence : str, optional
///     Three axes: intrinsic in upper case (``"ZXZ"``: R_NB = Rz(φ) Rx(θ) Rz(ψ)), extrinsic in lower
///     case; or ``"goldstein"``, ``"landau"`` (ZXZ), ``"aerospace"`` (ZYX).
/// degrees : bool, optional
///     The angles are in degrees.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 4)
///     (x, y, z, w) of R_NB.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import euler_angles
/// >>> euler_angles.to_quaternion((np.pi / 2, 0, 0)).round(6)
/// array([0.      , 0.      , 0.707107, 0.707107])
/// >>> euler_angles.to_quaternion((90, 0, 0), degrees=True).round(6)
/// array([0.      , 0.      , 0.707107, 0.707107])
#[pyfunction]
#[pyo3(signature = (angles, sequence="ZXZ", *, degrees=false))]
pub(crate) fn quaternion_from_euler_angles<'py>(
    py: Python<'py>,
    angles: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] sequence: &str,
    degrees: bool,
) -> Array<'py> {
    let sequence = parse_sequence(py, sequence)?;
    let angles: Stack<[f64; 3]> = in_radians(read(angles, "angles")?, degrees);
    let attitudes = try_rows(py, &angles, |angles| sequence.to_quaternion(angles))?;
    write_of(py, &attitudes, components)
}

/// Euler angles of attitudes.
///
/// Parameters
/// ----------
/// quaternion : array_like, shape (..., 4), or rotation
///     (x, y, z, w) of R_NB, or anything with ``as_quat()``.
/// sequence : str, optional
///     As in `to_quaternion`.
/// singular : {"raise", "nan"}, optional
///     What to do if the first and third angle are not defined (sine of the middle angle, or cosine for three
///     different axes, below 1e-12): raise, or give NaN for these two.
/// degrees : bool, optional
///     Give degrees.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3)
///     In radians unless `degrees`, first and third in [−π, π], the middle one in [0, π], or in [−π/2, π/2] for three
///     different axes.
///
/// Raises
/// ------
/// SingularAttitudeError
///     Naming the row and the middle angle.
///
/// Notes
/// -----
/// A quaternion with a NaN, as that of a failed member of an ensemble, gives NaN.
///
/// Examples
/// --------
/// >>> from polhode import euler_angles
/// >>> angles = (0.1, 1.2, -0.4)
/// >>> euler_angles.from_quaternion(euler_angles.to_quaternion(angles)).round(12)
/// array([ 0.1,  1.2, -0.4])
#[pyfunction]
#[pyo3(signature = (quaternion, sequence="ZXZ", singular="raise", *, degrees=false))]
pub(crate) fn euler_angles_from_quaternion<'py>(
    py: Python<'py>,
    quaternion: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] sequence: &str,
    #[pyo3(from_py_with = read_scalar)] singular: &str,
    degrees: bool,
) -> Array<'py> {
    let raises = raises_where_singular(singular)?;
    let sequence = parse_sequence(py, sequence)?;
    let quaternions = read_quaternion(quaternion, "quaternion")?;
    let angles = try_rows(py, &quaternions, |components| {
        if components.iter().any(|x| x.is_nan()) {
            return Ok([f64::NAN; 3]);
        }
        match sequence.from_quaternion(&from_components("quaternion", components)?) {
            Err(Error::Motion(MotionFault::GimbalLock { middle, .. })) if !raises => {
                Ok([f64::NAN, middle, f64::NAN])
            }
            result => result,
        }
    })?;
    write(py, &out_of_radians(angles, degrees))
}

/// Unit quaternions (x, y, z, w), w ≥ 0, of rotation matrices (..., 3, 3).
#[pyfunction]
pub(crate) fn quaternion_from_matrix<'py>(
    py: Python<'py>,
    matrix: &Bound<'py, PyAny>,
) -> Array<'py> {
    let matrices: Stack<Matrix3<f64>> = read(matrix, "matrix")?;
    let attitudes = try_rows(py, &matrices, from_matrix)?;
    write_of(py, &attitudes, components)
}

/// Vectors (..., 3) turned by unit quaternions (..., 4): q v q*, or q* v q.
#[pyfunction]
#[pyo3(signature = (quaternion, vector, inverse=false))]
pub(crate) fn rotate<'py>(
    py: Python<'py>,
    quaternion: &Bound<'py, PyAny>,
    vector: &Bound<'py, PyAny>,
    inverse: bool,
) -> Array<'py> {
    let quaternions: Stack<[f64; 4]> = read(quaternion, "quaternion")?;
    let vectors: Stack<Vector3<f64>> = read(vector, "vector")?;
    let grid = Broadcast::of(
        ["quaternion", "vector"],
        [&quaternions.shape, &vectors.shape],
    )?;
    let turned = grid.try_map(py, |[q, v]| {
        if quaternions[q].iter().any(|x| x.is_nan()) {
            return Ok(Vector3::repeat(f64::NAN));
        }
        let attitude = from_components("quaternion", &quaternions[q])?;
        let vector = &vectors[v];
        Ok(if inverse {
            attitude.inverse_transform_vector(vector)
        } else {
            attitude * vector
        })
    })?;
    write(py, &turned)
}
