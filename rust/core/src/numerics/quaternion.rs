//! Quaternions (x, y, z, w) and cross products in numbers of any precision.

use nalgebra::{Matrix3, Vector3};

use super::number::Real;

/// p ∘ q, components (x, y, z, w).
#[inline]
pub(crate) fn product<X: Real>(p: [X; 4], q: [X; 4]) -> [X; 4] {
    let ([a, b, c, d], [x, y, z, w]) = (p, q);
    [
        d * x + a * w + b * z - c * y,
        d * y + b * w + c * x - a * z,
        d * z + c * w + a * y - b * x,
        d * w - a * x - b * y - c * z,
    ]
}

#[inline]
pub(crate) fn conjugate<X: Real>([x, y, z, w]: [X; 4]) -> [X; 4] {
    [-x, -y, -z, w]
}

#[inline]
pub(crate) fn normalized<X: Real>(q: [X; 4]) -> [X; 4] {
    let length = q.into_iter().fold(X::zero(), |sum, x| sum + x * x).root();
    q.map(|x| x / length)
}

/// `M v = a × v`.
#[inline]
pub(crate) fn cross_matrix<X: Real>(a: &Vector3<X>) -> Matrix3<X> {
    let zero = X::zero();
    Matrix3::new(zero, -a.z, a.y, a.z, zero, -a.x, -a.y, a.x, zero)
}
