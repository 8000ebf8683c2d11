//! What the runs of `simulate` gave, as arrays, tables and exceptions.

use std::iter::repeat_n;

use nalgebra::Vector3;
use numpy::{PyArray1, PyArrayMethods, PyFixedUnicode};
use polhode::motion::attitude::components;
use polhode::motion::rolling::ContactPhase;
use polhode::motion::simulate::{ContactExtremes, Crossing, Effort, End, Run};
use polhode::motion::state::Phase;
use pyo3::exceptions::PyMemoryError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

use super::simulate_stack::{Ensemble, Results, Runs};
use crate::arrays::{Item, Numbers, write, write_of};
use crate::errors::at_row;
use crate::interrupt::Interrupt;
use crate::loads::{Fault, Slot};
use crate::memory;
use crate::stack::Stack;

/// What a run gave besides the states: as arrays and tables for those who ask.
#[pyclass(frozen)]
pub(crate) struct Outcome {
    times: Vec<f64>,
    shape: Vec<usize>,
    about: Stack<Vector3<f64>>,
    efforts: Vec<Effort>,
    /// Each with its row.
    crossings: Vec<(usize, Crossing)>,
    /// How many functions there are whose passages are events.
    functions: usize,
    /// The states of the load by name.
    slots: Vec<Slot>,
    /// The states of a run that Ctrl-C ended: to put them into arrays takes too long for whoever pressed it.
    samples: Vec<Option<Vec<Phase>>>,
}

impl Outcome {
    /// That of one motion with these states, about a point of the body; with its effort, its events and the number of their functions.
    pub(super) fn of_one(
        times: Vec<f64>,
        about: Vector3<f64>,
        (effort, crossings, functions): (Effort, Vec<Crossing>, usize),
        slots: Vec<Slot>,
        samples: Vec<Phase>,
    ) -> Self {
        Self {
            times,
            shape: Vec::new(),
            about: Stack::one(about),
            efforts: vec![effort],
            crossings: crossings.into_iter().map(|found| (0, found)).collect(),
            functions,
            slots,
            samples: vec![Some(samples)],
        }
    }

    /// An array of states that are not in arrays yet.
    fn array<'py, T: Item>(
        &self,
        py: Python<'py>,
        of: impl Fn(&Phase) -> T,
    ) -> PyResult<Bound<'py, PyAny>> {
        let shape = [&self.shape[..], &[self.times.len()]].concat();
        let rows = self.samples.iter().map(Option::as_deref);
        array(py, &shape, rows, of)
    }

    /// The states of the load at the events.
    fn states_of_events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        for slot in &self.slots {
            let found = self.crossings.iter();
            let values = found.flat_map(|(_, crossing)| slot.of(&crossing.phase.internal_state));
            let values = PyArray1::from_vec(py, values.copied().collect());
            named.set_item(
                &*slot.name,
                values.reshape([self.crossings.len(), slot.count])?,
            )?;
        }
        Ok(named)
    }

    /// The number of an event among the functions; −1, −2, … for those of a contact, in the order of `ContactEvent::ALL`.
    fn number(&self, crossing: &Crossing) -> i64 {
        let number = |n| i64::try_from(n).unwrap_or(i64::MAX);
        match crossing.event.checked_sub(self.functions) {
            None => number(crossing.event),
            Some(of_contact) => -1 - number(of_contact),
        }
    }

    fn counts<'py>(&self, py: Python<'py>, of: fn(&Effort) -> u64) -> PyResult<Bound<'py, PyAny>> {
        let count = |effort| i64::try_from(of(effort)).unwrap_or(i64::MAX);
        let counts = self.efforts.iter().map(count).collect();
        let counts = PyArray1::from_vec(py, counts).reshape(self.shape.clone())?;
        Ok(counts.into_any())
    }
}

