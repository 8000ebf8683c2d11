//! Rates of Euler angles and the angular velocity.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::error::MotionFault;
use pyo3::prelude::*;

use crate::arrays::{read, read_scalar, write};
use crate::kinematics::parse_frame;
use crate::rotations::{in_radians, out_of_radians, parse_sequence, raises_where_singular};
use crate::stack::{Broadcast, Stack};

/// Angular velocity from Euler angles and their rates.
///
/// Parameters
/// ----------
/// angles, rates : array_like, shape (..., 3)
///     Angles in radians unless `degrees`, and their derivatives with respect to time, in the order of the sequence.
/// sequence : str, optional
///     As in `to_quaternion`; the default is the (φ, θ, ψ) of Goldstein and Landau.
/// frame : {"body", "space"}, optional
///     The frame whose axes the components of the result refer to.
/// degrees : bool, optional
///     Angles and rates are in degrees; the result is in radians per unit of time in any case.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3)
///     ω of the body relative to space. A row with a NaN gives NaN.
///
/// Notes
/// -----
/// For ZXZ in the body (φ̇ sin θ sin ψ + θ̇ cos ψ, φ̇ sin θ cos ψ − θ̇ sin ψ, φ̇ cos θ + ψ̇), in space (θ̇
/// cos φ + ψ̇ sin θ sin φ, θ̇ sin φ − ψ̇ sin θ cos φ, φ̇ + ψ̇ cos θ); the square of either is φ̇² + θ̇² + ψ̇²
/// + 2 φ̇ ψ̇ cos θ.
///
/// Examples
/// --------
/// A top that leans by 60° and spins while it precesses:
///
/// >>> import numpy as np
/// >>> from polhode import euler_angles
/// >>> euler_angles.angular_velocity((0, np.pi / 3, 0), (2, 0, 9)).round(6)
/// array([ 0.      ,  1.732051, 10.      ])
#[pyfunction]
#[pyo3(signature = (angles, rates, sequence="ZXZ", frame="body", *, degrees=false))]
pub(crate) fn angular_velocity_from_euler_rates<'py>(
    py: Python<'py>,
    angles: &Bound<'py, PyAny>,
    rates: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] sequence: &str,
    #[pyo3(from_py_with = read_scalar)] frame: &str,
    degrees: bool,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let (sequence, frame) = (parse_sequence(py, sequence)?, parse_frame(frame)?);
    let angles: Stack<[f64; 3]> = in_radians(read(angles, "angles")?, degrees);
    let rates: Stack<[f64; 3]> = in_radians(read(rates, "rates")?, degrees);
    let grid = Broadcast::of(["angles", "rates"], [&angles.shape, &rates.shape])?;
    let omega = grid.try_map(py, |[a, r]| {
        Ok(sequence.angular_velocity(&angles[a], &rates[r], frame))
    })?;
    write(py, &omega)
}

/// Rates of Euler angles from the angles and the angular velocity.
///
/// Parameters
/// ----------
/// angles : array_like, shape (..., 3)
///     Angles in radians unless `degrees`, in the order of the sequence.
/// omega : array_like, shape (..., 3)
///     Angular velocity of the body relative to space, components in `frame`.
/// sequence : str, optional
///     As in `to_quaternion`; the default is the (φ, θ, ψ) of Goldstein and Landau.
/// frame : {"body", "space"}, optional
///     The frame whose axes the components of `omega` refer to.
/// singular : {"raise", "nan"}, optional
///     What to do if the first and third angle turn about the same axis (sine of the middle angle, or cosine
///     for three different axes, below 1e-12): raise, or give NaN for the rates of these two.
/// degrees : bool, optional
///     The angles are in degrees, and so are the rates; `omega` is in radians per unit of time in any case.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3)
///     A row with a NaN gives NaN.
///
/// Raises
/// ------
/// SingularAttitudeError
///     Naming the row and the middle angle.
///
/// Examples
/// --------
/// >>> from polhode import euler_angles
/// >>> angles = (0.1, 1.2, -0.4)
/// >>> omega = euler_angles.angular_velocity(angles, (2, 0, 9))
/// >>> euler_angles.rates(angles, omega).round(12)
/// array([2., 0., 9.])
#[pyfunction]
#[pyo3(signature = (angles, omega, sequence="ZXZ", frame="body", singular="raise", *, degrees=false))]
pub(crate) fn euler_rates<'py>(
    py: Python<'py>,
    angles: &Bound<'py, PyAny>,
    omega: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] sequence: &str,
    #[pyo3(from_py_with = read_scalar)] frame: &str,
    #[pyo3(from_py_with = read_scalar)] singular: &str,
    degrees: bool,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let raises = raises_where_singular(singular)?;
    let (sequence, frame) = (parse_sequence(py, sequence)?, parse_frame(frame)?);
    let angles: Stack<[f64; 3]> = in_radians(read(angles, "angles")?, degrees);
    let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
    let grid = Broadcast::of(["angles", "omega"], [&angles.shape, &omega.shape])?;
    let rates = grid.try_map(py, |[a, w]| {
        match sequence.rates(&angles[a], &omega[w], frame) {
            Err(Error::Motion(MotionFault::SingularEulerRates { .. })) if !raises => {
                let middle = sequence.middle_rate(&angles[a], &omega[w], frame);
                Ok([f64::NAN, middle, f64::NAN])
            }
            result => result,
        }
    })?;
    write(py, &out_of_radians(rates, degrees))
}
