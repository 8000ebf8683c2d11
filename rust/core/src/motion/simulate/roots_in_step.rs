//! All passages of a function of time and state through zero within a step.
//!
//! In each part of a step the function is looked at where Chebyshev polynomials are interpolated. It counts as resolved when the last
//! coefficients of its polynomial are small and when it agrees with the polynomial where that has its extremes, or, where there
//! are none, at one place more: values that a fast function has by chance at the Chebyshev points pass the first test now and then, and
//! not the second. Between two of these looks a resolved function rises or falls all the way, so that each passage shows in
//! the signs, also where two are close together. Where it is not resolved the part is halved, until it is, or until the time has no digits
//! left: there the function jumps. There is a limit to the looks at halved parts in a run; beyond it the run ends with an error.

use std::ops::ControlFlow;

use super::stepper::Dense;
use crate::error::{Error, MotionFault};
use crate::motion::state::Phase;
use crate::numerics::sign_changes::sign_changes;

/// The degree of the polynomials, and the angle that a body turns through in a part at most, in radians.
const DEGREE: usize = 8;
const TURN: f64 = 1.2;
/// A body that turns less than that in a part is followed by polynomials of half the degree, where these resolve the function.
const SHORT: f64 = 0.4;
/// A function counts as resolved when the last two coefficients of its polynomial are smaller than that, relative to its range.
const RESOLVED: f64 = 1e-3;
/// Where in a part a polynomial without extremes is compared with its function: at no distance from the nodes that is a simple
/// fraction of the part.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// A function that is so many times larger at nine places than it differs there is not followed to its zeros: of a sine that
/// passes through zero such values are found once in 10¹⁵ times.
const FAR: f64 = 1024.0;
/// How often a part is halved at most, and how many units of rounding of the time it is long at least: within less, a function
/// that is not resolved jumps.
const DEPTH: u32 = 45;
const INSTANT: f64 = 1024.0;
/// A function jumps between two of nine places where all it does besides is so much less than the jump.
const BESIDES: f64 = 1e-3;
/// Looks at parts that were halved, for one function in one run.
pub(super) const MOST_LOOKS: u64 = 1 << 24;
/// A part that was halved so often and is still not resolved counts as so many looks: as many parts as the step has then are more
/// than there are looks, so that a function that is noise there ends the run soon, and a kink does not.
const DEEP: u32 = 24;
const DEEP_LOOKS: u64 = 1 << 12;
/// How often an extreme near zero is looked for closer by.
const POLISHINGS: usize = 12;

/// A time since the start of the span, and the value of a function there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) at: f64,
    pub(super) value: f64,
}

/// A function of time and state, the time since the start of the span; it may ask the method.
pub(super) type Function<'a, E> =
    dyn FnMut(&mut dyn Dense<Error = E>, f64, &Phase) -> Result<f64, E> + 'a;

/// What is done with each look in turn; it may look closer by, and end the search.
pub(super) type Visit<'a, E> =
    dyn FnMut(&mut RootSearch<'_, E>, Look) -> Result<ControlFlow<()>, E> + 'a;

/// A function along one step, or a part of it.
pub(super) struct RootSearch<'b, E> {
    pub(super) function: &'b mut Function<'b, E>,
    /// Its number among those that a caller has, if it is one of them.
    pub(super) event: Option<usize>,
    pub(super) stepper: &'b mut dyn Dense<Error = E>,
    /// When the span starts, and the end of the part since then.
    pub(super) start: f64,
    pub(super) end: f64,
    /// How long a part is at most.
    pub(super) longest: f64,
    /// The length of the part that is looked at, where it was halved.
    pub(super) halved: Option<f64>,
    /// How many looks at such parts are left.
    pub(super) left: &'b mut u64,
}

