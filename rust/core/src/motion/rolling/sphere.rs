//! A sphere about the origin of its own axes.

use crate::numerics::power_series::Arithmetic;

/// Compute `p = −a γ` and its rate. `radius`: a.
pub(super) fn contact<N: Arithmetic>(radius: f64, normal: [N; 3], rate: [N; 3]) -> [[N; 3]; 2] {
    [normal.map(|x| x * -radius), rate.map(|x| x * -radius)]
}
