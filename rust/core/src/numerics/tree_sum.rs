//! Sums whose bits do not depend on how the work is cut.
//!
//! Term `i` goes to the virtual lane `i mod 8` of the block `i / 4096`; lanes and blocks are merged in a fixed tree. The
//! result is therefore the same for any number of threads, and the rounding error grows with the logarithm of the
//! number of terms beyond one block.

use std::convert::Infallible;
use std::ops::{ControlFlow, Range};

use super::threads::{Halt, fill_blocks};

/// Virtual lanes of a block.
pub(crate) const LANES: usize = 8;
/// Terms of a block.
pub(crate) const BLOCK: usize = 4096;

/// Blocks that a thread does at a time.
const SHARE: usize = 8;

/// The sums of all blocks of `0..n`, merged: the bits of [`sum_terms`] where `block` adds as that does.
///
/// Large sums are taken on all cores; about every 20 ms `watch` gets the fraction done and may end them.
///
/// # Errors
/// [`Halt::Stopped`] when `watch` said so.
#[inline]
pub(crate) fn sum_blocks<const K: usize>(
    n: usize,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    block: impl Fn(Range<usize>) -> [f64; K] + Sync,
) -> Result<[f64; K], Halt<Infallible>> {
    let range = |index: usize| index * BLOCK..n.min((index + 1) * BLOCK);
    let count = n.div_ceil(BLOCK).max(1);
    if count == 1 {
        return Ok(block(range(0)));
    }
    sum_many(count, watch, |index| block(range(index)))
}

/// The sums of this number of blocks, merged. By itself, so that a sum of one block is inlined where it is asked for.
#[inline(never)]
fn sum_many<const K: usize>(
    count: usize,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    block: impl Fn(usize) -> [f64; K] + Sync,
) -> Result<[f64; K], Halt<Infallible>> {
    let mut sums = vec![[0.0; K]; count];
    fill_blocks(&mut sums, SHARE, watch, |first, share| {
        for (index, sum) in (first..).zip(share) {
            *sum = block(index);
        }
        Ok(())
    })?;
    Ok(tree(0, count, &|index| sums[index]))
}

/// `Σ term(i)` over `0..n`, for K sums at once.
pub(crate) fn sum_terms<const K: usize>(n: usize, term: impl Fn(usize) -> [f64; K]) -> [f64; K] {
    tree(0, n.div_ceil(BLOCK).max(1), &|block| {
        block_sum(block * BLOCK, n.min((block + 1) * BLOCK), &term)
    })
}

/// The number of additions that a term passes on its way to the sum of `n`, at most.
#[must_use]
pub(crate) fn depth(n: usize) -> f64 {
    let within = n.min(BLOCK).div_ceil(LANES) + 3;
    let levels = n.div_ceil(BLOCK).max(1).next_power_of_two().ilog2();
    within as f64 + f64::from(levels)
}

/// The blocks `from..to` merged pairwise, split at the largest power of two, so that the tree depends on `to` alone.
fn tree<const K: usize>(from: usize, to: usize, block: &impl Fn(usize) -> [f64; K]) -> [f64; K] {
    let count = to - from;
    if count == 1 {
        return block(from);
    }
    let half = count.next_power_of_two() / 2;
    add(tree(from, from + half, block), tree(from + half, to, block))
}

/// The terms `from..to` of one block, in its lanes.
#[inline(always)]
pub(crate) fn block_sum<const K: usize>(
    from: usize,
    to: usize,
    term: &impl Fn(usize) -> [f64; K],
) -> [f64; K] {
    let mut lanes = [[0.0; K]; LANES];
    let whole = from + (to - from) / LANES * LANES;
    let mut i = from;
    while i < whole {
        for lane in &mut lanes {
            *lane = add(*lane, term(i));
            i += 1;
        }
    }
    for (lane, i) in lanes.iter_mut().zip(whole..to) {
        *lane = add(*lane, term(i));
    }
    merge_lanes(lanes, add)
}

/// The lanes of a block in their tree.
#[inline(always)]
pub(crate) fn merge_lanes<T>([a, b, c, d, e, f, g, h]: [T; LANES], add: impl Fn(T, T) -> T) -> T {
    add(add(add(a, e), add(c, g)), add(add(b, f), add(d, h)))
}

#[inline(always)]
fn add<const K: usize>(mut a: [f64; K], b: [f64; K]) -> [f64; K] {
    for (x, y) in a.iter_mut().zip(b) {
        *x += y;
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_every_term_once() {
        for n in [0, 1, 7, 8, 9, 4095, 4096, 4097, 3 * 4096, 100_000] {
            let [count, sum] = sum_terms(n, |i| [1.0, i as f64]);
            assert_eq!(count, n as f64);
            assert_eq!(sum, (n as f64) * (n as f64 - 1.0).max(0.0) / 2.0);
        }
    }
}
