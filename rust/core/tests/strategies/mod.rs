//! Random vectors, rotations and bodies for property tests.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use proptest::prelude::*;

pub(crate) fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-size..size, -size..size, -size..size].prop_map(Vector3::from)
}

pub(crate) fn rotation() -> impl Strategy<Value = Matrix3<f64>> {
    (vector(1.0), 0.0..std::f64::consts::PI).prop_filter_map("an axis", |(axis, angle)| {
        let axis = nalgebra::Unit::try_new(axis, 1e-3)?;
        Some(
            UnitQuaternion::from_axis_angle(&axis, angle)
                .to_rotation_matrix()
                .into_inner(),
        )
    })
}

/// Bodies from their second moments, which makes every one of them possible: solids, plates and needles of all scales.
pub(crate) fn any_body() -> impl Strategy<Value = RigidBody> {
    let second_moments = [-6.0..0.0_f64, -6.0..0.0_f64, -6.0..0.0_f64];
    (second_moments, -12.0..12.0_f64, rotation(), vector(5.0)).prop_map(
        |(s, scale, axes, center)| {
            let [a, b, c] = s.map(|exponent| 10.0_f64.powf(exponent + scale));
            RigidBody::from_principal(
                10.0_f64.powf(scale),
                &[b + c, a + c, a + b],
                &axes,
                &center,
                0.0,
            )
            .expect("a possible body")
        },
    )
}
