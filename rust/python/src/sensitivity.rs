//! The derivatives of a motion under a load.

use std::convert::Infallible;
use std::ops::Range;

use nalgebra::{UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::RigidBody;
use polhode::motion::integrate::variation::{Variation, variations};
use polhode::motion::loads::Term;
use polhode::motion::simulate::{Method, Task, Tolerance};
use polhode::motion::state::{Phase, State};
use polhode::parallel::fill_blocks;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::about::is_pivot;
use crate::arrays::{Numbers, read, read_scalar};
use crate::attitudes::read_attitude;
use crate::body::PyRigidBody;
use crate::errors::{at_row, new, to_py};
use crate::interrupt::{Beat, Interrupt};
use crate::loads::PyLoad;
use crate::memory;
use crate::stack::{Broadcast, Stack};
use crate::times::read_times;

/// Names, item by item: what an object says of its length is not relied on.
fn read_names(object: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    object.try_iter()?.map(|name| name?.extract()).collect()
}

/// The derivatives of motions from states at the first of the times; `given` names the states of the load that do not follow from its
/// numbers.
#[pyfunction]
#[pyo3(signature = (body, t, omega, quaternion, load, about, states=None, given=Vec::new()))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub(crate) fn motion_sensitivity<'py>(
    py: Python<'py>,
    body: &Bound<'py, PyRigidBody>,
    t: &Bound<'py, PyAny>,
    omega: &Bound<'py, PyAny>,
    quaternion: &Bound<'py, PyAny>,
    load: Option<&Bound<'py, PyLoad>>,
    #[pyo3(from_py_with = read_scalar)] about: &str,
    states: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = read_names)] given: Vec<String>,
) -> PyResult<Bound<'py, PyAny>> {
    let nothing = PyLoad::default();
    let load = load.map_or(&nothing, Bound::get);
    if !load.is_analytic() {
        let message = "sensitivity: the load has parts that call a function, of which no derivatives are known; \
             sensitivity(method=\"differences\") takes differences of motions from states and loads a little apart"
            .to_owned();
        return Err(new(py, "PolhodeError", message));
    }
    let times = read_times(py, t)?;
    let motions = Motions {
        bodies: &body.get().bodies,
        omega: read(omega, "omega")?,
        attitude: read_attitude(Some(quaternion), "quaternion")?,
        terms: load.terms(py)?,
        states: load.read_states(states, false)?,
        given: load
            .slots()
            .iter()
            .flat_map(|slot| vec![given.iter().any(|name| **name == *slot.name); slot.count])
            .collect(),
        load,
        times: &times,
        pivoted: is_pivot(about)?,
        tolerance: Tolerance::new(1e-10, 0.0).map_err(|error| to_py(py, &error))?,
    };
    let found = motions.vary(py)?;
    let own = motions.given.len();
    let numbers = motions.terms.rows.first().into_iter().flatten();
    let first = LOAD + numbers.map(Term::count).sum::<usize>();
    let [state, moments, products, center, mass] = Variation::COLUMNS;
    let of = |columns: Range<usize>| {
        let shape = [columns.len()];
        columns_of(py, &found, own, &columns.collect::<Vec<_>>(), &shape)
    };
    let both: Vec<usize> = state.chain(first..first + own).collect();
    let parts = (
        columns_of(py, &found, own, &both, &[both.len()])?,
        of(moments)?,
        of(products)?,
        of(center)?,
        columns_of(py, &found, own, &mass.collect::<Vec<_>>(), &[])?,
        by_load(py, &motions.terms, &found, own)?,
        begins(py, &found, own)?,
    );
    py.import("polhode.results")?
        .getattr("MotionSensitivity")?
        .call1(parts)
}

/// The column of the first number of a load.
const LOAD: usize = Variation::COLUMNS[4].end;

/// Bodies, states at the start and loads.
struct Motions<'a> {
    bodies: &'a Stack<RigidBody>,
    omega: Stack<Vector3<f64>>,
    attitude: Stack<UnitQuaternion<f64>>,
    terms: Stack<Vec<Term>>,
    load: &'a PyLoad,
    /// As they are reported.
    states: Stack<Vec<f64>>,
    /// Whether each of them does not follow from the numbers of the load.
    given: Vec<bool>,
    times: &'a [f64],
    pivoted: bool,
    tolerance: Tolerance,
}

