//! How the points of a moving body move, what holds it, and whether it spins steadily.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::motion::attitude::from_components;
use polhode::motion::kinematics::{point_acceleration, point_velocity};
use polhode::motion::pivot_reaction::pivot_reaction;
use polhode::motion::stability::stability;
use pyo3::prelude::*;

use crate::about::points;
use crate::arrays::{Argument, read, read_or, write};
use crate::attitudes::read_quaternion;
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

type Array<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

#[pymethods]
impl PyRigidBody {
    /// Velocity of a point of the body: ``v = v_P + ω×(r − P)``.
    ///
    /// Parameters
    /// ----------
    /// point : {"center_of_mass", "origin"} or array_like, shape (..., 3)
    ///     The point of the body, in the body frame.
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// velocity : array_like, shape (..., 3), optional
    ///     Velocity of P relative to space, components in the body frame.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     The point P of the body.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Relative to space, components in the body frame. A row with a NaN gives NaN.
    ///
    /// Examples
    /// --------
    /// A wheel rolls along x with unit speed. Its highest point is twice as fast; the point of contact is at
    /// rest:
    ///
    /// >>> from polhode import solids
    /// >>> wheel = solids.cylinder(radius=0.5, height=0.1, mass=1.0)
    /// >>> wheel.point_velocity([(0, 0.5, 0), (0, -0.5, 0)], omega=(0, 0, -2), velocity=(1, 0, 0))
    /// array([[2., 0., 0.],
    ///        [0., 0., 0.]])
    #[pyo3(
        signature = (point, omega, velocity=Argument::default(), about=Argument::default()),
        text_signature = "($self, point, omega, velocity=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn point_velocity<'py>(
        &self,
        py: Python<'py>,
        point: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        velocity: Argument<'py>,
        about: Argument<'py>,
    ) -> Array<'py> {
        let r = points(py, &self.bodies, Some(point), "point")?;
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let velocity = read_or(&velocity, "velocity", Vector3::zeros())?;
        let about = points(py, &self.bodies, about.value(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &r.shape,
            &omega.shape,
            &velocity.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "point", "omega", "velocity", "about"], shapes)?;
        let velocities = grid.try_map(py, |[_, r_, w, v, p]| {
            let arm = r[r_] - about[p];
            Ok(point_velocity(&arm, &omega[w], &velocity[v]))
        })?;
        write(py, &velocities)
    }

    /// Acceleration of a point of the body: ``a = a_P + ω̇×(r − P) + ω×(ω×(r − P))``.
    ///
    /// Parameters
    /// ----------
    /// point : {"center_of_mass", "origin"} or array_like, shape (..., 3)
    ///     The point of the body, in the body frame.
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// angular_acceleration : array_like, shape (..., 3), optional
    ///     ω̇, components in the body frame; zero by default.
    /// acceleration : array_like, shape (..., 3), optional
    ///     Acceleration of P relative to space, components in the body frame; zero by default.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     The point P of the body.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Relative to space, components in the body frame. A row with a NaN gives NaN.
    ///
    /// Examples
    /// --------
    /// The point of contact of a rolling wheel is at rest, and its acceleration is toward the axis:
    ///
    /// >>> from polhode import solids
    /// >>> wheel = solids.cylinder(radius=0.5, height=0.1, mass=1.0)
    /// >>> wheel.point_acceleration((0, -0.5, 0), omega=(0, 0, -2))
    /// array([0., 2., 0.])
    #[pyo3(
        signature = (
            point, omega, angular_acceleration=Argument::default(), acceleration=Argument::default(),
            about=Argument::default()
        ),
        text_signature = "($self, point, omega, angular_acceleration=(0.0, 0.0, 0.0), acceleration=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn point_acceleration<'py>(
        &self,
        py: Python<'py>,
        point: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        angular_acceleration: Argument<'py>,
        acceleration: Argument<'py>,
        about: Argument<'py>,
    ) -> Array<'py> {
        let zero = Vector3::zeros();
        let r = points(py, &self.bodies, Some(point), "point")?;
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let angular = read_or(&angular_acceleration, "angular_acceleration", zero)?;
        let linear = read_or(&acceleration, "acceleration", zero)?;
        let about = points(py, &self.bodies, about.value(), "about")?;
        let names = [
            "body",
            "point",
            "omega",
            "angular_acceleration",
            "acceleration",
            "about",
        ];
        let shapes = [
            &self.bodies.shape[..],
            &r.shape,
            &omega.shape,
            &angular.shape,
            &linear.shape,
            &about.shape,
        ];
        let accelerations = Broadcast::of(names, shapes)?.try_map(py, |[_, r_, w, e, a, p]| {
            let arm = r[r_] - about[p];
            Ok(point_acceleration(&arm, &omega[w], &angular[e], &linear[a]))
        })?;
        write(py, &accelerations)
    }

    /// Force with which a pivot holds the body: ``m [R_NB (ω̇×c_P + ω×(ω×c_P)) − g] − F`` with ``c_P = C − P``.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// angular_acceleration : array_like, shape (..., 3), optional
    ///     ω̇, components in the body frame, as `angular_acceleration` gives it about the pivot; zero by
    ///     default.
    /// attitude : array_like, shape (..., 4), or rotation, optional
    ///     R_NB as unit quaternions (x, y, z, w), or anything with ``as_quat()``; the identity by default.
    /// gravity : array_like, shape (..., 3), optional
    ///     g, components in space; none by default.
    /// force : array_like, shape (..., 3), optional
    ///     F, the sum of all other forces but the reaction, components in space; none by default.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     The pivot P: a point of the body that is fixed in space.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Force on the body, components in space. A row with a NaN gives NaN.
    ///
    /// Examples
    /// --------
    /// A pendulum with a bob of 2 kg and a length of half a metre passes its lowest point with 3 rad/s; the
    /// force is m (g + ω² l):
    ///
    /// >>> from polhode import solids
    /// >>> bob = solids.sphere(radius=0.0, mass=2.0).translated((0, 0, -0.5))
    /// >>> bob.pivot_reaction((3, 0, 0), gravity=(0, 0, -10))
    /// array([ 0.,  0., 29.])
    #[pyo3(
        signature = (
            omega, angular_acceleration=Argument::default(), attitude=None, gravity=Argument::default(),
            force=Argument::default(), about=Argument::default()
        ),
        text_signature = "($self, omega, angular_acceleration=(0.0, 0.0, 0.0), attitude=None, gravity=(0.0, 0.0, 0.0), force=(0.0, 0.0, 0.0), about='origin')"
    )]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn pivot_reaction<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        angular_acceleration: Argument<'py>,
        attitude: Option<&Bound<'py, PyAny>>,
        gravity: Argument<'py>,
        force: Argument<'py>,
        about: Argument<'py>,
    ) -> Array<'py> {
        let zero = Vector3::zeros();
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let angular = read_or(&angular_acceleration, "angular_acceleration", zero)?;
        let quaternion = attitude.map_or_else(
            || Ok(Stack::one([0.0, 0.0, 0.0, 1.0])),
            |attitude| read_quaternion(attitude, "attitude"),
        )?;
        let gravity = read_or(&gravity, "gravity", zero)?;
        let force = read_or(&force, "force", zero)?;
        let about = match about.value() {
            Some(about) => points(py, &self.bodies, Some(about), "about")?,
            None => Stack::one(zero),
        };
        let names = [
            "body",
            "omega",
            "angular_acceleration",
            "attitude",
            "gravity",
            "force",
            "about",
        ];
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &angular.shape,
            &quaternion.shape,
            &gravity.shape,
            &force.shape,
            &about.shape,
        ];
        let reactions = Broadcast::of(names, shapes)?.try_map(py, |[b, w, a, q, g, f, p]| {
            if quaternion[q].iter().any(|x| x.is_nan()) {
                return Ok(Vector3::repeat(f64::NAN));
            }
            Ok(pivot_reaction(
                &self.bodies[b],
                &from_components("attitude", &quaternion[q])?,
                &omega[w],
                &angular[a],
                &gravity[g],
                &force[f],
                &about[p],
            ))
        })?;
        write(py, &reactions)
    }

    /// Stability of the steady spins of a free body about its principal axes.
    ///
    /// The result for axis k is the squared frequency of small oscillations about the spin, seen from the
    /// body: ``ω² (I_k − I_i)(I_k − I_j)/(I_i I_j)``. If it is negative, the spin is unstable, and a
    /// disturbance grows as ``exp(t √−value)``. If it is zero, neighbouring axes have the same moment, and a
    /// disturbed spin drifts to them.
    ///
    /// Parameters
    /// ----------
    /// rate : array_like, shape (...)
    ///     Angular velocity ω of the spin, in radians per unit of time.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     P: the centre of mass of a body that moves freely, or a point fixed in space, without torque.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Squared frequencies in (radians per unit of time)², for the principal axes in the order of
    ///     ascending moments about P. A row with a NaN gives NaN.
    ///
    /// Examples
    /// --------
    /// A racket turns steadily about two of its axes:
    ///
    /// >>> from polhode import RigidBody
    /// >>> RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5)).stability(2.0)
    /// array([ 1.2, -0.8,  1.5])
    #[pyo3(
        signature = (rate, about=Argument::default()),
        text_signature = "($self, rate, about='center_of_mass')"
    )]
    fn stability<'py>(
        &self,
        py: Python<'py>,
        rate: &Bound<'py, PyAny>,
        about: Argument<'py>,
    ) -> Array<'py> {
        let rate: Stack<f64> = read(rate, "rate")?;
        let about = points(py, &self.bodies, about.value(), "about")?;
        let shapes = [&self.bodies.shape[..], &rate.shape, &about.shape];
        let squares =
            Broadcast::of(["body", "rate", "about"], shapes)?.try_map(py, |[b, w, p]| {
                self.bodies[b].check_about(&about[p])?;
                let moments = self.bodies[b].principal_about(&about[p]).moments;
                Ok(stability(&moments, rate[w]))
            })?;
        write(py, &squares)
    }
}
