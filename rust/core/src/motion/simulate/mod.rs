//! The motion of a body under a load, sampled at the times asked for.
//!
//! A [`Task`] says what is wanted, a [`Run`] what was found; `choose` says which method serves. Methods of steps go through
//! spans of time in which the load is smooth (`steps`): `stepper` is what a run needs of a method, `begin` makes one, and
//! `equations` is what Runge-Kutta methods see of the mechanics. [`events`] says what is looked for, `lookout` looks through a
//! step with `along`, and `flips` finds where a load changes its law with the state.

mod along;
mod begin;
mod choose;
mod equations;
pub mod events;
mod exact;
mod flips;
mod kicked;
mod lookout;
mod one;
mod solved;
mod stepper;
mod steps;
mod summed;

pub use self::choose::closed_top;
pub use self::events::{Events, NoEvents};
pub use self::one::simulate;
pub use super::problem::{
    Crossing, Direction, Effort, End, Footing, MOST_STEPS, Method, Rule, Run, TIGHTEST,
    TIGHTEST_TWOFOLD, Task, Tolerance, check_scales, check_times,
};
pub use super::state::{Phase, State};
