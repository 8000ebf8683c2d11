//! A load at work on a body.

use std::mem::take;
use std::ops::Range;

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::error::Kind;
use polhode::motion::loads::{
    Analytic, Bearing, BodyAtPoint, CarriedMomentum, LawSwitch, Load, Term, Windows, Wrench,
};
use polhode::motion::state::Phase;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::address::{Compiled, Exchange};
use super::callbacks::{Callback, Named, Slot, WithStates};
use super::firing::Firing;
use super::load::PyLoad;
use crate::arrays::{read, write_of};
use crate::errors::to_py;
use crate::stack::{Broadcast, Stack};

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

/// The functions of a load: of one that acts on a body, or of one that motors follow.
struct LoadFunctions<'a> {
    load: &'a PyLoad,
    with_states: Vec<&'a WithStates>,
    /// Those that are switched on.
    compiled: Vec<&'a Compiled>,
    callbacks: Vec<&'a Callback>,
    thrusters: Vec<&'a Firing>,
}

/// What functions are called with.
struct Call<'a, 'py> {
    /// Needed where the load calls Python.
    py: Option<Python<'py>>,
    slots: &'a [Slot],
    terms: &'a [Term],
    t: f64,
    phase: &'a Phase,
    /// What it acts on, a time within the span last entered, and where the run begins.
    body: &'a BodyAtPoint,
    middle: f64,
    start: f64,
}

impl<'a> LoadFunctions<'a> {
    fn new(load: &'a PyLoad) -> Self {
        Self {
            load,
            with_states: load.with_states().collect(),
            compiled: load.compiled_functions().collect(),
            callbacks: load.callbacks().collect(),
            thrusters: load.thrusters().collect(),
        }
    }

    /// Number of states.
    fn states(&self) -> usize {
        let called = self.with_states.iter().map(|one| one.initial.len());
        let compiled = self.load.compiled_functions().map(|one| one.initial.len());
        let fired = self.thrusters.iter().map(|firing| firing.initial.len());
        called.chain(compiled).chain(fired).sum()
    }

    /// The thrusters, and which of the states are theirs, where the first of all is number `first`.
    fn firing(&self, first: usize) -> impl Iterator<Item = (&'a Firing, Range<usize>)> + '_ {
        let own: usize = self.thrusters.iter().map(|one| one.initial.len()).sum();
        let mut first = first + self.states() - own;
        self.thrusters.iter().map(move |firing| {
            let own = first..first + firing.initial.len();
            first = own.end;
            (*firing, own)
        })
    }

    /// Times at which something begins or ends to act.
    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let called = self.load.callbacks().map(|callback| &callback.windows);
        let compiled = (self.load.compiled_functions()).map(|compiled| &compiled.windows);
        let windows = called.chain(compiled).flatten();
        let mut breaks: Vec<f64> = windows.flat_map(Windows::switches).collect();
        breaks.extend(self.with_states.iter().flat_map(|one| one.times(from, to)));
        breaks.extend(self.thrusters.iter().flat_map(|one| one.times(from, to)));
        breaks
    }

    /// From now on what is on at the time `middle` acts.
    fn enter(&mut self, middle: f64) {
        let is_on =
            |windows: &Option<Windows>| windows.as_ref().is_none_or(|open| open.contains(middle));
        self.callbacks.clear();
        (self.callbacks).extend(self.load.callbacks().filter(|one| is_on(&one.windows)));
        self.compiled.clear();
        let compiled = self.load.compiled_functions();
        (self.compiled).extend(compiled.filter(|one| is_on(&one.windows)));
    }

    /// Add the wrenches to a sum, and write the rates of the states from number `first` on into `rates`, where there is room.
    fn add(
        &self,
        call: &Call<'_, '_>,
        mut first: usize,
        rates: &mut [f64],
        sum: &mut Wrench,
    ) -> Result<(), Fault> {
        let Call { t, phase, .. } = *call;
        let asked = !rates.is_empty();
        // Their place among the states is looked for only if there are any.
        let firing = (!self.thrusters.is_empty()).then(|| self.firing(first));
        for (firing, own) in firing.into_iter().flatten() {
            let fires = firing.fires(call.middle, call.start, &phase.internal_state[own.clone()]);
            if asked {
                firing.rates(&fires, &mut rates[own]);
            }
            *sum += firing.wrench(&fires, call.body, phase);
        }
        if let Some(py) = call.py
            && !self.with_states.is_empty()
        {
            let states = Named::of(call.slots, call.terms, phase);
            for one in &self.with_states {
                let own = first..first + one.initial.len();
                first = own.end;
                if asked {
                    one.rates(py, t, phase, &states, &mut rates[own])
                        .map_err(Fault::Python)?;
                }
                *sum += one.call(py, t, phase, &states).map_err(Fault::Python)?;
            }
        }
        for compiled in &self.compiled {
            let own = first..first + compiled.initial.len();
            first = own.end;
            let into = if asked {
                &mut rates[own.clone()]
            } else {
                &mut []
            };
            *sum += compiled.call_once(t, phase, &phase.internal_state[own], into);
        }
        if let Some(py) = call.py {
            for callback in &self.callbacks {
                *sum += callback.call(py, t, phase).map_err(Fault::Python)?;
            }
        }
        Ok(())
    }
}

