//! Canonical axes: where a body leaves its axes free, those nearest to the body frame.
//!
//! Every axis of a sphere is principal, and every axis across the symmetry axis of a top. An eigensolver then returns axes
//! that hang on the last bits of the tensor. The canonical choice depends on the body alone.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use super::axes::{PrincipalAxes, with_sign_rule};
use crate::numerics::threads::{Halt, fill_blocks};

/// Projections whose squares are this close count as equal, and the earlier body axis is taken.
const TIE: f64 = 1e-8;

/// The same moments with the free axes turned to the body frame; moments closer than `rtol` times the largest magnitude
/// count as equal.
///
/// All three equal: the axes are the body's own. Two equal: of the body axes the one with the largest projection on the
/// plane of the pair (x before y before z where they tie) gives the pair's first axis its direction. The sign rule then
/// holds as ever. Where no two are equal, or a moment is not finite, nothing changes.
///
/// V diag(I) Vᵀ then equals the tensor to `rtol` rather than to rounding.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::nalgebra::Matrix3;
/// use polhode::principal::{TOP_RTOL, canonical};
///
/// // A ball has any axes: the canonical ones are those of the body frame.
/// let ball = solids::sphere(1.0, Amount::Mass(1.0))?;
/// assert_eq!(canonical(&ball.principal(), TOP_RTOL).axes, Matrix3::identity());
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn canonical(principal: &PrincipalAxes, rtol: f64) -> PrincipalAxes {
    let [i1, i2, i3] = principal.moments;
    let close = rtol * i1.abs().max(i3.abs());
    let axes = match (i2 - i1 <= close, i3 - i2 <= close) {
        (true, true) => Matrix3::identity(),
        (true, false) => {
            let symmetry = principal.axes.column(2).into_owned();
            let first = nearest_across(&symmetry);
            with_sign_rule(Matrix3::from_columns(&[
                first,
                symmetry.cross(&first),
                symmetry,
            ]))
        }
        (false, true) => {
            let symmetry = principal.axes.column(0).into_owned();
            let first = nearest_across(&symmetry);
            with_sign_rule(Matrix3::from_columns(&[
                symmetry,
                first,
                symmetry.cross(&first),
            ]))
        }
        (false, false) => principal.axes,
    };
    PrincipalAxes {
        moments: principal.moments,
        axes,
    }
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

/// The direction, across the unit vector n, of the projection of the body axis that has the longest.
fn nearest_across(n: &Vector3<f64>) -> Vector3<f64> {
    // The projection of e_k has the square 1 − n_k².
    let least = n.component_mul(n).min();
    let k = n.iter().position(|x| x * x <= least + TIE).unwrap_or(0);
    let mut projection = -n * n[k];
    projection[k] += 1.0;
    projection.normalize()
}

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
