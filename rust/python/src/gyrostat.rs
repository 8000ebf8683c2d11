//! The classes `Gyrostat` and `GyrostatMotion`: bodies with momentum inside, and their exact motions.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use polhode::motion::attitude::components;
use polhode::motion::gyrostat::equilibria::{
    Bifurcation, Equilibria, Equilibrium, Extent, Meeting,
};
use polhode::motion::gyrostat::{Gyrostat, GyrostatMotion, InternalMomentum};
use polhode::{DoubleDouble, RigidBody};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{
    in_slabs, read, read_scalar, write, write_numbers_of, write_of, write_words_of,
};
use crate::attitudes::read_attitude;
use crate::body::PyRigidBody;
use crate::closed_form::{angular_momentum, kinetic_energy, origin, trajectory};
use crate::errors::to_py;
use crate::free_motion::write_periods;
use crate::lazy_arrays::{handed_over, is_any};
use crate::loads::{PyLoad, PyWheel, Turns};
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{StartArguments, UncertainStart};

/// A gyrostat, or a stack of them: a rigid body with wheels or rotors that carry angular momentum.
///
/// Made by `RigidBody.gyrostat`. The object is immutable.
///
/// Attributes
/// ----------
/// body : RigidBody
///     The body, or the stack of them, with its wheels locked.
/// momentum : numpy.ndarray, shape (..., 3)
///     Angular momentum inside while the body does not turn, components in the body frame.
/// inertia : numpy.ndarray, shape (..., 3, 3)
///     The tensor of the motion: that of the body less ``J a aᵀ`` of free wheels.
/// wheels : tuple of Wheel
///     The wheels.
/// shape : tuple of int
///     Shape of the stack.
///
/// Examples
/// --------
/// >>> import polhode
/// >>> body = polhode.RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
/// >>> gyrostat = body.gyrostat(momentum=(0.0, 0.3, 0.0))
/// >>> gyrostat.free_motion((0.01, 1.0, 0.0)).at(10.0).omega.round(6)
/// array([ 0.122266,  0.971115, -0.199019])
#[pyclass(name = "Gyrostat", module = "polhode", frozen)]
pub(crate) struct PyGyrostat {
    #[pyo3(get)]
    pub(crate) body: Py<PyRigidBody>,
    given: Stack<Vector3<f64>>,
    #[pyo3(get)]
    wheels: Py<PyTuple>,
    pub(crate) gyrostats: Stack<Gyrostat>,
}

impl PyGyrostat {
    fn new(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        given: Stack<Vector3<f64>>,
        wheels: &Bound<'_, PyTuple>,
    ) -> PyResult<Self> {
        let mut inside = Broadcast::of(["momentum"], [&given.shape])?
            .try_map(py, |[m]| InternalMomentum::of(&given[m]))?;
        for (k, wheel) in wheels.iter().enumerate() {
            inside = with_wheel(py, &inside, &wheel, k)?;
        }
        let bodies = &body.get().bodies;
        let gyrostats = Broadcast::of(["body", "momentum"], [&bodies.shape, &inside.shape])?
            .try_map(py, |[b, h]| Gyrostat::of(&bodies[b], &inside[h]))?;
        Ok(Self {
            body,
            given,
            wheels: wheels.clone().unbind(),
            gyrostats,
        })
    }
}

