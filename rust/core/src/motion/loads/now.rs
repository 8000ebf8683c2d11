//! When and in which state a law is asked.

use super::body_at_point::BodyAtPoint;
use crate::motion::state::Phase;

/// When, on what and in which state a law acts within a run.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// What it acts on.
    pub body: &'a BodyAtPoint,
    /// The time.
    pub t: f64,
    /// A time within the span under way, which has no breaks.
    pub middle: f64,
    /// The state.
    pub phase: &'a Phase,
    /// The sign that a law with one is taken for.
    pub side: f64,
}
