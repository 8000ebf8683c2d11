//! What the content of a simplex is: a length, an area or a volume.

use super::vectors::{cross, difference, dot, norm};
use crate::numerics::lane::Lane;

/// What the content of a simplex is.
pub(in crate::mass) trait Kind<const N: usize> {
    /// Corners that count: those stored, and the reference itself in a solid.
    const VERTICES: f64;
    /// Content is this times [`Kind::content`].
    const FACTOR: f64;
    /// A multiple of the content, which may be negative, and what its rounding errors are relative to.
    fn content<L: Lane>(corners: &[[L; 3]; N]) -> (L, [L; 3]);
}

/// Segments: the length.
pub(in crate::mass) struct Wire;
/// Triangles: the area.
pub(in crate::mass) struct Shell;
/// Triangles whose normals may be too short to be squared: the area.
pub(in crate::mass) struct FaintShell;
/// Tetrahedra from the reference to triangles: the signed volume.
pub(in crate::mass) struct Solid;

impl Kind<2> for Wire {
    const VERTICES: f64 = 2.0;
    const FACTOR: f64 = 1.0;

    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 2]) -> (L, [L; 3]) {
        let zero = L::new(0.0);
        (norm(difference(corners[1], corners[0])), [zero; 3])
    }
}

impl Kind<3> for Shell {
    const VERTICES: f64 = 3.0;
    const FACTOR: f64 = 0.5;

    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 3]) -> (L, [L; 3]) {
        let (normal, scale) = area(corners);
        (norm(normal), scale)
    }
}

impl Kind<3> for FaintShell {
    const VERTICES: f64 = 3.0;
    const FACTOR: f64 = 0.5;

    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 3]) -> (L, [L; 3]) {
        let (normal, scale) = area(corners);
        let longest = normal[0].abs().max(normal[1].abs()).max(normal[2].abs());
        let (power, inverse) = longest.power_of_two_scale();
        let near = [normal[0] * power, normal[1] * power, normal[2] * power];
        (norm(near) * inverse, scale)
    }
}

/// Twice the area of a triangle along its normal, and what its rounding errors are relative to.
#[inline(always)]
fn area<L: Lane>(corners: &[[L; 3]; 3]) -> ([L; 3], [L; 3]) {
    let (e, f) = edges(corners);
    let (normal, positive) = cross(e, f);
    let length = |v: [L; 3]| v[0].abs() + v[1].abs() + v[2].abs();
    (
        normal,
        [length(positive), length(e) + length(f), L::new(0.0)],
    )
}

impl Kind<3> for Solid {
    const VERTICES: f64 = 4.0;
    const FACTOR: f64 = 1.0 / 6.0;

    // From the edges rather than from the corners: in a fine mesh they are short, and so are their rounding errors.
    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 3]) -> (L, [L; 3]) {
        let (e, f) = edges(corners);
        let (normal, positive) = cross(e, f);
        (dot(corners[0], normal), positive)
    }
}

#[inline(always)]
fn edges<L: Lane>(corners: &[[L; 3]; 3]) -> ([L; 3], [L; 3]) {
    (
        difference(corners[1], corners[0]),
        difference(corners[2], corners[0]),
    )
}
