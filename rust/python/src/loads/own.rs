//! The states that a load has of its own, by name.

use nalgebra::Vector3;
use numpy::PyUntypedArrayMethods;
use polhode::motion::loads::Term;
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::load::PyLoad;
use super::named::{Slot, reported};
use super::part::Acts;
use super::stateful::MOST_STATES;
use crate::arrays::floats;
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

/// Relative to it or to what counts as large, states that differ less are the same: those at the end of a run, of a wheel whose
/// speed is known.
const SAME: f64 = 1e-9;

impl PyLoad {
    /// The states of its parts, in the order in which a run has them: first those of its analytic terms, then those of parts that call
    /// Python, then those of compiled functions. Of parts with the same name the second is called `name_2`.
    pub(crate) fn slots(&self) -> Vec<Slot> {
        let mut slots: Vec<Slot> = Vec::new();
        let mut first = 0;
        for kind in 0..3 {
            for part in &self.parts {
                let (of_kind, count) = match &part.acts {
                    Acts::Term(terms) => (0, terms.rows.first().map_or(0, Term::internal_states)),
                    Acts::Callback(_) => (1, 0),
                    Acts::WithStates(one) => (1, one.initial.len()),
                    Acts::Compiled(one) => (2, one.initial.len()),
                };
                if of_kind != kind || count == 0 {
                    continue;
                }
                slots.push(Slot {
                    name: unused(part.name.as_deref().unwrap_or("states"), &slots),
                    first,
                    count,
                });
                first += count;
            }
        }
        slots
    }

    /// The states with which a motion starts at time `t` with `omega`, from those reported that are given; what is not a number is
    /// not given.
    pub(crate) fn begun(
        &self,
        terms: &[Term],
        t: f64,
        omega: &Vector3<f64>,
        given: &[f64],
    ) -> Box<[f64]> {
        let mut states = Vec::new();
        for carried in terms.iter().filter_map(Term::carried) {
            let mine = given.get(states.len()..states.len() + carried.count());
            states.extend(match mine.filter(|mine| !mine.iter().any(|x| x.is_nan())) {
                Some(mine) => carried.resumed(mine, t, omega),
                None => carried.begin(t, omega),
            });
        }
        for initial in self.initial_of_functions() {
            for &value in initial {
                let given = given.get(states.len()).filter(|x| !x.is_nan());
                states.push(given.copied().unwrap_or(value));
            }
        }
        states.into()
    }

    /// That states are given only where they can be: that of a wheel whose speed is known follows from it.
    pub(crate) fn check_given(
        &self,
        terms: &[Term],
        t: f64,
        omega: &Vector3<f64>,
        given: &[f64],
    ) -> PyResult<()> {
        let kept = self.begun(terms, t, omega, given);
        let phase = Phase {
            omega: *omega,
            internal_state: kept,
            ..Phase::nan()
        };
        let kept = reported(terms, &phase);
        let sizes = (terms.iter().filter_map(Term::carried))
            .flat_map(|carried| vec![carried.size() * omega.norm(); carried.count()]);
        for ((value, kept), size) in given.iter().zip(kept).zip(sizes) {
            let large = value.abs().max(kept.abs()).max(size);
            if (value - kept).abs() > SAME * large {
                return Err(PyValueError::new_err(format!(
                    "states: a wheel whose speed is known has the momentum {kept:?} at t = {t:?}, got {value:?}; leave it out, or give \
                     the wheel another speed"
                )));
            }
        }
        Ok(())
    }

    /// That a run from one time to another can be made.
    pub(crate) fn check_run(&self, from: f64, to: f64) -> PyResult<()> {
        let count: usize = self.slots().iter().map(|slot| slot.count).sum();
        if count > MOST_STATES && !self.is_analytic() {
            return Err(PyValueError::new_err(format!(
                "load: {count} states of its own, more than the {MOST_STATES} of a load that calls functions"
            )));
        }
        self.with_states().try_for_each(|one| one.check(from, to))
    }

