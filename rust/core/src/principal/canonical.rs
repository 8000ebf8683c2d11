//! Canonical axes: where a body leaves its axes free, those nearest to the body frame.
//!
//! Every axis of a sphere is principal, and every axis across the symmetry axis of a top. An eigensolver then returns axes
//! that hang on the last bits of the tensor, and a closed form returns others. The canonical choice depends on the body
//! alone: of all principal axes with moments in ascending order, those with the largest trace of V, the cosines of the
//! angles between the k-th principal axis and the k-th axis of the body frame taken together.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use super::axes::{PrincipalAxes, with_sign_rule};
use crate::numerics::threads::{Halt, fill_blocks};

/// A symmetry axis that is this nearly across its axis of the body frame has two nearest pairs: its direction decides.
const TIE: f64 = 1e-8;

/// Two moments count as equal for [`canonical_to_rounding`] where they differ by at most this part of the larger one. Sums
/// over matter and tensors turned to another frame are off by a few units of rounding.
pub const ROUNDING_RTOL: f64 = 16.0 * f64::EPSILON;

/// The same moments with the free axes turned to the body frame; moments closer than `rtol` times the largest magnitude
/// count as equal.
///
/// All three equal: the axes are the body's own. Two equal: the pair across the symmetry axis n is what the shortest
/// rotation to n makes of the other two axes of the body frame (of n and −n the nearer one, or, where n lies across its axis
/// of the body frame, the one whose largest component is positive). No other pair is nearer: see the theory page. The sign
/// rule then holds as ever. Where no two are equal, or a moment is not finite, nothing changes.
///
/// V diag(I) Vᵀ then equals the tensor to `rtol` rather than to rounding.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::nalgebra::{Matrix3, Rotation3, Vector3};
/// use polhode::principal::{TOP_RTOL, canonical};
///
/// // A brick that is nearly a cube has its own axes; to a part in 10⁶ any axes will do, and the body's are canonical.
/// let brick = solids::cuboid(&[1.0, 1.0 + 1e-8, 1.0 - 1e-8], Amount::Mass(1.0))?;
/// let tilted = brick.rotated(&Rotation3::from_axis_angle(&Vector3::x_axis(), 0.1).into_inner())?;
/// assert_ne!(tilted.principal().axes, Matrix3::identity());
/// assert_eq!(canonical(&tilted.principal(), TOP_RTOL).axes, Matrix3::identity());
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn canonical(principal: &PrincipalAxes, rtol: f64) -> PrincipalAxes {
    let [i1, _, i3] = principal.moments;
    let close = rtol * i1.abs().max(i3.abs());
    align(principal, |a, b| b - a <= close)
}

/// As [`canonical`], moments that rounding alone keeps apart ([`ROUNDING_RTOL`]) counting as equal: the axes of every body
/// that is made from a tensor or from matter.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::{Matrix3, Vector3};
/// use polhode::principal::{PrincipalAxes, ROUNDING_RTOL, canonical_to_rounding};
///
/// let flip = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
/// let with_gap = |gap: f64| canonical_to_rounding(&PrincipalAxes { moments: [1.0, 1.0 + gap, 2.0], axes: flip }).axes;
/// assert_eq!(with_gap(0.5 * ROUNDING_RTOL), Matrix3::identity());
/// assert_eq!(with_gap(2.0 * ROUNDING_RTOL), flip);
/// ```
#[must_use]
#[inline]
pub fn canonical_to_rounding(principal: &PrincipalAxes) -> PrincipalAxes {
    align(principal, is_rounding)
}

/// Whether rounding alone may keep two of the moments apart: seen at a glance, where many are asked. Only then
/// [`canonical_to_rounding`] turns axes.
#[inline]
pub(super) fn may_be_free(&[i1, i2, i3]: &[f64; 3]) -> bool {
    (i2 - i1).min(i3 - i2) <= ROUNDING_RTOL * i1.abs().max(i3.abs())
}

/// Whether rounding alone keeps two moments, a ≤ b, apart.
#[inline]
fn is_rounding(a: f64, b: f64) -> bool {
    b - a <= ROUNDING_RTOL * a.abs().max(b.abs())
}

/// The free axes turned to the body frame, `are_equal` saying of two moments in ascending order whether they are.
#[inline]
fn align(principal: &PrincipalAxes, are_equal: impl Fn(f64, f64) -> bool) -> PrincipalAxes {
    let [i1, i2, i3] = principal.moments;
    let axes = match (are_equal(i1, i2), are_equal(i2, i3)) {
        (false, false) => return *principal,
        (true, true) => Matrix3::identity(),
        (true, false) => nearest_about(principal.axes.column(2).into(), 2),
        (false, true) => nearest_about(principal.axes.column(0).into(), 0),
    };
    PrincipalAxes {
        moments: principal.moments,
        axes,
    }
}

/// The axes nearest to the body frame whose column k is along the unit vector n, under the sign rule.
///
/// For an n whose component k is not negative, the sum of the cosines is largest, 1 + 2 `n_k`, for the shortest rotation
/// from `e_k` to n: it takes `e_j` to `e_j − n_j (e_k + n)/(1 + n_k)`.
fn nearest_about(n: Vector3<f64>, k: usize) -> Matrix3<f64> {
    let toward = if n[k].abs() > TIE {
        n[k]
    } else {
        // The direction of the sign rule, that both directions of n agree.
        let enough = n.amax() * (1.0 - 1e-8);
        n.iter().copied().find(|x| x.abs() >= enough).unwrap_or(1.0)
    };
    let n = n * 1.0_f64.copysign(toward);
    let mut between = n / (1.0 + n[k]);
    between[k] = 1.0; // (e_k + n)/(1 + n_k)
    let mut axes = Matrix3::identity();
    for j in 0..3 {
        let axis = if j == k {
            n
        } else {
            axes.column(j) - between * n[j]
        };
        axes.set_column(j, &axis);
    }
    with_sign_rule(axes)
}

