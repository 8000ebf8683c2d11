//! Where the axis of a heavy top turns back: the roots of its cubic, and their distances from what else is singular.
//!
//! With `u = cos θ`, in the units of [`ReducedTop`], `u̇² = f(u) = (1 − u²) (h − 2κ (u − u₀)) − (a − b u)²`. Each distance that may be
//! small is found without cancellation: the cubic is solved in `x = u − u₀`, whose coefficients are as small as the motion is
//! slow, and near a pole by the values of f at the pole and of its slope, which the state gives directly.

use super::reduced::ReducedTop;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::MultiPrecision;
use crate::numerics::quad_double::QuadDouble;

/// Newton's steps at most: a dozen reach a root from the bound where the search starts.
const STEPS: usize = 60;
/// More of them, with the slope as a double: each adds a dozen digits.
const REFINEMENTS: usize = 16;

/// The roots `u₁ ≤ u₂ ≤ u₃` of f, by their distances. The motion stays between the first two; `−1 ≤ u₁ ≤ u₂ ≤ 1 ≤ u₃`.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningPoints<T = DoubleDouble> {
    /// `u₀ − u₁`.
    pub(super) fall: T,
    /// `u₂ − u₀`.
    pub(super) rise: T,
    /// `u₂ − u₁`.
    pub(super) range: T,
    /// `2κ (u₃ − u₂)`; finite also without weight, where u₃ is not.
    pub(super) gap: T,
    /// `2κ (u₃ − u₁)`.
    pub(super) height: T,
    /// `1 + u₁`.
    pub(super) above_bottom: T,
    /// `1 − u₁`.
    pub(super) depth: T,
    /// `1 − u₂`.
    pub(super) below_top: T,
    /// `2κ (u₃ − 1)`.
    pub(super) beyond_top: T,
    /// `h + 2κ (u₀ − u₁) = 2κ (u_e − u₁)`: ω² across the axis at its lowest, with `u_e = u₀ + h/2κ` the height at which it would vanish.
    pub(super) fastest: T,
    /// `2κ (u_e − u₂)`: ω² across the axis at its highest.
    pub(super) slowest: T,
    /// `2κ (u₃ − u_e)`.
    pub(super) beyond_rest: T,
}

/// A part of k′² that is worth no more than [`PHASE_ERROR`](crate::numerics::turns::PHASE_ERROR).
const HARMLESS: f64 = 2.0e-28; // 2⁻⁹²
/// A unit in the last place of what has four times the precision, over one of what has twice.
const FINER_ROUNDING: f64 = 8.1e-28; // 2⁻⁹⁰

impl TurningPoints {
    /// Whether k′² has the digits that long times need.
    pub(super) fn are_good(&self, motion: &ReducedTop) -> bool {
        self.gap.high * self.depth.high * HARMLESS >= motion.rounding_loss()
    }
}

impl TurningPoints<QuadDouble> {
    /// On the separatrix where nothing is left of the distance from it.
    pub(super) fn without_rounding(self, motion: &ReducedTop<QuadDouble>) -> Self {
        let left = self.gap.rounded() * self.depth.rounded();
        if left <= FINER_ROUNDING * motion.rounding_loss() {
            let gap = QuadDouble::default();
            return Self { gap, ..self };
        }
        self
    }
}

impl<T: MultiPrecision> TurningPoints<T> {
    /// The same to twice the precision.
    pub(super) fn twofold(&self) -> TurningPoints {
        TurningPoints {
            fall: self.fall.twofold(),
            rise: self.rise.twofold(),
            range: self.range.twofold(),
            gap: self.gap.twofold(),
            height: self.height.twofold(),
            above_bottom: self.above_bottom.twofold(),
            depth: self.depth.twofold(),
            below_top: self.below_top.twofold(),
            beyond_top: self.beyond_top.twofold(),
            fastest: self.fastest.twofold(),
            slowest: self.slowest.twofold(),
            beyond_rest: self.beyond_rest.twofold(),
        }
    }

