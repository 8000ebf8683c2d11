//! The stages of a step, and their sums.

use nalgebra::SVector;

/// The increments of the three stages over the state at the start of the step.
pub(super) type Stages<const N: usize> = [SVector<f64, N>; 3];

#[inline]
pub(super) fn combine<const N: usize>(weights: &[f64; 3], stages: &Stages<N>) -> SVector<f64, N> {
    stages[0] * weights[0] + stages[1] * weights[1] + stages[2] * weights[2]
}

#[inline]
pub(super) fn combined<const N: usize>(matrix: &[[f64; 3]; 3], stages: &Stages<N>) -> Stages<N> {
    let [a, b, c] = matrix;
    [combine(a, stages), combine(b, stages), combine(c, stages)]
}
