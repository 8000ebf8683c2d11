//! What is asked of a method, and what it gives: plain data that steppers and runs share.
//!
//! | what | file |
//! |---|---|
//! | what is to be simulated, by which method and how accurately | `task` |
//! | which runs are refused | `limits` |
//! | what a run looks for and what it gives | `outcome` |

pub(in crate::motion) mod limits;
mod outcome;
mod task;

pub use self::limits::{MOST_STEPS, check_scales, check_times};
pub use self::outcome::{
    ContactEvent, ContactExtremes, Crossing, Direction, Effort, End, EventTrigger, Rule, Run,
};
pub use self::task::{Method, ReferencePoint, TIGHTEST, TIGHTEST_TWOFOLD, Task, Tolerance};
