//! Numbers of four times the precision, for the few differences that decide what a motion does for ever after.
//!
//! Near a separatrix the difference of two large terms sets the period. What [`DoubleDouble`] leaves of it when its first
//! hundred bits cancel is too little; here two hundred are carried, and only where that happens.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::double_double::{DoubleDouble, fast_two_sum, two_product, two_sum};

/// A number as the unevaluated sum of four doubles, each at most half a unit in the last place of the one before: 212 bits.
///
/// Sums are accurate to 2⁻²⁰⁶ of the larger term, products, quotients and roots to 2⁻²⁰³ of themselves, within the range that
/// [`two_product`] states.
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

    /// The sum of parts that need not be apart, each near a unit in the last place of the one before, or below it.
    #[inline]
    fn of_parts([mut a, mut b, mut c, mut d]: [f64; 4]) -> Self {
        // Up once, what is carried; then what is left between two parts goes to the upper one.
        (c, d) = two_sum(c, d);
        (b, c) = two_sum(b, c);
        (a, b) = two_sum(a, b);
        (b, c) = fast_two_sum(b, c);
        (c, d) = fast_two_sum(c, d);
        Self([a, b, c, d])
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

    /// Parts of one order, and the errors of their sums to the next order.
    #[inline]
    fn add(self, other: Self) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        let (first, e1) = two_sum(a, p);
        let (second, e2) = two_sum(b, q);
        let (third, e3) = two_sum(c, r);
        let (second, f2) = two_sum(second, e1);
        let (third, f3) = two_sum(third, e2);
        let (third, g3) = two_sum(third, f2);
        Self::of_parts([first, second, third, (d + s) + (e3 + f3 + g3)])
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

    /// The products of parts down to 2⁻¹⁵⁹ of the first, those above it with their errors.
    #[inline]
    fn mul(self, other: Self) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        let (first, e1) = two_product(a, p);
        let [(ap, e2), (bp, f2)] = [two_product(a, q), two_product(b, p)];
        let (sum, g2) = two_sum(ap, bp);
        let (second, h2) = two_sum(sum, e1);
        let [(ar, e3), (bq, f3), (cp, g3)] =
            [two_product(a, r), two_product(b, q), two_product(c, p)];
        let (outer, h3) = two_sum(ar, cp);
        let (inner, i3) = two_sum(bq, e2);
        let (errors, j3) = two_sum(f2, g2);
        let (sum, k3) = two_sum(outer, inner);
        let (rest, l3) = two_sum(errors, h2);
        let (third, m3) = two_sum(sum, rest);
        let products = (a * s + d * p) + (b * r + c * q);
        let of_products = (e3 + g3) + f3;
        let of_sums = ((h3 + i3) + (j3 + k3)) + (l3 + m3);
        Self::of_parts([first, second, third, products + (of_products + of_sums)])
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
    use proptest::prelude::*;

    use super::*;
    use crate::numerics::expansion::Expansion;

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

    /// What a sum of terms lacks to be this number.
    fn rest(found: QuadDouble, terms: &[f64]) -> f64 {
        let mut sum = Expansion::default();
        for &x in terms {
            sum.add(x);
        }
        for part in found.0 {
            sum.add(-part);
        }
        sum.rounded()
    }

    /// Numbers whose parts have gaps of any size between them, or none.
    fn number() -> impl Strategy<Value = QuadDouble> {
        let part = (any::<bool>(), 1.0..2.0_f64, 53..75_i32);
        [part.clone(), part.clone(), part.clone(), part].prop_map(|parts| {
            let mut size = 0;
            parts.into_iter().fold(
                QuadDouble::default(),
                |sum, (is_negative, digits, below)| {
                    size -= below;
                    let part = digits * 2.0_f64.powi(53 + size);
                    sum + QuadDouble::from(if is_negative { -part } else { part })
                },
            )
        })
    }

    proptest! {
        #[test]
        fn sums_are_exact_but_for_their_last_bits(a in number(), b in number(), scale in -220..5_i32) {
            let b = b.scaled(2.0_f64.powi(scale));
            let terms = [a.0, b.0].concat();
            let larger = size(a).max(size(b));
            prop_assert!(rest(a + b, &terms).abs() <= 2.0_f64.powi(-206) * larger);
            prop_assert!(rest(a - a, &[]).abs() == 0.0);
            // What cancels leaves what is exact.
            let difference = (a + b) - a;
            prop_assert!(size(difference - b) <= 2.0_f64.powi(-205) * larger);
        }

        #[test]
        fn products_are_exact_but_for_their_last_bits(a in number(), b in number()) {
            let terms: Vec<f64> = (a.0.into_iter())
                .flat_map(|x| b.0.map(|y| <[f64; 2]>::from(two_product(x, y))))
                .flatten()
                .collect();
            let product = a * b;
            prop_assert!(rest(product, &terms).abs() <= 2.0_f64.powi(-206) * size(product));
        }

        #[test]
        fn parts_are_apart(a in number(), b in number(), scale in -220..5_i32) {
            let b = b.scaled(2.0_f64.powi(scale));
            for found in [a + b, a - b, a * b] {
                for pair in found.0.windows(2) {
                    prop_assert!(pair[0] + pair[1] == pair[0], "{found:?}");
                }
            }
        }
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
