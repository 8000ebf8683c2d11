//! The class `HeavyTop`: exact motions of heavy symmetric tops about a fixed point.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::attitude::components;
use polhode::motion::heavy_top::{HeavyTop, Nutation, PivotedTop};
use polhode::principal::TOP_RTOL;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{
    Numbers, in_slabs, read, read_scalar, write, write_numbers, write_numbers_of, write_of,
    write_words_of,
};
use crate::attitudes::read_attitude_exactly;
use crate::body::PyRigidBody;
use crate::closed_form::trajectory;
use crate::hints::no_gravity;
use crate::lazy_arrays::{handed_over, is_any};
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};
use crate::tops::in_radians;
use crate::uncertain::{PyUncertain, StartArguments, UncertainStart};

// The class `HeavyTop`: exact motions of heavy symmetric tops about a fixed point.

type Array<'py> = PyResult<Bound<'py, PyAny>>;

/// What a motion is made of.
#[derive(Clone, Copy)]
struct Start {
    top: PivotedTop,
    omega: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
    gravity: Vector3<f64>,
}

/// The motion of a heavy symmetric top, or of a stack of them, about the origin of the body frame, which is
/// fixed.
///
/// Made by `RigidBody.heavy_top`. The motion is in closed form, by theta functions: a state after a million
/// turns takes as long to compute as one near the start, and is as accurate. The object is immutable.
///
/// Attributes
/// ----------
/// body : RigidBody
///     The body, or the stack of them.
/// omega : numpy.ndarray, shape (..., 3)
///     Angular velocity at t = 0, of the body relative to space, components in the body frame.
/// quaternion : numpy.ndarray, shape (..., 4)
///     R_NB at t = 0 as (x, y, z, w).
/// gravity : numpy.ndarray, shape (..., 3)
///     The acceleration of free fall, components in space.
/// uncertain_start : tuple of Uncertain or None
///     Angular velocity and attitude at t = 0 where they were given with a sigma.
/// shape : tuple of int
///     Shape of the stack of motions: bodies, angular velocities, attitudes and gravities broadcast together.
/// mode : str or numpy.ndarray of str, shape (...)
///     How the axis moves on a sphere about the pivot, as a word.
/// nutation_limits : numpy.ndarray, shape (..., 2)
///     Least and largest inclination θ of the axis, from the pivot to the centre of mass, from the upward vertical.
/// nutation_period : float or numpy.ndarray, shape (...)
///     Time from one least inclination to the next: infinite in the mode "asymptotic", NaN where the inclination
///     is constant: in the modes "regular" and "steady".
/// mean_precession : float or numpy.ndarray, shape (...)
///     Mean rate at which the axis goes about the upward vertical, the mean of φ̇. Through the vertical φ jumps by half a
///     turn.
/// mean_spin : float or numpy.ndarray, shape (...)
///     Mean rate at which the body turns about its axis relative to the line of nodes, the mean of ψ̇.
/// axial_spin : float or numpy.ndarray, shape (...)
///     ω_s, the component of ω along the axis, which gravity leaves constant.
/// sleeping_limit : float or numpy.ndarray, shape (...)
///     The spin above which the top stands stably upright, 2 √(I_t m g l)/I_s: infinite without moment about the axis.
///
/// Examples
/// --------
/// The axis of a spinning top is let go at an inclination of 0.6 rad. It sinks to 0.7426 rad, rises again,
/// and comes to rest at 0.6 rad:
///
/// >>> from polhode import RigidBody, euler_angles
/// >>> body = RigidBody.from_principal(0.5, (2e-4, 2e-4, 3e-4), center_of_mass=(0, 0, 0.04))
/// >>> top = body.heavy_top((0, 0, 150), euler_angles.to_quaternion((0, 0.6, 0)), gravity=(0, 0, -9.81))
/// >>> top.mode, top.nutation_limits.round(4), round(top.nutation_period, 5)
/// ('cusp', array([0.6   , 0.7426]), 0.16619)
#[pyclass(name = "HeavyTop", module = "polhode", frozen)]
pub(crate) struct PyHeavyTop {
    #[pyo3(get)]
    body: Py<PyRigidBody>,
    starts: Stack<Start>,
    motions: Stack<HeavyTop>,
    rtol: f64,
    uncertain: UncertainStart,
}

