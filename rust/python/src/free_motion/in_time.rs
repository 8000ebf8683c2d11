//! What a free motion tells at a time: herpolhode, Poinsot's picture, derivatives, error bars.

use nalgebra::Matrix6;
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::motion::free::{FreeMotion, Invariants};
use polhode::motion::state::ClosedForm;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::PyFreeMotion;
use super::constants::tuple;
use crate::arrays::{read, write, write_numbers_of, write_of};
use crate::stack::{Broadcast, Stack};

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
    ///     ω, components in space: the shape of the stack, then that of `t`. Its component along L is constant, the
    ///     distance of the plane; across, it stays in the ring that `poinsot` tells. In general it never closes.
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
        tuple(py, "Poinsot", parts)
    }

    /// What small changes at the start, or of the moments, have become at a time: exact derivatives, at any time.
    ///
    /// Parameters
    /// ----------
    /// t : array_like
    ///     Times of any shape.
    ///
    /// Returns
    /// -------
    /// Sensitivity
    ///     ``state``, shape (..., 6, 6): of (δ, ω) at `t` by (δ, ω) at t = 0, where δ is a small rotation from the
    ///     attitude, ``R → R exp(δ×)``, components in the body frame, in radians. ``moments``, shape (..., 6, 3): by the
    ///     principal moments, ascending, with principal axes and initial state held.
    ///
    /// Notes
    /// -----
    /// By closed forms, no differences and no integration: the addition theorems of the elliptic functions give ω, and the
    /// conservation of momentum and energy the attitude, so a time a million rotations away costs and is as accurate
    /// as one close by, a few ε relative to the largest derivative in units of the spin rate. Symmetric and
    /// spherical bodies, steady spins and the separatrix are limits without loss. `moments` is NaN for a body with a zero
    /// moment, which has no neighbour on one side; far out on the separatrix derivatives that overflow are NaN.
    ///
    /// Examples
    /// --------
    /// A disturbance of a spin about the intermediate axis grows as the theory of small ones says:
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
        tuple(py, "Sensitivity", parts)
    }

    /// How well the state at a time is determined by what it is computed from.
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
    ///     Bounds, to first order and in the worst directions, on the angle by which the ``attitude`` is off, in
    ///     radians, and on the length of the error of ``omega``. The error of the computation itself is far
    ///     smaller: it takes its input as exact. With it grows what the phases are known to, 2⁻⁹⁰ of the turns made,
    ///     which is in the bounds even with ``rtol=0``. Infinite where nothing is known. A zero moment is taken as
    ///     known.
    ///
    /// Examples
    /// --------
    /// Moments known to a part in a thousand tell the attitude for a few dozen turns:
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
        rtol: f64,
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
        tuple(py, "ErrorBar", parts)
    }
}
