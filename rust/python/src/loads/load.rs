//! The class `Load`: a sum of terms, and what Python's operators do with it.

use std::cell::RefCell;
use std::iter::repeat_n;
use std::sync::Arc;

use nalgebra::Vector3;
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use polhode::error::MotionFault;
use polhode::motion::loads::{Term, Windows};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyNotImplemented, PyTuple};
use pyo3::{PyTraverseError, PyVisit};

use super::address::Compiled;
use super::callbacks::{Callback, MOST_STATES, Slot, WithStates, report_states};
use super::firing::Firing;
use super::pickle_recipe::{describe, recipe, unfold};
use crate::arrays::{copy_of, floats, read_list, read_scalar, try_rows};
use crate::errors::to_py;
use crate::indexing::{picked_by, to_index};
use crate::interrupt::Beat;
use crate::shape::tuple;
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
#[pyclass(name = "Load", module = "polhode.loads", frozen, subclass)]
#[derive(Default)]
pub(crate) struct PyLoad {
    pub(super) parts: Vec<Part>,
}

impl PyLoad {
    pub(super) fn one(acts: LoadPart, recipe: Py<PyTuple>) -> Self {
        Self {
            parts: vec![Part {
                acts,
                recipe,
                name: None,
                controller: None,
            }],
        }
    }

    /// The load with a name for the states of its parts.
    pub(super) fn with_name(mut self, name: &str) -> Self {
        for part in &mut self.parts {
            part.name = Some(name.into());
        }
        self
    }

    /// The sum of the loads of these recipes.
    pub(super) fn of_recipes(py: Python<'_>, recipes: Vec<Bound<'_, PyTuple>>) -> PyResult<Self> {
        let mut sum = Self::default();
        for recipe in recipes {
            sum.parts.extend(rebuild(py, &recipe)?.parts);
        }
        Ok(sum)
    }