impl PyHeavyTop {
    fn new(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        omega: &Stack<Vector3<f64>>,
        attitude: &Stack<UnitQuaternion<f64>>,
        gravity: &Stack<Vector3<f64>>,
        rtol: f64,
        uncertain: UncertainStart,
    ) -> PyResult<Self> {
        let bodies = &body.get().bodies;
        let tops = Broadcast::of(["body"], [&bodies.shape])?
            .try_map(py, |[b]| PivotedTop::of(&bodies[b], rtol))?;
        let shapes = [
            &bodies.shape[..],
            &omega.shape,
            &attitude.shape,
            &gravity.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "attitude", "gravity"], shapes)?;
        let start = |[b, w, q, g]: [usize; 4]| Start {
            top: tops[b],
            omega: omega[w],
            attitude: attitude[q],
            gravity: gravity[g],
        };
        let motions = grid.try_map(py, |row| {
            let Start {
                top,
                omega,
                attitude,
                gravity,
            } = start(row);
            HeavyTop::of(&top, &omega, &attitude, &gravity)
        })?;
        let starts = grid.try_map(py, |row| Ok(start(row)))?;
        Ok(Self {
            body,
            starts,
            motions,
            rtol,
            uncertain,
        })
    }
}

#[pymethods]
impl PyRigidBody {
    /// The motion of a symmetric top in uniform gravity about a fixed point, in closed form.
    ///
    /// The fixed point, the pivot, is the origin of the body frame.
    ///
    /// This is Lagrange's top: two principal moments are equal, and both the pivot and the centre of mass lie
    /// on the symmetry axis. The spherical pendulum and the plane pendulum are special cases.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3), or Uncertain
    ///     Angular velocity at t = 0, of the body relative to space, components in the body frame.
    /// attitude : array_like, shape (..., 4), rotation or Uncertain
    ///     R_NB at t = 0: unit quaternions (x, y, z, w), or anything with ``as_quat()`` such as SciPy's
    ///     Rotation. The identity by default.
    /// gravity : array_like, shape (..., 3)
    ///     Gravitational acceleration, components in space, for example ``(0, 0, -9.81)``. It must be given.
    /// rtol : float, optional
    ///     Moments that differ by less than `rtol` times the largest count as equal. The pivot counts as
    ///     lying on the axis if its distance from the axis is less than `rtol` times the radius of gyration.
    ///
    /// Returns
    /// -------
    /// HeavyTop
    ///     Bodies, angular velocities, attitudes and gravities broadcast together.
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     For a body that is no symmetric top, or if the pivot is not on its axis. The message tells the gap
    ///     between the moments, or the distance. `simulate` serves such bodies.
    ///
    /// Examples
    /// --------
    /// A top that starts with the rate of slow steady precession keeps its inclination, also after a million
    /// turns:
    ///
    /// >>> from polhode import RigidBody, euler_angles, tops
    /// >>> body = RigidBody.from_principal(0.5, (2e-4, 2e-4, 3e-4), center_of_mass=(0, 0, 0.04))
    /// >>> slow = tops.steady_precession(body, 150.0, 0.6, gravity=(0, 0, -9.81))[0]
    /// >>> angles, rates = (0, 0.6, 0), (slow, 0, 150 - slow * 0.825335614909678)
    /// >>> omega = euler_angles.angular_velocity(angles, rates)
    /// >>> top = body.heavy_top(omega, euler_angles.to_quaternion(angles), gravity=(0, 0, -9.81))
    /// >>> top.at(4e4).euler_angles()[1].round(9)
    /// np.float64(0.6)
    #[pyo3(signature = (omega, attitude=None, gravity=None, *, rtol=TOP_RTOL))]
    #[pyo3(text_signature = "($self, omega, attitude=None, gravity=None, *, rtol=1e-06)")]
    fn heavy_top(
        slf: Py<Self>,
        py: Python<'_>,
        omega: &Bound<'_, PyAny>,
        attitude: Option<&Bound<'_, PyAny>>,
        gravity: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
    ) -> PyResult<PyHeavyTop> {
        let gravity = gravity.ok_or_else(no_gravity)?;
        let given = StartArguments::read(omega, attitude)?;
        let (omega, gravity) = (read(&given.omega, "omega")?, read(gravity, "gravity")?);
        let attitude = read_attitude_exactly(given.attitude.as_ref(), "attitude")?;
        PyHeavyTop::new(py, slf, &omega, &attitude, &gravity, rtol, given.uncertain)
    }
}

