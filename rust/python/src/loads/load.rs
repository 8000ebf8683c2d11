//! The class `Load`: a sum of terms. What Python's operators do with it is in `operators`.

use polhode::motion::loads::{Term, Windows};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::address::Compiled;
use super::called::Callback;
use super::part::{Acts, Part};
use super::recipe::{recipe, unfolded};
use super::stateful::WithStates;
use crate::arrays::{numpy, read_list};
use crate::errors::to_py;
use crate::interrupt::Beat;
use crate::stack::{Broadcast, Stack};

/// Forces and torques on a body, as a sum of terms. Made by the functions of :mod:`polhode.loads`.
///
/// Loads can be added and multiplied by a factor: ``a + b``, ``a - b``, ``2 * a``, ``-a``, ``sum(loads)``.
/// Arguments with leading axes make a stack of loads, which broadcasts against bodies and states.
///
/// Examples
/// --------
/// >>> from polhode import loads
/// >>> loads.constant_torque((0, 0, 1)) + 2 * loads.constant_torque((0, 2, 0), frame="space")
/// <Load: constant_torque + 2.0 * constant_torque>
#[pyclass(name = "Load", module = "polhode.loads", frozen)]
#[derive(Default)]
pub(crate) struct PyLoad {
    pub(super) parts: Vec<Part>,
}

impl PyLoad {
    pub(super) fn one(acts: Acts, recipe: Py<PyTuple>) -> Self {
        Self {
            parts: vec![Part {
                acts,
                recipe,
                name: None,
            }],
        }
    }

    /// The load with a name for the states of its parts.
    pub(super) fn named(mut self, name: &str) -> Self {
        for part in &mut self.parts {
            part.name = Some(name.into());
        }
        self
    }

    pub(crate) fn copied(&self, py: Python<'_>) -> PyResult<Self> {
        self.map(|part| part.copied(py))
    }

    pub(super) fn plus(&self, py: Python<'_>, other: &Self) -> PyResult<Self> {
        let mut sum = self.copied(py)?;
        sum.parts.append(&mut other.copied(py)?.parts);
        sum.stack_shape()?;
        Ok(sum)
    }

    pub(super) fn map(&self, f: impl Fn(&Part) -> PyResult<Part>) -> PyResult<Self> {
        let parts = self.parts.iter().map(f).collect::<PyResult<_>>()?;
        Ok(Self { parts })
    }

    /// The shape to which the terms broadcast.
    pub(super) fn stack_shape(&self) -> PyResult<Vec<usize>> {
        self.parts.iter().try_fold(Vec::new(), |shape, part| {
            Ok(Broadcast::of(["load", "load"], [&shape, part.shape()])?.shape)
        })
    }

    /// The analytic terms of each row.
    pub(crate) fn terms(&self, py: Python<'_>) -> PyResult<Stack<Vec<Term>>> {
        let shape = self.stack_shape()?;
        let analytic = self.parts.iter().filter_map(|part| match &part.acts {
            Acts::Term(terms) => Some(terms),
            _ => None,
        });
        let parts = analytic
            .map(|terms| {
                Ok((
                    terms,
                    Broadcast::of(["load", "load"], [&shape, &terms.shape])?,
                ))
            })
            .collect::<PyResult<Vec<_>>>()?;
        Broadcast::of(["load"], [&shape])?.try_map(py, |[row]| {
            let terms = parts.iter().map(|(terms, grid)| {
                let [_, own] = grid.operands(row);
                terms[own].clone()
            });
            Ok(terms.collect())
        })
    }

    pub(super) fn callbacks(&self) -> impl Iterator<Item = &Callback> {
        self.parts.iter().filter_map(|part| match &part.acts {
            Acts::Callback(callback) => Some(callback),
            _ => None,
        })
    }

    pub(super) fn with_states(&self) -> impl Iterator<Item = &WithStates> {
        self.parts.iter().filter_map(|part| match &part.acts {
            Acts::WithStates(one) => Some(one),
            _ => None,
        })
    }

    pub(super) fn compiled(&self) -> impl Iterator<Item = &Compiled> {
        self.parts.iter().filter_map(|part| match &part.acts {
            Acts::Compiled(compiled) => Some(compiled),
            _ => None,
        })
    }

    /// Whether it has analytic terms alone.
    pub(crate) fn is_analytic(&self) -> bool {
        (self.parts.iter()).all(|part| matches!(part.acts, Acts::Term(_)))
    }

    /// Whether it calls Python.
    pub(crate) fn calls_python(&self) -> bool {
        self.callbacks().next().is_some() || self.with_states().next().is_some()
    }

    /// The load with `t` as the epoch of those orbits that have none. It serves to continue a motion that
    /// started at `t`.
    pub(super) fn copy_with_epoch(&self, py: Python<'_>, t: f64) -> PyResult<Self> {
        self.map(|part| {
            let mut part = part.copied(py)?;
            if let Acts::Term(terms) = &part.acts
                && terms.rows.iter().any(Term::needs_epoch)
            {
                part.recipe = recipe(py, "_with_epoch", (&part.recipe, t))?;
                part.acts = Acts::Term(terms.map(py, |term| term.clone().with_epoch(t))?);
            }
            if let Acts::WithStates(one) = &mut part.acts
                && one.needs_epoch()
            {
                one.set_epoch(t);
                part.recipe = recipe(py, "_with_epoch", (&part.recipe, t))?;
            }
            Ok(part)
        })
    }
}

/// The load of one recipe.
pub(super) fn made(py: Python<'_>, recipe: &Bound<'_, PyTuple>) -> PyResult<PyLoad> {
    let steps = unfolded(recipe)?;
    let (name, arguments) = &steps[0];
    let function = py.import("polhode.loads")?.getattr(name.as_str())?;
    let made = match arguments.get_item(arguments.len().saturating_sub(1)) {
        Ok(last) if last.is_instance_of::<PyDict>() => {
            let plain = arguments.get_slice(0, arguments.len() - 1);
            function.call(plain, Some(last.cast::<PyDict>()?))?
        }
        _ => function.call(arguments, None)?,
    };
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
            _ => load.copy_with_epoch(py, arguments.get_item(1)?.extract()?)?,
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
