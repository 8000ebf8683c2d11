//! A cache of the series of orbits at the starts of steps, for all motions on the same orbits.

use std::array::from_fn;
use std::mem::take;

use super::batch::Batch;
use super::equations::CacheKey;
use super::gravity_gradient::{GravityGradientSeries, INITIAL_NUMBERS};
use crate::numerics::number::Number;

/// The number of buckets, as a power of two, and of entries in each.
const LOG2_BUCKETS: u32 = 10;
pub(super) const ENTRIES: usize = 4;
/// The golden section of 2⁶⁴, for hashes.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
/// The largest ratio of two units of rates for which numbers of one are used in the other: its powers do not overflow.
const MAX_UNIT_RATIO: f64 = 1_048_576.0;

/// The part of the length of a step to which its end is rounded.
const GRAIN: f64 = 1.0 / 16.0;

/// The orbits of a load at starts of steps, as numbers of [`GravityGradientSeries`]: computed once for all motions on the same orbits.
///
/// Every bit of them depends only on the key and on the unit of rates, which is a power of two. So a motion has the same bits with and
/// without an entry in the cache.
#[derive(Clone, Debug, Default)]
pub(super) struct OrbitSeriesCache {
    /// The hashes of the keys, a bucket in one cache line of the processor; empty before the first insert.
    hashes: Vec<[u64; ENTRIES]>,
    entries: Vec<CacheEntry>,
    /// The number of inserts so far.
    inserted: usize,
}

/// The numbers of all orbits of a load, in a unit of rates.
#[derive(Clone, Debug)]
pub(super) struct CacheEntry {
    key: CacheKey,
    unit: f64,
    numbers: Vec<f64>,
}

impl CacheKey {
    /// Compute the hash, and the bucket.
    #[inline(always)]
    pub(super) fn hash(&self) -> (u64, usize) {
        let mixed = self.when.iter().fold(self.terms.0 as u64, |sum, bits| {
            (sum.rotate_left(5) ^ bits).wrapping_mul(GOLDEN)
        });
        (mixed, (mixed >> (64 - LOG2_BUCKETS)) as usize)
    }
}

impl OrbitSeriesCache {
    /// Find the number of the entry of a key.
    #[inline(always)]
    pub(super) fn find(&self, key: &CacheKey, unit: f64) -> Option<usize> {
        let (hash, bucket) = key.hash();
        let found = self.hashes.get(bucket)?.iter().position(|it| *it == hash)?;
        let number = ENTRIES * bucket + found;
        let entry = &self.entries[number];
        let ratio = entry.unit / unit;
        let serves = entry.key == *key && ratio <= MAX_UNIT_RATIO && 1.0 <= ratio * MAX_UNIT_RATIO;
        serves.then_some(number)
    }

    /// Return the entry of a number from [`Self::find`].
    #[inline(always)]
    pub(super) fn entry(&self, number: usize) -> &CacheEntry {
        &self.entries[number]
    }

    /// Restore the orbits of each row from an entry, in the unit of rates of the row.
    #[inline(always)]
    pub(super) fn restore_all<L: Number, const R: usize>(
        &self,
        known: &[(usize, f64); R],
        gradients: &mut [GravityGradientSeries<Batch<L, R>>],
        order: usize,
    ) {
        let mut ratio = Batch::new(1.0);
        for row in 0..R {
            let (number, unit) = known[row];
            ratio.set(row, self.entries[number].unit / unit);
        }
        let size = entry_length(order);
        for (which, gradient) in gradients.iter_mut().enumerate() {
            let mut stored: [&[f64]; R] = [&[]; R];
            for row in 0..R {
                let (number, _) = known[row];
                stored[row] = &self.entries[number].numbers[which * size..][..size];
            }
            gradient.restore_all(&stored, ratio);
        }
    }

    /// Insert the orbits of one row.
    #[inline(never)]
    pub(super) fn insert<L: Number, const R: usize>(
        &mut self,
        key: CacheKey,
        unit: f64,
        gradients: &mut [GravityGradientSeries<Batch<L, R>>],
        row: usize,
        order: usize,
    ) {
        if self.hashes.is_empty() {
            self.hashes.resize(1 << LOG2_BUCKETS, [0; ENTRIES]);
            self.entries
                .resize(ENTRIES << LOG2_BUCKETS, CacheEntry::none());
        }
        let (hash, bucket) = key.hash();
        let is_free = |it: &u64| *it == hash || *it == 0;
        let free = self.hashes[bucket].iter().position(is_free);
        let slot = free.unwrap_or(self.inserted % ENTRIES);
        self.inserted += 1;
        self.hashes[bucket][slot] = hash;
        let entry = &mut self.entries[ENTRIES * bucket + slot];
        let mut numbers = take(&mut entry.numbers);
        numbers.clear();
        for gradient in gradients {
            numbers.extend(gradient.initial_numbers(row).map(|x| L::of(x).get()));
            let half_turn = &gradient.orbit().half_turn()[1..order];
            numbers.extend(half_turn.iter().flatten().map(|x| x.get(row)));
        }
        *entry = CacheEntry { key, unit, numbers };
    }
}

impl CacheEntry {
    /// Return an entry without a key.
    fn none() -> Self {
        let key = CacheKey {
            when: [u64::MAX; 3],
            terms: (0, 0),
        };
        Self {
            key,
            unit: 1.0,
            numbers: Vec::new(),
        }
    }

