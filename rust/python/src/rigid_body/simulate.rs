//! The motion under a load.

use std::ops::ControlFlow;

use nalgebra::{UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::RigidBody;
use polhode::motion::attitude::components;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::loads::Torque;
use polhode::motion::simulate::{Cause, Effort, Failure, State, Tolerance, check_times, simulate};
use polhode::numerics::threads::{Halt, fill_blocks};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{PyRigidBody, points};
use crate::arrays::{read, read_attitude, write};
use crate::errors::{at_row, to_py};
use crate::interrupt::Interrupt;
use crate::loads::{Fault, PyLoad};
use crate::stack::{Broadcast, Stack};

/// An optional argument of any array-like kind.
type Given<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

#[pymethods]
impl PyRigidBody {
    /// The motion of the body at the times asked for.
    ///
    /// Solves Euler's equations together with the attitude, as a unit quaternion, under a load.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (T,)
    ///     Output times, strictly monotone (forward or backward); the first is the start.
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity at the start, of the body relative to space, components in the body frame.
    /// attitude : array_like, shape (..., 4), or rotation, optional
    ///     R_NB at the start: unit quaternions (x, y, z, w), or anything with ``as_quat()`` such as
    ///     SciPy's Rotation. The identity by default.
    /// load : Load, optional
    ///     What acts on the body, from :mod:`polhode.loads`; nothing by default. Its torques are about
    ///     the point `about`.
    /// position, velocity : array_like, shape (..., 3), optional
    ///     Of the point `about` at the start, in space; zero by default.
    /// about : {"center_of_mass", "origin"}, optional
    ///     The centre of mass of a body that moves freely, or the origin of the body frame when that
    ///     point is fixed in space.
    /// method : {"auto", "dop853"}, optional
    ///     "dop853" is the explicit Runge-Kutta method of order 8 by Dormand and Prince with a dense
    ///     output of order 7. "auto" chooses.
    /// rtol : float, optional
    ///     Error allowed in a step, relative to the largest angular speed so far and to the unit
    ///     quaternion; from 2.3e-15 to 0.1.
    /// atol : float, optional
    ///     Error of the angular velocity allowed besides; none by default.
    /// progress : callable, optional
    ///     Called with the fraction done, about twenty times a second and at the end.
    ///
    /// Returns
    /// -------
    /// Trajectory
    ///
    /// Raises
    /// ------
    /// IntegrationError
    ///     With the time and state that were reached and what had been computed.
    ///
    /// Notes
    /// -----
    /// The GIL is released unless the load calls Python; stacks run on all cores. Ctrl-C ends the run.
    /// An exception raised by a callback comes back as it is.
    ///
    /// Examples
    /// --------
    /// NASA's tumbling brick (NASA/TM-2015-218675, check case 2) after 30 seconds, in degrees a second:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(0.155404754, (0.001894220, 0.006211019, 0.007194665))
    /// >>> motion = brick.simulate([0, 30], omega=np.radians([10, 20, 30]))
    /// >>> np.degrees(motion.omega[-1]).round(6)
    /// array([ 12.618391, -17.397475,  31.119589])
    #[pyo3(
        signature = (
            t, omega, attitude=None, *, load=None, position=None, velocity=None, about="center_of_mass",
            method="auto", rtol=1e-10, atol=None, progress=None
        )
    )]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn simulate<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        attitude: Given<'_, 'py>,
        load: Given<'_, 'py>,
        position: Given<'_, 'py>,
        velocity: Given<'_, 'py>,
        about: &str,
        method: &str,
        rtol: f64,
        atol: Option<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        check_choices(about, method, velocity)?;
        let times = read_times(py, t)?;
        let tolerance =
            Tolerance::new(rtol, atol.unwrap_or(0.0)).map_err(|error| to_py(py, &error))?;
        let terms = match load {
            None => PyLoad::default(),
            Some(load) => load
                .cast::<PyLoad>()
                .map_err(|_| {
                    let kind = load.get_type();
                    PyTypeError::new_err(format!(
                        "load: expected a Load from polhode.loads, got {kind}; wrap a function in loads.torque_callback"
                    ))
                })?
                .get()
                .copied(py),
        };
        let bodies = &slf.get().bodies;
        let about_word = about.into_pyobject(py)?.into_any();
        let start = Start {
            bodies,
            omega: read(omega, "omega")?,
            attitude: read_attitude(attitude, "attitude")?,
            position: at_start(position, "position")?,
            velocity: at_start(velocity, "velocity")?,
            about: points(bodies, Some(&about_word), "about")?,
        };
        let run = Run {
            start: &start,
            grid: start.grid()?,
            times: &times,
            tolerance,
        };
        run.check(py)?;
        let interrupt = Interrupt::new(progress);
        let (motions, failure) = run.all(py, &terms, &interrupt)?;
        interrupt.finish(py)?;
        let trajectory = run.trajectory(py, slf, load, &motions)?;
        match failure {
            None => Ok(trajectory),
            Some((row, failure)) => Err(run.integration_error(py, row, failure, trajectory)),
        }
    }
}

