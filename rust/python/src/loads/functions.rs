//! The functions that make loads of functions: of Python's and of compiled ones.

use pyo3::prelude::*;

use super::address::Compiled;
use super::called::{Callback, Gives};
use super::load::PyLoad;
use super::part::Acts;
use super::recipe::recipe;

/// A torque computed by a Python function.
///
/// Parameters
/// ----------
/// function : callable
///     ``function(t, omega, quaternion)`` returns the torque about the reference point of the motion as
///     three numbers in the body frame, given the time, the angular velocity in the body frame, shape
///     (3,), and the attitude R_NB as (x, y, z, w), shape (4,).
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A body slowed down by a medium:
///
/// >>> from polhode import loads, solids
/// >>> ball = solids.sphere(1.0, mass=2.5)
/// >>> drag = loads.torque_callback(lambda t, omega, quaternion: -0.1 * omega)
/// >>> ball.simulate([0, 10], omega=(0, 0, 1), load=drag).omega[-1].round(6)
/// array([0.      , 0.      , 0.367879])
#[pyfunction]
pub(crate) fn torque_callback(function: &Bound<'_, PyAny>) -> PyResult<PyLoad> {
    load(function, "torque_callback", Gives::Torque)
}

/// A force and a torque computed by a Python function.
///
/// Parameters
/// ----------
/// function : callable
///     ``function(t, omega, quaternion, position, velocity)`` returns a pair: the force through the reference
///     point of the motion, three numbers in space, and the torque about it, three numbers in the body frame.
///     It is given the time, the angular velocity in the body frame, shape (3,), the attitude R_NB as
///     (x, y, z, w), shape (4,), and position and velocity of the reference point in space, shape (3,).
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A ball on a spring:
///
/// >>> import numpy as np
/// >>> from polhode import loads, solids
/// >>> spring = loads.callback(lambda t, omega, quaternion, position, velocity: (-position, (0.0, 0.0, 0.0)))
/// >>> ball = solids.sphere(1.0, mass=1.0)
/// >>> ball.simulate([0, np.pi], (0, 0, 1), position=(2, 0, 0), load=spring).position[-1].round(6)
/// array([-2.,  0.,  0.])
#[pyfunction]
pub(crate) fn callback(function: &Bound<'_, PyAny>) -> PyResult<PyLoad> {
    load(function, "callback", Gives::ForceAndTorque)
}

fn load(function: &Bound<'_, PyAny>, name: &str, gives: Gives) -> PyResult<PyLoad> {
    let callback = Callback::new(function, gives)?;
    let recipe = recipe(function.py(), name, (function,))?;
    Ok(PyLoad::one(Acts::Callback(callback), recipe))
}

/// A force and a torque computed by a compiled function, which runs without the GIL.
///
/// Parameters
/// ----------
/// function : scipy.LowLevelCallable, int, or object with ``address``
///     A function ``void f(double t, const double *state, double *out, void *user_data)``: a
///     ``LowLevelCallable``, the ``cfunc`` of Numba, or the bare address. ``state`` holds 13 numbers, the quaternion
///     x, y, z, w, the angular velocity in the body frame, position and velocity of the reference point in space;
///     ``out`` takes 6, the force in space and the torque in the body frame. ``out`` is zero before the call.
/// user_data : int, optional
///     The address that the function gets as ``user_data``; that of the ``LowLevelCallable``, or 0, by default.
///
/// Returns
/// -------
/// Load
///
/// Notes
/// -----
/// The address is trusted: a function of another signature is undefined behaviour. Stacks call it from several threads
/// at once. Such a load cannot be pickled.
///
/// Examples
/// --------
/// .. code-block:: python
///
///     from numba import cfunc, types
///
///     @cfunc(types.void(types.double, types.CPointer(types.double), types.CPointer(types.double), types.voidptr))
///     def drag(t, state, out, user_data):
///         for i in range(3):
///             out[3 + i] = -0.1 * state[4 + i]
///
///     body.simulate([0, 10], omega=(0, 0, 1), load=loads.compiled(drag))
#[pyfunction]
#[pyo3(signature = (function, user_data=None))]
pub(crate) fn compiled(function: &Bound<'_, PyAny>, user_data: Option<usize>) -> PyResult<PyLoad> {
    let compiled = Compiled::new(function, user_data)?;
    let recipe = recipe(function.py(), "_unpicklable", (function,))?;
    Ok(PyLoad::one(Acts::Compiled(compiled), recipe))
}
