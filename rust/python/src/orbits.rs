//! Kepler orbits: states at any time, fields along them, and what loads read of an orbit of Python.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::motion::attitude::components;
use polhode::motion::loads::kepler::Orbit;
use polhode::motion::loads::magnetic::field_and_rate;
use polhode::motion::loads::{Oblate, OrbitModel};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{list_floats, read, read_list, samples, try_rows, try_series, write, write_of};
use crate::errors::to_py;
use crate::interrupt::Beat;
use crate::memory;
use crate::stack::{BLOCK, Broadcast, Stack, try_watched};

/// An array of float64.
type Floats<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Where a body is, from an attractor, of an orbit of `polhode.orbits`, with its μ.
pub(crate) struct Orbits {
    pub(crate) mu: Stack<f64>,
    pub(crate) paths: Stack<OrbitModel>,
}

impl Orbits {
    /// Whether an object is an orbit, of any kind.
    pub(crate) fn is(object: &Bound<'_, PyAny>) -> bool {
        matches!(object.hasattr("dipole_field"), Ok(true))
    }

    /// From an object with the attributes of one.
    pub(crate) fn read(orbit: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = orbit.py();
        if !Self::is(orbit) {
            return Err(PyTypeError::new_err(format!(
                "orbit: expected one of polhode.orbits, got {}",
                orbit.get_type()
            )));
        }
        let part = |name: &str| orbit.getattr(name);
        let mu: Stack<f64> = read(&part("mu")?, "mu")?;
        if orbit.hasattr("times")? {
            let velocity = part("velocity")?;
            let velocity = Some(&velocity).filter(|velocity| !velocity.is_none());
            let mut paths = sampled(py, &part("times")?, &part("position")?, velocity)?;
            let j2 = part("j2")?;
            if !j2.is_none() {
                let bulges = Bulges::read([&j2, &part("radius")?, &part("pole")?])?;
                paths = bulges.below(py, &paths)?;
            }
            return Ok(Self { mu, paths });
        }
        let epoch: Option<f64> = part("epoch")?.extract()?;
        let orbits = through(py, &part("mu")?, &part("position")?, &part("velocity")?)?;
        let j2 = part("j2")?;
        let paths = if j2.is_none() {
            try_rows(py, &orbits, |orbit| OrbitModel::kepler(orbit, epoch))?
        } else {
            let bulges = Bulges::read([&j2, &part("radius")?, &part("pole")?])?;
            bulges.around(py, &orbits, epoch)?
        };
        Ok(Self { mu, paths })
    }
}

/// J₂, radius and pole of attractors.
struct Bulges {
    j2: Stack<f64>,
    radius: Stack<f64>,
    pole: Stack<Vector3<f64>>,
}

