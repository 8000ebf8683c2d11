//! An ellipsoid with its semi-axes along its own axes.

use crate::numerics::power_series::{Arithmetic, dot};

/// Compute `p = −A γ/√(γ·A γ)` with `A = diag(a², b², c²)`, and its rate.
pub(super) fn contact<N: Arithmetic>(
    semi_axes: &[f64; 3],
    normal: [N; 3],
    rate: [N; 3],
) -> [[N; 3]; 2] {
    let squared = |x: [N; 3]| [0, 1, 2].map(|i| x[i] * (semi_axes[i] * semi_axes[i]));
    let (b, change) = (squared(normal), squared(rate));
    let size = dot(normal, b).root();
    let point = b.map(|x| -x / size);
    let growth = dot(b, rate) / size;
    [
        point,
        [0, 1, 2].map(|i| -(change[i] + point[i] * growth) / size),
    ]
}
