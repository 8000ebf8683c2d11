//! The functions of `polhode.loads` that make a load of one analytic law, with their documentation.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::Error;
use polhode::motion::loads::{
    AttitudeTarget, Damping, Feedback, GravityGradient, Magnetic, MagneticField, Moment, Pulses,
    Rotor, Sampled, Slug, Term, Thrusters,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::address::Compiled;
use super::callbacks::{self, Callback, MOST_STATES, ReturnKind, WithStates, check_name};
use super::firing::Firing;
use super::load::{LoadPart, PyLoad, schedule_load};
use super::pickle_recipe::recipe;
use super::registry::register;
use super::wheel::controller_terms;
use crate::arrays::{
    as_array, copy_of, list_floats, read, read_list, read_scalar, samples, try_rows, try_series,
    write, write_of,
};
use crate::attitudes::read_attitude;
use crate::errors::to_py;
use crate::interrupt::watched;
use crate::kinematics::parse_frame;
use crate::orbits::Orbits;
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

// The function that makes the load of a controller.

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
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(Feedback by feedback);

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
                tuple(&[&samples.shape[..], &[4]].concat()),
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
    copy_of(&numbers).map(Some)
}

// The functions that make loads of fields: of gravity along an orbit, and magnetic ones.

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
        return Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe));
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
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(GravityGradient by gravity_gradient);

