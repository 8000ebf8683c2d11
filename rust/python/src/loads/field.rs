//! The functions that make loads of fields: of gravity along an orbit, and magnetic ones.

use nalgebra::Vector3;
use polhode::motion::loads::{GravityGradient, Magnetic, MagneticField, Term};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::load::PyLoad;
use super::made::made;
use super::part::Acts;
use super::recipe::recipe;
use crate::arrays::{read, read_scalar, samples, try_rows, try_series, write};
use crate::orbits::Orbits;
use crate::stack::{Broadcast, Stack};

/// The torque of an attractor's field on a body in orbit.
///
/// ``N = 3 mu/r**5 r_B × (I_C r_B)``, where r is the vector from the attractor to the centre of mass. The
/// orbit is given: it does not depend on the attitude of the body, and it does not change ``position`` and
/// ``velocity`` of the trajectory. A Kepler orbit may be an ellipse, a parabola or a hyperbola, and is solved
/// exactly. For an orbit with ``j2`` the torque includes the term of J₂. Several attractors are a sum of such
/// loads.
///
/// Parameters
/// ----------
/// mu : array_like, shape (...), or Orbit, or SampledOrbit
///     Gravitational parameter of the attractor; or an orbit of :mod:`polhode.orbits`, without further
///     arguments. For an orbit with ``j2`` or from samples, the method "auto" is "dop853", and derivatives
///     are by differences.
/// position, velocity : array_like, shape (..., 3)
///     Position and velocity of the centre of mass relative to the attractor, in space, at the epoch.
/// epoch : float, optional
///     Time at which the orbit has that state; the first time of a simulation by default.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// The torque on a stick at an angle to the vertical turns it toward the vertical:
///
/// >>> from polhode import loads, rods
/// >>> pull = loads.gravity_gradient(1.0, (2.0, 0.0, 0.0), (0.0, 0.5, 0.0))
/// >>> stick = rods.rod(length=0.12, mass=1000.0).rotated((0.0, 0.9238795325112867, 0.0, 0.3826834323650898))
/// >>> pull.torque(0.0, (0, 0, 0), (0, 0, 0, 1), body=stick).round(6)
/// array([ 0.   , -0.225,  0.   ])
#[pyfunction]
#[pyo3(signature = (mu, position=None, velocity=None, epoch=None))]
pub(crate) fn gravity_gradient(
    py: Python<'_>,
    mu: &Bound<'_, PyAny>,
    position: Option<&Bound<'_, PyAny>>,
    velocity: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] epoch: Option<f64>,
) -> PyResult<PyLoad> {
    if Orbits::is(mu) {
        if position.is_some() || velocity.is_some() || epoch.is_some() {
            return Err(PyTypeError::new_err(
                "mu: an orbit has its own position, velocity and epoch; give it alone",
            ));
        }
        let part = |name: &str| mu.getattr(name);
        if !mu.hasattr("times")? && part("j2")?.is_none() {
            let (position, velocity) = (part("position")?, part("velocity")?);
            let epoch = part("epoch")?.extract()?;
            return gravity_gradient(py, &part("mu")?, Some(&position), Some(&velocity), epoch);
        }
        let Orbits { mu: number, paths } = Orbits::read(mu)?;
        let grid = Broadcast::of(["mu", "orbit"], [&number.shape, &paths.shape])?;
        let terms = grid.try_map(py, |[m, p]| {
            GravityGradient::along(number[m], paths[p].clone()).map(Term::GravityGradient)
        })?;
        let recipe = recipe(py, "gravity_gradient", (mu.clone(),))?;
        return Ok(PyLoad::one(Acts::Term(terms), recipe));
    }
    let (Some(position), Some(velocity)) = (position, velocity) else {
        return Err(PyTypeError::new_err(
            "gravity_gradient: give mu, position and velocity, or an orbit of polhode.orbits",
        ));
    };
    let mu: Stack<f64> = read(mu, "mu")?;
    let position: Stack<Vector3<f64>> = read(position, "position")?;
    let velocity: Stack<Vector3<f64>> = read(velocity, "velocity")?;
    let shapes = [&mu.shape[..], &position.shape, &velocity.shape];
    let grid = Broadcast::of(["mu", "position", "velocity"], shapes)?;
    let terms = grid.try_map(py, |[m, r, v]| {
        GravityGradient::new(mu[m], &position[r], &velocity[v], epoch).map(Term::GravityGradient)
    })?;
    let arguments = (
        write(py, &mu)?,
        write(py, &position)?,
        write(py, &velocity)?,
        epoch,
    );
    let recipe = recipe(py, "gravity_gradient", arguments)?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(GravityGradient by gravity_gradient);

/// The torque of a magnetic field on a body with a magnetic moment: ``N = m × B``.
///
/// Parameters
/// ----------
/// dipole : array_like, shape (..., 3)
///     Magnetic moment that is fixed in the body, components in the body frame.
/// field : array_like, shape (..., 3) or (..., n, 3), or DipoleField
///     B, components in space: uniform; known at `times`, with a cubic spline in between; or along an orbit,
///     as :meth:`polhode.orbits.Orbit.dipole_field` makes it.
/// gain : float or array_like, shape (...), optional
///     Gain k of the control law "B-dot": the moment is ``m = dipole - k dB/dt``, with the rate of B in the
///     body frame. It slows the rotation of the body down.
/// times : array_like, shape (n,), optional
///     Times of `field`, ascending.
///
/// Returns
/// -------
/// Load
///
/// Notes
/// -----
/// For a fixed moment in a uniform field the method "auto" is "taylor". For any other magnetic load "auto" is
/// "dop853", and derivatives are by differences: :meth:`polhode.Trajectory.sensitivity` with ``"differences"``.
///
/// Examples
/// --------
/// A compass needle swings about north:
///
/// >>> import numpy as np
/// >>> from polhode import RigidBody, loads
/// >>> needle = RigidBody.from_principal(1e-3, (1e-9, 1e-6, 1e-6))
/// >>> earth = loads.magnetic(dipole=(0.1, 0, 0), field=(4e-5, 0, 0))
/// >>> period = 2 * np.pi * np.sqrt(1e-6 / (0.1 * 4e-5))
/// >>> quarter = needle.simulate([0, period / 4], (0, 0, 0), (0, 0, 1e-4, 1), load=earth)
/// >>> bool(abs(quarter.quaternion[-1, 2]) < 1e-11)
/// True
#[pyfunction]
#[pyo3(signature = (dipole, field, *, gain=None, times=None))]
pub(crate) fn magnetic(
    py: Python<'_>,
    dipole: &Bound<'_, PyAny>,
    field: &Bound<'_, PyAny>,
    gain: Option<&Bound<'_, PyAny>>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyLoad> {
    let moments: Stack<Vector3<f64>> = read(dipole, "dipole")?;
    let gains: Stack<Option<f64>> = match gain {
        None => Stack::one(None),
        Some(gain) => read::<f64>(gain, "gain")?.map(py, |&gain| Some(gain))?,
    };
    let fields = fields(py, field, times)?;
    let shapes = [&moments.shape[..], &gains.shape, &fields.shape];
    let grid = Broadcast::of(["dipole", "gain", "field"], shapes)?;
    let terms = grid.try_map(py, |[d, k, b]| {
        Magnetic::new(&moments[d], gains[k], fields[b].clone()).map(Term::Magnetic)
    })?;
    // Arrays are copied; a field along an orbit never changes.
    let numpy = crate::arrays::numpy(py)?;
    let kept = |given: &Bound<'_, PyAny>| -> PyResult<Py<PyAny>> {
        Ok(numpy.call_method1("array", (given, "float64"))?.unbind())
    };
    let field = if field.hasattr("orbit")? {
        field.clone().unbind()
    } else {
        kept(field)?
    };
    let options = PyDict::new(py);
    options.set_item("gain", gain.map(&kept).transpose()?)?;
    options.set_item("times", times.map(kept).transpose()?)?;
    let arguments = (write(py, &moments)?, field, options);
    let recipe = recipe(py, "magnetic", arguments)?;
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(Magnetic by magnetic);

/// One field or a stack of them.
fn fields(
    py: Python<'_>,
    field: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<Stack<MagneticField>> {
    if let (Ok(orbit), Ok(strength)) = (field.getattr("orbit"), field.getattr("strength")) {
        if times.is_some() {
            return Err(PyTypeError::new_err(
                "times: not beside a field along an orbit, which is known at all times",
            ));
        }
        let orbits = Orbits::read(&orbit)?;
        let strength: Stack<Vector3<f64>> = read(&strength, "strength")?;
        let shapes = [&orbits.paths.shape[..], &strength.shape];
        return Broadcast::of(["orbit", "strength"], shapes)?.try_map(py, |[o, s]| {
            MagneticField::of_dipole(&strength[s], orbits.paths[o].clone())
        });
    }
    let Some(times) = times else {
        let fields: Stack<Vector3<f64>> = read(field, "field")?;
        return try_rows(py, &fields, MagneticField::uniform);
    };
    let (times, values) = samples([times, field], ["times", "field"])?;
    try_series(py, &values, |series, watch| {
        MagneticField::sampled_watched(&times, series, watch)
    })
}
