//! The elliptic curve of a motion: from its invariants to roots, periods and nome.
//!
//! `4E³ − G₂E + G₃ = 0` has the roots `E_k`, whose sum is zero. `G₃ ≤ 0` means that the one that stands apart is the
//! largest: then the real period is not long beside the imaginary one and sines serve. Where `G₃ > 0` all is done for −E and
//! the time i t, in which the two periods exchange their roles, with hyperbolic functions.
//!
//! The elliptic logarithm of a point of the curve, by the chain of means, with the logarithmic derivative of ϑ₁ there.
//!
//! With `c² = P − E″`, `d² = P − E′`, `f² = P − E` a step of the chain is `a′ = ½(a + b)`, `b′ = √(ab)`, `c′ = ½(c + d)`,
//! `d′² = ½(f² + cd + ab)`, `f′² = ½(f² + cd − ab)`, `f′d′ = f c′`: the real period stays and the imaginary one doubles. In the
//! limit `c = a/sin v`, `f = a cot v`. The first step is the one in which E′ and E″ enter by their sum and product alone, so
//! they may as well be complex.

use super::pencil::Invariants;
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

/// A way to measure the curve: from the root E to the means of its real period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means {
    /// E, the largest or the only real root.
    pub(super) root: DoubleDouble,
    /// `H = √((E − E′)(E − E″))`, E′ and E″ the other roots.
    pub(super) height: DoubleDouble,
    /// `½√(3E + 2H)` and `√H`, whose arithmetic-geometric mean is 2π over the real period.
    pub(super) pair: [DoubleDouble; 2],
}

impl Means {
    fn of(root: DoubleDouble, height: DoubleDouble, sum: DoubleDouble) -> Self {
        Self {
            root,
            height,
            pair: [sum.sqrt().scaled(0.5), height.sqrt()],
        }
    }
}

/// The curve, or that of −E.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    /// Whether it is that of −E.
    pub(super) is_turned: bool,
    /// `(E′ − E″)²`: positive where all roots are real, zero where the curve is degenerate.
    pub(super) gap: DoubleDouble,
    /// By the root that stands apart.
    pub(super) apart: Means,
    /// The nome for a doubled imaginary period: the square of the nome of the curve, negative where only one root is real.
    pub(super) nome: DoubleDouble,
}

/// Steps of Newton's method in double precision at most.
const STEPS: usize = 60;

impl Curve {
    /// From the root that stands apart.
    pub(super) fn of(invariants: &Invariants, apart: DoubleDouble) -> Self {
        let is_turned = invariants.third.high > 0.0;
        let root = if is_turned { -apart } else { apart };
        let three = DoubleDouble::from(3.0);
        let square = three * (root * root) - invariants.second.scaled(0.25);
        if square.high <= 0.0 {
            return Self::cusp();
        }
        let gap = invariants.discriminant / (square * square);
        let height = square.sqrt();
        let sum = three * root + height.scaled(2.0);
        let apart = Means::of(root, height, sum);
        // The difference of the squares of the means.
        let difference = gap / sum.scaled(4.0);
        Self {
            is_turned,
            gap,
            apart,
            nome: nome(apart.pair, difference),
        }
    }

    /// With three equal roots: the elliptic functions are powers of the time.
    pub(super) fn cusp() -> Self {
        let zero = DoubleDouble::default();
        Self {
            is_turned: true,
            gap: zero,
            apart: Means::of(zero, zero, zero),
            nome: zero,
        }
    }

    /// By the root that is first in time of the real period, where the curve is that of −E; `None` where that is infinite.
    pub(super) fn in_time(&self) -> Option<Means> {
        let root = self.apart.root;
        let three = DoubleDouble::from(3.0);
        if self.gap.high > 0.0 {
            let gap = self.gap.sqrt();
            let first = (root + gap).scaled(0.5);
            let height = (gap * (three * root + gap)).scaled(0.5).sqrt();
            Some(Means::of(first, height, three * first + height.scaled(2.0)))
        } else if self.gap.high < 0.0 {
            let height = self.apart.height;
            let sum = -self.gap / (three * root + height.scaled(2.0));
            Some(Means::of(-root, height, sum))
        } else {
            None
        }
    }
}

/// The root that stands apart from the other two.
pub(super) fn apart(invariants: &Invariants) -> DoubleDouble {
    let (second, third) = (invariants.second, invariants.third);
    if third.high > 0.0 {
        -largest_root(second, third)
    } else {
        largest_root(second, -third)
    }
}

/// The largest root of `4E³ − G₂E − G₃`, G₃ ≥ 0: the other two, where they are real, are not above zero.
fn largest_root(second: DoubleDouble, third: DoubleDouble) -> DoubleDouble {
    let (g2, g3) = (second.high, third.high);
    // From above, where Newton's method only goes down.
    let mut root = (g2.max(0.0) / 3.0).sqrt() + (0.25 * g3).cbrt();
    if root == 0.0 {
        return DoubleDouble::default();
    }
    for _ in 0..STEPS {
        let slope = 12.0 * root * root - g2;
        let step = ((4.0 * root * root - g2) * root - g3) / slope;
        root -= step;
        if step.abs() <= 1e-12 * root.abs() {
            break;
        }
    }
    let mut root = DoubleDouble::from(root);
    for _ in 0..2 {
        let square = root * root;
        let slope = (square.scaled(12.0) - second).high;
        let rest = ((square.scaled(4.0) - second) * root - third).high;
        if slope > 0.0 {
            root -= (rest / slope).into();
        }
    }
    root
}

/// Terms of `q = ℓ + 2ℓ⁵ + 15ℓ⁹ + …`, `ℓ = ½(1 − √k′)/(1 + √k′)`; source: Abramowitz and Stegun 17.3.21.
const NOME: [f64; 9] = [
    1.0,
    2.0,
    15.0,
    150.0,
    1707.0,
    20_910.0,
    268_616.0,
    3_567_400.0,
    48_555_069.0,
];