    /// Restore the orbits of one row at the start of a step, in a unit of rates.
    #[inline(never)]
    pub(super) fn restore<L: Number, const R: usize>(
        &self,
        unit: f64,
        gradients: &mut [GravityGradientSeries<Batch<L, R>>],
        row: usize,
        order: usize,
    ) {
        let stored = self.numbers.chunks_exact(entry_length(order));
        for (gradient, numbers) in gradients.iter_mut().zip(stored) {
            gradient.restore(row, from_fn(|i| numbers[i].into()));
            gradient.rescale(row, self.unit / unit);
        }
    }
}

/// Return the count of numbers of one orbit in an entry.
#[inline(always)]
fn entry_length(order: usize) -> usize {
    INITIAL_NUMBERS + 2 * order - 2
}

/// Shorten a step from `now`, the time since the start, by a sixteenth at most, so that it ends at a round time: there motions on the
/// same orbit find the same key.
#[inline(always)]
pub(super) fn round_step_end(now: (f64, f64), h: f64) -> f64 {
    let power = f64::from_bits(h.to_bits() & (0x7ff << 52));
    let grain = power * GRAIN;
    if grain > 0.0 && grain < f64::INFINITY {
        let end = ((now.0 + h) / grain).floor() * grain;
        let shorter = (end - now.0) - now.1;
        if shorter > 0.5 * h && shorter <= h {
            shorter
        } else {
            h
        }
    } else {
        h
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::lane::{BASELINE, Double};

    type Pair = Batch<Double<BASELINE>, 2>;

    fn key(time: f64) -> CacheKey {
        CacheKey {
            when: [time.to_bits(), 0, 0],
            terms: (4096, 1),
        }
    }

    #[test]
    fn steps_end_at_round_times() {
        for (now, h) in [
            (0.0, 0.7),
            (0.3, 0.7),
            (1e6, 0.7),
            (3.25, 1e-9),
            (1e-9, 64.0),
        ] {
            let shorter = round_step_end((now, 0.0), h);
            assert!(shorter <= h && shorter > 0.93 * h, "{now} {h}: {shorter}");
            let end: f64 = now + shorter;
            // The sixteenth of the power of two at or below h.
            let grain = h.log2().floor().exp2() / 16.0;
            assert_eq!((end / grain).fract(), 0.0, "{now} {h}");
        }
        // From either side of a round time.
        assert_eq!(round_step_end((0.0, 0.0), 1.0), 1.0);
        assert_eq!(
            round_step_end((0.0, 0.0), 1.0_f64.next_down()),
            1.0 - 1.0 / 32.0
        );
        // No step is lost where there is nothing to round.
        for h in [0.0, f64::INFINITY, f64::MIN_POSITIVE / 8.0] {
            assert_eq!(round_step_end((1.0, 0.0), h), h);
        }
        assert!(round_step_end((1.0, 0.0), f64::NAN).is_nan());
    }

    #[test]
    fn another_unit_gets_the_bits_that_it_would_find() {
        let rates = [0.3, 0.7, 0.4];
        let at_order_8 = |unit: f64| {
            let mut gradient = GravityGradientSeries::<Pair>::new();
            let [a, b, c] = [rates[0] / unit, rates[1] / unit, rates[2] / unit / unit];
            gradient.restore(1, [0.1, 0.2, 0.3, 0.9, a, b, c, 3.0 * c]);
            gradient.expand(8);
            [gradient]
        };
        let mut cache = OrbitSeriesCache::default();
        assert!(cache.find(&key(1.0), 1.0).is_none());
        cache.insert(key(1.0), 1.0, &mut at_order_8(1.0), 1, 8);
        for unit in [1.0, 0.25, 64.0] {
            let number = cache.find(&key(1.0), unit).expect("an entry");
            let mut own = at_order_8(unit);
            let mut begins = [GravityGradientSeries::<Pair>::new()];
            cache.entry(number).restore(unit, &mut begins, 1, 8);
            assert_eq!(begins[0].initial_numbers(1), own[0].initial_numbers(1));
            // The row beside it in another unit.
            let mut taken = [GravityGradientSeries::<Pair>::new()];
            cache.restore_all(&[(number, 8.0), (number, unit)], &mut taken, 8);
            assert_eq!(taken[0].initial_numbers(1), own[0].initial_numbers(1));
            for k in 0..8 {
                let [taken, own] = [&mut taken, &mut own].map(|it| it[0].orbit().half_turn()[k]);
                assert_eq!(taken.map(|x| x.get(1)), own.map(|x| x.get(1)), "{unit} {k}");
            }
        }
        assert!(cache.find(&key(1.0), MAX_UNIT_RATIO).is_some());
        assert!(cache.find(&key(1.0), 2.0 * MAX_UNIT_RATIO).is_none());
        assert!(cache.find(&key(2.0), 1.0).is_none());
        // More than there is room for: what was put last is there.
        for k in 0..3 * (ENTRIES << LOG2_BUCKETS) {
            cache.insert(key(k as f64), 1.0, &mut at_order_8(1.0), 1, 2);
            assert!(cache.find(&key(k as f64), 1.0).is_some());
        }
        assert_eq!(cache.entries.len(), ENTRIES << LOG2_BUCKETS);
    }
}
