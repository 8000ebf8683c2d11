//! The function that makes the load of a controller.

use nalgebra::{UnitQuaternion, Vector3};
use polhode::motion::loads::{AttitudeTarget, Feedback, Term};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::load::PyLoad;
use super::made::made;
use super::part::Acts;
use super::recipe::recipe;
use super::terms::matrices;
use crate::arrays::{list_floats, read, read_scalar, write};
use crate::attitudes::read_attitude;
use crate::errors::to_py;
use crate::interrupt::watched;
use crate::orbits::Orbits;
use crate::stack::{Broadcast, Stack};

/// A controller that turns the body toward an attitude and damps it: ``-K sign(w) vec(e) - D (ω - ω_target)``.
///
/// ``e = target⁻¹ ∘ q`` is the quaternion of the rotation from the target to the body, and w is its scalar
/// part. For a small angle, vec(e) is half the angle times the axis. The factor sign(w) makes the body turn
/// the shorter way.
///
/// Parameters
/// ----------
/// K, D : array_like, shape (..., 3, 3), or a number
///     Gains in the body frame; a number stands for this number times the identity.
/// target : array_like, shape (..., 4), or rotation, or Orbit, or SampledOrbit, optional
///     Attitude R_NB to reach, as (x, y, z, w) or anything with ``as_quat()``; the identity by default. For
///     an orbit of :mod:`polhode.orbits` the target is its local frame, whose z axis points to the attractor.
/// rate : array_like, shape (..., 3), optional
///     Angular velocity of the target relative to space, components in space; zero by default.
/// times : array_like, shape (n,), optional
///     Times of the target, which then has the shape (n, 4). Between them the target follows cubic splines
///     through the components, normalised to unit length. Neighbouring attitudes must be less than a quarter
///     of a turn apart.
/// epoch : float, optional
///     Time at which a target with a rate has the attitude `target`; the start of a motion by default.
///
/// Returns
/// -------
/// Load
///     For a moving target the method "auto" is "dop853", and derivatives are by differences.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(1.0, (1, 2, 2.5))
/// >>> control = loads.feedback(K=8.0, D=4.0, target=(0, 0, 1, 0))
/// >>> motion = body.simulate([0, 40], omega=(0, 0, 0), attitude=(0.6, 0, 0, 0.8), load=control)
/// >>> np.abs(motion.quaternion[-1]).round(6)
/// array([0., 0., 1., 0.])
///
/// A ball follows a target that turns:
///
/// >>> from polhode import solids
/// >>> turning = loads.feedback(K=8.0, D=4.0, rate=(0, 0, 0.5))
/// >>> solids.sphere(1.0, mass=2.5).simulate([0, 40], omega=(0, 0, 0), load=turning).omega[-1].round(6)
/// array([0. , 0. , 0.5])
#[pyfunction]
#[pyo3(signature = (K, D, target=None, *, rate=None, times=None, epoch=None))]
#[expect(non_snake_case, reason = "the letters of the formula")]
pub(crate) fn feedback(
    py: Python<'_>,
    K: &Bound<'_, PyAny>,
    D: &Bound<'_, PyAny>,
    target: Option<&Bound<'_, PyAny>>,
    rate: Option<&Bound<'_, PyAny>>,
    times: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] epoch: Option<f64>,
) -> PyResult<PyLoad> {
    let (stiffness, damping) = (matrices(K, "K")?, matrices(D, "D")?);
    let kept = PyDict::new(py);
    let aims = aims(target, rate, times, epoch, &kept)?;
    let shapes = [&stiffness.shape[..], &damping.shape, &aims.shape];
    let grid = Broadcast::of(["K", "D", "target"], shapes)?;
    let terms = grid.try_map(py, |[k, d, a]| {
        Feedback::toward(&stiffness[k], &damping[d], aims[a].clone()).map(Term::Feedback)
    })?;
    let arguments = (write(py, &stiffness)?, write(py, &damping)?, kept);
    let recipe = recipe(py, "feedback", arguments)?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(Feedback by feedback);

/// The targets; what makes them again into `kept`.
fn aims(
    target: Option<&Bound<'_, PyAny>>,
    rate: Option<&Bound<'_, PyAny>>,
    times: Option<&Bound<'_, PyAny>>,
    epoch: Option<f64>,
    kept: &Bound<'_, PyDict>,
) -> PyResult<Stack<AttitudeTarget>> {
    let py = kept.py();
    let beside = |what: &str, with: &str| {
        Err(PyTypeError::new_err(format!(
            "{what}: not beside {with}; give one of the two"
        )))
    };
    if let Some(orbit) = target.filter(|target| Orbits::is(target)) {
        for (what, given) in [
            ("rate", rate.is_some()),
            ("times", times.is_some()),
            ("epoch", epoch.is_some()),
        ] {
            if given {
                return beside(what, "an orbit, which has its own");
            }
        }
        kept.set_item("target", orbit)?;
        return Orbits::read(orbit)?
            .paths
            .map(py, |path| AttitudeTarget::Down(path.clone()));
    }
    if let Some(times) = times {
        if rate.is_some() || epoch.is_some() {
            return beside("rate and epoch", "times=, which tell how the target moves");
        }
        let times = list_floats(times, "times", "n", &[])?;
        let times = times.as_slice()?;
        let samples = read_attitude(target, "target")?;
        if samples.shape != [times.len()] {
            return Err(PyValueError::new_err(format!(
                "target: expected an attitude for each of the {} times, shape ({}, 4), got shape {}",
                times.len(),
                times.len(),
                crate::shape::tuple(&[&samples.shape[..], &[4]].concat()),
            )));
        }
        let aim = watched(py, |watch| {
            AttitudeTarget::sampled_watched(times, &samples.rows, watch)
        })?;
        kept.set_item("times", times.to_vec())?;
        kept.set_item("target", as_given(target)?)?;
        return aim.map(Stack::one).map_err(|error| to_py(py, &error));
    }
    let attitude = read_attitude(target, "target")?;
    kept.set_item("target", as_given(target)?)?;
    let Some(rate) = rate else {
        if epoch.is_some() {
            return Err(PyTypeError::new_err(
                "epoch: it is that of a target with rate=",
            ));
        }
        return attitude.map(py, |attitude: &UnitQuaternion<f64>| {
            AttitudeTarget::Fixed(*attitude)
        });
    };
    let rate: Stack<Vector3<f64>> = read(rate, "rate")?;
    kept.set_item("rate", write(py, &rate)?)?;
    kept.set_item("epoch", epoch)?;
    Broadcast::of(["target", "rate"], [&attitude.shape, &rate.shape])?.try_map(py, |[q, w]| {
        AttitudeTarget::turning(&attitude[q], &rate[w], epoch)
    })
}

/// A copy of quaternions, not yet at unit length: a load that is made again from them has the same bits.
fn as_given<'py>(target: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(target) = target else {
        return Ok(None);
    };
    let numbers = if target.hasattr("as_quat")? {
        target.call_method0("as_quat")?
    } else {
        target.clone()
    };
    let numpy = crate::arrays::numpy(target.py())?;
    numpy.call_method1("array", (numbers, "float64")).map(Some)
}
