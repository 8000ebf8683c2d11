//! The recurrences of terms that are not linear in the coefficients of one order.

use nalgebra::Vector3;

use super::batch::Batch;
use super::series::Series;
use crate::motion::loads::Forcing;
use crate::numerics::number::Number;

/// Torques that are cubics in time, in the body or in space: of the latter `Σ_j τ_j·γ_{k−j}` with the axes γ of space.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
pub(super) struct ForcedTorques<T> {
    in_body: [[T; 3]; 4],
    in_space: [[T; 3]; 4],
    inverse_moments: [T; 3],
}

impl<L: Number, const R: usize> ForcedTorques<Batch<L, R>> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = Batch::new(0.0);
        Self {
            in_body: [[zero; 3]; 4],
            in_space: [[zero; 3]; 4],
            inverse_moments: [zero; 3],
        }
    }

    /// The cubics of one row at the start of a step.
    pub(super) fn set(
        &mut self,
        row: usize,
        forcing: &Forcing<L::Real>,
        inverse_moments: &Vector3<L::Real>,
    ) {
        for i in 0..3 {
            for k in 0..4 {
                self.in_body[k][i].put(row, forcing.in_body[k][i]);
                self.in_space[k][i].put(row, forcing.in_space[k][i]);
            }
            self.inverse_moments[i].put(row, inverse_moments[i]);
        }
    }

    /// The coefficient of order `k` of the angular acceleration, components in principal axes.
    #[inline(always)]
    pub(super) fn coefficient<const B: usize>(
        &self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
    ) -> [Batch<L, R>; 3] {
        let mut sum = [Batch::new(0.0); 3];
        if B == 3 {
            for j in 0..=k.min(3) {
                let g = series.get(k - j).g;
                for (axis, direction) in g.iter().enumerate() {
                    for i in 0..3 {
                        sum[i] = self.in_space[j][axis].mul_add(direction[i], sum[i]);
                    }
                }
            }
        }
        for i in 0..3 {
            sum[i] = sum[i] * self.inverse_moments[i];
            if k < 4 {
                sum[i] = sum[i] + self.in_body[k][i];
            }
        }
        sum
    }
}