/// With what a wheel adds.
fn with_wheel(
    py: Python<'_>,
    inside: &Stack<InternalMomentum>,
    wheel: &Bound<'_, PyAny>,
    k: usize,
) -> PyResult<Stack<InternalMomentum>> {
    let PyWheel {
        axis,
        inertia,
        momentum,
        turns,
        ..
    } = wheel
        .cast::<PyWheel>()
        .map_err(|_| {
            PyTypeError::new_err(format!(
                "wheels[{k}]: expected what polhode.wheel(axis=, inertia=, ...) makes, got {}",
                wheel
                    .get_type()
                    .name()
                    .map_or_else(|_| "something else".to_owned(), |name| name.to_string())
            ))
        })?
        .get();
    let is_free = match turns {
        Turns::Free => true,
        Turns::Held => false,
        Turns::Driven(by) => {
            let what = match *by {
                "torque" => "a motor",
                "times" => "a speed that changes",
                _ => "friction in its bearing",
            };
            return Err(PyValueError::new_err(format!(
                "wheels[{k}]: it has {what} ({by}=), and the closed form is that of wheels that turn freely or at a constant \
                 rate; make it without, or integrate: body.simulate(t, omega, load=wheel)"
            )));
        }
    };
    let shapes = [
        &inside.shape[..],
        &axis.shape,
        &inertia.shape,
        &momentum.shape,
    ];
    Broadcast::of(["wheels", "axis", "inertia", "momentum"], shapes)?.try_map(py, |[i, a, j, h]| {
        inside[i].with(&axis[a], inertia[j], momentum[h], is_free)
    })
}

#[pymethods]
impl PyRigidBody {
    /// A gyrostat: this body with constant angular momentum inside.
    ///
    /// Parameters
    /// ----------
    /// momentum : array_like, shape (..., 3), optional
    ///     Angular momentum relative to the body that is held constant, components in the body frame.
    /// wheels : sequence of Wheel, optional
    ///     Wheels, made by :func:`polhode.wheel`, or by :func:`polhode.loads.wheel` without motor and friction.
    ///     The inertia of this body includes them as if they were locked.
    ///
    /// Returns
    /// -------
    /// Gyrostat
    ///     Bodies, momenta and wheels broadcast together.
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     When free wheels have a larger moment of inertia than the body.
    ///
    /// Notes
    /// -----
    /// If h is held constant, the equation of motion is ``I ω̇ + ω×(I ω + h) = 0``. For a free wheel ``h = J
    /// (Ω + a·ω)`` is constant instead, and I is replaced by ``I − J a aᵀ``.
    ///
    /// Examples
    /// --------
    /// >>> import polhode
    /// >>> body = polhode.RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> wheel = polhode.wheel(axis=(0, 1, 0), inertia=0.1, rate=50.0)
    /// >>> motion = body.gyrostat(wheels=[wheel]).free_motion((0.1, 0.2, 0.3))
    /// >>> motion.mode, round(motion.periods.rotation, 6)
    /// ('single', 1.966414)
    #[pyo3(signature = (momentum=None, *, wheels=None))]
    fn gyrostat(
        slf: Py<Self>,
        py: Python<'_>,
        momentum: Option<&Bound<'_, PyAny>>,
        wheels: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyGyrostat> {
        let given = match momentum {
            Some(momentum) => read(momentum, "momentum")?,
            None => Stack::one(Vector3::zeros()),
        };
        let wheels = match wheels {
            Some(wheels) => {
                let refused = || {
                    PyTypeError::new_err(format!(
                        "wheels: expected a sequence of wheels, got {}; of one wheel [wheel]",
                        wheels.get_type()
                    ))
                };
                if wheels.is_instance_of::<PyLoad>() {
                    return Err(refused());
                }
                let list = wheels.try_iter().map_err(|_| refused())?;
                PyTuple::new(py, list.collect::<PyResult<Vec<_>>>()?)?
            }
            None => PyTuple::empty(py),
        };
        PyGyrostat::new(py, slf, given, &wheels)
    }
}

#[pymethods]
impl PyGyrostat {
    /// Angular momentum inside the body if the body is at rest: the given momentum plus ``J Ω a`` of each wheel.
    ///
    /// Components in the body frame, shape (..., 3). For a free wheel the momentum in the motion is ``J (Ω +
    /// a·ω) a``.
    #[getter]
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let momentum =
            |one: &Gyrostat| Vector3::from(one.inside.momentum.map(DoubleDouble::rounded));
        Ok(write_of(py, &self.gyrostats, momentum)?.into_any())
    }

