//! The functions that make loads which the body carries along: rotors, wheels, slugs.

use nalgebra::Vector3;
use numpy::PyUntypedArrayMethods;
use polhode::motion::loads::{Drive, PiecewiseSignal, Rotor, Slug, Term, Wheel};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::load::PyLoad;
use super::made::made;
use super::part::Acts;
use super::recipe::recipe;
use super::stateful::check_name;
use crate::arrays::{floats, list_floats, read, read_scalar, try_rows, write, write_of};
use crate::errors::to_py;
use crate::stack::{Broadcast, Stack};

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
    Ok(PyLoad::one(Acts::Term(terms), recipe))
}

made!(Rotor by rotor);

/// A wheel in the body, with a motor and friction in its bearing.
///
/// Its state is its angular momentum about its axis a, ``h = J (Ω + a·ω)``, where Ω is its rate relative to
/// the body. The inertia of the body includes the wheel as if it were locked. The equation of the wheel is
/// ``ḣ = τ - c Ω - c₀ sign(Ω)``, where τ is the torque of the motor on the wheel. On the rest of the body,
/// whose tensor is ``I - J a aᵀ``, the wheel exerts the torque ``-a ḣ - ω × h a``. If ``speed`` is given in
/// place of ``torque``, the motor exerts the torque that this speed needs.
///
/// Parameters
/// ----------
/// axis : array_like, shape (..., 3)
///     a in the body frame, of any length.
/// inertia : array_like, shape (...)
///     J about the axis. ``I - J a aᵀ`` must have positive moments.
/// rate : array_like, shape (...), optional
///     Ω at the start; zero by default.
/// torque : float, array_like of shape (n,), or Load, optional
///     Torque τ of the motor on the wheel: a constant; values at `times`, each of which is held until the
///     next; or a :func:`feedback`. The motor then exerts on the body the component along a of the torque of that
///     feedback.
/// speed : float or array_like of shape (n,), optional
///     Rate Ω, in radians per unit of time: a constant, or values at `times` with straight lines in between.
/// times : array_like, shape (n,), optional
///     Times of `torque` or `speed`, ascending. A torque is not defined before the first of them; a speed is
///     defined only from the first to the last.
/// friction : array_like, shape (...), optional
///     Coefficient c of viscous friction: torque divided by rate. Not together with `speed`.
/// dry_friction : array_like, shape (...), optional
///     Torque c₀ of dry friction (Coulomb's law): it is against the rate and does not depend on its size. Not
///     together with `speed`. While the wheel is at rest, friction exerts the torque that keeps it at rest;
///     if that were larger than c₀, the wheel begins to slip. The method "auto" is then "dop853", which finds
///     the times of stop and slip. The run must go forward in time.
/// limit : float, optional
///     Largest possible ``|τ|``, for a motor that follows a feedback. The method "auto" is then "dop853".
/// name : str, optional
///     Name of its state in ``states`` of the trajectory. If several have the same name, the second becomes
///     ``wheel_2``, and so on.
///
/// Returns
/// -------
/// Load
///
/// See Also
/// --------
/// rotor : a momentum that stays constant.
///
/// Examples
/// --------
/// A wheel is spun up, and the body turns in the opposite sense; the total angular momentum stays zero:
///
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
/// >>> wheel = loads.wheel(axis=(0, 0, 1), inertia=0.5, torque=0.1)
/// >>> motion = body.simulate([0, 10], omega=(0, 0, 0), load=wheel)
/// >>> (momentum,) = motion.states.values()
/// >>> motion.omega[-1].round(9), momentum[-1].round(9)
/// (array([ 0. ,  0. , -0.5]), array([1.]))
#[pyfunction]
#[pyo3(signature = (axis, inertia, rate=None, *, torque=None, speed=None, times=None, friction=None,
                   dry_friction=None, limit=None, name="wheel"))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub(crate) fn wheel(
    py: Python<'_>,
    axis: &Bound<'_, PyAny>,
    inertia: &Bound<'_, PyAny>,
    rate: Option<&Bound<'_, PyAny>>,
    torque: Option<&Bound<'_, PyAny>>,
    speed: Option<&Bound<'_, PyAny>>,
    times: Option<&Bound<'_, PyAny>>,
    friction: Option<&Bound<'_, PyAny>>,
    dry_friction: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] limit: Option<f64>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<PyLoad> {
    check_name(name)?;
    if limit.is_some() && !torque.is_some_and(PyAnyMethods::is_instance_of::<PyLoad>) {
        return Err(PyTypeError::new_err(
            "limit: it is that of a motor that follows a feedback: torque=loads.feedback(...)",
        ));
    }
    if speed.is_some() {
        for (what, given) in [
            ("rate", rate),
            ("torque", torque),
            ("friction", friction),
            ("dry_friction", dry_friction),
        ] {
            if given.is_some() {
                return Err(PyTypeError::new_err(format!(
                    "{what}: not beside speed=, which says what the wheel does"
                )));
            }
        }
    }
    let drive = match (torque, speed) {
        (_, Some(speed)) => Stack::one(Drive::Speed(held("speed", speed, times)?)),
        (None, None) => Stack::one(Drive::Torque(nothing(py, times)?)),
        (Some(torque), None) => match torque.cast::<PyLoad>() {
            Ok(load) => asked(py, load.get(), times, limit)?,
            Err(_) => Stack::one(Drive::Torque(held("torque", torque, times)?)),
        },
    };
    let axis: Stack<Vector3<f64>> = read(axis, "axis")?;
    let inertia: Stack<f64> = read(inertia, "inertia")?;
    let or_zero = |given: Option<&Bound<'_, PyAny>>, name| {
        given.map_or_else(|| Ok(Stack::one(0.0)), |given| read::<f64>(given, name))
    };
    let (rates, frictions) = (or_zero(rate, "rate")?, or_zero(friction, "friction")?);
    let dry_frictions = or_zero(dry_friction, "dry_friction")?;
    let names = [
        "axis",
        "inertia",
        "rate",
        "friction",
        "dry_friction",
        "torque",
    ];
    let shapes = [
        &axis.shape[..],
        &inertia.shape,
        &rates.shape,
        &frictions.shape,
        &dry_frictions.shape,
        &drive.shape,
    ];
    let terms = Broadcast::of(names, shapes)?.try_map(py, |[a, j, w, c, c0, d]| {
        Wheel::new(
            &axis[a],
            inertia[j],
            rates[w],
            frictions[c],
            drive[d].clone(),
        )
        .and_then(|wheel| wheel.with_dry_friction(dry_frictions[c0]))
        .map(Term::Wheel)
    })?;
    let number = |stack: &Stack<f64>| write_of(py, stack, |x| *x);
    let kept = |given: Option<&Bound<'_, PyAny>>| -> PyResult<Option<Py<PyAny>>> {
        Ok(match given {
            Some(load) if load.is_instance_of::<PyLoad>() => Some(load.clone().unbind()),
            Some(numbers) => Some(
                crate::arrays::numpy(py)?
                    .call_method1("array", (numbers, "float64"))?
                    .unbind(),
            ),
            None => None,
        })
    };
    let options = PyDict::new(py);
    options.set_item("torque", kept(torque)?)?;
    options.set_item("speed", kept(speed)?)?;
    options.set_item("times", kept(times)?)?;
    options.set_item(
        "friction",
        friction.map(|_| number(&frictions)).transpose()?,
    )?;
    let dry_friction = dry_friction.map(|_| number(&dry_frictions));
    options.set_item("dry_friction", dry_friction.transpose()?)?;
    options.set_item("limit", limit)?;
    options.set_item("name", name)?;
    let rate = rate.map(|_| number(&rates)).transpose()?;
    let arguments = (write(py, &axis)?, number(&inertia)?, rate, options);
    let recipe = recipe(py, "wheel", arguments)?;
    Ok(PyLoad::one(Acts::Term(terms), recipe).named(name))
}

