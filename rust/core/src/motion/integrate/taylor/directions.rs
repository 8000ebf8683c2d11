//! Directions that are fixed in space, as seen from the body, by squares of series.
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
pub(super) fn halve<L: Lane, const R: usize>(roots: &[Batch<L, R>; 6]) -> [Batch<L, R>; 6] {
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
    use super::{Batch, add_squares, axis, from_squares, halve, roots};
    use crate::numerics::lane::{BASELINE, Double, Lane};

    type One = Batch<Double<BASELINE>, 1>;

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
                    sums = add_squares(sums, &halve(&root(k / 2)), &root(k / 2));
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
