//! Principal axes: I = V diag(I₁, I₂, I₃) Vᵀ with I₁ ≤ I₂ ≤ I₃.
//!
//! The axes are the **columns** of V, components in the body frame: `v_B` = V `v_P`. V is a rotation. Since an axis has no
//! direction of its own, a rule picks one: in columns 0 and 1 the first component that is as large as the largest, to
//! 1e-8, is positive, and column 2 = column 0 × column 1.

use std::ops::ControlFlow;

use nalgebra::Matrix3;

use crate::numerics::eigen3::{
    self, Eigen3, eigen3, eigen3_many_checked, eigenvalues3_many_checked,
};
use crate::numerics::threads::{Halt, fill_blocks};

/// Rows of a stack that one thread takes at a time, and that stay in its cache meanwhile.
const BLOCK: usize = 1024;

/// Principal moments and axes of a tensor of inertia, or of any symmetric tensor.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::{Matrix3, Rotation3, Vector3};
/// use polhode::principal::{PrincipalAxes, with_sign_rule};
///
/// let flip = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0));
/// let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5).into_inner();
/// let found = PrincipalAxes { moments: [1.0, 2.0, 2.5], axes: with_sign_rule(turn * flip) };
/// // The largest component of the first two axes is positive, the third one is their product.
/// assert!((found.axes - turn).amax() < 1e-15);
/// let tensor = found.axes * Matrix3::from_diagonal(&found.moments.into()) * found.axes.transpose();
/// assert!((tensor.trace() - 5.5).abs() < 1e-14);
/// ```
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
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::{Matrix3, Vector3};
/// use polhode::principal::principal_axes;
///
/// let tensor = Matrix3::new(3.0, -1.0, 0.0, -1.0, 3.0, 0.0, 0.0, 0.0, 5.0);
/// let found = principal_axes(&tensor);
/// assert!((Vector3::from(found.moments) - Vector3::new(2.0, 4.0, 5.0)).amax() < 1e-14);
/// assert!((found.axes.column(0) - Vector3::new(1.0, 1.0, 0.0).normalize()).amax() < 1e-15);
/// ```
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
/// About every 20 ms `watch` gets the fraction done; [`ControlFlow::Break`] ends the job.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::principal::principal_axes_many;
///
/// let tensors = [[3.0, -1.0, 0.0, -1.0, 3.0, 0.0, 0.0, 0.0, 5.0]; 2];
/// let (mut moments, mut axes) = ([[0.0; 3]; 2], [[0.0; 9]; 2]);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// principal_axes_many(&tensors, 0.0, &mut moments, &mut axes, go_on).unwrap();
/// assert!((moments[1][0] - 2.0).abs() < 1e-14);
/// ```
///
/// # Errors
/// [`Halt::Failed`] with the first row whose tensor is not symmetric: |`a_ij` − `a_ji`| > `asymmetry` · max |a|, where all
/// elements are finite. [`Halt::Stopped`] if `watch` said so. `moments` and `axes` are then unspecified.
///
/// # Panics
/// If the lengths differ.
pub fn principal_axes_many(
    tensors: &[[f64; 9]],
    asymmetry: f64,
    moments: &mut [[f64; 3]],
    axes: &mut [[f64; 9]],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Halt<usize>> {
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
    let check = &|some: &[[f64; 9]]| all_symmetric(some, asymmetry);
    let mut blocks: Vec<_> = moments
        .chunks_mut(BLOCK)
        .zip(axes.chunks_mut(BLOCK))
        .collect();
    fill_blocks(&mut blocks, 1, watch, |block, results| {
        let start = block * BLOCK;
        for (moments, axes) in results {
            let tensors = &tensors[start..start + moments.len()];
            eigen3_many_checked(tensors, check, moments, axes).map_err(|row| start + row)?;
        }
        Ok(())
    })
}

/// The principal moments alone, to the bits of [`principal_axes_many`] in less time.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::principal::principal_moments_many;
///
/// let tensors = [[3.0, -1.0, 0.0, -1.0, 3.0, 0.0, 0.0, 0.0, 5.0]];
/// let mut moments = [[0.0; 3]];
/// principal_moments_many(&tensors, 0.0, &mut moments, &mut |_| ControlFlow::Continue(())).unwrap();
/// assert!((moments[0][2] - 5.0).abs() < 1e-14);
/// ```
///
/// # Errors
/// As [`principal_axes_many`].
///
/// # Panics
/// If the lengths differ.
pub fn principal_moments_many(
    tensors: &[[f64; 9]],
    asymmetry: f64,
    moments: &mut [[f64; 3]],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Halt<usize>> {
    assert_eq!(
        tensors.len(),
        moments.len(),
        "as many triples of moments as tensors"
    );
    let check = &|some: &[[f64; 9]]| all_symmetric(some, asymmetry);
    fill_blocks(moments, BLOCK, watch, |start, moments| {
        let tensors = &tensors[start..start + moments.len()];
        eigenvalues3_many_checked(tensors, check, moments).map_err(|row| start + row)
    })
}

/// Finds the first row that is not symmetric, if any.
fn all_symmetric(tensors: &[[f64; 9]], asymmetry: f64) -> Result<(), usize> {
    tensors
        .iter()
        .position(|tensor| is_asymmetric(tensor, asymmetry))
        .map_or(Ok(()), Err)
}

/// Whether all elements are finite and mirror images differ by more than `asymmetry` times the largest element.
fn is_asymmetric(tensor: &[f64; 9], asymmetry: f64) -> bool {
    let &[_, a01, a02, a10, _, a12, a20, a21, _] = tensor;
    // The rule, seen at a glance.
    if a01 == a10 && a02 == a20 && a12 == a21 {
        return false;
    }
    if !tensor.iter().all(|x| x.is_finite()) {
        return false;
    }
    let largest = tensor
        .iter()
        .fold(0.0, |largest: f64, x| largest.max(x.abs()));
    [(a01, a10), (a02, a20), (a12, a21)]
        .iter()
        .any(|(a, b)| (a / largest - b / largest).abs() > asymmetry)
}

/// The axes of a rotation, in the directions that the sign rule picks.
#[must_use]
pub fn with_sign_rule(axes: Matrix3<f64>) -> Matrix3<f64> {
    eigen3::with_sign_rule(&axes)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::{Halt, principal_axes_many, principal_moments_many};

    const ALLOWED: f64 = 8.0 * f64::EPSILON;

    fn solve(tensors: &[[f64; 9]]) -> Result<(), Halt<usize>> {
        let mut moments = vec![[0.0; 3]; tensors.len()];
        let mut axes = vec![[0.0; 9]; tensors.len()];
        let mut go_on = |_| ControlFlow::Continue(());
        let outcome = principal_axes_many(tensors, ALLOWED, &mut moments, &mut axes, &mut go_on);
        let alone = principal_moments_many(tensors, ALLOWED, &mut moments, &mut go_on);
        assert_eq!(outcome, alone);
        outcome
    }

    #[test]
    fn the_first_asymmetric_row_is_named() {
        let mut tensors = vec![[2.0, 1.0, 0.0, 1.0, 3.0, 0.0, 0.0, 0.0, 4.0]; 50_000];
        assert_eq!(solve(&tensors), Ok(()));
        assert_eq!(solve(&[]), Ok(()));
        tensors[10][1] += 4.0 * f64::EPSILON;
        tensors[20][5] = f64::NAN;
        tensors[30][2] = f64::INFINITY;
        tensors[30][1] = 7.0;
        assert_eq!(solve(&tensors), Ok(()));
        // Rows are checked 32 at a time, in blocks of 1024: on both sides of each end.
        for row in [40_000, 33_333, 1024, 1023, 32, 31, 7] {
            tensors[row][2] = 1e-14;
            assert_eq!(solve(&tensors), Err(Halt::Failed(row)));
        }
        assert_eq!(
            solve(&[[5e-324, 5e-324, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]]),
            Err(Halt::Failed(0))
        );
    }
}