    fn initial_of_functions(&self) -> impl Iterator<Item = &[f64]> {
        let called = self.with_states().map(|one| &one.initial[..]);
        called.chain(self.compiled().map(|one| &one.initial[..]))
    }

    /// The states given under their names, each of shape (..., k); what is not given is not a number.
    pub(crate) fn read_states(
        &self,
        given: Option<&Bound<'_, PyAny>>,
        all: bool,
    ) -> PyResult<Stack<Vec<f64>>> {
        let slots = self.slots();
        let names = || {
            let names: Vec<_> = slots
                .iter()
                .map(|slot| format!("{:?}", slot.name))
                .collect();
            names.join(", ")
        };
        let Some(given) = given.filter(|given| !given.is_none()) else {
            if all && !slots.is_empty() {
                return Err(PyTypeError::new_err(format!(
                    "states: the load has states of its own: pass states= with {}, as `states` of a trajectory has them",
                    names()
                )));
            }
            return Ok(Stack::one(Vec::new()));
        };
        let given = given.cast::<PyDict>().map_err(|_| {
            PyTypeError::new_err(format!(
                "states: expected a dict of names and arrays, got {}",
                given.get_type()
            ))
        })?;
        for key in given.keys() {
            let name: String = key.extract().map_err(|_| {
                PyTypeError::new_err(format!("states: names are strings, got {key}"))
            })?;
            if !slots.iter().any(|slot| slot.name == name) {
                let known = if slots.is_empty() {
                    "the load has none".to_owned()
                } else {
                    format!("the load has {}", names())
                };
                return Err(PyValueError::new_err(format!(
                    "states: no {name:?}; {known}"
                )));
            }
        }
        let mut found = Stack::one(Vec::new());
        for slot in &slots {
            let values = match given.get_item(&slot.name)? {
                Some(values) => one(&values, slot, all)?,
                None if all => {
                    return Err(PyTypeError::new_err(format!(
                        "states: {:?} is missing",
                        slot.name
                    )));
                }
                None => Stack::one(vec![f64::NAN; slot.count]),
            };
            let grid = Broadcast::of(["states", "states"], [&found.shape, &values.shape])?;
            found = grid.try_map(
                given.py(),
                |[a, b]| Ok([&found[a][..], &values[b]].concat()),
            )?;
        }
        Ok(found)
    }
}

/// A name that no slot has yet: the one that is asked for, or with the first number that makes it one.
fn unused(name: &str, slots: &[Slot]) -> String {
    let is_taken = |name: &str| slots.iter().any(|slot| slot.name == name);
    let mut found = name.to_owned();
    let mut number = 2;
    while is_taken(&found) {
        found = format!("{name}_{number}");
        number += 1;
    }
    found
}

/// The states of one part, shape (..., k); those after the end of a run are not numbers.
fn one(values: &Bound<'_, PyAny>, slot: &Slot, with_holes: bool) -> PyResult<Stack<Vec<f64>>> {
    let name = format!("states[{:?}]", slot.name);
    let array = floats(values, &name)?;
    let shape = array.shape();
    if shape.last() != Some(&slot.count) {
        return Err(PyValueError::new_err(format!(
            "{name}: expected shape (..., {}), got {}",
            slot.count,
            tuple(shape)
        )));
    }
    let numbers = array.as_slice()?;
    let is_bad = |x: &&f64| !(x.is_finite() || with_holes && x.is_nan());
    if let Some(bad) = numbers.iter().find(is_bad) {
        return Err(PyValueError::new_err(format!(
            "{name}: must be finite, got {bad}"
        )));
    }
    Ok(Stack {
        shape: shape[..shape.len() - 1].to_vec(),
        rows: numbers.chunks(slot.count).map(<[f64]>::to_vec).collect(),
    })
}