    /// Of a motion that is not steady.
    pub(super) fn of(motion: &ReducedTop<T>) -> Self {
        let &ReducedTop {
            kappa,
            spin: b,
            square: h,
            lift: d,
            rate,
            bottom,
            top,
            ..
        } = motion;
        let two_kappa = kappa + kappa;
        let (sum, difference, excess) = (motion.sum(), motion.difference(), motion.excess());
        let pull = (bottom - T::from(1.0)) * h + kappa * (bottom * top) - b * d;
        let cubic = Cubic {
            constant: rate * rate,
            linear: -(pull + pull),
            quadratic: two_kappa * (bottom - top) - h - b * b,
            two_kappa,
        };
        let pole = Pole {
            top,
            difference,
            slope: excess - b * difference,
        };
        let roots = cubic.roots(&pole);
        let Roots {
            fall, rise, third, ..
        } = roots;
        let depth = top + fall;
        // The values of f at ±1 and at u_e are minus squares, and products of three distances.
        let above_bottom = quotient(sum * sum, (bottom + rise) * (third + two_kappa * bottom));
        let fastest = h + two_kappa * fall;
        let rest = motion.rest();
        let product = quotient(rest * rest, fastest);
        let (slowest, beyond_rest) = if excess.rounded() >= 0.0 {
            let slowest = excess + two_kappa * roots.below_top;
            if slowest.rounded() > 0.0 {
                (slowest, quotient(product, slowest))
            } else {
                (slowest, roots.beyond_top)
            }
        } else {
            let beyond = roots.beyond_top - excess;
            (quotient(product, beyond), beyond)
        };
        Self {
            fall,
            rise,
            range: roots.range,
            gap: roots.gap,
            height: third + two_kappa * fall,
            above_bottom,
            depth,
            below_top: roots.below_top,
            beyond_top: roots.beyond_top,
            fastest,
            slowest,
            beyond_rest,
        }
    }
}

/// The quotient of two numbers that are not negative, where nothing over nothing is nothing.
fn quotient<T: MultiPrecision>(a: T, b: T) -> T {
    if a.rounded() <= 0.0 || b.rounded() <= 0.0 {
        T::from(0.0)
    } else {
        a / b
    }
}

/// `a/b` as a double, where nothing over nothing is nothing: products of two small numbers would be lost.
fn share<T: MultiPrecision>(a: T, b: T) -> f64 {
    quotient(T::from(a.rounded()), T::from(b.rounded())).rounded()
}

fn not_negative<T: MultiPrecision>(x: T) -> T {
    if x.rounded() > 0.0 { x } else { T::from(0.0) }
}

/// What f is at u = 1: `f(1 − δ) = −(a − b)² + 2 slope δ + …`
struct Pole<T> {
    /// `1 − u₀`.
    top: T,
    /// `a − b`.
    difference: T,
    slope: T,
}

/// `f(u₀ + x) = constant + linear x + quadratic x² + 2κ x³`, with f(u₀) ≥ 0 and three real roots.
#[derive(Clone, Copy)]
struct Cubic<T> {
    constant: T,
    linear: T,
    quadratic: T,
    two_kappa: T,
}

/// Distances as [`TurningPoints`] has them; `third` is `2κ (u₃ − u₀)`.
struct Roots<T> {
    fall: T,
    rise: T,
    range: T,
    third: T,
    gap: T,
    below_top: T,
    beyond_top: T,
}

impl<T: MultiPrecision> Cubic<T> {
    /// The root that stands apart by Newton's method, the other two by the quadratic that is left.
    fn roots(&self, pole: &Pole<T>) -> Roots<T> {
        if self.constant.rounded() == 0.0 {
            return if self.linear.rounded() > 0.0 {
                self.with_lowest(T::from(0.0), pole)
            } else {
                self.with_middle(pole)
            };
        }
        // In ρ = 2κ x the cubic is monic: ρ³ + A ρ² + B ρ + C.
        let monic = [
            self.quadratic,
            self.two_kappa * self.linear,
            self.two_kappa * self.two_kappa * self.constant,
        ];
        let [a, b, c] = monic.map(T::rounded);
        let mean = -a / 3.0;
        let spread = (a * a - 3.0 * b).max(0.0).sqrt() / 3.0;
        // f is negative at the mean of the roots where the third stands apart. All lie within two spreads of the mean.
        if ((mean + a) * mean + b) * mean + c <= 0.0 {
            self.with_highest(newton(&monic, mean + 2.0 * spread), pole)
        } else {
            let lowest = newton(&monic, mean - 2.0 * spread);
            self.with_lowest(not_negative(-lowest) / self.two_kappa, pole)
        }
    }