#[pymethods]
impl PyHeavyTop {
    /// Asked where there is no such attribute.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<Py<PyAny>> {
        Err(crate::hints::no_attribute(slf.as_any(), name))
    }

    /// Angular velocity of the body relative to space at t = 0, components in the body frame, in radians per unit
    /// of time, shape (..., 3).
    #[getter]
    fn omega<'py>(&self, py: Python<'py>) -> Array<'py> {
        Ok(write_of(py, &self.starts, |start| start.omega)?.into_any())
    }

    /// Attitude R_NB at t = 0 as a unit quaternion (x, y, z, w), shape (..., 4).
    #[getter]
    fn quaternion<'py>(&self, py: Python<'py>) -> Array<'py> {
        let quaternions = self.starts.map(py, |start| components(&start.attitude))?;
        Ok(write(py, &quaternions)?.into_any())
    }

    /// Gravitational acceleration, components in space, shape (..., 3).
    #[getter]
    fn gravity<'py>(&self, py: Python<'py>) -> Array<'py> {
        Ok(write_of(py, &self.starts, |start| start.gravity)?.into_any())
    }

    /// Angular velocity and attitude at t = 0 as `Uncertain`, each None where it was given without a sigma.
    #[getter]
    fn uncertain_start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.uncertain.to_python(py)
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
    ///     About the origin of the body frame, which rests. The axes of its ``omega`` and ``quaternion`` are
    ///     those of the stack, then those of `t`, then the components. The quaternion is continuous in time.
    ///     A time that is not finite gives NaN. A time after more than 2⁸⁸ turns is an error: no digit of the
    ///     phase is known there. If `t` is a dask array, the result is an `xarray.Dataset` that is computed
    ///     later, chunk by chunk, with the same bits.
    ///
    /// Notes
    /// -----
    /// The computation releases the GIL and uses all cores for many states; Ctrl-C ends it. A state has the
    /// same bits whether it is computed alone or together with others.
    ///
    /// Examples
    /// --------
    /// A plane pendulum of one metre is let go at 1 rad. After half a period it is at rest on the other side:
    ///
    /// >>> from polhode import solids, euler_angles
    /// >>> bob = solids.sphere(radius=0.0, mass=1.0).translated((0, 0, -1))
    /// >>> swing = bob.heavy_top((0, 0, 0), euler_angles.to_quaternion((0, 1, 0)), gravity=(0, 0, -9.81))
    /// >>> round(2 * swing.nutation_period, 6)
    /// 2.139138
    /// >>> swing.at([0.0, swing.nutation_period]).point("center_of_mass").round(6)
    /// array([[ 0.      ,  0.841471, -0.540302],
    ///        [ 0.      , -0.841471, -0.540302]])
    fn at<'py>(slf: &Bound<'py, Self>, t: &Bound<'py, PyAny>) -> Array<'py> {
        let (py, this) = (slf.py(), slf.get());
        if is_any(&[Some(t)])
            && let Some(motion) = handed_over(py, "motion_at", (slf, t), None)?
        {
            return Ok(motion);
        }
        let gravity =
            (py.import("polhode.loads")?).call_method1("uniform_gravity", (this.gravity(py)?,))?;
        let fields = PyDict::new(py);
        fields.set_item("load", gravity)?;
        fields.set_item("pivoted", true)?;
        let origins = (this.body.get().bodies).map(py, |_: &RigidBody| Vector3::zeros())?;
        let uncertain = (&this.uncertain, slf.as_any());
        trajectory(
            py,
            &this.body,
            &this.motions,
            t,
            &origins,
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
        let rtol = self.rtol.into_pyobject(py)?.into_any();
        let parts = [
            body,
            in_slabs(self.omega(py)?)?,
            in_slabs(self.quaternion(py)?)?,
            in_slabs(self.gravity(py)?)?,
            rtol,
            self.uncertain_start(py)?.into_any(),
        ];
        Ok((restore, PyTuple::new(py, parts)?))
    }

    /// The motions that `__reduce__` took apart; for pickle.
    #[staticmethod]
    fn _from_start(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        omega: &Bound<'_, PyAny>,
        quaternion: &Bound<'_, PyAny>,
        gravity: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
        uncertain_start: (Option<Py<PyUncertain>>, Option<Py<PyUncertain>>),
    ) -> PyResult<Self> {
        let quaternion: Stack<[f64; 4]> = read(quaternion, "quaternion")?;
        let attitude = quaternion.map(py, |&[x, y, z, w]| {
            UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)) // to the last bit
        })?;
        let (omega, gravity) = (read(omega, "omega")?, read(gravity, "gravity")?);
        let uncertain = UncertainStart::restore(uncertain_start);
        Self::new(py, body, &omega, &attitude, &gravity, rtol, uncertain)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// One motion by its mode and start; a stack by its shape.
    fn __repr__(&self) -> String {
        if !self.motions.is_one() {
            let count = self.motions.rows.len();
            return format!(
                "<HeavyTop stack of shape {}: {count} motions>",
                tuple(&self.motions.shape)
            );
        }
        let [p, q, r]: [f64; 3] = self.starts[0].omega.into();
        let mode = self.motions[0].nutation().mode.name();
        format!("<HeavyTop: {mode}, omega=[{p:?}, {q:?}, {r:?}]>")
    }
}

// What stays constant along the motion of a heavy top.

impl PyHeavyTop {
    fn numbers<'py>(&self, py: Python<'py>, of: fn(&Nutation) -> f64) -> Array<'py> {
        write_numbers_of(py, &self.motions, |motion| of(motion.nutation()))
    }
}

