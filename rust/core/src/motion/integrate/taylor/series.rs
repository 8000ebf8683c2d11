//! Taylor coefficients of ω, of the attitude and of directions fixed in space, and the products of series that their
//! equations are made of.
//!
//! With `a_k = a⁽ᵏ⁾/k!` the product of two series has the coefficients `(a b)_k = Σ_j a_j b_{k−j}`, and the equations
//!
//! ```text
//! ω̇ = κ ω ω + …,   q̇ = ½ q∘ω
//! ```
//!
//! give the coefficients of order k + 1 from those up to k. Nearly all work is in these sums. Of the twelve products of
//! numbers in q∘ω two are saved: with `α = w + i z`, `β = x + i y` and `p = ω₁ + i ω₂` the second equation is
//!
//! ```text
//! 2 β̇ = α p − i ω₃ β,   2 α̇ = −β p̄ + i ω₃ α
//! ```
//!
//! and a complex product takes three real ones. With `S = Re α + Im α` those of α p are `ω₁ S`, `(ω₁ + ω₂) z` and `(ω₂ − ω₁) w`:
//! its parts are the first less the second, and the first plus the third.
//! (Gauss's way; Knuth, The Art of Computer Programming 2, §4.6.4.)
//!
//! The recursion stands here once, for any numbers: [`Coefficients`] are stored, and their products added up, in the way of each kind. In doubles the sums are computed in two ways. [`BatchSeries`](super::batch_series::BatchSeries) puts
//! the same component of several motions in the lanes. [`SingleMotionSeries`](super::single_series::SingleMotionSeries) puts the
//! components of one motion in the lanes, and all of its recursion with them: in half the time of a batch of one.
//! Both add the same products in the same order, so a motion has the same bits in both.
//! [`DoubleDoubleSeries`](super::double_double_series::DoubleDoubleSeries) and
//! [`VariationalSeries`](super::variational_series::VariationalSeries) compute all twelve products.
//!
//! The newest coefficients come last in a sum, because the processor may still be computing them. So a sum goes from the
//! middle outward: first the product of order j < k/2 with k − j, then that of k − j with j.
//!
//! # Directions
//!
//! The direction `e_n` of space, as seen from the body, obeys `γ̇ = γ × ω`: six products of series. With |q| = 1 it can be
//! written with six squares, and the sum for the square of a series is half as long as that for a product. With n, a, b =
//! 1, 2, 3 and cyclic, its components in principal axes are
//!
//! ```text
//! n: 1 − 2 (q_a² + q_b²),   a: (q_n + q_a)² + (w − q_b)² − 1,   b: (q_n + q_b)² + (w + q_a)² − 1
//! ```
//!
//! The coefficient of order k of u² is twice the sum of `u_j u_{k−j}` over j < k/2, and for even k the square in the middle.
//! Here too the sums begin in the middle.

use super::batch::{Batch, cross_term};
use crate::numerics::lane::Lane;
use crate::numerics::number::Number;

/// The highest order of a series in doubles, and the number of its coefficients. The order is even, because
/// [`SingleMotionSeries`](super::single_series::SingleMotionSeries) sums two orders at a time.
pub(super) const MAX_ORDER_DOUBLE: usize = 26;
pub(super) const COUNT: usize = MAX_ORDER_DOUBLE + 1;
/// The highest order of a series in double-double, and the largest number of coefficients of any series.
pub(super) const MAX_ORDER_DOUBLE_DOUBLE: usize = 40;
pub(super) const MAX_COUNT: usize = MAX_ORDER_DOUBLE_DOUBLE + 1;

/// The coefficients of one order: ω in principal axes, (x, y, z, w) of the attitude, and `B` directions that are fixed in
/// space as seen from the principal axes: the vertical `e_3` of three, or all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficient<T, const B: usize> {
    pub(super) w: [T; 3],
    pub(super) q: [T; 4],
    pub(super) g: [[T; 3]; B],
}

/// The coefficients of all orders, of one motion or of several, and the sums of their products.
pub(super) trait Coefficients<T, const B: usize> {
    /// Return coefficients that are all zero.
    fn new() -> Self;
    /// Set which component of ω is constant in all motions: the first, the third or none. Its coefficients of orders above zero
    /// are zero, so their products may be left out.
    fn set_constant_component(&mut self, _component: Option<usize>) {}
    /// Shorten each step until the series of the derivatives are as accurate as those of the motion.
    fn limit(&mut self, _steps: &mut [f64]) {}
    /// Change the unit of rates; `ratio` is the old unit over the new one.
    fn rescale(&mut self, _ratio: f64) {}
    /// Return the coefficient of order `k`. Its directions are known once the sums of that order are computed.
    fn get(&self, k: usize) -> Coefficient<T, B>;
    /// Sums of products of one order.
    type Sums;
    /// Compute the sums of order `k` from the coefficients up to k. Called for one order after the other. The bits depend on the
    /// order of the additions, which each kind of numbers has for itself.
    fn sums(&mut self, k: usize) -> Self::Sums;
    /// Return the sums of ω₂ω₃, ω₃ω₁ and ω₁ω₂.
    fn spins(sums: &Self::Sums) -> [T; 3];
}

