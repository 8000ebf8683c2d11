//! The class `FreeMotion`: exact motions of free bodies.

mod constants;
mod from_periods;
mod in_time;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::mass::refined::RefinedPrincipal;
use polhode::motion::attitude::components;
use polhode::motion::free::FreeMotion;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{in_slabs, read, write_of};
use crate::attitudes::read_attitude;
use crate::body::PyRigidBody;
use crate::closed_form::trajectory;
use crate::elsewhere::{handed_over, is_any};
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{PyUncertain, StartGiven, UncertainStart};

/// The motion of a body, or of a stack of bodies, on which no torque acts about its centre of mass.
///
/// Made by `RigidBody.free_motion`. The motion is in closed form, by theta functions: a state after a million
/// rotations takes as long to compute as one near the start, and is as accurate. The object is immutable.
///
/// Attributes
/// ----------
/// body : RigidBody
///     The body, or the stack of them.
/// omega : numpy.ndarray, shape (..., 3)
///     Angular velocity at t = 0, of the body relative to space, components in the body frame.
/// quaternion : numpy.ndarray, shape (..., 4)
///     Attitude R_NB at t = 0 as (x, y, z, w).
/// uncertain_start : tuple of Uncertain or None
///     Angular velocity and attitude at t = 0 as `Uncertain`, each None where it was given without a sigma.
/// shape : tuple of int
///     Shape of the stack of motions: bodies, angular velocities and attitudes broadcast together.
///
/// Examples
/// --------
/// A racket spun about its middle axis, almost, soon turns over:
///
/// >>> from polhode import RigidBody
/// >>> racket = RigidBody.from_principal(0.3, (0.0012, 0.0164, 0.0176))
/// >>> motion = racket.free_motion(omega=(0.001, 10.0, 0.0))
/// >>> motion.at([0.0, 0.5, 1.0, 1.25, 1.5]).omega[:, 1].round(3)
/// array([10.   , 10.   ,  8.626, -7.698, -9.975])
#[pyclass(name = "FreeMotion", module = "polhode", frozen)]
pub(crate) struct PyFreeMotion {
    #[pyo3(get)]
    body: Py<PyRigidBody>,
    pub(crate) motions: Stack<FreeMotion>,
    uncertain: UncertainStart,
    /// The periods that it was made from, where those or the body are uncertain: for each source the motion is found anew.
    from_periods: Option<Py<PyAny>>,
}

impl PyFreeMotion {
    fn new(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        omega: &Stack<Vector3<f64>>,
        attitude: &Stack<UnitQuaternion<f64>>,
        uncertain: UncertainStart,
    ) -> PyResult<Self> {
        let bodies = &body.get().bodies;
        let shapes = [&bodies.shape[..], &omega.shape, &attitude.shape];
        let starts = Broadcast::of(["body", "omega", "attitude"], shapes)?;
        let motions = if starts.len() == bodies.rows.len() {
            starts.try_map(py, |[b, w, q]| {
                FreeMotion::of(&bodies[b], &omega[w], &attitude[q])
            })?
        } else {
            // Several starts of a body: it is refined once.
            let refined = Broadcast::of(["body"], [&bodies.shape])?
                .try_map(py, |[b]| Ok(RefinedPrincipal::of(&bodies[b])))?;
            starts.try_map(py, |[b, w, q]| {
                FreeMotion::refined(&refined[b], &omega[w], &attitude[q])
            })?
        };
        Ok(Self {
            body,
            motions,
            uncertain,
            from_periods: None,
        })
    }

    /// Whether the body or the start has a sigma.
    fn is_uncertain(&self) -> bool {
        self.body.get().doubts.is_some() || self.uncertain.is_any()
    }

    fn centers(&self, py: Python<'_>) -> PyResult<Stack<Vector3<f64>>> {
        self.body.get().bodies.map(py, RigidBody::center_of_mass)
    }
}

#[pymethods]
impl PyRigidBody {
    /// The motion of the body when no torque acts about its centre of mass (Euler's problem), in closed form.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3), or Uncertain
    ///     Angular velocity at t = 0, of the body relative to space, components in the body frame.
    /// attitude : array_like, shape (..., 4), rotation or Uncertain, optional
    ///     R_NB at t = 0: unit quaternions (x, y, z, w), or anything with ``as_quat()`` such as SciPy's
    ///     Rotation. The identity by default.
    ///
    /// Returns
    /// -------
    /// FreeMotion
    ///     Bodies, angular velocities and attitudes broadcast together.
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     When `omega` is not finite or `attitude` is not a rotation.
    ///
    /// Notes
    /// -----
    /// The numbers that define the body, its principal moments or its tensor, are taken as exact, and the
    /// constants of the motion are computed from them in twice the precision. About an axis with zero moment,
    /// the angular velocity stays constant.
    ///
    /// Examples
    /// --------
    /// NASA's tumbling brick (NASA/TM-2015-218675, check case 2) after 30 seconds, in degrees a second:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(0.155404754, (0.001894220, 0.006211019, 0.007194665))
    /// >>> motion = brick.free_motion(omega=np.radians([10, 20, 30]))
    /// >>> np.degrees(motion.at(30.0).omega).round(6)
    /// array([ 12.618391, -17.397475,  31.119589])
    #[pyo3(signature = (omega, attitude=None))]
    fn free_motion(
        slf: Py<Self>,
        py: Python<'_>,
        omega: &Bound<'_, PyAny>,
        attitude: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyFreeMotion> {
        let given = StartGiven::read(omega, attitude)?;
        let attitude = read_attitude(given.attitude.as_ref(), "attitude")?;
        let omega = read(&given.omega, "omega")?;
        PyFreeMotion::new(py, slf, &omega, &attitude, given.uncertain)
    }
}

#[pymethods]
impl PyFreeMotion {
    /// Asked where there is no such attribute.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<Py<PyAny>> {
        Err(crate::hints::no_attribute(slf.as_any(), name))
    }

