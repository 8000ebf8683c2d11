//! A motion step by step, for the loop of a flight program: what does not change from step to step is made ready once.

use nalgebra::Vector3;
use numpy::PyArray1;
use polhode::motion::attitude::components;
use polhode::motion::loads::{CarriedMomentum, Term, VaryingLoad};
use polhode::motion::simulate::{Chain, Crossing, Effort, End, Method, NoEvents, Run, Tolerance};
use polhode::motion::state::Phase;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};
use pyo3::{PyTraverseError, PyVisit, intern};

use super::outcome::{Outcome, of_run, tell};
use super::simulate::{Given, cast_load, check_velocity, most_steps, parse_method};
use super::simulate_stack::Start;
use crate::about::is_pivot;
use crate::arrays::{read_scalar, write_of};
use crate::body::PyRigidBody;
use crate::closed_form::origin;
use crate::depth::RecursionGuard;
use crate::errors::to_py;
use crate::events::{Functions, States};
use crate::hints;
use crate::interrupt::Interrupt;
use crate::loads::{ActingLoad, Fault, PyLoad, Slot, carried_along, check_start, report_states};
use crate::shape::tuple;
use crate::stack::Stack;
use crate::uncertain::{StartArguments, UncertainStart};

/// An angular momentum that differs by less, relative to its parts, is the same.
const EQUAL_MOMENTA: f64 = 1e-12;

/// The load of the steps from now on.
struct Acting {
    /// As it was given.
    given: Option<Py<PyAny>>,
    /// For a motion that began at its start.
    load: Py<PyLoad>,
    terms: Vec<Term>,
    slots: Vec<Slot>,
}

/// Where a step begins: the state, with the states of the load as the equations have them, and these as they are reported.
struct StepStart {
    phase: Phase,
    reported: Vec<f64>,
}

impl Acting {
    fn new(py: Python<'_>, given: Given<'_, '_>, start: f64) -> PyResult<Self> {
        let given = given.filter(|given| !given.is_none());
        let load = match given {
            None => Py::new(py, PyLoad::default())?,
            Some(given) if cast_load(given)?.needs_epoch() => {
                Py::new(py, cast_load(given)?.copy_with_epoch(py, start)?)?
            }
            Some(given) => given.cast::<PyLoad>()?.clone().unbind(),
        };
        let mut terms = load.get().terms(py)?;
        if !terms.is_one() {
            return Err(not_one("load", &terms.shape));
        }
        Ok(Self {
            given: given.map(|given| given.clone().unbind()),
            terms: terms.rows.swap_remove(0),
            slots: load.get().slots(),
            load,
        })
    }

    /// A step from time `t` and the state `now`, with these states of the load.
    fn begin(&self, t: f64, now: &Phase, states: &[f64]) -> StepStart {
        let load = self.load.get();
        let phase = Phase {
            internal_state: load.initial_states(&self.terms, t, &now.omega, states),
            ..*now
        };
        StepStart {
            reported: report_states(&self.terms, &phase),
            phase,
        }
    }

    fn carried(&self) -> impl Iterator<Item = &dyn CarriedMomentum> {
        self.terms.iter().filter_map(Term::carried)
    }

    /// The states of a load that was before it, under the same names; what that does not have is not a number.
    fn states_of(&self, before: &Self, reported: &[f64]) -> PyResult<Vec<f64>> {
        let mut states = Vec::new();
        for slot in &self.slots {
            match before.slots.iter().find(|one| one.name == slot.name) {
                None => states.resize(states.len() + slot.count, f64::NAN),
                Some(known) if known.count == slot.count => {
                    states.extend_from_slice(known.of(reported));
                }
                Some(known) => {
                    return Err(PyValueError::new_err(format!(
                        "load: the states {:?} are {} numbers until now and {} under this load; give them another name=",
                        slot.name, known.count, slot.count
                    )));
                }
            }
        }
        Ok(states)
    }
}

