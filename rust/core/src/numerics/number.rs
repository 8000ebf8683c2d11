//! One algorithm for numbers of either precision: doubles, and sums of two doubles.
//!
//! [`Real`] is for what is done once, with matrices and quotients; [`Number`] for the arithmetic of kernels, where a
//! [`Real`] comes in and goes out.

use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, Scalar};
use num_traits::{One, Zero};

use super::double_double::DoubleDouble;
use super::lane::Lane;

/// A real number, rounded to one precision.
pub trait Real:
    Scalar
    + Copy
    + Default
    + Zero
    + One
    + From<f64>
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    /// The sum of two doubles.
    #[must_use]
    fn pair(high: f64, low: f64) -> Self;
    /// The nearest double.
    #[must_use]
    fn rounded(self) -> f64;
    /// Square root.
    #[must_use]
    fn root(self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn pair(high: f64, low: f64) -> Self {
        high + low
    }

    #[inline(always)]
    fn rounded(self) -> f64 {
        self
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Real for DoubleDouble {
    #[inline]
    fn pair(high: f64, low: f64) -> Self {
        Self::sum(high, low)
    }

    #[inline]
    fn rounded(self) -> f64 {
        self.high
    }

    #[inline]
    fn root(self) -> Self {
        self.sqrt()
    }
}

/// A number of a kernel: a [`Lane`], or one of twice its precision.
pub(crate) trait Number:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// What comes in and goes out without loss.
    type Real: Real;
    /// Whether it carries derivatives.
    const VARIES: bool = false;
    /// The level of its lanes, as a number; 0 for numbers that are computed outside of kernels.
    const LEVEL: u8 = 0;
    /// Zero. Large arrays of it are constants, which are filled at once, where a loop would be compiled for all their numbers.
    const ZERO: Self;
    /// The number `x`.
    fn new(x: f64) -> Self;
    /// The nearest double.
    fn get(self) -> f64;
    /// The number `x`.
    fn of(x: Self::Real) -> Self;
    /// The number itself.
    fn real(self) -> Self::Real;
    /// `self * b + c`, rounded once or twice.
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// 1/n.
    ///
    /// # Panics
    /// When `n` is 64 or more.
    #[must_use]
    fn over(n: usize) -> Self;
    /// `self / n`, as the product with 1/n.
    ///
    /// # Panics
    /// When `n` is 64 or more.
    #[must_use]
    #[inline(always)]
    fn quotient(self, n: usize) -> Self {
        self * Self::over(n)
    }
}

/// 1/n.
const RECIPROCALS: [f64; 64] = {
    let mut reciprocals = [f64::INFINITY; 64];
    let mut n = 1;
    while n < 64 {
        reciprocals[n] = 1.0 / n as f64;
        n += 1;
    }
    reciprocals
};

impl<L: Lane> Number for L {
    type Real = f64;

    const LEVEL: u8 = <L as Lane>::LEVEL;
    const ZERO: Self = <L as Lane>::ZERO;

    #[inline(always)]
    fn new(x: f64) -> Self {
        Lane::new(x)
    }

    #[inline(always)]
    fn get(self) -> f64 {
        Lane::get(self)
    }

    #[inline(always)]
    fn of(x: f64) -> Self {
        Lane::new(x)
    }

    #[inline(always)]
    fn real(self) -> f64 {
        Lane::get(self)
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Lane::mul_add(self, b, c)
    }

    #[inline(always)]
    fn over(n: usize) -> Self {
        Lane::new(RECIPROCALS[n])
    }
}