/// The words that `about` and `method` may be, and that a pivot does not move.
fn check_choices(about: &str, method: &str, velocity: Given<'_, '_>) -> PyResult<()> {
    if !matches!(about, "center_of_mass" | "origin") {
        return Err(PyValueError::new_err(format!(
            "about: expected \"center_of_mass\" or \"origin\", got \"{about}\"; to fix another point move the body with translated()"
        )));
    }
    if !matches!(method, "auto" | "dop853") {
        return Err(PyValueError::new_err(format!(
            "method: expected \"auto\" or \"dop853\", got \"{method}\""
        )));
    }
    if about == "origin" && velocity.is_some() {
        return Err(PyValueError::new_err(
            "velocity: with about=\"origin\" that point is fixed in space and has no velocity",
        ));
    }
    Ok(())
}

/// A vector that is zero unless given.
fn at_start(vector: Given<'_, '_>, name: &str) -> PyResult<Stack<Vector3<f64>>> {
    vector.map_or_else(
        || Ok(Stack::one(Vector3::zeros())),
        |vector| read(vector, name),
    )
}

fn read_times(py: Python<'_>, t: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let times: Stack<f64> = read(t, "t")?;
    if times.shape.len() != 1 {
        return Err(PyValueError::new_err(format!(
            "t: expected shape (T,), got {}",
            crate::stack::tuple(&times.shape)
        )));
    }
    check_times(&times.rows).map_err(|error| to_py(py, &error))?;
    Ok(times.rows)
}

/// Bodies and their states at the start.
struct Start<'a> {
    bodies: &'a Stack<RigidBody>,
    omega: Stack<Vector3<f64>>,
    attitude: Stack<UnitQuaternion<f64>>,
    position: Stack<Vector3<f64>>,
    velocity: Stack<Vector3<f64>>,
    about: Stack<Vector3<f64>>,
}

impl Start<'_> {
    fn grid(&self) -> PyResult<Broadcast<6>> {
        Broadcast::of(
            ["body", "omega", "attitude", "position", "velocity", "about"],
            [
                &self.bodies.shape,
                &self.omega.shape,
                &self.attitude.shape,
                &self.position.shape,
                &self.velocity.shape,
                &self.about.shape,
            ],
        )
    }
}

/// One row's samples and effort, and how it ended.
#[derive(Clone)]
struct Motion {
    samples: Vec<State>,
    effort: Effort,
}

/// The row that failed first, and how.
type FirstFailure = Option<(usize, Failure<Fault>)>;

/// All that a run needs.
struct Run<'a> {
    start: &'a Start<'a>,
    grid: Broadcast<6>,
    times: &'a [f64],
    tolerance: Tolerance,
}