/// A load at work on a body.
pub(crate) struct ActingLoad<'a, 'py> {
    analytic: Analytic<'a>,
    load: &'a PyLoad,
    /// Needed where the load calls Python.
    py: Option<Python<'py>>,
    functions: LoadFunctions<'a>,
    /// What motors follow, if it is functions.
    controllers: Vec<LoadFunctions<'a>>,
    /// For each of the analytic terms the number of the controller that its motor follows.
    follows: Vec<Option<usize>>,
    /// What the controllers asked for last; kept so that no evaluation makes room for it.
    torques: Vec<Vector3<f64>>,
    /// The states by name, where Python is called with them.
    slots: Vec<Slot>,
    /// The numbers of the first states of functions and of controllers. Those of the analytic terms come first; then those of functions:
    /// of Python, compiled ones, thrusters.
    first_of_functions: usize,
    first_of_controllers: usize,
    /// If it is one compiled function and nothing else, what this function is called with.
    exchange: Option<Box<Exchange>>,
    /// Where the run begins, as far as it has been told.
    start: f64,
    /// A time within the span last entered.
    middle: f64,
}

impl<'a, 'py> ActingLoad<'a, 'py> {
    /// `load`, whose analytic terms are `terms`, on `subject`.
    pub(crate) fn new(
        load: &'a PyLoad,
        terms: &'a [Term],
        subject: BodyAtPoint,
        py: Option<Python<'py>>,
    ) -> Self {
        let (controllers, follows) = load.controllers();
        let has_states = |load: &PyLoad| load.with_states().next().is_some();
        let names_states = has_states(load)
            || load.thrusters().any(Firing::calls_python)
            || controllers.iter().any(|one| has_states(one));
        let functions = LoadFunctions::new(load);
        let first_of_functions = terms.iter().map(Term::internal_states).sum();
        Self {
            first_of_functions,
            first_of_controllers: first_of_functions + functions.states(),
            exchange: (load.is_compiled_function()).then(|| Box::new(Exchange::new())),
            controllers: controllers.into_iter().map(LoadFunctions::new).collect(),
            follows,
            torques: Vec::new(),
            analytic: Analytic::new(terms, subject),
            load,
            py,
            functions,
            slots: if names_states {
                load.slots()
            } else {
                Vec::new()
            },
            start: subject.start,
            middle: subject.start,
        }
    }

    /// What the controllers ask of the motors, as torques on the body, into `all`; the rates of their states into `rates`, where there is
    /// room.
    fn commands(
        &self,
        t: f64,
        phase: &Phase,
        mut first: usize,
        rates: &mut [f64],
        all: &mut Vec<Vector3<f64>>,
    ) -> Result<(), Fault> {
        all.clear();
        for one in &self.controllers {
            let mut sum = Wrench::default();
            one.add(&self.call(t, phase), first, rates, &mut sum)?;
            first += one.states();
            if sum.force != Vector3::zeros() {
                let [x, y, z] = sum.force.into();
                return Err(Fault::Python(PyValueError::new_err(format!(
                    "torque: a motor exerts a torque alone, and so do coils; its controller asks for the force [{x:?}, {y:?}, {z:?}] at t = \
                     {t:?}. Return a force of zero there, and add a load with the force to the wheel or to the coils"
                ))));
            }
            all.push(sum.torque);
        }
        Ok(())
    }

    fn call<'s>(&'s self, t: f64, phase: &'s Phase) -> Call<'s, 'py> {
        Call {
            py: self.py,
            slots: &self.slots,
            terms: self.analytic.terms(),
            t,
            phase,
            body: self.analytic.body(),
            middle: self.middle,
            start: self.start,
        }
    }

    /// The sum of all that act, after the controllers have asked the motors.
    #[inline(never)]
    fn act_together(&mut self, t: f64, phase: &Phase, rates: &mut [f64]) -> Result<Wrench, Fault> {
        if !self.controllers.is_empty() {
            let mut torques = take(&mut self.torques);
            self.commands(t, phase, self.first_of_controllers, rates, &mut torques)?;
            self.command(&torques);
            self.torques = torques;
        }
        let mut sum = self.analytic.act(t, phase, rates)?;
        let first = self.first_of_functions;
        self.functions
            .add(&self.call(t, phase), first, rates, &mut sum)?;
        Ok(sum)
    }

    /// Tells the motors what the controllers ask for.
    fn command(&mut self, torques: &[Vector3<f64>]) {
        for (term, follows) in self.follows.iter().enumerate() {
            if let Some(number) = follows {
                self.analytic.command(term, torques[*number]);
            }
        }
    }
}