#[pymethods]
impl PyHeavyTop {
    /// How the axis moves on a sphere about the pivot, as one of eight words.
    ///
    /// ``"cusp"``: the axis rests whenever it is highest. ``"loop"``: its precession turns back while it is
    /// high. ``"wave"``: its precession never turns back. ``"regular"``: steady precession. ``"crossing"``:
    /// the axis goes through the vertical in each period. ``"planar"``: it swings or turns over in a vertical
    /// plane. ``"asymptotic"``: it approaches the upward vertical for ever. ``"steady"``: the axis rests:
    /// upright (a sleeping top), hanging, or because there is no weight. A string, or an array of them for a
    /// stack.
    #[getter]
    fn mode<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_words_of(
            py,
            &self.motions,
            |motion| motion.nutation().mode.name(),
            "<U10",
        )
    }

    /// Least and largest inclination of the axis, in radians, shape (..., 2).
    ///
    /// The inclination θ is the angle between the upward vertical and the axis, which points from the pivot
    /// to the centre of mass.
    #[getter]
    fn nutation_limits<'py>(&self, py: Python<'py>) -> Array<'py> {
        let limits = (self.motions).map(py, |motion| motion.nutation().inclination)?;
        Ok(write(py, &limits)?.into_any())
    }

    /// Time from one least inclination to the next: infinite in the mode "asymptotic", NaN where the inclination is
    /// constant: in the modes "regular" and "steady".
    #[getter]
    fn nutation_period<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.numbers(py, |nutation| nutation.period)
    }

    /// Mean rate, in radians per unit of time, at which the axis goes about the upward vertical.
    ///
    /// It is the mean of φ̇. Where the axis goes through the vertical, φ jumps by half a turn.
    #[getter]
    fn mean_precession<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.numbers(py, |nutation| nutation.precession)
    }

    /// Mean rate, in radians per unit of time, at which the body turns about its axis relative to the line of
    /// nodes.
    ///
    /// It is the mean of ψ̇.
    #[getter]
    fn mean_spin<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.numbers(py, |nutation| nutation.spin)
    }

    /// Component ω_s of ω along the axis, in radians per unit of time. It is constant.
    #[getter]
    fn axial_spin<'py>(&self, py: Python<'py>) -> Array<'py> {
        let spins = (self.starts).map(py, |start| start.omega.dot(&start.top.axis))?;
        write_numbers(py, &spins)
    }

    /// Spin above which the top stands stably upright, 2 √(I_t m g l)/I_s, in radians per unit of time.
    ///
    /// I_s is the moment about the axis, I_t that across it, both about the pivot; l is the distance of the
    /// centre of mass from the pivot. Infinite for a body without moment about the axis.
    #[getter]
    fn sleeping_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        let limit = |start: &Start| start.top.least_spin(0.0, &start.gravity);
        write_numbers_of(py, &self.starts, limit)
    }

    /// Effective potential V(θ) of the inclination.
    ///
    /// The sum ``I_t θ̇²/2 + V(θ)`` is constant: it is the energy of the top minus the energy of its spin
    /// about the axis.
    ///
    /// ``V(θ) = (L_z − L_s cos θ)²/(2 I_t sin²θ) + m g l cos θ``, where L_z is the angular momentum about the
    /// upward vertical and L_s that about the axis, both constant. The axis moves between those inclinations
    /// where V is equal to that sum.
    ///
    /// Parameters
    /// ----------
    /// inclination : array_like, shape (n,) or ()
    ///     Angle θ between the axis and the upward vertical, in radians unless `degrees`.
    /// degrees : bool, optional
    ///     Whether the inclination is in degrees.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., n) or (...)
    ///     The potential. It is infinite at θ = 0 or θ = π, if the axis cannot reach that vertical.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_principal(1.0, (1.0, 1.0, 0.5), center_of_mass=(0, 0, 1))
    /// >>> top = body.heavy_top((1, 0, 4), None, gravity=(0, 0, -10))
    /// >>> top.effective_potential([0.5, 1.0])
    /// array([8.84102512, 5.70146947])
    #[pyo3(signature = (inclination, *, degrees=false))]
    fn effective_potential<'py>(
        &self,
        py: Python<'py>,
        inclination: &Bound<'py, PyAny>,
        degrees: bool,
    ) -> Array<'py> {
        let angles = in_radians(read(inclination, "inclination")?, degrees);
        let shape = [&self.motions.shape[..], &angles.shape].concat();
        let mut numbers = Numbers::of::<f64>(py, "inclination", &shape)?;
        for start in &self.starts.rows {
            numbers.put(&angles.rows, |&angle, out| {
                let Start {
                    top,
                    omega,
                    attitude,
                    gravity,
                } = start;
                out.push(top.effective_potential(omega, attitude, gravity, angle));
            })?;
        }
        Ok(numbers.finish::<f64>(&shape)?.into_any())
    }
}
