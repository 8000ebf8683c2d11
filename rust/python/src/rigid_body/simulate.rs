//! The motion under a load.

use nalgebra::Vector3;
use polhode::RigidBody;
use polhode::motion::loads::VaryingBody;
use polhode::motion::rolling::Law;
use polhode::motion::simulate::{Method, Plan, Refusal, Tolerance, most_demanding};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::simulate_stack::{Ensemble, Rolling, Start};
use crate::about::is_pivot;
use crate::arrays::{read, read_scalar};
use crate::attitudes::read_attitude_exactly;
use crate::body::PyRigidBody;
use crate::closed_form::origin;
use crate::depth::RecursionGuard;
use crate::errors::{at_row, to_py};
use crate::events::Functions;
use crate::hints;
use crate::interrupt::Interrupt;
use crate::lazy_arrays::{handed_over, is_any};
use crate::loads::PyLoad;
use crate::rolling::{PyContact, read_contact};
use crate::stack::Stack;
use crate::times::read_times;
use crate::uncertain::StartArguments;

/// An optional argument of any array-like kind.
pub(super) type Given<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

#[pymethods]
impl PyRigidBody {
    /// Compute the motion of the body at given times, with or without a load.
    ///
    /// Solves Euler's equations together with the attitude, as a unit quaternion, and the motion of the centre of
    /// mass under a load.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (T,)
    ///     Output times, strictly monotone (forward or backward); the first is the start.
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity at the start, of the body relative to space, components in the body frame.
    /// attitude : array_like, shape (..., 4), or rotation, optional
    ///     R_NB at the start: unit quaternions (x, y, z, w), or anything with ``as_quat()`` such as
    ///     SciPy's Rotation. The identity by default.
    /// load : Load, optional
    ///     Forces and torques on the body, from :mod:`polhode.loads`; none by default. Torques are about the
    ///     point `about`. Forces move the centre of mass of a free body.
    /// position, velocity : array_like, shape (..., 3), optional
    ///     Position and velocity of the point `about` at the start, in space; zero by default.
    ///     With `contact`, position None puts the body on the plane, and velocity None is that of rolling; another
    ///     one is for the laws "sliding" and "dry".
    /// contact : Contact, optional
    ///     A plane on which the body rolls or slips, from :func:`polhode.rolling.plane`; none by
    ///     default. The load is then uniform gravity, or nothing, and the method "taylor" serves the run.
    ///     ``contact`` of the trajectory has the force of the plane and what else the contact tells. Where the
    ///     normal force falls through zero the run ends with the status "lift-off". `events` of the trajectory has
    ///     what happens to the contact too: "lift-off", "slip", "roll" and others in its column ``kind``.
    /// about : {"center_of_mass", "origin"}, optional
    ///     The centre of mass of a body that moves freely, or the origin of the body frame when that
    ///     point is fixed in space.
    /// method : {"auto", "exact", "taylor", "dop853", "radau", "splitting"}, optional
    ///     * "auto" takes the first of "exact", "taylor" and "dop853" that can serve the run.
    ///     * "exact" is the closed form of a free body without a load, and of a symmetric top under uniform
    ///       gravity whose axis passes through the fixed origin. Its cost and error do not grow with time.
    ///     * "taylor" sums Taylor series. Their order is chosen so that the work is nearly least: 18 at the
    ///       default `rtol`, 26 at 2.3e-15. It serves every load but those for which
    ///       :meth:`polhode.Trajectory.sensitivity` has no series either: functions, gravity gradients along an oblate
    ///       or sampled orbit, magnetic fields along an orbit or at given times, B-dot, motors with a limit,
    ///       dry friction, feedbacks on a moving target.
    ///     * "dop853" is the explicit Runge-Kutta method of order 8 by Dormand and Prince, with a dense
    ///       output of order 7. It serves any load.
    ///     * "radau" is the implicit Runge-Kutta method Radau IIA of order 5. It serves any load, and is made
    ///       for stiff ones such as strong damping.
    ///     * "splitting" alternates exact free motions with impulses of the load. It serves loads that depend
    ///       on time, attitude and position alone, and is made for long times, since the energy does not
    ///       drift. All its steps have the same length. The length changes where a load begins or ends, or
    ///       where a comparison with two half steps shows that shorter steps are needed. If the body takes more
    ///       than twenty steps for a radian, the error of each step is held below `rtol`, since the errors add
    ///       up.
    /// rtol : float, optional
    ///     Error allowed in a step, relative to the unit quaternion and to the largest angular speed,
    ///     distance and speed so far. The range is 2.3e-15 to 0.1; for "taylor" it begins at 1e-28. Below
    ///     2.3e-15 (ten units of rounding) "taylor" sums its series in numbers of twice the precision and
    ///     rounds the result once. This takes many times as long. It is meant for reference solutions, and
    ///     for motions whose rounding errors grow with time, such as those near a separatrix. With such an
    ///     `rtol` "auto" takes "taylor" even where "exact" could serve.
    /// atol : float, optional
    ///     Absolute error of the angular velocity that is allowed in addition, in radians per unit of time;
    ///     zero by default.
    /// events : callable or sequence of callables, optional
    ///     Functions ``event(t, omega, quaternion, position, velocity)`` whose passages through zero are
    ///     searched for. If the load has states, they are the sixth argument, a dict by name. All passages of
    ///     a smooth function are found, also two within one step, and however fast it is beside the body: where
    ///     a polynomial through its values does not agree with it, a part of a step is halved. Each function may
    ///     be evaluated 2**24 times in such parts of a run, which is enough for about 2e5 cycles of a sine. Beyond
    ///     that the run fails, and the error says so. A function is looked at more than 64 times in a run, and
    ///     several times in each radian of a turn. What does not show there is not found: two passages at a jump,
    ///     a corner or a narrow peak if the body turns by less than a quarter of a radian between them, or ripples
    ///     that are a thousand times smaller than the changes of the function in such a part.
    ///     The functions may have attributes as in SciPy. ``direction``: if it is positive,
    ///     only passages that rise in time count; if it is negative, only those that fall. ``terminal`` True
    ///     ends the run at the first, a number n at the n-th. :class:`polhode.Event` sets them.
    /// on_failure : {"raise", "keep"}, optional
    ///     What happens if the integration of a body cannot go on: an error ends the run, or the other bodies
    ///     of the stack go on and ``status`` and ``failures`` of the trajectory tell about this one.
    /// progress : callable, optional
    ///     Called with the fraction done, about twenty times a second and at the end.
    /// states : dict of str and array_like, shape (..., k), optional
    ///     States of the load at the start, by name, in place of its usual initial states.
    /// max_steps : int, optional
    ///     Largest number of steps of each body, 1e9 by default. A body that needs more fails, and the others
    ///     need not wait for it. Closed forms take no steps.
    ///
    /// Returns
    /// -------
    /// Trajectory
    ///     The motion. If omega, attitude, position or velocity is a dask array, or an `xarray.DataArray`
    ///     that holds one, the result is an `xarray.Dataset` of dask arrays, as `Trajectory.to_xarray` gives
    ///     it, with the variable ``status``. It is computed later, chunk by chunk, with the same bits. Names
    ///     and coordinates of the axes are kept.
    ///
    /// Raises
    /// ------
    /// IntegrationError
    ///     If an integration cannot go on, or needs more than `max_steps` steps. The error has the time and
    ///     the state that were reached, and the part that was computed.
    ///
    /// Notes
    /// -----
    /// The GIL is released unless load or events call Python; stacks run on all cores. Ctrl-C ends the run;
    /// the attribute ``partial`` of the KeyboardInterrupt is the trajectory so far. An exception that a
    /// callback raises is passed on unchanged.
    ///
    /// Examples
    /// --------
    /// NASA's tumbling brick (NASA/TM-2015-218675, check case 2) after 30 seconds, in degrees a second:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(0.155404754, (0.001894220, 0.006211019, 0.007194665))
    /// >>> motion = brick.simulate([0, 30], omega=np.radians([10, 20, 30]))
    /// >>> np.degrees(motion.omega[-1]).round(6)
    /// array([ 12.618391, -17.397475,  31.119589])
    #[pyo3(
        signature = (
            t=None, omega=None, attitude=None, *, load=None, contact=None, position=None, velocity=None,
            about="center_of_mass",
            method="auto", rtol=1e-10, atol=None, events=None, on_failure="raise", progress=None, states=None,
            max_steps=None, **unknown
        ),
        text_signature = "($self, t, omega, attitude=None, *, load=None, contact=None, position=None, velocity=None, about=\"center_of_mass\", method=\"auto\", rtol=1e-10, atol=None, events=None, on_failure=\"raise\", progress=None, states=None, max_steps=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn simulate<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        t: Given<'_, 'py>,
        omega: Given<'_, 'py>,
        attitude: Given<'_, 'py>,
        load: Given<'_, 'py>,
        contact: Given<'_, 'py>,
        position: Given<'_, 'py>,
        velocity: Given<'_, 'py>,
        #[pyo3(from_py_with = read_scalar)] about: &str,
        #[pyo3(from_py_with = read_scalar)] method: &str,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
        #[pyo3(from_py_with = read_scalar)] atol: Option<f64>,
        events: Given<'_, 'py>,
        #[pyo3(from_py_with = read_scalar)] on_failure: &str,
        progress: Option<Py<PyAny>>,
        states: Given<'_, 'py>,
        #[pyo3(from_py_with = read_scalar)] max_steps: Option<i128>,
        unknown: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        hints::refuse_unknown("RigidBody.simulate", &KEYWORDS, unknown)?;
        let [t, omega] = hints::require("RigidBody.simulate", [("t", t), ("omega", omega)])?;
        if is_any(&[Some(omega), attitude, position, velocity]) {
            let arrays = [load, contact, position, velocity, events, states];
            let words = (about, method, on_failure);
            let numbers = (rtol, atol, max_steps);
            let options = options_of(py, arrays, words, numbers, progress.as_ref())?;
            let given = (slf, t, omega, attitude);
            if let Some(motion) = handed_over(py, "simulate", given, Some(&options))? {
                return Ok(motion);
            }
        }
        let wanted = Wanted {
            t,
            omega,
            attitude,
            load,
            contact,
            position,
            velocity,
            about,
            method: parse_method(method)?,
            rtol,
            atol,
            events,
            on_failure,
            progress,
            states,
            max_steps,
        };
        wanted.run(py, slf.as_any(), &slf.get().bodies, None)
    }
}