/// The recursion, one order after the other.
pub(super) trait Series<T, const B: usize>: Coefficients<T, B> {
    /// Set the coefficient of order zero.
    fn start(&mut self, state: &Coefficient<T, B>);
    /// Compute the coefficients of order k + 1 from the sums and the coefficient of ω̇, both of order `k`.
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[T; 3]);
    /// Compute the change of the state within the time `h`. The order is even. Horner's rule in h² runs for even and odd powers
    /// side by side, because each product waits for the one before.
    fn increment(&self, order: usize, h: T) -> [T; 7];
}

/// The coefficients that the recursion needs of each kind of numbers.
pub(super) trait AnyNumber<T, const B: usize>: Coefficients<T, B> {
    /// Set the coefficient of order `k`; its directions only for order zero where [`Coefficients::sums`] computes them.
    fn put(&mut self, k: usize, coefficient: &Coefficient<T, B>);
    /// Return the sums of q∘ω.
    fn attitude_sums(sums: &Self::Sums) -> [T; 4];
    /// Return the sums of γ×ω for each direction; none where [`Coefficients::sums`] computes the directions.
    fn direction_sums(sums: &Self::Sums) -> Option<[[T; 3]; B]>;
}

impl<L: Number, S: AnyNumber<Batch<L, R>, B>, const R: usize, const B: usize> Series<Batch<L, R>, B>
    for S
{
    #[inline(always)]
    fn start(&mut self, state: &Coefficient<Batch<L, R>, B>) {
        self.put(0, state);
    }

    #[inline(always)]
    fn increment(&self, order: usize, h: Batch<L, R>) -> [Batch<L, R>; 7] {
        let square = h * h;
        let mut odd = [Batch::new(0.0); 7];
        let mut even = [Batch::new(0.0); 7];
        for half in (1..=order / 2).rev() {
            let (one, two) = (self.get(2 * half - 1), self.get(2 * half));
            for i in 0..3 {
                odd[i] = odd[i].mul_add(square, one.w[i]);
                even[i] = even[i].mul_add(square, two.w[i]);
            }
            for i in 0..4 {
                odd[3 + i] = odd[3 + i].mul_add(square, one.q[i]);
                even[3 + i] = even[3 + i].mul_add(square, two.q[i]);
            }
        }
        let mut sum = [Batch::new(0.0); 7];
        for i in 0..7 {
            sum[i] = even[i].mul_add(h, odd[i]) * h;
        }
        sum
    }

    #[inline(always)]
    fn extend(&mut self, k: usize, sums: &S::Sums, acceleration: &[Batch<L, R>; 3]) {
        // Loops, since closures would be compiled without the instructions of the level.
        let mut next = Coefficient {
            w: *acceleration,
            q: S::attitude_sums(sums),
            g: [[Batch::new(0.0); 3]; B],
        };
        for i in 0..3 {
            next.w[i] = next.w[i].quotient(k + 1);
        }
        for i in 0..4 {
            next.q[i] = next.q[i].quotient(2 * (k + 1));
        }
        if let Some(sums) = S::direction_sums(sums) {
            for b in 0..B {
                for i in 0..3 {
                    next.g[b][i] = sums[b][i].quotient(k + 1);
                }
            }
        }
        self.put(k + 1, &next);
    }
}

/// Return the axis of space that is direction `b` of `B`.
pub(super) const fn axis<const B: usize>(b: usize) -> usize {
    if B == 1 { 2 } else { b }
}

/// The six bases u of the squares for each axis n. The last two of eight are not used.
pub(super) const ROOTS: [PairSums; 3] = [roots_of(0), roots_of(1), roots_of(2)];

/// Eight sums of pairs of four numbers: `x[first] + sign x[second]`.
pub(super) struct PairSums {
    pub(super) first: [usize; 8],
    pub(super) second: [usize; 8],
    pub(super) signs: [f64; 8],
}

const fn roots_of(n: usize) -> PairSums {
    let (a, b, w) = ((n + 1) % 3, (n + 2) % 3, 3);
    PairSums {
        first: [a, b, n, w, n, w, n, n],
        second: [n, n, a, b, b, a, n, n],
        signs: [0.0, 0.0, 1.0, -1.0, 1.0, 1.0, 0.0, 0.0],
    }
}

/// Compute the bases u of the squares for the axis n.
#[inline(always)]
pub(super) fn roots<L: Lane, const R: usize>(n: usize, q: &[Batch<L, R>; 4]) -> [Batch<L, R>; 6] {
    let (a, b, n, w) = (q[(n + 1) % 3], q[(n + 2) % 3], q[n], q[3]);
    [a, b, n + a, w - b, n + b, w + a]
}