impl Load for ActingLoad<'_, '_> {
    type Error = Fault;

    fn analytic(&self) -> Option<&[Term]> {
        (self.load.is_analytic()).then(|| self.analytic.analytic())?
    }

    fn exerts_force(&self) -> bool {
        self.analytic.exerts_force()
            || self.load.callbacks().any(Callback::exerts_force)
            || self
                .functions
                .with_states
                .iter()
                .any(|one| one.exerts_force())
            || self.load.compiled_functions().next().is_some()
            || self.load.thrusters().next().is_some()
    }

    fn depends_on_rates(&self) -> bool {
        self.analytic.depends_on_rates()
            || self.load.calls_python()
            || self.load.compiled_functions().next().is_some()
            || self.load.thrusters().next().is_some()
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let mut breaks = self.functions.breaks(from, to);
        breaks.extend(self.analytic.breaks(from, to));
        for one in &self.controllers {
            breaks.extend(one.breaks(from, to));
        }
        breaks
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), Fault> {
        let middle = from + 0.5 * (to - from);
        self.middle = middle;
        self.functions.enter(middle);
        for one in &mut self.controllers {
            one.enter(middle);
        }
        Ok(self.analytic.enter(from, to)?)
    }

    fn settle(&mut self, t: f64, phase: &Phase) {
        self.analytic.settle(t, phase);
    }

    fn law_switches(&self) -> Vec<LawSwitch> {
        self.analytic.law_switches()
    }

    fn switch_law(&mut self, change: &LawSwitch) {
        self.analytic.switch_law(change);
    }

    fn bearings(&self) -> &[Bearing] {
        self.analytic.bearings()
    }

    fn over_limit(&self, wheel: Option<usize>, t: f64, phase: &Phase) -> f64 {
        if self.controllers.is_empty() {
            return self.analytic.over_limit(wheel, t, phase);
        }
        // What fails here fails in the equations too, which say so.
        let (first, torques) = (self.first_of_controllers, &mut Vec::new());
        if self.commands(t, phase, first, &mut [], torques).is_err() {
            return f64::NAN;
        }
        let mut analytic = self.analytic.clone();
        for (term, follows) in self.follows.iter().enumerate() {
            if let Some(number) = follows {
                analytic.command(term, torques[*number]);
            }
        }
        analytic.over_limit(wheel, t, phase)
    }

    fn set_body(&mut self, body: &BodyAtPoint) {
        self.analytic.set_body(body);
    }

    #[inline]
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Fault> {
        self.act(t, phase, &mut [])
    }

    /// Without room for the rates none are asked for.
    // One function by itself is called from where the equations are, and its answer stays in registers. So what all others exert is
    // returned number by number: otherwise both answers would be in memory.
    #[inline(always)]
    fn act(&mut self, t: f64, phase: &Phase, rates: &mut [f64]) -> Result<Wrench, Fault> {
        if let Some(exchange) = &mut self.exchange
            && let [compiled] = self.functions.compiled[..]
        {
            return Ok(compiled.call(t, phase, &phase.internal_state, rates, exchange));
        }
        let Wrench { force, torque } = self.act_together(t, phase, rates)?;
        Ok(Wrench {
            force: Vector3::new(force.x, force.y, force.z),
            torque: Vector3::new(torque.x, torque.y, torque.z),
        })
    }

    fn carried(&self) -> Vec<&dyn CarriedMomentum> {
        self.analytic.carried()
    }

    fn sizes(&self) -> Vec<[f64; 2]> {
        let mut sizes = self.analytic.sizes();
        let scales = self.load.scales_of_functions().into_iter();
        sizes.extend(scales.map(|scale| [0.0, scale]));
        sizes
    }

