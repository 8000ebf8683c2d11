//! What a load exerts at a time and a state, asked for outside a run.

use nalgebra::{UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::RigidBody;
use polhode::mass::refined::RefinedPrincipal;
use polhode::motion::attitude::from_components;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::loads::{BodyAtPoint, ConservedMomentum, Load, Term, Wrench, wrench_at};
use polhode::motion::state::Phase;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use super::acting::{ActingLoad, Fault};
use super::load::{LoadPart, PyLoad};
use crate::about::is_pivot;
use crate::arrays::{Numbers, read, read_scalar, write_of};
use crate::attitudes::read_quaternion;
use crate::body::PyRigidBody;
use crate::depth::RecursionGuard;
use crate::errors::{at_row, to_py};
use crate::interrupt::Beat;
use crate::memory;
use crate::stack::{BLOCK, Broadcast, Stack};

impl PyLoad {
    /// Force and torque at each row of times, states and bodies.
    #[expect(clippy::too_many_arguments, reason = "a state has many parts")]
    fn wrenches(
        &self,
        py: Python<'_>,
        t: &Bound<'_, PyAny>,
        omega: &Bound<'_, PyAny>,
        quaternion: &Bound<'_, PyAny>,
        position: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        body: Option<&Bound<'_, PyRigidBody>>,
        about: &str,
        start: Option<f64>,
        states: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Stack<Wrench>> {
        let _guard = RecursionGuard::run("load")?;
        let terms = self.terms(py)?;
        let bodies = match body {
            Some(body) => &body.get().bodies,
            None => &unit(py, &terms, self.thrusters().next().is_some())?,
        };
        let pivoted = is_pivot(about)?;
        let t: Stack<f64> = read(t, "t")?;
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let quaternion = read_quaternion(quaternion, "quaternion")?;
        let vector = |given: Option<&Bound<'_, PyAny>>, name| {
            given.map_or_else(
                || Ok(Stack::one(Vector3::zeros())),
                |given| read::<Vector3<f64>>(given, name),
            )
        };
        let (position, velocity) = (vector(position, "position")?, vector(velocity, "velocity")?);
        let states = self.read_states(states, true)?;
        let names = [
            "load",
            "body",
            "t",
            "omega",
            "quaternion",
            "position",
            "velocity",
            "states",
        ];
        let shapes = [
            &terms.shape[..],
            &bodies.shape,
            &t.shape,
            &omega.shape,
            &quaternion.shape,
            &position.shape,
            &velocity.shape,
            &states.shape,
        ];
        let grid = Broadcast::of(names, shapes)?;
        let mut found = memory::vector("result", &grid.shape, 1)?;
        let mut beat = Beat::new(py);
        for (row, [l, b, k, w, q, r, v, s]) in grid.rows().enumerate() {
            if row % BLOCK == 0 {
                beat.mark()?;
            }
            let wrench = || {
                if quaternion[q].iter().chain(&states[s]).any(|x| x.is_nan()) {
                    let nan = Vector3::repeat(f64::NAN);
                    return Ok(Wrench {
                        force: nan,
                        torque: nan,
                    });
                }
                let start = start.unwrap_or(t[k]);
                let subject = if pivoted {
                    BodyAtPoint::pivoted(&bodies[b], start)
                } else {
                    BodyAtPoint::free(&bodies[b], start)
                };
                let mut acting = ActingLoad::new(self, &terms[l], subject, Some(py));
                let attitude = from_components("quaternion", &quaternion[q]);
                (attitude.map_err(Fault::Core))
                    .and_then(|attitude| {
                        self.check_given(&terms[l], t[k], &omega[w], &states[s])
                            .map_err(Fault::Python)?;
                        let phase = Phase {
                            attitude,
                            omega: omega[w],
                            position: position[r],
                            velocity: velocity[v],
                            internal_state: self
                                .initial_states(&terms[l], t[k], &omega[w], &states[s]),
                        };
                        acting.enter(t[k], t[k])?;
                        on_locked(&bodies[b], &subject, &mut acting, t[k], &phase)
                    })
                    .map_err(|fault| match fault {
                        Fault::Core(error) => at_row(&grid.shape, row, &to_py(py, &error), py),
                        Fault::Python(error) => error,
                    })
            };
            found.push(wrench()?);
        }
        let shape = grid.shape;
        Ok(Stack { shape, rows: found })
    }
}

#[pymethods]
impl PyLoad {
    /// Torque of the load about the reference point of the motion at a time and a state.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (...)
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// quaternion : array_like, shape (..., 4), or rotation
    ///     Attitude R_NB as (x, y, z, w), or anything with ``as_quat()``.
    /// position, velocity : array_like, shape (..., 3), optional
    ///     Position and velocity of the reference point, in space; zero by default.
    /// body : RigidBody, optional
    ///     The body. It is needed for loads that depend on it: weight, a force at a point, gravity gradient.
    /// about : {"center_of_mass", "origin"}, optional
    ///     The reference point, as in `simulate`.
    /// start : float, optional
    ///     Time at which the motion starts; `t` by default. It is the epoch of orbits that have none.
    /// states : dict of str and array_like, shape (..., k), optional
    ///     States of the load, as in ``states`` of a trajectory; needed if it has any. The torque N of a
    ///     wheel is that of ``I ω̇ + ω × I ω = N``, where I includes the wheel as if it were locked.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Components in the body frame; NaN for a quaternion with a NaN.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import loads
    /// >>> upside_down = (1, 0, 0, 0)
    /// >>> loads.constant_torque((0, 2, 1), frame="space").torque(0.0, (0, 0, 0), upside_down)
    /// array([ 0., -2., -1.])
    #[pyo3(signature = (
        t, omega, quaternion, position=None, velocity=None, *, body=None, about="center_of_mass", start=None,
        states=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn torque<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        quaternion: &Bound<'py, PyAny>,
        position: Option<&Bound<'py, PyAny>>,
        velocity: Option<&Bound<'py, PyAny>>,
        body: Option<&Bound<'py, PyRigidBody>>,
        #[pyo3(from_py_with = read_scalar)] about: &str,
        #[pyo3(from_py_with = read_scalar)] start: Option<f64>,
        states: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let wrenches = self.wrenches(
            py, t, omega, quaternion, position, velocity, body, about, start, states,
        )?;
        write_of(py, &wrenches, |wrench| wrench.torque)
    }

    /// Sum of the forces of the load at a time and a state; arguments as for `torque`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Components in space; NaN for a quaternion with a NaN.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import loads, solids
    /// >>> weight = loads.uniform_gravity((0, 0, -10))
    /// >>> weight.force(0.0, (0, 0, 0), (0, 0, 0, 1), body=solids.cube(1.0, mass=2.0))
    /// array([  0.,   0., -20.])
    #[pyo3(signature = (
        t, omega, quaternion, position=None, velocity=None, *, body=None, about="center_of_mass", start=None,
        states=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn force<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        quaternion: &Bound<'py, PyAny>,
        position: Option<&Bound<'py, PyAny>>,
        velocity: Option<&Bound<'py, PyAny>>,
        body: Option<&Bound<'py, PyRigidBody>>,
        #[pyo3(from_py_with = read_scalar)] about: &str,
        #[pyo3(from_py_with = read_scalar)] start: Option<f64>,
        states: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let wrenches = self.wrenches(
            py, t, omega, quaternion, position, velocity, body, about, start, states,
        )?;
        write_of(py, &wrenches, |wrench| wrench.force)
    }

    /// Potential energy of the body in the field of the load.
    ///
    /// Parameters
    /// ----------
    /// body : RigidBody
    /// quaternion : array_like, shape (..., 4), or rotation
    /// position : array_like, shape (..., 3), optional
    ///     Position of the reference point, in space; zero by default.
    /// about : {"center_of_mass", "origin"}, optional
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (...), or None
    ///     ``-m g·r_C`` in uniform gravity, ``-F·r`` of a force constant in space, ``2 k (1 - |w|)`` of feedback with
    ///     the gain k alone. None for a load with a part that has no potential.
    #[pyo3(signature = (body, quaternion, position=None, about="center_of_mass"))]
    fn potential<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyRigidBody>,
        quaternion: &Bound<'py, PyAny>,
        position: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = read_scalar)] about: &str,
    ) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
        if !self.is_analytic() {
            return Ok(None);
        }
        let (terms, bodies, pivoted) = (self.terms(py)?, &body.get().bodies, is_pivot(about)?);
        let quaternion = read_quaternion(quaternion, "quaternion")?;
        let position = position.map_or_else(
            || Ok(Stack::one(Vector3::zeros())),
            |given| read(given, "position"),
        )?;
        let shapes = [
            &terms.shape[..],
            &bodies.shape,
            &quaternion.shape,
            &position.shape,
        ];
        let grid = Broadcast::of(["load", "body", "quaternion", "position"], shapes)?;
        let energies = grid.rows().map(|[l, b, q, r]| {
            let [x, y, z, w] = quaternion[q];
            let phase = Phase {
                attitude: UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z)),
                position: position[r],
                ..Phase::nan()
            };
            let subject = if pivoted {
                BodyAtPoint::pivoted(&bodies[b], 0.0)
            } else {
                BodyAtPoint::free(&bodies[b], 0.0)
            };
            (terms[l].iter())
                .map(|term| term.potential(&subject, &phase))
                .sum::<Option<f64>>()
        });
        let mut numbers = Numbers::of::<f64>(py, "result", &grid.shape)?;
        let mut known = true;
        numbers.put(
            energies.map_while(|energy| {
                known = energy.is_some();
                energy
            }),
            |energy, out| out.push(energy),
        )?;
        known
            .then(|| numbers.finish::<f64>(&grid.shape))
            .transpose()
    }

    /// Find which part of the angular momentum about the reference point is conserved under the load.
    ///
    /// Parameters
    /// ----------
    /// about : {"center_of_mass", "origin"}, optional
    ///
    /// Returns
    /// -------
    /// True, numpy.ndarray of shape (..., 3), or None
    ///     True if all of it is conserved; unit vectors in space if its component along them is conserved;
    ///     else None.
    #[pyo3(signature = (about="center_of_mass"))]
    fn keeps_momentum<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] about: &str,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let pivoted = is_pivot(about)?;
        // A controller moves momentum between a wheel and the body, and no more.
        if !(self.parts.iter()).all(|part| matches!(part.acts, LoadPart::Term(_))) {
            return Ok(None);
        }
        let kept = (self.terms(py)?).map(py, |terms| {
            (terms.iter()).fold(ConservedMomentum::All, |kept, term| {
                kept.and(term.keeps(pivoted))
            })
        })?;
        if kept.rows.iter().all(|kept| *kept == ConservedMomentum::All) {
            return Ok(Some(true.into_pyobject(py)?.to_owned().into_any()));
        }
        if kept.rows.contains(&ConservedMomentum::Nothing) {
            return Ok(None);
        }
        let axes = write_of(py, &kept, |kept| match kept {
            ConservedMomentum::Along(axis) => *axis,
            _ => Vector3::z(), // one as good as another
        })?;
        Ok(Some(axes.into_any()))
    }
}