impl<E: From<Error>> RootSearch<'_, E> {
    fn look(&mut self, at: f64) -> Result<Look, E> {
        let phase = if at == self.stepper.elapsed() {
            self.stepper.phase()
        } else {
            self.stepper.within(at)?
        };
        let value = self.value(at, &phase)?;
        Ok(Look { at, value })
    }

    /// The function, as long as looks are left.
    fn value(&mut self, at: f64, phase: &Phase) -> Result<f64, E> {
        if let Some(length) = self.halved {
            let Some(left) = self.left.checked_sub(1) else {
                return Err(Error::Motion(MotionFault::UnresolvedFunction {
                    event: self.event,
                    time: self.start + at,
                    length,
                    looks: MOST_LOOKS,
                })
                .into());
            };
            *self.left = left;
        }
        (self.function)(&mut *self.stepper, at, phase)
    }

    /// Looks from `begin`, which is not among them, to the end of the step, in which the body turns by `turn`: so many that between
    /// two of them the function rises or falls all the way.
    pub(super) fn visit_looks(
        &mut self,
        begin: Look,
        turn: f64,
        visit: &mut Visit<'_, E>,
    ) -> Result<(), E> {
        let degree = if turn < SHORT { DEGREE / 2 } else { DEGREE };
        let (from, length) = (begin.at, self.end - begin.at);
        let parts = (turn / TURN).max(length.abs() / self.longest);
        let parts = parts.ceil().clamp(1.0, f64::from(u32::MAX));
        let (mut begin, mut part) = (begin, 0.0);
        while part < parts {
            part += 1.0;
            let end = if part == parts {
                self.end
            } else {
                from + length * (part / parts)
            };
            self.halved = None;
            let end = self.look(end)?;
            if self
                .look_through([begin, end], degree, 0, visit)?
                .is_break()
            {
                break;
            }
            begin = end;
        }
        Ok(())
    }

    /// Visits looks from the first of two, which is not among them, to the second, which is.
    fn look_through(
        &mut self,
        [begin, end]: [Look; 2],
        degree: usize,
        depth: u32,
        visit: &mut Visit<'_, E>,
    ) -> Result<ControlFlow<()>, E> {
        self.halved = (depth > 0).then_some((end.at - begin.at).abs());
        let place = |node: usize, degree: usize| {
            // The Chebyshev points of the second kind.
            let x = 0.5 - 0.5 * (std::f64::consts::PI * node as f64 / degree as f64).cos();
            begin.at + (end.at - begin.at) * x
        };
        let mut nodes = vec![begin];
        for node in 1..degree {
            nodes.push(self.look(place(node, degree))?);
        }
        nodes.push(end);
        let mut interpolant = Interpolant::of(&nodes);
        let mut resolved = self.resolve(&nodes, &interpolant)?;
        if resolved.is_none() && degree < DEGREE && interpolant.may_be_followed {
            // Every second point of the higher degree is known.
            let mut all = vec![begin];
            for (known, node) in nodes[1..].iter().zip((1..).step_by(2)) {
                all.extend([self.look(place(node, DEGREE))?, *known]);
            }
            interpolant = Interpolant::of(&all);
            nodes = all;
            resolved = self.resolve(&nodes, &interpolant)?;
        }
        let is_instant = {
            let [one, other] = [begin.at, end.at].map(|at| (self.start + at).abs());
            (end.at - begin.at).abs() <= INSTANT * f64::EPSILON * one.max(other)
        };
        let looks = match resolved {
            Some(looks) => looks,
            None if depth < DEPTH && !is_instant && interpolant.may_be_followed => {
                if depth >= DEEP {
                    *self.left = self.left.saturating_sub(DEEP_LOOKS);
                }
                let middle = nodes[nodes.len() / 2];
                for half in [[begin, middle], [middle, end]] {
                    if self
                        .look_through(half, DEGREE, depth + 1, visit)?
                        .is_break()
                    {
                        return Ok(ControlFlow::Break(()));
                    }
                }
                return Ok(ControlFlow::Continue(()));
            }
            None => nodes,
        };
        for look in &looks[1..] {
            if visit(self, *look)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The looks through a part between which the function rises or falls all the way, if its polynomial resolves it.
    fn resolve(
        &mut self,
        nodes: &[Look],
        interpolant: &Interpolant,
    ) -> Result<Option<Vec<Look>>, E> {
        if interpolant.is_constant {
            return Ok(Some(nodes.to_vec()));
        }
        if !interpolant.is_resolved {
            return Ok(None);
        }
        let [begin, end] = [nodes[0].at, nodes[nodes.len() - 1].at];
        let place = |x: f64| begin + (end - begin) * x;
        let extremes = interpolant.extremes();
        let places = if extremes.is_empty() {
            &[GOLDEN][..]
        } else {
            &extremes
        };
        let mut between = nodes.to_vec();
        for &x in places {
            let look = self.look(place(x))?;
            let off = (look.value - interpolant.at(x)).abs();
            if off.is_nan() || off > interpolant.tolerance {
                return Ok(None);
            }
            between.push(look);
        }
        for (index, &x) in extremes.iter().enumerate() {
            let extreme = between[nodes.len() + index];
            if extreme.value.abs() <= interpolant.doubt {
                let before = index.checked_sub(1).map_or(0.0, |before| extremes[before]);
                let after = extremes.get(index + 1).map_or(1.0, |after| *after);
                between[nodes.len() + index] =
                    self.polish_extreme([place(before), place(x), place(after)], extreme)?;
            }
        }
        between.sort_by(|a, b| (a.at - begin).abs().total_cmp(&(b.at - begin).abs()));
        Ok(Some(between))
    }

    /// The extreme nearer to zero close by one that the polynomial has, by parabolas; it ends where the function has passed through
    /// zero.
    fn polish_extreme(&mut self, [low, at, high]: [f64; 3], found: Look) -> Result<Look, E> {
        let side = found.value.signum();
        let mut best = found;
        // A tenth of the way to the neighbours, then ever closer.
        let mut reach = 0.1 * (at - low).abs().min((high - at).abs());
        for _ in 0..POLISHINGS {
            let (one, two) = (self.look(best.at - reach)?, self.look(best.at + reach)?);
            for look in [one, two] {
                if look.value * side <= 0.0 {
                    return Ok(look);
                }
            }
            let curve = (one.value - 2.0 * best.value + two.value) * side;
            let slope = (two.value - one.value) * side;
            let shift = -0.5 * reach * slope / curve;
            if curve > 0.0 && shift.abs() <= reach.abs() {
                let look = self.look(best.at + shift)?;
                if look.value * side <= 0.0 {
                    return Ok(look);
                }
                if (look.value * side) < best.value * side {
                    best = look;
                }
            } else {
                for look in [one, two] {
                    if (look.value * side) < best.value * side {
                        best = look;
                    }
                }
            }
            reach *= 0.2;
        }
        Ok(best)
    }

    /// The zero in a bracket, at whose start the function has the sign `was`, to the last digit of the time: by Ridders'
    /// method, which halves the bracket at least.
    pub(super) fn locate(&mut self, [before, after]: [Look; 2], was: f64) -> Result<f64, E> {
        let (mut low, mut high) = (before.at, after.at);
        let (mut f_low, mut f_high) = (self.inner(low)?, self.inner(high)?);
        // The dense output may differ from the step's end in the last digits, and so in sign.
        if sign(f_low) != was {
            return Ok(low);
        }
        if sign(f_high) == was {
            return Ok(high);
        }
        loop {
            let middle = low + 0.5 * (high - low);
            if middle == low || middle == high || self.start + low == self.start + high {
                return Ok(if f_low.abs() < f_high.abs() {
                    low
                } else {
                    high
                });
            }
            let f_middle = self.inner(middle)?;
            let radical = (f_middle * f_middle - f_low * f_high).sqrt();
            let guess = middle + (middle - low) * (was * f_middle / radical);
            // A bracket on both sides of the guess, where it is a number.
            let mut points = [(middle, f_middle), (middle, f_middle)];
            if guess != middle && is_within(guess, low, high) {
                points[1] = (guess, self.inner(guess)?);
            }
            for (x, f) in points {
                if f == 0.0 {
                    return Ok(x);
                }
                if is_within(x, low, high) {
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

    /// The function along the dense output, at the end of the step too.
    fn inner(&mut self, at: f64) -> Result<f64, E> {
        let phase = self.stepper.within(at)?;
        self.value(at, &phase)
    }
}

/// Whether a place lies between two others, whichever of them is the larger.
fn is_within(place: f64, one: f64, other: f64) -> bool {
    one < place && place < other || other < place && place < one
}

/// A function through Chebyshev points, as a polynomial.
struct Interpolant {
    /// To rounding: there is nothing to resolve.
    is_constant: bool,
    is_resolved: bool,
    /// Whether there may be more to see of it: it is finite, zero is not far from all that is known, and that is no jump.
    may_be_followed: bool,
    /// How far the polynomial may be off.
    doubt: f64,
    /// How far the function may be off it where it counts as resolved.
    tolerance: f64,
    /// The coefficients of its Chebyshev polynomials.
    chebyshev: Vec<f64>,
}

impl Interpolant {
    /// Through values at `x_j = (1 − cos πj/n)/2`.
    fn of(nodes: &[Look]) -> Self {
        let n = nodes.len() - 1;
        let half = |j: usize| if j == 0 || j == n { 0.5 } else { 1.0 };
        let chebyshev: Vec<f64> = (0..=n)
            .map(|k| {
                let sum: f64 = (nodes.iter().enumerate())
                    .map(|(j, look)| {
                        // T_k at −cos(πj/n).
                        let angle =
                            std::f64::consts::PI * ((k * (n - j)) % (2 * n)) as f64 / n as f64;
                        half(j) * look.value * angle.cos()
                    })
                    .sum();
                2.0 / n as f64 * half(k) * sum
            })
            .collect();
        let range: f64 = chebyshev[1..].iter().map(|c| c.abs()).sum();
        let doubt = chebyshev[n - 1].abs() + chebyshev[n].abs();
        let values = || nodes.iter().map(|look| look.value);
        let most = values().map(f64::abs).fold(0.0, f64::max);
        let (low, high) = values()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        let is_far = n >= DEGREE && low.max(-high) >= FAR * (high - low);
        let changes = || (nodes.windows(2)).map(|pair| (pair[1].value - pair[0].value).abs());
        let (all, largest) = (changes().sum::<f64>(), changes().fold(0.0, f64::max));
        let is_jump = n >= DEGREE && all - largest <= BESIDES * largest;
        let rounding = 64.0 * f64::EPSILON * most;
        Self {
            is_constant: range <= rounding,
            is_resolved: doubt <= RESOLVED * range,
            may_be_followed: range.is_finite() && !is_far && !is_jump,
            doubt: 4.0 * doubt + rounding,
            tolerance: 4.0 * doubt + RESOLVED * range + rounding,
            chebyshev,
        }
    }

    /// The polynomial at a place within 0..1, by Clenshaw's recurrence.
    fn at(&self, x: f64) -> f64 {
        let y = 2.0 * x - 1.0;
        let (mut one, mut two) = (0.0, 0.0);
        for coefficient in self.chebyshev[1..].iter().rev() {
            (one, two) = (coefficient + 2.0 * y * one - two, one);
        }
        self.chebyshev[0] + y * one - two
    }

    /// Where within 0..1 the polynomial has its extremes.
    fn extremes(&self) -> Vec<f64> {
        let count = self.chebyshev.len();
        // Shifted Chebyshev polynomials by powers of x: T₀ = 1, T₁ = 2x − 1, T_{k+1} = 2 (2x − 1) T_k − T_{k−1}.
        let (mut before, mut shifted) = (vec![0.0; count], vec![0.0; count]);
        let mut powers = vec![0.0; count];
        before[0] = 1.0;
        (shifted[0], shifted[1]) = (-1.0, 2.0);
        for coefficient in &self.chebyshev {
            for (power, t) in powers.iter_mut().zip(&before) {
                *power += coefficient * t;
            }
            let next: Vec<f64> = (0..count)
                .map(|i| {
                    let up = if i == 0 { 0.0 } else { shifted[i - 1] };
                    4.0 * up - 2.0 * shifted[i] - before[i]
                })
                .collect();
            before = std::mem::replace(&mut shifted, next);
        }
        let slopes: Vec<f64> = (1..count).map(|k| powers[k] * k as f64).collect();
        sign_changes(&slopes, None)
    }
}

/// −1, 0 or 1, or NaN.
pub(super) fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use nalgebra::{UnitQuaternion, Vector3};

    /// A body at rest, in a step of one second.
    struct Still;

    impl Dense for Still {
        type Error = Error;

        fn elapsed(&self) -> f64 {
            1.0
        }

        fn phase(&self) -> Phase {
            Phase {
                attitude: UnitQuaternion::identity(),
                omega: Vector3::zeros(),
                position: Vector3::zeros(),
                velocity: Vector3::zeros(),
                internal_state: Box::default(),
            }
        }

        fn within(&mut self, _: f64) -> Result<Phase, Error> {
            Ok(self.phase())
        }
    }

    /// All zeros of a function within a step of one second, in which a body turns by `turn`, and how often it was asked.
    fn search_zeros(
        turn: f64,
        left: &mut u64,
        value: &dyn Fn(f64) -> f64,
    ) -> Result<(Vec<f64>, usize), Error> {
        let (mut count, mut zeros) = (0, Vec::new());
        let mut before = Look {
            at: 0.0,
            value: value(0.0),
        };
        let mut search = RootSearch {
            function: &mut |_, at, _| {
                count += 1;
                Ok(value(at))
            },
            event: Some(3),
            stepper: &mut Still,
            start: 0.0,
            end: 1.0,
            longest: f64::INFINITY,
            halved: None,
            left,
        };
        search.visit_looks(before, turn, &mut |search, look| {
            if before.value * look.value < 0.0 {
                zeros.push(search.locate([before, look], sign(before.value))?);
            }
            before = look;
            Ok(ControlFlow::Continue(()))
        })?;
        Ok((zeros, count))
    }

    #[test]
    fn a_function_much_faster_than_the_body_loses_no_zero() {
        let mut cycles = 0.37;
        while cycles < 2e3 {
            for phase in [0.3, 1.9, 4.4] {
                for turn in [0.0, 1.0, 30.0] {
                    let rate = std::f64::consts::TAU * cycles;
                    let wave = |t: f64| (rate * t + phase).sin();
                    let (zeros, count) =
                        search_zeros(turn, &mut MOST_LOOKS.clone(), &wave).expect("found");
                    let half = std::f64::consts::PI;
                    let want = ((rate + phase) / half).floor() - (phase / half).floor();
                    assert_eq!(zeros.len() as f64, want, "{cycles} {phase} {turn}");
                    for (k, zero) in zeros.iter().enumerate() {
                        let exact = ((phase / half).floor() + 1.0 + k as f64) * half - phase;
                        assert!(
                            (zero * rate - exact).abs() < 1e-8 + 1e-14 * rate,
                            "{cycles}"
                        );
                    }
                    assert!(count as f64 <= 90.0 * (1.0 + cycles) + 20.0 * turn);
                }
            }
            cycles *= 1.7;
        }
    }

    #[test]
    fn looks_at_halved_parts_are_counted_and_have_an_end() {
        let fast = |t: f64| (6e3 * t).sin();
        let mut left = MOST_LOOKS;
        search_zeros(0.0, &mut left, &fast).expect("found");
        let needed = MOST_LOOKS - left;
        for (mut left, is_found) in [(needed, true), (needed - 1, false)] {
            let found = search_zeros(0.0, &mut left, &fast);
            assert_eq!(found.is_ok(), is_found);
            assert_eq!(left, 0);
            if let Err(error) = found {
                let told = error.to_string();
                assert!(
                    told.starts_with("events: event 3 changes too fast"),
                    "{told}"
                );
            }
        }
        // Rounding errors about zero; and far from it, where they are not followed.
        let noise = |t: f64| (1e14 * t * t).sin();
        assert!(search_zeros(0.0, &mut 100_000, &noise).is_err());
        let (zeros, count) = search_zeros(0.0, &mut 0, &|t| 0.3 + 1e-5 * noise(t)).expect("far");
        assert!(zeros.is_empty() && count < 20, "{count}");
    }

    #[test]
    fn a_jump_is_seen_at_once_and_a_corner_soon() {
        let (zeros, count) =
            search_zeros(0.0, &mut 0, &|t| if t < 0.377 { -2.0 } else { 1.0 }).expect("found");
        assert_eq!(
            (zeros.len(), (zeros[0] - 0.377).abs() < 1e-16, count < 130),
            (1, true, true)
        );
        for (corner, level) in [(0.377, 0.1), (0.6, 1e-3), (0.21, 1e-9)] {
            let left = &mut MOST_LOOKS.clone();
            let (zeros, count) =
                search_zeros(0.0, left, &|t| (t - corner).abs() - level).expect("found");
            assert_eq!((zeros.len(), count <= 1500), (2, true), "{corner} {count}");
        }
    }

    #[test]
    fn only_a_part_that_was_halved_often_counts_as_many_looks() {
        // The part with the corner is halved until it is a thousand times shorter than the level; then zero is far from it.
        let cost = |level: f64| {
            let mut left = MOST_LOOKS;
            let (zeros, count) =
                search_zeros(0.0, &mut left, &|t| (t - 0.377).abs() - level).expect("found");
            assert_eq!(zeros.len(), 2, "{level}");
            (MOST_LOOKS - left, count as u64)
        };
        for level in [1e-1, 1e-3, 2.0_f64.powi(-13)] {
            let (spent, count) = cost(level);
            assert!(spent < count, "{level}: {spent} of {count}");
        }
        for level in [2.0_f64.powi(-15), 1e-11] {
            let (spent, count) = cost(level);
            assert!(
                spent > DEEP_LOOKS + count / 2,
                "{level}: {spent} of {count}"
            );
        }
        // As many such parts as a function of rounding errors has end the run soon.
        let mut left = MOST_LOOKS;
        let noise = |t: f64| {
            let x = (t - 0.377).abs();
            if x < 1e-7 {
                1e-7 * (1e30 * x * x).sin()
            } else {
                x
            }
        };
        assert!(search_zeros(0.0, &mut left, &noise).is_err() && left == 0);
    }

    /// Where a function passes through zero in a step that starts at a time, and how often it was asked.
    fn locate_zero(start: f64, value: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut count = 0;
        let mut function = |_: &mut dyn Dense<Error = Error>, at: f64, _: &Phase| {
            count += 1;
            // A bracket that is never closed ends here.
            if count > 500 {
                return Err(Error::Stopped);
            }
            Ok(value(at))
        };
        let bracket = [0.0, 1.0].map(|at| Look {
            at,
            value: value(at),
        });
        let mut search = RootSearch {
            function: &mut function,
            event: None,
            stepper: &mut Still,
            start,
            end: 1.0,
            longest: 1.0,
            halved: None,
            left: &mut 0,
        };
        let found = search.locate(bracket, sign(bracket[0].value));
        (found.expect("a zero"), count)
    }

    #[test]
    fn a_bracket_is_halved_at_least() {
        // A jump has no slope that would help: 53 halvings, two looks each, and the two ends.
        for jump in [0.7, 0.3, 0.999, 1e-3] {
            let (found, count) = locate_zero(0.0, |at| if at < jump { -1.0 } else { 1.0 });
            assert!((found - jump).abs() <= f64::EPSILON * jump, "{found}");
            assert!(count <= 2 * 53 + 12 + 2, "{jump}: {count} looks");
        }
        // A slope helps: Ridders' method doubles the digits with every two looks.
        let (found, count) = locate_zero(0.0, |at| at * at * at - 0.343);
        assert!((found - 0.7).abs() <= 2.0 * f64::EPSILON, "{found}");
        assert!(count <= 20, "{count} looks");
    }

    #[test]
    fn no_more_digits_are_looked_for_than_the_time_has() {
        // A million seconds after zero a second has 33 binary digits left; 53 of them take 60 looks.
        let (found, count) = locate_zero(1e6, |at| if at < 0.7 { -1.0 } else { 1.0 });
        assert!((found - 0.7).abs() <= 2.0_f64.powi(-33), "{found}");
        assert!(count <= 48, "{count} looks");
    }
}
