//! Numbers of four times the precision, for the few differences that decide what a motion does for ever after.
//!
//! Near a separatrix the difference of two large terms sets the period. What [`DoubleDouble`] leaves of it when its first
//! hundred bits cancel is too little; here two hundred are carried. Slow, and used only where that happens.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::double_double::{DoubleDouble, fast_two_sum, two_product, two_sum};

/// A number as the unevaluated sum of four doubles, each at most half a unit in the last place of the one before: 212 bits.
///
/// Sums and products are accurate to a few units of 2⁻²⁰⁸ of the larger term, quotients and roots of themselves, within the
/// range that [`two_product`] states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct QuadDouble([f64; 4]);

impl QuadDouble {
    /// π.
    pub(crate) const PI: Self = Self([
        std::f64::consts::PI,
        1.224_646_799_147_353_2e-16,
        -2.994_769_809_718_339_7e-33,
        1.112_454_220_863_365_3e-49,
    ]);

    /// π/2.
    pub(crate) const HALF_PI: Self = Self([
        Self::PI.0[0] / 2.0,
        Self::PI.0[1] / 2.0,
        Self::PI.0[2] / 2.0,
        Self::PI.0[3] / 2.0,
    ]);

    /// The nearest double.
    #[must_use]
    pub(crate) fn rounded(self) -> f64 {
        self.0[0]
    }

    /// The nearest number of twice the precision.
    #[must_use]
    pub(crate) fn twofold(self) -> DoubleDouble {
        let [a, b, c, _] = self.0;
        DoubleDouble::sum(a, b + c)
    }

    /// The number times a power of two, exactly while nothing leaves the range of float64.
    #[must_use]
    pub(crate) fn scaled(self, power_of_two: f64) -> Self {
        Self(self.0.map(|part| part * power_of_two))
    }

    /// Square root; zero of zero, NaN of what is negative.
    #[must_use]
    pub(crate) fn sqrt(self) -> Self {
        if self.0[0] == 0.0 {
            return Self::default();
        }
        // One step of Newton's method from the root to twice the precision.
        let root = self.twofold().sqrt();
        let start = Self::from(root);
        let rest = (self - start * start).twofold() / (root + root);
        start + rest.into()
    }

    /// The sum of terms of any sizes: sweeps of error-free sums gather it in the first ones.
    fn of_terms<const N: usize>(mut terms: [f64; N]) -> Self {
        for _ in 0..SWEEPS {
            gather(&mut terms);
        }
        let mut parts = [0.0; 4];
        for (k, part) in parts.iter_mut().enumerate() {
            gather(&mut terms[k..]);
            *part = terms[k];
        }
        // Each part is near the rounded rest; carries go up once more.
        gather(&mut parts);
        for k in 0..3 {
            (parts[k], parts[k + 1]) = fast_two_sum(parts[k], parts[k + 1]);
        }
        Self(parts)
    }
}

/// After so many sweeps the errors of a sum are 2⁻²¹² of its largest term.
const SWEEPS: usize = 3;

/// Error-free sums from the last term to the first, which becomes the rounded sum of them all.
fn gather(terms: &mut [f64]) {
    for k in (1..terms.len()).rev() {
        (terms[k - 1], terms[k]) = two_sum(terms[k - 1], terms[k]);
    }
}

impl From<f64> for QuadDouble {
    fn from(x: f64) -> Self {
        Self([x, 0.0, 0.0, 0.0])
    }
}

impl From<DoubleDouble> for QuadDouble {
    fn from(x: DoubleDouble) -> Self {
        Self([x.high, x.low, 0.0, 0.0])
    }
}

impl Neg for QuadDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|part| -part))
    }
}

impl Add for QuadDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        Self::of_terms([a, p, b, q, c, r, d, s])
    }
}

impl Sub for QuadDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for QuadDouble {
    type Output = Self;

