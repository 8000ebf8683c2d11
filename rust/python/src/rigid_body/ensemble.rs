//! A run of `simulate`: every row integrated, on all cores without the GIL or one by one when the load calls Python.

use std::ops::ControlFlow;

use nalgebra::{UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::RigidBody;
use polhode::motion::attitude::components;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::loads::Torque;
use polhode::motion::simulate::{Cause, Effort, Failure, State, Tolerance, simulate};
use polhode::numerics::threads::{Halt, fill_blocks};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyRigidBody;
use crate::arrays::write;
use crate::errors::{at_row, to_py};
use crate::interrupt::Interrupt;
use crate::loads::{Fault, PyLoad};
use crate::stack::{Broadcast, Stack};

/// Bodies and their states at the start.
pub(super) struct Start<'a> {
    pub(super) bodies: &'a Stack<RigidBody>,
    pub(super) omega: Stack<Vector3<f64>>,
    pub(super) attitude: Stack<UnitQuaternion<f64>>,
    pub(super) position: Stack<Vector3<f64>>,
    pub(super) velocity: Stack<Vector3<f64>>,
    pub(super) about: Stack<Vector3<f64>>,
}

impl Start<'_> {
    pub(super) fn grid(&self) -> PyResult<Broadcast<6>> {
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
pub(super) struct Motion {
    samples: Vec<State>,
    effort: Effort,
}

/// The row that failed first, and how.
pub(super) type FirstFailure = Option<(usize, Failure<Fault>)>;

/// All that a run needs.
pub(super) struct Run<'a> {
    pub(super) start: &'a Start<'a>,
    pub(super) grid: Broadcast<6>,
    pub(super) times: &'a [f64],
    pub(super) tolerance: Tolerance,
}

impl Run<'_> {
    /// Every state at the start must be finite.
    pub(super) fn check(&self, py: Python<'_>) -> PyResult<()> {
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
    pub(super) fn all(
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
    pub(super) fn trajectory<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyRigidBody>,
        load: Option<&Bound<'py, PyAny>>,
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
    pub(super) fn integration_error(
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
