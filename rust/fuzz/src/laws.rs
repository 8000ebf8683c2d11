//! The laws.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::{PrincipalAxes, RigidBody};

/// Rounding of a few dozen operations.
const ROUNDING: f64 = 1e-13;
/// What the least numbers of float64 may be off by.
pub const LEAST: f64 = 1e-320;

/// The largest element.
#[must_use]
pub fn size(a: &Matrix3<f64>) -> f64 {
    a.amax()
}

/// Whether numbers are so far from the ends of float64 that squares and products are numbers.
#[must_use]
pub fn is_plain(numbers: &[f64]) -> bool {
    (numbers.iter()).all(|x| *x == 0.0 || (1e-30..1e30).contains(&x.abs()))
}

/// Ascending finite moments, and axes that are a rotation and diagonalize the tensor to rounding and `bound`.
///
/// # Panics
/// When they are not.
pub fn diagonalizes(principal: &PrincipalAxes, tensor: &Matrix3<f64>, bound: f64) {
    let PrincipalAxes { moments, axes } = principal;
    assert!(
        moments.iter().all(|moment| moment.is_finite()),
        "moments {moments:?} of {tensor:?}"
    );
    assert!(
        moments[0] <= moments[1] && moments[1] <= moments[2],
        "moments {moments:?} do not ascend"
    );
    is_rotation(axes);
    // In units in which nothing overflows.
    let unit = size(tensor).max(f64::MIN_POSITIVE);
    let scaled = Vector3::from(moments.map(|moment| moment / unit));
    let again = axes * Matrix3::from_diagonal(&scaled) * axes.transpose();
    let off = size(&(again - tensor / unit));
    assert!(
        off <= ROUNDING + (LEAST + bound) / unit,
        "V diag(I) Vᵀ is off by {off} of {tensor:?}: {principal:?}, with a bound of {bound:?}"
    );
}

/// Orthonormal and right-handed.
///
/// # Panics
/// When it is not.
pub fn is_rotation(R: &Matrix3<f64>) {
    let off = size(&(R.transpose() * R - Matrix3::identity()));
    assert!(off <= ROUNDING, "RᵀR is off by {off}: {R:?}");
    assert!(R.determinant() > 0.0, "left-handed: {R:?}");
}

/// A quaternion of unit length.
///
/// # Panics
/// When it is none.
pub fn is_unit(q: &UnitQuaternion<f64>) {
    let norm = q.as_ref().norm();
    assert!((norm - 1.0).abs() <= ROUNDING, "|q| = {norm:?}");
}

/// A possible body: positive mass, finite numbers, moments that a distribution of mass can have to `admitted` of their sum,
/// a tensor that agrees with them, bounds that are bounds; and as an array the same again.
///
/// # Panics
/// When it is not.
pub fn is_body(body: &RigidBody, admitted: f64) {
    let (mass, center, inertia) = (body.mass(), body.center_of_mass(), body.inertia());
    assert!(mass > 0.0 && mass.is_finite(), "mass {mass:?}");
    assert!(center.iter().all(|x| x.is_finite()), "centre {center:?}");
    assert!(inertia.iter().all(|x| x.is_finite()), "tensor {inertia:?}");
    assert_eq!(inertia, inertia.transpose(), "not symmetric");
    let principal = body.principal();
    let bound = body.error_bound();
    for (what, bound) in [
        ("mass", bound.mass),
        ("centre", bound.center_of_mass),
        ("inertia", bound.inertia),
    ] {
        assert!(bound >= 0.0, "error bound {bound:?} of {what}: {body:?}");
    }
    // A body from storage is held to a part in 10¹² of its trace.
    let stored = admitted.min(1e-11) * principal.moments[2];
    // Where each element is off by the bound, an eigenvalue is by three times as much.
    diagonalizes(&principal, &inertia, 6.0 * bound.inertia + stored);
    let [i1, i2, i3] = principal.moments;
    assert!(i1 >= 0.0, "negative moment {i1:?}: {body:?}");
    let deficit = i3 - i2 - i1;
    // It is twice what the least second moment lacks. Where each element of the tensor is off by the bound, those of half
    // the trace less the tensor are by 3/2 of it on the diagonal and 1 beside it: an eigenvalue by 7/2. One bound more is for
    // sums of bodies that just pass.
    assert!(
        deficit <= (1e-14 + 3.0 * admitted) * i3 + 8.0 * bound.inertia + LEAST,
        "{i1:?} + {i2:?} < {i3:?}: {body:?}"
    );
    for (radius, moment) in body.radii_of_gyration().into_iter().zip(principal.moments) {
        // Beyond float64 it is infinite, as a quotient is.
        let want = moment.sqrt() / mass.sqrt();
        assert!(
            radius == want || (radius - want).abs() <= 1e-14 * want || radius.min(want) > 1e308,
            "radius of gyration {radius:?} for {want:?}: {body:?}"
        );
    }
    let numbers = body.to_array();
    let again = RigidBody::from_array(&numbers).map(|again| again.to_array().map(f64::to_bits));
    assert_eq!(
        again,
        Ok(numbers.map(f64::to_bits)),
        "as an array: {body:?}"
    );
}