/// What is asked of `simulate`.
pub(super) struct Wanted<'a, 'py> {
    pub(super) t: &'a Bound<'py, PyAny>,
    pub(super) omega: &'a Bound<'py, PyAny>,
    pub(super) attitude: Given<'a, 'py>,
    pub(super) load: Given<'a, 'py>,
    pub(super) contact: Given<'a, 'py>,
    pub(super) position: Given<'a, 'py>,
    pub(super) velocity: Given<'a, 'py>,
    pub(super) about: &'a str,
    pub(super) method: Method,
    pub(super) rtol: f64,
    pub(super) atol: Option<f64>,
    pub(super) events: Given<'a, 'py>,
    pub(super) on_failure: &'a str,
    pub(super) progress: Option<Py<PyAny>>,
    pub(super) states: Given<'a, 'py>,
    pub(super) max_steps: Option<i128>,
}

impl<'py> Wanted<'_, 'py> {
    /// The trajectory of `body`, which is `bodies`, or varies and is `bodies` at the first time.
    pub(super) fn run(
        self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        bodies: &Stack<RigidBody>,
        varying: Option<&VaryingBody>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let _guard = RecursionGuard::run("simulate")?;
        let pivoted = is_pivot(self.about)?;
        check_velocity(pivoted, self.velocity)?;
        let contact = read_rolling(self.contact, self.velocity)?;
        let raises = raises(self.on_failure)?;
        let times = read_times(py, self.t)?;
        let tolerance = Tolerance::new(self.rtol, self.atol.unwrap_or(0.0))
            .map_err(|error| to_py(py, &error))?
            .within(most_steps(self.max_steps)?);
        let nothing = PyLoad::default();
        let load = self.load.filter(|load| !load.is_none());
        let acts = load.map_or(Ok(&nothing), cast_load)?;
        let given = StartArguments::read(self.omega, self.attitude)?;
        if varying.is_some() && given.uncertain.is_any() {
            return Err(PyValueError::new_err(
                "omega, attitude: of a varying body the start is without uncertainty; draw starts with polhode.ensembles, or give numbers",
            ));
        }
        let places = [self.position, self.velocity];
        let start = Start::read(py, bodies, &given, places, acts, self.states)?;
        let rolling = (contact.map(|contact| {
            let given = places.map(|given| given.is_some_and(|given| !given.is_none()));
            Rolling::new(py, contact.get().contact, &start, acts, given)
        }))
        .transpose()?;
        let events = Functions::read(self.events, acts, &start.terms)?;
        let of_one = most_demanding(&start.terms.rows, pivoted);
        let interrupt = Interrupt::new(self.progress);
        let plan = Plan::new(
            &start.bodies.rows,
            pivoted,
            &times,
            // Rolling has series, and no closed form that serves here.
            match self.method {
                Method::Auto if rolling.is_some() => Method::Taylor,
                method => method,
            },
            tolerance,
            (acts.is_analytic() && varying.is_none()).then_some(of_one),
            &|done| interrupt.poll(done),
        )
        .map_err(|refusal| refused(py, &start.bodies.shape, &refusal))?;
        acts.check_run(py, times[0], times[times.len() - 1])?;
        let ensemble = Ensemble {
            start: &start,
            grid: start.grid()?,
            plan,
            load: acts,
            events: &events,
            raises,
            rolling,
            varying,
        };
        ensemble.check(py)?;
        let (trajectory, has_failures) = ensemble.run(py, body, load, &interrupt)?;
        if let Some(contact) = contact {
            let known = trajectory.getattr("__dict__")?;
            known.set_item("_contact", contact)?;
        }
        if given.uncertain.is_any() {
            let known = trajectory.getattr("__dict__")?;
            known.set_item("uncertain_start", given.uncertain.to_python(py)?)?;
        }
        if let Some(Ok(states)) = self.states.map(|states| states.cast::<PyDict>()) {
            // Those of the load that do not follow from its numbers.
            let known = trajectory.getattr("__dict__")?;
            known.set_item("_origin", origin(py, "states", states.keys().to_tuple())?)?;
        }
        let failure = raises && has_failures;
        if let Err(stop) = interrupt.finish(py, !failure) {
            stop.value(py).setattr("partial", trajectory)?;
            return Err(stop);
        }
        if failure {
            let first = trajectory.getattr("failures")?.get_item(0)?;
            first.setattr("partial", &trajectory)?;
            return Err(PyErr::from_value(first));
        }
        Ok(trajectory)
    }
}

