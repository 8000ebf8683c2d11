//! The sums of products of series that the torque of a gravity gradient is made of: see [`Gradient`](super::gradient::Gradient).

use super::pack::{Lined, Pack, plus};
use crate::numerics::dispatch::Kernel;
use crate::numerics::lane::Lane;
use crate::numerics::number::Number;

// The components are written out, since a loop would keep the sums in memory.

/// `sums` and the coefficients of `c̄ q`: Re and Im of `(a − ib)(x + iy)`, then of `(a − ib)(w + iz)` as (z, w), each as what is
/// added and what is taken away.
#[inline(always)]
fn turn_terms<L: Number, const R: usize>(
    [a, b]: &[Pack<L, R>; 2],
    [x, y, z, w]: &[Pack<L, R>; 4],
    [plus, cross]: [[Pack<L, R>; 4]; 2],
) -> [[Pack<L, R>; 4]; 2] {
    [
        [
            a.mul_add(*x, plus[0]),
            a.mul_add(*y, plus[1]),
            a.mul_add(*z, plus[2]),
            a.mul_add(*w, plus[3]),
        ],
        [
            b.mul_add(*y, cross[0]),
            b.mul_add(*x, cross[1]),
            b.mul_add(*w, cross[2]),
            b.mul_add(*z, cross[3]),
        ],
    ]
}

/// The sums of the products that make m: x², w², y², z²; xy twice and zw twice; xz twice and yw twice.
type Squares<T> = [[T; 4]; 3];

/// `sums` and the products of two orders, each once.
#[inline(always)]
pub(super) fn square_terms<L: Number, const R: usize>(
    [x, y, z, w]: &[Pack<L, R>; 4],
    [p, q, r, s]: &[Pack<L, R>; 4],
    [along, second, third]: Squares<Pack<L, R>>,
) -> Squares<Pack<L, R>> {
    [
        [
            x.mul_add(*p, along[0]),
            w.mul_add(*s, along[1]),
            y.mul_add(*q, along[2]),
            z.mul_add(*r, along[3]),
        ],
        [
            x.mul_add(*q, second[0]),
            y.mul_add(*p, second[1]),
            z.mul_add(*s, second[2]),
            w.mul_add(*r, second[3]),
        ],
        [
            x.mul_add(*r, third[0]),
            z.mul_add(*p, third[1]),
            y.mul_add(*s, third[2]),
            w.mul_add(*q, third[3]),
        ],
    ]
}

/// `sums` and the products of two orders of m, each once.
#[inline(always)]
fn crossed_terms<L: Number, const R: usize>(
    [a, b, c]: &[Pack<L, R>; 3],
    [p, q, r]: &[Pack<L, R>; 3],
    [first, second, third]: [[Pack<L, R>; 2]; 3],
) -> [[Pack<L, R>; 2]; 3] {
    [
        [b.mul_add(*r, first[0]), c.mul_add(*q, first[1])],
        [c.mul_add(*p, second[0]), a.mul_add(*r, second[1])],
        [a.mul_add(*q, third[0]), b.mul_add(*p, third[1])],
    ]
}

/// Half of the coefficient of m from the products of two orders, each once; the coefficient from those of one order with itself.
#[inline(always)]
pub(super) fn pointed<L: Number, const R: usize>(
    [a, b, c]: Squares<Pack<L, R>>,
) -> [Pack<L, R>; 3] {
    let along = (a[0] + a[1]) - (a[2] + a[3]);
    [
        along,
        (b[0] + b[1]) - (b[2] + b[3]),
        (c[0] + c[1]) + (c[2] + c[3]),
    ]
}

// Each of these sums is a function of its own: within a larger one they are not kept in registers.

/// The sum over a slice of coefficients of m, the first with the last and so on: what they give to a coefficient of (m₂m₃, m₃m₁, m₁m₂).
pub(super) struct Crossed<'a, T>(pub(super) &'a [[T; 3]]);

impl<N: Number, const R: usize> Kernel for Crossed<'_, Pack<N, R>> {
    type Output = Lined<[Pack<N, R>; 3]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let half = self.0.len() / 2;
        let mut sums = [[Pack::new(0.0); 2]; 3];
        let late = &self.0[self.0.len() - half..];
        for (early, late) in self.0[..half].iter().rev().zip(late) {
            sums = crossed_terms(early, late, sums);
        }
        let [first, second, third] = sums;
        let (x, y) = (first[0] + first[1], second[0] + second[1]);
        let z = third[0] + third[1];
        if self.0.len().is_multiple_of(2) {
            return Lined([x, y, z]);
        }
        let [a, b, c] = self.0[half];
        Lined([b.mul_add(c, x), c.mul_add(a, y), a.mul_add(b, z)])
    }
}

/// The sum over a slice of coefficients of Q, the first with the last and so on: what they give to a coefficient of m.
pub(super) struct Squared<'a, T>(pub(super) &'a [[T; 4]]);

impl<N: Number, const R: usize> Kernel for Squared<'_, Pack<N, R>> {
    type Output = Lined<[Pack<N, R>; 3]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let half = self.0.len() / 2;
        let mut sums = [[Pack::new(0.0); 4]; 3];
        let late = &self.0[self.0.len() - half..];
        for (early, late) in self.0[..half].iter().rev().zip(late) {
            sums = square_terms(early, late, sums);
        }
        let m = pointed(sums);
        let m = plus(m, m);
        if self.0.len().is_multiple_of(2) {
            return Lined(m);
        }
        let middle = &self.0[half];
        Lined(plus(
            m,
            pointed(square_terms(middle, middle, [[Pack::new(0.0); 4]; 3])),
        ))
    }
}

/// The sum of the products of the first slice backward with the second: what they give to a coefficient of `c̄ q`.
pub(super) struct Turned<'a, T>(pub(super) &'a [[T; 2]], pub(super) &'a [[T; 4]]);

impl<N: Number, const R: usize> Kernel for Turned<'_, Pack<N, R>> {
    type Output = Lined<[Pack<N, R>; 4]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let mut sums = [[Pack::new(0.0); 4]; 2];
        for (half, q) in self.0.iter().rev().zip(self.1) {
            sums = turn_terms(half, q, sums);
        }
        let [p, s] = sums;
        Lined([p[0] + s[0], p[1] - s[1], p[2] - s[2], p[3] + s[3]])
    }
}
