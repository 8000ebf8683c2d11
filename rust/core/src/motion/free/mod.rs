//! The motion of a body on which nothing acts.
//!
//! | idea | file |
//! |---|---|
//! | the six modes | `mode` |
//! | what stays constant | `invariants` |
//! | periods and mean precession | `periods` |
//! | the motion with two given periods | `from_periods` |
//! | the curve of ω in the body | `polhode` |
//! | nutation, body cone, space cone | `nutation` |
//! | the rolling ellipsoid | `poinsot` |
//! | derivatives by initial state and moments | `sensitivity`, on `clock` |
//! | error bars | `conditioning` |

mod clock;
mod conditioning;
mod from_periods;
mod invariants;
mod mode;
mod nutation;
mod periods;
mod poinsot;
mod polhode;
mod sensitivity;

pub use conditioning::ErrorBar;
pub use from_periods::{Circled, FromPeriods, attitude_about};
pub use invariants::Invariants;
pub use mode::Mode;
pub use nutation::Cones;
pub use periods::Periods;
pub use poinsot::Poinsot;
pub use sensitivity::Sensitivity;