/// The load that an argument is.
pub(super) fn cast_load<'a>(load: &'a Bound<'_, PyAny>) -> PyResult<&'a PyLoad> {
    let cast = load.cast::<PyLoad>();
    cast.map(Bound::get).map_err(|_| hints::not_a_load(load))
}

impl<'a> Start<'a> {
    /// From the arguments of `simulate`.
    pub(super) fn read(
        py: Python<'_>,
        bodies: &'a Stack<RigidBody>,
        given: &StartArguments<'_>,
        [position, velocity]: [Given<'_, '_>; 2],
        load: &PyLoad,
        states: Given<'_, '_>,
    ) -> PyResult<Self> {
        Ok(Self {
            bodies,
            omega: read(&given.omega, "omega")?,
            attitude: read_attitude_exactly(given.attitude.as_ref(), "attitude")?,
            position: at_start(position, "position")?,
            velocity: at_start(velocity, "velocity")?,
            terms: load.terms(py)?,
            states: load.read_states(states, false)?,
        })
    }
}

/// The keywords as Python has them.
fn options_of<'py>(
    py: Python<'py>,
    [load, contact, position, velocity, events, states]: [Given<'_, 'py>; 6],
    (about, method, on_failure): (&str, &str, &str),
    (rtol, atol, max_steps): (f64, Option<f64>, Option<i128>),
    progress: Option<&Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = PyDict::new(py);
    for (name, value) in [
        ("load", load),
        ("contact", contact),
        ("position", position),
        ("velocity", velocity),
        ("events", events),
        ("states", states),
    ] {
        options.set_item(name, value)?;
    }
    options.set_item("about", about)?;
    options.set_item("method", method)?;
    options.set_item("rtol", rtol)?;
    options.set_item("atol", atol)?;
    options.set_item("on_failure", on_failure)?;
    options.set_item("progress", progress)?;
    options.set_item("max_steps", max_steps)?;
    Ok(options)
}

