//! Where the axis of a heavy top turns back: the roots of its cubic, and their distances from what else is singular.
//!
//! With `u = cos θ`, in the units of [`Reduced`], `u̇² = f(u) = (1 − u²) (h − 2κ (u − u₀)) − (a − b u)²`. Each distance that may be
//! small is found without cancellation: the cubic is solved in `x = u − u₀`, whose coefficients are as small as the motion is
//! slow, and near a pole by the values of f at the pole and of its slope, which the state gives directly.

use super::reduced::Reduced;
use crate::numerics::double_double::DoubleDouble;

/// Newton's steps at most: a dozen reach a root from the bound where the search starts.
const STEPS: usize = 60;

/// The roots `u₁ ≤ u₂ ≤ u₃` of f, by their distances. The motion stays between the first two; `−1 ≤ u₁ ≤ u₂ ≤ 1 ≤ u₃`.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningPoints {
    /// `u₀ − u₁`.
    pub(super) fall: DoubleDouble,
    /// `u₂ − u₀`.
    pub(super) rise: DoubleDouble,
    /// `u₂ − u₁`.
    pub(super) range: DoubleDouble,
    /// `2κ (u₃ − u₂)`; finite also without weight, where u₃ is not.
    pub(super) gap: DoubleDouble,
    /// `2κ (u₃ − u₁)`.
    pub(super) height: DoubleDouble,
    /// `1 + u₁`.
    pub(super) above_bottom: DoubleDouble,
    /// `1 − u₁`.
    pub(super) depth: DoubleDouble,
    /// `1 − u₂`.
    pub(super) below_top: DoubleDouble,
    /// `2κ (u₃ − 1)`.
    pub(super) beyond_top: DoubleDouble,
    /// `h + 2κ (u₀ − u₁) = 2κ (u_e − u₁)`: ω² across the axis at its lowest, with `u_e = u₀ + h/2κ` the height at which it would vanish.
    pub(super) fastest: DoubleDouble,
    /// `2κ (u_e − u₂)`: ω² across the axis at its highest.
    pub(super) slowest: DoubleDouble,
    /// `2κ (u₃ − u_e)`.
    pub(super) beyond_rest: DoubleDouble,
}

