//! The class `FreeMotion`: exact motions of free bodies.

use nalgebra::{Matrix6, Quaternion, UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::mass::refined::RefinedPrincipal;
use polhode::motion::attitude::components;
use polhode::motion::closed_form::ClosedForm;
use polhode::motion::free::{
    CircledAxis, FreeMotion, FromPeriods, Invariants, Periods, attitude_about,
};
use polhode::motion::stability::stability;
use polhode::{DoubleDouble, Error, RigidBody};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{
    Argument, Item, Numbers, in_slabs, read, read_or, read_scalar, write, write_any_of,
    write_numbers_of, write_of, write_words_of,
};
use crate::attitudes::read_attitude;
use crate::body::PyRigidBody;
use crate::closed_form::{angular_momentum, kinetic_energy, trajectory};
use crate::lazy_arrays::{handed_over, is_any};
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{PyUncertain, StartArguments, UncertainStart, value_of};

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
                FreeMotion::from_refined(&refined[b], &omega[w], &attitude[q])
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
        self.body.get().uncertainties.is_some() || self.uncertain.is_any()
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
        let given = StartArguments::read(omega, attitude)?;
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
    #[getter(_from_periods)]
    fn given_periods(&self, py: Python<'_>) -> Option<Py<PyAny>> {
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
        let given = self.given_periods(py).into_pyobject(py)?.into_any();
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
        let uncertain = UncertainStart::restore(uncertain_start);
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

// What a free motion tells at a time: herpolhode, Poinsot's picture, derivatives, error bars.

impl PyFreeMotion {
    /// `f` of every motion at every time, under the shape of the stack and then that of the times.
    fn each_time<R: Clone + Send>(
        &self,
        py: Python<'_>,
        t: &Bound<'_, PyAny>,
        f: impl Fn(&FreeMotion, f64) -> Result<R, Error> + Sync,
    ) -> PyResult<Stack<R>> {
        let times: Stack<f64> = read(t, "t")?;
        let spread = vec![1; times.shape.len()];
        let shapes = [
            &[&self.motions.shape[..], &spread].concat()[..],
            &times.shape,
        ];
        Broadcast::of(["motion", "t"], shapes)?.try_map(py, |[m, k]| f(&self.motions[m], times[k]))
    }

    /// As [`Self::each_time`], for what is known within the reach of the motion alone.
    fn each_time_within<R: Clone + Send>(
        &self,
        py: Python<'_>,
        t: &Bound<'_, PyAny>,
        f: impl Fn(&FreeMotion, f64) -> R + Sync,
    ) -> PyResult<Stack<R>> {
        self.each_time(py, t, |motion, t| {
            motion.reaches(t)?;
            Ok(f(motion, t))
        })
    }
}

#[pymethods]
impl PyFreeMotion {
    /// The herpolhode: the curve of the tip of the angular velocity in space, in the invariable plane.
    ///
    /// Parameters
    /// ----------
    /// t : array_like
    ///     Times of any shape.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     ω, components in space; the axes are those of the stack, then those of `t`. The component of ω
    ///     along L is constant: it is the distance of the invariable plane from C. In that plane the curve
    ///     stays in a ring, whose radii `poinsot` gives. In general the curve never closes.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> motion = brick.free_motion(omega=(0.3, 0.2, 1.1))
    /// >>> tip = motion.herpolhode(np.linspace(0, 20, 5))
    /// >>> (tip @ motion.poinsot(0.0).normal).round(12)
    /// array([1.14307795, 1.14307795, 1.14307795, 1.14307795, 1.14307795])
    fn herpolhode<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        write(py, &self.each_time_within(py, t, FreeMotion::herpolhode)?)
    }

    /// Poinsot's construction: the ellipsoid of energy, fixed in the body, rolls on a plane fixed in space.
    ///
    /// The ellipsoid ``ω·I ω = 2T`` has its centre in C; it touches the plane at the tip of ω, where both have the
    /// normal L.
    ///
    /// Parameters
    /// ----------
    /// t : array_like
    ///     Times of any shape.
    ///
    /// Returns
    /// -------
    /// Poinsot
    ///     ``semi_axes`` of the ellipsoid along the principal axes, shape (..., 3); ``normal`` of the plane in space,
    ///     shape (..., 3); its ``distance`` from C; the ``radii`` of the ring that holds the herpolhode, shape (..., 2);
    ///     the point of ``contact`` in space at each time, as `herpolhode` gives it.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> found = brick.free_motion(omega=(0.3, 0.2, 1.1)).poinsot(0.0)
    /// >>> round(found.distance, 6), found.radii.round(6)
    /// (1.143078, array([0.07983 , 0.203403]))
    fn poinsot<'py>(&self, py: Python<'py>, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let plane = self
            .motions
            .map(py, |motion| Invariants::of_motion(motion).poinsot())?;
        let parts = (
            write_of(py, &plane, |plane| plane.semi_axes)?,
            write_of(py, &self.motions, FreeMotion::normal)?,
            write_numbers_of(py, &plane, |plane| plane.distance)?,
            write_of(py, &plane, |plane| plane.radii)?,
            self.herpolhode(py, t)?,
        );
        named_tuple(py, "Poinsot", parts)
    }

    /// Derivatives of the state at a time by the initial state and by the principal moments, in closed form.
    ///
    /// Parameters
    /// ----------
    /// t : array_like
    ///     Times of any shape.
    ///
    /// Returns
    /// -------
    /// Sensitivity
    ///     ``state``, shape (..., 6, 6): derivatives of (δ, ω) at `t` by (δ, ω) at t = 0. δ is a small
    ///     rotation from the attitude R, ``R → R exp(δ×)``, components in the body frame, in radians.
    ///     ``moments``, shape (..., 6, 3): derivatives of (δ, ω) at `t` by the principal moments in ascending
    ///     order; principal axes and initial state stay fixed.
    ///
    /// Notes
    /// -----
    /// No finite differences are taken and no equation is integrated. The addition theorems of the elliptic
    /// functions give ω; the conservation of angular momentum and energy gives the attitude. The derivatives
    /// after a million rotations therefore take as long to compute as those near the start. Their error is
    /// the same too: a few ε relative to the largest derivative, in units of the spin rate.
    ///
    /// Symmetric and spherical bodies, steady spins and the separatrix are limits, which are taken without
    /// loss of digits. `moments` is NaN for a body with a zero moment, since no moment can be negative. After
    /// a long time on the separatrix some derivatives overflow; these are NaN.
    ///
    /// Examples
    /// --------
    /// A small disturbance of a spin about the intermediate axis grows as the linear theory says:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> motion = brick.free_motion(omega=(0, 6.0, 0))
    /// >>> growth = motion.sensitivity(5.0).state[3, 3]  # of the component of ω along axis 1, by itself
    /// >>> rate = np.sqrt(-brick.stability(6.0)[1])
    /// >>> round(growth), round(np.cosh(rate * 5.0))
    /// (335461, 335461)
    fn sensitivity<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let found = self.each_time_within(py, t, FreeMotion::sensitivity)?;
        let parts = (
            write_of(py, &found, |at| Matrix6::from(at.state))?,
            write_of(py, &found, |at| at.moments)?,
        );
        named_tuple(py, "Sensitivity", parts)
    }

    /// Bounds on the errors of the state at a time that errors of the start and of the moments cause.
    ///
    /// Parameters
    /// ----------
    /// t : array_like
    ///     Times of any shape.
    /// rtol : float, optional
    ///     Relative error of the angular velocity at the start and of each principal moment, and error of the
    ///     attitude in radians; by default that of float64.
    ///
    /// Returns
    /// -------
    /// ErrorBar
    ///     Bounds to first order, for errors in the worst directions: ``attitude`` bounds the angle by which
    ///     the attitude is wrong, in radians; ``omega`` bounds the length of the error of the angular
    ///     velocity. The error of the computation itself is far smaller than such errors of the input. One part
    ///     of it grows with time: the error of the phases, 2⁻⁹⁰ of the angle turned. The bounds include this
    ///     part, even with ``rtol=0``. A bound is infinite where nothing is known about the state. A moment of zero is
    ///     taken as exact.
    ///
    /// Examples
    /// --------
    /// Moments that are known to one part in a thousand determine the attitude for a few dozen turns:
    ///
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> motion = brick.free_motion(omega=(0.3, 0.2, 1.1))
    /// >>> motion.error_bar([0.0, 6.0, 600.0], rtol=1e-3).attitude.round(3).tolist()
    /// [0.001, 0.012, 1.081]
    #[pyo3(
        signature = (t, rtol=f64::EPSILON),
        text_signature = "($self, t, rtol=2.220446049250313e-16)"
    )]
    fn error_bar<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        if !(rtol >= 0.0 && rtol.is_finite()) {
            return Err(PyValueError::new_err(format!(
                "rtol: expected a relative error, zero or more, got {rtol:?}"
            )));
        }
        let bars = self.each_time(py, t, |motion, t| Ok(motion.error_bar(t, rtol)))?;
        let parts = (
            write_numbers_of(py, &bars, |bar| bar.attitude)?,
            write_numbers_of(py, &bars, |bar| bar.omega)?,
        );
        named_tuple(py, "ErrorBar", parts)
    }
}

