//! Rates seen from moving frames.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::motion::kinematics::{Frame, transport as transport_of};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{read, write};
use crate::stack::{Broadcast, Stack};

/// What the argument `frame` asks for.
pub(crate) fn parse_frame(word: &str) -> PyResult<Frame> {
    match word {
        "body" => Ok(Frame::Body),
        "space" => Ok(Frame::Space),
        other => Err(PyValueError::new_err(format!(
            "frame: expected \"body\" or \"space\", got \"{other}\""
        ))),
    }
}

/// Rate of change of a vector in the inertial frame from that in a rotating frame: ``(dA/dt)_N = (dA/dt)_F +
/// Ω×A``.
///
/// Parameters
/// ----------
/// rate_in_frame : array_like, shape (..., 3)
///     Derivatives with respect to time of the components of A in the rotating frame F.
/// vector : array_like, shape (..., 3)
///     A.
/// frame_omega : array_like, shape (..., 3)
///     Ω, the angular velocity of F relative to the inertial frame N. With ``-frame_omega`` the same formula
///     leads from N to F.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3)
///     Rate of change in N. All arguments and the result have components along the same axes. A row with a
///     NaN gives NaN.
///
/// Examples
/// --------
/// The torque that keeps ω constant in a body whose ω is not along a principal axis. Its angular momentum is
/// then constant in the body:
///
/// >>> from polhode import kinematics, solids
/// >>> box, omega = solids.box((1, 2, 3), mass=12.0), (1.0, 0.0, 1.0)
/// >>> kinematics.transport((0, 0, 0), box.angular_momentum(omega).total, omega)
/// array([0., 8., 0.])
/// >>> box.torque(omega)
/// array([0., 8., 0.])
#[pyfunction]
pub(crate) fn transport<'py>(
    py: Python<'py>,
    rate_in_frame: &Bound<'py, PyAny>,
    vector: &Bound<'py, PyAny>,
    frame_omega: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let rate: Stack<Vector3<f64>> = read(rate_in_frame, "rate_in_frame")?;
    let vector: Stack<Vector3<f64>> = read(vector, "vector")?;
    let omega: Stack<Vector3<f64>> = read(frame_omega, "frame_omega")?;
    let shapes = [&rate.shape[..], &vector.shape, &omega.shape];
    let grid = Broadcast::of(["rate_in_frame", "vector", "frame_omega"], shapes)?;
    let rates = grid.try_map(py, |[r, v, w]| {
        Ok(transport_of(&rate[r], &vector[v], &omega[w]))
    })?;
    write(py, &rates)
}