/// The plane that a body is on; one that it rolls on says its velocity.
fn read_rolling<'a, 'py>(
    contact: Given<'a, 'py>,
    velocity: Given<'_, 'py>,
) -> PyResult<Option<&'a Bound<'py, PyContact>>> {
    let contact = read_contact(contact)?;
    let rolls = contact.is_some_and(|contact| contact.get().contact.law == Law::Rolling);
    if rolls && velocity.is_some_and(|velocity| !velocity.is_none()) {
        return Err(PyValueError::new_err(
            "velocity: a body that rolls has the velocity u - omega x r of rolling; leave it out, or give the contact the law \"sliding\" or \"dry\"",
        ));
    }
    Ok(contact)
}

/// A fixed point has no velocity.
pub(super) fn check_velocity(pivoted: bool, velocity: Given<'_, '_>) -> PyResult<()> {
    if pivoted && velocity.is_some() {
        return Err(PyValueError::new_err(
            "velocity: with about=\"origin\" that point is fixed in space and has no velocity",
        ));
    }
    Ok(())
}

/// Why runs are not begun, with the body at fault.
fn refused(py: Python<'_>, shape: &[usize], Refusal { body, error }: &Refusal) -> PyErr {
    let error = to_py(py, error);
    match body {
        Some(row) => at_row(shape, *row, &error, py),
        None => error,
    }
}

