//! One term of a load: scaled, scheduled, picked from a stack, and as the recipe that makes it anew.

use polhode::motion::loads::{Term, Windows};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::PyLoad;
use super::address::Compiled;
use super::called::Callback;
use crate::arrays::{as_array, numpy, read_list, try_rows};
use crate::errors::to_py;
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
    pub(super) fn copied(&self, py: Python<'_>) -> Self {
        Self {
            acts: match &self.acts {
                Acts::Term(terms) => Acts::Term(terms.clone()),
                Acts::Callback(callback) => Acts::Callback(callback.copied(py)),
                Acts::Compiled(compiled) => Acts::Compiled(compiled.copied(py)),
            },
            recipe: self.recipe.clone_ref(py),
        }
    }

    pub(super) fn shape(&self) -> &[usize] {
        match &self.acts {
            Acts::Term(terms) => &terms.shape,
            _ => &[],
        }
    }

    pub(super) fn scaled(&self, py: Python<'_>, factor: f64) -> PyResult<Self> {
        let mut scaled = self.copied(py);
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
        let numbers = numpy(py)?.call_method1("arange", (shape.iter().product::<usize>(),))?;
        let numbers = numbers.call_method1("reshape", (PyTuple::new(py, shape)?,))?;
        let picked = as_array(&numbers.get_item(key)?, "key")?;
        let rows = Stack {
            shape: picked.getattr("shape")?.extract()?,
            rows: picked
                .call_method0("ravel")?
                .call_method0("tolist")?
                .extract::<Vec<usize>>()?,
        };
        let mut part = self.copied(py);
        if let Acts::Term(terms) = &part.acts {
            let grid = Broadcast::of(["load", "load"], [shape, &terms.shape])?;
            part.acts = Acts::Term(rows.map(|&row| terms[grid.operands(row)[1]].clone()));
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
        let mut part = self.copied(py);
        let within = |own: &Option<Windows>| {
            Some(
                own.as_ref()
                    .map_or_else(|| windows.clone(), |own| own.within(windows)),
            )
        };
        match &mut part.acts {
            Acts::Term(terms) => *terms = terms.map(|term| term.clone().scheduled(windows)),
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

/// A recipe in words: the function that made the term, and what was done to it.
pub(super) fn described(recipe: &Bound<'_, PyTuple>) -> PyResult<String> {
    let (name, arguments): (String, Bound<'_, PyTuple>) = recipe.extract()?;
    let inner = || described(&arguments.get_item(0)?.cast_into::<PyTuple>()?);
    Ok(match name.as_str() {
        "_scaled" => {
            let factor: f64 = arguments.get_item(1)?.extract()?;
            format!("{factor:?} * {}", inner()?)
        }
        "_scheduled" => format!("schedule({})", inner()?),
        "_picked" | "_anchored" => inner()?,
        "_unpicklable" => "compiled".to_owned(),
        _ => name,
    })
}

/// The load of one recipe.
pub(super) fn made(py: Python<'_>, name: &str, arguments: &Bound<'_, PyTuple>) -> PyResult<PyLoad> {
    let inner = || -> PyResult<PyLoad> {
        let (name, arguments): (String, Bound<'_, PyTuple>) = arguments.get_item(0)?.extract()?;
        made(py, &name, &arguments)
    };
    match name {
        "_scaled" => {
            let factor = arguments.get_item(1)?.extract()?;
            inner()?.map(|part| part.scaled(py, factor))
        }
        "_scheduled" => {
            let windows = arguments.get_item(1)?;
            schedule_load(py, &inner()?, &windows)
        }
        "_picked" => {
            let shape: Vec<usize> = arguments.get_item(1)?.extract()?;
            let key = arguments.get_item(2)?;
            inner()?.map(|part| part.picked(py, &shape, &key))
        }
        "_anchored" => inner()?.anchored(py, arguments.get_item(1)?.extract()?),
        _ => {
            let module = py.import("polhode.loads")?;
            let made = module
                .getattr(name)?
                .call(arguments, None::<&Bound<'_, PyDict>>)?;
            let made = made.cast::<PyLoad>()?.get().copied(py);
            Ok(made)
        }
    }
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