    /// Angular velocity of the body relative to space at t = 0, components in the body frame, in radians per unit
    /// of time, shape (..., 3).
    #[getter]
    fn omega<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let omegas = write_of(py, &self.motions, |motion| motion.initial.omega)?;
        Ok(omegas.into_any())
    }

    /// Attitude R_NB at t = 0 as a unit quaternion (x, y, z, w), shape (..., 4).
    #[getter]
    fn quaternion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let attitude = |motion: &FreeMotion| components(&motion.initial.attitude);
        Ok(write_of(py, &self.motions, attitude)?.into_any())
    }

    /// Angular velocity and attitude at t = 0 as `Uncertain`, each None where it was given without a sigma.
    #[getter]
    fn uncertain_start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.uncertain.to_python(py)
    }

    /// The periods of an uncertain motion that was made from them, else None.
    #[getter]
    fn _from_periods(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.from_periods.as_ref().map(|given| given.clone_ref(py))
    }

    /// Shape of the stack of motions, as a tuple of int; ``()`` for one motion.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.motions.shape)
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
    ///     after more than 2⁸⁸ turns is an error: no digit of the phase is known there. If `t` is a dask
    ///     array, the result is an `xarray.Dataset` that is computed later, chunk by chunk, with the same
    ///     bits.
    ///
    /// Notes
    /// -----
    /// The computation releases the GIL and uses all cores for many states; Ctrl-C ends it. A state has the
    /// same bits whether it is computed alone or together with others.
    ///
    /// Examples
    /// --------
    /// A flat disk that wobbles: in the body, ω goes once round the axis while the disk spins once:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import laminae
    /// >>> motion = laminae.disk(radius=0.01, mass=0.005).free_motion(omega=(0.1, 0.0, 10.0))
    /// >>> spin = 2 * np.pi / 10.0
    /// >>> motion.at([0.0, spin / 4, spin / 2]).omega.round(3)
    /// array([[ 0.1,  0. , 10. ],
    ///        [ 0. ,  0.1, 10. ],
    ///        [-0.1,  0. , 10. ]])
    fn at<'py>(slf: &Bound<'py, Self>, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        if is_any(&[Some(t)])
            && let Some(motion) = handed_over(py, "motion_at", (slf, t), None)?
        {
            return Ok(motion);
        }
        let fields = PyDict::new(py);
        let centers = this.centers(py)?;
        let uncertain = (&this.uncertain, slf.as_any());
        trajectory(
            py,
            &this.body,
            &this.motions,
            t,
            &centers,
            uncertain,
            fields,
        )
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_start")?;
        let body = self.body.bind(py).clone().into_any();
        let uncertain = self.uncertain_start(py)?.into_any();
        let [omega, quaternion] = [self.omega(py)?, self.quaternion(py)?].map(in_slabs);
        let given = self._from_periods(py).into_pyobject(py)?.into_any();
        let parts = [body, omega?, quaternion?, uncertain, given];
        Ok((restore, PyTuple::new(py, parts)?))
    }

    /// The motions that `__reduce__` took apart; for pickle.
    #[staticmethod]
    #[pyo3(signature = (body, omega, quaternion, uncertain_start, from_periods=None))]
    fn _from_start(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        omega: &Bound<'_, PyAny>,
        quaternion: &Bound<'_, PyAny>,
        uncertain_start: (Option<Py<PyUncertain>>, Option<Py<PyUncertain>>),
        from_periods: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let quaternion: Stack<[f64; 4]> = read(quaternion, "quaternion")?;
        let attitude = quaternion.map(py, |&[x, y, z, w]| {
            UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)) // to the last bit
        })?;
        let uncertain = UncertainStart::restored(uncertain_start);
        let motion = Self::new(py, body, &read(omega, "omega")?, &attitude, uncertain)?;
        Ok(Self {
            from_periods,
            ..motion
        })
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
                "<FreeMotion stack of shape {}: {count} motions>",
                tuple(&self.motions.shape)
            );
        }
        let motion = &self.motions[0];
        let [p, q, r]: [f64; 3] = motion.initial.omega.into();
        format!("<FreeMotion: {}, omega=[{p:?}, {q:?}, {r:?}]>", motion.mode)
    }
}
