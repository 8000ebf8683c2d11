//! The motion of a body under a load, sampled at the times asked for.
//!
//! A [`Task`] says what is wanted, a [`Run`] what was found.
//!
//! | what | file |
//! |---|---|
//! | which method serves; what all motions of a stack have in common | `choose`, `plan` |
//! | one motion; many, on as many cores as may take part | `one`, `many` |
//! | bodies and tops in closed form | `exact` |
//! | methods of steps, through spans of time in which the load is smooth | `steps` |
//! | what a run needs of such a method; the one place that makes it | `stepper`, `begin` |
//! | the methods: Runge-Kutta, splitting, Taylor series looked through as they are summed | `solved`, `kicked`, `summed` |
//! | what Runge-Kutta methods see of the mechanics | `equations` |
//! | what is looked for, and the look through a step | [`events`], `lookout`, `along` |
//! | where a load changes its law with the state | `flips` |

mod along;
mod begin;
mod choose;
mod equations;
pub mod events;
mod exact;
mod flips;
mod kicked;
mod lookout;
mod many;
mod one;
mod plan;
mod solved;
mod stepper;
mod steps;
mod summed;

pub use self::choose::most_demanding;
pub use self::events::{Events, NoEvents};
pub use self::many::{Calls, Row, Rows, simulate_many};
pub use self::one::simulate;
pub use self::plan::{Ask, Plan, Refusal};
pub use super::problem::{
    Crossing, Direction, Effort, End, Footing, MOST_STEPS, Method, Rule, Run, TIGHTEST,
    TIGHTEST_TWOFOLD, Task, Tolerance, Watched, check_scales, check_times,
};
pub use super::state::{Phase, State};
