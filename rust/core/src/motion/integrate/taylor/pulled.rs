//! The sums of products of series that the torque of a gravity gradient is made of: see [`GravityGradientSeries`](super::gravity_gradient::GravityGradientSeries).

use std::marker::PhantomData;

use super::batch::{Batch, CacheAligned};
use super::series::Series;
use crate::numerics::dispatch::Kernel;
use crate::numerics::lane::Lane;
use crate::numerics::number::Number;

// The components are written out, since a loop would keep the sums in memory.

/// `sums` and the products that make the coefficients of `c̄ q`, which are `(a − ib)(x + iy)` and `(a − ib)(w + iz)`: three of each,
/// as in [`series`](super::series). They are those of `a` with `x + y`, of `a + b` with x, of `a − b` with y; Re is the first less the
/// third, Im the first less the second.
#[inline(always)]
fn turn_terms<L: Number, const R: usize>(
    [a, b]: &[Batch<L, R>; 2],
    [x, y, z, w]: &[Batch<L, R>; 4],
    [beta, alpha]: [[Batch<L, R>; 3]; 2],
) -> [[Batch<L, R>; 3]; 2] {
    let (sum, difference) = (*a + *b, *a - *b);
    [
        [
            a.mul_add(*x + *y, beta[0]),
            sum.mul_add(*x, beta[1]),
            difference.mul_add(*y, beta[2]),
        ],
        [
            a.mul_add(*w + *z, alpha[0]),
            sum.mul_add(*w, alpha[1]),
            difference.mul_add(*z, alpha[2]),
        ],
    ]
}

/// The sums of the squares that make m: of x, y, z, w, then of x + y, z + w, x + z, y + w.
type Squares<T> = [T; 8];

/// `sums` and the products of two orders, each once.
#[inline(always)]
pub(super) fn square_terms<L: Number, const R: usize>(
    [x, y, z, w]: &[Batch<L, R>; 4],
    [p, q, r, s]: &[Batch<L, R>; 4],
    sums: Squares<Batch<L, R>>,
) -> Squares<Batch<L, R>> {
    [
        x.mul_add(*p, sums[0]),
        y.mul_add(*q, sums[1]),
        z.mul_add(*r, sums[2]),
        w.mul_add(*s, sums[3]),
        (*x + *y).mul_add(*p + *q, sums[4]),
        (*z + *w).mul_add(*r + *s, sums[5]),
        (*x + *z).mul_add(*p + *r, sums[6]),
        (*y + *w).mul_add(*q + *s, sums[7]),
    ]
}

/// `sums` and the products of two orders of m, each once.
#[inline(always)]
fn crossed_terms<L: Number, const R: usize>(
    [a, b, c]: &[Batch<L, R>; 3],
    [p, q, r]: &[Batch<L, R>; 3],
    [first, second, third]: [[Batch<L, R>; 2]; 3],
) -> [[Batch<L, R>; 2]; 3] {
    [
        [b.mul_add(*r, first[0]), c.mul_add(*q, first[1])],
        [c.mul_add(*p, second[0]), a.mul_add(*r, second[1])],
        [a.mul_add(*q, third[0]), b.mul_add(*p, third[1])],
    ]
}

/// Half of the coefficient of m = (x² + w² − y² − z², 2 (xy − zw), 2 (xz + yw)) from the products of two orders, each once; the
/// coefficient from those of one order with itself.
#[inline(always)]
pub(super) fn pointing_from_squares<L: Number, const R: usize>(
    [x, y, z, w, xy, zw, xz, yw]: Squares<Batch<L, R>>,
) -> [Batch<L, R>; 3] {
    let (first, last) = (x + y, z + w);
    [
        (x - y) + (w - z),
        (xy - first) - (zw - last),
        (xz + yw) - (first + last),
    ]
}

// Each of these sums is a function of its own: within a larger one they are not kept in registers.

/// The sums over slices of coefficients of m and of Q, the first with the last and so on: what they give to a coefficient of
/// (m₂m₃, m₃m₁, m₁m₂), and to one of m.
pub(super) struct PairedSums<'a, T> {
    pub(super) pointing: &'a [[T; 3]],
    /// As many.
    pub(super) turned: &'a [[T; 4]],
}

impl<N: Number, const R: usize> Kernel for PairedSums<'_, Batch<N, R>> {
    type Output = CacheAligned<[Batch<N, R>; 6]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let Self { pointing, turned } = self;
        let count = pointing.len();
        let half = count / 2;
        let mut crossed = [[Batch::new(0.0); 2]; 3];
        let mut squared = [Batch::new(0.0); 8];
        let early = pointing[..half].iter().zip(&turned[..half]).rev();
        let late = pointing[count - half..].iter().zip(&turned[count - half..]);
        for ((m, q), (n, p)) in early.zip(late) {
            crossed = crossed_terms(m, n, crossed);
            squared = square_terms(q, p, squared);
        }
        let [first, second, third] = crossed;
        let (x, y) = (first[0] + first[1], second[0] + second[1]);
        let z = third[0] + third[1];
        let [s, t, u] = pointing_from_squares(squared);
        let [s, t, u] = [s + s, t + t, u + u];
        if count.is_multiple_of(2) {
            return CacheAligned([x, y, z, s, t, u]);
        }
        let ([a, b, c], middle) = (pointing[half], &turned[half]);
        let [d, e, f] = pointing_from_squares(square_terms(middle, middle, [Batch::new(0.0); 8]));
        CacheAligned([
            b.mul_add(c, x),
            c.mul_add(a, y),
            a.mul_add(b, z),
            s + d,
            t + e,
            u + f,
        ])
    }
}

/// Coefficients of an attitude.
pub(super) trait AttitudeCoefficients<T> {
    fn at(&self, order: usize) -> [T; 4];
}

impl<T: Copy, const COUNT: usize> AttitudeCoefficients<T> for &[[T; 4]; COUNT] {
    #[inline(always)]
    fn at(&self, order: usize) -> [T; 4] {
        self[order]
    }
}

/// Those of the series of a motion.
pub(super) struct SeriesAttitudes<'a, S, T, const B: usize>(&'a S, PhantomData<T>);

impl<'a, S, T, const B: usize> SeriesAttitudes<'a, S, T, B> {
    #[inline(always)]
    pub(super) fn new(series: &'a S) -> Self {
        Self(series, PhantomData)
    }
}

impl<T: Copy, S: Series<T, B>, const B: usize> AttitudeCoefficients<T>
    for SeriesAttitudes<'_, S, T, B>
{
    #[inline(always)]
    fn at(&self, order: usize) -> [T; 4] {
        self.0.get(order).q
    }
}

/// The sum of the products of the slice backward with the coefficients from order 0 on: what they give to a coefficient of `c̄ q`.
pub(super) struct HalfTurnProduct<'a, T, Q>(pub(super) &'a [[T; 2]], pub(super) Q);

impl<N: Number, Q: AttitudeCoefficients<Batch<N, R>>, const R: usize> Kernel
    for HalfTurnProduct<'_, Batch<N, R>, Q>
{
    type Output = CacheAligned<[Batch<N, R>; 4]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let mut sums = [[Batch::new(0.0); 3]; 2];
        for (order, half) in self.0.iter().rev().enumerate() {
            sums = turn_terms(half, &self.1.at(order), sums);
        }
        let [[p, q, r], [s, t, u]] = sums;
        CacheAligned([p - r, p - q, s - t, s - u])
    }
}
