//! Jacobi's method with a relative stop: every eigenvalue to its own relative accuracy.
//!
//! Rotations zero one off-diagonal element after the other until each is negligible beside the geometric
//! mean of its two diagonal elements. For a graded matrix D S D, with S well conditioned, that keeps the
//! small eigenvalues accurate however small they are (Demmel & Veselić, SIAM J. Matrix Anal. Appl. 13, 1992).
//! The closed form cannot do this: it sees the small eigenvalue only beside the large ones.

use super::symmetric::{Spectrum, Symmetric};
use crate::numerics::lane::{Lane, LaneMask};

/// An off-diagonal element o is negligible when o² ≤ this · |`d_p` `d_q`|: half a unit in the last place, squared.
const NEGLIGIBLE: f64 = 5e-32;
/// Cyclic Jacobi converges quadratically; 3×3 matrices take three or four sweeps.
const SWEEPS: usize = 12;

/// A matrix on its way to the diagonal form, and the product of the rotations so far, by columns.
struct Iterate<L> {
    d: [L; 3],
    o01: L,
    o02: L,
    o12: L,
    v: [[L; 3]; 3],
}

/// The decomposition of a symmetric matrix, signs as they come.
///
/// Lanes go in lock-step, and a lane whose element is negligible is left as it is: how often the others
/// sweep does not change its bits.
#[inline(always)]
pub(super) fn jacobi<L: Lane>(a: &Symmetric<L>) -> (Spectrum<L>, L) {
    let scaled = a.scaled();
    let (a, zero, one) = (scaled.matrix, L::splat(0.0), L::splat(1.0));
    let mut iterate = Iterate {
        d: [a.a00, a.a11, a.a22],
        o01: a.a01,
        o02: a.a02,
        o12: a.a12,
        v: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
    };
    let mut sweep = 0;
    while sweep < SWEEPS && iterate.significant().any() {
        iterate.sweep();
        sweep += 1;
    }
    iterate.order(0, 1);
    iterate.order(1, 2);
    iterate.order(0, 1);
    let Iterate { d, v, .. } = iterate;
    let back = |x: L| (x + scaled.poison) * scaled.unscale;
    (
        Spectrum {
            values: [back(d[0]), back(d[1]), back(d[2])],
            vectors: v,
        },
        scaled.poison,
    )
}

#[inline(always)]
fn is_significant<L: Lane>(o: L, dp: L, dq: L) -> L::Mask {
    ((dp * dq).abs() * L::splat(NEGLIGIBLE)).lt(o * o)
}

impl<L: Lane> Iterate<L> {
    #[inline(always)]
    fn significant(&self) -> L::Mask {
        let [d0, d1, d2] = self.d;
        is_significant(self.o01, d0, d1)
            | is_significant(self.o02, d0, d2)
            | is_significant(self.o12, d1, d2)
    }

    #[inline(always)]
    fn sweep(&mut self) {
        let Self {
            d: [d0, d1, d2],
            o01,
            o02,
            o12,
            v: [v0, v1, v2],
        } = self;
        rotate((d0, d1), o01, (o02, o12), (v0, v1));
        rotate((d0, d2), o02, (o01, o12), (v0, v2));
        rotate((d1, d2), o12, (o01, o02), (v1, v2));
    }

    /// Exchanges columns i and j where their values are out of order, turning one so that det V stays +1.
    #[inline(always)]
    fn order(&mut self, i: usize, j: usize) {
        let (di, dj) = (self.d[i], self.d[j]);
        let swap = dj.lt(di);
        self.d[i] = L::select(swap, dj, di);
        self.d[j] = L::select(swap, di, dj);
        let mut row = 0;
        while row < 3 {
            let (vi, vj) = (self.v[i][row], self.v[j][row]);
            self.v[i][row] = L::select(swap, vj, vi);
            self.v[j][row] = L::select(swap, -vi, vj);
            row += 1;
        }
    }
}

/// Rotates in the plane (p, q) so that the element o = `o_pq` becomes zero; `beside` are the elements that p
/// and q share with the third index.
#[inline(always)]
fn rotate<L: Lane>(
    (dp, dq): (&mut L, &mut L),
    o: &mut L,
    (op, oq): (&mut L, &mut L),
    (vp, vq): (&mut [L; 3], &mut [L; 3]),
) {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    // tan φ, the smaller root of t² + (h/o) t − 1 = 0: |φ| ≤ π/4. The floor turns 0/0 into 0.
    let (h, g) = (*dq - *dp, *o + *o);
    let root = h.mul_add(h, g * g).sqrt();
    let t = g / (h.abs() + root).max(L::splat(1e-300)).copysign(h);
    let t = L::select(is_significant(*o, *dp, *dq), t.min(one).max(-one), zero);
    let c = one / t.mul_add(t, one).sqrt();
    let s = t * c;
    let shift = t * *o;
    *dp = *dp - shift;
    *dq = *dq + shift;
    *o = zero;
    turn(c, s, op, oq);
    let mut row = 0;
    while row < 3 {
        turn(c, s, &mut vp[row], &mut vq[row]);
        row += 1;
    }
}

/// (a, b) ← (c a − s b, s a + c b).
#[inline(always)]
fn turn<L: Lane>(c: L, s: L, a: &mut L, b: &mut L) {
    let (x, y) = (*a, *b);
    *a = c.mul_add(x, -(s * y));
    *b = s.mul_add(x, c * y);
}
