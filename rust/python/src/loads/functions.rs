//! The functions that make loads of functions: of Python's and of compiled ones.

use crate::arrays::read_scalar;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::address::Compiled;
use super::called::{Callback, Gives};
use super::load::PyLoad;
use super::part::Acts;
use super::recipe::recipe;
use super::stateful::{self, WithStates};

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
/// A body that a medium slows down:
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
///     ``function(t, omega, quaternion, position, velocity)`` returns a pair: the force at the reference
///     point of the motion, three components in space, and the torque about that point, three components in
///     the body frame. It is given the time, the angular velocity in the body frame, shape (3,), the attitude
///     R_NB as (x, y, z, w), shape (4,), and position and velocity of the reference point in space, shape
///     (3,).
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
/// initial : array_like, shape (k,), optional
///     Initial values of states of the load: ``state`` then holds these states after the 13 numbers, and
///     ``out`` takes their derivatives after the 6.
/// name : str, optional
///     The name of these states in `states` of the trajectory.
/// scale : float or array_like, shape (k,), optional
///     Typical size of each of these states, as for :func:`with_states`.
///
/// Returns
/// -------
/// Load
///
/// Notes
/// -----
/// The address is not checked: a function of another signature is undefined behaviour. For stacks it is
/// called from several threads at once. Such a load cannot be pickled.
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
#[pyo3(signature = (function, user_data=None, *, initial=None, name="states", scale=None))]
pub(crate) fn compiled(
    function: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] user_data: Option<usize>,
    initial: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
    scale: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyLoad> {
    let own = match initial {
        Some(initial) => stateful::initial(initial, scale)?,
        None if scale.is_some() => {
            return Err(PyTypeError::new_err(
                "scale: give initial= too: the function has no states",
            ));
        }
        None => (Vec::new(), Vec::new()),
    };
    stateful::check_name(name)?;
    let compiled = Compiled::new(function, user_data, own)?;
    let recipe = recipe(function.py(), "_unpicklable", (function,))?;
    Ok(PyLoad::one(Acts::Compiled(compiled), recipe).named(name))
}

/// A load with states that are integrated together with the motion: filters, actuators, integrators, sampled
/// controllers.
///
/// Every function is called as ``function(t, omega, quaternion, position, velocity, states)``: time, angular
/// velocity in the body frame, attitude R_NB as (x, y, z, w), position and velocity of the reference point in
/// space, and a dict of the states of the whole load by name, so that a controller can read the states of
/// wheels, too.
///
/// Parameters
/// ----------
/// rates : callable or None
///     Function that returns the derivatives of these states with respect to time. None: they change by
///     `update` alone.
/// initial : array_like, shape (k,)
///     The states at the start, at most 51.
/// wrench : callable, optional
///     Function that returns a pair: the force at the reference point, components in space, and the torque
///     about that point, components in the body frame. By default there is no force and no torque.
/// name : str, optional
///     Name of these states, in the dict of states and in ``states`` of the trajectory.
/// update : callable, optional
///     Function that returns new values of these states. It is called at the start and after each `period`.
///     This is a sampled controller: its output is constant from one update to the next.
/// period : float, optional
///     Time between two updates.
/// scale : float or array_like, shape (k,), optional
///     Typical size of each state. Errors are relative to it, or to the largest value of the state so far if
///     that is larger. It is needed for a state that stays near zero. It is also needed for a body at rest
///     and a state that begins at zero with a rate of zero, such as the last of a chain of lags. Without it
///     the method "dop853" then takes many small steps, and "radau" fails.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A thruster follows its command with a first-order lag of half a second:
///
/// >>> import numpy as np
/// >>> from polhode import RigidBody, loads
/// >>> def rates(t, omega, quaternion, position, velocity, states):
/// ...     return (1.0 - states["lag"]) / 0.5
/// >>> def wrench(t, omega, quaternion, position, velocity, states):
/// ...     return (0, 0, 0), (0, 0, states["lag"][0])
/// >>> thruster = loads.with_states(rates, [0.0], wrench, name="lag")
/// >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
/// >>> motion = body.simulate([0, 1, 10], omega=(0, 0, 0), load=thruster, rtol=1e-12)
/// >>> motion.states["lag"][:, 0].round(6)
/// array([0.      , 0.864665, 1.      ])
/// >>> bool(np.isclose(motion.omega[-1, 2], (10 - 0.5 * (1 - np.exp(-20))) / 2.5, rtol=1e-10))
/// True
#[pyfunction]
#[pyo3(signature = (rates, initial, wrench=None, name="states", *, update=None, period=None, scale=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub(crate) fn with_states(
    py: Python<'_>,
    rates: Option<&Bound<'_, PyAny>>,
    initial: &Bound<'_, PyAny>,
    wrench: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
    update: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] period: Option<f64>,
    scale: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyLoad> {
    let (values, scales) = stateful::initial(initial, scale)?;
    stateful::check_name(name)?;
    let own = (values.clone(), scales.clone());
    let load = WithStates::new([rates, wrench, update], period, own)?;
    let options = PyDict::new(py);
    options.set_item("update", update)?;
    options.set_item("period", period)?;
    options.set_item("scale", scales)?;
    let recipe = recipe(py, "with_states", (rates, values, wrench, name, options))?;
    Ok(PyLoad::one(Acts::WithStates(load), recipe).named(name))
}
