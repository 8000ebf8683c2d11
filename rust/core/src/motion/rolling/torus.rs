//! A torus about the third of its own axes: a disk with a round edge.

use super::{disk, sphere};
use crate::numerics::power_series::{Arithmetic, plus};

/// Compute the point of contact and its rate: those of a disk of the major radius and of a sphere of the minor one, added.
pub(super) fn contact<N: Arithmetic>(
    [major, minor]: [f64; 2],
    normal: [N; 3],
    rate: [N; 3],
) -> [[N; 3]; 2] {
    let [center, of_center] = disk::contact(major, normal, rate);
    let [point, of_point] = sphere::contact(minor, normal, rate);
    [plus(center, point), plus(of_center, of_point)]
}
