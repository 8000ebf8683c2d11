//! Numbers of twice the precision in kernels: two lanes whose sum they are.

use std::ops::{Add, Mul, Neg, Sub};

use super::double_double::{DoubleDouble, fast_two_sum, two_sum};
use super::lane::{BASELINE, Lane};
use super::number::Number;

/// The sum of two lanes, `low` at most half a unit in the last place of `high`: 106 bits.
///
/// As [`DoubleDouble`], with the products that the lanes of the level have. Sums are accurate relative to the larger term.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twofold<L> {
    /// The number rounded to a lane.
    pub high: L,
    /// The rest.
    pub low: L,
}

impl<L: Lane> Twofold<L> {
    /// From a number and a rest that is smaller.
    #[inline(always)]
    pub(crate) fn renormalized(high: L, low: L) -> Self {
        let (high, low) = fast_two_sum(high, low);
        Self { high, low }
    }

    /// `self · b` as a lane and the rest.
    #[inline(always)]
    fn product(self, b: Self) -> (L, L) {
        if <L as Lane>::LEVEL == BASELINE {
            return self.product_in_parts(b);
        }
        self.product_at_once(b)
    }

    /// As [`Self::product`], without fused multiply-add: 21 operations instead of 4, too many to be compiled for every product.
    #[inline(never)]
    fn product_in_parts(self, b: Self) -> (L, L) {
        self.product_at_once(b)
    }

    #[inline(always)]
    fn product_at_once(self, b: Self) -> (L, L) {
        let (p, e) = self.high.two_product(b.high);
        (p, (self.high).mul_add(b.low, self.low.mul_add(b.high, e)))
    }
}

impl<L: Lane> Neg for Twofold<L> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl<L: Lane> Add for Twofold<L> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (s, e) = two_sum(self.high, other.high);
        Self::renormalized(s, e + (self.low + other.low))
    }
}

impl<L: Lane> Sub for Twofold<L> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<L: Lane> Mul for Twofold<L> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (p, e) = self.product(other);
        Self::renormalized(p, e)
    }
}

impl<L: Lane> Number for Twofold<L> {
    type Real = DoubleDouble;

    const LEVEL: u8 = <L as Lane>::LEVEL;
    const ZERO: Self = Self {
        high: <L as Lane>::ZERO,
        low: <L as Lane>::ZERO,
    };

    #[inline(always)]
    fn new(x: f64) -> Self {
        Self {
            high: L::new(x),
            low: L::new(0.0),
        }
    }

    #[inline(always)]
    fn get(self) -> f64 {
        self.high.get()
    }

    #[inline(always)]
    fn of(x: DoubleDouble) -> Self {
        Self {
            high: L::new(x.high),
            low: L::new(x.low),
        }
    }

    #[inline(always)]
    fn real(self) -> DoubleDouble {
        DoubleDouble {
            high: self.high.get(),
            low: self.low.get(),
        }
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        let (p, e) = self.product(b);
        let (s, r) = two_sum(p, c.high);
        Self::renormalized(s, r + (e + c.low))
    }

    #[inline(always)]
    fn over(n: usize) -> Self {
        let (one, n) = (L::new(1.0), L::new(n as f64));
        let high = one / n;
        let (p, e) = high.two_product(n);
        Self {
            high,
            low: ((one - p) - e) / n,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::lane::{AVX2, BASELINE, Double};

    fn arithmetic<L: Lane>() {
        let number = |x: DoubleDouble| Twofold::<L>::of(x);
        let (a, b) = (
            DoubleDouble::sum(0.7, 3e-17),
            DoubleDouble::sum(-1.3, 7e-17),
        );
        let c = DoubleDouble::sum(0.91, -2e-17);
        for (got, want) in [
            (number(a) + number(b), a + b),
            (number(a) - number(b), a - b),
            (number(a) * number(b), a * b),
            (number(a).mul_add(number(b), number(c)), a * b + c),
            (Number::over(7), DoubleDouble::from(1.0) / 7.0.into()),
        ] {
            // a b + c nearly vanishes: the error is relative to c.
            assert!((got.real() - want).high.abs() <= 2.0_f64.powi(-104));
        }
    }

    #[test]
    fn arithmetic_is_that_of_double_doubles() {
        arithmetic::<Double<AVX2>>();
        arithmetic::<Double<BASELINE>>();
    }
}
