//! Events: Python functions whose passages through zero are looked for.

use numpy::PyArray1;
use polhode::motion::attitude::components;
use polhode::motion::loads::{CarriedMomentum, Magnetic, Term};
use polhode::motion::simulate::{Crossing, Direction, EventTrigger, Events, Rule};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::{PyTraverseError, PyVisit};

use crate::loads::{Fault, Named, PyLoad, Slot};
use crate::stack::Stack;

/// The functions of an argument `events`.
#[derive(Default)]
pub(crate) struct Functions {
    callables: Vec<Py<PyAny>>,
    rules: Vec<Rule>,
    /// After how many passages of each a run ends; 0 for never.
    terminal: Vec<u64>,
}

impl Functions {
    /// One function or a sequence of them; attributes `direction` and `terminal` as in SciPy. Some are told by the load.
    pub(crate) fn read(
        events: Option<&Bound<'_, PyAny>>,
        load: &PyLoad,
        terms: &Stack<Vec<Term>>,
    ) -> PyResult<Self> {
        let terms: Vec<_> = terms.rows.iter().map(Vec::as_slice).collect();
        let terms = &terms[..];
        let mut all = Self::default();
        let Some(events) = events.filter(|events| !events.is_none()) else {
            return Ok(all);
        };
        if events.is_callable() {
            all.push(events, load, terms)?;
            return Ok(all);
        }
        let items = events.try_iter().map_err(|_| {
            PyTypeError::new_err(format!(
                "events: expected a function or a sequence of them, got {}",
                events.get_type()
            ))
        })?;
        for item in items {
            all.push(&item?, load, terms)?;
        }
        Ok(all)
    }

    fn push(
        &mut self,
        function: &Bound<'_, PyAny>,
        load: &PyLoad,
        terms: &[&[Term]],
    ) -> PyResult<()> {
        let number = self.callables.len();
        if !function.is_callable() {
            return Err(PyTypeError::new_err(format!(
                "events: event {number} is no function but {}",
                function.get_type()
            )));
        }
        let attribute = |name| -> PyResult<f64> {
            let Some(value) = function.getattr_opt(name)? else {
                return Ok(0.0);
            };
            value.extract::<f64>().map_err(|_| {
                PyTypeError::new_err(format!(
                    "events: {name} of event {number} must be a number, got {value}"
                ))
            })
        };
        let (direction, terminal) = (attribute("direction")?, attribute("terminal")?);
        if !(terminal >= 0.0 && terminal.fract() == 0.0 && terminal < 1e18) {
            return Err(PyValueError::new_err(format!(
                "events: terminal of event {number} must be True, False or a count of zero or more, got {terminal}"
            )));
        }
        if direction.is_nan() {
            return Err(PyValueError::new_err(format!(
                "events: direction of event {number} must be positive, negative or zero, got nan"
            )));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked above to be a count"
        )]
        let last = terminal as u64;
        self.callables.push(function.clone().unbind());
        self.terminal.push(last);
        self.rules.push(Rule {
            direction: if direction > 0.0 {
                Direction::Rising
            } else if direction < 0.0 {
                Direction::Falling
            } else {
                Direction::Any
            },
            last,
            trigger: read_event(function, load, terms)?,
            has_passed: (function.getattr_opt("_is_at_start")?)
                .is_some_and(|given| given.is_truthy().unwrap_or(false)),
        });
        Ok(())
    }

    pub(crate) fn len(&self) -> usize {
        self.callables.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.callables.is_empty()
    }

    /// The function of number `event`; that of what happens to a contact has none.
    pub(crate) fn function(&self, event: usize) -> Option<&Py<PyAny>> {
        self.callables.get(event)
    }

    pub(crate) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        (self.callables.iter()).try_for_each(|function| visit.call(function))
    }

    pub(crate) fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            callables: self.callables.iter().map(|one| one.clone_ref(py)).collect(),
            rules: self.rules.clone(),
            terminal: self.terminal.clone(),
        }
    }

    /// Look for the same events under another load.
    pub(crate) fn aim(&mut self, py: Python<'_>, load: &PyLoad, terms: &[Term]) -> PyResult<()> {
        for (function, rule) in self.callables.iter().zip(&mut self.rules) {
            rule.trigger = read_event(function.bind(py), load, &[terms])?;
        }
        Ok(())
    }

    /// Look on in a run that goes on from the end of the last one, which has `found` these passages, the last of which has ended it if
    /// `is_over`. Passages are counted on; those of a function that has ended a run begin anew.
    pub(crate) fn go_on(&mut self, found: &[Crossing], is_over: bool) {
        let last = found.last().filter(|_| is_over).map(|last| last.event);
        for (event, rule) in self.rules.iter_mut().enumerate() {
            let passed = found.iter().filter(|one| one.event == event).count() as u64;
            rule.has_passed = last == Some(event);
            rule.last = match rule.last.checked_sub(passed) {
                Some(left) if left > 0 => left,
                _ => self.terminal[event],
            };
        }
    }

    /// The functions with the GIL to call them.
    pub(crate) fn with_callbacks<'a, 'py>(
        &'a self,
        py: Python<'py>,
        states: States<'a>,
    ) -> EventCalls<'a, 'py> {
        EventCalls {
            functions: self,
            py,
            states,
        }
    }
}

