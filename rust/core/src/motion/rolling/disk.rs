//! The sharp edge of a disk, or a hoop, about the third of its own axes.

use crate::numerics::power_series::Arithmetic;

/// Compute `p = −a t/|t|` and its rate; t is the part of γ in the plane of the disk. `radius`: a.
pub(super) fn contact<N: Arithmetic>(radius: f64, normal: [N; 3], rate: [N; 3]) -> [[N; 3]; 2] {
    let [x, y, z] = normal;
    let size = (x * x + y * y).root();
    let (x, y) = (x / size, y / size);
    // ḋ = (ṫ − d (d·ṫ))/|t| for the direction d = t/|t| is (d×ṫ)/|t| along that at right angles to it.
    let turn = (x * rate[1] - y * rate[0]) / size;
    [
        [x * -radius, y * -radius, z * 0.0],
        [y * turn * radius, x * turn * -radius, z * 0.0],
    ]
}
