//! A load at work on a body.

use polhode::Error;
use polhode::error::Kind;
use polhode::motion::loads::{Analytic, Load, Subject, Switch, Term, Windows, Wrench};
use polhode::motion::state::Phase;
use pyo3::prelude::*;

use super::address::Compiled;
use super::called::Callback;
use super::load::PyLoad;
use crate::errors::to_py;

/// What may go wrong while a load is integrated.
pub(crate) enum Fault {
    /// In the core.
    Core(Error),
    /// In a function of the user's, whose exception this is.
    Python(PyErr),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Core(error)
    }
}

impl Fault {
    /// As an exception.
    pub(crate) fn to_exception(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Core(error) => to_py(py, error),
            Self::Python(error) => error.clone_ref(py),
        }
    }

    /// Whether a function of the user's raised it.
    pub(crate) fn is_of_the_user(&self) -> bool {
        matches!(self, Self::Python(_))
    }

    /// Whether it is the integration itself that failed.
    pub(crate) fn is_of_integration(&self) -> bool {
        matches!(self, Self::Core(error) if error.kind() == Kind::Integration)
    }
}

/// A load at work on a body.
pub(crate) struct Acting<'a, 'py> {
    analytic: Analytic<'a>,
    load: &'a PyLoad,
    /// Needed where the load calls Python.
    py: Option<Python<'py>>,
    /// Those that are switched on.
    callbacks: Vec<&'a Callback>,
    compiled: Vec<&'a Compiled>,
}

impl<'a, 'py> Acting<'a, 'py> {
    /// `load`, whose analytic terms are `terms`, on `subject`.
    pub(crate) fn new(
        load: &'a PyLoad,
        terms: &'a [Term],
        subject: Subject,
        py: Option<Python<'py>>,
    ) -> Self {
        Self {
            analytic: Analytic::new(terms, subject),
            load,
            py,
            callbacks: load.callbacks().collect(),
            compiled: load.compiled().collect(),
        }
    }
}

impl Load for Acting<'_, '_> {
    type Error = Fault;

    fn analytic(&self) -> Option<&[Term]> {
        (self.load.is_analytic()).then(|| self.analytic.analytic())?
    }

    fn exerts_force(&self) -> bool {
        self.analytic.exerts_force()
            || self.load.callbacks().any(Callback::exerts_force)
            || self.load.compiled().next().is_some()
    }

    fn depends_on_rates(&self) -> bool {
        self.analytic.depends_on_rates()
            || self.load.callbacks().next().is_some()
            || self.load.compiled().next().is_some()
    }

    fn breaks(&self) -> Vec<f64> {
        let windows = (self.load.callbacks().map(|callback| &callback.windows))
            .chain(self.load.compiled().map(|compiled| &compiled.windows));
        let mut breaks: Vec<f64> = windows.flatten().flat_map(Windows::switches).collect();
        breaks.extend(self.analytic.breaks());
        breaks
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), Fault> {
        let middle = from + 0.5 * (to - from);
        let is_on =
            |windows: &Option<Windows>| windows.as_ref().is_none_or(|open| open.contains(middle));
        self.callbacks.clear();
        (self.callbacks).extend(self.load.callbacks().filter(|one| is_on(&one.windows)));
        self.compiled.clear();
        (self.compiled).extend(self.load.compiled().filter(|one| is_on(&one.windows)));
        Ok(self.analytic.enter(from, to)?)
    }

    fn settle(&mut self, phase: &Phase) {
        self.analytic.settle(phase);
    }

    fn switches(&self) -> Vec<Switch> {
        self.analytic.switches()
    }

    fn flip(&mut self, index: usize) {
        self.analytic.flip(index);
    }

    #[inline]
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Fault> {
        let mut sum = self.analytic.wrench(t, phase)?;
        for compiled in &self.compiled {
            sum += compiled.call(t, phase);
        }
        if let Some(py) = self.py {
            for callback in &self.callbacks {
                sum += callback.call(py, t, phase).map_err(Fault::Python)?;
            }
        }
        Ok(sum)
    }
}