/// What an event looks for: its function, or what becomes of a wheel of the load.
fn read_event(
    event: &Bound<'_, PyAny>,
    load: &PyLoad,
    terms: &[&[Term]],
) -> PyResult<EventTrigger> {
    if let Some(number) = event
        .getattr_opt("_thruster")?
        .filter(|given| !given.is_none())
    {
        return read_pulse(event, number.extract()?, load);
    }
    let Some(of) = event
        .getattr_opt("_of_load")?
        .filter(|given| !given.is_none())
    else {
        return Ok(EventTrigger::Function);
    };
    let (kind, name): (String, String) = of.extract()?;
    if kind == "dipole limit" {
        let has_limit = |term: &Term| term.coils().is_some_and(Magnetic::has_limit);
        if terms.iter().any(|row| row.iter().any(has_limit)) {
            return Ok(EventTrigger::DipoleLimit);
        }
        return Err(PyValueError::new_err(
            "events: Event.dipole_limit asks for coils with a limit; give loads.magnetic(..., max_dipole=) in the load",
        ));
    }
    let slots = load.slots();
    let Some(slot) = slots.iter().find(|slot| *slot.name == *name) else {
        let known: Vec<_> = slots
            .iter()
            .map(|slot| format!("{:?}", slot.name))
            .collect();
        let known = if known.is_empty() {
            "nothing".to_owned()
        } else {
            known.join(", ")
        };
        return Err(PyValueError::new_err(format!(
            "events: Event.{} asks for the wheel {name:?}; the load carries {known}",
            kind.replace(' ', "_")
        )));
    };
    let (trigger, has, lack): (_, fn(&dyn CarriedMomentum) -> bool, _) = match kind.as_str() {
        "stop" => (EventTrigger::Stop(slot.first), has_bearing, "dry friction"),
        "breakaway" => (EventTrigger::Slip(slot.first), has_bearing, "dry friction"),
        "rate limit" => (
            EventTrigger::RateLimit(slot.first),
            |carried| carried.rate_limit().is_some(),
            "a largest rate, max_rate= or max_momentum=",
        ),
        "momentum limit" => (
            EventTrigger::RateLimit(slot.first),
            |carried| carried.rate_limit().is_some(),
            "a largest momentum, max_momentum= or max_rate=",
        ),
        _ => (
            EventTrigger::Limit(slot.first),
            |carried| carried.has_limit(),
            "a motor with a limit",
        ),
    };
    let is_able = |row: &&[Term]| {
        let mut index = 0;
        let mut all = row.iter().filter_map(Term::carried);
        all.any(|carried| {
            let is_it = index == slot.first && carried.count() > 0;
            index += carried.count();
            is_it && has(carried)
        })
    };
    if !terms.iter().any(is_able) {
        return Err(PyValueError::new_err(format!(
            "events: Event.{} asks for a wheel with {lack}, which {name:?} is not",
            kind.replace(' ', "_")
        )));
    }
    Ok(trigger)
}

/// The thruster of a load that an event asks for.
fn read_pulse(event: &Bound<'_, PyAny>, number: i64, load: &PyLoad) -> PyResult<EventTrigger> {
    let (_, name): (String, String) = event.getattr("_of_load")?.extract()?;
    let (slots, pulses) = (load.slots(), format!("{name}_pulse"));
    let find = |name: &str| slots.iter().find(|slot| *slot.name == *name);
    let (Some(slot), Some(_)) = (find(&name), find(&pulses)) else {
        return Err(PyValueError::new_err(format!(
            "events: Event.pulse asks for thrusters with the name {name:?}; the load has none, as loads.thrusters(..., name={name:?}) \
             makes them"
        )));
    };
    match usize::try_from(number) {
        Ok(number) if number < slot.count => Ok(EventTrigger::Pulse(slot.first + number)),
        _ => Err(PyValueError::new_err(format!(
            "events: Event.pulse asks for the thruster {number} of {name:?}, which has those from 0 to {}",
            slot.count - 1
        ))),
    }
}

fn has_bearing(carried: &dyn CarriedMomentum) -> bool {
    carried.bearing().is_some()
}

/// Functions that are called while a body is simulated.
pub(crate) struct EventCalls<'a, 'py> {
    functions: &'a Functions,
    py: Python<'py>,
    states: States<'a>,
}

/// The states of the load under which a body is simulated.
pub(crate) struct States<'a> {
    pub(crate) slots: &'a [Slot],
    pub(crate) terms: &'a [Term],
}

impl Events for EventCalls<'_, '_> {
    type Error = Fault;

    fn rules(&self) -> &[Rule] {
        &self.functions.rules
    }

    fn value(&mut self, event: usize, t: f64, phase: &Phase) -> Result<f64, Fault> {
        let array = |numbers: &[f64]| PyArray1::from_slice(self.py, numbers);
        let arguments = (
            t,
            array(phase.omega.as_slice()),
            array(&components(&phase.attitude)),
            array(phase.position.as_slice()),
            array(phase.velocity.as_slice()),
        );
        let value = || -> PyResult<f64> {
            let function = self.functions.callables[event].bind(self.py);
            let returned = if self.states.slots.is_empty() {
                function.call1(arguments)?
            } else {
                let States { slots, terms } = &self.states;
                let states = Named::of(slots, terms, phase).dict(self.py)?;
                let (t, omega, quaternion, position, velocity) = arguments;
                function.call1((t, omega, quaternion, position, velocity, states))?
            };
            returned.extract().map_err(|_| {
                PyTypeError::new_err(format!(
                    "events: event {event} must return a number, got {}",
                    returned.get_type()
                ))
            })
        };
        value().map_err(Fault::Python)
    }
}