    pub(crate) fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            parts: self.parts.iter().map(|part| part.clone_ref(py)).collect(),
        }
    }

    pub(super) fn plus(&self, py: Python<'_>, other: &Self) -> PyResult<Self> {
        let mut sum = self.clone_ref(py);
        sum.parts.append(&mut other.clone_ref(py).parts);
        sum.stack_shape()?;
        Ok(sum)
    }

    pub(super) fn map(&self, f: impl Fn(&Part) -> PyResult<Part>) -> PyResult<Self> {
        let parts = self.parts.iter().map(f).collect::<PyResult<_>>()?;
        Ok(Self { parts })
    }

    /// The shape to which the terms broadcast.
    pub(super) fn stack_shape(&self) -> PyResult<Vec<usize>> {
        if self.parts.iter().all(|part| part.shape().is_empty()) {
            return Ok(Vec::new());
        }
        self.parts.iter().try_fold(Vec::new(), |shape, part| {
            Ok(Broadcast::of(["load", "load"], [&shape, part.shape()])?.shape)
        })
    }

    /// The objects of Python that it holds.
    pub(crate) fn visit_parts(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.parts.iter().try_for_each(|part| part.traverse(visit))
    }

    /// The analytic terms of each row.
    pub(crate) fn terms(&self, py: Python<'_>) -> PyResult<Stack<Vec<Term>>> {
        let shape = self.stack_shape()?;
        let analytic = self.parts.iter().filter_map(|part| match &part.acts {
            LoadPart::Term(terms) => Some(terms),
            _ => None,
        });
        if shape.is_empty() {
            return Ok(Stack::one(analytic.map(|terms| terms[0].clone()).collect()));
        }
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
            LoadPart::Callback(callback) => Some(callback),
            _ => None,
        })
    }

    pub(super) fn with_states(&self) -> impl Iterator<Item = &WithStates> {
        self.parts.iter().filter_map(|part| match &part.acts {
            LoadPart::WithStates(one) => Some(one),
            _ => None,
        })
    }

    pub(super) fn thrusters(&self) -> impl Iterator<Item = &Firing> {
        self.parts.iter().filter_map(|part| match &part.acts {
            LoadPart::Thrusters(firing) => Some(firing),
            _ => None,
        })
    }

    pub(super) fn compiled_functions(&self) -> impl Iterator<Item = &Compiled> {
        self.parts.iter().filter_map(|part| match &part.acts {
            LoadPart::Compiled(compiled) => Some(compiled),
            _ => None,
        })
    }

    /// The loads that motors of its wheels follow, if they have functions: each once, and the number of it for each of the terms.
    ///
    /// Wheels that were given the same load follow the same controller, which is asked once for all of them.
    pub(super) fn controllers(&self) -> (Vec<&Self>, Vec<Option<usize>>) {
        let mut found: Vec<&Py<Self>> = Vec::new();
        let terms = (self.parts.iter()).filter(|part| matches!(part.acts, LoadPart::Term(_)));
        let numbers = terms.map(|part| {
            let controller = part.controller.as_ref()?;
            let known = found.iter().position(|one| one.is(controller));
            Some(known.unwrap_or_else(|| {
                found.push(controller);
                found.len() - 1
            }))
        });
        let numbers = numbers.collect();
        (found.into_iter().map(Py::get).collect(), numbers)
    }

    /// Whether it has analytic terms alone.
    pub(crate) fn is_analytic(&self) -> bool {
        (self.parts.iter())
            .all(|part| matches!(part.acts, LoadPart::Term(_)) && part.controller.is_none())
    }

    /// Whether it is one compiled function and nothing else.
    pub(super) fn is_compiled_function(&self) -> bool {
        let [part] = &self.parts[..] else {
            return false;
        };
        matches!(part.acts, LoadPart::Compiled(_)) && part.controller.is_none()
    }

    /// Whether it calls Python.
    pub(crate) fn calls_python(&self) -> bool {
        self.callbacks().next().is_some()
            || self.with_states().next().is_some()
            || self.thrusters().any(Firing::calls_python)
            || self.controllers().0.into_iter().any(Self::calls_python)
    }

    /// Whether a part counts from where its motion starts.
    pub(crate) fn needs_epoch(&self) -> bool {
        self.parts.iter().any(Part::needs_epoch)
    }

    /// The load with `t` as the epoch of those orbits that have none. It serves to continue a motion that
    /// started at `t`.
    pub(crate) fn copy_with_epoch(&self, py: Python<'_>, t: f64) -> PyResult<Self> {
        // The same controller for the wheels that had the same one.
        let begun: RefCell<Vec<(Py<Self>, Py<Self>)>> = RefCell::default();
        let begin = |controller: &Py<Self>| -> PyResult<Py<Self>> {
            let known = begun.borrow();
            if let Some((_, new)) = known.iter().find(|(old, _)| old.is(controller)) {
                return Ok(new.clone_ref(py));
            }
            drop(known);
            let new = Py::new(py, controller.get().copy_with_epoch(py, t)?)?;
            begun
                .borrow_mut()
                .push((controller.clone_ref(py), new.clone_ref(py)));
            Ok(new)
        };
        self.map(|part| {
            let mut part = part.clone_ref(py);
            let starts = |one: &mut Py<Self>| clock_needs_epoch(one.get());
            if let Some(controller) = part.controller.take_if(starts) {
                part.recipe = recipe(py, "_with_epoch", (&part.recipe, t))?;
                part.controller = Some(begin(&controller)?);
            }
            if let LoadPart::Term(terms) = &part.acts
                && terms.rows.iter().any(Term::needs_epoch)
            {
                part.recipe = recipe(py, "_with_epoch", (&part.recipe, t))?;
                let begun = terms.map(py, |term| term.clone().with_epoch(t))?;
                part.acts = LoadPart::Term(begun.into());
            }
            let begins = match &mut part.acts {
                LoadPart::WithStates(one) if one.needs_epoch() => {
                    one.start_at(t);
                    true
                }
                LoadPart::Thrusters(firing) if firing.needs_epoch() => {
                    firing.start_at(t);
                    true
                }
                _ => false,
            };
            if begins {
                part.recipe = recipe(py, "_with_epoch", (&part.recipe, t))?;
            }
            Ok(part)
        })
    }
}

/// Whether a controller has a clock that counts from where its motion starts.
fn clock_needs_epoch(controller: &PyLoad) -> bool {
    controller.with_states().any(WithStates::needs_epoch)
}

/// The load of one recipe.
pub(super) fn rebuild(py: Python<'_>, recipe: &Bound<'_, PyTuple>) -> PyResult<PyLoad> {
    let steps = unfold(recipe)?;
    let (name, arguments) = &steps[0];
    let function = py.import("polhode.loads")?.getattr(name.as_str())?;
    let made = match arguments.get_item(arguments.len().saturating_sub(1)) {
        Ok(last) if last.is_instance_of::<PyDict>() => {
            let plain = arguments.get_slice(0, arguments.len() - 1);
            function.call(plain, Some(last.cast::<PyDict>()?))?
        }
        _ => function.call(arguments, None)?,
    };
    let mut load = made.cast::<PyLoad>()?.get().clone_ref(py);
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
                load.map(|part| part.pick(py, &shape, &key))?
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
    let kept = copy_of(windows)?;
    load.map(|part| part.schedule(py, &opened, &kept))
}

