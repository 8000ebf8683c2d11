//! Events: Python functions whose passages through zero are looked for.

use numpy::PyArray1;
use polhode::motion::attitude::components;
use polhode::motion::loads::Term;
use polhode::motion::simulate::{Direction, Events, Rule};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::loads::{Fault, Named, Slot};

/// The functions of an argument `events`.
#[derive(Default)]
pub(crate) struct Functions {
    functions: Vec<Py<PyAny>>,
    rules: Vec<Rule>,
}

impl Functions {
    /// One function or a sequence of them; attributes `direction` and `terminal` as in SciPy.
    pub(crate) fn read(events: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let mut all = Self::default();
        let Some(events) = events.filter(|events| !events.is_none()) else {
            return Ok(all);
        };
        if events.is_callable() {
            all.push(events)?;
            return Ok(all);
        }
        let items = events.try_iter().map_err(|_| {
            PyTypeError::new_err(format!(
                "events: expected a function or a sequence of them, got {}",
                events.get_type()
            ))
        })?;
        for item in items {
            all.push(&item?)?;
        }
        Ok(all)
    }

    fn push(&mut self, function: &Bound<'_, PyAny>) -> PyResult<()> {
        let number = self.functions.len();
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
        self.functions.push(function.clone().unbind());
        self.rules.push(Rule {
            direction: if direction > 0.0 {
                Direction::Rising
            } else if direction < 0.0 {
                Direction::Falling
            } else {
                Direction::Any
            },
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "checked above to be a count"
            )]
            last: terminal as u64,
        });
        Ok(())
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// The functions with the GIL to call them.
    pub(crate) fn calling<'a, 'py>(
        &'a self,
        py: Python<'py>,
        states: States<'a>,
    ) -> Calling<'a, 'py> {
        Calling {
            functions: self,
            py,
            states,
        }
    }
}

/// Functions that are called while a body is simulated.
pub(crate) struct Calling<'a, 'py> {
    functions: &'a Functions,
    py: Python<'py>,
    states: States<'a>,
}

/// The states of the load under which a body is simulated.
pub(crate) struct States<'a> {
    pub(crate) slots: Vec<Slot>,
    pub(crate) terms: &'a [Term],
}

impl Events for Calling<'_, '_> {
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
            let function = self.functions.functions[event].bind(self.py);
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