impl TurningPoints {
    /// Of a motion that is not steady.
    pub(super) fn of(motion: &Reduced) -> Self {
        let &Reduced {
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
        let pull = (bottom - ONE) * h + kappa * (bottom * top) - b * d;
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
        let (slowest, beyond_rest) = if excess.high >= 0.0 {
            let slowest = excess + two_kappa * roots.below_top;
            if slowest.high > 0.0 {
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

const ONE: DoubleDouble = DoubleDouble {
    high: 1.0,
    low: 0.0,
};

/// The quotient of two numbers that are not negative, where nothing over nothing is nothing.
fn quotient(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    if a.high <= 0.0 || b.high <= 0.0 {
        DoubleDouble::default()
    } else {
        a / b
    }
}

fn not_negative(x: DoubleDouble) -> DoubleDouble {
    if x.high > 0.0 {
        x
    } else {
        DoubleDouble::default()
    }
}

/// What f is at u = 1: `f(1 − δ) = −(a − b)² + 2 slope δ + …`
struct Pole {
    /// `1 − u₀`.
    top: DoubleDouble,
    /// `a − b`.
    difference: DoubleDouble,
    slope: DoubleDouble,
}

/// `f(u₀ + x) = constant + linear x + quadratic x² + 2κ x³`, with f(u₀) ≥ 0 and three real roots.
#[derive(Clone, Copy)]
struct Cubic {
    constant: DoubleDouble,
    linear: DoubleDouble,
    quadratic: DoubleDouble,
    two_kappa: DoubleDouble,
}

/// Distances as [`TurningPoints`] has them; `third` is `2κ (u₃ − u₀)`.
struct Roots {
    fall: DoubleDouble,
    rise: DoubleDouble,
    range: DoubleDouble,
    third: DoubleDouble,
    gap: DoubleDouble,
    below_top: DoubleDouble,
    beyond_top: DoubleDouble,
}

impl Cubic {
    /// The root that stands apart by Newton's method, the other two by the quadratic that is left.
    fn roots(&self, pole: &Pole) -> Roots {
        if self.constant.high == 0.0 {
            return if self.linear.high > 0.0 {
                self.with_lowest(DoubleDouble::default(), pole)
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
        let [a, b, c] = monic.map(DoubleDouble::rounded);
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
    fn with_highest(&self, third: DoubleDouble, pole: &Pole) -> Roots {
        let p = self.constant / third;
        let s = -(self.two_kappa * p + self.linear) / third;
        let range = (s * s + p.scaled(4.0)).sqrt();
        let larger = (range + s.abs()).scaled(0.5);
        let smaller = quotient(p, larger);
        let (fall, rise) = if s.high > 0.0 {
            (larger, smaller)
        } else {
            (smaller, larger)
        };
        let gap = not_negative(third - self.two_kappa * rise);
        self.with_pole(fall, rise, range, third, gap, pole)
    }

    /// The start is the upper turning point: `f = x (2κ x² + quadratic x + linear)`, linear ≤ 0.
    fn with_middle(&self, pole: &Pole) -> Roots {
        let minus_c = -self.linear;
        let root =
            (self.quadratic * self.quadratic + (self.two_kappa * minus_c).scaled(4.0)).sqrt();
        let larger = (root + self.quadratic.abs()).scaled(0.5);
        let (third, fall) = if self.quadratic.high <= 0.0 {
            (larger, quotient(minus_c, larger))
        } else {
            (
                quotient(self.two_kappa * minus_c, larger),
                larger / self.two_kappa,
            )
        };
        self.with_pole(fall, DoubleDouble::default(), fall, third, third, pole)
    }

    /// `1 − u₂` and `2κ (u₃ − 1)` from their product: the one that loses less is a difference, the other a quotient.
    fn with_pole(
        &self,
        fall: DoubleDouble,
        rise: DoubleDouble,
        range: DoubleDouble,
        third: DoubleDouble,
        gap: DoubleDouble,
        pole: &Pole,
    ) -> Roots {
        let square = quotient(pole.difference * pole.difference, pole.top + fall);
        let below_top = not_negative(pole.top - rise);
        let beyond_top = not_negative(third - self.two_kappa * pole.top);
        let (below_top, beyond_top) =
            if below_top.high * third.high > beyond_top.high * pole.top.high {
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
    fn with_lowest(&self, fall: DoubleDouble, pole: &Pole) -> Roots {
        let depth = pole.top + fall;
        let square = pole.difference * pole.difference / depth;
        let unbalance = (square - pole.slope.scaled(2.0)) / depth;
        let product = self.two_kappa * square;
        let gap = (unbalance * unbalance + product.scaled(4.0)).sqrt();
        let larger = (gap + unbalance.abs()).scaled(0.5);
        let (below_top, beyond_top) = if unbalance.high > 0.0 {
            (larger / self.two_kappa, quotient(product, larger))
        } else {
            (quotient(square, larger), larger)
        };
        let third = self.two_kappa * pole.top + beyond_top;
        let rest = if fall.high > 0.0 {
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
fn newton(monic: &[DoubleDouble; 3], start: f64) -> DoubleDouble {
    let [a, b, c] = monic.map(DoubleDouble::rounded);
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
    let mut root = DoubleDouble::from(x);
    for _ in 0..4 {
        let [a, b, c] = *monic;
        let value = ((root + a) * root + b) * root + c;
        let step = value / slope(root.high).into();
        if !step.high.is_finite() {
            break;
        }
        root -= step;
        if step.high.abs() <= 1e-26 * root.high.abs() {
            break;
        }
    }
    root
}
