//! A body that changes with time.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::motion::loads::VaryingBody;
use polhode::motion::simulate::Method;
use pyo3::exceptions::{PyAttributeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::simulate::{Given, Wanted, parse_method};
use crate::about::is_pivot;

use crate::arrays::{read, read_scalar, write};
use crate::body::PyRigidBody;
use crate::errors::to_py;
use crate::hints;
use crate::interrupt::watched;
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

/// An array of float64.
type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// A body whose mass, centre of mass and tensor change with time: what :meth:`RigidBody.varying` returns.
///
/// See Also
/// --------
/// RigidBody.varying : the equations of motion, and what they leave out.
///
/// Examples
/// --------
/// >>> from polhode import RigidBody, solids
/// >>> rods = RigidBody.stack([solids.cylinder(0.01, length, mass=2.0) for length in (1.0, 2.0)])
/// >>> boom = RigidBody.varying([0, 10], rods)
/// >>> boom
/// VaryingBody(2 bodies from t = 0.0 to 10.0)
/// >>> boom.at([2.5, 5.0]).mass
/// array([2., 2.])
#[pyclass(name = "VaryingBody", module = "polhode", frozen)]
pub(crate) struct PyVaryingBody {
    varying: VaryingBody,
    bodies: Py<PyRigidBody>,
}

#[pymethods]
impl PyRigidBody {
    /// Make a body whose mass and tensor change with time, from what it is at some times.
    ///
    /// Mass, first moments and tensor about a fixed point are cubic splines in time through those of the bodies
    /// ("not a knot": smooth to the second derivative). Whatever is a cubic in time is met exactly. With the tensor I
    /// about the reference point P, the torque N and the force F of the load, and the mean over the outlets, which lie
    /// at r from P, the motion follows from
    ///
    /// ``d(I ω)/dt + ω × I ω = N + ṁ r × (ω × r)``, components in the body frame, and ``m v̇_C = F``.
    ///
    /// Mass that leaves takes its angular momentum along ("jet damping"). Without an outlet the mass is constant, and
    /// the body changes by what moves inside: the angular momentum is conserved. The equations leave out the
    /// momentum of what moves inside relative to the body, such as a swirl of the gas in a nozzle. They do not
    /// include the thrust, which is a load, such as :func:`polhode.loads.constant_force`.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (n,)
    ///     Ascending times, two or more, at which the body is known.
    /// bodies : RigidBody
    ///     Stack of shape (n,): the body then, in the same frame at all times.
    /// outlet : array_like, shape (3,) or (k, 3), optional
    ///     Point of the body, components in its frame, through which mass leaves or comes; of several points each
    ///     passes the same share. It is needed where the masses of the bodies differ.
    ///
    /// Returns
    /// -------
    /// VaryingBody
    ///     With :meth:`VaryingBody.simulate` for its motion, and :meth:`VaryingBody.at`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the mass changes and there is no outlet, or if between two times the spline is none that a body can have.
    ///
    /// References
    /// ----------
    /// F. O. Eke, Dynamics of Variable Mass Systems, NASA/CR-1998-208246; W. T. Thomson, Introduction to Space
    /// Dynamics.
    ///
    /// Examples
    /// --------
    /// A skater draws the arms in; the moment falls to a half, and she turns twice as fast:
    ///
    /// >>> from polhode import RigidBody
    /// >>> arms = RigidBody.from_principal(60.0, [(3.0, 3.5, 2.0), (3.0, 3.5, 1.0)])
    /// >>> skater = RigidBody.varying([0, 2], arms)
    /// >>> skater.simulate([0, 2], omega=(0, 0, 3.0)).omega[-1].round(9)
    /// array([0., 0., 6.])
    ///
    /// A rocket tumbles more and more slowly while its grain burns:
    ///
    /// >>> from polhode import solids
    /// >>> grain = RigidBody.stack([solids.cylinder(0.1, 1.0, mass=mass) for mass in (10.0, 6.0)])
    /// >>> rocket = RigidBody.varying([0, 4], grain, outlet=(0, 0, -0.5))
    /// >>> rocket.simulate([0, 4], omega=(1.0, 0, 0)).omega[-1].round(6)
    /// array([0.37138, 0.     , 0.     ])
    #[staticmethod]
    #[pyo3(
        signature = (t=None, bodies=None, outlet=None, **unknown),
        text_signature = "(t, bodies, outlet=None)"
    )]
    fn varying(
        py: Python<'_>,
        t: Given<'_, '_>,
        bodies: Given<'_, '_>,
        outlet: Given<'_, '_>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyVaryingBody> {
        hints::refuse_unknown("RigidBody.varying", &["t", "bodies", "outlet"], unknown)?;
        let [t, bodies] = hints::require("RigidBody.varying", [("t", t), ("bodies", bodies)])?;
        let times: Stack<f64> = read(t, "t")?;
        let Ok(bodies) = bodies.cast::<Self>() else {
            return Err(PyValueError::new_err(
                "bodies: expected a stack of bodies, one for each time: RigidBody.stack([...])",
            ));
        };
        let stack = bodies.get();
        if times.shape.len() != 1 || times.shape != stack.bodies.shape {
            return Err(PyValueError::new_err(format!(
                "t, bodies: expected as many times as bodies, shapes (n,) and (n,), got {} and {}",
                tuple(&times.shape),
                tuple(&stack.bodies.shape)
            )));
        }
        if stack.uncertainties.is_some() {
            return Err(PyValueError::new_err(
                "bodies: the uncertainty of bodies is not carried along a varying body; give bodies without: \
                 RigidBody(bodies.mass, bodies.inertia, bodies.center_of_mass)",
            ));
        }
        let outlets: Stack<Vector3<f64>> = match outlet.filter(|given| !given.is_none()) {
            None => Stack {
                shape: vec![0],
                rows: Vec::new(),
            },
            Some(given) => read(given, "outlet")?,
        };
        if outlets.shape.len() > 1 {
            return Err(PyValueError::new_err(format!(
                "outlet: expected shape (3,) or (k, 3), got the shape {} of vectors",
                tuple(&outlets.shape)
            )));
        }
        let rows = &stack.bodies.rows;
        let varying = watched(py, |watch| {
            VaryingBody::new(&times.rows, rows, &outlets.rows, watch)
        })?
        .map_err(|error| to_py(py, &error))?;
        Ok(PyVaryingBody {
            varying,
            bodies: bodies.clone().unbind(),
        })
    }
}