    /// Shape of the stack, as a tuple of int; ``()`` for one.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.gyrostats.shape)
    }

    /// The momentum and, of the free wheels, Σ J a aᵀ: for trajectories.
    #[pyo3(name = "_rotor")]
    pub(crate) fn rotor<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let momentum = write_of(py, &self.gyrostats, |one| {
            Vector3::from(one.inside.momentum.map(DoubleDouble::rounded))
        })?;
        let free = write_of(py, &self.gyrostats, |one| {
            Matrix3::from(one.inside.free.map(|row| row.map(DoubleDouble::rounded)))
        })?;
        Ok((momentum.into_any(), free.into_any()))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_parts")?;
        let body = self.body.bind(py).clone().into_any();
        let wheels = self.wheels.bind(py).clone().into_any();
        let given = in_slabs(write(py, &self.given)?.into_any())?;
        Ok((restore, PyTuple::new(py, [body, given, wheels])?))
    }

    /// What `__reduce__` took apart; for pickle.
    #[staticmethod]
    fn _from_parts(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        momentum: &Bound<'_, PyAny>,
        wheels: &Bound<'_, PyTuple>,
    ) -> PyResult<Self> {
        Self::new(py, body, read(momentum, "momentum")?, wheels)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// Equal bodies with equal momenta and wheels.
    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(false);
        };
        let other = other.get();
        let same = self.given == other.given && self.gyrostats == other.gyrostats;
        Ok(same
            && self.body.bind(py).eq(other.body.bind(py))?
            && self.wheels.bind(py).eq(other.wheels.bind(py))?)
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.body.bind(py).hash()
    }

    /// One gyrostat by what is inside; a stack by its shape.
    fn __repr__(&self, py: Python<'_>) -> String {
        let wheels = match self.wheels.bind(py).len() {
            0 => String::new(),
            1 => ", 1 wheel".to_owned(),
            n => format!(", {n} wheels"),
        };
        if !self.gyrostats.shape.is_empty() {
            return format!(
                "<Gyrostat stack of shape {}: {} gyrostats{wheels}>",
                tuple(&self.gyrostats.shape),
                self.gyrostats.rows.len()
            );
        }
        let [x, y, z] = (self.gyrostats[0].inside.momentum).map(DoubleDouble::rounded);
        format!("<Gyrostat: momentum=[{x:?}, {y:?}, {z:?}]{wheels}>")
    }
}

// The steady rotations of a gyrostat.

#[pymethods]
impl PyGyrostat {
    /// All steady rotations with a given length of L = I ω + h, and whether they are stable.
    ///
    /// Parameters
    /// ----------
    /// momentum : float
    ///     The length of L.
    ///
    /// Returns
    /// -------
    /// Equilibria
    ///     Two, four or six steady rotations. For a body with two equal moments, an entry may stand for a
    ///     circle of them.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a stack. For free wheels too, since their h depends on ω at the start; use
    ///     :meth:`GyrostatMotion.equilibria`.
    ///
    /// Examples
    /// --------
    /// A wheel along the middle axis makes the spin about that axis stable, if it has enough momentum:
    ///
    /// >>> import polhode
    /// >>> body = polhode.RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> print(*body.gyrostat((0, 0.2, 0)).equilibria(2.0).kind)
    /// minimum minimum saddle saddle maximum maximum
    /// >>> print(*body.gyrostat((0, 2.5, 0)).equilibria(2.0).kind)
    /// minimum maximum
    fn equilibria<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] momentum: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let [one] = &self.gyrostats.rows[..] else {
            return Err(PyValueError::new_err(
                "equilibria: expected one gyrostat, got a stack; ask them one by one",
            ));
        };
        if one.inside.free.iter().flatten().any(|x| x.high != 0.0) {
            return Err(PyValueError::new_err(
                "equilibria: the momentum of free wheels depends on ω at the start; ask `equilibria` of the motion, or give \
                 momentum= in place of wheels",
            ));
        }
        let found = one
            .equilibria(momentum, &Vector3::zeros())
            .map_err(|error| to_py(py, &error))?;
        table(py, found)
    }

    /// Inertia tensor in the equations of motion, in the body frame, shape (..., 3, 3).
    ///
    /// It is that of the body minus ``J a aᵀ`` of each free wheel, whose moment about its axis does not
    /// count.
    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let tensor = |one: &Gyrostat| -> Matrix3<f64> { one.inertia() };
        Ok(write_of(py, &self.gyrostats, tensor)?.into_any())
    }
}

