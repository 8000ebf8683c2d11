//! What a free motion tells at a time: herpolhode, Poinsot's picture, derivatives, error bars.

use nalgebra::Matrix6;
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::motion::closed_form::ClosedForm;
use polhode::motion::free::{FreeMotion, Invariants};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::PyFreeMotion;
use super::constants::tuple;
use crate::arrays::{read, read_scalar, write, write_numbers_of, write_of};
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
        tuple(py, "Poinsot", parts)
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
        tuple(py, "Sensitivity", parts)
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
        tuple(py, "ErrorBar", parts)
    }
}
