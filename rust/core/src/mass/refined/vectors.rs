//! Vectors and matrices of more than double precision.

use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::Real;

/// Three components to twice the precision.
pub type Vector = [DoubleDouble; 3];

/// The tensor with these rows, in these axes.
pub(super) fn within<T: Real>(rows: &[[T; 3]; 3], axes: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    axes.map(|axis| {
        let image = [0, 1, 2].map(|i| dot(&rows[i], &axis));
        axes.map(|other| dot(&other, &image))
    })
}

/// `½ V (3 − VᵀV)`: one step of Newton's method toward the nearest rotation, which squares the error.
pub(super) fn orthonormal<T: Real>(v: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    let (half, three) = (T::from(0.5), T::from(3.0));
    let gram = v.map(|a| v.map(|b| dot(&a, &b)));
    std::array::from_fn(|j| {
        std::array::from_fn(|i| {
            let weight = |k: usize| {
                if k == j {
                    three - gram[k][j]
                } else {
                    -gram[k][j]
                }
            };
            half * (v[0][i] * weight(0) + v[1][i] * weight(1) + v[2][i] * weight(2))
        })
    })
}

/// The component along an axis. Where this has zeros, as axes along those of B have, no product is taken.
pub(super) fn along<T: Real>(axis: &[T; 3], vector: &[T; 3]) -> T {
    let mut parts = (axis.iter().zip(vector))
        .filter(|(a, _)| a.rounded() != 0.0)
        .map(|(&a, &x)| a * x);
    let first = parts.next().unwrap_or_else(|| T::from(0.0));
    parts.fold(first, |sum, x| sum + x)
}

pub(super) fn dot<T: Real>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