#[pymethods]
impl PyGyrostatMotion {
    /// All steady rotations with the length of L and the h of this motion.
    ///
    /// Returns
    /// -------
    /// Equilibria
    ///     As :meth:`Gyrostat.equilibria` has them.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a stack.
    fn equilibria<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let ([motion], [gyrostat]) = (
            &self.motions.rows[..],
            &self.gyrostat.get().gyrostats.rows[..],
        ) else {
            return Err(PyValueError::new_err(
                "equilibria: expected one motion, got a stack; ask them one by one",
            ));
        };
        let momentum = motion.angular_momentum.norm();
        let found = gyrostat
            .equilibria(momentum, &motion.initial.omega)
            .map_err(|error| to_py(py, &error))?;
        table(py, found)
    }
}

/// As `polhode.motion.gyrostat.Equilibria`.
fn table(py: Python<'_>, found: Equilibria) -> PyResult<Bound<'_, PyAny>> {
    let stack = |count: usize| vec![count];
    let all = Stack {
        shape: stack(found.found.len()),
        rows: found.found,
    };
    let changes = Stack {
        shape: stack(found.bifurcations.len()),
        rows: found.bifurcations,
    };
    let circle = |one: &Equilibrium| match one.extent {
        Extent::Circle(axis) => axis,
        Extent::Point | Extent::Sphere => [0.0; 3],
    };
    let word = |one: &Bifurcation| match one.meeting {
        Meeting::Fold => "fold",
        Meeting::Pitchfork => "pitchfork",
    };
    let module = py.import("polhode.motion.gyrostat")?;
    let bifurcations = module.getattr("Bifurcations")?.call1((
        write_words_of(py, &changes, word, "<U9")?,
        write_of(py, &changes, |one| one.direction)?,
        numbers(py, &changes, |one| one.momentum)?,
        numbers(py, &changes, |one| one.rotor)?,
    ))?;
    module.getattr("Equilibria")?.call1((
        write_of(py, &all, |one| one.direction)?,
        write_of(py, &all, |one| one.omega)?,
        numbers(py, &all, |one| one.kinetic_energy)?,
        numbers(py, &all, |one| one.squared_rate)?,
        write_words_of(py, &all, |one| one.kind.as_str(), "<U10")?,
        write_of(py, &all, circle)?,
        bifurcations,
    ))
}

fn numbers<'py, T>(
    py: Python<'py>,
    stack: &Stack<T>,
    of: impl Fn(&T) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    let numbers: Vec<f64> = stack.rows.iter().map(of).collect();
    Ok(PyArray1::from_vec(py, numbers)
        .reshape(stack.shape.clone())?
        .into_any())
}

// The class `GyrostatMotion`.

