//! What is asked of a method, and what it gives: plain data that steppers and runs share.
//!
//! | what | file |
//! |---|---|
//! | what is to be simulated, and how | `task` |
//! | the methods by name | `method` |
//! | how accurate it is to be | `tolerance` |
//! | which runs are refused | `limits` |
//! | passages through zero | `crossing` |
//! | what a run gives | `outcome` |

mod crossing;
pub(in crate::motion) mod limits;
mod method;
mod outcome;
mod task;
mod tolerance;

pub use self::crossing::{Crossing, Direction, Rule, Watched};
pub use self::limits::{MOST_STEPS, check_scales, check_times};
pub use self::method::Method;
pub use self::outcome::{Effort, End, Run};
pub use self::task::{ReferencePoint, Task};
pub use self::tolerance::{TIGHTEST, TIGHTEST_TWOFOLD, Tolerance};