#[pymethods]
impl Outcome {
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        PyArray1::from_slice(py, &self.times).into_any()
    }

    #[getter]
    fn about<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(write(py, &self.about)?.into_any())
    }

    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.counts(py, |effort| effort.steps)
    }

    #[getter]
    fn evaluations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.counts(py, |effort| effort.evaluations)
    }

    #[getter]
    fn omega<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.array(py, |phase| phase.omega)
    }

    #[getter]
    fn quaternion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.array(py, |phase| components(&phase.attitude))
    }

    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.array(py, |phase| phase.position)
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.array(py, |phase| phase.velocity)
    }

    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let shape = [&self.shape[..], &[self.times.len()]].concat();
        let rows: Vec<_> = self.samples.iter().map(Option::as_deref).collect();
        states(py, &self.slots, &shape, &rows)
    }

    /// The events of all rows, one after the other.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let found = Stack {
            shape: vec![self.crossings.len()],
            rows: self.crossings.iter().collect(),
        };
        let counts = |of: fn(&(usize, Crossing)) -> usize| {
            let numbers = self.crossings.iter().map(of);
            let numbers: Vec<i64> = numbers.filter_map(|n| i64::try_from(n).ok()).collect();
            PyArray1::from_vec(py, numbers)
        };
        let columns = (
            self.states_of_events(py)?,
            counts(|found| found.0),
            PyArray1::from_vec(
                py,
                self.crossings
                    .iter()
                    .map(|found| self.number(&found.1))
                    .collect(),
            ),
            write_of(py, &found, |found| found.1.time)?,
            write_of(py, &found, |found| found.1.phase.omega)?,
            write_of(py, &found, |found| components(&found.1.phase.attitude))?,
            write_of(py, &found, |found| found.1.phase.position)?,
            write_of(py, &found, |found| found.1.phase.velocity)?,
        );
        let table = py
            .import("polhode.motion.events")?
            .getattr("Events")?
            .call_method1("with_states", columns)?;
        Ok(table)
    }
}