/// The motion of a gyrostat, or of a stack of them, on which no torque acts about its centre of mass.
///
/// Made by `Gyrostat.free_motion`. The motion is in closed form, by theta functions: a state after a million
/// rotations takes as long to compute as one near the start, and is as accurate. The object is immutable.
///
/// Attributes
/// ----------
/// gyrostat : Gyrostat
///     The gyrostat, or the stack of them.
/// body : RigidBody
///     Its body.
/// omega : numpy.ndarray, shape (..., 3)
///     Angular velocity at t = 0, of the body relative to space, components in the body frame.
/// quaternion : numpy.ndarray, shape (..., 4)
///     R_NB at t = 0 as (x, y, z, w).
/// shape : tuple of int
///     Shape of the stack of motions: gyrostats, angular velocities and attitudes broadcast together.
///
/// Examples
/// --------
/// A wheel along the middle axis keeps a racket from turning over:
///
/// >>> import numpy as np
/// >>> from polhode import RigidBody
/// >>> racket = RigidBody.from_principal(0.3, (0.0012, 0.0164, 0.0176))
/// >>> times = np.linspace(0, 10, 1001)
/// >>> for momentum in (0.0, 0.2):
/// ...     motion = racket.gyrostat((0, momentum, 0)).free_motion((0.001, 10.0, 0.0))
/// ...     print(motion.at(times).omega[:, 1].min().round(3))
/// -10.0
/// 10.0
#[pyclass(name = "GyrostatMotion", module = "polhode", frozen)]
pub(crate) struct PyGyrostatMotion {
    #[pyo3(get)]
    gyrostat: Py<PyGyrostat>,
    motions: Stack<GyrostatMotion>,
}

impl PyGyrostatMotion {
    fn new(
        py: Python<'_>,
        gyrostat: Py<PyGyrostat>,
        omega: &Stack<Vector3<f64>>,
        attitude: &Stack<UnitQuaternion<f64>>,
    ) -> PyResult<Self> {
        let all = &gyrostat.get().gyrostats;
        let shapes = [&all.shape[..], &omega.shape, &attitude.shape];
        let motions = Broadcast::of(["gyrostat", "omega", "attitude"], shapes)?
            .try_map(py, |[g, w, q]| all[g].free_motion(&omega[w], &attitude[q]))?;
        Ok(Self { gyrostat, motions })
    }

    fn numbers<'py>(
        &self,
        py: Python<'py>,
        f: fn(&GyrostatMotion) -> f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        write_numbers_of(py, &self.motions, f)
    }
}

#[pymethods]
impl PyGyrostat {
    /// Asked where there is no such attribute.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<Py<PyAny>> {
        Err(crate::hints::no_attribute(slf.as_any(), name))
    }

    /// The motion when no torque acts about the centre of mass, in closed form.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity at t = 0, of the body relative to space, components in the body frame.
    /// attitude : array_like, shape (..., 4), or rotation, optional
    ///     R_NB at t = 0: unit quaternions (x, y, z, w), or anything with ``as_quat()`` such as SciPy's
    ///     Rotation. The identity by default.
    ///
    /// Returns
    /// -------
    /// GyrostatMotion
    ///     Gyrostats, angular velocities and attitudes broadcast together.
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     When `omega` is not finite, `attitude` is not a rotation, the body has a zero moment, or ω would
    ///     have lost more than seven of its sixteen digits.
    ///
    /// Notes
    /// -----
    /// The error of ω has two parts. The first is the rounding error times the ratio of the largest moment to
    /// the least. It matters for thin bodies that do not turn fast about their long axis. The second is 1e-31
    /// times h/I, the momentum inside divided by a moment. It matters for bodies that hardly turn.
    /// :meth:`RigidBody.simulate` under :func:`polhode.loads.rotor` has neither.
    ///
    /// Examples
    /// --------
    /// Without momentum inside it is the free motion of the body, to the last bit:
    ///
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> motion = body.gyrostat((0, 0, 0)).free_motion((0.3, 0.2, 1.1))
    /// >>> bool((motion.at(1e6).omega == body.free_motion((0.3, 0.2, 1.1)).at(1e6).omega).all())
    /// True
    #[pyo3(signature = (omega, attitude=None))]
    fn free_motion(
        slf: Py<Self>,
        py: Python<'_>,
        omega: &Bound<'_, PyAny>,
        attitude: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyGyrostatMotion> {
        let given = StartArguments::read(omega, attitude)?;
        if given.uncertain.is_any() || slf.get().body.get().uncertainties.is_some() {
            return Err(PyValueError::new_err(
                "Gyrostat.free_motion: sigmas are not followed through the motion of a gyrostat: give plain numbers",
            ));
        }
        let attitude = read_attitude(given.attitude.as_ref(), "attitude")?;
        let omega = read(&given.omega, "omega")?;
        PyGyrostatMotion::new(py, slf, &omega, &attitude)
    }
}