/// The nome of the modulus `√(1 − (b/a)²)`, of a, b and `a² − b²`; negative where b is the larger.
fn nome([a, b]: [DoubleDouble; 2], difference: DoubleDouble) -> DoubleDouble {
    let roots = a.sqrt() + b.sqrt();
    let l = (difference / ((a + b) * (roots * roots))).scaled(0.5);
    let square = l * l;
    let fourth = square * square;
    let mut sum = DoubleDouble::default();
    for &term in NOME.iter().rev() {
        sum = sum * fourth + term.into();
    }
    sum * l
}

type Number = Complex<DoubleDouble>;

/// Where a point is on the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Logarithm {
    /// a, b at their common limit: 2π over the real period.
    pub(super) mean: DoubleDouble,
    /// `a cot v`.
    pub(super) cotangent: Number,
    /// `a/sin v`.
    pub(super) cosecant: Number,
    /// `d log ϑ₁(v)` by the time.
    pub(super) slope: Number,
}

/// The most steps of the chain.
const MOST_MEANS: usize = 24;
/// Means this close are one, to twice the precision, after one more step.
const CLOSE: f64 = 1e-8;

/// Of the point (P, P′) of `P′² = 4(P − E)(P − E′)(P − E″)`.
pub(super) fn logarithm(means: &Means, [value, derivative]: [Number; 2]) -> Logarithm {
    let (root, height) = (means.root, means.height);
    let x = value - real(root);
    let three = root + root.scaled(2.0);
    let square = x * (x + real(three)) + real(height * height);
    // √((P − E′)(P − E″)) and √(P − E), of which the smaller is by the derivative.
    let half = derivative.scaled(0.5);
    let (mut f, mut r) = if x.norm_squared().high >= square.taxicab() {
        let f = x.sqrt();
        (f, if f.taxicab() == 0.0 { f } else { half.over(f) })
    } else {
        let r = square.sqrt();
        (half.over(r), r)
    };
    let middle = x + real(three.scaled(0.5));
    if middle.is_opposite_to(r) {
        (f, r) = (-f, -r);
    }
    let [mut a, mut b] = means.pair;
    let mut c = (middle + r).scaled(0.5).sqrt();
    let height = real(height);
    let squares = [(x + r + height).scaled(0.5), (x + r - height).scaled(0.5)];
    let first = f;
    let mut d;
    (d, f) = both(squares, f * c, c);
    let (mut slope, mut weight) = (f, 1.0);
    for _ in 0..MOST_MEANS {
        let is_last = (a - b).high.abs() <= CLOSE * a.high;
        let (sum, product) = (f.square() + c * d, real(a * b));
        let next = (c + d).scaled(0.5);
        let squares = [(sum + product).scaled(0.5), (sum - product).scaled(0.5)];
        let (d_next, f_next) = both(squares, f * next, next);
        weight *= 2.0;
        slope = slope + (f_next - f).scaled(weight);
        (a, b) = ((a + b).scaled(0.5), (a * b).sqrt());
        (c, d, f) = (next, d_next, f_next);
        if is_last {
            break;
        }
    }
    Logarithm {
        mean: (a + b).scaled(0.5),
        cotangent: f,
        cosecant: (c + d).scaled(0.5),
        slope: slope.scaled(2.0) - first,
    }
}

fn real(x: DoubleDouble) -> Number {
    Complex::new(x, DoubleDouble::default())
}

/// d and f of their squares and their product, d on the side of c: the larger is a root, the other a quotient.
fn both([d, f]: [Number; 2], product: Number, c: Number) -> (Number, Number) {
    let (d, f) = if d.taxicab() >= f.taxicab() {
        let d = d.sqrt();
        if d.taxicab() == 0.0 {
            return (d, d);
        }
        (d, product.over(d))
    } else {
        let f = f.sqrt();
        (product.over(f), f)
    };
    if d.is_opposite_to(c) {
        (-d, -f)
    } else {
        (d, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `4(x − e₁)(x − e₂)(x − e₃)` with roots that sum to zero; with G₃ = 0 they are ±½√G₂ and zero.
    #[test]
    fn the_largest_root_is_found() {
        for [e1, e2] in [
            [1.0, 0.0],
            [1.0, -0.5],
            [0.5, -0.25],
            [3.0, -1e-9],
            [2.0, -0.75],
        ] {
            let e3 = -(e1 + e2);
            let (second, third) = (-4.0 * (e1 * e2 + e2 * e3 + e3 * e1), 4.0 * e1 * e2 * e3);
            let root = largest_root(second.into(), third.into());
            assert!((root.high / e1 - 1.0).abs() < 1e-15, "{e1} {e2} {root:?}");
        }
        // One real root: 4x³ − G₃.
        assert!((largest_root(0.0.into(), 32.0.into()).high - 2.0).abs() < 1e-15);
        assert_eq!(
            largest_root(0.0.into(), 0.0.into()),
            DoubleDouble::default()
        );
    }

    #[test]
    fn two_roots_that_are_zero_are_numbers() {
        let (zero, one) = (Number::zero(), Number::one());
        let found = both([zero, zero], zero, one);
        assert_eq!([found.0.size(), found.1.size()], [0.0, 0.0]);
        // Else they have their squares and their product.
        for (d2, f2) in [(4.0, 9.0), (9.0, 4.0)] {
            let (d, f) = both([real(d2.into()), real(f2.into())], real(6.0.into()), -one);
            assert_eq!([d.re.high, f.re.high], [-d2.sqrt(), -f2.sqrt()]);
        }
    }
}