/// The torque of a magnetic field on a body with a magnetic moment: ``N = m × B``.
///
/// Parameters
/// ----------
/// dipole : array_like, shape (..., 3) or (..., n, 3), or Load
///     Magnetic moment in the body frame, of a magnet or of coils: constant; known at `dipole_times`, where each value
///     holds until the next time; or a controller, as :func:`wheel` takes it. Of the torque N that the
///     controller asks for the coils exert the part across the field: ``m = B × N/|B|**2``.
/// field : array_like, shape (..., 3) or (..., n, 3), or DipoleField
///     B, components in space: uniform; known at `times`, with a cubic spline in between; or along an orbit,
///     as :meth:`polhode.orbits.Orbit.dipole_field` makes it.
/// gain : float or array_like, shape (...), optional
///     Gain k of the control law "B-dot": the moment is ``m = dipole - k dB/dt``, with the rate of B in the
///     body frame. It slows the rotation of the body down.
/// times : array_like, shape (n,), optional
///     Times of `field`, ascending.
/// dipole_times : array_like, shape (n,), optional
///     Times of `dipole`, ascending.
/// max_dipole : float or array_like, shape (..., 3), optional
///     Largest moment of the three coils, along the axes of the body frame: each component of m is clipped to it.
///     :meth:`polhode.Event.dipole_limit` finds when that begins and ends. Coils along other axes are loads of their own.
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
///
/// Three coils of 0.2 A m² damp a rotation. The part along the field stays:
///
/// >>> satellite = RigidBody.from_principal(10.0, (0.3, 0.4, 0.5))
/// >>> coils = loads.magnetic(loads.feedback(K=0, D=1e-3), field=(0, 0, 4e-5), max_dipole=0.2)
/// >>> satellite.simulate([0, 1e5], (0.03, 0, 0), load=coils).omega[-1].round(6) + 0.0
/// array([0., 0., 0.])
#[pyfunction]
#[pyo3(signature = (dipole, field, *, gain=None, times=None, dipole_times=None, max_dipole=None))]
pub(crate) fn magnetic(
    py: Python<'_>,
    dipole: &Bound<'_, PyAny>,
    field: &Bound<'_, PyAny>,
    gain: Option<&Bound<'_, PyAny>>,
    times: Option<&Bound<'_, PyAny>>,
    dipole_times: Option<&Bound<'_, PyAny>>,
    max_dipole: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyLoad> {
    let controller = dipole.cast::<PyLoad>().ok();
    let moments: Stack<(Moment, Vec<Term>)> = match (&controller, dipole_times) {
        (Some(load), None) => controller_terms(py, load.get())?
            .map(py, |row| (Moment::Commanded(1.0), row.clone()))?,
        (Some(_), Some(_)) => {
            return Err(PyTypeError::new_err(
                "dipole_times: not beside a controller; loads.schedule(...) makes one that acts at times",
            ));
        }
        (None, Some(times)) => {
            let (times, values) = samples([times, dipole], ["dipole_times", "dipole"])?;
            try_series(py, &values, |series, _| {
                Ok((Moment::table(&times, series)?, Vec::new()))
            })?
        }
        (None, None) => {
            let moments: Stack<Vector3<f64>> = read(dipole, "dipole")?;
            moments.map(py, |moment| (Moment::Fixed(*moment), Vec::new()))?
        }
    };
    let gains: Stack<Option<f64>> = match gain {
        None => Stack::one(None),
        Some(gain) => read::<f64>(gain, "gain")?.map(py, |&gain| Some(gain))?,
    };
    let limits: Stack<Option<Vector3<f64>>> = match max_dipole {
        None => Stack::one(None),
        Some(given) => vectors(given, "max_dipole")?.map(py, |most| Some(*most))?,
    };
    let fields = fields(py, field, times)?;
    let shapes = [
        &moments.shape[..],
        &gains.shape,
        &fields.shape,
        &limits.shape,
    ];
    let grid = Broadcast::of(["dipole", "gain", "field", "max_dipole"], shapes)?;
    let is_controlled = controller.is_some();
    let terms = grid.try_map(py, |[d, k, b, l]| {
        let (moment, asks) = moments[d].clone();
        let mut coils = Magnetic::of(moment, gains[k], fields[b].clone())?;
        if let Some(most) = &limits[l] {
            coils = coils.with_max_dipole(most)?;
        }
        if is_controlled {
            Term::controlled_coils(coils, asks)
        } else {
            Ok(Term::Magnetic(coils))
        }
    })?;
    // Arrays are copied; a field along an orbit never changes, nor does a controller.
    let field = if field.hasattr(intern!(py, "orbit"))? {
        field.clone()
    } else {
        copy_of(field)?
    };
    let dipole = if controller.is_some() {
        dipole.clone()
    } else {
        copy_of(dipole)?
    };
    let options = PyDict::new(py);
    for (name, given) in [
        (intern!(py, "gain"), gain),
        (intern!(py, "times"), times),
        (intern!(py, "dipole_times"), dipole_times),
        (intern!(py, "max_dipole"), max_dipole),
    ] {
        if let Some(given) = given {
            options.set_item(name, copy_of(given)?)?;
        }
    }
    let recipe = recipe(py, "magnetic", (dipole, field, options))?;
    let mut load = PyLoad::one(LoadPart::Term(terms.into()), recipe);
    if let Some(controller) = controller.filter(|one| !one.get().is_analytic())
        && let Some(part) = load.parts.first_mut()
    {
        part.controller = Some(controller.clone().unbind());
    }
    Ok(load)
}

register!(Magnetic by magnetic);

/// One field or a stack of them.
fn fields(
    py: Python<'_>,
    field: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<Stack<MagneticField>> {
    if field.hasattr(intern!(py, "orbit"))?
        && let (Ok(orbit), Ok(strength)) = (field.getattr("orbit"), field.getattr("strength"))
    {
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

// The function that makes thrusters.

/// Thrusters that fire in pulses: in each period from its start on, for a part of it.
///
/// Each exerts a force at a point of the body, so that it turns the body and pushes it. The duty of a thruster
/// is the part of a period in which it fires, from 0 to 1. The duties are known at the start of a period, and
/// with them the times at which the thrusters are switched off. A simulation ends a step at each switch, so the
/// times are exact.
///
/// Parameters
/// ----------
/// positions : array_like, shape (n, 3)
///     Points where the forces act, in the body frame. At most 25 thrusters.
/// directions : array_like, shape (n, 3)
///     Directions of the forces on the body, against the exhaust, in the body frame. The lengths do not count.
/// forces : array_like, shape () or (n,)
///     Force of a thruster that fires.
/// command : array_like, shape (n,) or (k, n), or callable
///     Duties. An array of shape (n,) is for all periods. Of an array of shape (k, n) each row is for the periods
///     that start at the same one of `times`, or later. A function
///     ``command(t, omega, quaternion, position, velocity, states)`` returns n numbers. It is called at the
///     start of each period, with the arguments of the functions of :func:`with_states`. Duties below 0 count
///     as 0, and those above 1 as 1.
/// period : float
///     Time from the start of one period to the next one. The first period starts with the motion.
/// min_on : float, optional
///     Shortest time for which a thruster can fire. If a pulse would be shorter, the thruster does not fire.
/// max_on : float, optional
///     Longest time for which a thruster can fire in a period; the period by default.
/// deadband : float, optional
///     With it the thrusters are on or off: one with a duty of `deadband` or more fires for `max_on`, one with
///     less does not fire.
/// times : array_like, shape (k,), optional
///     Times of a `command` of shape (k, n), ascending.
/// name : str, optional
///     Name of the states.
///
/// Returns
/// -------
/// Load
///     Its states in ``states`` of a trajectory are the impulses of the thrusters since the start, force times
///     time of firing, shape (n,), under `name`; and the lengths of the pulses of the period under way under
///     `name` with ``_pulse``.
///
/// Notes
/// -----
/// The mass of the propellant that a thruster has used is its impulse divided by its specific impulse (a
/// speed; of a value in seconds, that times 9.80665 m/s²). The mass of the body does not change.
///
/// :meth:`polhode.Event.pulse` finds when a thruster is switched on and off.
///
/// Examples
/// --------
/// A pair of thrusters turns a satellite. A controller asks every 0.1 s for the torque ``-0.4 ω``, of which each
/// thruster can do one sign:
///
/// >>> import numpy as np
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(90.0, (8.0, 9.0, 10.0))
/// >>> def duties(t, omega, *_):
/// ...     return np.array([-0.4, 0.4]) * omega[2] / (0.5 * 0.02)
/// >>> arms, along = [(0.5, 0, 0), (0.5, 0, 0)], [(0, 1, 0), (0, -1, 0)]
/// >>> jets = loads.thrusters(arms, along, 0.02, command=duties, period=0.1, min_on=0.01)
/// >>> motion = body.simulate([0, 120], omega=(0, 0, 0.05), load=jets)
/// >>> bool(abs(motion.omega[-1, 2]) < 0.0026)
/// True
/// >>> impulse = motion.states["thrusters"][-1]
/// >>> bool(np.isclose(0.5 * (impulse[1] - impulse[0]), 10.0 * (0.05 - motion.omega[-1, 2])))
/// True
/// >>> propellant = impulse.sum() / (70 * 9.80665)  # in kg, for a specific impulse of 70 s
#[pyfunction]
#[pyo3(signature = (positions, directions, forces, *, command, period, min_on=None, max_on=None, deadband=None, times=None,
                   name="thrusters"))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
#[expect(clippy::doc_link_with_quotes, reason = "the name of a state in Python")]
pub(crate) fn thrusters(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
    forces: &Bound<'_, PyAny>,
    command: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] period: f64,
    #[pyo3(from_py_with = read_scalar)] min_on: Option<f64>,
    #[pyo3(from_py_with = read_scalar)] max_on: Option<f64>,
    #[pyo3(from_py_with = read_scalar)] deadband: Option<f64>,
    times: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<PyLoad> {
    check_name(name)?;
    let at: Stack<Vector3<f64>> = read_list(positions, "positions", "n")?;
    let along: Stack<Vector3<f64>> = read_list(directions, "directions", "n")?;
    let count = at.rows.len();
    let most = MOST_STATES / 2;
    if count == 0 || count > most {
        return Err(PyValueError::new_err(format!(
            "positions: expected from 1 to {most} thrusters, got {count}; loads with more of them can be added"
        )));
    }
    if along.rows.len() != count {
        return Err(PyValueError::new_err(format!(
            "directions: expected one for each of the {count} thrusters, got {}",
            along.rows.len()
        )));
    }
    let given: Stack<f64> = read(forces, "forces")?;
    let each = match given.shape[..] {
        [] => vec![given[0]; count],
        [found] if found == count => given.rows.clone(),
        _ => {
            return Err(PyValueError::new_err(format!(
                "forces: expected one number, or one for each of the {count} thrusters, got the shape {}",
                tuple(&given.shape)
            )));
        }
    };
    let core = |error: &Error| to_py(py, error);
    let pulses =
        Pulses::new(period, min_on.unwrap_or(0.0), max_on, deadband).map_err(|e| core(&e))?;
    let set = Thrusters::new(&at.rows, &along.rows, &each, pulses).map_err(|e| core(&e))?;
    if command.is_instance_of::<PyLoad>() {
        return Err(PyTypeError::new_err(
            "command: a load asks for a torque, not for duties; give a function \
             command(t, omega, quaternion, position, velocity, states) that returns the duty of each thruster",
        ));
    }
    let firing = Firing::new(set, command, times)?;
    let options = PyDict::new(py);
    if firing.calls_python() {
        options.set_item("command", command)?;
    } else {
        options.set_item("command", copy_of(command)?)?;
    }
    options.set_item("period", period)?;
    for (what, given) in [
        ("min_on", min_on),
        ("max_on", max_on),
        ("deadband", deadband),
    ] {
        options.set_item(what, given)?;
    }
    options.set_item("times", times.map(copy_of).transpose()?)?;
    options.set_item("name", name)?;
    let arguments = (
        write(py, &at)?,
        write(py, &along)?,
        copy_of(forces)?,
        options,
    );
    let recipe = recipe(py, "thrusters", arguments)?;
    Ok(PyLoad::one(LoadPart::Thrusters(firing), recipe).with_name(name))
}

// The functions that make loads of functions: of Python's and of compiled ones.

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
    load(function, "torque_callback", ReturnKind::Torque)
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
    load(function, "callback", ReturnKind::ForceAndTorque)
}

fn load(function: &Bound<'_, PyAny>, name: &str, gives: ReturnKind) -> PyResult<PyLoad> {
    let callback = Callback::new(function, gives)?;
    let recipe = recipe(function.py(), name, (function,))?;
    Ok(PyLoad::one(LoadPart::Callback(callback), recipe))
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
        Some(initial) => callbacks::initial_values(initial, scale)?,
        None if scale.is_some() => {
            return Err(PyTypeError::new_err(
                "scale: give initial= too: the function has no states",
            ));
        }
        None => (Vec::new(), Vec::new()),
    };
    check_name(name)?;
    let compiled = Compiled::new(function, user_data, own)?;
    let recipe = recipe(function.py(), "_unpicklable", (function,))?;
    Ok(PyLoad::one(LoadPart::Compiled(compiled), recipe).with_name(name))
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
    let (values, scales) = callbacks::initial_values(initial, scale)?;
    check_name(name)?;
    let own = (values.clone(), scales.clone());
    let load = WithStates::new([rates, wrench, update], period, own)?;
    let options = PyDict::new(py);
    options.set_item("update", update)?;
    options.set_item("period", period)?;
    options.set_item("scale", scales)?;
    let recipe = recipe(py, "with_states", (rates, values, wrench, name, options))?;
    Ok(PyLoad::one(LoadPart::WithStates(load), recipe).with_name(name))
}

