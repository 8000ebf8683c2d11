//! Energy, momentum and Euler's equations.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::motion::angular_momentum::{AngularMomentum, angular_momentum};
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::kinetic_energy::{KineticEnergy, kinetic_energy};
use pyo3::prelude::*;

use crate::about::points;
use crate::arrays::{Argument, read, read_or, write, write_numbers_of, write_of};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

#[pymethods]
impl PyRigidBody {
    /// Kinetic energy in three parts, ``½ m v² + m v·(ω×c_P) + ½ ω·I_P·ω`` with ``c_P = C − P``.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// velocity : array_like, shape (..., 3), optional
    ///     Velocity of P relative to space, components in the body frame.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     The point P of the body. The parts depend on it, their sum does not.
    ///
    /// Returns
    /// -------
    /// KineticEnergy
    ///     ``translational``, ``mixed``, ``rotational`` and their ``total``.
    ///
    /// Examples
    /// --------
    /// A cylinder that rolls with unit speed, seen from its axis and from the line of contact:
    ///
    /// >>> from polhode import solids
    /// >>> cylinder = solids.cylinder(radius=1.0, height=2.0, mass=4.0)
    /// >>> cylinder.kinetic_energy((0, 0, 1), velocity=(1, 0, 0))
    /// KineticEnergy(translational=2.0, mixed=0.0, rotational=1.0)
    /// >>> cylinder.kinetic_energy((0, 0, 1), about=(0, 1, 0))
    /// KineticEnergy(translational=0.0, mixed=0.0, rotational=3.0)
    #[pyo3(
        signature = (omega, velocity=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, velocity=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn kinetic_energy<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        velocity: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let velocity = read_or(&velocity, "velocity", Vector3::zeros())?;
        let about = points(py, &self.bodies, about.given(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &velocity.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "velocity", "about"], shapes)?;
        let energy = grid.try_map(py, |[b, w, v, p]| {
            Ok(kinetic_energy(
                &self.bodies[b],
                &omega[w],
                &velocity[v],
                &about[p],
            ))
        })?;
        let part = |part: fn(&KineticEnergy) -> f64| write_numbers_of(py, &energy, part);
        let parts = (
            part(|t| t.translational)?,
            part(|t| t.mixed)?,
            part(|t| t.rotational)?,
        );
        py.import("polhode.results")?
            .getattr("KineticEnergy")?
            .call1(parts)
    }

    /// Angular momentum about the origin of space in three parts, ``m R×v + m [R×(ω×c_P) + c_P×v] + I_P ω``.
    ///
    /// For P = C the mixed part is zero, and the sum is orbital + spin. For P fixed at the origin of space
    /// the sum is the spin alone.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// velocity, position : array_like, shape (..., 3), optional
    ///     Velocity and position of the point P relative to space, components in the body frame.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     The point P of the body; ``c_P = C − P``.
    ///
    /// Returns
    /// -------
    /// AngularMomentum
    ///     ``orbital``, ``mixed``, ``spin`` and their ``total``, each of shape (..., 3).
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.sphere(1.0, mass=5.0).angular_momentum((0, 0, 3), velocity=(0, 1, 0), position=(2, 0, 0)).total
    /// array([ 0.,  0., 16.])
    #[pyo3(
        signature = (omega, velocity=Argument::default(), position=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, velocity=(0.0, 0.0, 0.0), position=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn angular_momentum<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        velocity: Argument<'py>,
        position: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let velocity = read_or(&velocity, "velocity", Vector3::zeros())?;
        let position = read_or(&position, "position", Vector3::zeros())?;
        let about = points(py, &self.bodies, about.given(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &velocity.shape,
            &position.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "velocity", "position", "about"], shapes)?;
        let momentum = grid.try_map(py, |[b, w, v, r, p]| {
            Ok(angular_momentum(
                &self.bodies[b],
                &omega[w],
                &velocity[v],
                &position[r],
                &about[p],
            ))
        })?;
        let part = |part: fn(&AngularMomentum) -> Vector3<f64>| write_of(py, &momentum, part);
        let parts = (part(|l| l.orbital)?, part(|l| l.mixed)?, part(|l| l.spin)?);
        py.import("polhode.results")?
            .getattr("AngularMomentum")?
            .call1(parts)
    }

    /// Angular acceleration by Euler's equations, ``I_P ω̇ + ω × I_P ω = N_P``.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// torque : array_like, shape (..., 3), optional
    ///     Torque about P, components in the body frame.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     P: the centre of mass of a body that moves freely, or a point fixed in space.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     ω̇, components in the body frame. Along an axis with zero moment it is zero.
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     For a torque along an axis with zero moment.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> body.angular_acceleration((1.0, 2.0, 4.0))
    /// array([-4. ,  3. , -0.8])
    #[pyo3(
        signature = (omega, torque=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, torque=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn angular_acceleration<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        torque: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let torque = read_or(&torque, "torque", Vector3::zeros())?;
        let about = points(py, &self.bodies, about.given(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &torque.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "torque", "about"], shapes)?;
        let acceleration = grid.try_map(py, |[b, w, n, p]| {
            self.bodies[b].check_about(&about[p])?;
            EulerEquations::about(&self.bodies[b], &about[p])
                .angular_acceleration(&omega[w], &torque[n])
        })?;
        write(py, &acceleration)
    }

    /// Torque that causes a given angular acceleration, by Euler's equations.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// angular_acceleration : array_like, shape (..., 3), optional
    ///     ω̇, components in the body frame; zero by default. The result is then the torque that keeps ω
    ///     constant in the body.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     P: the centre of mass of a body that moves freely, or a point fixed in space.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     ``N_P = I_P ω̇ + ω × I_P ω``, components in the body frame.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> body.torque((1.0, 2.0, 4.0))
    /// array([ 4., -6.,  2.])
    #[pyo3(
        signature = (omega, angular_acceleration=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, angular_acceleration=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn torque<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        angular_acceleration: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let acceleration = read_or(
            &angular_acceleration,
            "angular_acceleration",
            Vector3::zeros(),
        )?;
        let about = points(py, &self.bodies, about.given(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &acceleration.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "angular_acceleration", "about"], shapes)?;
        let torque = grid.try_map(py, |[b, w, a, p]| {
            self.bodies[b].check_about(&about[p])?;
            Ok(EulerEquations::about(&self.bodies[b], &about[p])
                .torque(&omega[w], &acceleration[a]))
        })?;
        write(py, &torque)
    }
}