impl Bulges {
    fn read([j2, radius, pole]: [&Bound<'_, PyAny>; 3]) -> PyResult<Self> {
        Ok(Self {
            j2: read(j2, "j2")?,
            radius: read(radius, "radius")?,
            pole: read(pole, "pole")?,
        })
    }

    /// The orbits about them.
    fn around(
        &self,
        py: Python<'_>,
        orbits: &Stack<Orbit>,
        epoch: Option<f64>,
    ) -> PyResult<Stack<OrbitModel>> {
        self.each(py, orbits, |orbit, j2, radius, pole| {
            OrbitModel::oblate(Oblate::new(orbit, j2, radius, pole)?, epoch)
        })
    }

    /// Samples about them.
    fn below(&self, py: Python<'_>, paths: &Stack<OrbitModel>) -> PyResult<Stack<OrbitModel>> {
        self.each(py, paths, |path, j2, radius, pole| {
            path.clone().about_oblate(j2, radius, pole)
        })
    }

    fn each<T: Sync>(
        &self,
        py: Python<'_>,
        orbits: &Stack<T>,
        make: impl Fn(&T, f64, f64, &Vector3<f64>) -> Result<OrbitModel, Error> + Sync,
    ) -> PyResult<Stack<OrbitModel>> {
        let names = ["orbit", "j2", "radius", "pole"];
        let shapes = [
            &orbits.shape[..],
            &self.j2.shape,
            &self.radius.shape,
            &self.pole.shape,
        ];
        Broadcast::of(names, shapes)?.try_map(py, |[o, j, r, p]| {
            make(&orbits[o], self.j2[j], self.radius[r], &self.pole[p])
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
    let found = Broadcast::of(["orbit", "t"], shapes)?.try_map(py, |[o, t]| {
        orbits[o].check(elapsed[t])?;
        Ok(orbits[o].at(elapsed[t]))
    })?;
    Ok((
        write_of(py, &found, |state| state.0)?,
        write_of(py, &found, |state| state.1)?,
    ))
}

/// Position and velocity on orbits about oblate attractors, a time after the state that they are given by.
///
/// Parameters
/// ----------
/// mu, j2, radius : array_like, shape (...)
/// position, velocity, pole : array_like, shape (..., 3)
/// elapsed : array_like, shape (n,)
///
/// Returns
/// -------
/// tuple of numpy.ndarray, shape (..., n, 3)
///     Not numbers where an orbit has fallen into the attractor.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the numbers of an orbit")]
pub(crate) fn oblate_states<'py>(
    py: Python<'py>,
    mu: &Bound<'py, PyAny>,
    position: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
    j2: &Bound<'py, PyAny>,
    radius: &Bound<'py, PyAny>,
    pole: &Bound<'py, PyAny>,
    elapsed: &Bound<'py, PyAny>,
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let orbits = through(py, mu, position, velocity)?;
    let paths = Bulges::read([j2, radius, pole])?.around(py, &orbits, None)?;
    let elapsed = list_floats(elapsed, "t", "n", &[])?;
    let elapsed = elapsed.as_slice()?;
    let far = elapsed.iter().fold(0.0, |far: f64, t| far.max(t.abs()));
    for path in &paths.rows {
        path.check(0.0, 0.0, far)
            .map_err(|error| to_py(py, &error))?;
    }
    states(py, &paths, elapsed)
}

/// The curves through positions, and velocities where there are any, at some times.
fn sampled(
    py: Python<'_>,
    times: &Bound<'_, PyAny>,
    position: &Bound<'_, PyAny>,
    velocity: Option<&Bound<'_, PyAny>>,
) -> PyResult<Stack<OrbitModel>> {
    let (times, positions) = samples([times, position], ["t", "position"])?;
    let Some(velocity) = velocity else {
        return try_series(py, &positions, |row, watch| {
            OrbitModel::sampled_watched(&times, row, None, watch)
        });
    };
    let velocities: Stack<Vector3<f64>> = read_list(velocity, "velocity", "..., n")?;
    if velocities.shape != positions.shape {
        return Err(PyValueError::new_err(format!(
            "velocity: expected one for each position, {:?} of them, got {:?}",
            positions.shape, velocities.shape
        )));
    }
    let count = times.len();
    let shape = positions.shape[..positions.shape.len() - 1].to_vec();
    let both = (positions.rows.chunks(count.max(1))).zip(velocities.rows.chunks(count.max(1)));
    try_watched(py, shape, both, |(row, speeds), watch| {
        OrbitModel::sampled_watched(&times, row, Some(speeds), watch)
    })
}

/// Position and velocity along cubic splines through positions at some times, or quintics through positions and velocities.
///
/// Parameters
/// ----------
/// times : array_like, shape (n,)
/// position : array_like, shape (..., n, 3)
/// t : array_like, shape (m,)
/// velocity : array_like, shape (..., n, 3), optional
///
/// Returns
/// -------
/// tuple of numpy.ndarray, shape (..., m, 3)
#[pyfunction]
#[pyo3(signature = (times, position, t, velocity=None))]
pub(crate) fn sampled_states<'py>(
    py: Python<'py>,
    times: &Bound<'py, PyAny>,
    position: &Bound<'py, PyAny>,
    t: &Bound<'py, PyAny>,
    velocity: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let paths = sampled(py, times, position, velocity)?;
    let asked = list_floats(t, "t", "n", &[])?;
    let asked = asked.as_slice()?;
    // All paths have the same times.
    if let Some(path) = paths.rows.first() {
        (asked.iter().try_for_each(|&t| path.check(0.0, t, t)))
            .map_err(|error| to_py(py, &error))?;
    }
    states(py, &paths, asked)
}

/// The frame that points down, and its angular velocity, on orbits of `polhode.orbits` at times.
///
/// Parameters
/// ----------
/// orbit : Orbit or SampledOrbit
/// t : array_like, shape (n,)
///
/// Returns
/// -------
/// quaternion : numpy.ndarray, shape (..., n, 4)
/// omega : numpy.ndarray, shape (..., n, 3)
#[pyfunction]
pub(crate) fn local_frames<'py>(
    py: Python<'py>,
    orbit: &Bound<'py, PyAny>,
    t: &Bound<'py, PyAny>,
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let paths = Orbits::read(orbit)?.paths;
    let t = list_floats(t, "t", "n", &[])?;
    let t = t.as_slice()?;
    for path in &paths.rows {
        (t.iter().try_for_each(|&t| path.check(0.0, t, t))).map_err(|error| to_py(py, &error))?;
    }
    let found = at_times(py, &paths, t, |path, t| path.frame(0.0, t))?;
    Ok((
        write_of(py, &found, |(attitude, _)| components(attitude))?,
        write_of(py, &found, |(_, rate)| *rate)?,
    ))
}

/// Position and velocity on each path at each of some times; an epoch that there is none of is zero.
fn states<'py>(
    py: Python<'py>,
    paths: &Stack<OrbitModel>,
    times: &[f64],
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let found = at_times(py, paths, times, |path, t| path.at(0.0, t))?;
    Ok((
        write_of(py, &found, |state| state.0)?,
        write_of(py, &found, |state| state.1)?,
    ))
}

/// What is known of each path at each of some times.
fn at_times<T>(
    py: Python<'_>,
    paths: &Stack<OrbitModel>,
    times: &[f64],
    known: impl Fn(&OrbitModel, f64) -> T,
) -> PyResult<Stack<T>> {
    let shape = [&paths.shape[..], &[times.len()]].concat();
    let mut rows = memory::vector("result", &shape, 1)?;
    let mut beat = Beat::new(py);
    for path in &paths.rows {
        for row in times.chunks(BLOCK) {
            beat.mark()?;
            rows.extend(row.iter().map(|&t| known(path, t)));
        }
    }
    Ok(Stack { shape, rows })
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
    // Of the shortest vectors too, whose squares vanish.
    if position.rows.iter().any(|r| r.norm() == 0.0) {
        return Err(PyValueError::new_err(
            "position: the field of a dipole is infinite at its centre; give a position outside of the planet",
        ));
    }
    let found = Broadcast::of(["strength", "position"], [&strength.shape, &position.shape])?
        .try_map(py, |[m, r]| {
            Ok(field_and_rate(&strength[m], &position[r], &Vector3::zeros())[0])
        })?;
    write(py, &found)
}