impl Ensemble<'_> {
    /// The results as a `polhode.Trajectory`, and whether a row failed.
    pub(super) fn trajectory<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        load: Option<&Bound<'py, PyAny>>,
        runs: Runs,
        interrupt: &Interrupt,
    ) -> Results<'py> {
        let failures = self.failures(py, &runs)?;
        let fields = PyDict::new(py);
        fields.set_item(intern!(py, "body"), body)?;
        fields.set_item(intern!(py, "status"), self.status(py, &runs)?)?;
        fields.set_item(intern!(py, "failures"), &failures)?;
        fields.set_item(intern!(py, "load"), load)?;
        fields.set_item(intern!(py, "pivoted"), self.plan.pivoted())?;
        let shape = [&self.grid.shape[..], &[self.plan.times().len()]].concat();
        let slots = self.load.slots();
        if !interrupt.is_stopped()
            && let Err(error) = put_states(py, &fields, &shape, &runs, &slots)
        {
            if error.is_instance_of::<PyMemoryError>(py) {
                return Err(error);
            }
            interrupt.stop(error);
        }
        let keeps = interrupt.is_stopped();
        if self.rolling.is_some() {
            let extremes = |of: fn(&ContactExtremes) -> [f64; 2]| {
                let rows = runs.iter().map(|run| {
                    let contact = run.as_ref().and_then(|run| run.contact.as_ref());
                    contact.map_or([f64::NAN; 2], of)
                });
                let rows = rows.collect();
                let shape = self.grid.shape.clone();
                write(py, &Stack { shape, rows })
            };
            let friction = extremes(|contact| contact.friction_needed)?;
            let normal = extremes(|contact| contact.normal_force)?;
            fields.set_item(intern!(py, "_contact_extremes"), (friction, normal))?;
            let (phases, work) = along_contact(&runs, self.plan.times().len());
            let shape = [&self.grid.shape[..], &[self.plan.times().len()]].concat();
            let [phases, work] = [phases, work].map(|rows| {
                let shape = shape.clone();
                write(py, &Stack { shape, rows })
            });
            fields.set_item(intern!(py, "_contact_states"), (phases?, work?))?;
        }
        let ended = matches!(
            runs[..],
            [Some(Run {
                end: End::Event,
                ..
            })]
        );
        let mut efforts = memory::vector("result", &self.grid.shape, 0)?;
        let (mut crossings, mut samples) = (Vec::new(), Vec::new());
        for (row, run) in runs.into_iter().enumerate() {
            efforts.push(run.as_ref().map_or_else(Effort::default, |run| run.effort));
            let (states, found) = run.map(|run| (run.samples, run.crossings)).unzip();
            let found = found.into_iter().flatten();
            crossings.extend(found.map(|crossing| (row, crossing)));
            if keeps {
                samples.push(states);
            }
        }
        if let ([], [(_, last)], true) = (
            &self.grid.shape[..],
            &crossings[crossings.len().saturating_sub(1)..],
            ended,
        ) {
            fields.set_item(intern!(py, "_ended_by"), self.events.function(last.event))?;
        }
        let outcome = Outcome {
            times: self.plan.times().to_vec(),
            shape: self.grid.shape.clone(),
            about: if self.plan.pivoted() {
                Stack::one(Vector3::zeros())
            } else if let Some(varying) = self.varying {
                // One for each time; beyond the times of the body the run has not come.
                let center = |&t: &f64| {
                    let body = varying.at(t);
                    body.map_or(Vector3::repeat(f64::NAN), |body| body.center_of_mass())
                };
                Stack {
                    shape: vec![self.plan.times().len()],
                    rows: self.plan.times().iter().map(center).collect(),
                }
            } else {
                (self.start.bodies).map(py, polhode::RigidBody::center_of_mass)?
            },
            efforts,
            crossings,
            functions: self.events.len(),
            slots,
            samples,
        };
        fields.set_item(intern!(py, "_outcome"), Bound::new(py, outcome)?)?;
        let motion = of_run(py)?.call1((fields,))?;
        Ok((motion, !failures.is_empty()))
    }

    /// A word for each row: how its run ended.
    fn status<'py>(&self, py: Python<'py>, runs: &Runs) -> PyResult<Bound<'py, PyAny>> {
        let word = |run: &Option<Run<Fault>>| match run.as_ref().map(|run| &run.end) {
            None => "not run",
            Some(End::Complete) => "complete",
            Some(End::Event) => "event",
            Some(End::Contact(event)) => event.word(),
            Some(End::Stopped) => "stopped",
            Some(End::Failed(_)) => "failed",
        };
        if let ([], [run]) = (&self.grid.shape[..], &runs[..]) {
            return Ok(word(run).into_pyobject(py)?.into_any());
        }
        let words = runs.iter().map(|run| fixed_width(word(run))).collect();
        let words = PyArray1::from_vec(py, words).reshape(self.grid.shape.clone())?;
        Ok(words.into_any())
    }

    /// An exception, not raised, for each row that failed.
    fn failures<'py>(&self, py: Python<'py>, runs: &Runs) -> PyResult<Bound<'py, PyTuple>> {
        let mut failures = Vec::new();
        for (row, run) in runs.iter().enumerate() {
            if let Some(run) = run
                && let End::Failed(fault) = &run.end
            {
                failures.push(self.exception(py, row, run, fault)?.value(py).clone());
            }
        }
        PyTuple::new(py, failures)
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
        tell(&error, row, run, py)?;
        Ok(error)
    }
}

/// The exception of a run knows its row, and the time and the state that the run came to.
pub(super) fn tell(error: &PyErr, row: usize, run: &Run<Fault>, py: Python<'_>) -> PyResult<()> {
    let value = error.value(py);
    value.setattr("row", row)?;
    value.setattr("time", run.time)?;
    let attitude = write(py, &Stack::one(components(&run.phase.attitude)))?;
    value.setattr(
        "state",
        (attitude, write(py, &Stack::one(run.phase.omega))?),
    )
}

/// What bodies do, in numbers as `phase_of` reads them, and the work of the plane so far, at all times.
fn along_contact(runs: &Runs, times: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut phases, mut work) = (Vec::new(), Vec::new());
    for (row, run) in runs.iter().enumerate() {
        if let Some(run) = run {
            phases.extend((run.contact_phases.iter()).map(|phase| match phase {
                ContactPhase::Rolling => 0.0,
                ContactPhase::Sliding => 1.0,
                ContactPhase::Flying => 2.0,
            }));
            let done = |sample: &Phase| sample.internal_state.first().copied().unwrap_or(0.0);
            work.extend(run.samples.iter().map(done));
        }
        phases.resize((row + 1) * times, f64::NAN);
        work.resize((row + 1) * times, f64::NAN);
    }
    (phases, work)
}

