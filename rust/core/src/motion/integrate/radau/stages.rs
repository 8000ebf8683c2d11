//! The stages of a step, and their sums.

use nalgebra::SVector;

/// The increments of the three stages over the state at the start of the step.
pub(super) type Stages<const N: usize> = [SVector<f64, N>; 3];

pub(super) fn combine<const N: usize>(weights: &[f64; 3], stages: &Stages<N>) -> SVector<f64, N> {
    stages[0] * weights[0] + stages[1] * weights[1] + stages[2] * weights[2]
}

pub(super) fn combined<const N: usize>(matrix: &[[f64; 3]; 3], stages: &Stages<N>) -> Stages<N> {
    matrix.each_ref().map(|row| combine(row, stages))
}
