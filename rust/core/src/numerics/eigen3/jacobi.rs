//! Jacobi's method with a relative stop: every eigenvalue to its own relative accuracy.
//!
//! Rotations zero one off-diagonal element after the other until each is negligible beside the geometric mean of its two
//! diagonal elements. For a graded matrix D S D, with S well conditioned, that keeps the small eigenvalues accurate however
//! small they are (Demmel & Veselić, SIAM J. Matrix Anal. Appl. 13, 1992). The closed form cannot do this: it sees a small
//! eigenvalue only beside the large ones.
//!
//! Rows go in lock-step, sweep by sweep. An element that is negligible is left as it is, so that further sweeps, which
//! other rows may need, do not change a row's bits.

use super::symmetric::{Scaled, Spectrum, Symmetric};
use crate::numerics::lane::Lane;

/// Cyclic Jacobi converges quadratically: 3×3 matrices take three to five sweeps.
pub(super) const SWEEPS: usize = 12;
/// An off-diagonal element o is negligible when o² ≤ this · |`d_p` `d_q`|: about half a unit in the last place, squared.
const NEGLIGIBLE: f64 = 5e-32;

/// A matrix on its way to the diagonal form.
#[derive(Clone, Copy)]
pub(super) struct Iterate<L> {
    /// The diagonal.
    d: [L; 3],
    /// What the rounding of the diagonal has left so far.
    rest: [L; 3],
    o01: L,
    o02: L,
    o12: L,
    /// The product of the rotations so far, by columns.
    v: [[L; 3]; 3],
    unscale: L,
    poison: L,
}

/// The numbers of an iterate, of which one says whether another sweep is needed: 1 or 0.
pub(super) const NUMBERS: usize = 21;
pub(super) const UNFINISHED: usize = 20;

/// The decomposition of one matrix, signs as they come.
#[inline(always)]
pub(super) fn jacobi<L: Lane>(a: &Symmetric<L>) -> Spectrum<L> {
    let mut iterate = Iterate::start(a);
    let mut sweep = 0;
    while sweep < SWEEPS && iterate.is_unfinished() {
        iterate = iterate.swept();
        sweep += 1;
    }
    iterate.spectrum()
}

impl<L: Lane> Iterate<L> {
    #[inline(always)]
    pub(super) fn start(a: &Symmetric<L>) -> Self {
        let Scaled {
            matrix,
            unscale,
            poison,
        } = a.scaled();
        let (zero, one) = (L::new(0.0), L::new(1.0));
        // A diagonal matrix needs no products, hence no scaling, in which an element 300 decades below would be lost.
        let off_diagonal = a.a01.abs().max(a.a02.abs()).max(a.a12.abs());
        let (d, unscale) = if off_diagonal == zero {
            ([a.a00, a.a11, a.a22], one)
        } else {
            ([matrix.a00, matrix.a11, matrix.a22], unscale)
        };
        Self {
            d,
            rest: [zero; 3],
            o01: matrix.a01,
            o02: matrix.a02,
            o12: matrix.a12,
            v: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
            unscale,
            poison,
        }
    }

    /// Whether another sweep is needed.
    #[inline(always)]
    pub(super) fn is_unfinished(&self) -> bool {
        let [d0, d1, d2] = self.d;
        is_significant(self.o01, d0, d1)
            | is_significant(self.o02, d0, d2)
            | is_significant(self.o12, d1, d2)
    }

    /// One rotation in each plane.
    #[inline(always)]
    pub(super) fn swept(mut self) -> Self {
        let Self {
            d: [d0, d1, d2],
            rest: [r0, r1, r2],
            o01,
            o02,
            o12,
            v: [v0, v1, v2],
            ..
        } = &mut self;
        rotate((d0, d1), (r0, r1), o01, (o02, o12), (v0, v1));
        rotate((d0, d2), (r0, r2), o02, (o01, o12), (v0, v2));
        rotate((d1, d2), (r1, r2), o12, (o01, o02), (v1, v2));
        self
    }

    /// The decomposition that the iteration has come to, signs as they come.
    #[inline(always)]
    pub(super) fn spectrum(mut self) -> Spectrum<L> {
        let ([d0, d1, d2], [r0, r1, r2]) = (self.d, self.rest);
        self.d = [d0 + r0, d1 + r1, d2 + r2];
        self.order(0, 1);
        self.order(1, 2);
        self.order(0, 1);
        let values = self.d.map(|x| (x + self.poison) * self.unscale);
        Spectrum {
            values,
            vectors: self.v,
            poison: self.poison,
        }
    }

