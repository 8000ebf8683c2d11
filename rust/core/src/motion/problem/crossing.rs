//! Passages through zero: which count, and what is known of one.

use crate::motion::state::Phase;

/// Which passages through zero count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// All.
    #[default]
    Any,
    /// From below, forward in time.
    Rising,
    /// From above, forward in time.
    Falling,
}

/// What to do with the passages of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rule {
    /// Which of them count.
    pub direction: Direction,
    /// The run ends at the passage of this number; 0 for never.
    pub last: u64,
}

/// A passage through zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The number of the function.
    pub event: usize,
    /// When.
    pub time: f64,
    /// The state then.
    pub phase: Phase,
}
