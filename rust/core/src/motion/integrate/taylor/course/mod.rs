//! One motion as the driver needs it: in principal axes, in a unit of time of its own, from break to break of its load.
//!
//! | what | file |
//! |---|---|
//! | from break to break, and what acts between two of them | `segments` |
//! | the unit of rates of a segment, and its equations | `equations` |
//! | states in units of the run and in real ones | `state` |
//! | times in either | `times` |

mod equations;
mod segments;
mod state;
mod times;

pub(super) use equations::parts;
pub(super) use segments::PiecewiseEquations;
pub(super) use state::AuxiliaryState;