/// Compute a direction, of an order above zero, from half of each of its three sums of squares.
#[inline(always)]
pub(super) fn from_squares<L: Lane, const R: usize>(
    n: usize,
    halves: [Batch<L, R>; 3],
) -> [Batch<L, R>; 3] {
    let (two, four) = (Batch::new(2.0), Batch::new(-4.0));
    let [along, a, b] = halves;
    let mut direction = [along * four; 3];
    direction[(n + 1) % 3] = a * two;
    direction[(n + 2) % 3] = b * two;
    direction
}

/// Add the products of two orders.
#[inline(always)]
pub(super) fn add_squares<L: Lane, const R: usize>(
    sums: [Batch<L, R>; 6],
    one: &[Batch<L, R>; 6],
    other: &[Batch<L, R>; 6],
) -> [Batch<L, R>; 6] {
    [
        one[0].mul_add(other[0], sums[0]),
        one[1].mul_add(other[1], sums[1]),
        one[2].mul_add(other[2], sums[2]),
        one[3].mul_add(other[3], sums[3]),
        one[4].mul_add(other[4], sums[4]),
        one[5].mul_add(other[5], sums[5]),
    ]
}

#[inline(always)]
pub(super) fn halved<L: Lane, const R: usize>(roots: &[Batch<L, R>; 6]) -> [Batch<L, R>; 6] {
    let half = Batch::new(0.5);
    let [a, b, c, d, e, f] = *roots;
    [a * half, b * half, c * half, d * half, e * half, f * half]
}

/// Compute the components in the body of a direction fixed in space: `Rᵀ e` for the attitude (x, y, z, w).
#[inline(always)]
pub(super) fn direction_in_body<L: Number, const R: usize>(
    q: &[Batch<L, R>; 4],
    e: &[Batch<L, R>; 3],
) -> [Batch<L, R>; 3] {
    let [x, y, z, w] = *q;
    let (u, zero) = ([x, y, z], [Batch::new(0.0); 3]);
    let t = cross_term(&u, e, zero);
    let t = [t[0] + t[0], t[1] + t[1], t[2] + t[2]];
    let mut direction = cross_term(&u, &t, zero);
    for i in 0..3 {
        direction[i] = (-w).mul_add(t[i], e[i]) + direction[i];
    }
    direction
}

#[cfg(test)]
mod tests {
    use super::{Batch, add_squares, axis, from_squares, halved, roots};
    use crate::numerics::lane::{Double, Lane};

    type One = Batch<Double<false>, 1>;

    /// The coefficient of order k of row n of q's matrix, from products.
    fn plain(n: usize, q: &[[i32; 4]], k: usize) -> [i32; 3] {
        let (a, b) = ((n + 1) % 3, (n + 2) % 3);
        let product = |i: usize, j: usize| (0..=k).map(|m| q[m][i] * q[k - m][j]).sum::<i32>();
        let mut row = [0; 3];
        row[n] = product(n, n) + product(3, 3) - product(a, a) - product(b, b);
        row[a] = 2 * (product(n, a) - product(3, b));
        row[b] = 2 * (product(n, b) + product(3, a));
        row
    }

    #[test]
    fn squares_give_the_rows_of_the_matrix_where_the_length_is_constant() {
        // 6 (u cos t + v sin t) for orthogonal u and v of the same length, to the third order in whole numbers.
        let (u, v) = ([2, -1, 3, 5], [1, 2, -5, 3]);
        assert_eq!((0..4).map(|i| u[i] * v[i]).sum::<i32>(), 0);
        let orders: Vec<[i32; 4]> = (0..4)
            .map(|k| match k {
                0 => u.map(|x| 6 * x),
                1 => v.map(|x| 6 * x),
                2 => u.map(|x| -3 * x),
                _ => v.map(|x| -x),
            })
            .collect();
        for n in 0..3 {
            for k in 1..4 {
                let root = |j: usize| {
                    let q = orders[j].map(|x| One::new(f64::from(x)));
                    roots(n, &q)
                };
                let mut sums = [One::new(0.0); 6];
                if k % 2 == 0 {
                    sums = add_squares(sums, &halved(&root(k / 2)), &root(k / 2));
                }
                for j in 0..k.div_ceil(2) {
                    sums = add_squares(sums, &root(j), &root(k - j));
                }
                let [a, b, c, d, e, f] = sums;
                let row = from_squares(n, [a + b, c + d, e + f]).map(|x| x.0[0].get());
                assert_eq!(
                    row,
                    plain(n, &orders, k).map(f64::from),
                    "axis {n}, order {k}"
                );
            }
        }
        assert_eq!((axis::<1>(0), axis::<3>(1)), (2, 1));
    }
}
