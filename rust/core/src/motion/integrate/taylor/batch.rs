//! The same number of several rows, side by side.

use std::ops::{Add, Mul, Neg, Sub};

use crate::numerics::number::Number;

/// One number of `R` rows; with one row plain arithmetic. Every operation acts on each row by itself.
///
/// What holds many of them is aligned to a line of the cache: a register of the widest lanes that lies in two lines takes twice as
/// long to load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch<L, const R: usize>(pub(super) [L; R]);

/// Packs that a function gives, aligned like what holds many of them.
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
    /// The number `x` in every row.
    #[inline(always)]
    pub(super) fn new(x: f64) -> Self {
        Self([L::new(x); R])
    }

    /// 1/n in every row.
    #[inline(always)]
    pub(super) fn over(n: usize) -> Self {
        Self([L::over(n); R])
    }

    /// The number of one row, rounded to a double.
    #[inline(always)]
    pub(super) fn get(&self, row: usize) -> f64 {
        self.0[row].get()
    }

    /// The number of one row.
    #[inline(always)]
    pub(super) fn real(&self, row: usize) -> L::Real {
        self.0[row].real()
    }

    /// Sets the number of one row to a double.
    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, x: f64) {
        self.0[row] = L::new(x);
    }

    /// Sets the number of one row.
    #[inline(always)]
    pub(super) fn put(&mut self, row: usize, x: L::Real) {
        self.0[row] = L::of(x);
    }

    /// `self * b + c`.
    #[inline(always)]
    pub(super) fn mul_add(mut self, b: Self, c: Self) -> Self {
        for row in 0..R {
            self.0[row] = self.0[row].mul_add(b.0[row], c.0[row]);
        }
        self
    }

    /// Each row's number through `f`.
    #[inline(always)]
    pub(super) fn map(mut self, f: impl Fn(L) -> L) -> Self {
        for row in 0..R {
            self.0[row] = f(self.0[row]);
        }
        self
    }
}

/// `sum + a × b`.
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

/// `a + b`.
#[inline(always)]
pub(super) fn plus<L: Number, const R: usize>(
    a: [Batch<L, R>; 3],
    b: [Batch<L, R>; 3],
) -> [Batch<L, R>; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
