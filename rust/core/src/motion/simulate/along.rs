//! All passages of a function of time and state through zero within a step.
//!
//! In each part of a step the function is looked at where Chebyshev polynomials are interpolated. When its polynomial shows that it is
//! resolved, it is asked again at the extremes of the polynomial: between two looks it then rises or falls all the way, so that
//! each passage shows in the signs, also where two are close together. Where it is not resolved the part is halved, some
//! times: of a function that is not smooth, passages closer together than that may be missed.

use super::stepper::Dense;
use crate::motion::state::Phase;
use crate::numerics::sign_changes::sign_changes;

/// The degree of the polynomials, and the angle that a body turns through in a part at most, in radians.
const DEGREE: usize = 8;
const TURN: f64 = 1.2;
/// A body that turns less than that in a part is followed by polynomials of half the degree.
const SHORT: f64 = 0.4;
/// A function counts as resolved when the last two coefficients of its polynomial are smaller than that, relative to its range.
const RESOLVED: f64 = 1e-3;
/// How often a part is halved until its function counts as one that is not smooth.
const HALVINGS: u32 = 6;
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

/// A function along one step, or a part of it.
pub(super) struct View<'b, E> {
    pub(super) function: &'b mut Function<'b, E>,
    pub(super) stepper: &'b mut dyn Dense<Error = E>,
    /// When the span starts, and the end of the part since then.
    pub(super) start: f64,
    pub(super) end: f64,
}

impl<E> View<'_, E> {
    fn look(&mut self, at: f64) -> Result<Look, E> {
        let phase = if at == self.stepper.elapsed() {
            self.stepper.phase()
        } else {
            self.stepper.within(at)?
        };
        let value = (self.function)(&mut *self.stepper, at, &phase)?;
        Ok(Look { at, value })
    }

    /// Looks from `begin`, which is not among them, to the end of the step, in which the body turns by `turn`: so many that between
    /// two of them the function rises or falls all the way.
    pub(super) fn looks(&mut self, begin: Look, turn: f64) -> Result<Vec<Look>, E> {
        let degree = if turn < SHORT { DEGREE / 2 } else { DEGREE };
        let parts = (turn / TURN).ceil().clamp(1.0, f64::from(u32::MAX));
        let (from, length) = (begin.at, self.end - begin.at);
        let (mut looks, mut begin, mut part) = (Vec::new(), begin, 0.0);
        while part < parts {
            part += 1.0;
            let end = if part == parts {
                self.end
            } else {
                from + length * (part / parts)
            };
            let end = self.look(end)?;
            self.look_through(begin, end, degree, HALVINGS, &mut looks)?;
            begin = end;
        }
        Ok(looks)
    }

    /// Adds looks from `begin` to `end`, this one included.
    fn look_through(
        &mut self,
        begin: Look,
        end: Look,
        degree: usize,
        halvings: u32,
        looks: &mut Vec<Look>,
    ) -> Result<(), E> {
        let place = |x: f64| begin.at + (end.at - begin.at) * x;
        let mut nodes = vec![begin];
        for node in 1..degree {
            // The Chebyshev points of the second kind.
            let x = 0.5 - 0.5 * (std::f64::consts::PI * node as f64 / degree as f64).cos();
            nodes.push(self.look(place(x))?);
        }
        nodes.push(end);
        let shape = Shape::of(&nodes);
        if !shape.is_resolved && halvings > 0 && shape.is_finite {
            let middle = nodes[degree / 2];
            self.look_through(begin, middle, degree, halvings - 1, looks)?;
            return self.look_through(middle, end, degree, halvings - 1, looks);
        }
        if !shape.is_resolved {
            looks.extend(&nodes[1..]);
            return Ok(());
        }
        let extremes = shape.extremes();
        let mut between = nodes;
        for (index, &x) in extremes.iter().enumerate() {
            let extreme = self.look(place(x))?;
            let before = index.checked_sub(1).map_or(0.0, |before| extremes[before]);
            let after = extremes.get(index + 1).map_or(1.0, |after| *after);
            let is_near = extreme.value.abs() <= shape.doubt;
            between.push(if is_near {
                self.polished([place(before), extreme.at, place(after)], extreme)?
            } else {
                extreme
            });
        }
        between.sort_by(|a, b| (a.at - begin.at).abs().total_cmp(&(b.at - begin.at).abs()));
        looks.extend(&between[1..]);
        Ok(())
    }

    /// The extreme nearer to zero close by one that the polynomial has, by parabolas; it ends where the function has passed through
    /// zero.
    fn polished(&mut self, [low, at, high]: [f64; 3], found: Look) -> Result<Look, E> {
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
        (self.function)(&mut *self.stepper, at, &phase)
    }
}

/// Whether a place lies between two others, whichever of them is the larger.
fn is_within(place: f64, one: f64, other: f64) -> bool {
    one < place && place < other || other < place && place < one
}

/// A function through Chebyshev points, as a polynomial.
struct Shape {
    is_finite: bool,
    is_resolved: bool,
    /// How far the polynomial may be off.
    doubt: f64,
    /// The coefficients of its Chebyshev polynomials.
    chebyshev: Vec<f64>,
}

impl Shape {
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
        let most = nodes
            .iter()
            .map(|look| look.value.abs())
            .fold(0.0, f64::max);
        // Of what is constant to rounding there is nothing to resolve.
        let is_constant = range <= 64.0 * f64::EPSILON * most;
        Self {
            is_finite: range.is_finite(),
            is_resolved: is_constant || doubt <= RESOLVED * range,
            doubt: 4.0 * doubt + 64.0 * f64::EPSILON * most,
            chebyshev,
        }
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
                own: Box::default(),
            }
        }

        fn within(&mut self, _: f64) -> Result<Phase, Error> {
            Ok(self.phase())
        }
    }

    /// Where a function passes through zero in a step that starts at a time, and how often it was asked.
    fn located(start: f64, value: impl Fn(f64) -> f64) -> (f64, usize) {
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
        let mut view = View {
            function: &mut function,
            stepper: &mut Still,
            start,
            end: 1.0,
        };
        let found = view.locate(bracket, sign(bracket[0].value));
        (found.expect("a zero"), count)
    }

    #[test]
    fn a_bracket_is_halved_at_least() {
        // A jump has no slope that would help: 53 halvings, two looks each, and the two ends.
        for jump in [0.7, 0.3, 0.999, 1e-3] {
            let (found, count) = located(0.0, |at| if at < jump { -1.0 } else { 1.0 });
            assert!((found - jump).abs() <= f64::EPSILON * jump, "{found}");
            assert!(count <= 2 * 53 + 12 + 2, "{jump}: {count} looks");
        }
        // A slope helps: Ridders' method doubles the digits with every two looks.
        let (found, count) = located(0.0, |at| at * at * at - 0.343);
        assert!((found - 0.7).abs() <= 2.0 * f64::EPSILON, "{found}");
        assert!(count <= 20, "{count} looks");
    }

    #[test]
    fn no_more_digits_are_looked_for_than_the_time_has() {
        // A million seconds after zero a second has 33 binary digits left; 53 of them take 60 looks.
        let (found, count) = located(1e6, |at| if at < 0.7 { -1.0 } else { 1.0 });
        assert!((found - 0.7).abs() <= 2.0_f64.powi(-33), "{found}");
        assert!(count <= 48, "{count} looks");
    }
}
