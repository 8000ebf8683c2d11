//! One term of a load: scaled, scheduled, picked from a stack.

use std::sync::Arc;

use numpy::PyUntypedArrayMethods;
use polhode::error::MotionFault;
use polhode::motion::loads::{Term, Windows};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use pyo3::{PyTraverseError, PyVisit};

use super::address::Compiled;
use super::called::Callback;
use super::recipe::recipe;
use super::stateful::WithStates;
use crate::arrays::try_rows;
use crate::errors::to_py;
use crate::indexing::{picked_by, to_index};
use crate::stack::{Broadcast, Stack};

/// A term, and how it was made.
pub(super) struct Part {
    pub(super) acts: Acts,
    /// The name of a function and its arguments, which make it anew; for pickle.
    pub(super) recipe: Py<PyTuple>,
    /// The name of its states.
    pub(super) name: Option<Arc<str>>,
}

pub(super) enum Acts {
    Term(Stack<Term>),
    Callback(Callback),
    Compiled(Compiled),
    WithStates(WithStates),
}

impl Part {
    /// The objects of Python that it holds.
    pub(super) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.recipe)?;
        match &self.acts {
            Acts::Term(_) => Ok(()),
            Acts::Callback(callback) => visit.call(callback.function()),
            Acts::Compiled(compiled) => visit.call(compiled.owner()),
            Acts::WithStates(one) => one.traverse(visit),
        }
    }

    pub(super) fn copied(&self, py: Python<'_>) -> PyResult<Self> {
        Ok(Self {
            acts: match &self.acts {
                Acts::Term(terms) => Acts::Term(terms.map(py, Term::clone)?),
                Acts::Callback(callback) => Acts::Callback(callback.copied(py)),
                Acts::Compiled(compiled) => Acts::Compiled(compiled.copied(py)),
                Acts::WithStates(one) => Acts::WithStates(one.copied(py)),
            },
            recipe: self.recipe.clone_ref(py),
            name: self.name.clone(),
        })
    }

    pub(super) fn shape(&self) -> &[usize] {
        match &self.acts {
            Acts::Term(terms) => &terms.shape,
            _ => &[],
        }
    }

    pub(super) fn scaled(&self, py: Python<'_>, factor: f64) -> PyResult<Self> {
        self.check_changes(py, "scaled")?;
        let mut scaled = self.copied(py)?;
        match &mut scaled.acts {
            Acts::Term(terms) => *terms = try_rows(py, terms, |term| term.scaled(factor))?,
            Acts::Callback(callback) => callback.factor *= factor,
            Acts::Compiled(compiled) => compiled.factor *= factor,
            Acts::WithStates(_) => (),
        }
        scaled.recipe = recipe(py, "_scaled", (&self.recipe, factor))?;
        Ok(scaled)
    }

    /// That functions with states of their own are not scaled or scheduled.
    fn check_changes(&self, py: Python<'_>, what: &'static str) -> PyResult<()> {
        let has_states = match &self.acts {
            Acts::WithStates(_) => true,
            Acts::Compiled(compiled) => !compiled.initial.is_empty(),
            Acts::Term(_) | Acts::Callback(_) => false,
        };
        if has_states {
            return Err(to_py(py, &MotionFault::StatesStay { what }.into()));
        }
        Ok(())
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
        self.check_changes(py, "scheduled")?;
        let mut part = self.copied(py)?;
        let within = |own: &Option<Windows>| {
            Some(
                own.as_ref()
                    .map_or_else(|| windows.clone(), |own| own.within(windows)),
            )
        };
        match &mut part.acts {
            Acts::Term(terms) => {
                *terms = try_rows(py, terms, |term| term.clone().scheduled(windows))?;
            }
            Acts::Callback(callback) => callback.windows = within(&callback.windows),
            Acts::Compiled(compiled) => compiled.windows = within(&compiled.windows),
            Acts::WithStates(_) => (),
        }
        part.recipe = recipe(py, "_scheduled", (&self.recipe, given))?;
        Ok(part)
    }
}
