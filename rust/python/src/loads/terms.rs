//! The functions of `polhode.loads` that make analytic terms.

use nalgebra::{Matrix3, Vector3};
use polhode::Error;
use polhode::motion::loads::{Damping, Sampled, Term};
use pyo3::prelude::*;

use super::load::{PyLoad, schedule_load};
use super::made::made;
use super::part::Acts;
use super::recipe::recipe;
use crate::arrays::{as_array, read, read_scalar, samples, try_rows, try_series, write};
use crate::errors::to_py;
use crate::kinematics::parse_frame;
use crate::stack::{Broadcast, Stack};

/// A torque that stays constant, about the reference point of the motion.
///
/// Parameters
/// ----------
/// vector : array_like, shape (..., 3)
/// frame : {"body", "space"}, optional
///     The frame whose axes the components refer to: a torque constant in the body turns with it, one constant
///     in space keeps its direction.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// >>> from polhode import loads, solids
/// >>> flywheel = solids.cylinder(radius=1.0, height=0.2, mass=4.0)
/// >>> flywheel.simulate([0, 5], omega=(0, 0, 0), load=loads.constant_torque((0, 0, 2))).omega[-1].round(9)
/// array([0., 0., 5.])
#[pyfunction]
#[pyo3(signature = (vector, frame="body"))]
pub(crate) fn constant_torque(
    py: Python<'_>,
    vector: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] frame: &str,
) -> PyResult<PyLoad> {
    let axes = parse_frame(frame)?;
    let vector: Stack<Vector3<f64>> = read(vector, "vector")?;
    let terms = try_rows(py, &vector, |vector| Term::constant_torque(vector, axes))?;
    let recipe = recipe(py, "constant_torque", (write(py, &vector)?, frame))?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(ConstantTorque by constant_torque);

/// A force that stays constant, at a point of the body.
///
/// Parameters
/// ----------
/// vector : array_like, shape (..., 3)
/// frame : {"body", "space"}, optional
///     The frame whose axes the components refer to: the thrust of a nozzle turns with the body, a steady wind
///     does not.
/// point : array_like, shape (..., 3), optional
///     Point where the force acts, in the body frame; the centre of mass by default.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A force at the centre of mass moves a body without turning it:
///
/// >>> from polhode import loads, solids
/// >>> cube = solids.cube(1.0, mass=2.0)
/// >>> push = loads.constant_force((4, 0, 0), frame="space")
/// >>> motion = cube.simulate([0, 3], omega=(0, 0, 1), load=push)
/// >>> motion.position[-1].round(9), motion.omega[-1]
/// (array([9., 0., 0.]), array([0., 0., 1.]))
#[pyfunction]
#[pyo3(signature = (vector, frame="body", point=None))]
pub(crate) fn constant_force(
    py: Python<'_>,
    vector: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] frame: &str,
    point: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyLoad> {
    let axes = parse_frame(frame)?;
    let vector: Stack<Vector3<f64>> = read(vector, "vector")?;
    let point = point
        .map(|point| read::<Vector3<f64>>(point, "point"))
        .transpose()?;
    let shape = point.as_ref().map_or(&[][..], |point| &point.shape);
    let grid = Broadcast::of(["vector", "point"], [&vector.shape, shape])?;
    let terms = grid.try_map(py, |[f, p]| {
        Term::constant_force(&vector[f], axes, point.as_ref().map(|point| &point[p]))
    })?;
    let point = point.map(|point| write(py, &point)).transpose()?;
    let recipe = recipe(py, "constant_force", (write(py, &vector)?, frame, point))?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(ConstantForce by constant_force);

/// The weight of a body in a uniform field: a force m g at its centre of mass.
///
/// A free body falls; a body simulated with ``about="origin"`` is a pendulum or a top.
///
/// Parameters
/// ----------
/// gravity : array_like, shape (..., 3)
///     Gravitational acceleration g, components in space.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// >>> from polhode import loads, solids
/// >>> stone = solids.sphere(0.1, mass=1.0)
/// >>> stone.simulate([0, 2], omega=(0, 0, 0), load=loads.uniform_gravity((0, 0, -9.81))).velocity[-1].round(9)
/// array([  0.  ,   0.  , -19.62])
#[pyfunction]
pub(crate) fn uniform_gravity(py: Python<'_>, gravity: &Bound<'_, PyAny>) -> PyResult<PyLoad> {
    let gravity: Stack<Vector3<f64>> = read(gravity, "gravity")?;
    let terms = try_rows(py, &gravity, Term::uniform_gravity)?;
    let recipe = recipe(py, "uniform_gravity", (write(py, &gravity)?,))?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(UniformGravity by uniform_gravity);

/// A torque against the angular velocity, ``-D ω - E |ω| ω``.
///
/// The torque is external, like that of the air: the angular momentum of the body decreases. For a loss of
/// energy inside the body, at constant angular momentum, see :func:`slug`.
///
/// Parameters
/// ----------
/// matrix : array_like, shape (..., 3, 3), or a number
///     D in the body frame; a number stands for that times the identity.
/// quadratic : array_like, shape (..., 3, 3), or a number, optional
///     E in the body frame; none by default.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// >>> from polhode import loads, solids
/// >>> ball = solids.sphere(1.0, mass=2.5)
/// >>> ball.simulate([0, 10], omega=(0, 0, 1), load=loads.damping(0.1)).omega[-1].round(6)
/// array([0.      , 0.      , 0.367879])
#[pyfunction]
#[pyo3(signature = (matrix, quadratic=None))]
pub(crate) fn damping(
    py: Python<'_>,
    matrix: &Bound<'_, PyAny>,
    quadratic: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyLoad> {
    let linear = matrices(matrix, "matrix")?;
    let quadratic = quadratic.map_or_else(
        || Ok(Stack::one(Matrix3::zeros())),
        |quadratic| matrices(quadratic, "quadratic"),
    )?;
    let grid = Broadcast::of(["matrix", "quadratic"], [&linear.shape, &quadratic.shape])?;
    let terms = grid.try_map(py, |[d, e]| {
        Damping::new(&linear[d], &quadratic[e]).map(Term::Damping)
    })?;
    let recipe = recipe(py, "damping", (write(py, &linear)?, write(py, &quadratic)?))?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(Damping by damping);

/// A torque that is known at given times, with a cubic spline in between.
///
/// The spline is that of :class:`scipy.interpolate.CubicSpline` ("not-a-knot"). A simulation ends a step at each of the
/// times, where the spline is not smooth.
///
/// Parameters
/// ----------
/// t : array_like, shape (n,)
///     Ascending, at least two.
/// torque : array_like, shape (..., n, 3)
///     Torques about the reference point of the motion.
/// frame : {"body", "space"}, optional
///
/// Returns
/// -------
/// Load
///
/// Raises
/// ------
/// ValueError
///     If a simulation needs the torque before the first or after the last of the times.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import RigidBody, loads
/// >>> t = np.linspace(0, 10, 201)
/// >>> torque = np.column_stack([0 * t, 0 * t, np.cos(t)])
/// >>> body = RigidBody.from_principal(1.0, (1, 2, 2.5))
/// >>> motion = body.simulate([0, np.pi / 2], omega=(0, 0, 0), load=loads.sampled(t, torque))
/// >>> motion.omega[-1].round(5)
/// array([0. , 0. , 0.4])
#[pyfunction]
#[pyo3(signature = (t, torque, frame="body"))]
pub(crate) fn sampled(
    py: Python<'_>,
    t: &Bound<'_, PyAny>,
    torque: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] frame: &str,
) -> PyResult<PyLoad> {
    let axes = parse_frame(frame)?;
    let (times, values) = samples([t, torque], ["t", "torque"])?;
    let terms = try_series(py, &values, |series, watch| {
        Sampled::new_watched(&times, series, axes, watch).map(Term::Sampled)
    })?;
    let arguments = (
        numpy::PyArray1::from_vec(py, times),
        write(py, &values)?,
        frame,
    );
    let recipe = recipe(py, "sampled", arguments)?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(Sampled by sampled);

/// A load that is switched on and off at given times.
///
/// A simulation ends a step at each switch.
///
/// Parameters
/// ----------
/// load : Load
/// windows : array_like, shape (n, 2)
///     Times at which it is switched on and off, ascending and without overlap; the last may end at infinity.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A wheel whose motor runs for two seconds of ten:
///
/// >>> from polhode import loads, solids
/// >>> wheel = solids.cylinder(radius=1.0, height=0.2, mass=4.0)
/// >>> pulse = loads.schedule(loads.constant_torque((0, 0, 2)), [(1, 2), (5, 6)])
/// >>> wheel.simulate([0, 10], omega=(0, 0, 0), load=pulse).omega[-1].round(9)
/// array([0., 0., 2.])
#[pyfunction]
pub(crate) fn schedule(
    py: Python<'_>,
    load: &Bound<'_, PyLoad>,
    windows: &Bound<'_, PyAny>,
) -> PyResult<PyLoad> {
    schedule_load(py, load.get(), windows)
}

/// Matrices (..., 3, 3), or a number times the identity.
pub(super) fn matrices(
    object: &Bound<'_, PyAny>,
    name: &'static str,
) -> PyResult<Stack<Matrix3<f64>>> {
    let is_number = as_array(object, name)?
        .getattr("ndim")?
        .extract::<usize>()?
        == 0;
    if !is_number {
        return read(object, name);
    }
    let number: Stack<f64> = read(object, name)?;
    if !number[0].is_finite() {
        let error = Error::NonFinite {
            what: name,
            value: number[0],
        };
        return Err(to_py(object.py(), &error));
    }
    number.map(object.py(), |&x| Matrix3::from_diagonal_element(x))
}