/// The states of all rows as the arrays of a trajectory.
fn put_states(
    py: Python<'_>,
    fields: &Bound<'_, PyDict>,
    shape: &[usize],
    runs: &Runs,
    slots: &[Slot],
) -> PyResult<()> {
    let rows = || (runs.iter()).map(|run| run.as_ref().map(|run| &run.samples[..]));
    let omega = array(py, shape, rows(), |phase| phase.omega)?;
    let quaternion = array(py, shape, rows(), |phase| components(&phase.attitude))?;
    let position = array(py, shape, rows(), |phase| phase.position)?;
    let velocity = array(py, shape, rows(), |phase| phase.velocity)?;
    fields.set_item(intern!(py, "omega"), omega)?;
    fields.set_item(intern!(py, "quaternion"), quaternion)?;
    fields.set_item(intern!(py, "position"), position)?;
    fields.set_item(intern!(py, "velocity"), velocity)?;
    let rows: Vec<_> = rows().collect();
    fields.set_item(intern!(py, "states"), states(py, slots, shape, &rows)?)
}

/// The states of the load by name, each of shape (..., T, k); not numbers where a row did not come to.
fn states<'py>(
    py: Python<'py>,
    slots: &[Slot],
    shape: &[usize],
    rows: &[Option<&[Phase]>],
) -> PyResult<Bound<'py, PyDict>> {
    let times = shape.last().copied().unwrap_or(0);
    let named = PyDict::new(py);
    for slot in slots {
        let shape = [shape, &[slot.count]].concat();
        let mut numbers = Numbers::of::<f64>(py, "result", &shape)?;
        let each = rows.iter().copied().flat_map(|row| at_times(row, times));
        numbers.put(each, |phase, out| match phase {
            Some(phase) => out.extend_from_slice(slot.of(&phase.internal_state)),
            None => out.extend(repeat_n(f64::NAN, slot.count)),
        })?;
        named.set_item(&*slot.name, numbers.finish::<f64>(&shape)?)?;
    }
    Ok(named)
}

/// One item for each state of each row; not numbers where it did not come to.
fn array<'a, 'py, T: Item>(
    py: Python<'py>,
    shape: &[usize],
    rows: impl Iterator<Item = Option<&'a [Phase]>>,
    of: impl Fn(&Phase) -> T,
) -> PyResult<Bound<'py, PyAny>> {
    let times = shape.last().copied().unwrap_or(0);
    let unknown = Phase::nan();
    let mut numbers = Numbers::of::<T>(py, "result", shape)?;
    let each = rows.flat_map(|row| at_times(row, times));
    numbers.put(each, |phase, out| of(phase.unwrap_or(&unknown)).write(out))?;
    Ok(numbers.finish::<T>(shape)?.into_any())
}

/// The states of a row at so many times; none where it did not come to.
fn at_times(row: Option<&[Phase]>, times: usize) -> impl Iterator<Item = Option<&Phase>> {
    let states = row.unwrap_or_default();
    let missing = repeat_n(None, times.saturating_sub(states.len()));
    states.iter().map(Some).chain(missing)
}

/// `polhode.motion.trajectory.Trajectory._of_run`.
pub(super) fn of_run(py: Python<'_>) -> PyResult<&Bound<'_, PyAny>> {
    static FUNCTION: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let function = FUNCTION.get_or_try_init(py, || {
        let class = py
            .import("polhode.motion.trajectory")?
            .getattr("Trajectory")?;
        class.getattr("_of_run").map(Bound::unbind)
    })?;
    Ok(function.bind(py))
}

/// A word of at most eight letters as NumPy's `<U8`.
fn fixed_width(word: &str) -> PyFixedUnicode<8> {
    let mut letters = [0; 8];
    for (letter, code) in letters.iter_mut().zip(word.chars()) {
        *letter = u32::from(code);
    }
    letters.into()
}
