//! The class `GyrostatMotion`.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::DoubleDouble;
use polhode::RigidBody;
use polhode::motion::attitude::components;
use polhode::motion::gyrostat::GyrostatMotion;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::PyGyrostat;
use crate::arrays::{in_slabs, read, write_numbers_of, write_of, write_words_of};
use crate::attitudes::read_attitude;
use crate::body::PyRigidBody;
use crate::closed_form::trajectory;
use crate::elsewhere::{handed_over, is_any};
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{StartGiven, UncertainStart};

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
    pub(super) gyrostat: Py<PyGyrostat>,
    pub(super) motions: Stack<GyrostatMotion>,
}

impl PyGyrostatMotion {
    pub(super) fn new(
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
        let given = StartGiven::read(omega, attitude)?;
        if given.uncertain.is_any() || slf.get().body.get().doubts.is_some() {
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

    /// Time after which the components of ω and L in the body repeat; infinite where they never repeat, NaN where
    /// they are constant (``mode`` "steady").
    #[getter]
    fn period<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, |motion| motion.period.rounded())
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

    /// Angular momentum L about the centre of mass with that of the wheels, components in space, shape (...,
    /// 3). It is constant.
    #[getter]
    fn angular_momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        write_of(py, &self.motions, |motion| motion.angular_momentum)
    }

    /// Kinetic energy without that of the wheels in their own rotation: ``½ ω·(I − Σ J a aᵀ) ω``, with the
    /// sum over the free wheels. It is constant.
    #[getter]
    fn kinetic_energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, |motion| motion.kinetic_energy)
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
        known.set_item("_within", slf)?;
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
