//! The derivatives of a motion under a load.

use std::convert::Infallible;

use nalgebra::{Matrix6, UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::RigidBody;
use polhode::motion::integrate::variation::{Variation, variations};
use polhode::motion::loads::Term;
use polhode::motion::simulate::{Method, Task, Tolerance};
use polhode::motion::state::{Phase, State};
use polhode::numerics::threads::fill_blocks;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::about::is_pivot;
use crate::arrays::{Numbers, read, write_of};
use crate::attitudes::read_attitude;
use crate::body::PyRigidBody;
use crate::errors::{at_row, new, to_py};
use crate::interrupt::{Beat, Interrupt};
use crate::loads::PyLoad;
use crate::memory;
use crate::stack::{Broadcast, Stack};
use crate::times::read_times;

/// The derivatives of motions from states at the first of the times.
#[pyfunction]
#[pyo3(signature = (body, t, omega, quaternion, load, about))]
pub(crate) fn motion_sensitivity<'py>(
    py: Python<'py>,
    body: &Bound<'py, PyRigidBody>,
    t: &Bound<'py, PyAny>,
    omega: &Bound<'py, PyAny>,
    quaternion: &Bound<'py, PyAny>,
    load: Option<&Bound<'py, PyLoad>>,
    about: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let nothing = PyLoad::default();
    let load = load.map_or(&nothing, Bound::get);
    if !load.is_analytic() {
        let message = "sensitivity: the load has parts that call a function, of which no derivatives are known; take \
             differences of motions simulated at rtol=1e-13 from states and loads a little apart"
            .to_owned();
        return Err(new(py, "PolhodeError", message));
    }
    let times = read_times(py, t)?;
    let motions = Motions {
        bodies: &body.get().bodies,
        omega: read(omega, "omega")?,
        attitude: read_attitude(Some(quaternion), "quaternion")?,
        terms: load.terms(py)?,
        times: &times,
        pivoted: is_pivot(about)?,
        tolerance: Tolerance::new(1e-10, 0.0).map_err(|error| to_py(py, &error))?,
    };
    let found = motions.vary(py)?;
    let parts = (
        write_of(py, &found, |slopes| Matrix6::from(slopes.state))?,
        write_of(py, &found, |slopes| slopes.moments)?,
        write_of(py, &found, |slopes| slopes.products)?,
        write_of(py, &found, |slopes| slopes.center_of_mass)?,
        write_of(py, &found, |slopes| slopes.mass)?,
        by_load(py, &motions.terms, &found)?,
    );
    py.import("polhode.results")?
        .getattr("MotionSensitivity")?
        .call1(parts)
}

/// Bodies, states at the start and loads.
struct Motions<'a> {
    bodies: &'a Stack<RigidBody>,
    omega: Stack<Vector3<f64>>,
    attitude: Stack<UnitQuaternion<f64>>,
    terms: Stack<Vec<Term>>,
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
        ];
        let grid = Broadcast::of(["body", "omega", "quaternion", "load"], shapes)?;
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
        [b, w, q, l]: [usize; 4],
        interrupt: &Interrupt,
    ) -> Result<Vec<Variation>, polhode::Error> {
        let initial = Phase::in_place(&State {
            attitude: self.attitude[q],
            omega: self.omega[w],
        });
        let of = if self.pivoted {
            Task::pivoted
        } else {
            Task::free
        };
        let body = &self.bodies[b];
        let task = of(body, initial, self.times, Method::Taylor, self.tolerance);
        variations(&task, &self.terms[l], &mut |_| interrupt.poll(None))
    }
}

/// For each term of the load a dictionary: the derivatives by each of its parameters.
fn by_load<'py>(
    py: Python<'py>,
    terms: &Stack<Vec<Term>>,
    found: &Stack<Variation>,
) -> PyResult<Bound<'py, PyTuple>> {
    let mut first = 0;
    let mut dictionaries = Vec::new();
    for term in terms.rows.first().into_iter().flatten() {
        let dictionary = PyDict::new(py);
        for parameter in term.parameters() {
            let columns = first..first + parameter.count();
            let slopes = columns_of(py, found, columns.clone(), &parameter.shape)?;
            dictionary.set_item(parameter.name, slopes)?;
            first = columns.end;
        }
        dictionaries.push(dictionary);
    }
    PyTuple::new(py, dictionaries)
}

/// Columns as an array, shape (..., 6) and then `shape`.
fn columns_of<'py>(
    py: Python<'py>,
    found: &Stack<Variation>,
    columns: std::ops::Range<usize>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let shape = [&found.shape[..], &[6], shape].concat();
    let mut numbers = Numbers::of::<f64>(py, "sensitivity", &shape)?;
    numbers.put(&found.rows, |slopes, out| {
        let columns = &slopes.load[columns.clone()];
        for row in 0..6 {
            out.extend(columns.iter().map(|column| column[row]));
        }
    })?;
    numbers.finish::<f64>(&shape)
}
