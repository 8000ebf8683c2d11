//! Principal axes: I = V diag(I₁, I₂, I₃) Vᵀ with I₁ ≤ I₂ ≤ I₃.
//!
//! The axes are the **columns** of V, components in the body frame: `v_B` = V `v_P`. V is a rotation. Since an axis has no
//! direction of its own, a rule picks one: in columns 0 and 1 the first component that is as large as the largest, to
//! 1e-8, is positive, and column 2 = column 0 × column 1.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nalgebra::Matrix3;

use crate::numerics::eigen3::{self, Eigen3, eigen3, eigen3_many, eigenvalues3_many};
use crate::numerics::threads::fill_blocks;

/// Rows of a stack that one thread takes at a time: a tenth of a millisecond's work.
const BLOCK: usize = 4096;

/// Principal moments and axes of a tensor of inertia, or of any symmetric tensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalAxes {
    /// The principal moments, ascending.
    pub moments: [f64; 3],
    /// The principal axes as columns, a rotation.
    pub axes: Matrix3<f64>,
}

/// The principal moments and axes of a symmetric tensor, of which the lower triangle is read.
///
/// A tensor with an element that is not finite gives NaN throughout.
#[must_use]
pub fn principal_axes(inertia: &Matrix3<f64>) -> PrincipalAxes {
    let Eigen3 { values, vectors } = eigen3(inertia);
    PrincipalAxes {
        moments: values,
        axes: vectors,
    }
}

/// The principal moments and axes of a stack of tensors, on several threads when the stack is large; tensors and axes
/// are row-major. Each row has the bits of [`principal_axes`].
///
/// About every 20 ms `watch` gets the fraction done; where it says [`ControlFlow::Break`] the job ends, and so does this
/// function, with the contents of `moments` and `axes` unspecified.
///
/// # Panics
/// If the lengths differ.
pub fn principal_axes_many(
    tensors: &[[f64; 9]],
    moments: &mut [[f64; 3]],
    axes: &mut [[f64; 9]],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> ControlFlow<()> {
    assert_eq!(
        tensors.len(),
        moments.len(),
        "as many triples of moments as tensors"
    );
    assert_eq!(
        tensors.len(),
        axes.len(),
        "as many triples of axes as tensors"
    );
    let mut blocks: Vec<_> = tensors
        .chunks(BLOCK)
        .zip(moments.chunks_mut(BLOCK))
        .zip(axes.chunks_mut(BLOCK))
        .collect();
    let outcome = fill_blocks(&mut blocks, 1, watch, |_, block| {
        for ((tensors, moments), axes) in block {
            eigen3_many(tensors, moments, axes);
        }
        Ok::<(), Infallible>(())
    });
    if outcome.is_ok() {
        ControlFlow::Continue(())
    } else {
        ControlFlow::Break(())
    }
}

/// The principal moments alone, to the bits of [`principal_axes_many`] in less time.
///
/// # Panics
/// If the lengths differ.
pub fn principal_moments_many(
    tensors: &[[f64; 9]],
    moments: &mut [[f64; 3]],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> ControlFlow<()> {
    assert_eq!(
        tensors.len(),
        moments.len(),
        "as many triples of moments as tensors"
    );
    let mut blocks: Vec<_> = tensors
        .chunks(BLOCK)
        .zip(moments.chunks_mut(BLOCK))
        .collect();
    let outcome = fill_blocks(&mut blocks, 1, watch, |_, block| {
        for (tensors, moments) in block {
            eigenvalues3_many(tensors, moments);
        }
        Ok::<(), Infallible>(())
    });
    if outcome.is_ok() {
        ControlFlow::Continue(())
    } else {
        ControlFlow::Break(())
    }
}

/// The axes of a rotation, in the directions that the sign rule picks.
#[must_use]
pub fn with_sign_rule(axes: Matrix3<f64>) -> Matrix3<f64> {
    eigen3::with_sign_rule(&axes)
}