/// The motion of one body step by step: what :meth:`RigidBody.stepper` returns.
///
/// A step has the bits of :meth:`Trajectory.resume` through the same times. A step that fails, or that Ctrl-C
/// stops, is not made: the stepper stays where it was.
///
/// Attributes
/// ----------
/// t : float
///     Time that the motion has come to.
/// status : {"complete", "event"}
///     How the last step ended: after its whole length, or earlier, at a terminal event. The next step goes on
///     from there.
///
/// Examples
/// --------
/// A motor that is told its torque once a second, and brings a satellite to rest:
///
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
/// >>> run = body.stepper(omega=(0, 0, 0.1), load=loads.wheel((0, 0, 1), inertia=0.1))
/// >>> for _ in range(100):
/// ...     torque = 0.2 * run.state().omega[2]
/// ...     state = run.step(1.0, load=loads.wheel((0, 0, 1), inertia=0.1, torque=torque))
/// >>> motion = run.trajectory()
/// >>> (momentum,) = motion.states.values()
/// >>> run.t, state.omega.round(3) + 0.0, momentum[-1].round(3)
/// (100.0, array([0., 0., 0.]), array([0.25]))
/// >>> motion
/// Trajectory(101 times from 0 to 100)
#[pyclass(name = "Stepper", module = "polhode")]
pub(crate) struct PyStepper {
    body: Py<PyRigidBody>,
    chain: Chain,
    pivoted: bool,
    method: Method,
    acting: Acting,
    /// Whether another load has acted before.
    has_changed: bool,
    events: Functions,
    uncertain: UncertainStart,
    /// Names of the states that were given.
    given_states: Option<Py<PyTuple>>,
    status: &'static str,
    // The motion so far.
    times: Vec<f64>,
    /// The states, those of the load as they are reported.
    samples: Vec<Phase>,
    /// The states of the load by name, from the sample of that number on.
    slots: Vec<(usize, Vec<Slot>)>,
    /// What is carried along at each sample.
    carried: Vec<(Vector3<f64>, f64)>,
    crossings: Vec<Crossing>,
    effort: Effort,
}

