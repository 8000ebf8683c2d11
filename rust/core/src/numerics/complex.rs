//! Complex numbers of any precision that the chain of means knows.

use std::ops::{Add, Mul, Neg, Sub};

use super::double_double::DoubleDouble;
use super::elliptic::MultiPrecision;

/// `re + i im`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Complex<T> {
    /// Real part.
    pub re: T,
    /// Imaginary part.
    pub im: T,
}

/// Within these bounds no square of a part that counts has left the range of float64.
const LEAST_SQUARE: f64 = 1e-270;
const MOST_SQUARE: f64 = 1e300;

impl<T: MultiPrecision> Complex<T> {
    /// From real and imaginary part.
    #[inline]
    #[must_use]
    pub(crate) fn new(re: T, im: T) -> Self {
        Self { re, im }
    }

    /// Zero.
    #[inline]
    #[must_use]
    pub(crate) fn zero() -> Self {
        Self::new(0.0.into(), 0.0.into())
    }

    /// One.
    #[inline]
    #[must_use]
    pub(crate) fn one() -> Self {
        Self::new(1.0.into(), 0.0.into())
    }

    /// `i z`.
    #[inline]
    #[must_use]
    pub(crate) fn times_i(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// `z̄`.
    #[inline]
    #[must_use]
    pub(crate) fn conjugate(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// `k z` for a real k.
    #[inline]
    #[must_use]
    pub(crate) fn times(self, k: T) -> Self {
        Self::new(k * self.re, k * self.im)
    }

    /// `z` times a power of two.
    #[inline]
    #[must_use]
    pub(crate) fn scaled(self, power_of_two: f64) -> Self {
        Self::new(self.re.scaled(power_of_two), self.im.scaled(power_of_two))
    }

    /// `|z|²`.
    #[inline]
    #[must_use]
    pub(crate) fn norm_squared(self) -> T {
        self.re * self.re + self.im * self.im
    }

    /// |z| rounded.
    #[inline]
    #[must_use]
    pub(crate) fn size(self) -> f64 {
        self.re.rounded().hypot(self.im.rounded())
    }

    /// |z| within a factor of √2, sooner: the sum of the sizes of its parts.
    #[inline]
    #[must_use]
    pub(crate) fn taxicab(self) -> f64 {
        self.re.rounded().abs() + self.im.rounded().abs()
    }

    /// `z²`.
    #[inline]
    #[must_use]
    pub(crate) fn square(self) -> Self {
        let product = self.re * self.im;
        Self::new(
            (self.re - self.im) * (self.re + self.im),
            product.scaled(2.0),
        )
    }

    /// `a/b`; not a number where b is zero.
    #[inline]
    #[must_use]
    pub(crate) fn over(self, b: Self) -> Self {
        let inverse = T::from(1.0) / b.norm_squared();
        (self * b.conjugate()).times(inverse)
    }

    /// Whether `Re(a b̄) < 0`: a and b point to opposite sides.
    #[inline]
    #[must_use]
    pub(crate) fn is_opposite_to(self, b: Self) -> bool {
        self.re.rounded() * b.re.rounded() + self.im.rounded() * b.im.rounded() < 0.0
    }
}

impl Complex<DoubleDouble> {
    /// The square root in the right half plane: that of the rounded number, and one step of Newton's method.
    #[must_use]
    pub(crate) fn sqrt(self) -> Self {
        let (x, y) = (self.re.high, self.im.high);
        let square = x * x + y * y;
        let size = if (LEAST_SQUARE..=MOST_SQUARE).contains(&square) {
            square.sqrt()
        } else {
            x.hypot(y)
        };
        let larger = (0.5 * (size + x.abs())).sqrt();
        if larger == 0.0 {
            return Self::zero();
        }
        let smaller = 0.5 * y / larger;
        let (x, y) = if x >= 0.0 {
            (larger, smaller)
        } else if y < 0.0 {
            (-smaller, -larger)
        } else {
            (smaller, larger)
        };
        let square = DoubleDouble::product(x, x) - DoubleDouble::product(y, y);
        let rest = (self.re - square).high;
        let across = (self.im - DoubleDouble::product(x, y).scaled(2.0)).high;
        let half = 0.5 / size;
        Self::new(
            DoubleDouble::sum(x, (rest * x + across * y) * half),
            DoubleDouble::sum(y, (across * x - rest * y) * half),
        )
    }
}

impl<T: MultiPrecision> Add for Complex<T> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl<T: MultiPrecision> Sub for Complex<T> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl<T: MultiPrecision> Neg for Complex<T> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}

impl<T: MultiPrecision> Mul for Complex<T> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::new(
            self.re * other.re - self.im * other.im,
            self.re * other.im + self.im * other.re,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_and_quotients_undo_products() {
        let number = |re: f64, im: f64| {
            Complex::new(
                DoubleDouble::product(re, 1.0 / 3.0),
                DoubleDouble::product(im, 0.7),
            )
        };
        for z in [
            number(1.0, 2.0),
            number(-3.0, 1e-9),
            number(-3.0, -1e-9),
            number(0.0, 4.0),
            number(2.0, 0.0),
            number(-2.0, 0.0),
        ] {
            let root = z.sqrt();
            assert!(root.re.high >= 0.0);
            assert!((root * root - z).size() <= 1e-30 * z.size());
            assert!((root.square() - z).size() <= 1e-30 * z.size());
            let w = number(0.3, -5.0);
            assert!(((z * w).over(w) - z).size() <= 1e-30 * z.size());
        }
        assert_eq!(Complex::<DoubleDouble>::zero().sqrt(), Complex::zero());
    }

    #[test]
    fn roots_keep_their_digits_on_both_sides_of_where_squares_leave_the_range() {
        for bound in [LEAST_SQUARE.sqrt(), MOST_SQUARE.sqrt()] {
            for factor in [1e-3, 0.99, 1.01, 1e3] {
                let size = bound * factor;
                for (x, y) in [(0.6, 0.8), (-0.6, 0.8), (-1.0, 1e-9), (0.0, -1.0)] {
                    let z = Complex::new(DoubleDouble::from(x * size), (y * size).into());
                    let root = z.sqrt();
                    let off = root.square() - z;
                    assert!(off.size() <= 1e-30 * z.size(), "{x} {y} times {size:e}");
                }
            }
        }
    }

    #[test]
    fn the_sum_of_parts_is_the_size_within_the_root_of_two() {
        for k in 0..64 {
            let (y, x) = (0.1 * f64::from(k)).sin_cos();
            let sum = Complex::new(x, y).taxicab();
            assert!((1.0 - 1e-15..=std::f64::consts::SQRT_2 + 1e-15).contains(&sum));
        }
    }

    #[test]
    fn what_is_more_than_a_right_angle_apart_is_opposite() {
        let number = |re: f64, im: f64| Complex::new(DoubleDouble::from(re), im.into());
        for (a, is_opposite) in [(-1e-9, true), (0.0, false), (1e-9, false)] {
            assert_eq!(
                number(a, 1.0).is_opposite_to(number(1.0, 0.0)),
                is_opposite,
                "{a}"
            );
            assert_eq!(
                number(1.0, 1.0).is_opposite_to(number(-1.0, a + 1.0)),
                a < 0.0,
                "{a}"
            );
        }
    }
}