/// Force and torque N of `I ω̇ + ω × I ω = N`, where I has the wheels locked.
fn on_locked(
    body: &RigidBody,
    subject: &BodyAtPoint,
    acting: &mut ActingLoad<'_, '_>,
    t: f64,
    phase: &Phase,
) -> Result<Wrench, Fault> {
    let turning: Vec<_> = (acting.carried().iter())
        .filter_map(|carried| carried.turning())
        .collect();
    if turning.is_empty() {
        return acting.wrench(t, phase);
    }
    let body_without_wheels = RefinedPrincipal::about(body, &subject.point).without(&turning)?;
    let body_without_wheels = EulerEquations::of_refined(&body_without_wheels);
    let wrench = wrench_at(acting, &body_without_wheels, t, phase)?;
    let rate = body_without_wheels.angular_acceleration(&phase.omega, &wrench.torque)?;
    Ok(Wrench {
        torque: EulerEquations::about(body, &subject.point).torque(&phase.omega, &rate),
        ..wrench
    })
}

/// The bodies it acts on; a load that does not depend on the body acts on any.
fn unit(
    py: Python<'_>,
    terms: &Stack<Vec<Term>>,
    has_thrusters: bool,
) -> PyResult<Stack<RigidBody>> {
    if has_thrusters || terms.rows.iter().flatten().any(Term::needs_body) {
        return Err(PyTypeError::new_err(
            "body: the weight, the point of a force and the gravity gradient depend on the body; pass body=",
        ));
    }
    RigidBody::new(1.0, &nalgebra::Matrix3::identity(), &Vector3::zeros(), 0.0)
        .map(Stack::one)
        .map_err(|error| to_py(py, &error))
}