#[pymethods]
impl PyStepper {
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.body)?;
        visit.call(&self.acting.given)?;
        visit.call(&self.acting.load)?;
        self.events.traverse(&visit)
    }

    /// Time that the motion has come to.
    #[getter]
    fn t(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// How the last step ended: "complete", or "event" at a terminal event.
    #[getter]
    fn status(&self) -> &'static str {
        self.status
    }

    /// Make a step.
    ///
    /// Parameters
    /// ----------
    /// dt : float
    ///     Length of the step. All steps go the same way in time: forward, or backward if it is negative.
    /// load : Load, optional
    ///     Load from this step on; by default the load of the step before. States of the same name go on, so that
    ///     wheels keep their momentum, and the others begin anew. To take all loads away, give one that is
    ///     zero.
    ///
    /// Returns
    /// -------
    /// State
    ///     The state at the end of the step, as :meth:`state` gives it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the total angular momentum would jump: wheels are missing in another load, or it has others that
    ///     turn.
    /// IntegrationError
    ///     If the integration cannot go on. ``partial`` of the error is the trajectory without this step.
    #[pyo3(signature = (dt, load=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] dt: f64,
        load: Given<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let _guard = RecursionGuard::run("step")?;
        let times = self.times_of(dt)?;
        let same = load.is_none_or(|load| {
            load.is_none() || (self.acting.given.as_ref()).is_some_and(|given| load.is(given))
        });
        let now = &self.samples[self.samples.len() - 1];
        if same {
            let at_start = self.acting.begin(times[0], now, &now.internal_state);
            let run = self.run(py, times, &self.chain, &self.acting, at_start, &self.events)?;
            self.add(run);
            return self.state(py);
        }
        let next = Acting::new(py, load, self.times[0])?;
        let states = next.states_of(&self.acting, &now.internal_state)?;
        let at_start = next.begin(times[0], now, &states);
        check_start(
            &next.terms,
            times[0],
            &at_start.phase,
            &at_start.reported,
            &states,
        )?;
        let mut chain = self.chain.clone();
        let terms = next.load.get().is_analytic().then_some(&next.terms[..]);
        (chain.take(self.method, terms, next.carried())).map_err(|error| to_py(py, &error))?;
        self.check_momentum(py, &chain, &next, &at_start)?;
        let mut events = self.events.clone_ref(py);
        events.aim(py, next.load.get(), &next.terms)?;
        let run = self.run(py, times, &chain, &next, at_start, &events)?;
        if next.slots != self.acting.slots {
            self.slots.push((self.samples.len(), next.slots.clone()));
        }
        (self.chain, self.acting, self.events, self.has_changed) = (chain, next, events, true);
        self.add(run);
        self.state(py)
    }

    /// Return the state that the motion has come to.
    ///
    /// Returns
    /// -------
    /// State
    ///     `omega`, `attitude`, `position`, `velocity`, and `states` of the load by name, or None.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        let phase = &self.samples[self.samples.len() - 1];
        let array = |numbers: &[f64]| PyArray1::from_slice(py, numbers);
        let slots = &self.slots[self.slots.len() - 1].1;
        let states = if slots.is_empty() {
            None
        } else {
            let named = PyDict::new(py);
            for slot in slots {
                named.set_item(&*slot.name, array(slot.of(&phase.internal_state)))?;
            }
            Some(named)
        };
        CLASS.import(py, "polhode.results", "State")?.call1((
            array(phase.omega.as_slice()),
            array(&components(&phase.attitude)),
            array(phase.position.as_slice()),
            array(phase.velocity.as_slice()),
            states,
        ))
    }

    /// Return the motion so far: the start, and the end of every step.
    ///
    /// Returns
    /// -------
    /// Trajectory
    ///     With the events, and the states of the load. If the load was changed on the way, its attribute
    ///     ``load`` is None, and what needs it, such as the torque, is not known; the momentum of wheels is.
    ///     A state that a load of that time did not have is NaN.
    fn trajectory<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let fields = PyDict::new(py);
        fields.set_item(intern!(py, "body"), &self.body)?;
        fields.set_item(intern!(py, "status"), self.status)?;
        fields.set_item(intern!(py, "failures"), ())?;
        fields.set_item(intern!(py, "pivoted"), self.pivoted)?;
        let load = self.acting.given.as_ref().filter(|_| !self.has_changed);
        fields.set_item(intern!(py, "load"), load)?;
        if self.has_changed {
            fields.set_item(intern!(py, "_origin"), origin(py, "loaded", true)?)?;
            let along = Stack {
                shape: vec![self.carried.len()],
                rows: self.carried.clone(),
            };
            let momentum = write_of(py, &along, |one| one.0)?;
            let energy = write_of(py, &along, |one| one.1)?;
            let carries = self
                .carried
                .iter()
                .any(|one| one.0 != Vector3::zeros() || one.1 != 0.0);
            fields.set_item(
                intern!(py, "carried"),
                carries.then_some((momentum, energy)),
            )?;
        } else if let Some(names) = &self.given_states {
            fields.set_item(intern!(py, "_origin"), origin(py, "states", names)?)?;
        }
        if self.uncertain.is_any() {
            fields.set_item(
                intern!(py, "uncertain_start"),
                self.uncertain.to_python(py)?,
            )?;
        }
        if self.status == "event"
            && let Some(last) = self.crossings.last()
        {
            fields.set_item(intern!(py, "_ended_by"), self.events.function(last.event))?;
        }
        let (slots, samples, crossings) = self.with_common_slots();
        let outcome = Outcome::of_one(
            self.times.clone(),
            self.chain.body_at_point(0.0).point,
            (self.effort, crossings, self.events.len()),
            slots,
            samples,
        );
        fields.set_item(intern!(py, "_outcome"), Bound::new(py, outcome)?)?;
        of_run(py)?.call1((fields,))
    }

    fn __repr__(&self) -> String {
        format!(
            "<Stepper: t = {:?} after {} steps>",
            self.t(),
            self.times.len() - 1
        )
    }
}