    fn cuts(&self, from: f64, to: f64, phase: &Phase) -> Vec<f64> {
        let firing = self.functions.firing(self.first_of_functions);
        let mut cuts: Vec<f64> = firing
            .flat_map(|(one, own)| one.cuts((from, to), self.start, &phase.internal_state[own]))
            .collect();
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    fn firing(&self, t: f64, is_before: bool, phase: &Phase) -> Vec<(usize, bool)> {
        let firing = self.functions.firing(self.first_of_functions);
        let all = firing.flat_map(|(one, own)| {
            let (first, states) = (own.start, &phase.internal_state[own]);
            let fires = if is_before {
                one.fired(t, self.start, states)
            } else {
                one.fires(self.middle, self.start, states)
            };
            (fires.into_iter().enumerate()).map(move |(k, fires)| (first + k, fires))
        });
        all.collect()
    }

    fn jump(&mut self, t: f64, phase: &mut Phase) -> Result<(), Fault> {
        let py = self.py.filter(|_| !self.slots.is_empty());
        if py.is_none() && self.functions.thrusters.is_empty() {
            return Ok(());
        }
        let now = (t, self.start);
        let states = py.map(|_| Named::of(&self.slots, self.analytic.terms(), phase));
        let mut after = phase.internal_state.clone();
        if let (Some(py), Some(states)) = (py, &states) {
            let own = (self.first_of_functions, self.load);
            let mut of_controllers = self.first_of_controllers;
            let controllers = self.controllers.iter().map(|one| {
                let first = of_controllers;
                of_controllers += one.states();
                (first, one.load)
            });
            let laws = std::iter::once(own)
                .chain(controllers)
                .flat_map(|(mut first, load)| {
                    load.with_states().map(move |law| {
                        let own = first..first + law.initial.len();
                        first = own.end;
                        (own, law)
                    })
                });
            for (own, one) in laws {
                let updated = one.update(py, now, phase, states);
                if let Some(new) = updated.map_err(Fault::Python)? {
                    after[own].copy_from_slice(&new);
                }
            }
        }
        for (one, own) in self.functions.firing(self.first_of_functions) {
            let before = &phase.internal_state[own.clone()];
            let begun = one.begin_period(py, now, phase, states.as_ref(), before);
            if let Some(new) = begun.map_err(Fault::Python)? {
                after[own].copy_from_slice(&new);
            }
        }
        phase.internal_state = after;
        Ok(())
    }
}

// What a body carries along under a load, asked for outside a run: momentum, energy, states.

/// An array of float64.
type Floats<'py> = Bound<'py, PyArrayDyn<f64>>;

#[pymethods]
impl PyLoad {
    /// Angular momentum and energy of the wheels, rotors and slugs of the load, in addition to ``I ω`` and
    /// ``½ ω·I ω``. A rotor adds angular momentum, but no energy.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (...)
    /// omega : array_like, shape (..., 3)
    /// states : dict of str and array_like, shape (..., k), optional
    ///
    /// Returns
    /// -------
    /// momentum : numpy.ndarray, shape (..., 3)
    ///     Angular momentum, components in the body frame.
    /// energy : numpy.ndarray, shape (...)
    #[pyo3(signature = (t, omega, states=None))]
    fn carried<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        states: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Floats<'py>, Floats<'py>)> {
        let (terms, t): (_, Stack<f64>) = (self.terms(py)?, read(t, "t")?);
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let states = self.read_states(states, true)?;
        let shapes = [&terms.shape[..], &t.shape, &omega.shape, &states.shape];
        let grid = Broadcast::of(["load", "t", "omega", "states"], shapes)?;
        let found = grid.try_map(py, |[l, k, w, s]| {
            Ok(carried_along(&terms[l], t[k], &omega[w], &states[s]))
        })?;
        Ok((
            write_of(py, &found, |found| found.0)?,
            write_of(py, &found, |found| found.1)?,
        ))
    }

    /// Whether the load has wheels, rotors or slugs, which the body carries.
    #[getter]
    fn carries(&self, py: Python<'_>) -> PyResult<bool> {
        let terms = self.terms(py)?;
        Ok(terms
            .rows
            .iter()
            .flatten()
            .any(|term| term.carried().is_some()))
    }

    /// Number of states of the load, by name.
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        for slot in self.slots() {
            named.set_item(&*slot.name, slot.count)?;
        }
        Ok(named)
    }
}

/// What the terms carry along at a time: momentum beside I ω and energy beside ½ ω·I ω, from the states as they are reported.
pub(crate) fn carried_along(
    terms: &[Term],
    t: f64,
    omega: &Vector3<f64>,
    reported: &[f64],
) -> (Vector3<f64>, f64) {
    let (mut momentum, mut energy, mut first) = (Vector3::zeros(), 0.0, 0);
    for carried in terms.iter().filter_map(Term::carried) {
        let mine = reported
            .get(first..first + carried.count())
            .unwrap_or_default();
        first += carried.count();
        let mut own = mine.to_vec();
        if carried.count() > 0 {
            carried.resume_states(&mut own, t, omega);
        }
        momentum += carried.momentum(&own, omega);
        energy += carried.energy(&own, omega);
    }
    (momentum, energy)
}
