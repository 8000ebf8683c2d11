//! Kepler orbits: states at any time, fields along them, and what loads read of an orbit of Python.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::motion::loads::kepler::Orbit;
use polhode::motion::loads::magnetic::field_and_rate;
use pyo3::prelude::*;

use crate::arrays::{read, write, write_of};
use crate::stack::{Broadcast, Stack};

/// An array of float64.
type Floats<'py> = Bound<'py, PyArrayDyn<f64>>;

/// What an orbit of `polhode.orbits` is made of.
pub(crate) struct Orbits {
    pub(crate) stack: Stack<Orbit>,
    pub(crate) epoch: Option<f64>,
}

impl Orbits {
    /// From an object with the attributes of one.
    pub(crate) fn read(orbit: &Bound<'_, PyAny>) -> PyResult<Self> {
        let part = |name: &str| orbit.getattr(name);
        Ok(Self {
            stack: through(
                orbit.py(),
                &part("mu")?,
                &part("position")?,
                &part("velocity")?,
            )?,
            epoch: part("epoch")?.extract()?,
        })
    }
}

/// The orbits through states.
pub(crate) fn through(
    py: Python<'_>,
    mu: &Bound<'_, PyAny>,
    position: &Bound<'_, PyAny>,
    velocity: &Bound<'_, PyAny>,
) -> PyResult<Stack<Orbit>> {
    let mu: Stack<f64> = read(mu, "mu")?;
    let position: Stack<Vector3<f64>> = read(position, "position")?;
    let velocity: Stack<Vector3<f64>> = read(velocity, "velocity")?;
    let shapes = [&mu.shape[..], &position.shape, &velocity.shape];
    Broadcast::of(["mu", "position", "velocity"], shapes)?.try_map(py, |[m, r, v]| {
        Orbit::new(mu[m], &position[r], &velocity[v])
    })
}

/// Position and velocity on Kepler orbits, a time after the state that they are given by.
///
/// Parameters
/// ----------
/// mu, elapsed : array_like, shape (...)
/// position, velocity : array_like, shape (..., 3)
///
/// Returns
/// -------
/// tuple of numpy.ndarray, shape (..., 3)
#[pyfunction]
pub(crate) fn kepler_states<'py>(
    py: Python<'py>,
    mu: &Bound<'py, PyAny>,
    position: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
    elapsed: &Bound<'py, PyAny>,
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let orbits = through(py, mu, position, velocity)?;
    let elapsed: Stack<f64> = read(elapsed, "t")?;
    let shapes = [&orbits.shape[..], &elapsed.shape];
    let found = Broadcast::of(["orbit", "t"], shapes)?
        .try_map(py, |[o, t]| Ok(orbits[o].at(elapsed[t])))?;
    Ok((
        write_of(py, &found, |state| state.0)?,
        write_of(py, &found, |state| state.1)?,
    ))
}

/// The time of a revolution of Kepler orbits; infinite but for ellipses.
///
/// Parameters
/// ----------
/// mu : array_like, shape (...)
/// position, velocity : array_like, shape (..., 3)
///
/// Returns
/// -------
/// numpy.ndarray, shape (...)
#[pyfunction]
pub(crate) fn kepler_period<'py>(
    py: Python<'py>,
    mu: &Bound<'py, PyAny>,
    position: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
) -> PyResult<Floats<'py>> {
    write_of(py, &through(py, mu, position, velocity)?, Orbit::period)
}

/// The magnetic field at a position from a dipole: ``3 (M·r) r/r**5 - M/r**3``.
///
/// Parameters
/// ----------
/// strength, position : array_like, shape (..., 3)
///     M: the moment of the dipole times μ₀/4π.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3)
#[pyfunction]
pub(crate) fn dipole_field<'py>(
    py: Python<'py>,
    strength: &Bound<'py, PyAny>,
    position: &Bound<'py, PyAny>,
) -> PyResult<Floats<'py>> {
    let strength: Stack<Vector3<f64>> = read(strength, "strength")?;
    let position: Stack<Vector3<f64>> = read(position, "position")?;
    let found = Broadcast::of(["strength", "position"], [&strength.shape, &position.shape])?
        .try_map(py, |[m, r]| {
            Ok(field_and_rate(&strength[m], &position[r], &Vector3::zeros())[0])
        })?;
    write(py, &found)
}
