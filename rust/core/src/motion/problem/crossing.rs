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

/// What is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Watched {
    /// The passages of a function through zero.
    #[default]
    Function,
    /// The wheel whose momentum is the state of the load of that number comes to rest in its bearing.
    Stop(usize),
    /// It begins to turn.
    Slip(usize),
    /// What its motor is asked for comes to the most that it can, or back from there.
    Limit(usize),
}

/// What to do with the passages of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rule {
    /// Which of them count.
    pub direction: Direction,
    /// The run ends at the passage of this number; 0 for never.
    pub last: u64,
    /// Of what.
    pub watched: Watched,
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
