//! One term of a load: scaled, scheduled, picked from a stack, and as the recipe that makes it anew.

use numpy::PyUntypedArrayMethods;
use polhode::motion::loads::{Term, Windows};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use pyo3::{PyTraverseError, PyVisit};

use super::PyLoad;
use super::address::Compiled;
use super::called::Callback;
use crate::arrays::{numpy, read_list, try_rows};
use crate::errors::to_py;
use crate::interrupt::Beat;
use crate::rigid_body::{picked_by, to_index};
use crate::stack::{Broadcast, Stack};

/// A term, and how it was made.
pub(super) struct Part {
    pub(super) acts: Acts,
    /// The name of a function and its arguments, which make it anew; for pickle.
    pub(super) recipe: Py<PyTuple>,
}

pub(super) enum Acts {
    Term(Stack<Term>),
    Callback(Callback),
    Compiled(Compiled),
}

impl Part {
    /// The objects of Python that it holds.
    pub(super) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.recipe)?;
        match &self.acts {
            Acts::Term(_) => Ok(()),
            Acts::Callback(callback) => visit.call(callback.function()),
            Acts::Compiled(compiled) => visit.call(compiled.owner()),
        }
    }

    pub(super) fn copied(&self, py: Python<'_>) -> PyResult<Self> {
        Ok(Self {
            acts: match &self.acts {
                Acts::Term(terms) => Acts::Term(terms.map(py, Term::clone)?),
                Acts::Callback(callback) => Acts::Callback(callback.copied(py)),
                Acts::Compiled(compiled) => Acts::Compiled(compiled.copied(py)),
            },
            recipe: self.recipe.clone_ref(py),
        })
    }

    pub(super) fn shape(&self) -> &[usize] {
        match &self.acts {
            Acts::Term(terms) => &terms.shape,
            _ => &[],
        }
    }

    pub(super) fn scaled(&self, py: Python<'_>, factor: f64) -> PyResult<Self> {
        let mut scaled = self.copied(py)?;
        match &mut scaled.acts {
            Acts::Term(terms) => *terms = try_rows(py, terms, |term| term.scaled(factor))?,
            Acts::Callback(callback) => callback.factor *= factor,
            Acts::Compiled(compiled) => compiled.factor *= factor,
        }
        scaled.recipe = recipe(py, "_scaled", (&self.recipe, factor))?;
        Ok(scaled)
    }

    /// The rows that NumPy's indexing picks, of the part broadcast to `shape`.
    pub(super) fn picked(
        &self,
        py: Python<'_>,
        shape: &[usize],
        key: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let picked = picked_by(py, shape, key)?;
        let rows = picked.as_slice()?;
        let mut part = self.copied(py)?;
        if let Acts::Term(terms) = &part.acts {
            let grid = Broadcast::of(["load", "load"], [shape, &terms.shape])?;
            let taken = Broadcast::of(["key"], [picked.shape()])?;
            part.acts = Acts::Term(taken.try_map(py, |[k]| {
                Ok(terms[grid.operands(to_index(rows[k]))[1]].clone())
            })?);
        }
        part.recipe = recipe(py, "_picked", (&self.recipe, shape.to_vec(), key))?;
        Ok(part)
    }

    pub(super) fn scheduled(
        &self,
        py: Python<'_>,
        windows: &Windows,
        given: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let mut part = self.copied(py)?;
        let within = |own: &Option<Windows>| {
            Some(
                own.as_ref()
                    .map_or_else(|| windows.clone(), |own| own.within(windows)),
            )
        };
        match &mut part.acts {
            Acts::Term(terms) => {
                *terms = terms.map(py, |term| term.clone().scheduled(windows))?;
            }
            Acts::Callback(callback) => callback.windows = within(&callback.windows),
            Acts::Compiled(compiled) => compiled.windows = within(&compiled.windows),
        }
        part.recipe = recipe(py, "_scheduled", (&self.recipe, given))?;
        Ok(part)
    }
}

/// The name of a function and its arguments as a tuple.
pub(super) fn recipe<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyResult<Py<PyTuple>> {
    let arguments = arguments.into_pyobject(py)?;
    Ok((name, arguments).into_pyobject(py)?.unbind())
}

/// A recipe of recipes, innermost first. There may be very many: no function here calls itself for each.
fn unfolded<'py>(recipe: &Bound<'py, PyTuple>) -> PyResult<Vec<(String, Bound<'py, PyTuple>)>> {
    let mut steps: Vec<(String, Bound<'py, PyTuple>)> = vec![recipe.extract()?];
    let mut beat = Beat::new(recipe.py());
    while let Some((name, arguments)) = steps.last()
        && ["_scaled", "_scheduled", "_picked", "_anchored"].contains(&name.as_str())
    {
        beat.mark()?;
        steps.push(arguments.get_item(0)?.extract()?);
    }
    steps.reverse();
    Ok(steps)
}

/// A recipe in words: the function that made the term, and what was done to it.
pub(super) fn described(recipe: &Bound<'_, PyTuple>) -> PyResult<String> {
    let (mut before, mut after) = (Vec::new(), 0);
    let steps = unfolded(recipe)?;
    for (name, arguments) in steps[1..].iter().rev() {
        match name.as_str() {
            "_scaled" => {
                let factor: f64 = arguments.get_item(1)?.extract()?;
                before.push(format!("{factor:?} * "));
            }
            "_scheduled" => {
                before.push("schedule(".to_owned());
                after += 1;
            }
            _ => (),
        }
    }
    let made_by = match steps[0].0.as_str() {
        "_unpicklable" => "compiled",
        name => name,
    };
    Ok(format!("{}{made_by}{}", before.concat(), ")".repeat(after)))
}

/// The load of one recipe.
pub(super) fn made(py: Python<'_>, recipe: &Bound<'_, PyTuple>) -> PyResult<PyLoad> {
    let steps = unfolded(recipe)?;
    let (name, arguments) = &steps[0];
    let made = (py.import("polhode.loads")?.getattr(name.as_str())?)
        .call(arguments, None::<&Bound<'_, PyDict>>)?;
    let mut load = made.cast::<PyLoad>()?.get().copied(py)?;
    let mut beat = Beat::new(py);
    for (name, arguments) in &steps[1..] {
        beat.mark()?;
        load = match name.as_str() {
            "_scaled" => {
                let factor = arguments.get_item(1)?.extract()?;
                load.map(|part| part.scaled(py, factor))?
            }
            "_scheduled" => schedule_load(py, &load, &arguments.get_item(1)?)?,
            "_picked" => {
                let shape: Vec<usize> = arguments.get_item(1)?.extract()?;
                let key = arguments.get_item(2)?;
                load.map(|part| part.picked(py, &shape, &key))?
            }
            _ => load.anchored(py, arguments.get_item(1)?.extract()?)?,
        };
    }
    Ok(load)
}

/// `load` in windows of time alone.
pub(super) fn schedule_load(
    py: Python<'_>,
    load: &PyLoad,
    windows: &Bound<'_, PyAny>,
) -> PyResult<PyLoad> {
    let pairs: Stack<[f64; 2]> = read_list(windows, "windows", "n")?;
    let pairs: Vec<(f64, f64)> = pairs.rows.iter().map(|&[on, off]| (on, off)).collect();
    let opened = Windows::new(&pairs).map_err(|error| to_py(py, &error))?;
    let kept = numpy(py)?.call_method1("array", (windows, "float64"))?;
    load.map(|part| part.scheduled(py, &opened, &kept))
}
