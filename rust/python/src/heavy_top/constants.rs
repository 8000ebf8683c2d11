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
    /// Path of the axis on a sphere about the pivot, as one of eight words.
    ///
    /// ``"cusp"``: the axis rests whenever it is highest. ``"loop"``: its precession turns back while it is
    /// high. ``"wave"``: its precession never turns back. ``"regular"``: steady precession. ``"crossing"``:
    /// the axis goes through the vertical in each period. ``"planar"``: it swings or turns over in a vertical
    /// plane. ``"asymptotic"``: it approaches the upward vertical for ever. ``"steady"``: the axis rests:
    /// upright (a sleeping top), hanging, or because there is no weight. A string, or an array of them for a
    /// stack.
    #[getter]
    fn path<'py>(&self, py: Python<'py>) -> Array<'py> {
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

    /// Time from one least inclination to the next: infinite on an asymptotic path, NaN where the inclination is
    /// constant: on the paths "regular" and "steady".
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