impl PyStepper {
    /// The times of a step.
    fn times_of(&self, dt: f64) -> PyResult<[f64; 2]> {
        let (first, t) = (self.times[0], self.t());
        let end = t + dt;
        if !(end.is_finite() && dt != 0.0) {
            return Err(PyValueError::new_err(format!(
                "dt: expected a finite time that is not zero, got {dt:?}"
            )));
        }
        if end == t {
            return Err(PyValueError::new_err(format!(
                "dt: {dt:?} is lost in the rounding of t = {t:?}; make longer steps, or begin the clock anew"
            )));
        }
        if (t - first) * dt < 0.0 {
            return Err(PyValueError::new_err(format!(
                "dt: all steps go the same way in time, the ones before from {first:?} to {t:?}; got {dt:?}. For the way back begin \
                 another stepper with this state: body.stepper(**run.state()._asdict(), start=run.t)"
            )));
        }
        Ok([t, end])
    }

    /// One step. The states of the load are reported again after it.
    fn run(
        &self,
        py: Python<'_>,
        times: [f64; 2],
        chain: &Chain,
        acting: &Acting,
        at_start: StepStart,
        events: &Functions,
    ) -> PyResult<Run<Fault>> {
        let Acting { load, terms, .. } = acting;
        let load = load.get();
        load.check_run(py, times[0], times[1])?;
        let initial = at_start.phase;
        let subject = chain.body_at_point(times[0]);
        let interrupt = Interrupt::new(None);
        let watch = &mut |done| interrupt.poll(Some(done));
        let run = if load.calls_python() || !events.is_empty() {
            let load = ActingLoad::new(load, terms, subject, Some(py));
            let states = States {
                slots: &acting.slots,
                terms,
            };
            chain.run(
                &times,
                initial,
                &mut VaryingLoad::constant(load),
                &mut events.with_callbacks(py, states),
                watch,
            )
        } else {
            py.detach(|| {
                let load = ActingLoad::new(load, terms, subject, None);
                let load = &mut VaryingLoad::constant(load);
                chain.run(&times, initial, load, &mut NoEvents::new(), watch)
            })
        };
        let mut run = run.map_err(|error| to_py(py, &error))?;
        if let End::Failed(fault) = &run.end {
            let error = fault.to_exception(py);
            if !fault.is_of_the_user() {
                tell(&error, 0, &run, py)?;
                error.value(py).setattr("partial", self.trajectory(py)?)?;
            }
            return Err(error);
        }
        if let Err(stop) = interrupt.finish(py, true) {
            stop.value(py).setattr("partial", self.trajectory(py)?)?;
            return Err(stop);
        }
        let found = run.crossings.iter_mut().map(|crossing| &mut crossing.phase);
        for phase in found.chain([&mut run.phase]) {
            if !phase.internal_state.is_empty() {
                phase.internal_state = report_states(terms, phase).into();
            }
        }
        Ok(run)
    }

    /// The motion goes on by a step.
    fn add(&mut self, run: Run<Fault>) {
        let has_ended = matches!(run.end, End::Event);
        self.status = if has_ended { "event" } else { "complete" };
        self.events.go_on(&run.crossings, has_ended);
        self.crossings.extend(run.crossings);
        self.effort.steps += run.effort.steps;
        self.effort.evaluations += run.effort.evaluations;
        let Phase {
            omega,
            internal_state,
            ..
        } = &run.phase;
        let along = carried_along(&self.acting.terms, run.time, omega, internal_state);
        self.carried.push(along);
        self.times.push(run.time);
        self.samples.push(run.phase);
    }

    /// Refuse another load under which the total angular momentum would jump.
    fn check_momentum(
        &self,
        py: Python<'_>,
        chain: &Chain,
        next: &Acting,
        at_start: &StepStart,
    ) -> PyResult<()> {
        let (t, omega) = (self.t(), &at_start.phase.omega);
        let of = self.carried[self.carried.len() - 1].0;
        let (into, _) = carried_along(&next.terms, t, omega, &at_start.reported);
        let point = chain.body_at_point(t).point;
        let spin = chain.body().inertia_about(&point) * omega;
        if (into - of).norm() <= EQUAL_MOMENTA * (into.norm() + of.norm() + spin.norm()) {
            return Ok(());
        }
        let words = py
            .import("polhode.motion.trajectory")?
            .getattr("momentum_jump")?;
        let [of, into] = [of, into].map(|one| <[f64; 3]>::from(one).to_vec());
        Err(PyErr::from_value(words.call1((t, of, into))?))
    }

