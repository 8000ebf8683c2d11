//! Structure of arrays: a batch of rows, transposed, so that one loop over a formula fills the lanes.
//!
//! Rows come and go as arrays of a few numbers each. Plane k holds number k of every row of a batch, in the first-level
//! cache while [`StructureOfArrays::map`] and [`StructureOfArrays::update`] run over it.

use super::lane::Lane;

/// Rows of a batch: whole registers on every machine, and few enough that fifty planes leave half of a first-level cache
/// of 32 KiB to the rows that come and go. Twice as many cost a third of the speed on stacks that do not fit the caches.
pub(crate) const ROWS: usize = 32;

/// A formula from `K` numbers of a row to `M` others.
///
/// A trait rather than a closure: a closure's body is compiled apart, without the instructions of the level, whenever it
/// is too long to be inlined.
pub(crate) trait RowFormula<const K: usize, const M: usize> {
    /// The formula. Mark the implementation `#[inline(always)]`.
    fn apply<L: Lane>(numbers: [L; K]) -> [L; M];
}

/// `K` numbers for each of up to [`ROWS`] rows.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct StructureOfArrays<const K: usize>([[f64; ROWS]; K]);

impl<const K: usize> StructureOfArrays<K> {
    /// All zero.
    pub(crate) const ZERO: Self = Self([[0.0; ROWS]; K]);

    /// Sets the numbers of one row.
    #[inline(always)]
    pub(crate) fn set(&mut self, row: usize, numbers: [f64; K]) {
        let mut k = 0;
        while k < K {
            self.0[k][row] = numbers[k];
            k += 1;
        }
    }

    /// The numbers of one row from plane `first` on.
    #[inline(always)]
    #[must_use]
    pub(crate) fn get<const N: usize>(&self, row: usize, first: usize) -> [f64; N] {
        let mut numbers = [0.0; N];
        let mut k = 0;
        while k < N {
            numbers[k] = self.0[first + k][row];
            k += 1;
        }
        numbers
    }

    /// The numbers of one row as lanes.
    #[inline(always)]
    #[must_use]
    pub(crate) fn lanes<L: Lane>(&self, row: usize) -> [L; K] {
        let mut numbers = [L::new(0.0); K];
        let mut k = 0;
        while k < K {
            numbers[k] = L::new(self.0[k][row]);
            k += 1;
        }
        numbers
    }

    /// Sets the numbers of one row from lanes.
    #[inline(always)]
    pub(crate) fn set_lanes<L: Lane>(&mut self, row: usize, numbers: [L; K]) {
        let mut k = 0;
        while k < K {
            self.0[k][row] = numbers[k].get();
            k += 1;
        }
    }

    /// Writes the formula's results for the first `rows` rows to `target`.
    #[inline(always)]
    pub(crate) fn map<L: Lane, F: RowFormula<K, M>, const M: usize>(
        &self,
        rows: usize,
        target: &mut StructureOfArrays<M>,
    ) {
        for row in 0..rows.min(ROWS) {
            target.set_lanes(row, F::apply(self.lanes::<L>(row)));
        }
    }

    /// Replaces the numbers of the first `rows` rows by the formula's results.
    #[inline(always)]
    pub(crate) fn update<L: Lane, F: RowFormula<K, K>>(&mut self, rows: usize) {
        for row in 0..rows.min(ROWS) {
            self.set_lanes(row, F::apply(self.lanes::<L>(row)));
        }
    }

    /// Adds row i of each of the first `summed` planes to lane i mod N of its total; of the other planes, whose numbers
    /// are not negative, a lane keeps the largest.
    #[inline(always)]
    pub(crate) fn add_to<const N: usize>(&self, totals: &mut [[f64; N]; K], summed: usize) {
        for (k, total) in totals.iter_mut().enumerate() {
            for rows in self.0[k].chunks_exact(N) {
                let mut lane = 0;
                while lane < N {
                    let (x, old) = (rows[lane], total[lane]);
                    let larger = if x > old { x } else { old };
                    total[lane] = if k < summed { old + x } else { larger };
                    lane += 1;
                }
            }
        }
    }

    /// Whether plane `k` is anywhere other than zero in the first `rows` rows.
    #[inline(always)]
    #[must_use]
    pub(crate) fn any(&self, k: usize, rows: usize) -> bool {
        let mut any = false;
        for row in 0..rows.min(ROWS) {
            any |= self.0[k][row] != 0.0;
        }
        any
    }
}
