//! The free motion that has two given periods.

use nalgebra::Vector3;
use polhode::Error;
use polhode::motion::free::{CircledAxis, FromPeriods, attitude_about};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyFreeMotion;
use crate::arrays::{Argument, read, read_or, read_scalar, write_numbers_of, write_of};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{UncertainStart, value_of};

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
        if slf.get().doubts.is_none() && of_rotation.is_none() && of_precession.is_none() {
            return Ok(motion);
        }
        let given = PyDict::new(py);
        for (name, value, doubt) in [
            ("rotation_period", rotation_period, of_rotation),
            ("precession_period", precession_period, of_precession),
        ] {
            given.set_item(name, doubt.map_or(value, Bound::into_any))?;
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
        let uncertain = UncertainStart::restored(uncertain);
        let motion = PyFreeMotion::new(py, slf, &omega, &attitude, uncertain)?;
        Ok(PyFreeMotion {
            from_periods: Some(given),
            ..motion
        })
    }
}