    /// The states of all loads by name, and samples and events that have them in this order.
    fn with_common_slots(&self) -> (Vec<Slot>, Vec<Phase>, Vec<Crossing>) {
        let (mut samples, mut crossings) = (self.samples.clone(), self.crossings.clone());
        if let [(_, slots)] = &self.slots[..] {
            return (slots.clone(), samples, crossings);
        }
        let mut common: Vec<Slot> = Vec::new();
        for slot in self.slots.iter().flat_map(|(_, slots)| slots) {
            if !common.iter().any(|one| one.name == slot.name) {
                let first = common.last().map_or(0, |last| last.first + last.count);
                common.push(Slot {
                    first,
                    ..slot.clone()
                });
            }
        }
        let count = common.last().map_or(0, |last| last.first + last.count);
        let rewrite = |phase: &mut Phase, slots: &[Slot]| {
            let mut states = vec![f64::NAN; count];
            for (slot, one) in slots.iter().filter_map(|slot| {
                let found = common.iter().find(|one| one.name == slot.name);
                found.map(|one| (slot, one))
            }) {
                states[one.first..one.first + one.count]
                    .copy_from_slice(slot.of(&phase.internal_state));
            }
            phase.internal_state = states.into();
        };
        let mut crossings_left = &mut crossings[..];
        for (index, (first, slots)) in self.slots.iter().enumerate() {
            let end = (self.slots.get(index + 1)).map_or(samples.len(), |(next, _)| *next);
            let last = self.times[end - 1];
            for phase in &mut samples[*first..end] {
                rewrite(phase, slots);
            }
            let forward = last >= self.times[0];
            let here = crossings_left.partition_point(|one| {
                if forward {
                    one.time <= last
                } else {
                    one.time >= last
                }
            });
            let (mine, rest) = crossings_left.split_at_mut(here);
            crossings_left = rest;
            for one in mine {
                rewrite(&mut one.phase, slots);
            }
        }
        (common, samples, crossings)
    }
}

/// That an argument is a stack.
fn not_one(name: &str, shape: &[usize]) -> PyErr {
    PyValueError::new_err(format!(
        "{name}: a stepper moves one body, got a stack of shape {}; make a stepper for each, or simulate the stack",
        tuple(shape)
    ))
}

const KEYWORDS: [&str; 13] = [
    "omega",
    "attitude",
    "load",
    "start",
    "position",
    "velocity",
    "about",
    "method",
    "rtol",
    "atol",
    "events",
    "states",
    "max_steps",
];