made!(Wheel by wheel);

/// No torque.
fn nothing(py: Python<'_>, times: Option<&Bound<'_, PyAny>>) -> PyResult<PiecewiseSignal> {
    if times.is_some() {
        return Err(PyTypeError::new_err("times: give torque= or speed= too"));
    }
    PiecewiseSignal::constant("torque", 0.0).map_err(|error| to_py(py, &error))
}

/// A number, or one for each of the times.
fn held(
    what: &'static str,
    given: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<PiecewiseSignal> {
    let py = given.py();
    let values = floats(given, what)?;
    let made = match times {
        None if values.ndim() == 0 => PiecewiseSignal::constant(what, values.as_slice()?[0]),
        None => {
            return Err(PyTypeError::new_err(format!(
                "{what}: expected one number, got {} of them; give the times= from which each holds",
                values.len()
            )));
        }
        Some(times) => {
            let times = list_floats(times, "times", "n", &[])?;
            let values = list_floats(given, what, "n", &[])?;
            if times.len() != values.len() {
                return Err(PyValueError::new_err(format!(
                    "{what}: expected one for each of the {} times, got {}",
                    times.len(),
                    values.len()
                )));
            }
            PiecewiseSignal::table(what, times.as_slice()?, values.as_slice()?)
        }
    };
    made.map_err(|error| to_py(py, &error))
}

/// What a feedback asks of a motor.
fn asked(
    py: Python<'_>,
    load: &PyLoad,
    times: Option<&Bound<'_, PyAny>>,
    limit: Option<f64>,
) -> PyResult<Stack<Drive>> {
    let refused = || {
        PyTypeError::new_err(
            "torque: expected a number, numbers with times=, or one loads.feedback(...) alone, not a sum, a scaled or scheduled one",
        )
    };
    if times.is_some() {
        return Err(PyTypeError::new_err("times: not beside a feedback"));
    }
    let terms = load.terms(py)?;
    if !load.is_analytic() || terms.rows.iter().any(|row| row.len() != 1) {
        return Err(refused());
    }
    let shape = terms.shape;
    let drives = terms.rows.into_iter().map(|mut row| match row.pop() {
        Some(Term::Feedback(law)) => Ok(match limit {
            Some(limit) => Drive::Limited(law, limit),
            None => Drive::Feedback(law),
        }),
        _ => Err(refused()),
    });
    Ok(Stack {
        shape,
        rows: drives.collect::<PyResult<_>>()?,
    })
}

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
    Ok(PyLoad::one(Acts::Term(terms), recipe).named(name))
}

made!(Slug by slug);