// What a free motion tells without a time: mode, constants, periods, angles.

type Array<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

impl PyFreeMotion {
    fn invariants(&self, py: Python<'_>) -> PyResult<Stack<Invariants>> {
        self.motions.map(py, Invariants::of_motion)
    }

    /// A float for one motion, an array for a stack.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        f: fn(&Invariants) -> f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        write_numbers_of(py, &self.invariants(py)?, f)
    }
}

/// As `polhode.motion.free.Periods`.
pub(crate) fn write_periods<'py>(
    py: Python<'py>,
    periods: &Stack<Periods>,
) -> PyResult<Bound<'py, PyAny>> {
    let parts = (
        write_numbers_of(py, periods, |periods| periods.turn)?,
        write_numbers_of(py, periods, |periods| periods.wobble)?,
        write_numbers_of(py, periods, |periods| periods.spin)?,
        write_numbers_of(py, periods, |periods| periods.rotation)?,
        write_numbers_of(py, periods, |periods| periods.precession)?,
        write_numbers_of(py, periods, |periods| periods.flip)?,
        write_of(py, periods, |periods| periods.rates)?,
    );
    named_tuple(py, "Periods", parts)
}

/// A named tuple of `polhode.motion.free`.
fn named_tuple<'py>(
    py: Python<'py>,
    name: &str,
    parts: impl pyo3::call::PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("polhode.motion.free")?
        .getattr(name)?
        .call1(parts)
}