    /// Exchanges columns i and j where their values are out of order, turning one so that det V stays +1.
    #[inline(always)]
    fn order(&mut self, i: usize, j: usize) {
        let (di, dj, [xi, yi, zi], [xj, yj, zj]) = (self.d[i], self.d[j], self.v[i], self.v[j]);
        let swap = dj < di;
        self.d[i] = if swap { dj } else { di };
        self.d[j] = if swap { di } else { dj };
        self.v[i] = if swap { [xj, yj, zj] } else { [xi, yi, zi] };
        self.v[j] = if swap { [-xi, -yi, -zi] } else { [xj, yj, zj] };
    }

    #[inline(always)]
    pub(super) fn into_numbers(self) -> [L; NUMBERS] {
        let unfinished = L::new(if self.is_unfinished() { 1.0 } else { 0.0 });
        let Self {
            d: [d0, d1, d2],
            rest: [r0, r1, r2],
            o01,
            o02,
            o12,
            v: [a, b, c],
            unscale,
            poison,
        } = self;
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = [a, b, c];
        [
            d0, d1, d2, r0, r1, r2, o01, o02, o12, ax, ay, az, bx, by, bz, cx, cy, cz, unscale,
            poison, unfinished,
        ]
    }

    #[inline(always)]
    pub(super) fn from_numbers(numbers: [L; NUMBERS]) -> Self {
        let [
            d0,
            d1,
            d2,
            r0,
            r1,
            r2,
            o01,
            o02,
            o12,
            ax,
            ay,
            az,
            bx,
            by,
            bz,
            cx,
            cy,
            cz,
            unscale,
            poison,
            _,
        ] = numbers;
        let v = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]];
        Self {
            d: [d0, d1, d2],
            rest: [r0, r1, r2],
            o01,
            o02,
            o12,
            v,
            unscale,
            poison,
        }
    }
}

#[inline(always)]
fn is_significant<L: Lane>(o: L, dp: L, dq: L) -> bool {
    o * o > (dp * dq).abs() * L::new(NEGLIGIBLE)
}

/// Rotates in the plane (p, q) so that the element o = `o_pq` becomes zero; `op` and `oq` are those that p and q share
/// with the third index.
#[inline(always)]
fn rotate<L: Lane>(
    (dp, dq): (&mut L, &mut L),
    (rp, rq): (&mut L, &mut L),
    o: &mut L,
    (op, oq): (&mut L, &mut L),
    (vp, vq): (&mut [L; 3], &mut [L; 3]),
) {
    let (zero, one) = (L::new(0.0), L::new(1.0));
    // t = tan φ, the smaller root of t² + (h/o) t − 1 = 0, so |φ| ≤ π/4. The floor turns 0/0 into 0.
    let (h, g) = (*dq - *dp, *o + *o);
    let root = h.mul_add(h, g * g).sqrt();
    let smaller = g / (h.abs() + root).max(L::new(1e-300)).copysign(h);
    let within = smaller.min(one).max(-one);
    let t = if is_significant(*o, *dp, *dq) {
        within
    } else {
        zero
    };
    let c = one / t.mul_add(t, one).sqrt();
    let s = t * c;
    shift(-t, *o, dp, rp);
    shift(t, *o, dq, rq);
    *o = zero;
    turn(c, s, op, oq);
    let ([xp, yp, zp], [xq, yq, zq]) = (vp, vq);
    turn(c, s, xp, xq);
    turn(c, s, yp, yq);
    turn(c, s, zp, zq);
}

/// d ← d + t o, and to the rest r what the rounding of the sum leaves.
#[inline(always)]
fn shift<L: Lane>(t: L, o: L, d: &mut L, r: &mut L) {
    let sum = t.mul_add(o, *d);
    *r = *r + t.mul_add(o, *d - sum);
    *d = sum;
}

/// (a, b) ← (c a − s b, s a + c b).
#[inline(always)]
fn turn<L: Lane>(c: L, s: L, a: &mut L, b: &mut L) {
    let (x, y) = (*a, *b);
    *a = c.mul_add(x, -(s * y));
    *b = s.mul_add(x, c * y);
}
