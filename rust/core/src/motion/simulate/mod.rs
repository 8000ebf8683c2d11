//! The motion of a body under a load, sampled at the times asked for.
//!
//! A [`Task`] says what is wanted, a [`Run`] what was found.
//!
//! | what | file |
//! |---|---|
//! | which method serves; what all motions of a stack have in common | `plan` |
//! | one motion; many, on as many cores as may take part | `runs` |
//! | a motion that goes on run by run | `chain` |
//! | the loop over the steps, through spans of time in which the load is smooth | `run_loop` |
//! | what a run needs of a method of steps | `stepper` |
//! | the methods: Runge-Kutta, splitting, Taylor series with events | `runge_kutta_run`, `splitting_run`, `taylor_run_with_events` |
//! | bodies and tops in closed form | `closed_form_run` |
//! | a body that rolls on a plane | `rolling_run` |
//! | the search for events | [`events`] |
//! | all zeros of a function within a step | `roots_in_step` |
//! | where a load changes its law with the state | `law_switches` |
//!
//! # Examples
//!
//! ```
//! use std::ops::ControlFlow;
//! use polhode::mass::{Amount, solids};
//! use polhode::motion::loads::{Callback, CarriedMomentum, BodyAtPoint, Term};
//! use polhode::motion::simulate::{
//!     Crossing, Direction, End, Events, ReferencePoint, MOST_STEPS, Method, Phase, Rule, Run, State, TIGHTEST, TIGHTEST_TWOFOLD, Task,
//!     Tolerance, EventTrigger, check_scales, simulate,
//! };
//! use polhode::nalgebra::{UnitQuaternion, Vector3};
//!
//! /// The second time at which the tip is lowest ends the run.
//! struct Lowest;
//!
//! impl Events for Lowest {
//!     type Error = polhode::Error;
//!
//!     fn rules(&self) -> &[Rule] {
//!         &[Rule { direction: Direction::Rising, last: 2, trigger: EventTrigger::Function, has_passed: false }]
//!     }
//!
//!     fn value(&mut self, _: usize, _: f64, phase: &Phase) -> Result<f64, Self::Error> {
//!         Ok((phase.attitude * phase.omega.cross(&-Vector3::z())).z)
//!     }
//! }
//!
//! // A rod of 1 m that swings about its end: the origin of its frame is fixed.
//! let rod = solids::cuboid(&[0.0, 0.0, 1.0], Amount::Mass(2.0))?.translated(&Vector3::new(0.0, 0.0, -0.5))?;
//! let tilted = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.01);
//! let start = Phase::in_place(&State { attitude: tilted, omega: Vector3::zeros() });
//! let tolerance = Tolerance::new(1e-12, 0.0)?.within(10_000);
//! assert!(tolerance.most_steps < MOST_STEPS && tolerance.relative > TIGHTEST);
//! let times = [0.0, 100.0];
//! check_scales(&rod, true, &times)?;
//! let reference_point = ReferencePoint::pivoted(&rod, times[0]);
//! assert_eq!(reference_point.body_at_point, BodyAtPoint::pivoted(&rod, 0.0));
//! let task: Task = Task::about(&reference_point, &rod, start, &times, Method::Auto, tolerance);
//! assert!(Tolerance::new(1e-20, 0.0)?.is_beyond_doubles() && Tolerance::new(0.5 * TIGHTEST_TWOFOLD, 0.0).is_err());
//!
//! let weight = |_: f64, phase: &Phase| {
//!     let pull = phase.attitude.inverse() * Vector3::new(0.0, 0.0, -2.0 * 9.81);
//!     Ok::<_, polhode::Error>(Vector3::new(0.0, 0.0, -0.5).cross(&pull))
//! };
//! let go_on = &mut |_| ControlFlow::Continue(());
//! let run: Run<polhode::Error> = simulate(&task, &mut Callback::torque(weight), &mut Lowest, go_on);
//! assert_eq!(run.end, End::Event);
//! let Crossing { time: first, .. } = run.crossings[0];
//! let Crossing { time: second, .. } = run.crossings[1];
//! let half = std::f64::consts::PI * (2.0 / 3.0 / 9.81_f64).sqrt(); // π √(2l/3g)
//! assert!(((second - first) / half - 1.0).abs() < 1e-4);
//!
//! // Another error, as of a caller's own type; and a task whose load carries something along.
//! assert_eq!(run.with_error(|error| error.to_string()).end, End::Event);
//! let slug = Term::Slug(polhode::motion::loads::Slug::new(0.01, 0.1)?);
//! let carried: Option<&dyn CarriedMomentum> = slug.carried();
//! assert_eq!(task.with_carried(carried.into_iter())?.initial.internal_state.len(), 3);
//! # Ok::<(), polhode::Error>(())
//! ```

mod chain;
mod closed_form_run;
pub mod events;
mod law_switches;
mod plan;
mod rolling_run;
mod roots_in_step;
mod run_loop;
mod runge_kutta_run;
mod runs;
mod splitting_run;
mod stepper;
mod taylor_run_with_events;

pub use self::chain::Chain;
pub use self::events::{Events, NoEvents};
pub use self::plan::{Ask, Plan, Refusal, gravity_alone, most_demanding};
pub use self::runs::{Batch, CallbackPolicy, Member, roll, simulate, simulate_many};
pub use super::problem::{
    ContactEvent, ContactExtremes, Crossing, Direction, Effort, End, EventTrigger, MOST_STEPS,
    Method, ReferencePoint, Rule, Run, TIGHTEST, TIGHTEST_TWOFOLD, Task, Tolerance, check_scales,
    check_times,
};
pub use super::state::{Phase, State};