/// Angles from the least to the greatest, for each axis.
struct Ranges([[f64; 2]; 3]);

impl Item for Ranges {
    const TAIL: &'static [usize] = &[3, 2];

    fn read(numbers: &[f64]) -> Self {
        Self(std::array::from_fn(|k| {
            [numbers[2 * k], numbers[2 * k + 1]]
        }))
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend(self.0.as_flattened());
    }
}

#[pymethods]
impl PyFreeMotion {
    /// How the body moves: the first that fits of "spherical", "symmetric", "steady", "separatrix", "long-axis",
    /// "short-axis".
    ///
    /// Spherical and symmetric bodies have equal moments. A steady spin is along a principal axis. In
    /// long-axis mode (``L² < 2T I₂``) the angular velocity circles in the body about axis 1, that of the
    /// least moment; in short-axis mode (``L² > 2T I₂``) about axis 3; on the separatrix (both sides exactly
    /// equal) it approaches the intermediate axis for ever. A string, or an array of them for a stack.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> print(*brick.free_motion([(0.3, 0.2, 1.1), (1.3, 0.2, 0.1), (0, 1, 0)]).mode)
    /// short-axis long-axis steady
    #[getter]
    fn mode<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        write_words_of(py, &self.motions, |motion| motion.mode.as_str(), "<U10")
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
    ///     Each part of shape (..., 3). The part ``spin`` is ``I ω``; the others are zero.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> brick.free_motion(omega=(0.3, 0.2, 1.1)).angular_momentum().spin
    /// array([0.3 , 0.4 , 2.75])
    #[pyo3(signature = (frame="space"))]
    fn angular_momentum<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] frame: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (in_space, in_body) = (
            FreeMotion::angular_momentum,
            FreeMotion::angular_momentum_in_body,
        );
        angular_momentum(py, &self.motions, frame, in_space, in_body)
    }

    /// Kinetic energy, which is constant; the centre of mass rests.
    ///
    /// Returns
    /// -------
    /// KineticEnergy
    ///     Each part of shape (...). The part ``rotational`` is ``½ ω·I ω``; the others are zero.
    fn kinetic_energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        kinetic_energy(py, &self.invariants(py)?, Invariants::kinetic_energy)
    }

    /// ``T/T_min`` with ``T_min = L²/(2 I₃)``, the least energy of a body with this angular momentum.
    ///
    /// One for a spin about axis 3, ``I₃/I₁`` for one about axis 1, ``I₃/I₂`` on the separatrix. Known as E/E₀ of
    /// tumbling asteroids. NaN without angular momentum.
    #[getter]
    fn energy_ratio<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Invariants::energy_ratio)
    }

    /// k, the modulus of the elliptic functions of time (their parameter is m = k²).
    ///
    /// Zero for a symmetric body and in the limit of a steady spin about axis 1 or 3, one on the separatrix.
    #[getter]
    fn modulus<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Invariants::modulus)
    }

    /// Complementary modulus k′ = √(1 − k²), accurate near the separatrix too.
    #[getter]
    fn complementary_modulus<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Invariants::complementary_modulus)
    }

    /// The periods of the motion: each mode has its own, and those that it does not have are NaN.
    ///
    /// Returns
    /// -------
    /// Periods
    ///     ``turn``, ``wobble``: of a steady rotation. ``spin``, ``precession``: of a symmetric body.
    ///     ``rotation``, ``precession``: P_ψ and P_φ of long- and short-axis mode, in the long-axis convention
    ///     of the literature on tumbling asteroids. ``flip``: time from one turning over of the intermediate
    ///     axis to the next. ``rates``: mean rate of precession of each principal axis about L.
    ///
    /// Examples
    /// --------
    /// A wing nut, set spinning about its intermediate axis, turns over every seven seconds:
    ///
    /// >>> from polhode import RigidBody
    /// >>> nut = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> round(nut.free_motion(omega=(0.001, 6.0, 0.0)).periods.flip, 3)
    /// 7.366
    #[getter]
    fn periods<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        let periods = this.invariants(py)?.map(py, Invariants::periods)?;
        let found = write_periods(py, &periods)?;
        if this.is_uncertain() {
            found.setattr("_motion", slf)?;
        }
        Ok(found)
    }

    /// The standard deviations of `periods`.
    fn _periods_sigma<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        (slf.py().import("polhode.uncertainty.motion")?).call_method1("periods_sigma", (slf,))
    }

    /// Least and greatest angle between each principal axis and L, in radians, shape (..., 3, 2).
    ///
    /// This is the range of the Euler angle θ of that axis, with L along z. On the separatrix the bounds are
    /// limits, which the motion approaches. NaN without angular momentum.
    ///
    /// Examples
    /// --------
    /// A plate that wobbles keeps its axis, the third, at a constant angle from L:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> plate = RigidBody.from_principal(mass=1.0, moments=(1.0, 1.0, 2.0))
    /// >>> np.degrees(plate.free_motion(omega=(0.3, 0, 3)).nutation).round(3)
    /// array([[87.138, 92.862],
    ///        [87.138, 92.862],
    ///        [ 2.862,  2.862]])
    #[getter]
    fn nutation<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.invariants(py)?, |motion| {
            Ranges(motion.nutation())
        })
    }

    /// Half opening angles of the body cone and of the space cone, least and greatest, in radians.
    ///
    /// Returns
    /// -------
    /// Cones
    ///     ``axis``: the principal axis that ω circles, as an index counted from 0: 0 for axis 1, 2 for axis 3.
    ///     ``body``, shape (..., 2): angles between ω and that axis. ``space``, shape (..., 2): angles between
    ///     ω and L.
    ///
    /// Examples
    /// --------
    /// A symmetric body has round cones:
    ///
    /// >>> from polhode import laminae
    /// >>> plate = laminae.disk(radius=0.1, mass=0.2)
    /// >>> cones = plate.free_motion(omega=(0.3, 0, 3)).cones
    /// >>> cones.axis, cones.body.round(4), cones.space.round(4)
    /// (2, array([0.0997, 0.0997]), array([0.0497, 0.0497]))
    #[getter]
    fn cones<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let cones = self.invariants(py)?.map(py, Invariants::cones)?;
        let axis = if cones.is_one() {
            cones[0].axis.into_pyobject(py)?.into_any()
        } else {
            write_any_of(py, &cones, |cones| i64::try_from(cones.axis).unwrap_or(2))?
        };
        let parts = (
            axis,
            write_of(py, &cones, |cones| cones.body)?,
            write_of(py, &cones, |cones| cones.space)?,
        );
        named_tuple(py, "Cones", parts)
    }

    /// Stability of the steady spins about the principal axes with this angular momentum.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     For axis k the squared frequency, seen from the body, of small oscillations about a spin with
    ///     ``ω = L/I_k``, in (radians per unit of time)². If it is negative, the spin is unstable. NaN for an
    ///     axis with zero moment: no spin about it has angular momentum. `RigidBody.stability` computes it
    ///     for a spin rate instead.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> brick.free_motion(omega=(0, 2, 0)).stability().round(12)
    /// array([ 4.8 , -0.8 ,  0.96])
    fn stability<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.motions, |motion| {
            let moments = motion.moments.map(DoubleDouble::rounded);
            let rates = Invariants::of_motion(motion).steady_rates();
            std::array::from_fn::<_, 3, _>(|k| {
                if moments[k] > 0.0 {
                    stability(&moments, rates[k])[k]
                } else {
                    f64::NAN
                }
            })
        })
    }

    /// The polhode: the closed curve of the angular velocity in the body, exact.
    ///
    /// Parameters
    /// ----------
    /// n : int, optional
    ///     Number of points, at least two; the last point is equal to the first.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., n, 3)
    ///     Angular velocities, components in the body frame. The first is that at t = 0; the others follow in
    ///     the sense of the motion, in equal steps of the amplitude of the elliptic functions. If the angular
    ///     velocity is constant, all points are equal. On the separatrix the curve is the limit of the
    ///     polhodes next to it.
    ///
    /// Examples
    /// --------
    /// Every point has the energy and the momentum of the motion:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> curve = brick.free_motion(omega=(0.3, 0.2, 1.1)).polhode(5)
    /// >>> brick.kinetic_energy(curve).rotational.round(12)
    /// array([1.5975, 1.5975, 1.5975, 1.5975, 1.5975])
    #[pyo3(signature = (n=181))]
    fn polhode<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] n: i128,
    ) -> PyResult<Bound<'py, PyAny>> {
        if n < 2 {
            return Err(PyValueError::new_err(format!(
                "n: expected at least 2 points of a closed curve, got {n}"
            )));
        }
        let n = usize::try_from(n).unwrap_or(usize::MAX); // far beyond all memory, which is told below
        let shape = [&self.motions.shape[..], &[n]].concat();
        let mut numbers = Numbers::of::<Vector3<f64>>(py, "n", &shape)?;
        for motion in &self.motions.rows {
            numbers.put(motion.polhode_points(n), |point, out| point.write(out))?;
        }
        Ok(numbers.finish::<Vector3<f64>>(&shape)?.into_any())
    }
}

