//! What the runs of `simulate` gave, as arrays, tables and exceptions.

use nalgebra::Vector3;
use numpy::{PyArray1, PyArrayMethods};
use polhode::motion::attitude::components;
use polhode::motion::simulate::{Crossing, Effort, End, Run};
use polhode::motion::state::Phase;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use super::PyRigidBody;
use super::ensemble::{Ensemble, Runs};
use crate::arrays::{numpy, write, write_of};
use crate::errors::at_row;
use crate::loads::Fault;
use crate::stack::Stack;

impl Ensemble<'_> {
    /// The results as a `polhode.Trajectory`.
    pub(super) fn trajectory<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyRigidBody>,
        load: Option<&Bound<'py, PyAny>>,
        runs: &Runs,
    ) -> PyResult<Bound<'py, PyAny>> {
        let unknown = vec![Phase::nan(); self.times.len()];
        let samples = Stack {
            shape: [&self.grid.shape[..], &[self.times.len()]].concat(),
            rows: (runs.iter())
                .flat_map(|run| run.as_ref().map_or(&unknown, |run| &run.samples))
                .copied()
                .collect(),
        };
        let about = if self.pivoted {
            Stack::one(Vector3::zeros())
        } else {
            self.start.bodies.map(polhode::RigidBody::center_of_mass)
        };
        let effort = |f: fn(&Effort) -> u64| {
            let count = |run: &Run<Fault>| i64::try_from(f(&run.effort)).unwrap_or(i64::MAX);
            let counts = (runs.iter().map(|run| run.as_ref().map_or(0, count))).collect();
            PyArray1::from_vec(py, counts).reshape(self.grid.shape.clone())
        };
        let fields = PyDict::new(py);
        fields.set_item("body", body)?;
        fields.set_item("t", PyArray1::from_slice(py, self.times))?;
        fields.set_item("omega", write_of(py, &samples, |phase| phase.omega)?)?;
        fields.set_item(
            "quaternion",
            write_of(py, &samples, |phase| components(&phase.attitude))?,
        )?;
        fields.set_item("position", write_of(py, &samples, |phase| phase.position)?)?;
        fields.set_item("velocity", write_of(py, &samples, |phase| phase.velocity)?)?;
        fields.set_item("about", write(py, &about)?)?;
        fields.set_item("load", load)?;
        fields.set_item("steps", effort(|effort| effort.steps)?)?;
        fields.set_item("evaluations", effort(|effort| effort.evaluations)?)?;
        fields.set_item("status", self.status(py, runs)?)?;
        fields.set_item("events", table(py, runs)?)?;
        fields.set_item("pivoted", self.pivoted)?;
        fields.set_item("failures", self.failures(py, runs)?)?;
        py.import("polhode.trajectory")?
            .getattr("Trajectory")?
            .call((), Some(&fields))
    }

    /// A word for each row: how its run ended.
    fn status<'py>(&self, py: Python<'py>, runs: &Runs) -> PyResult<Bound<'py, PyAny>> {
        let word = |run: &Option<Run<Fault>>| match run.as_ref().map(|run| &run.end) {
            None => "not run",
            Some(End::Complete) => "complete",
            Some(End::Event) => "event",
            Some(End::Stopped) => "stopped",
            Some(End::Failed(_)) => "failed",
        };
        if let ([], [run]) = (&self.grid.shape[..], &runs[..]) {
            return Ok(word(run).into_pyobject(py)?.into_any());
        }
        let words: Vec<_> = runs.iter().map(word).collect();
        numpy(py)?
            .call_method1("array", (words, "<U8"))?
            .call_method1("reshape", (PyTuple::new(py, &self.grid.shape)?,))
    }

    /// An exception, not raised, for each row that failed.
    fn failures<'py>(&self, py: Python<'py>, runs: &Runs) -> PyResult<Bound<'py, PyTuple>> {
        let failures = PyList::empty(py);
        for (row, run) in runs.iter().enumerate() {
            if let Some(run) = run
                && let End::Failed(fault) = &run.end
            {
                failures.append(self.exception(py, row, run, fault)?.value(py))?;
            }
        }
        Ok(failures.to_tuple())
    }

    /// The exception of a row that failed, with its number, the time and the state.
    fn exception(
        &self,
        py: Python<'_>,
        row: usize,
        run: &Run<Fault>,
        fault: &Fault,
    ) -> PyResult<PyErr> {
        let error = at_row(&self.grid.shape, row, &fault.to_exception(py), py);
        let value = error.value(py);
        value.setattr("row", row)?;
        value.setattr("time", run.time)?;
        let attitude = write(py, &Stack::one(components(&run.phase.attitude)))?;
        value.setattr(
            "state",
            (attitude, write(py, &Stack::one(run.phase.omega))?),
        )?;
        Ok(error)
    }
}

/// The events of all rows, one after the other.
fn table<'py>(py: Python<'py>, runs: &Runs) -> PyResult<Bound<'py, PyAny>> {
    let found: Vec<(usize, &Crossing)> = (runs.iter().enumerate())
        .flat_map(|(row, run)| {
            (run.iter().flat_map(|run| &run.crossings)).map(move |crossing| (row, crossing))
        })
        .collect();
    let found = Stack {
        shape: vec![found.len()],
        rows: found,
    };
    let counts = |f: fn(&(usize, &Crossing)) -> usize| {
        let numbers = found.rows.iter().map(f);
        let numbers: Vec<i64> = numbers.filter_map(|n| i64::try_from(n).ok()).collect();
        PyArray1::from_vec(py, numbers)
    };
    let columns = (
        counts(|found| found.0),
        counts(|found| found.1.event),
        write_of(py, &found, |found| found.1.time)?,
        write_of(py, &found, |found| found.1.phase.omega)?,
        write_of(py, &found, |found| components(&found.1.phase.attitude))?,
        write_of(py, &found, |found| found.1.phase.position)?,
        write_of(py, &found, |found| found.1.phase.velocity)?,
    );
    py.import("polhode.events")?
        .getattr("Events")?
        .call1(columns)
}
