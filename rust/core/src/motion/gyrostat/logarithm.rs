//! The elliptic logarithm of a point of the curve, by the chain of means, with the logarithmic derivative of ϑ₁ there.
//!
//! With `c² = P − E″`, `d² = P − E′`, `f² = P − E` a step of the chain is `a′ = ½(a + b)`, `b′ = √(ab)`, `c′ = ½(c + d)`,
//! `d′² = ½(f² + cd + ab)`, `f′² = ½(f² + cd − ab)`, `f′d′ = f c′`: the real period stays and the imaginary one doubles. In the
//! limit `c = a/sin v`, `f = a cot v`. The first step is the one in which E′ and E″ enter by their sum and product alone, so
//! they may as well be complex.

use super::curve::Means;
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

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
const STEPS: usize = 24;
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
    for _ in 0..STEPS {
        let is_last = (a - b).high.abs() <= CLOSE * a.high;
        let (sum, product) = (f.squared() + c * d, real(a * b));
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
