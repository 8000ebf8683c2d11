//! A run of `simulate`: every row integrated, on all cores without the GIL or one by one when Python is called.

use std::ops::ControlFlow;

use nalgebra::{UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::integrate::taylor;
use polhode::motion::loads::Term;
use polhode::motion::simulate::{
    End, Events, Footing, Method, NoEvents, Run, Task, Tolerance, simulate,
};
use polhode::motion::state::Phase;
use polhode::numerics::threads::fill_blocks;
use pyo3::prelude::*;

use crate::body::PyRigidBody;
use crate::errors::{at_row, to_py};
use crate::events::Functions;
use crate::interrupt::{Beat, Interrupt};
use crate::loads::{Acting, Cause, Fault, PyLoad};
use crate::memory;
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
}

impl Start<'_> {
    pub(super) fn grid(&self) -> PyResult<Broadcast<'static, 6>> {
        Broadcast::of(
            ["body", "omega", "attitude", "position", "velocity", "load"],
            [
                &self.bodies.shape,
                &self.omega.shape,
                &self.attitude.shape,
                &self.position.shape,
                &self.velocity.shape,
                &self.terms.shape,
            ],
        )
    }
}

/// That of a body for motions from the first of `times` on.
pub(super) fn footing(body: &RigidBody, times: &[f64], pivoted: bool) -> Footing {
    if pivoted {
        Footing::pivoted(body, times[0])
    } else {
        Footing::free(body, times[0])
    }
}

/// All that a run needs.
pub(super) struct Ensemble<'a> {
    pub(super) start: &'a Start<'a>,
    pub(super) grid: Broadcast<'a, 6>,
    /// Of the body, where there is one alone.
    pub(super) footing: Option<Footing>,
    pub(super) times: &'a [f64],
    pub(super) pivoted: bool,
    pub(super) method: Method,
    pub(super) tolerance: Tolerance,
    pub(super) load: &'a PyLoad,
    pub(super) events: &'a Functions,
    /// Whether the first row that fails ends the run.
    pub(super) raises: bool,
}

/// One run for each row, as far as they were begun.
pub(super) type Runs<E> = Vec<Option<Run<E>>>;

/// The results as a `polhode.Trajectory`, and whether a row failed.
pub(super) type Results<'py> = PyResult<(Bound<'py, PyAny>, bool)>;