// One term of a load: scaled, scheduled, picked from a stack.

/// A term, and how it was made.
pub(super) struct Part {
    pub(super) acts: LoadPart,
    /// The name of a function and its arguments, which make it anew; for pickle.
    pub(super) recipe: Py<PyTuple>,
    /// The name of its states.
    pub(super) name: Option<Arc<str>>,
    /// Of a wheel whose motor follows functions: the load that has them. Its analytic terms stand in the wheel.
    pub(super) controller: Option<Py<PyLoad>>,
}

pub(super) enum LoadPart {
    /// Shared by the sums that it is a part of.
    Term(Arc<Stack<Term>>),
    Callback(Callback),
    Compiled(Compiled),
    WithStates(WithStates),
    Thrusters(Firing),
}

impl Part {
    /// The objects of Python that it holds.
    pub(super) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.recipe)?;
        visit.call(&self.controller)?;
        match &self.acts {
            LoadPart::Term(_) => Ok(()),
            LoadPart::Callback(callback) => visit.call(callback.function()),
            LoadPart::Compiled(compiled) => visit.call(compiled.owner()),
            LoadPart::WithStates(one) => one.traverse(visit),
            LoadPart::Thrusters(firing) => firing.traverse(visit),
        }
    }

    pub(super) fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            acts: match &self.acts {
                LoadPart::Term(terms) => LoadPart::Term(Arc::clone(terms)),
                LoadPart::Callback(callback) => LoadPart::Callback(callback.clone_ref(py)),
                LoadPart::Compiled(compiled) => LoadPart::Compiled(compiled.clone_ref(py)),
                LoadPart::WithStates(one) => LoadPart::WithStates(one.clone_ref(py)),
                LoadPart::Thrusters(firing) => LoadPart::Thrusters(firing.clone_ref(py)),
            },
            recipe: self.recipe.clone_ref(py),
            name: self.name.clone(),
            controller: self.controller.as_ref().map(|one| one.clone_ref(py)),
        }
    }

    /// Whether it counts from where its motion starts.
    fn needs_epoch(&self) -> bool {
        let mut controllers = self.controller.iter();
        controllers.any(|one| clock_needs_epoch(one.get()))
            || match &self.acts {
                LoadPart::Term(terms) => terms.rows.iter().any(Term::needs_epoch),
                LoadPart::WithStates(one) => one.needs_epoch(),
                LoadPart::Thrusters(firing) => firing.needs_epoch(),
                LoadPart::Callback(_) | LoadPart::Compiled(_) => false,
            }
    }

    /// The number of its states.
    fn count_states(&self) -> usize {
        match &self.acts {
            LoadPart::Term(terms) => terms.rows.first().map_or(0, Term::internal_states),
            LoadPart::WithStates(one) => one.initial.len(),
            LoadPart::Compiled(one) => one.initial.len(),
            LoadPart::Thrusters(firing) => firing.initial.len(),
            LoadPart::Callback(_) => 0,
        }
    }

    pub(super) fn shape(&self) -> &[usize] {
        match &self.acts {
            LoadPart::Term(terms) => &terms.shape,
            _ => &[],
        }
    }

    pub(super) fn scaled(&self, py: Python<'_>, factor: f64) -> PyResult<Self> {
        self.check_changes(py, "scaled")?;
        let mut scaled = self.clone_ref(py);
        match &mut scaled.acts {
            LoadPart::Term(terms) => {
                *terms = try_rows(py, terms, |term| term.scaled(factor))?.into();
            }
            LoadPart::Callback(callback) => callback.factor *= factor,
            LoadPart::Compiled(compiled) => compiled.factor *= factor,
            LoadPart::WithStates(_) | LoadPart::Thrusters(_) => (),
        }
        scaled.recipe = recipe(py, "_scaled", (&self.recipe, factor))?;
        Ok(scaled)
    }

    /// That wheels, slugs and functions with states of their own are not scaled or scheduled. A wheel without moment is a
    /// rotor, but with a name.
    fn check_changes(&self, py: Python<'_>, what: &'static str) -> PyResult<()> {
        let has_states = match &self.acts {
            LoadPart::WithStates(_) | LoadPart::Thrusters(_) => true,
            LoadPart::Compiled(compiled) => !compiled.initial.is_empty(),
            LoadPart::Term(_) => self.name.is_some(),
            LoadPart::Callback(_) => false,
        };
        if has_states {
            return Err(to_py(py, &MotionFault::StatesStay { what }.into()));
        }
        Ok(())
    }

    /// The rows that NumPy's indexing picks, of the part broadcast to `shape`.
    pub(super) fn pick(
        &self,
        py: Python<'_>,
        shape: &[usize],
        key: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let picked = picked_by(py, shape, key)?;
        let rows = picked.as_slice()?;
        let mut part = self.clone_ref(py);
        if let LoadPart::Term(terms) = &part.acts {
            let grid = Broadcast::of(["load", "load"], [shape, &terms.shape])?;
            let taken = Broadcast::of(["key"], [picked.shape()])?;
            let picked = taken.try_map(py, |[k]| {
                Ok(terms[grid.operands(to_index(rows[k]))[1]].clone())
            })?;
            part.acts = LoadPart::Term(picked.into());
        }
        part.recipe = recipe(py, "_picked", (&self.recipe, shape.to_vec(), key))?;
        Ok(part)
    }

    pub(super) fn schedule(
        &self,
        py: Python<'_>,
        windows: &Windows,
        given: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        self.check_changes(py, "scheduled")?;
        let mut part = self.clone_ref(py);
        let within = |own: &Option<Windows>| {
            Some(
                own.as_ref()
                    .map_or_else(|| windows.clone(), |own| own.within(windows)),
            )
        };
        match &mut part.acts {
            LoadPart::Term(terms) => {
                *terms = try_rows(py, terms, |term| term.clone().schedule(windows))?.into();
            }
            LoadPart::Callback(callback) => callback.windows = within(&callback.windows),
            LoadPart::Compiled(compiled) => compiled.windows = within(&compiled.windows),
            LoadPart::WithStates(_) | LoadPart::Thrusters(_) => (),
        }
        part.recipe = recipe(py, "_scheduled", (&self.recipe, given))?;
        Ok(part)
    }
}

