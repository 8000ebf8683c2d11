//! What a run gives, and which passages through zero it looks for.

use super::task::Task;
use crate::error::Error;
use crate::motion::rolling::ContactPhase;
use crate::motion::state::Phase;

/// What an integration took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Accepted steps.
    pub steps: u64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End<E> {
    /// At the last time.
    Complete,
    /// At an event that ends it.
    Event,
    /// At what happens to the contact of a body on a plane.
    Contact(ContactEvent),
    /// Where the watch asked for it.
    Stopped,
    /// Where the equations or the load failed.
    Failed(E),
}

/// What a run gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<E> {
    /// The states at the times that it came to, in their order: as many as there are times where it is complete.
    pub samples: Vec<Phase>,
    /// The passages through zero, in the order of the run.
    pub crossings: Vec<Crossing>,
    /// What it took.
    pub effort: Effort,
    /// The time it came to.
    pub time: f64,
    /// The state then.
    pub phase: Phase,
    /// How it ended.
    pub end: End<E>,
    /// What a contact came to, of a body on a plane.
    pub contact: Option<ContactExtremes>,
    /// What such a body did at each of the samples.
    pub contact_phases: Vec<ContactPhase>,
}

/// What happens to a contact: its number stands in [`Crossing::event`] after those of the functions.
///
/// # Examples
///
/// ```
/// use polhode::motion::simulate::ContactEvent;
///
/// let words = ContactEvent::ALL.map(ContactEvent::word);
/// assert_eq!(words, ["lift-off", "slip", "roll", "landing", "rest"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEvent {
    /// The normal force falls through zero.
    LiftOff,
    /// A body that rolled begins to slip.
    Slip,
    /// The slip ceases.
    Roll,
    /// A body that has lifted off touches again.
    Landing,
    /// A body whose resistance to rolling has an arm ceases to turn, but for its pivoting.
    Rest,
}

impl ContactEvent {
    /// In the order of their numbers.
    pub const ALL: [Self; 5] = [
        Self::LiftOff,
        Self::Slip,
        Self::Roll,
        Self::Landing,
        Self::Rest,
    ];

    /// Return its word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::LiftOff => "lift-off",
            Self::Slip => "slip",
            Self::Roll => "roll",
            Self::Landing => "landing",
            Self::Rest => "rest",
        }
    }
}

/// The extremes of a contact over a whole run, located between the outputs: each a value and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactExtremes {
    /// The largest ratio of the force across the normal to that along it.
    pub friction_needed: [f64; 2],
    /// The smallest force along the normal.
    pub normal_force: [f64; 2],
}

impl<E> Run<E> {
    /// One that has come no further than the first time.
    pub(crate) fn at_start(task: &Task<'_>, end: End<E>) -> Self {
        // Room for all of them, but none is written before it is known: to fill many pages takes longer than Ctrl-C may.
        let mut samples = Vec::with_capacity(task.times.len());
        samples.extend(task.times.first().map(|_| task.initial.clone()));
        Self {
            samples,
            crossings: Vec::new(),
            effort: Effort::default(),
            time: task.times.first().copied().unwrap_or(f64::NAN),
            phase: task.initial.clone(),
            end,
            contact: None,
            contact_phases: Vec::new(),
        }
    }

    /// The run, where it came to its end: at the last time, at an event that ends it, or where a contact ends.
    ///
    /// # Errors
    /// What failed, or [`Error::Stopped`] where the watch stopped it. Who wants the states until then looks at [`Self::end`] instead.
    pub fn into_result(self) -> Result<Self, E>
    where
        E: From<Error>,
    {
        match self.end {
            End::Complete | End::Event | End::Contact(_) => Ok(self),
            End::Stopped => Err(Error::Stopped.into()),
            End::Failed(error) => Err(error),
        }
    }

    /// The same run, its error through `f`.
    #[must_use]
    pub fn with_error<F>(self, f: impl FnOnce(E) -> F) -> Run<F> {
        Run {
            samples: self.samples,
            crossings: self.crossings,
            effort: self.effort,
            time: self.time,
            phase: self.phase,
            end: match self.end {
                End::Complete => End::Complete,
                End::Event => End::Event,
                End::Contact(event) => End::Contact(event),
                End::Stopped => End::Stopped,
                End::Failed(error) => End::Failed(f(error)),
            },
            contact: self.contact,
            contact_phases: self.contact_phases,
        }
    }
}

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
pub enum EventTrigger {
    /// The passages of a function through zero.
    #[default]
    Function,
    /// The wheel whose momentum is the state of the load of that number comes to rest in its bearing.
    Stop(usize),
    /// It begins to turn.
    Slip(usize),
    /// What its motor is asked for comes to the most that it can, or back from there.
    Limit(usize),
    /// It comes to the limit of its rate (rising), or leaves it (falling).
    RateLimit(usize),
    /// What the coils of the load with a limit are asked for comes to the most that they can, or back from there.
    DipoleLimit,
    /// The thruster whose impulse is the state of the load of that number is switched on (rising) or off (falling).
    Pulse(usize),
}

impl EventTrigger {
    /// Whether it is searched for within steps. The load tells the others.
    pub(in crate::motion) fn is_searched(self) -> bool {
        matches!(self, Self::Function | Self::Limit(_) | Self::DipoleLimit)
    }
}

/// What to do with the passages of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rule {
    /// Which of them count.
    pub direction: Direction,
    /// The run ends at the passage of this number; 0 for never.
    pub last: u64,
    /// Of what.
    pub trigger: EventTrigger,
    /// Whether the run begins at such a passage, at which the one before ended: it does not count again.
    pub has_passed: bool,
}

/// A passage through zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The number of the function, or after these that of a [`ContactEvent`].
    pub event: usize,
    /// When.
    pub time: f64,
    /// The state then.
    pub phase: Phase,
}
