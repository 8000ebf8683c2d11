//! Runs motions to their last output time, `R` at a time, each with its own steps.
//!
//! | file | what it knows |
//! |---|---|
//! | `lanes` | motions side by side: states, times, what each comes to next |
//! | `run` | until all motions are done |
//! | `stepping` | one step of every motion |
//! | `search` | where within a step the law of a motion changes |
//! | `stops` | outputs, breaks, changes of law |
//! | `entering` | a motion into a lane, its unit, its end |
//! | `shown` | each step as it is made, for events |
//! | `settings` | the order of the series and the size of their last terms |

mod entering;
mod lanes;
mod run;
mod search;
mod settings;
mod shown;
mod stepping;
mod stops;

pub(super) use lanes::{Job, SampleSink};
pub(super) use run::drive;
pub(super) use settings::Settings;
pub(super) use shown::Observer;
pub(crate) use shown::Step;