// What Python's operators and pickle do with a load.

/// What scales a load: a real number of Python or NumPy, also one in an array without axes; `None` of anything else.
fn real_number(factor: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    if factor.is_instance_of::<PyFloat>() || factor.is_instance_of::<PyInt>() {
        return read_scalar(factor).map(Some);
    }
    let py = factor.py();
    if let Ok(array) = factor.cast::<PyUntypedArray>() {
        if array.ndim() == 0 && factor.is_exact_instance_of::<PyUntypedArray>() {
            return real_number(&array.call_method0("item")?);
        }
        // NumPy's own answer would be about anything but loads.
        return Err(PyTypeError::new_err(
            "a load is scaled by one number, not by an array: for a stack of loads give the function that makes it a stack \
             of arguments",
        ));
    }
    let real = py.import("numbers")?.getattr("Real")?;
    if factor.is_instance(&real)? {
        return read_scalar(factor).map(Some);
    }
    Ok(None)
}

#[pymethods]
impl PyLoad {
    /// What the garbage collector may find a cycle through: a function that knows the load it is part of.
    ///
    /// Nothing is cleared here: a load never changes, so that every cycle passes through something else that does.
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.visit_parts(&visit)
    }

    fn __getitem__(&self, py: Python<'_>, key: &Bound<'_, PyAny>) -> PyResult<Self> {
        let shape = self.stack_shape()?;
        self.map(|part| part.pick(py, &shape, key))
    }

    /// Shape of the stack of loads; empty for one.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.stack_shape()?)
    }

    /// Return the same load for a motion that is continued and that had started at `t`. Orbits without an epoch
    /// get `t` as their epoch.
    fn with_epoch(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = read_scalar)] t: f64,
    ) -> PyResult<Self> {
        self.copy_with_epoch(py, t)
    }

    fn __add__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        Ok(self.plus(py, other.get())?.into_pyobject(py)?.into_any())
    }

    /// `sum(loads)` starts from the number 0.
    fn __radd__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if other.is_exact_instance_of::<PyInt>()
            && other.extract::<i64>().is_ok_and(|zero| zero == 0)
        {
            return Ok(self.clone_ref(py).into_pyobject(py)?.into_any());
        }
        Ok(PyNotImplemented::get(py).to_owned().into_any())
    }

    fn __sub__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let negative = other.get().__neg__(py)?;
        Ok(self.plus(py, &negative)?.into_pyobject(py)?.into_any())
    }

    fn __neg__(&self, py: Python<'_>) -> PyResult<Self> {
        self.map(|part| part.scaled(py, -1.0))
    }

    fn __mul__<'py>(
        &self,
        py: Python<'py>,
        factor: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Some(factor) = real_number(factor)? else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let scaled = self.map(|part| part.scaled(py, factor))?;
        Ok(scaled.into_pyobject(py)?.into_any())
    }

    fn __rmul__<'py>(
        &self,
        py: Python<'py>,
        factor: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.__mul__(py, factor)
    }

    /// A load is no array: NumPy leaves ``2.0 * load`` to the load, also where the number is one of NumPy's.
    #[classattr]
    fn __array_ufunc__() -> Option<bool> {
        None
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        self.clone_ref(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone_ref(py)
    }

    /// The terms as the functions that make them, with their arguments; for pickle.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        if self.compiled_functions().next().is_some() {
            return Err(PyTypeError::new_err(
                "a load with a compiled function cannot be pickled: its address holds in this process alone",
            ));
        }
        let restore = py.get_type::<Self>().getattr("_from_parts")?;
        let parts: Vec<_> = self.parts.iter().map(|part| part.recipe.bind(py)).collect();
        Ok((restore, PyTuple::new(py, [parts])?))
    }

    /// The load that `__reduce__` took apart.
    #[staticmethod]
    fn _from_parts(py: Python<'_>, parts: Vec<Bound<'_, PyTuple>>) -> PyResult<Self> {
        Self::of_recipes(py, parts)
    }

    /// The functions that made its terms; a stack also by its shape.
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shape = self.stack_shape()?;
        let terms = (self.parts.iter())
            .map(|part| describe(part.recipe.bind(py)))
            .collect::<PyResult<Vec<_>>>()?
            .join(" + ");
        Ok(if shape.is_empty() {
            format!("<Load: {terms}>")
        } else {
            format!("<Load stack of shape {}: {terms}>", tuple(&shape))
        })
    }
}

