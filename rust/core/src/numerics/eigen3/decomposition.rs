//! The eigenvalues and eigenvectors of one matrix, or of many.

use nalgebra::Matrix3;

use super::stack::{One, Stack, VALUES_ONLY, WITH_VECTORS};
use super::symmetric::Eigen3;
use crate::numerics::dispatch::dispatch;

/// The decomposition of one matrix.
#[must_use]
#[inline]
pub fn eigen3(a: &Matrix3<f64>) -> Eigen3 {
    let [[a00, a10, a20], [_, a11, a21], [_, _, a22]] = a.data.0;
    dispatch(One([a00, a10, a20, a10, a11, a21, a20, a21, a22]))
}

/// The decompositions of many matrices, on the calling thread; matrices and eigenvectors are row-major.
///
/// # Panics
/// If the lengths differ.
pub fn eigen3_many(matrices: &[[f64; 9]], values: &mut [[f64; 3]], vectors: &mut [[f64; 9]]) {
    assert_eq!(
        matrices.len(),
        values.len(),
        "as many triples of values as matrices"
    );
    assert_eq!(
        matrices.len(),
        vectors.len(),
        "as many triples of vectors as matrices"
    );
    dispatch(Stack::<WITH_VECTORS> {
        matrices,
        values,
        vectors,
    });
}

/// The eigenvalues of many row-major matrices, on the calling thread: the bits of [`eigen3_many`] in less time.
///
/// # Panics
/// If the lengths differ.
pub fn eigenvalues3_many(matrices: &[[f64; 9]], values: &mut [[f64; 3]]) {
    assert_eq!(
        matrices.len(),
        values.len(),
        "as many triples of values as matrices"
    );
    dispatch(Stack::<VALUES_ONLY> {
        matrices,
        values,
        vectors: &mut [],
    });
}
