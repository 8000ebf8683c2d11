//! Rotation vectors and their unit quaternions, to the last digits from none to half a turn.

use nalgebra::{Quaternion, Vector3};

/// The shortest rotation vector of `a⁻¹ b`, in the axes of both.
#[inline]
pub(super) fn rotation_vector(a: &Quaternion<f64>, b: &Quaternion<f64>) -> Vector3<f64> {
    let turn = a.conjugate() * b;
    let vector = turn.imag();
    let length = vector.norm();
    let scale = if length > 0.0 {
        2.0 * length.atan2(turn.w.abs()) / length
    } else {
        2.0
    };
    vector * if turn.w < 0.0 { -scale } else { scale }
}

/// The unit quaternion of a rotation vector.
#[inline]
pub(super) fn exponential(vector: &Vector3<f64>) -> Quaternion<f64> {
    let half = 0.5 * vector.norm();
    let (sine, cosine) = half.sin_cos();
    let scale = if half > 0.0 { 0.5 * sine / half } else { 0.5 };
    Quaternion::from_parts(cosine, vector * scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn rotation_vectors_come_back_from_none_to_half_a_turn() {
        let axis = Vector3::new(2.0, -3.0, 6.0) / 7.0;
        let start = exponential(&Vector3::new(0.3, -1.1, 0.7));
        for angle in [0.0, 1e-300, 1e-17, 1e-9, 0.02, 1.0, 3.0, PI - 1e-9] {
            let found = rotation_vector(&start, &(start * exponential(&(axis * angle))));
            assert!((found - axis * angle).norm() < 2e-15, "{angle}: {found}");
            let alone = rotation_vector(&Quaternion::identity(), &exponential(&(axis * angle)));
            assert!(
                (alone - axis * angle).norm() <= 1e-15 * angle,
                "{angle}: {alone}"
            );
        }
        // Beyond half a turn the way back is the shorter one.
        let found = rotation_vector(&start, &(start * exponential(&(axis * (PI + 0.1)))));
        assert!((found + axis * (PI - 0.1)).norm() < 2e-15);
    }
}