impl Ensemble<'_> {
    /// Every state at the start must be finite.
    pub(super) fn check(&self, py: Python<'_>) -> PyResult<()> {
        for (name, stack) in [
            ("omega", &self.start.omega),
            ("position", &self.start.position),
            ("velocity", &self.start.velocity),
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

    /// Integrates every row: on all cores without the GIL, or one by one attached when Python is called.
    ///
    /// # Errors
    /// The user's own exceptions, and those that do not concern the integration where `raises`.
    pub(super) fn run<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyRigidBody>,
        load: Option<&Bound<'py, PyAny>>,
        interrupt: &Interrupt,
    ) -> Results<'py> {
        if self.load.calls_python() || !self.events.is_empty() {
            self.results(py, body, load, self.attached(py, interrupt)?, interrupt)
        } else if self.method == Method::Taylor {
            self.results(py, body, load, self.abreast(py, interrupt)?, interrupt)
        } else {
            self.results(py, body, load, self.detached(py, interrupt)?, interrupt)
        }
    }

    fn results<'py, E: Cause>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyRigidBody>,
        load: Option<&Bound<'py, PyAny>>,
        runs: Runs<E>,
        interrupt: &Interrupt,
    ) -> Results<'py> {
        for (row, run) in runs.iter().enumerate() {
            if let Some(Run {
                end: End::Failed(cause),
                ..
            }) = run
            {
                if cause.is_of_the_user() {
                    return Err(cause.to_exception(py));
                }
                if self.raises && !cause.is_of_integration() {
                    let error = cause.to_exception(py);
                    return Err(at_row(&self.grid.shape, row, &error, py));
                }
            }
        }
        self.trajectory(py, body, load, runs, interrupt)
    }

    /// As many as there are rows, none of them begun, and room for their states and the arrays of these.
    fn none_yet<E>(&self, py: Python<'_>) -> PyResult<Runs<E>> {
        let numbers = size_of::<Phase>().saturating_mul(2 * self.times.len());
        let what = "simulate: rows of the stack times output times";
        let states = [&self.grid.shape[..], &[self.times.len()]].concat();
        memory::room(what, &states, 2 * size_of::<Phase>())?;
        let each = numbers.saturating_add(size_of::<Option<Run<E>>>());
        let count = memory::room(what, &self.grid.shape, each)?;
        let mut runs = memory::vector(what, &self.grid.shape, 0)?;
        let mut beat = Beat::new(py);
        while runs.len() < count {
            beat.mark()?;
            runs.resize_with(count.min(runs.len() + BLOCK), || None);
        }
        Ok(runs)
    }

    /// Every row, one by one, with Python at hand.
    fn attached(&self, py: Python<'_>, interrupt: &Interrupt) -> PyResult<Runs<Fault>> {
        let count = self.grid.len();
        let mut runs = self.none_yet::<Fault>(py)?;
        for (row, slot) in runs.iter_mut().enumerate() {
            let watch = |part: f64| interrupt.poll(Some((row as f64 + part) / count as f64));
            let run = self.one(row, Some(py), &mut self.events.calling(py), watch);
            let over = self.ends_all(&run);
            *slot = Some(run);
            if over {
                break;
            }
        }
        Ok(runs)
    }

    /// Every row by itself, on all cores.
    fn detached(&self, py: Python<'_>, interrupt: &Interrupt) -> PyResult<Runs<Fault>> {
        let count = self.grid.len();
        let mut runs = self.none_yet::<Fault>(py)?;
        let fraction = |of_row: f64| (count == 1).then_some(of_row);
        // Where a run ends all, the rows begun so far are kept.
        let _ended = py.detach(|| {
            let mut watch = |done| interrupt.poll(Some(done));
            fill_blocks(&mut runs, 1, &mut watch, |row, out| {
                let watch = |part| interrupt.poll(fraction(part));
                let run = self.one(row, None, &mut NoEvents::new(), watch);
                let over = self.ends_all(&run);
                out[0] = Some(run);
                if over { Err(()) } else { Ok(()) }
            })
        });
        Ok(runs)
    }

    /// Every row by Taylor series, eight side by side.
    fn abreast(&self, py: Python<'_>, interrupt: &Interrupt) -> PyResult<Runs<polhode::Error>> {
        let count = self.grid.len();
        let mut runs = self.none_yet::<polhode::Error>(py)?;
        py.detach(|| {
            if count == 1 {
                let mut watch = |part| interrupt.poll(Some(part));
                let run = taylor::solve_one(&self.task(0), self.terms(0), &mut watch);
                runs[0] = Some(run);
            } else {
                let poll = |begun| interrupt.poll(Some(begun));
                let (task, terms) = (|row| self.task(row), |row| self.terms(row));
                taylor::solve_many(&task, &terms, &mut runs, &poll);
            }
        });
        Ok(runs)
    }

    fn ends_all(&self, run: &Run<Fault>) -> bool {
        match &run.end {
            End::Stopped | End::Failed(Fault::Python(_)) => true,
            End::Failed(Fault::Core(_)) => self.raises,
            End::Complete | End::Event => false,
        }
    }

    fn one(
        &self,
        row: usize,
        py: Option<Python<'_>>,
        events: &mut dyn Events<Error = Fault>,
        mut watch: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Run<Fault> {
        let task = self.task(row);
        let mut load = Acting::new(self.load, self.terms(row), task.subject, py);
        simulate(&task, &mut load, events, &mut watch)
    }

    /// The analytic terms of the load in a row.
    fn terms(&self, row: usize) -> &[Term] {
        let [.., l] = self.grid.operands(row);
        &self.start.terms[l]
    }

    /// What is to be simulated in a row.
    fn task(&self, row: usize) -> Task<'_> {
        let [b, w, q, r, v, _] = self.grid.operands(row);
        let given = self.start.attitude[q];
        let is_exact =
            self.method == Method::Exact && self.pivoted || self.tolerance.is_beyond_doubles();
        let initial = Phase {
            attitude: if is_exact {
                given
            } else {
                UnitQuaternion::new_normalize(given.into_inner())
            },
            omega: self.start.omega[w],
            position: self.start.position[r],
            velocity: self.start.velocity[v],
        };
        let body = &self.start.bodies[b];
        let footing = match &self.footing {
            Some(footing) => footing,
            None => &footing(body, self.times, self.pivoted),
        };
        Task::on(
            footing,
            body,
            initial,
            self.times,
            self.method,
            self.tolerance,
        )
    }
}