// The states that a load has of its own, by name.

/// Relative to it or to what counts as large, states that differ less are the same: those at the end of a run, of a wheel whose
/// speed is known.
const SAME: f64 = 1e-9;

impl PyLoad {
    /// The states of its parts, in the order in which a run has them: first those of its analytic terms, then those of parts that call
    /// Python, then those of compiled functions, then those of thrusters, and those of controllers last. Of parts with the same name the second is called `name_2`.
    pub(crate) fn slots(&self) -> Vec<Slot> {
        let mut slots: Vec<Slot> = Vec::new();
        let mut first = 0;
        for kind in 0..4 {
            for part in &self.parts {
                let (of_kind, count) = match &part.acts {
                    LoadPart::Term(terms) => {
                        (0, terms.rows.first().map_or(0, Term::internal_states))
                    }
                    LoadPart::Callback(_) => (1, 0),
                    LoadPart::WithStates(one) => (1, one.initial.len()),
                    LoadPart::Compiled(one) => (2, one.initial.len()),
                    LoadPart::Thrusters(firing) => (3, firing.count()),
                };
                if of_kind != kind || count == 0 {
                    continue;
                }
                let name = part.name.clone().unwrap_or_else(|| "states".into());
                let name = unused_name(name, &slots);
                let pulses = (kind == 3).then(|| format!("{name}_pulse").into());
                for name in [Some(name), pulses].into_iter().flatten() {
                    let name = unused_name(name, &slots);
                    slots.push(Slot { name, first, count });
                    first += count;
                }
            }
        }
        for controller in self.controllers().0 {
            for slot in controller.slots() {
                let (name, count) = (unused_name(slot.name, &slots), slot.count);
                slots.push(Slot { name, first, count });
                first += count;
            }
        }
        slots
    }

