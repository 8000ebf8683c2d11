//! `f(μ) = Σ h_i²/(1 − μ I_i)²` between its poles: where it has a given value, where it is least.

use super::axes::{ReducedAxes, Vector, norm};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::number::Real;
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// What is below this, relative to its own terms, is zero: inputs are doubles, and the arithmetic has 31 digits.
pub(super) const NOTHING: f64 = 1e-28;

/// Steps of Newton's method at most; from a double it takes two or three.
const STEPS: usize = 60;

/// A multiplier, as its distance `1 − μ I_k = unit·s` from the pole of an axis: no digit of it is lost close by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Multiplier {
    /// k.
    axis: usize,
    /// A power of two at a small `h_k`, so that s is of order one at the pole's roots.
    unit: i32,
    /// The distance.
    s: DoubleDouble,
}

/// One axis as seen from a pole: `1 − μ I_j = gap + ratio·unit·s`, and the part of h.
#[derive(Clone, Copy)]
struct Term<T> {
    gap: T,
    ratio: T,
    part: T,
    /// The pole's own axis: no gap, and its part is in units of `unit`.
    is_own: bool,
}

/// f as seen from one pole.
#[derive(Clone, Copy)]
struct SecularAtPole<T> {
    unit: i32,
    terms: [Term<T>; 3],
}

impl<T: Real> SecularAtPole<T> {
    /// `f/L² − 1` and, per s, half its slope.
    fn value_and_slope(&self, s: T) -> (T, T) {
        let (mut value, mut slope) = (-T::from(1.0), T::default());
        for term in &self.terms {
            let (n, rate) = term.share(s, self.unit);
            value += n * n;
            slope -= n * n * rate;
        }
        (value, slope)
    }

    /// `½ df/ds` and its slope, for the minimum; in units in which nothing overflows.
    fn slope_and_curvature(&self, s: T) -> (T, T) {
        let largest = self
            .terms
            .iter()
            .fold(1.0, |most: f64, term| most.max(term.part.rounded().abs()));
        let unit = power::<T>(-(exponent(largest) & !127));
        let (mut slope, mut curvature) = (T::default(), T::default());
        for term in &self.terms {
            let (n, rate) = term.share(s, self.unit);
            let n = n * unit;
            slope -= n * n * rate;
            curvature += T::from(3.0) * n * n * rate * rate;
        }
        (slope, curvature)
    }
}

impl<T: Real> Term<T> {
    /// `n_j = part/(1 − μ I_j)`, and the relative rate of the denominator per s.
    fn share(&self, s: T, unit: i32) -> (T, T) {
        if self.part.rounded() == 0.0 {
            return (T::default(), T::default());
        }
        if self.is_own {
            return (self.part / s, T::from(1.0) / s);
        }
        let rate = self.ratio * power(unit);
        let distance = self.gap + rate * s;
        (self.part / distance, rate / distance)
    }
}

/// 2^e as a number.
fn power<T: Real>(e: i32) -> T {
    T::from(times_power_of_two(1.0, e))
}

/// f, from all of its poles.
pub(super) struct Secular<'a> {
    frame: &'a ReducedAxes,
    /// Axes whose poles f has, these ascending.
    poles: Vec<usize>,
}

impl<'a> Secular<'a> {
    pub(super) fn of(frame: &'a ReducedAxes) -> Self {
        let poles = frame.with_rotor();
        Self { frame, poles }
    }

    /// All multipliers at which f is L².
    pub(super) fn roots(&self) -> Vec<Multiplier> {
        let (Some(&first), Some(&last)) = (self.poles.first(), self.poles.last()) else {
            return Vec::new();
        };
        let mut roots = vec![self.outer(first, 1.0)];
        for (minimum, pair) in self.minima().iter().zip(self.poles.windows(2)) {
            let below = DoubleDouble::from(1.0) - norm(&minimum.shares(self.frame));
            if below.high > NOTHING {
                roots.push(self.inner(minimum, pair[0], pair[1], below));
                roots.push(self.inner(minimum, pair[1], pair[0], below));
            } else if below.high >= -NOTHING {
                roots.push(*minimum);
            }
        }
        roots.push(self.outer(last, -1.0));
        roots
    }