    /// The products of parts down to 2⁻²¹² of the first, those above it with their rests.
    fn mul(self, other: Self) -> Self {
        let mut terms = [0.0; 23];
        let mut filled = 0;
        for order in 0..=4_usize {
            for i in order.saturating_sub(3)..=order.min(3) {
                let (a, b) = (self.0[i], other.0[order - i]);
                if order < 4 {
                    let (product, rest) = two_product(a, b);
                    terms[filled] = product;
                    terms[filled + 1] = rest;
                    filled += 2;
                } else {
                    terms[filled] = a * b;
                    filled += 1;
                }
            }
        }
        Self::of_terms(terms)
    }
}

impl Div for QuadDouble {
    type Output = Self;

    /// Long division, a digit of twice the precision at a time.
    fn div(self, other: Self) -> Self {
        let divisor = other.twofold();
        let digit = Self::from(self.twofold() / divisor);
        let rest = self - digit * other;
        let next = Self::from(rest.twofold() / divisor);
        let last = (rest - next * other).twofold() / divisor;
        digit + next + last.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size(x: QuadDouble) -> f64 {
        x.rounded().abs()
    }

    #[test]
    fn arithmetic_has_four_times_the_digits() {
        let one = QuadDouble::from(1.0);
        let third = one / 3.0.into();
        assert!(size(third + third + third - one) <= 2.0_f64.powi(-208));
        let small = one + 2.0_f64.powi(-100).into() + 2.0_f64.powi(-180).into();
        assert_eq!(
            size(small - one - 2.0_f64.powi(-100).into()),
            2.0_f64.powi(-180)
        );
        // (1 + x)² − 1 − 2x = x².
        let x = QuadDouble::from(2.0_f64.powi(-90));
        let square = (one + x) * (one + x) - one - x - x;
        assert_eq!(size(square), 2.0_f64.powi(-180));
        assert_eq!(size(small - small), 0.0);
        assert!(size((small * third) / third - small) <= 2.0_f64.powi(-206));
    }

    #[test]
    fn products_of_full_numbers_are_exact_to_their_last_bits() {
        // (a + b)² − (a − b)² = 4ab for numbers of 53 bits.
        let (a, b) = (std::f64::consts::E, 1e-9 / 3.0);
        let (sum, difference) = (
            QuadDouble::from(a) + b.into(),
            QuadDouble::from(a) - b.into(),
        );
        let product = QuadDouble::from(DoubleDouble::product(a, b)).scaled(4.0);
        let rest = sum * sum - difference * difference - product;
        assert!(size(rest) <= 2.0_f64.powi(-205), "{rest:?}");
    }

    #[test]
    fn roots_have_four_times_the_digits() {
        for x in [2.0, 3.0, 1e-150, 7e140, 0.1] {
            let x = QuadDouble::from(x) / 3.0.into();
            let root = x.sqrt();
            let rest = size(root * root - x) / x.rounded();
            assert!(rest < 2.0_f64.powi(-203), "{x:?} {rest:e}");
        }
        assert_eq!(QuadDouble::default().sqrt(), QuadDouble::default());
        assert!(QuadDouble::from(-1.0).sqrt().rounded().is_nan());
    }

    #[test]
    fn pi_is_that_of_machin() {
        // π = 16 atan 1/5 − 4 atan 1/239.
        let inverse_tangent = |n: f64| {
            let n = QuadDouble::from(n);
            let (mut power, mut sum) = (QuadDouble::from(1.0) / n, QuadDouble::default());
            for k in 0..160 {
                let term = power / f64::from(2 * k + 1).into();
                sum = if k % 2 == 0 { sum + term } else { sum - term };
                power = power / (n * n);
            }
            sum
        };
        let pi = inverse_tangent(5.0).scaled(16.0) - inverse_tangent(239.0).scaled(4.0);
        assert!(size(pi - QuadDouble::PI) <= 2.0_f64.powi(-203));
    }
}
