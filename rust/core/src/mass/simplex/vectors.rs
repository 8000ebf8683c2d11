//! Differences and products of vectors in lanes.

use crate::numerics::lane::Lane;

#[inline(always)]
pub(super) fn difference<L: Lane>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn dot<L: Lane>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
pub(super) fn norm<L: Lane>(a: [L; 3]) -> L {
    dot(a, a).sqrt()
}

/// `e × f`, and the same with the magnitudes of all products.
#[inline(always)]
pub(super) fn cross<L: Lane>(e: [L; 3], f: [L; 3]) -> ([L; 3], [L; 3]) {
    let (p, q) = component(e[1], f[2], e[2], f[1]);
    let (r, s) = component(e[2], f[0], e[0], f[2]);
    let (t, u) = component(e[0], f[1], e[1], f[0]);
    ([p, r, t], [q, s, u])
}

/// `a b − c d` and `|a b| + |c d|`.
#[inline(always)]
fn component<L: Lane>(a: L, b: L, c: L, d: L) -> (L, L) {
    let cd = c * d;
    (a.mul_add(b, -cd), a.abs().mul_add(b.abs(), cd.abs()))
}
