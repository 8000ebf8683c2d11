//! One motion as the driver needs it: in principal axes, in a unit of time of its own, from break to break of its load.

mod equations;
mod segments;
mod state;
mod times;

pub(super) use equations::parts;
pub(super) use segments::Course;