    /// `f = (2κ x − third) (x² + s x − p)`: the low coefficients give s and p without loss, since the third root is the largest.
    fn with_highest(&self, third: T, pole: &Pole<T>) -> Roots<T> {
        let p = self.constant / third;
        let s = -(self.two_kappa * p + self.linear) / third;
        let range = (s * s + p.scaled(4.0)).sqrt();
        let larger = (range + s.abs()).scaled(0.5);
        let smaller = quotient(p, larger);
        let (fall, rise) = if s.rounded() > 0.0 {
            (larger, smaller)
        } else {
            (smaller, larger)
        };
        let gap = not_negative(third - self.two_kappa * rise);
        self.with_pole(fall, rise, range, third, gap, pole)
    }

    /// The start is the upper turning point: `f = x (2κ x² + quadratic x + linear)`, linear ≤ 0.
    fn with_middle(&self, pole: &Pole<T>) -> Roots<T> {
        let minus_c = -self.linear;
        let root =
            (self.quadratic * self.quadratic + (self.two_kappa * minus_c).scaled(4.0)).sqrt();
        let larger = (root + self.quadratic.abs()).scaled(0.5);
        let (third, fall) = if self.quadratic.rounded() <= 0.0 {
            (larger, quotient(minus_c, larger))
        } else {
            (
                quotient(self.two_kappa * minus_c, larger),
                larger / self.two_kappa,
            )
        };
        self.with_pole(fall, T::from(0.0), fall, third, third, pole)
    }

    /// `1 − u₂` and `2κ (u₃ − 1)` from their product: the one that loses less is a difference, the other a quotient.
    fn with_pole(&self, fall: T, rise: T, range: T, third: T, gap: T, pole: &Pole<T>) -> Roots<T> {
        let square = quotient(pole.difference * pole.difference, pole.top + fall);
        let below_top = not_negative(pole.top - rise);
        let beyond_top = not_negative(third - self.two_kappa * pole.top);
        let (below_top, beyond_top) = if share(below_top, pole.top) > share(beyond_top, third) {
            (below_top, quotient(square, below_top))
        } else {
            (quotient(square, beyond_top), beyond_top)
        };
        Roots {
            fall,
            rise,
            range,
            third,
            gap,
            below_top,
            beyond_top,
        }
    }

    /// The other two roots enclose the pole: with `X = 2κ (1 − u₂)` and `Y = 2κ (u₃ − 1)`, f(1) gives X Y and f′(1) gives X − Y,
    /// so that their sum, the gap, does not suffer when they are close.
    fn with_lowest(&self, fall: T, pole: &Pole<T>) -> Roots<T> {
        let depth = pole.top + fall;
        let square = pole.difference * pole.difference / depth;
        let unbalance = (square - pole.slope.scaled(2.0)) / depth;
        let product = self.two_kappa * square;
        let gap = (unbalance * unbalance + product.scaled(4.0)).sqrt();
        let larger = (gap + unbalance.abs()).scaled(0.5);
        let (below_top, beyond_top) = if unbalance.rounded() > 0.0 {
            (larger / self.two_kappa, quotient(product, larger))
        } else {
            (quotient(square, larger), larger)
        };
        let third = self.two_kappa * pole.top + beyond_top;
        let rest = if fall.rounded() > 0.0 {
            self.constant / fall
        } else {
            self.linear
        };
        let rise = quotient(rest, third);
        Roots {
            fall,
            rise,
            range: rise + fall,
            third,
            gap,
            below_top,
            beyond_top,
        }
    }
}

/// The root of `ρ³ + A ρ² + B ρ + C` that Newton's method comes to from `start`, outside of all roots: steadily, and fast since
/// that root stands apart.
fn newton<T: MultiPrecision>(monic: &[T; 3], start: f64) -> T {
    let [a, b, c] = monic.map(T::rounded);
    let slope = |x: f64| (3.0 * x + 2.0 * a) * x + b;
    let mut x = start;
    for _ in 0..STEPS {
        let step = (((x + a) * x + b) * x + c) / slope(x);
        if !step.is_finite() {
            break;
        }
        x -= step;
        if step.abs() <= 1e-9 * x.abs() {
            break;
        }
    }
    let mut root = T::from(x);
    for _ in 0..REFINEMENTS {
        let [a, b, c] = *monic;
        let value = ((root + a) * root + b) * root + c;
        let step = value / T::from(slope(root.rounded()));
        if !step.rounded().is_finite() {
            break;
        }
        root = root - step;
        if step.rounded().abs() <= T::CLOSE * T::CLOSE * 1e6 * root.rounded().abs() {
            break;
        }
    }
    root
}