// The functions that make analytic terms.

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
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(ConstantTorque by constant_torque);

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
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(ConstantForce by constant_force);

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
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(UniformGravity by uniform_gravity);

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
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(Damping by damping);

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
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(Sampled by sampled);

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

/// Return whether there is one number, without axes.
fn is_number(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<bool> {
    let axes: usize = as_array(object, name)?.getattr("ndim")?.extract()?;
    Ok(axes == 0)
}

/// Vectors (..., 3), or a number for all components.
fn vectors(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Stack<Vector3<f64>>> {
    if !is_number(object, name)? {
        return read(object, name);
    }
    let number: Stack<f64> = read(object, name)?;
    number.map(object.py(), |&x| Vector3::repeat(x))
}

/// Matrices (..., 3, 3), or a number times the identity.
pub(super) fn matrices(
    object: &Bound<'_, PyAny>,
    name: &'static str,
) -> PyResult<Stack<Matrix3<f64>>> {
    if !is_number(object, name)? {
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

// The functions that make loads which the body carries along: rotors, wheels, slugs.

/// A rotor whose angular momentum h is constant in the body; its torque on the body is ``-ω × h``.
///
/// A body with such a rotor is called a gyrostat. The angular momentum of a trajectory includes h. Its kinetic
/// energy does not include the energy of the rotor: it is ``½ ω·I ω``, which is constant if nothing else acts.
///
/// Parameters
/// ----------
/// momentum : array_like, shape (..., 3)
///     h of the rotor relative to the body, in the body frame: ``J Ω`` along its axis.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A wheel turns fast about the third axis of a body, and the body turns slowly about its first axis. No torque
/// acts. The body then nutates; the total angular momentum and the energy stay constant:
///
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
/// >>> motion = body.simulate([0, 50, 100], omega=(0.1, 0, 0), load=loads.rotor((0, 0, 20)), rtol=1e-13)
/// >>> motion.angular_momentum().spin.round(9)[-1] + 0.0
/// array([ 0.1,  0. , 20. ])
/// >>> bool(motion.invariants().energy_drift < 1e-11)
/// True
#[pyfunction]
pub(crate) fn rotor(py: Python<'_>, momentum: &Bound<'_, PyAny>) -> PyResult<PyLoad> {
    let momentum: Stack<Vector3<f64>> = read(momentum, "momentum")?;
    let terms = try_rows(py, &momentum, |h| Rotor::new(h).map(Term::Rotor))?;
    let recipe = recipe(py, "rotor", (write(py, &momentum)?,))?;
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(Rotor by rotor);

/// A spherical damper: a ball (the slug) in a viscous fluid inside the body. It dissipates energy at constant
/// angular momentum.
///
/// Its states are σ, the angular velocity of the slug relative to space, components in the body frame. At the
/// start σ is the angular velocity of the body, unless `simulate` is given another by ``states``. The states
/// obey ``J σ̇ + ω × J σ = -k (σ - ω)``; the torque on the body is ``k (σ - ω)``. The slug is a simple model
/// for everything loose or flexible in a body: nutation is damped, and a long body that spins about its long
/// axis goes over into a flat spin.
///
/// Parameters
/// ----------
/// inertia : array_like, shape (...)
///     Moment of inertia J of the slug, a number; the inertia of the body does not include it.
/// damping : array_like, shape (...)
///     Coefficient k: torque divided by angular velocity.
/// name : str, optional
///     The name of its states in `states` of the trajectory.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A long body spins nearly about its long axis. It ends in a flat spin, with all its angular momentum about
/// the axis of the largest moment:
///
/// >>> from polhode import RigidBody, loads
/// >>> explorer = RigidBody.from_principal(1.0, (0.2, 1.0, 1.05))
/// >>> motion = explorer.simulate([0, 400], omega=(10, 0.1, 0), load=loads.slug(inertia=0.05, damping=0.05))
/// >>> abs(motion.omega[-1]).round(3)
/// array([0.   , 0.   , 2.275])
/// >>> motion.angular_momentum().spin[-1].round(6) - motion.angular_momentum().spin[0].round(6)
/// array([0., 0., 0.])
#[pyfunction]
#[pyo3(signature = (inertia, damping, name="slug"))]
pub(crate) fn slug(
    py: Python<'_>,
    inertia: &Bound<'_, PyAny>,
    damping: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<PyLoad> {
    check_name(name)?;
    let (inertia, damping): (Stack<f64>, Stack<f64>) =
        (read(inertia, "inertia")?, read(damping, "damping")?);
    let grid = Broadcast::of(["inertia", "damping"], [&inertia.shape, &damping.shape])?;
    let terms = grid.try_map(py, |[j, k]| {
        Slug::new(inertia[j], damping[k]).map(Term::Slug)
    })?;
    let number = |stack: &Stack<f64>| write_of(py, stack, |x| *x);
    let recipe = recipe(py, "slug", (number(&inertia)?, number(&damping)?, name))?;
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe).with_name(name))
}

register!(Slug by slug);
