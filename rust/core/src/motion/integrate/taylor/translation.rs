//! The translation of a free body under forces: `m v̇ = F`, with parts of F constant in space and in the body.

use super::batch::Batch;
use super::equations::LinearTerms;
use super::series;
use super::series::Series;
use super::step::compensate;
use crate::numerics::number::{Number, Real};

/// Position and velocity of the centre of mass in N, and the series of the acceleration in a step.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
pub(super) struct Translation<T> {
    value: [T; 6],
    rest: [T; 6],
    acceleration: [[T; 3]; series::MAX_COUNT],
}

impl<L: Number, const R: usize> Translation<Batch<L, R>> {
    pub(super) const ZERO: Self = Self {
        value: [Batch::ZERO; 6],
        rest: [Batch::ZERO; 6],
        acceleration: [[Batch::ZERO; 3]; series::MAX_COUNT],
    };

    /// Set position and velocity of one row.
    pub(super) fn set(&mut self, row: usize, place: &[f64; 6]) {
        for i in 0..6 {
            self.value[i].set(row, place[i]);
            self.rest[i].set(row, 0.0);
        }
    }

    /// Change the unit of rates of one row: multiply the velocity by `ratio`.
    pub(super) fn rescale(&mut self, row: usize, ratio: f64) {
        for i in 3..6 {
            let (value, rest) = (self.value[i].real(row), self.rest[i].real(row));
            self.value[i].put(row, value * ratio.into());
            self.rest[i].put(row, rest * ratio.into());
        }
    }

    /// Compute the series of the acceleration. `R f` has the components `γ_i·f` with the axes γ of space, which the series contain if a
    /// force is constant in the body.
    #[inline(always)]
    pub(super) fn expand<const B: usize>(
        &mut self,
        order: usize,
        series: &impl Series<Batch<L, R>, B>,
        linear_terms: &LinearTerms<Batch<L, R>, B>,
    ) {
        for k in 0..order {
            let mut sum = if k == 0 {
                linear_terms.force
            } else {
                [Batch::new(0.0); 3]
            };
            if B == 3 {
                let g = series.get(k).g;
                for (axis, direction) in g.iter().enumerate() {
                    for i in 0..3 {
                        sum[axis] = direction[i].mul_add(linear_terms.thrust[i], sum[axis]);
                    }
                }
            }
            self.acceleration[k] = sum;
        }
    }

    /// Compute the change of position and velocity within the time `h`.
    #[inline(always)]
    pub(super) fn increment(&self, order: usize, h: Batch<L, R>) -> [Batch<L, R>; 6] {
        let mut sums = [Batch::new(0.0); 6];
        for k in (0..order).rev() {
            let once = Batch::over(k + 1);
            let twice = once * Batch::over(k + 2);
            for i in 0..3 {
                let a = self.acceleration[k][i];
                sums[i] = sums[i].mul_add(h, a * twice);
                sums[3 + i] = sums[3 + i].mul_add(h, a * once);
            }
        }
        for i in 0..3 {
            let velocity = self.value[3 + i] + self.rest[3 + i];
            sums[i] = sums[i].mul_add(h, velocity) * h;
            sums[3 + i] = sums[3 + i] * h;
        }
        sums
    }

    #[inline(always)]
    pub(super) fn add(&mut self, increment: &[Batch<L, R>; 6]) {
        for i in 0..6 {
            compensate(&mut self.value[i], &mut self.rest[i], increment[i]);
        }
    }

    /// Return position and velocity of one row.
    pub(super) fn now(&self, row: usize) -> [L::Real; 6] {
        let mut place = [L::Real::default(); 6];
        for i in 0..6 {
            place[i] = self.value[i].real(row);
        }
        place
    }

    /// Return the coefficients of position and velocity of one row in the step that began at `start`.
    pub(super) fn path(&self, row: usize, order: usize, start: &[L::Real; 6]) -> Vec<[f64; 6]> {
        let mut path = vec![[0.0; 6]; order + 2];
        path[0] = start.map(L::Real::rounded);
        for i in 0..3 {
            path[1][i] = path[0][3 + i];
            for k in 0..order {
                let a = self.acceleration[k][i].get(row) * (1.0 / (k + 1) as f64);
                path[k + 1][3 + i] = a;
                path[k + 2][i] = a * (1.0 / (k + 2) as f64);
            }
        }
        path
    }

    /// Compute position and velocity of one row after `increment`.
    #[inline(always)]
    pub(super) fn state_after(&self, increment: &[Batch<L, R>; 6], row: usize) -> [L::Real; 6] {
        let mut place = [L::Real::default(); 6];
        for i in 0..6 {
            let change = increment[i].real(row) + self.rest[i].real(row);
            place[i] = self.value[i].real(row) + change;
        }
        place
    }
}