/// Whether a failure ends the run.
fn raises(on_failure: &str) -> PyResult<bool> {
    match on_failure {
        "raise" => Ok(true),
        "keep" => Ok(false),
        _ => Err(PyValueError::new_err(format!(
            "on_failure: expected \"raise\" or \"keep\", got \"{on_failure}\""
        ))),
    }
}

/// The steps that a run may take.
pub(super) fn most_steps(given: Option<i128>) -> PyResult<u64> {
    match given {
        None => Ok(u64::MAX),
        Some(count) if count > 0 => Ok(u64::try_from(count).unwrap_or(u64::MAX)),
        Some(count) => Err(PyValueError::new_err(format!(
            "max_steps: expected a positive integer, got {count}"
        ))),
    }
}

const KEYWORDS: [&str; 16] = [
    "t",
    "omega",
    "attitude",
    "load",
    "contact",
    "position",
    "velocity",
    "about",
    "method",
    "rtol",
    "atol",
    "events",
    "on_failure",
    "progress",
    "states",
    "max_steps",
];

pub(super) fn parse_method(word: &str) -> PyResult<Method> {
    (Method::ALL.iter().copied())
        .find(|method| method.name() == word)
        .ok_or_else(|| {
            let names: Vec<String> = (Method::ALL.iter())
                .map(|method| format!("\"{}\"", method.name()))
                .collect();
            let names = names.join(", ");
            PyValueError::new_err(format!("method: expected one of {names}, got \"{word}\""))
        })
}

/// A vector that is zero unless given.
fn at_start(vector: Given<'_, '_>, name: &str) -> PyResult<Stack<Vector3<f64>>> {
    vector.map_or_else(
        || Ok(Stack::one(Vector3::zeros())),
        |vector| read(vector, name),
    )
}