// The free motion that has two given periods.

#[pymethods]
impl PyRigidBody {
    /// The free motion with two given periods, as they are found from the light curve of a tumbling asteroid.
    ///
    /// Parameters
    /// ----------
    /// rotation_period : array_like, shape (...), or Uncertain
    ///     P_ψ: time after which the components of the angular velocity in the body repeat. In long-axis mode
    ///     it is the period of the rotation about the long axis (axis 1, of the least moment); in short-axis
    ///     mode that of the swing of the long axis to and fro.
    /// precession_period : array_like, shape (...), or Uncertain
    ///     P_φ: mean time in which the long axis goes once round L, in both modes.
    /// mode : {"long-axis", "short-axis"}
    ///     Whether the angular velocity circles axis 1 or axis 3 in the body. Most pairs of periods are those
    ///     of a motion in either mode, so there is no default.
    /// sense : {1, -1}, optional
    ///     Sign of the component of the angular velocity along that axis.
    /// phase : array_like, shape (...), optional
    ///     Phase at t = 0, as a fraction of the rotation period. At phase 0 the angular velocity is in the
    ///     plane of axes 1 and 3, and its component along the axis that it does not circle is positive.
    /// angular_momentum_direction : array_like, shape (..., 3), optional
    ///     Direction of L in space, as a vector of any length. At t = 0 the Euler angle φ of the long axis
    ///     about L is 0.
    ///
    /// Returns
    /// -------
    /// FreeMotion
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     If the body has no such mode, or if no motion has this ratio of periods. The message tells the
    ///     possible range.
    ///
    /// Notes
    /// -----
    /// The ratio P_ψ/P_φ has its least value for a steady spin about the circled axis, and grows to infinity
    /// at the separatrix. So at most one motion has a given ratio.
    ///
    /// If the body or a period is uncertain, the angular velocity is solved anew for each source of
    /// uncertainty. The given periods keep their own standard deviations, or none; what follows from them and
    /// from the moments gets one: :attr:`FreeMotion.uncertain_start` and :attr:`Periods.sigma`.
    ///
    /// Examples
    /// --------
    /// Toutatis, with the moments of its shape and its periods in days. The angle between the long axis and L
    /// varies between 49.18° and 50.10°:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> toutatis = RigidBody.from_principal(mass=1.0, moments=(1.0, 3.01307, 3.18992))
    /// >>> motion = toutatis.free_motion_from_periods(5.41, 7.35, mode="long-axis")
    /// >>> np.degrees(motion.nutation[0]).round(2)
    /// array([49.18, 50.1 ])
    #[pyo3(
        signature = (
            rotation_period, precession_period, mode=None, sense=1.0, phase=Argument::default(),
            angular_momentum_direction=Argument::default()
        ),
        text_signature = "($self, rotation_period, precession_period, mode, sense=1.0, phase=0.0, angular_momentum_direction=(0.0, 0.0, 1.0))"
    )]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn free_motion_from_periods(
        slf: Py<Self>,
        py: Python<'_>,
        rotation_period: &Bound<'_, PyAny>,
        precession_period: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = read_scalar)] mode: Option<&str>,
        #[pyo3(from_py_with = read_scalar)] sense: f64,
        phase: Argument<'_>,
        angular_momentum_direction: Argument<'_>,
    ) -> PyResult<PyFreeMotion> {
        let (circled, mode) = match mode {
            Some("long-axis") => (CircledAxis::Long, "long-axis"),
            Some("short-axis") => (CircledAxis::Short, "short-axis"),
            Some(other) => {
                return Err(PyValueError::new_err(format!(
                    "mode: expected \"long-axis\" or \"short-axis\", got \"{other}\""
                )));
            }
            None => {
                return Err(PyTypeError::new_err(
                    "mode: state which of the two motions has these periods: mode=\"long-axis\", where the angular \
                     velocity circles the axis of the least moment, or mode=\"short-axis\", where it circles that \
                     of the greatest",
                ));
            }
        };
        let (rotation_period, of_rotation) = value_of(rotation_period)?;
        let (precession_period, of_precession) = value_of(precession_period)?;
        let rotation: Stack<f64> = read(&rotation_period, "rotation_period")?;
        let precession: Stack<f64> = read(&precession_period, "precession_period")?;
        let phase = read_or(&phase, "phase", 0.0)?;
        let direction = read_or(
            &angular_momentum_direction,
            "angular_momentum_direction",
            Vector3::z(),
        )?;
        let bodies = &slf.get().bodies;
        let names = [
            "body",
            "rotation_period",
            "precession_period",
            "phase",
            "angular_momentum_direction",
        ];
        let shapes = [
            &bodies.shape[..],
            &rotation.shape,
            &precession.shape,
            &phase.shape,
            &direction.shape,
        ];
        let starts = Broadcast::of(names, shapes)?.try_map(py, |[b, r, p, f, d]| {
            let principal = bodies[b].principal();
            let wanted = FromPeriods {
                rotation: rotation[r],
                precession: precession[p],
                circled,
                sense,
                phase: phase[f],
            };
            let omega = wanted.omega(&principal.moments)?;
            let attitude =
                attitude_about(&principal.moments, &principal.axes, &omega, &direction[d])?;
            Ok::<_, Error>((principal.axes * omega, attitude))
        })?;
        let omega = starts.map(py, |start| start.0)?;
        let attitude = starts.map(py, |start| start.1)?;
        let certain = UncertainStart::default();
        let motion = PyFreeMotion::new(py, slf.clone_ref(py), &omega, &attitude, certain)?;
        if slf.get().uncertainties.is_none() && of_rotation.is_none() && of_precession.is_none() {
            return Ok(motion);
        }
        let given = PyDict::new(py);
        for (name, value, uncertainty) in [
            ("rotation_period", rotation_period, of_rotation),
            ("precession_period", precession_period, of_precession),
        ] {
            given.set_item(name, uncertainty.map_or(value, Bound::into_any))?;
        }
        given.set_item("mode", mode)?;
        given.set_item("sense", sense)?;
        given.set_item("phase", write_numbers_of(py, &phase, |&phase| phase)?)?;
        given.set_item(
            "angular_momentum_direction",
            write_of(py, &direction, |&direction| direction)?,
        )?;
        let room = py.import("polhode.uncertainty.motion")?;
        let (given, uncertain) = (room
            .call_method1("start_from_periods", (motion.into_pyobject(py)?, given))?)
        .extract::<(Py<PyAny>, _)>()?;
        let uncertain = UncertainStart::restore(uncertain);
        let motion = PyFreeMotion::new(py, slf, &omega, &attitude, uncertain)?;
        Ok(PyFreeMotion {
            from_periods: Some(given),
            ..motion
        })
    }
}