#[pymethods]
impl PyRigidBody {
    /// Begin a motion that is computed step by step, as in the loop of a flight program.
    ///
    /// A chain of :meth:`Trajectory.resume` gives the same bits. A stepper does not make everything anew for each
    /// step: a step with three wheels takes a small part of the time.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (3,)
    ///     Angular velocity at the start, of the body relative to space, components in the body frame.
    /// attitude : array_like, shape (4,), or rotation, optional
    ///     R_NB at the start; the identity by default.
    /// load : Load, optional
    ///     Forces and torques on the body. Controllers of the load, such as
    ///     :func:`polhode.loads.with_states` with a period, go on over the steps.
    /// start : float, optional
    ///     Time at the start; zero by default.
    /// position, velocity : array_like, shape (3,), optional
    ///     Of the point `about` at the start, in space; zero by default.
    /// about, method, rtol, atol
    ///     As in :meth:`simulate`.
    /// events : callable or sequence of callables, optional
    ///     As in :meth:`simulate`. A terminal event ends the step in which it is, and the next step goes on from
    ///     there. If ``terminal`` is a number n, every n-th passage does, counted over all steps.
    /// states : dict of str and array_like, shape (k,), optional
    ///     States of the load at the start, by name, in place of its usual initial states.
    /// max_steps : int, optional
    ///     Largest number of steps of the integration within a step.
    ///
    /// Returns
    /// -------
    /// Stepper
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    /// >>> run = body.stepper(omega=(0.1, 1.0, 0.2))
    /// >>> one, two = run.step(0.5), run.step(0.5)
    /// >>> run.t, two.omega.round(6)
    /// (1.0, array([0.006364, 1.007442, 0.178976]))
    #[pyo3(
        signature = (
            omega=None, attitude=None, *, load=None, start=0.0, position=None, velocity=None,
            about="center_of_mass", method="auto", rtol=1e-10, atol=None, events=None, states=None,
            max_steps=None, **unknown
        ),
        text_signature = "($self, omega, attitude=None, *, load=None, start=0.0, position=None, velocity=None, about=\"center_of_mass\", method=\"auto\", rtol=1e-10, atol=None, events=None, states=None, max_steps=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn stepper<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        omega: Given<'_, 'py>,
        attitude: Given<'_, 'py>,
        load: Given<'_, 'py>,
        #[pyo3(from_py_with = read_scalar)] start: f64,
        position: Given<'_, 'py>,
        velocity: Given<'_, 'py>,
        #[pyo3(from_py_with = read_scalar)] about: &str,
        #[pyo3(from_py_with = read_scalar)] method: &str,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
        #[pyo3(from_py_with = read_scalar)] atol: Option<f64>,
        events: Given<'_, 'py>,
        states: Given<'_, 'py>,
        #[pyo3(from_py_with = read_scalar)] max_steps: Option<i128>,
        unknown: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<PyStepper> {
        hints::refuse_unknown("RigidBody.stepper", &KEYWORDS, unknown)?;
        let [omega] = hints::require("RigidBody.stepper", [("omega", omega)])?;
        let pivoted = is_pivot(about)?;
        check_velocity(pivoted, velocity)?;
        let tolerance = Tolerance::new(rtol, atol.unwrap_or(0.0))
            .map_err(|error| to_py(py, &error))?
            .within(most_steps(max_steps)?);
        if !start.is_finite() {
            return Err(PyValueError::new_err(format!(
                "start: expected a finite time, got {start:?}"
            )));
        }
        let acting = Acting::new(py, load, start)?;
        let given = StartArguments::read(omega, attitude)?;
        let bodies = &slf.get().bodies;
        let first = Start::read(
            py,
            bodies,
            &given,
            [position, velocity],
            acting.load.get(),
            states,
        )?;
        let grid = first.grid()?;
        if !grid.shape.is_empty() {
            let what = if bodies.shape.is_empty() {
                "the start"
            } else {
                "the body"
            };
            return Err(not_one(what, &grid.shape));
        }
        first.check_finite(py)?;
        let omega = first.omega[0];
        acting
            .load
            .get()
            .check_given(&acting.terms, start, &omega, &first.states[0])?;
        let method = parse_method(method)?;
        let mut chain = Chain::new(bodies[0], pivoted, tolerance);
        let terms = acting.load.get().is_analytic().then_some(&acting.terms[..]);
        chain
            .take(method, terms, acting.carried())
            .map_err(|error| to_py(py, &error))?;
        let events = Functions::read(events, acting.load.get(), &first.terms)?;
        let mut phase = Phase {
            attitude: first.attitude[0],
            omega,
            position: first.position[0],
            velocity: first.velocity[0],
            internal_state: acting.load.get().initial_states(
                &acting.terms,
                start,
                &omega,
                &first.states[0],
            ),
        };
        phase.internal_state = report_states(&acting.terms, &phase).into();
        let along = carried_along(&acting.terms, start, &omega, &phase.internal_state);
        let given_states = match states.map(|states| states.cast::<PyDict>()) {
            Some(Ok(states)) => Some(states.keys().to_tuple().unbind()),
            _ => None,
        };
        Ok(PyStepper {
            body: slf.clone().unbind(),
            chain,
            pivoted,
            method,
            slots: vec![(0, acting.slots.clone())],
            acting,
            has_changed: false,
            events,
            uncertain: given.uncertain,
            given_states,
            status: "complete",
            times: vec![start],
            samples: vec![phase],
            carried: vec![along],
            crossings: Vec::new(),
            effort: Effort::default(),
        })
    }
}
