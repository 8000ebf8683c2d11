//! Error-free transformations, and numbers of twice the precision: a rounded value plus the rest.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{One, Zero};

use super::power_of_two::times_power_of_two;

/// `a + b = s + e` exactly, s the rounded sum (Knuth); for doubles and for [lanes](super::lane::Lane).
#[inline(always)]
#[must_use]
pub(crate) fn two_sum<T: Copy + Add<Output = T> + Sub<Output = T>>(a: T, b: T) -> (T, T) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// `a + b = s + e` exactly when |a| ≥ |b| or a is zero (Dekker).
#[inline(always)]
#[must_use]
pub(crate) fn fast_two_sum<T: Copy + Add<Output = T> + Sub<Output = T>>(a: T, b: T) -> (T, T) {
    let s = a + b;
    (s, b - (s - a))
}

/// `a b = p + e` exactly, p the rounded product (Dekker), for factors below 2⁹⁹⁶.
///
/// Written with Veltkamp's splitting, since a fused multiply-add is a slow library call on machines without one.
#[inline(always)]
#[must_use]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (
        p,
        ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low,
    )
}

/// The upper 26 bits of the significand and the rest.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a; // 2^27 + 1
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// A number as the unevaluated sum of two doubles, `low` at most half a unit in the last place of `high`: 106 bits.
///
/// Every operation is accurate to a few units of 2⁻¹⁰⁶ (Joldes, Muller, Popescu 2017), within the range that
/// `two_product` states.
///
/// # Examples
///
/// ```
/// use polhode::DoubleDouble;
///
/// let exact = DoubleDouble::sum(1.0, 1e-20); // no digit is lost
/// assert_eq!((exact - DoubleDouble::from(1.0)).rounded(), 1e-20);
/// let root = DoubleDouble::from(2.0).sqrt();
/// assert!((root * root - DoubleDouble::from(2.0)).rounded().abs() < 1e-30);
/// assert_eq!(DoubleDouble::product(3.0, 4.0).scaled(0.5).rounded(), 6.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    /// The number rounded to a double.
    pub high: f64,
    /// The rest.
    pub low: f64,
}

impl DoubleDouble {
    /// The sum of any two doubles, exactly.
    #[inline]
    #[must_use]
    pub fn sum(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, b);
        Self { high, low }
    }

    /// π.
    pub const PI: Self = Self {
        high: std::f64::consts::PI,
        low: 1.224_646_799_147_353_2e-16,
    };

    /// 1/2π.
    pub const PER_TURN: Self = Self {
        high: 0.159_154_943_091_895_35,
        low: -9.839_338_337_591_243e-18,
    };

    /// The product of two doubles, exactly within the range that `two_product` states.
    #[inline]
    #[must_use]
    pub fn product(a: f64, b: f64) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// The nearest double.
    #[inline]
    #[must_use]
    pub fn rounded(self) -> f64 {
        self.high
    }

    /// Square root; zero of zero, NaN of what is negative.
    #[inline]
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return Self::default();
        }
        // One step of Newton's method from the reciprocal root (Karp).
        let reciprocal = 1.0 / self.high.sqrt();
        let root = self.high * reciprocal;
        let rest = (self - Self::product(root, root)).high;
        Self::sum(root, rest * (0.5 * reciprocal))
    }

    /// Magnitude.
    #[inline]
    #[must_use]
    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// The number times a power of two, exactly while nothing leaves the range of float64.
    #[inline]
    #[must_use]
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self {
            high: self.high * power_of_two,
            low: self.low * power_of_two,
        }
    }

    /// Times `2^e`, which need not be a number.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::DoubleDouble;
    ///
    /// let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
    /// assert_eq!(third.times_power_of_two(3).rounded(), 8.0 / 3.0); // no digit is lost
    /// ```
    #[must_use]
    #[inline]
    pub fn times_power_of_two(self, e: i32) -> Self {
        Self {
            high: times_power_of_two(self.high, e),
            low: times_power_of_two(self.low, e),
        }
    }

    /// From a double and a rest that is smaller.
    #[inline]
    fn renormalized(high: f64, low: f64) -> Self {
        let (high, low) = fast_two_sum(high, low);
        Self { high, low }
    }
}

impl From<f64> for DoubleDouble {
    #[inline]
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (s, e) = two_sum(self.high, other.high);
        let (t, f) = two_sum(self.low, other.low);
        let (s, e) = fast_two_sum(s, e + t);
        Self::renormalized(s, e + f)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (p, e) = two_product(self.high, other.high);
        Self::renormalized(p, e + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    /// Long division: a digit, and the exact remainder's.
    #[inline]
    fn div(self, other: Self) -> Self {
        let digit = self.high / other.high;
        let (p, e) = two_product(digit, other.high);
        // self.high − p is exact, as the digit is within a rounding of the quotient.
        let rest = (self.high - p) + ((self.low - e) - digit * other.low);
        Self::renormalized(digit, rest / other.high)
    }
}

super::assign::assign_operators!([] DoubleDouble);

impl Zero for DoubleDouble {
    #[inline]
    fn zero() -> Self {
        Self::default()
    }

    #[inline]
    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl One for DoubleDouble {
    #[inline]
    fn one() -> Self {
        Self::from(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_has_twice_the_digits() {
        let third = DoubleDouble::from(1.0) / 3.0.into();
        let one = third + third + third;
        assert!((one - 1.0.into()).high.abs() <= 2.0_f64.powi(-105));
        let small = DoubleDouble::sum(1.0, 2.0_f64.powi(-80));
        // (1 + ε)² − 1 = 2 ε + ε², and ε² is beyond the 106 bits.
        assert_eq!((small * small - 1.0.into()).high, 2.0_f64.powi(-79));
        assert_eq!((small - small).high, 0.0);
        assert!(((small * third) / third - small).high.abs() <= 2.0_f64.powi(-103));
    }

    #[test]
    fn roots_have_twice_the_digits() {
        for x in [2.0, 3.0, 1e-150, 7e140, 0.1] {
            let x = DoubleDouble::product(x, x * (1.0 + f64::EPSILON));
            let root = x.sqrt();
            let rest = (root * root - x).high / x.high;
            assert!(rest.abs() < 2.0_f64.powi(-102), "{x:?} {rest:e}");
        }
        assert_eq!(DoubleDouble::default().sqrt(), DoubleDouble::default());
        assert!(DoubleDouble::from(-1.0).sqrt().high.is_nan());
    }

    #[test]
    fn rests_are_exact() {
        assert_eq!(two_sum(1.0, 2.0_f64.powi(-60)), (1.0, 2.0_f64.powi(-60)));
        assert_eq!(fast_two_sum(1e16, 1.0), (1e16, 1.0));
        let x = 1.0 + 2.0_f64.powi(-30);
        assert_eq!(
            two_product(x, x),
            (1.0 + 2.0_f64.powi(-29), 2.0_f64.powi(-60))
        );
    }
}
