//! Events: the times at which a function of time and state passes through zero.

use super::stepper::Dense;
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

/// Functions whose passages through zero are events.
pub trait Events {
    /// As of the load.
    type Error;

    /// One rule for each function.
    fn rules(&self) -> &[Rule];

    /// The function of number `event` at time `t`.
    ///
    /// # Errors
    /// Ends the run and comes back to the caller as it is.
    fn value(&mut self, event: usize, t: f64, phase: &Phase) -> Result<f64, Self::Error>;
}

/// No events.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoEvents<E>(std::marker::PhantomData<E>);

impl<E> NoEvents<E> {
    /// None of them.
    #[must_use]
    pub fn new() -> Self {
        Self(std::marker::PhantomData)
    }
}

impl<E> Events for NoEvents<E> {
    type Error = E;

    fn rules(&self) -> &[Rule] {
        &[]
    }

    fn value(&mut self, _: usize, _: f64, _: &Phase) -> Result<f64, E> {
        Ok(f64::NAN)
    }
}

/// A passage through zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The number of the function.
    pub event: usize,
    /// When.
    pub time: f64,
    /// The state then.
    pub phase: Phase,
}

/// The functions as a run goes on.
pub(super) struct Lookout<'a, E> {
    events: &'a mut dyn Events<Error = E>,
    rules: Vec<Rule>,
    /// The sign each function had when it was last not zero, and zero after it was found at zero.
    signs: Vec<f64>,
    counts: Vec<u64>,
    /// Whether the run goes forward in time.
    forward: bool,
    pub(super) crossings: Vec<Crossing>,
}

impl<'a, E> Lookout<'a, E> {
    pub(super) fn new(
        events: &'a mut dyn Events<Error = E>,
        t: f64,
        phase: &Phase,
        forward: bool,
    ) -> Result<Self, E> {
        let rules = events.rules().to_vec();
        let signs = (0..rules.len())
            .map(|event| Ok(sign(events.value(event, t, phase)?)))
            .collect::<Result<_, E>>()?;
        let counts = vec![0; rules.len()];
        Ok(Self {
            events,
            rules,
            signs,
            counts,
            forward,
            crossings: Vec::new(),
        })
    }

    /// Looks through the last step, which began at `from`; where the run is to end, if it is, as time since the span's
    /// start and the state there. A function that passes through zero twice within one of the step's parts is not seen to.
    pub(super) fn look(
        &mut self,
        stepper: &mut dyn Dense<Error = E>,
        start: f64,
        from: f64,
    ) -> Result<Option<(f64, Phase)>, E> {
        if self.rules.is_empty() {
            return Ok(None);
        }
        let (to, parts) = (stepper.elapsed(), stepper.parts());
        let mut before = from;
        for part in 1..=parts {
            let (after, phase) = if part == parts {
                (to, stepper.phase())
            } else {
                let after = from + (to - from) * (f64::from(part) / f64::from(parts));
                (after, stepper.within(after)?)
            };
            let mut found = Vec::new();
            for event in 0..self.rules.len() {
                let value = self.events.value(event, start + after, &phase)?;
                let (was, is) = (self.signs[event], sign(value));
                if was * is > 0.0 || was == 0.0 {
                    self.signs[event] = if was == 0.0 { is } else { was };
                    continue;
                }
                if is.is_nan() || was.is_nan() {
                    self.signs[event] = is;
                    continue;
                }
                self.signs[event] = is;
                let rising = (was < 0.0) == self.forward;
                let counts = match self.rules[event].direction {
                    Direction::Any => true,
                    Direction::Rising => rising,
                    Direction::Falling => !rising,
                };
                if !counts {
                    continue;
                }
                let place = if is == 0.0 {
                    after
                } else {
                    self.locate(event, stepper, start, [before, after], was)?
                };
                found.push((place, event));
            }
            found.sort_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()));
            for (place, event) in found {
                let phase = if place == to {
                    stepper.phase()
                } else {
                    stepper.within(place)?
                };
                self.crossings.push(Crossing {
                    event,
                    time: start + place,
                    phase,
                });
                self.counts[event] += 1;
                if self.counts[event] == self.rules[event].last {
                    return Ok(Some((place, phase)));
                }
            }
            before = after;
        }
        Ok(None)
    }

    /// The zero in a bracket, at whose start the function has the sign `was`, to the last digit of the time: by Ridders'
    /// method, which halves the bracket at least.
    fn locate(
        &mut self,
        event: usize,
        stepper: &mut dyn Dense<Error = E>,
        start: f64,
        [mut low, mut high]: [f64; 2],
        was: f64,
    ) -> Result<f64, E> {
        let mut value = |x: f64, stepper: &mut dyn Dense<Error = E>| {
            let phase = stepper.within(x)?;
            self.events.value(event, start + x, &phase)
        };
        let (mut f_low, mut f_high) = (value(low, stepper)?, value(high, stepper)?);
        // The dense output may differ from the step's end in the last digits, and so in sign.
        if sign(f_low) != was {
            return Ok(low);
        }
        if sign(f_high) == was {
            return Ok(high);
        }
        loop {
            let middle = low + 0.5 * (high - low);
            if middle == low || middle == high || start + low == start + high {
                return Ok(if f_low.abs() < f_high.abs() {
                    low
                } else {
                    high
                });
            }
            let f_middle = value(middle, stepper)?;
            let radical = (f_middle * f_middle - f_low * f_high).sqrt();
            let guess = middle + (middle - low) * (was * f_middle / radical);
            // A bracket on both sides of the guess, where it is a number.
            let mut points = [(middle, f_middle), (middle, f_middle)];
            if guess.is_finite() && guess != middle && (guess - low) * (guess - high) < 0.0 {
                points[1] = (guess, value(guess, stepper)?);
            }
            for (x, f) in points {
                if f == 0.0 {
                    return Ok(x);
                }
                if (x - low) * (x - high) < 0.0 {
                    if sign(f) == was {
                        (low, f_low) = (x, f);
                    } else {
                        (high, f_high) = (x, f);
                    }
                }
            }
            if f_middle.is_nan() {
                return Ok(middle);
            }
        }
    }
}

/// −1, 0 or 1, or NaN.
fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}