    /// The states with which a motion starts at time `t` with `omega`, from those reported that are given; what is not a number is
    /// not given.
    pub(crate) fn initial_states(
        &self,
        terms: &[Term],
        t: f64,
        omega: &Vector3<f64>,
        given: &[f64],
    ) -> Box<[f64]> {
        let mut states = Vec::new();
        for carried in terms.iter().filter_map(Term::carried) {
            let mine = given.get(states.len()..states.len() + carried.count());
            if let Some(mine) = mine.filter(|mine| !mine.iter().any(|x| x.is_nan())) {
                let first = states.len();
                states.extend_from_slice(mine);
                carried.resume_states(&mut states[first..], t, omega);
            } else {
                states.extend(carried.begin(t, omega));
            }
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
        let kept = self.initial_states(terms, t, omega, given);
        let phase = Phase {
            omega: *omega,
            internal_state: kept,
            ..Phase::nan()
        };
        check_start(terms, t, &phase, &report_states(terms, &phase), given)
    }

    /// The number of states of its own.
    fn count_states(&self) -> usize {
        let parts = self.parts.iter().map(Part::count_states);
        let controllers = self.controllers().0.into_iter();
        parts.sum::<usize>() + controllers.map(Self::count_states).sum::<usize>()
    }

    /// That a run from one time to another can be made.
    pub(crate) fn check_run(&self, py: Python<'_>, from: f64, to: f64) -> PyResult<()> {
        let count = self.count_states();
        if count > MOST_STATES && !self.is_analytic() {
            return Err(PyValueError::new_err(format!(
                "load: {count} states of its own, more than the {MOST_STATES} of a load that calls functions"
            )));
        }
        self.with_states().try_for_each(|one| one.check(from, to))?;
        (self.thrusters()).try_for_each(|firing| firing.check(py, from, to))?;
        let mut controllers = self.controllers().0.into_iter();
        controllers.try_for_each(|one| one.check_run(py, from, to))
    }

    /// The initial states of functions, those of controllers last.
    fn initial_of_functions(&self) -> Vec<&[f64]> {
        let called = self.with_states().map(|one| &one.initial[..]);
        let compiled = self.compiled_functions().map(|one| &one.initial[..]);
        let fired = self.thrusters().map(|firing| &firing.initial[..]);
        let asked = self.controllers().0.into_iter();
        (called.chain(compiled).chain(fired))
            .chain(asked.flat_map(Self::initial_of_functions))
            .collect()
    }

    /// What counts as large of each of these states.
    pub(super) fn scales_of_functions(&self) -> Vec<f64> {
        let called = self.with_states().flat_map(|one| one.scale.iter().copied());
        let compiled = (self.compiled_functions()).flat_map(|one| one.scale.iter().copied());
        let fired = (self.thrusters()).flat_map(|firing| firing.scale.iter().copied());
        let asked = self.controllers().0.into_iter();
        (called.chain(compiled).chain(fired))
            .chain(asked.flat_map(Self::scales_of_functions))
            .collect()
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
            if !slots.iter().any(|slot| *slot.name == *name) {
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
            let values = match given.get_item(&*slot.name)? {
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

/// As [`PyLoad::check_given`], at a time and a state from which the load begins with the states `given`, and reports those that are `kept`.
pub(crate) fn check_start(
    terms: &[Term],
    t: f64,
    phase: &Phase,
    kept: &[f64],
    given: &[f64],
) -> PyResult<()> {
    let sizes = (terms.iter().filter_map(Term::carried))
        .flat_map(|carried| repeat_n(carried.size() * phase.omega.norm(), carried.count()));
    for ((value, kept), size) in given.iter().zip(kept).zip(sizes) {
        let large = value.abs().max(kept.abs()).max(size);
        if (value - kept).abs() > SAME * large {
            return Err(PyValueError::new_err(format!(
                "states: a wheel whose speed is known has the momentum {kept:?} at t = {t:?}, got {value:?}; leave it out, or give \
                 the wheel another speed"
            )));
        }
    }
    let mut first = 0;
    for carried in terms.iter().filter_map(Term::carried) {
        if let (Some((axis, inertia, most)), Some(momentum)) =
            (carried.rate_limit(), phase.internal_state.get(first))
        {
            let rate = momentum / inertia - axis.dot(&phase.omega);
            if rate.abs() > most * (1.0 + SAME) {
                return Err(PyValueError::new_err(format!(
                    "states: a wheel has the rate {rate:?} at t = {t:?}, beyond its limit {most:?} (max_rate, or max_momentum divided \
                     by its inertia); give it a larger limit, or another state"
                )));
            }
        }
        first += carried.count();
    }
    Ok(())
}

/// A name that no slot has yet: the one that is asked for, or with the first number that makes it one.
fn unused_name(name: Arc<str>, slots: &[Slot]) -> Arc<str> {
    let is_taken = |name: &Arc<str>| slots.iter().any(|slot| slot.name == *name);
    let mut found = Arc::clone(&name);
    let mut number = 2;
    while is_taken(&found) {
        found = format!("{name}_{number}").into();
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