    /// The minimum of f between each two neighbouring poles.
    pub(super) fn minima(&self) -> Vec<Multiplier> {
        self.poles
            .windows(2)
            .map(|pair| self.minimum(pair[0], pair[1]))
            .collect()
    }

    /// The root beyond all poles, on the side where `1 − μ I_k` has this sign.
    fn outer(&self, k: usize, side: f64) -> Multiplier {
        let view = self.view::<f64>(k);
        let is_above = |s: f64| view.value_and_slope(s).0 > 0.0;
        let near = side * view.terms[k].part.abs();
        let mut far = near;
        // It ends: infinitely far f is zero.
        while is_above(far) {
            far *= 16.0;
        }
        let start = between(near, far, is_above);
        self.refined(k, start.into())
    }

    /// The root between the pole of one axis and the minimum toward another pole.
    fn inner(
        &self,
        minimum: &Multiplier,
        from: usize,
        to: usize,
        below: DoubleDouble,
    ) -> Multiplier {
        if below.high < 1e-9 {
            // Too close for doubles to see a side: f is a parabola.
            let view = self.view::<DoubleDouble>(minimum.axis);
            let curvature = view.slope_and_curvature(minimum.s).1.high;
            let width = (2.0 * below.high / curvature).sqrt();
            // μ ascends as s falls, and poles ascend as moments fall.
            let is_lower = self.frame.moments[from].high > self.frame.moments[to].high;
            let side = if is_lower { width } else { -width };
            return self.refined(minimum.axis, minimum.s + side.into());
        }
        // The half of the way to the other pole in which the root is names the pole that it is seen from.
        let near = self.view::<f64>(from);
        let middle = self.middle(from, to);
        let is_in_near_half = if minimum.axis == from {
            true
        } else {
            near.value_and_slope(middle).0 < 0.0
        };
        if is_in_near_half {
            let start = middle.signum() * near.terms[from].part.abs();
            let end = if minimum.axis == from {
                minimum.s.high
            } else {
                middle
            };
            let is_above = |s: f64| near.value_and_slope(s).0 > 0.0;
            return self.refined(from, between(start, end, is_above).into());
        }
        let far = self.view::<f64>(to);
        let is_above = |s: f64| far.value_and_slope(s).0 > 0.0;
        let start = between(self.middle(to, from), minimum.s.high, is_above);
        self.refined(to, start.into())
    }

    /// Half of the way from one pole to another, as seen from the first.
    fn middle(&self, from: usize, to: usize) -> f64 {
        let I = &self.frame.moments;
        let half = ((I[to] - I[from]) / I[to]).high * 0.5;
        times_power_of_two(half, -self.unit(from))
    }

    /// The minimum between the poles of two axes, the lower pole first.
    fn minimum(&self, low: usize, high: usize) -> Multiplier {
        // f falls from the lower pole on: in which half does it rise again?
        let view = self.view::<f64>(low);
        let middle = self.middle(low, high);
        let falls = |view: &SecularAtPole<f64>, s: f64| view.slope_and_curvature(s).0 > 0.0;
        let (k, end, from_low) = if falls(&view, middle) {
            (high, self.middle(high, low), false)
        } else {
            (low, middle, true)
        };
        let view = self.view::<f64>(k);
        let start = end * f64::EPSILON.powi(20);
        let s = between(start, end, |s| falls(&view, s) == from_low);
        let view = self.view::<DoubleDouble>(k);
        let mut s = DoubleDouble::from(s);
        for _ in 0..4 {
            let (slope, curvature) = view.slope_and_curvature(s);
            let step = slope / curvature;
            if !step.high.is_finite() || step.high.abs() > 1e-8 * s.high.abs() {
                break;
            }
            s -= step;
        }
        self.place(k, s)
    }

