//! What stays constant along the motion of a heavy top.

use polhode::motion::heavy_top::Nutation;
use pyo3::prelude::*;

use super::top::{Array, PyHeavyTop, Start};
use crate::arrays::{Numbers, read, write, write_numbers, write_numbers_of, write_words_of};
use crate::tops::turned;

impl PyHeavyTop {
    fn numbers<'py>(&self, py: Python<'py>, of: fn(&Nutation) -> f64) -> Array<'py> {
        write_numbers_of(py, &self.motions, |motion| of(motion.nutation()))
    }
}

#[pymethods]
impl PyHeavyTop {
    /// What the axis draws on a sphere about the pivot.
    #[getter]
    fn path<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_words_of(
            py,
            &self.motions,
            |motion| motion.nutation().path.name(),
            "<U10",
        )
    }

    /// Least and largest inclination of the axis from the upward vertical.
    #[getter]
    fn nutation_limits<'py>(&self, py: Python<'py>) -> Array<'py> {
        let limits = (self.motions).map(py, |motion| motion.nutation().inclination)?;
        Ok(write(py, &limits)?.into_any())
    }

    /// Time from one least inclination to the next.
    #[getter]
    fn nutation_period<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.numbers(py, |nutation| nutation.period)
    }

    /// Mean rate of the axis about the upward vertical.
    #[getter]
    fn mean_precession<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.numbers(py, |nutation| nutation.precession)
    }

    /// Mean rate of the body about its axis relative to the line of nodes.
    #[getter]
    fn mean_spin<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.numbers(py, |nutation| nutation.spin)
    }

    /// The component of ω along the axis.
    #[getter]
    fn axial_spin<'py>(&self, py: Python<'py>) -> Array<'py> {
        let spins = (self.starts).map(py, |start| start.omega.dot(&start.top.axis))?;
        write_numbers(py, &spins)
    }

    /// The spin above which the top stands stably upright.
    #[getter]
    fn sleeping_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        let limit = |start: &Start| start.top.least_spin(0.0, &start.gravity);
        write_numbers_of(py, &self.starts, limit)
    }

    /// Effective potential of the inclination: ``I_t θ̇²/2 + V(θ)`` is constant, the energy less that of the axial spin.
    ///
    /// ``V(θ) = (L_z − L_s cos θ)²/(2 I_t sin²θ) + m g l cos θ``, with the angular momenta L_z about the
    /// upward vertical and L_s about the axis, both constant. The axis nods where V is at most that constant.
    ///
    /// Parameters
    /// ----------
    /// inclination : array_like, shape (n,) or ()
    ///     θ, of the axis from the upward vertical, in radians.
    /// degrees : bool, optional
    ///     It is in degrees.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., n) or (...)
    ///     The potential; infinite at the verticals that the axis cannot reach.
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
        let angles = turned(read(inclination, "inclination")?, degrees);
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
