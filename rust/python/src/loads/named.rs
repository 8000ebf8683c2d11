//! States by name, as functions of Python get them.

use numpy::PyArray1;
use polhode::motion::loads::Term;
use polhode::motion::state::Phase;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The states of one part of a load among those of all.
#[derive(Clone, Debug)]
pub(crate) struct Slot {
    pub(crate) name: String,
    pub(crate) first: usize,
    pub(crate) count: usize,
}

impl Slot {
    pub(crate) fn of<'a>(&self, all: &'a [f64]) -> &'a [f64] {
        &all[self.first..self.first + self.count]
    }
}

/// The names and numbers of the states of a phase, for functions of Python.
pub(crate) struct Named<'a> {
    slots: &'a [Slot],
    states: Vec<f64>,
}

impl<'a> Named<'a> {
    pub(crate) fn of(slots: &'a [Slot], terms: &[Term], phase: &Phase) -> Self {
        Self {
            slots,
            states: reported(terms, phase),
        }
    }

    /// A dict for one call: a function may write into it what it likes.
    pub(crate) fn dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for slot in self.slots {
            dict.set_item(&slot.name, PyArray1::from_slice(py, slot.of(&self.states)))?;
        }
        Ok(dict)
    }
}

/// The states of a phase as they are reported.
pub(crate) fn reported(terms: &[Term], phase: &Phase) -> Vec<f64> {
    let mut states = phase.internal_state.to_vec();
    let mut first = 0;
    for carried in terms.iter().filter_map(Term::carried) {
        let mine = first..first + carried.count();
        if let Some(own) = states.get_mut(mine.clone()) {
            let told = carried.reported(own, &phase.omega);
            own.copy_from_slice(&told);
        }
        first = mine.end;
    }
    states
}