    /// Newton's method to twice the precision.
    fn refined(&self, k: usize, start: DoubleDouble) -> Multiplier {
        let view = self.view::<DoubleDouble>(k);
        let mut s = start;
        for _ in 0..STEPS {
            let (value, slope) = view.value_and_slope(s);
            let step = value / (slope + slope);
            if !step.high.is_finite() {
                break;
            }
            s -= step;
            if step.high.abs() <= 1e-30 * s.high.abs() {
                break;
            }
        }
        self.place(k, s)
    }

    fn place(&self, axis: usize, s: DoubleDouble) -> Multiplier {
        Multiplier {
            axis,
            unit: self.unit(axis),
            s,
        }
    }

    fn unit(&self, axis: usize) -> i32 {
        exponent(self.frame.rotor[axis].high).min(0)
    }

    fn view<T: Real>(&self, k: usize) -> SecularAtPole<T> {
        let ReducedAxes { moments, rotor, .. } = self.frame;
        let number = |x: DoubleDouble| T::pair(x.high, x.low);
        let unit = self.unit(k);
        let terms = [0, 1, 2].map(|j| Term {
            gap: number((moments[k] - moments[j]) / moments[k]),
            ratio: number(moments[j] / moments[k]),
            part: number(if j == k {
                let h = rotor[j];
                h.times_power_of_two(-unit)
            } else {
                rotor[j]
            }),
            is_own: j == k,
        });
        SecularAtPole { unit, terms }
    }
}

impl Multiplier {
    /// The multiplier `1/I_k` itself, of an axis without a part of h.
    pub(super) fn at_pole(axis: usize) -> Self {
        Self {
            axis,
            unit: 0,
            s: DoubleDouble::default(),
        }
    }

    /// `1 − μ I_j`, and the sum of the sizes of its terms.
    fn distance(&self, frame: &ReducedAxes, j: usize) -> (DoubleDouble, f64) {
        let I = &frame.moments;
        let own = self.s.times_power_of_two(self.unit);
        if I[j] == I[self.axis] {
            return (own, own.high.abs());
        }
        let gap = (I[self.axis] - I[j]) / I[self.axis];
        let moved = I[j] / I[self.axis] * own;
        (gap + moved, gap.high.abs() + moved.high.abs())
    }

    /// L/|L| along the axes; zero along those without a part of h.
    pub(super) fn shares(&self, frame: &ReducedAxes) -> Vector {
        [0, 1, 2].map(|j| {
            let h = frame.rotor[j];
            if h.high == 0.0 {
                return DoubleDouble::default();
            }
            if j == self.axis {
                let scaled = h.times_power_of_two(-self.unit);
                return scaled / self.s;
            }
            h / self.distance(frame, j).0
        })
    }

    /// `1/I_j − μ` along each axis, and the size of what it is a difference of.
    pub(super) fn across(&self, frame: &ReducedAxes) -> (Vector, [f64; 3]) {
        let both = [0, 1, 2].map(|j| {
            let (distance, size) = self.distance(frame, j);
            (distance / frame.moments[j], size / frame.moments[j].high)
        });
        (both.map(|(x, _)| x), both.map(|(_, size)| size))
    }

    /// μ.
    pub(super) fn multiplier(&self, frame: &ReducedAxes) -> DoubleDouble {
        let own = self.distance(frame, self.axis).0;
        (DoubleDouble::from(1.0) - own) / frame.moments[self.axis]
    }
}

/// The last double from `near` toward `far`, of one sign, at which a condition holds that holds at `near` and not at `far`:
/// by halving among the doubles, so that sixty steps cross all magnitudes.
fn between(near: f64, far: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let sign = if far < 0.0 { -1.0 } else { 1.0 };
    let (mut low, mut high) = (near.abs().to_bits(), far.abs().to_bits());
    while low.abs_diff(high) > 1 {
        let middle = low / 2 + high / 2 + (low & high & 1);
        if holds(sign * f64::from_bits(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    sign * f64::from_bits(low)
}
