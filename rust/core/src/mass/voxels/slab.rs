//! Sums over the voxels of equal x.

use crate::numerics::dispatch::Kernel;
use crate::numerics::lane::Lane;
use crate::numerics::reduce::sum_terms;

/// A number that a density may be stored as: `f32` or `f64`. Sums are taken in double precision.
pub trait Voxel: Copy + Into<f64> + Send + Sync {
    /// Whether it is sooner to add four rows of cells at once than one after the other: where the sums that are kept take
    /// longer to read than the densities.
    const FOUR_AT_ONCE: bool;
}

impl Voxel for f32 {
    const FOUR_AT_ONCE: bool = true;
}

impl Voxel for f64 {
    const FOUR_AT_ONCE: bool = false;
}

/// The sums over a slab of cells of equal x: ρ, ρ y, ρ z, ρ y², ρ y z, ρ z², densities below zero; y and z in indices.
pub(super) const SLAB: usize = 7;

/// The cells of equal x.
pub(super) struct Slab<'a, T> {
    /// Their densities.
    pub(super) density: &'a [T],
    /// Cells along z.
    pub(super) length: usize,
    /// The indices along y and z that are counted from.
    pub(super) reference: [f64; 2],
}

/// Sums along y for each z.
struct Columns<L> {
    /// ρ.
    sum: Vec<L>,
    /// ρ y.
    first: Vec<L>,
    /// ρ y².
    second: Vec<L>,
    /// Densities below zero.
    below: Vec<L>,
}

impl<L: Lane> Columns<L> {
    #[inline(always)]
    fn new(length: usize) -> Self {
        let zero = || vec![L::new(0.0); length];
        Self {
            sum: zero(),
            first: zero(),
            second: zero(),
            below: zero(),
        }
    }

    /// Adds a row of cells at y.
    #[inline(always)]
    fn add<T: Voxel>(&mut self, row: &[T], y: L) {
        let y_squared = y * y;
        let sums = self.sum.iter_mut().zip(&mut self.first);
        let sums = sums.zip(&mut self.second).zip(&mut self.below);
        for (&density, (((sum, first), second), below)) in row.iter().zip(sums) {
            let density = L::new(density.into());
            *sum = *sum + density;
            *first = density.mul_add(y, *first);
            *second = density.mul_add(y_squared, *second);
            *below = *below + density.min(L::new(0.0));
        }
    }

    /// Adds four rows, in the order of additions of one by one.
    #[inline(always)]
    fn add_four<T: Voxel>(&mut self, rows: &[T], y: [L; 4]) {
        let length = self.sum.len();
        let rows: [&[T]; 4] = std::array::from_fn(|n| &rows[n * length..(n + 1) * length]);
        let first = &mut self.first[..length];
        let second = &mut self.second[..length];
        let below = &mut self.below[..length];
        for k in 0..length {
            for n in 0..4 {
                let density = L::new(rows[n][k].into());
                self.sum[k] = self.sum[k] + density;
                first[k] = density.mul_add(y[n], first[k]);
                second[k] = density.mul_add(y[n] * y[n], second[k]);
                below[k] = below[k] + density.min(L::new(0.0));
            }
        }
    }
}

impl<T: Voxel> Kernel for Slab<'_, T> {
    type Output = [f64; SLAB];

    #[inline(always)]
    fn run<L: Lane>(self) -> [f64; SLAB] {
        let y = |j: usize| L::new(j as f64 - self.reference[0]);
        let mut columns = Columns::new(self.length);
        let mut j = 0;
        let mut rest = self.density;
        if T::FOUR_AT_ONCE {
            let fours = rest.chunks_exact(4 * self.length);
            rest = fours.remainder();
            for rows in fours {
                columns.add_four(rows, [y(j), y(j + 1), y(j + 2), y(j + 3)]);
                j += 4;
            }
        }
        for row in rest.chunks_exact(self.length) {
            columns.add(row, y(j));
            j += 1;
        }
        sum_terms(self.length, |k| {
            let of = |column: &[L]| column[k].get();
            let (s, y, yy) = (of(&columns.sum), of(&columns.first), of(&columns.second));
            let z = k as f64 - self.reference[1];
            [s, y, s * z, yy, y * z, s * z * z, of(&columns.below)]
        })
    }
}