impl Motions<'_> {
    /// The derivatives of every row at every time, on all cores.
    fn vary(&self, py: Python<'_>) -> PyResult<Stack<Variation>> {
        let shapes = [
            &self.bodies.shape[..],
            &self.omega.shape,
            &self.attitude.shape,
            &self.terms.shape,
            &self.states.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "quaternion", "load", "states"], shapes)?;
        let shape = [&grid.shape[..], &[self.times.len()]].concat();
        let mut found = memory::vector("sensitivity", &shape, 2)?;
        let mut rows = memory::vector("sensitivity", &grid.shape, 0)?;
        rows.resize_with(grid.len(), || None);
        let interrupt = Interrupt::new(None);
        let outcome = py.detach(|| {
            let mut watch = |_| interrupt.poll(None);
            fill_blocks(&mut rows, 1, &mut watch, |row, out| {
                out[0] = Some(self.of(grid.operands(row), &interrupt));
                Ok::<(), Infallible>(())
            })
        });
        interrupt.finish(py, outcome.is_ok())?;
        let mut beat = Beat::new(py);
        for (row, slopes) in rows.into_iter().flatten().enumerate() {
            beat.mark()?;
            let slopes = slopes.map_err(|error| at_row(&grid.shape, row, &to_py(py, &error), py));
            found.extend(slopes?);
        }
        Ok(Stack { shape, rows: found })
    }

    fn of(
        &self,
        [b, w, q, l, s]: [usize; 5],
        interrupt: &Interrupt,
    ) -> Result<Vec<Variation>, polhode::Error> {
        let mut initial = Phase::in_place(&State {
            attitude: self.attitude[q],
            omega: self.omega[w],
        });
        let terms = &self.terms[l];
        initial.internal_state =
            (self.load).initial_states(terms, self.times[0], &self.omega[w], &self.states[s]);
        let of = if self.pivoted {
            Task::pivoted
        } else {
            Task::free
        };
        let body = &self.bodies[b];
        let task = of(body, initial, self.times, Method::Taylor, self.tolerance);
        variations(&task, terms, &self.given, &mut |_| interrupt.poll(None))
    }
}

/// For each term of the load a dictionary: the derivatives by each of its parameters.
fn by_load<'py>(
    py: Python<'py>,
    terms: &Stack<Vec<Term>>,
    found: &Stack<Variation>,
    own: usize,
) -> PyResult<Bound<'py, PyTuple>> {
    let mut first = LOAD;
    let mut dictionaries = Vec::new();
    for term in terms.rows.first().into_iter().flatten() {
        let dictionary = PyDict::new(py);
        for parameter in term.parameters() {
            let end = first + parameter.count();
            let columns: Vec<usize> = (first..end).collect();
            let slopes = columns_of(py, found, own, &columns, &parameter.shape)?;
            dictionary.set_item(parameter.name, slopes)?;
            first = end;
        }
        dictionaries.push(dictionary);
    }
    PyTuple::new(py, dictionaries)
}

/// Columns as an array, shape (..., 6 + own) and then `shape`.
fn columns_of<'py>(
    py: Python<'py>,
    found: &Stack<Variation>,
    own: usize,
    columns: &[usize],
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let shape = [&found.shape[..], &[6 + own], shape].concat();
    let mut numbers = Numbers::of::<f64>(py, "sensitivity", &shape)?;
    numbers.put(&found.rows, |slopes, out| {
        for row in 0..6 + own {
            out.extend(columns.iter().map(|&column| slopes.slope(row, column)));
        }
    })?;
    numbers.finish::<f64>(&shape)
}

/// By ω at the start the states there that follow from it, shape (..., own, 3).
fn begins<'py>(
    py: Python<'py>,
    found: &Stack<Variation>,
    own: usize,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let times = found.shape.last().copied().unwrap_or(1);
    let shape = [&found.shape[..found.shape.len() - 1], &[own, 3]].concat();
    let mut numbers = Numbers::of::<f64>(py, "sensitivity", &shape)?;
    let firsts: Vec<_> = found.rows.iter().step_by(times).collect();
    numbers.put(&firsts, |slopes, out| {
        out.extend(slopes.begins.iter().flatten());
    })?;
    numbers.finish::<f64>(&shape)
}