impl Run<'_> {
    /// Every state at the start must be finite.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        for (name, stack) in [
            ("omega", &self.start.omega),
            ("position", &self.start.position),
            ("velocity", &self.start.velocity),
        ] {
            for (row, vector) in stack.rows.iter().enumerate() {
                if let Some(&value) = vector.iter().find(|x| !x.is_finite()) {
                    let error = polhode::Error::NonFinite { what: name, value };
                    return Err(at_row(&stack.shape, row, &to_py(py, &error), py));
                }
            }
        }
        Ok(())
    }

    /// Integrates every row: on all cores without the GIL, or one by one attached when the load calls Python.
    fn all(
        &self,
        py: Python<'_>,
        load: &PyLoad,
        interrupt: &Interrupt,
    ) -> PyResult<(Vec<Motion>, FirstFailure)> {
        let count = self.grid.len();
        let unborn = Motion {
            samples: Vec::new(),
            effort: Effort {
                steps: 0,
                evaluations: 0,
            },
        };
        let mut motions = vec![unborn; count];
        let mut failure = None;
        if load.callbacks.is_empty() {
            let fraction = |of_row: f64| (count == 1).then_some(of_row);
            let outcome = py.detach(|| {
                let mut watch = |done| interrupt.poll(Some(done));
                fill_blocks(&mut motions, 1, &mut watch, |row, out| {
                    self.one(row, &mut &load.terms[..], &mut out[0], |part| {
                        interrupt.poll(fraction(part))
                    })
                    .map_err(|failure| Box::new((row, failure)))
                })
            });
            if let Err(Halt::Failed(first)) = outcome {
                let (row, Failure { time, state, cause }) = *first;
                let cause = match cause {
                    Cause::Stopped => Cause::Stopped,
                    Cause::Failed(error) => Cause::Failed(Fault::Core(error)),
                };
                failure = Some((row, Failure { time, state, cause }));
            }
        } else {
            for (row, motion) in motions.iter_mut().enumerate() {
                let mut torque = load.calling(py);
                let watch = |part: f64| interrupt.poll(Some((row as f64 + part) / count as f64));
                if let Err(fault) = self.one(row, &mut torque, motion, watch) {
                    failure = Some((row, fault));
                    break;
                }
            }
        }
        // A callback's own exception and errors that do not concern the integration come back as they are.
        if let Some((
            row,
            Failure {
                cause: Cause::Failed(fault),
                ..
            },
        )) = &failure
            && let Some(error) = fault.not_of_integration(py)
        {
            return Err(match fault {
                Fault::Core(_) => at_row(&self.grid.shape, *row, &error, py),
                Fault::Python(_) => error,
            });
        }
        Ok((motions, failure))
    }

    fn one<T: Torque>(
        &self,
        row: usize,
        torque: &mut T,
        motion: &mut Motion,
        mut watch: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(), Failure<T::Error>> {
        let [b, w, q, _, _, p] = self.grid.operands(row);
        let initial = State {
            attitude: self.start.attitude[q],
            omega: self.start.omega[w],
        };
        let equations = EulerEquations::about(&self.start.bodies[b], &self.start.about[p]);
        motion.samples = vec![State::nan(); self.times.len()];
        let effort = simulate(
            &equations,
            &initial,
            self.times,
            torque,
            self.tolerance,
            &mut motion.samples,
            &mut watch,
        )?;
        motion.effort = effort;
        Ok(())
    }

    /// The results as a `polhode.results.Trajectory`.
    fn trajectory<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyRigidBody>,
        load: Given<'_, 'py>,
        motions: &[Motion],
    ) -> PyResult<Bound<'py, PyAny>> {
        let shape = [&self.grid.shape[..], &[self.times.len()]].concat();
        let count = self.times.len();
        let sample = |row: usize, k: usize| {
            motions[row]
                .samples
                .get(k)
                .copied()
                .unwrap_or_else(State::nan)
        };
        let rows = || {
            self.grid
                .rows()
                .enumerate()
                .flat_map(|(row, operands)| (0..count).map(move |k| (row, k, operands)))
        };
        let vectors = |f: &dyn Fn(usize, usize, [usize; 6]) -> Vector3<f64>| -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            write(py, &Stack { shape: shape.clone(), rows: rows().map(|(row, k, operands)| f(row, k, operands)).collect() })
        };
        let quaternions: Vec<[f64; 4]> = rows()
            .map(|(row, k, _)| components(&sample(row, k).attitude))
            .collect();
        // No force acts, so the reference point keeps its velocity.
        let elapsed = |k: usize| self.times[k] - self.times[0];
        let effort = |f: fn(&Effort) -> u64| -> PyResult<Bound<'py, PyAny>> {
            let counts = motions
                .iter()
                .map(|motion| f(&motion.effort))
                .map(i64::try_from)
                .collect::<Result<Vec<_>, _>>();
            numpy::PyArray1::from_vec(py, counts.unwrap_or_default())
                .call_method1("reshape", (self.grid.shape.clone(),))
        };
        let fields = PyDict::new(py);
        fields.set_item("body", body)?;
        fields.set_item("t", numpy::PyArray1::from_slice(py, self.times))?;
        fields.set_item("omega", vectors(&|row, k, _| sample(row, k).omega)?)?;
        fields.set_item(
            "quaternion",
            write(
                py,
                &Stack {
                    shape: shape.clone(),
                    rows: quaternions,
                },
            )?,
        )?;
        fields.set_item(
            "position",
            vectors(&|_, k, [_, _, _, r, v, _]| {
                self.start.position[r] + self.start.velocity[v] * elapsed(k)
            })?,
        )?;
        fields.set_item(
            "velocity",
            vectors(&|_, _, [_, _, _, _, v, _]| self.start.velocity[v])?,
        )?;
        fields.set_item("about", write(py, &self.start.about)?)?;
        fields.set_item("load", load)?;
        fields.set_item("steps", effort(|effort| effort.steps)?)?;
        fields.set_item("evaluations", effort(|effort| effort.evaluations)?)?;
        py.import("polhode.results")?
            .getattr("Trajectory")?
            .call((), Some(&fields))
    }

    /// The exception for a run that ended early, with the time, the state and what was computed.
    fn integration_error(
        &self,
        py: Python<'_>,
        row: usize,
        failure: Failure<Fault>,
        partial: Bound<'_, PyAny>,
    ) -> PyErr {
        let Failure {
            time,
            state,
            cause: Cause::Failed(fault),
        } = failure
        else {
            return crate::errors::new(
                py,
                "IntegrationError",
                "the integration was stopped".to_owned(),
            );
        };
        let error = at_row(&self.grid.shape, row, &fault.into_py(py), py);
        let value = error.value(py);
        let attached = (|| {
            value.setattr("time", time)?;
            let attitude = write(py, &Stack::one(components(&state.attitude)))?;
            value.setattr("state", (attitude, write(py, &Stack::one(state.omega))?))?;
            value.setattr("partial", partial)
        })();
        attached.err().unwrap_or(error)
    }
}
