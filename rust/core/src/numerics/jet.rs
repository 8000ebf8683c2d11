//! Numbers that carry their first derivatives with them.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{One, Zero};

use super::lane::{BASELINE, Double};
use super::number::{Number, Real};

/// A value and its derivatives with respect to N variables, to first order.
///
/// The derivatives stand first in memory, so that the compiler finds a register of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub(crate) struct Jet<const N: usize> {
    /// Its derivatives.
    pub slopes: [f64; N],
    /// The value.
    pub value: f64,
}

impl<const N: usize> Jet<N> {
    /// A number that depends on none of the variables.
    #[must_use]
    pub(crate) const fn constant(value: f64) -> Self {
        Self {
            value,
            slopes: [0.0; N],
        }
    }

    /// Variable number `index`.
    #[must_use]
    pub(crate) fn variable(value: f64, index: usize) -> Self {
        Self {
            value,
            slopes: std::array::from_fn(|k| f64::from(u8::from(k == index))),
        }
    }

    /// A function of two jets: its value, and its derivatives with respect to each.
    #[inline(always)]
    #[must_use]
    pub(crate) fn chain(value: f64, [(by_p, p), (by_q, q)]: [(f64, &Self); 2]) -> Self {
        // A loop is less to compile than `from_fn`. Rust 1.95 crashes if the loop writes into a jet that exists already, and the core is
        // compiled in one piece.
        let mut slopes = [0.0; N];
        for (k, slope) in slopes.iter_mut().enumerate() {
            *slope = by_p * p.slopes[k] + by_q * q.slopes[k];
        }
        Self { slopes, value }
    }

    /// Multiply value and derivatives by a number.
    #[inline(always)]
    fn scaled(mut self, factor: f64) -> Self {
        self.value *= factor;
        for slope in &mut self.slopes {
            *slope *= factor;
        }
        self
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::chain(self.value + other.value, [(1.0, &self), (1.0, &other)])
    }
}

impl<const N: usize> Add<f64> for Jet<N> {
    type Output = Self;

    #[inline(always)]
    fn add(mut self, number: f64) -> Self {
        self.value += number;
        self
    }
}

impl<const N: usize> Sub for Jet<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::chain(self.value - other.value, [(1.0, &self), (-1.0, &other)])
    }
}

impl<const N: usize> Neg for Jet<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(mut self) -> Self {
        // No `map`: its closure would be compiled without the instructions of the level.
        for slope in &mut self.slopes {
            *slope = -*slope;
        }
        self.value = -self.value;
        self
    }
}

impl<const N: usize> Mul for Jet<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        Self::chain(x * y, [(y, &self), (x, &other)])
    }
}

impl<const N: usize> Mul<f64> for Jet<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.scaled(factor)
    }
}

impl<const N: usize> Div<f64> for Jet<N> {
    type Output = Self;

    fn div(mut self, divisor: f64) -> Self {
        self.value /= divisor;
        for slope in &mut self.slopes {
            *slope /= divisor;
        }
        self
    }
}

impl<const N: usize> Div for Jet<N> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        Self::chain(x / y, [(1.0 / y, &self), (-(x / y) / y, &other)])
    }
}

super::assign::assign_operators!([const N: usize] Jet<N>);

impl<const N: usize> Default for Jet<N> {
    fn default() -> Self {
        Self::constant(0.0)
    }
}

impl<const N: usize> Zero for Jet<N> {
    fn zero() -> Self {
        Self::constant(0.0)
    }

    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<const N: usize> One for Jet<N> {
    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl<const N: usize> From<f64> for Jet<N> {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl<const N: usize> Real for Jet<N> {
    fn pair(high: f64, low: f64) -> Self {
        Self::constant(high + low)
    }

    fn rounded(self) -> f64 {
        self.value
    }

    fn root(self) -> Self {
        let root = self.value.sqrt();
        Self {
            value: root,
            slopes: self.slopes.map(|slope| slope * (0.5 / root)),
        }
    }
}

impl<const N: usize> Number for Jet<N> {
    type Real = Self;

    const VARIES: bool = true;
    const ZERO: Self = Self::constant(0.0);

    fn new(x: f64) -> Self {
        Self::constant(x)
    }

    fn get(self) -> f64 {
        self.value
    }

    fn of(x: Self) -> Self {
        x
    }

    fn real(self) -> Self {
        self
    }

    #[inline(always)]
    fn mul_add(mut self, b: Self, c: Self) -> Self {
        for n in 0..N {
            self.slopes[n] = (self.value * b.slopes[n] + self.slopes[n] * b.value) + c.slopes[n];
        }
        self.value = self.value * b.value + c.value;
        self
    }

    fn over(n: usize) -> Self {
        Self::constant(<Double<BASELINE> as Number>::over(n).get())
    }

    #[inline(always)]
    fn quotient(self, n: usize) -> Self {
        self.scaled(<Double<BASELINE> as Number>::over(n).get())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_of_differentiation() {
        let (x, y) = (Jet::<2>::variable(3.0, 0), Jet::variable(2.0, 1));
        assert_eq!((x + y).slopes, [1.0, 1.0]);
        assert_eq!((x - y).slopes, [1.0, -1.0]);
        assert_eq!((-x).slopes, [-1.0, -0.0]);
        assert_eq!((x * 5.0 - Jet::constant(1.0)).slopes, [5.0, 0.0]);
        assert_eq!((x * x * y).slopes, [12.0, 9.0]);
        assert_eq!((x / y).slopes, [0.5, -0.75]);
        assert_eq!(((x * x).root() - x).slopes, [0.0, 0.0]);
        assert_eq!(x.mul_add(y, x), x * y + x);
        let mut sum = x;
        sum += y;
        sum *= x;
        sum -= y;
        sum /= x;
        assert_eq!(sum, ((x + y) * x - y) / x);
        assert_eq!(Jet::<2>::over(3), Jet::constant(1.0 / 3.0));
        assert_eq!(x.quotient(3), x * Jet::over(3));
        let composed = Jet::chain(7.0, [(2.0, &(x * y)), (5.0, &y)]);
        assert_eq!((composed.value, composed.slopes), (7.0, [4.0, 11.0]));
    }
}
