//! A run of `simulate`: what stands in each row, for the core to run, without the GIL unless Python is called.

use nalgebra::{UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::loads::{Term, VaryingBody, VaryingLoad};
use polhode::motion::rolling::Contact;
use polhode::motion::simulate::{
    Batch, CallbackPolicy, End, Events, Member, NoEvents, Plan, Run, simulate_many,
};
use polhode::motion::state::Phase;
use pyo3::prelude::*;

use crate::errors::{at_row, to_py};
use crate::events::{Functions, States};
use crate::interrupt::{Beat, Interrupt};
use crate::loads::{ActingLoad, Fault, PyLoad, report_states};
use crate::memory;
use crate::rolling::gravity_of;
use crate::stack::{BLOCK, Broadcast, Stack};

/// Bodies, their states at the start and the analytic terms of the load on each.
pub(super) struct Start<'a> {
    pub(super) bodies: &'a Stack<RigidBody>,
    pub(super) omega: Stack<Vector3<f64>>,
    /// As given, to the last bit, and of unit length to rounding alone.
    pub(super) attitude: Stack<UnitQuaternion<f64>>,
    pub(super) position: Stack<Vector3<f64>>,
    pub(super) velocity: Stack<Vector3<f64>>,
    pub(super) terms: Stack<Vec<Term>>,
    /// States of the load, as they are reported; not numbers where none are given.
    pub(super) states: Stack<Vec<f64>>,
}

impl Start<'_> {
    pub(super) fn grid(&self) -> PyResult<Broadcast<'static, 7>> {
        Broadcast::of(
            [
                "body", "omega", "attitude", "position", "velocity", "load", "states",
            ],
            [
                &self.bodies.shape,
                &self.omega.shape,
                &self.attitude.shape,
                &self.position.shape,
                &self.velocity.shape,
                &self.terms.shape,
                &self.states.shape,
            ],
        )
    }

    /// Every number of the states must be finite.
    pub(super) fn check_finite(&self, py: Python<'_>) -> PyResult<()> {
        for (name, stack) in [
            ("omega", &self.omega),
            ("position", &self.position),
            ("velocity", &self.velocity),
        ] {
            for (row, vector) in stack.rows.iter().enumerate() {
                if let Some(&value) = vector.iter().find(|x| !x.is_finite()) {
                    let error = polhode::Error::NonFinite { what: name, value };
                    return Err(at_row(&stack.shape, row, &to_py(py, &error), py));
                }
            }
        }
        Ok(())
    }
}

/// All that a run needs.
pub(super) struct Ensemble<'a> {
    pub(super) start: &'a Start<'a>,
    pub(super) grid: Broadcast<'a, 7>,
    pub(super) plan: Plan<'a>,
    pub(super) load: &'a PyLoad,
    pub(super) events: &'a Functions,
    /// Whether the first row that fails ends the run.
    pub(super) raises: bool,
    /// The plane that the bodies roll on.
    pub(super) rolling: Option<Rolling>,
    /// The body, where it varies with time.
    pub(super) varying: Option<&'a VaryingBody>,
}

/// A plane, and how each row starts on it and which gravity acts there.
pub(super) struct Rolling {
    pub(super) contact: Contact,
    pub(super) rows: Vec<(Phase, Vector3<f64>)>,
}

impl Rolling {
    /// Put every row on the plane: where it is given, which must touch, or at the point of the plane.
    pub(super) fn new(
        py: Python<'_>,
        contact: Contact,
        start: &Start<'_>,
        load: &PyLoad,
        [is_placed, is_moving]: [bool; 2],
    ) -> PyResult<Self> {
        let grid = start.grid()?;
        let mut rows = memory::vector("simulate: rows of the stack", &grid.shape, 0)?;
        for row in 0..grid.len() {
            let [b, w, q, r, v, l, _] = grid.operands(row);
            let gravity = gravity_of(py, load, &start.terms[l])?;
            // The plane needs a unit quaternion to the last digit.
            let attitude = UnitQuaternion::new_normalize(start.attitude[q].into_inner());
            let phase = contact
                .start(
                    &start.bodies[b],
                    start.omega[w],
                    attitude,
                    is_placed.then(|| start.position[r]),
                    is_moving.then(|| start.velocity[v]),
                )
                .map_err(|error| at_row(&grid.shape, row, &to_py(py, &error), py))?;
            rows.push((phase, gravity));
        }
        Ok(Self { contact, rows })
    }
}

impl Ensemble<'_> {
    /// The motion of a row, whose body may vary.
    fn integrate(
        &self,
        row: Member<'_>,
        load: ActingLoad<'_, '_>,
        events: &mut dyn Events<Error = Fault>,
    ) -> Run<Fault> {
        let mut load = match self.varying {
            Some(body) => VaryingLoad::new(body, load, &row.body()),
            None => VaryingLoad::constant(load),
        };
        row.integrate(&mut load, events)
    }
}

/// One run for each row, as far as they were begun.
pub(super) type Runs = Vec<Option<Run<Fault>>>;

/// The results as a `polhode.Trajectory`, and whether a row failed.
pub(super) type Results<'py> = PyResult<(Bound<'py, PyAny>, bool)>;