#[pymethods]
impl PyGyrostatMotion {
    /// Asked where there is no such attribute.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<Py<PyAny>> {
        Err(crate::hints::no_attribute(slf.as_any(), name))
    }

    /// The body.
    #[getter]
    fn body(&self, py: Python<'_>) -> Py<PyRigidBody> {
        self.gyrostat.get().body.clone_ref(py)
    }

    /// Angular velocity of the body relative to space at t = 0, components in the body frame, in radians per unit
    /// of time, shape (..., 3).
    #[getter]
    fn omega<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(write_of(py, &self.motions, |motion| motion.initial.omega)?.into_any())
    }

    /// Attitude R_NB at t = 0 as a unit quaternion (x, y, z, w), shape (..., 4).
    #[getter]
    fn quaternion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let attitude = |motion: &GyrostatMotion| components(&motion.initial.attitude);
        Ok(write_of(py, &self.motions, attitude)?.into_any())
    }

    /// Shape of the stack of motions, as a tuple of int; ``()`` for one motion.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.motions.shape)
    }

    /// Kind of motion: the first that applies of "steady", "circular", "separatrix", "paired", "single".
    ///
    /// In the body frame, L moves on a sphere, along a curve of constant energy. Steady: L rests. Circular:
    /// the elliptic functions are sines, as for equal moments or for a symmetric body with its momentum along
    /// the axis. Separatrix: L approaches an unstable steady spin for ever. Paired: two closed curves have
    /// this energy, and L moves on one of them, as always for a free body. Single: only one closed curve has
    /// this energy. A string, or an array of them for a stack.
    #[getter]
    fn mode<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        write_words_of(py, &self.motions, |motion| motion.mode.as_str(), "<U10")
    }

    /// The periods of the motion: each mode has its own, and those that it does not have are NaN.
    ///
    /// Returns
    /// -------
    /// Periods
    ///     ``turn``, ``wobble``: of a steady rotation. ``rotation``: the time after which the components of ω
    ///     and L in the body repeat, of every other motion; infinite where they never repeat. The others are NaN:
    ///     the mean rate about L is known except for whole turns, see :attr:`mean_precession`.
    #[getter]
    fn periods<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let gyrostats = &self.gyrostat.get().gyrostats;
        let shapes = [&gyrostats.shape[..], &self.motions.shape];
        let periods = Broadcast::of(["gyrostat", "motion"], shapes)?
            .try_map(py, |[g, m]| self.motions[m].periods(&gyrostats[g]))?;
        write_periods(py, &periods)
    }

    /// Mean rate, in radians per unit of time, at which the body precesses about L.
    ///
    /// After one period of ω the body has turned about L by an angle. This angle, divided by the period, is the
    /// mean rate. The closed form gives the angle except for whole turns, so the true mean rate may differ by
    /// whole turns per period.
    #[getter]
    fn mean_precession<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, |motion| motion.mean_precession.rounded())
    }

    /// Angular momentum L about the centre of mass, which rests.
    ///
    /// Parameters
    /// ----------
    /// frame : {"space", "body"}, optional
    ///     The frame whose axes the components refer to. In space L is constant; in the body it is not, and the
    ///     result is that at t = 0.
    ///
    /// Returns
    /// -------
    /// AngularMomentum
    ///     Each part of shape (..., 3). The part ``spin`` includes the wheels; the others are zero.
    #[pyo3(signature = (frame="space"))]
    fn angular_momentum<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] frame: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let in_space = |motion: &GyrostatMotion| motion.angular_momentum;
        let in_body = GyrostatMotion::angular_momentum_in_body;
        angular_momentum(py, &self.motions, frame, in_space, in_body)
    }

    /// Kinetic energy without that of the wheels in their own rotation. It is constant; the centre of mass
    /// rests.
    ///
    /// Returns
    /// -------
    /// KineticEnergy
    ///     Each part of shape (...). The part ``rotational`` is ``½ ω·(I − Σ J a aᵀ) ω``, with the sum over the
    ///     free wheels; the others are zero.
    fn kinetic_energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        kinetic_energy(py, &self.motions, |motion| motion.kinetic_energy)
    }

    /// Constant angular momentum h inside, components in the body frame, shape (..., 3); for a free wheel it
    /// is ``J (Ω + a·ω)`` along its axis.
    #[getter]
    fn rotor<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        write_of(py, &self.motions, |motion| {
            Vector3::from(motion.rotor.map(DoubleDouble::rounded))
        })
    }

    /// Attitude and angular velocity at the times asked for.
    ///
    /// Parameters
    /// ----------
    /// t : array_like
    ///     Times of any shape and in any order, negative ones too; each motion is evaluated at each time.
    ///
    /// Returns
    /// -------
    /// Trajectory
    ///     The axes of its ``omega`` and ``quaternion`` are those of the stack, then those of `t`, then the
    ///     components. The quaternion is continuous in time. A time that is not finite gives NaN. A time
    ///     after more than 2⁸⁸ turns is an error: no digit of the phase is known there. The angular momentum
    ///     of the trajectory includes the wheels. If `t` is a dask array, the result is an `xarray.Dataset`
    ///     that is computed later, chunk by chunk, with the same bits.
    ///
    /// Notes
    /// -----
    /// The computation releases the GIL and uses all cores for many states; Ctrl-C ends it. A state has the
    /// same bits whether it is computed alone or together with others.
    fn at<'py>(slf: &Bound<'py, Self>, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        if is_any(&[Some(t)])
            && let Some(motion) = handed_over(py, "motion_at", (slf, t), None)?
        {
            return Ok(motion);
        }
        let gyrostat = this.gyrostat.get();
        let centers = gyrostat
            .body
            .get()
            .bodies
            .map(py, RigidBody::center_of_mass)?;
        let uncertain = UncertainStart::default();
        let motion = trajectory(
            py,
            &gyrostat.body,
            &this.motions,
            t,
            &centers,
            (&uncertain, slf.as_any()),
            PyDict::new(py),
        )?;
        // What is carried along is computed for those who ask.
        let known = motion.getattr("__dict__")?;
        known.del_item("carried")?;
        known.set_item("_origin", origin(py, "motion", slf)?)?;
        Ok(motion)
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_start")?;
        let gyrostat = self.gyrostat.bind(py).clone().into_any();
        let [omega, quaternion] = [self.omega(py)?, self.quaternion(py)?].map(in_slabs);
        let parts = [gyrostat, omega?, quaternion?];
        Ok((restore, PyTuple::new(py, parts)?))
    }

    /// The motions that `__reduce__` took apart; for pickle.
    #[staticmethod]
    fn _from_start(
        py: Python<'_>,
        gyrostat: Py<PyGyrostat>,
        omega: &Bound<'_, PyAny>,
        quaternion: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let quaternion: Stack<[f64; 4]> = read(quaternion, "quaternion")?;
        let attitude = quaternion.map(py, |&[x, y, z, w]| {
            UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)) // to the last bit
        })?;
        Self::new(py, gyrostat, &read(omega, "omega")?, &attitude)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// One motion by its start; a stack by its shape.
    fn __repr__(&self) -> String {
        if !self.motions.shape.is_empty() {
            let count = self.motions.rows.len();
            return format!(
                "<GyrostatMotion stack of shape {}: {count} motions>",
                tuple(&self.motions.shape)
            );
        }
        let motion = &self.motions[0];
        let [p, q, r]: [f64; 3] = motion.initial.omega.into();
        format!(
            "<GyrostatMotion: {}, omega=[{p:?}, {q:?}, {r:?}]>",
            motion.mode
        )
    }
}
