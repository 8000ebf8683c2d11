//! An elliptic paraboloid `z = −h + x²/(2 r₁) + y²/(2 r₂)`, its apex downward; its rim is at z = 0.

use crate::numerics::power_series::Arithmetic;

/// Compute the point whose outward normal, along `(x/r₁, y/r₂, −1)`, is −γ, and its rate. `radii`: r₁ and r₂ at the apex; `apex`: h.
pub(super) fn contact<N: Arithmetic>(
    radii: &[f64; 2],
    apex: f64,
    normal: [N; 3],
    rate: [N; 3],
) -> [[N; 3]; 2] {
    let up = normal[2];
    let [x, y] = [0, 1].map(|i| normal[i] * -radii[i] / up);
    let [x_rate, y_rate] =
        [(0, x), (1, y)].map(|(i, place)| -(rate[i] * radii[i] + place * rate[2]) / up);
    let [slope, other_slope] = [x * (1.0 / radii[0]), y * (1.0 / radii[1])];
    let height = (x * slope + y * other_slope) * 0.5 + -apex;
    [
        [x, y, height],
        [x_rate, y_rate, slope * x_rate + other_slope * y_rate],
    ]
}
