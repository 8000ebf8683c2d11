//! The sums over a block of simplices, eight side by side, and blocks merged in a fixed tree.

use std::marker::PhantomData;

use super::frame::{LocalFrame, Place, Shifted, Turned};
use super::kinds::Kind;
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::planes::{Planes, ROWS};

/// N stored corners for each simplex.
pub(in crate::mass) trait Corners<const N: usize>: Sync {
    fn count(&self) -> usize;
    /// The corners of one simplex; NaN where there is no such corner.
    fn corners(&self, index: usize) -> [[f64; 3]; N];
}

/// Content, its magnitude, first moment (3), second moment (6), what rounding is relative to (3), extents (3).
pub(super) const TERMS: usize = 17;
/// The terms that are summed; of the others the largest counts.
const SUMMED: usize = 14;
const LANES: usize = 8;

/// The sums over one block, or over several.
pub(in crate::mass) type Partial = [f64; TERMS];

#[inline(always)]
fn terms<L: Lane, K: Kind<N>, const N: usize>(corners: &[[L; 3]; N]) -> [L; TERMS] {
    let (w, scale) = K::content(corners);
    let mut s = corners[0];
    let mut extent = [
        corners[0][0].abs(),
        corners[0][1].abs(),
        corners[0][2].abs(),
    ];
    let mut n = 1;
    while n < N {
        let mut k = 0;
        while k < 3 {
            s[k] = s[k] + corners[n][k];
            extent[k] = extent[k].max(corners[n][k].abs());
            k += 1;
        }
        n += 1;
    }
    [
        w,
        w.abs(),
        w * s[0],
        w * s[1],
        w * s[2],
        w * product(corners, &s, 0, 0),
        w * product(corners, &s, 0, 1),
        w * product(corners, &s, 0, 2),
        w * product(corners, &s, 1, 1),
        w * product(corners, &s, 1, 2),
        w * product(corners, &s, 2, 2),
        scale[0],
        scale[1],
        scale[2],
        extent[0],
        extent[1],
        extent[2],
    ]
}

/// `Σ v_i v_j + s_i s_j`.
#[inline(always)]
fn product<L: Lane, const N: usize>(corners: &[[L; 3]; N], s: &[L; 3], i: usize, j: usize) -> L {
    let mut sum = s[i] * s[j];
    let mut n = 0;
    while n < N {
        sum = corners[n][i].mul_add(corners[n][j], sum);
        n += 1;
    }
    sum
}

/// Sums over the simplices of one block.
struct Block<'a, C, P, K, const N: usize> {
    corners: &'a C,
    from: usize,
    to: usize,
    place: P,
    /// Where a simplex has no content.
    nowhere: [f64; 3],
    kind: PhantomData<K>,
}

impl<C: Corners<N>, P: Place, K: Kind<N>, const N: usize> Kernel for Block<'_, C, P, K, N> {
    type Output = Partial;

    #[inline(always)]
    fn run<L: Lane>(self) -> Partial {
        let place = self.place;
        let mut lanes = [[0.0; LANES]; TERMS];
        let mut batch = [Planes::<3>::ZERO; N];
        let mut results = Planes::<TERMS>::ZERO;
        let mut from = self.from;
        while from < self.to {
            let rows = ROWS.min(self.to - from);
            for row in 0..rows {
                let corners = self.corners.corners(from + row);
                for (planes, corner) in batch.iter_mut().zip(corners) {
                    planes.set(row, corner);
                }
            }
            // The last batch may be short: its other rows count nothing.
            for row in rows..ROWS {
                for planes in &mut batch {
                    planes.set(row, self.nowhere);
                }
            }
            for row in 0..ROWS {
                let mut placed = [[L::new(0.0); 3]; N];
                let mut n = 0;
                while n < N {
                    placed[n] = place.place(batch[n].lanes::<L>(row));
                    n += 1;
                }
                results.set_lanes(row, terms::<L, K, N>(&placed));
            }
            results.add_to(&mut lanes, SUMMED);
            from += rows;
        }
        let mut partial = [0.0; TERMS];
        for (k, (total, [a, b, c, d, e, f, g, h])) in partial.iter_mut().zip(lanes).enumerate() {
            *total = if k < SUMMED {
                ((a + e) + (c + g)) + ((b + f) + (d + h))
            } else {
                [b, c, d, e, f, g, h].into_iter().fold(a, f64::max)
            };
        }
        partial
    }
}

/// The sums over simplices `from..to`, at most a block of them, which `from` begins.
pub(in crate::mass) fn block_sum<C: Corners<N>, K: Kind<N>, const N: usize>(
    corners: &C,
    from: usize,
    to: usize,
    frame: &LocalFrame,
) -> Partial {
    match &frame.axes {
        None => dispatch(Block::<C, _, K, N> {
            corners,
            from,
            to,
            place: Shifted::of(frame),
            nowhere: frame.reference.into(),
            kind: PhantomData,
        }),
        Some(axes) => dispatch(Block::<C, _, K, N> {
            corners,
            from,
            to,
            place: Turned::of(frame, axes),
            nowhere: frame.reference.into(),
            kind: PhantomData,
        }),
    }
}

/// The blocks merged in a fixed tree.
pub(in crate::mass) fn merge(blocks: &[Partial]) -> Partial {
    match blocks {
        [] => [0.0; TERMS],
        [one] => *one,
        _ => {
            let half = blocks.len().next_power_of_two() / 2;
            let (mut sum, other) = (merge(&blocks[..half]), merge(&blocks[half..]));
            for k in 0..TERMS {
                sum[k] = if k < SUMMED {
                    sum[k] + other[k]
                } else {
                    sum[k].max(other[k])
                };
            }
            sum
        }
    }
}