impl Ensemble<'_> {
    /// Every state at the start must be finite, and those of the load's own such as it has.
    pub(super) fn check(&self, py: Python<'_>) -> PyResult<()> {
        self.start.check_finite(py)?;
        if self.start.states.rows.iter().any(|given| !given.is_empty()) {
            for row in 0..self.grid.len() {
                let [_, w, _, _, _, l, s] = self.grid.operands(row);
                let (terms, states) = (&self.start.terms[l], &self.start.states[s]);
                let omega = &self.start.omega[w];
                (self
                    .load
                    .check_given(terms, self.plan.times()[0], omega, states))
                .map_err(|error| at_row(&self.grid.shape, row, &error, py))?;
            }
        }
        Ok(())
    }

    /// Integrates every row, without the GIL unless Python is called.
    ///
    /// # Errors
    /// The user's own exceptions, and those that do not concern the integration where `raises`.
    pub(super) fn run<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        load: Option<&Bound<'py, PyAny>>,
        interrupt: &Interrupt,
    ) -> Results<'py> {
        let mut runs = self.none_yet(py)?;
        let mut go = || simulate_many(&self.plan, self, &mut runs, &|done| interrupt.poll(done));
        match self.callbacks() {
            CallbackPolicy::OnThisThread => go(),
            CallbackPolicy::Nothing | CallbackPolicy::OnAnyThread => py.detach(go),
        }
        for (row, run) in runs.iter().enumerate() {
            if let Some(Run {
                end: End::Failed(fault),
                ..
            }) = run
            {
                if fault.is_of_the_user() {
                    return Err(fault.to_exception(py));
                }
                if self.raises && !fault.is_of_integration() {
                    let error = fault.to_exception(py);
                    return Err(at_row(&self.grid.shape, row, &error, py));
                }
            }
        }
        self.tell_states(&mut runs);
        self.trajectory(py, body, load, runs, interrupt)
    }

    /// The states of the load as they are reported, in place of those that the runs went on with.
    fn tell_states(&self, runs: &mut Runs) {
        if self.load.slots().is_empty() {
            return;
        }
        for (row, run) in runs.iter_mut().enumerate() {
            let Some(run) = run else {
                continue;
            };
            let terms = Batch::terms(self, row);
            let found = run.crossings.iter_mut().map(|crossing| &mut crossing.phase);
            for phase in run.samples.iter_mut().chain(found).chain([&mut run.phase]) {
                if !phase.internal_state.is_empty() {
                    phase.internal_state = report_states(terms, phase).into();
                }
            }
        }
    }

    /// As many as there are rows, none of them begun, and room for their states and the arrays of these.
    fn none_yet(&self, py: Python<'_>) -> PyResult<Runs> {
        let times = self.plan.times().len();
        let own: usize = self.load.slots().iter().map(|slot| slot.count).sum();
        let numbers = (size_of::<Phase>() + 8 * own).saturating_mul(2 * times);
        let what = "simulate: rows of the stack times output times";
        let states = [&self.grid.shape[..], &[times]].concat();
        memory::room(what, &states, 2 * size_of::<Phase>())?;
        let each = numbers.saturating_add(size_of::<Option<Run<Fault>>>());
        let count = memory::room(what, &self.grid.shape, each)?;
        let mut runs = memory::vector(what, &self.grid.shape, 0)?;
        let mut beat = Beat::new(py);
        while runs.len() < count {
            beat.mark()?;
            runs.resize_with(count.min(runs.len() + BLOCK), || None);
        }
        Ok(runs)
    }
}

impl Batch for Ensemble<'_> {
    type Error = Fault;

    fn callbacks(&self) -> CallbackPolicy {
        if self.load.calls_python() || !self.events.is_empty() {
            CallbackPolicy::OnThisThread
        } else if self.load.is_analytic() && self.rolling.is_none() {
            CallbackPolicy::Nothing
        } else {
            CallbackPolicy::OnAnyThread
        }
    }

    fn start(&self, row: usize) -> (usize, Phase) {
        let [b, w, q, r, v, l, s] = self.grid.operands(row);
        if let Some(rolling) = &self.rolling {
            return (b, rolling.rows[row].0.clone());
        }
        let omega = self.start.omega[w];
        let own = self.load.initial_states(
            &self.start.terms[l],
            self.plan.times()[0],
            &omega,
            &self.start.states[s],
        );
        let initial = Phase {
            attitude: self.start.attitude[q],
            omega,
            position: self.start.position[r],
            velocity: self.start.velocity[v],
            internal_state: own,
        };
        (b, initial)
    }

    fn terms(&self, row: usize) -> &[Term] {
        let [.., l, _] = self.grid.operands(row);
        &self.start.terms[l]
    }

    fn run(&self, row: Member<'_>) -> Run<Fault> {
        let (load, terms, subject) = (self.load, self.terms(row.number), row.body());
        if let Some(Rolling { contact, rows }) = &self.rolling {
            let gravity = &rows[row.number].1;
            if self.events.is_empty() {
                return row.roll(contact, gravity, &mut NoEvents::new());
            }
            return Python::attach(|py| {
                let slots = &self.load.slots();
                let states = States { slots, terms };
                let events = &mut self.events.with_callbacks(py, states);
                row.roll(contact, gravity, events)
            });
        }
        match self.callbacks() {
            CallbackPolicy::Nothing | CallbackPolicy::OnAnyThread => {
                let load = ActingLoad::new(load, terms, subject, None);
                self.integrate(row, load, &mut NoEvents::new())
            }
            CallbackPolicy::OnThisThread => Python::attach(|py| {
                let load = ActingLoad::new(load, terms, subject, Some(py));
                let slots = &self.load.slots();
                let states = States { slots, terms };
                self.integrate(row, load, &mut self.events.with_callbacks(py, states))
            }),
        }
    }

    fn ends_all(&self, fault: &Fault) -> bool {
        self.raises || fault.is_of_the_user()
    }
}