/// As [`canonical`] for a stack in place, axes row-major.
///
/// About every 20 ms `watch` gets the fraction done; [`ControlFlow::Break`] ends the job.
///
/// # Examples
///
/// ```
/// use polhode::principal::{TOP_RTOL, canonical_many};
/// use std::ops::ControlFlow;
///
/// // A coin whose free axes came out along the diagonals: they are turned to x and y.
/// let half = 0.5_f64.sqrt();
/// let mut axes = [[half, -half, 0.0, half, half, 0.0, 0.0, 0.0, 1.0]];
/// canonical_many(&[[1.0, 1.0, 2.0]], &mut axes, TOP_RTOL, &mut |_| ControlFlow::Continue(())).unwrap();
/// assert!((axes[0][0] - 1.0).abs() < 1e-15 && axes[0][1].abs() < 1e-15);
/// ```
///
/// # Errors
/// [`Halt::Stopped`] if `watch` said so.
///
/// # Panics
/// If the lengths differ.
pub fn canonical_many(
    moments: &[[f64; 3]],
    axes: &mut [[f64; 9]],
    rtol: f64,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Halt<Infallible>> {
    assert_eq!(
        moments.len(),
        axes.len(),
        "as many triples of axes as of moments"
    );
    fill_blocks(axes, BLOCK, watch, |start, block| {
        for (&moments, row) in moments[start..].iter().zip(block) {
            let axes = Matrix3::from_row_slice(row);
            let found = canonical(&PrincipalAxes { moments, axes }, rtol);
            row.copy_from_slice(found.axes.transpose().as_slice());
        }
        Ok(())
    })
}

/// Rows that one thread does at a time.
const BLOCK: usize = 1024;

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Rotation3, Vector3};

    use super::{ControlFlow, canonical, canonical_many};
    use crate::principal::principal_axes;

    #[test]
    fn a_sphere_has_the_body_axes() {
        let found = principal_axes(&(Matrix3::identity() * 0.4 + Matrix3::repeat(1e-17)));
        assert_eq!(canonical(&found, 1e-6).axes, Matrix3::identity());
    }

    #[test]
    fn the_pair_of_a_top_lies_along_the_body_axes_it_can_reach() {
        for moments in [[1.0, 1.0, 1.5], [1.0, 2.0, 2.0], [0.0, 2.0, 2.0]] {
            let found = canonical(
                &principal_axes(&Matrix3::from_diagonal(&moments.into())),
                1e-6,
            );
            assert_eq!(found.axes, Matrix3::identity(), "{moments:?}");
        }
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.3).into_inner();
        let oblate = turn * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.5)) * turn.transpose();
        assert!(
            (canonical(&principal_axes(&oblate), 1e-6).axes - turn)
                .abs()
                .max()
                < 1e-15
        );
    }

    #[test]
    fn the_canonical_axes_diagonalise_the_tensor_and_obey_the_sign_rule() {
        for seed in 0..200 {
            let angle = f64::from(seed) * 0.7;
            let turn = Rotation3::from_euler_angles(angle, 2.0 * angle, 3.0 * angle).into_inner();
            let tensor =
                turn * Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.0)) * turn.transpose();
            let tensor = (tensor + tensor.transpose()) * 0.5;
            let found = canonical(&principal_axes(&tensor), 1e-6);
            let back =
                found.axes * Matrix3::from_diagonal(&found.moments.into()) * found.axes.transpose();
            assert!((back - tensor).abs().max() < 4e-15);
            assert!((found.axes.determinant() - 1.0).abs() < 1e-15);
            assert_eq!(super::with_sign_rule(found.axes), found.axes);
        }
    }

    #[test]
    fn a_stack_has_the_rows_of_its_own() {
        let tensors = [
            Matrix3::new(2.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 2.0),
            Matrix3::identity(),
            Matrix3::repeat(1.0),
        ];
        let found = tensors.map(|tensor| principal_axes(&tensor));
        let mut rows = found.map(|row| {
            row.axes
                .transpose()
                .data
                .0
                .as_flattened()
                .try_into()
                .unwrap()
        });
        let go_on = &mut |_| ControlFlow::Continue(());
        let moments = found.map(|row| row.moments);
        canonical_many(&moments, &mut rows, 1e-6, go_on).expect("nobody stops it");
        for (row, alone) in rows.iter().zip(&found) {
            assert_eq!(Matrix3::from_row_slice(row), canonical(alone, 1e-6).axes);
        }
    }

    #[test]
    fn three_different_moments_leave_nothing_free() {
        let found = principal_axes(&Matrix3::new(3.0, 0.1, 0.2, 0.1, 4.0, 0.3, 0.2, 0.3, 5.0));
        assert_eq!(canonical(&found, 1e-6), found);
        let nan = principal_axes(&Matrix3::repeat(f64::NAN));
        assert!(canonical(&nan, 1e-6).axes.iter().all(|x| x.is_nan()));
    }
}
