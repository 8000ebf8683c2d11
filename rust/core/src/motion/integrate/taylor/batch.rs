//! Arithmetic with one number of several motions. Each motion is a *row*.

use std::ops::{Add, Mul, Neg, Sub};

use crate::numerics::number::Number;

/// One number of `R` rows. Every operation acts on each row separately.
///
/// Types that contain many of them are aligned to a cache line: a register of the widest lanes that lies in two cache lines takes
/// twice as long to load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch<L, const R: usize>(pub(super) [L; R]);

/// The result of a function, aligned to a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct CacheAligned<T>(pub(super) T);

macro_rules! each {
    ($operator:ident, $method:ident, $symbol:tt) => {
        impl<L: Number, const R: usize> $operator for Batch<L, R> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for row in 0..R {
                    self.0[row] = self.0[row] $symbol other.0[row];
                }
                self
            }
        }
    };
}
each!(Add, add, +);
each!(Sub, sub, -);
each!(Mul, mul, *);

impl<L: Number, const R: usize> Neg for Batch<L, R> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

impl<L: Number, const R: usize> Batch<L, R> {
    /// Zero in every row.
    pub(super) const ZERO: Self = Self([L::ZERO; R]);

    /// Return the number `x` in every row.
    #[inline(always)]
    pub(super) fn new(x: f64) -> Self {
        Self([L::new(x); R])
    }

    /// Return 1/n in every row.
    #[inline(always)]
    pub(super) fn over(n: usize) -> Self {
        Self([L::over(n); R])
    }

    /// Compute `self / n`, as the product with 1/n.
    #[inline(always)]
    pub(super) fn quotient(mut self, n: usize) -> Self {
        for row in 0..R {
            self.0[row] = self.0[row].quotient(n);
        }
        self
    }

    /// Return the number of one row, rounded to a double.
    #[inline(always)]
    pub(super) fn get(&self, row: usize) -> f64 {
        self.0[row].get()
    }

    /// Return the number of one row.
    #[inline(always)]
    pub(super) fn real(&self, row: usize) -> L::Real {
        self.0[row].real()
    }

    /// Return `H` rows from row `FIRST` on.
    #[inline(always)]
    pub(super) fn rows<const FIRST: usize, const H: usize>(&self) -> Batch<L, H> {
        Batch(std::array::from_fn(|i| self.0[FIRST + i]))
    }

    /// Set `H` rows from row `FIRST` on.
    #[inline(always)]
    pub(super) fn put_rows<const FIRST: usize, const H: usize>(&mut self, rows: Batch<L, H>) {
        for i in 0..H {
            self.0[FIRST + i] = rows.0[i];
        }
    }

    /// Set the number of one row to a double.
    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, x: f64) {
        self.0[row] = L::new(x);
    }

    /// Set the number of one row.
    #[inline(always)]
    pub(super) fn put(&mut self, row: usize, x: L::Real) {
        self.0[row] = L::of(x);
    }

    /// Compute `self * b + c`.
    #[inline(always)]
    pub(super) fn mul_add(mut self, b: Self, c: Self) -> Self {
        for row in 0..R {
            self.0[row] = self.0[row].mul_add(b.0[row], c.0[row]);
        }
        self
    }

    /// Apply `f` to the number of each row.
    #[inline(always)]
    pub(super) fn map(mut self, f: impl Fn(L) -> L) -> Self {
        for row in 0..R {
            self.0[row] = f(self.0[row]);
        }
        self
    }
}

/// Compute `sum + a × b`.
#[inline(always)]
pub(super) fn cross_term<L: Number, const R: usize>(
    a: &[Batch<L, R>; 3],
    b: &[Batch<L, R>; 3],
    sum: [Batch<L, R>; 3],
) -> [Batch<L, R>; 3] {
    [
        a[1].mul_add(b[2], (-a[2]).mul_add(b[1], sum[0])),
        a[2].mul_add(b[0], (-a[0]).mul_add(b[2], sum[1])),
        a[0].mul_add(b[1], (-a[1]).mul_add(b[0], sum[2])),
    ]
}

/// Compute `a + b`.
#[inline(always)]
pub(super) fn plus<L: Number, const R: usize>(
    a: [Batch<L, R>; 3],
    b: [Batch<L, R>; 3],
) -> [Batch<L, R>; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