#[pymethods]
impl PyVaryingBody {
    /// Times at which the body is known, shape (n,).
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        write(py, &list(self.varying.times().to_vec()))
    }

    /// The body at these times: a stack of shape (n,).
    #[getter]
    fn bodies(&self, py: Python<'_>) -> Py<PyRigidBody> {
        self.bodies.clone_ref(py)
    }

    /// Points of the body, components in its frame, where mass leaves or comes, shape (k, 3); None without them.
    #[getter]
    fn outlet<'py>(&self, py: Python<'py>) -> PyResult<Option<Array<'py>>> {
        let outlets = self.varying.outlets();
        (!outlets.is_empty())
            .then(|| write(py, &list(outlets.to_vec())))
            .transpose()
    }

    /// Return the body at given times.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (...)
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///     Of shape (...).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a time beyond those at which the body is known.
    fn at(&self, py: Python<'_>, t: &Bound<'_, PyAny>) -> PyResult<PyRigidBody> {
        let times: Stack<f64> = read(t, "t")?;
        let grid = Broadcast::of(["t"], [&times.shape])?;
        let bodies = grid.try_map(py, |[k]| self.varying.at(times[k]))?;
        Ok(PyRigidBody::from(bodies))
    }

    /// Compute the motion of the varying body at given times, with or without a load.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (T,)
    ///     Output times, strictly monotone, within those at which the body is known; the first is the start.
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity at the start, components in the body frame.
    /// attitude : array_like, shape (..., 4), or rotation, optional
    ///     R_NB at the start; the identity by default.
    /// load : Load, optional
    ///     Forces and torques, as for :meth:`RigidBody.simulate`. They act on the body as it is then: the weight is
    ///     ``m(t) g``, and the arm of a force begins at the present centre of mass. Wheels are part of the bodies;
    ///     those with dry friction or a limit of their rate are refused.
    /// position, velocity : array_like, shape (..., 3), optional
    ///     Position and velocity of the point `about` at the start, in space; zero by default.
    /// about : {"center_of_mass", "origin"}, optional
    ///     The present centre of mass of a body that moves freely, or the origin of the body frame when that point is
    ///     fixed in space.
    /// method : {"auto", "dop853", "radau"}, optional
    ///     "auto" is "dop853".
    /// rtol, atol, events, on_failure, progress, states, max_steps
    ///     As for :meth:`RigidBody.simulate`.
    ///
    /// Returns
    /// -------
    /// Trajectory
    ///     Its ``body`` is the varying body. Energies and momenta are those of the body at each time. ``about`` has the
    ///     centre of mass at each time, shape (T, 3).
    ///
    /// Examples
    /// --------
    /// A satellite pushes out two booms within a minute; its rate falls, its angular momentum does not:
    ///
    /// >>> from polhode import RigidBody
    /// >>> bodies = RigidBody.from_principal(100.0, [(20.0, 20.0, 15.0), (20.0, 80.0, 75.0)])
    /// >>> motion = RigidBody.varying([0, 60], bodies).simulate([0, 30, 60], omega=(0, 0, 0.5))
    /// >>> motion.omega[:, 2].round(6), motion.angular_momentum().spin[:, 2].round(6)
    /// (array([0.5     , 0.166667, 0.1     ]), array([7.5, 7.5, 7.5]))
    #[pyo3(
        signature = (
            t=None, omega=None, attitude=None, *, load=None, position=None, velocity=None, about="center_of_mass",
            method="auto", rtol=1e-10, atol=None, events=None, on_failure="raise", progress=None, states=None,
            max_steps=None, **unknown
        ),
        text_signature = "($self, t, omega, attitude=None, *, load=None, position=None, velocity=None, about=\"center_of_mass\", method=\"auto\", rtol=1e-10, atol=None, events=None, on_failure=\"raise\", progress=None, states=None, max_steps=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn simulate<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        t: Given<'_, 'py>,
        omega: Given<'_, 'py>,
        attitude: Given<'_, 'py>,
        load: Given<'_, 'py>,
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
        hints::refuse_unknown("VaryingBody.simulate", &KEYWORDS, unknown)?;
        let [t, omega] = hints::require("VaryingBody.simulate", [("t", t), ("omega", omega)])?;
        let varying = &slf.get().varying;
        let times: Stack<f64> = read(t, "t")?;
        let ends = [times.rows.first(), times.rows.last()];
        for &t in ends.into_iter().flatten() {
            varying.check_at(t).map_err(|error| to_py(py, &error))?;
        }
        let first = times.rows.first().copied().unwrap_or(varying.times()[0]);
        let start = varying.at(first).map_err(|error| to_py(py, &error))?;
        let parsed = parse_method(method)?;
        if !matches!(parsed, Method::Auto | Method::Dop853 | Method::Radau) {
            return Err(PyValueError::new_err(format!(
                "method: \"dop853\" (\"auto\") and \"radau\" serve a varying body, got \"{method}\""
            )));
        }
        let wanted = Wanted {
            t,
            omega,
            attitude,
            load,
            contact: None,
            position,
            velocity,
            about,
            method: parsed,
            rtol,
            atol,
            events,
            on_failure,
            progress,
            states,
            max_steps,
        };
        wanted.run(py, slf.as_any(), &Stack::one(start), Some(varying))
    }

    /// Compute the torque that the change of the body exerts beside a load: ``−İ ω + ṁ r × (ω × r)``.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (...)
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity, components in the body frame.
    /// about : {"center_of_mass", "origin"}, optional
    ///     The point that I and r refer to.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Components in the body frame.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> arms = RigidBody.from_principal(60.0, [(3.0, 3.5, 2.0), (3.0, 3.5, 1.0)])
    /// >>> float(RigidBody.varying([0, 2], arms).torque_of_change(1.0, (0, 0, 4.0))[2])
    /// 2.0
    #[pyo3(signature = (t, omega, about="center_of_mass"))]
    fn torque_of_change<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = read_scalar)] about: &str,
    ) -> PyResult<Array<'py>> {
        let pivoted = is_pivot(about)?;
        let times: Stack<f64> = read(t, "t")?;
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let grid = Broadcast::of(["t", "omega"], [&times.shape, &omega.shape])?;
        let found = grid.try_map(py, |[k, w]| {
            self.varying.check_at(times[k])?;
            Ok((self.varying).torque_of_change(times[k], &omega[w], pivoted))
        })?;
        write(py, &found)
    }

    /// What is not known of the body: nothing.
    #[expect(clippy::unused_self, reason = "Python asks an instance")]
    fn _doubts(&self) -> Option<bool> {
        None
    }

    /// Asked where there is no such attribute: most that a body has, this one has at a time.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<Py<PyAny>> {
        let py = slf.py();
        if !name.starts_with('_') && py.get_type::<PyRigidBody>().hasattr(name)? {
            return Err(PyAttributeError::new_err(format!(
                "VaryingBody has no {name}: it changes with time; body.at(t).{name} is that of the body at t"
            )));
        }
        Err(hints::no_attribute(slf.as_any(), name))
    }

    fn __repr__(&self) -> String {
        let times = self.varying.times();
        format!(
            "VaryingBody({} bodies from t = {:?} to {:?})",
            times.len(),
            times[0],
            times[times.len() - 1]
        )
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let make = py.get_type::<PyRigidBody>().getattr("varying")?;
        let given = (self.t(py)?, self.bodies(py), self.outlet(py)?);
        Ok((make, given.into_pyobject(py)?))
    }

    /// Equal bodies at equal times, with equal outlets.
    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(false);
        };
        let other = other.get();
        Ok(self.varying == other.varying && self.bodies.bind(py).eq(other.bodies.bind(py))?)
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.bodies.bind(py).hash()
    }
}

/// A stack of shape (n,).
fn list<T>(rows: Vec<T>) -> Stack<T> {
    Stack {
        shape: vec![rows.len()],
        rows,
    }
}

const KEYWORDS: [&str; 15] = [
    "t",
    "omega",
    "attitude",
    "load",
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
