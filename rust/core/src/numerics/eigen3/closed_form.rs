//! The closed form: no iteration, no branch, every lane the same instructions.
//!
//! 1. The [deviator](super::deviator) and its isolated eigenvalue μ.
//! 2. The eigenvector of μ: the largest column of the adjugate of B − μ 1, which is a multiple of v vᵀ.
//! 3. An orthonormal basis of the plane across v, and in it a symmetric 2×2 problem, solved by one exact rotation. This
//!    is where the two close eigenvalues are told apart, so their distance is accurate however small it is.
//!
//! Eigenvalues come out accurate beside the largest, eigenvectors beside the spread of the eigenvalues.

use super::deviator::Deviator;
use super::symmetric::{Spectrum, Symmetric, dot};
use crate::numerics::lane::Lane;

/// Squares below this are those of vectors that are zero but for underflow.
const NULL: f64 = 1e-290;

/// The decomposition of a symmetric matrix from its deviator, signs as they come.
#[inline(always)]
pub(super) fn closed_form<L: Lane>(deviator: &Deviator<L>) -> Spectrum<L> {
    let (b, mu) = (&deviator.matrix, deviator.isolated);
    let v = isolated_eigenvector(b, mu);
    let (u, w) = complement(v);
    let pair = Pair::of(b, u, w);
    let (lower_vector, upper_vector) = pair.vectors(u, w);
    // The trace of B is zero, so the mean of the pair is −μ/2: better than the trace of the 2×2 matrix would tell.
    let mean = mu * L::new(-0.5);
    let isolated = deviator.back(mu);
    let lower = deviator.back(mean - pair.radius);
    let upper = deviator.back(mean + pair.radius);
    let (values, vectors) = if mu < L::new(0.0) {
        ([isolated, lower, upper], [v, lower_vector, upper_vector])
    } else {
        ([lower, upper, isolated], [lower_vector, upper_vector, v])
    };
    Spectrum {
        values,
        vectors,
        poison: deviator.poison,
    }
}

/// The unit eigenvector of B for μ; the z-axis where B is zero.
#[inline(always)]
fn isolated_eigenvector<L: Lane>(b: &Symmetric<L>, mu: L) -> [L; 3] {
    let (e0, e1, e2) = (b.a00 - mu, b.a11 - mu, b.a22 - mu);
    let k00 = e1.mul_add(e2, -(b.a12 * b.a12));
    let k11 = e0.mul_add(e2, -(b.a02 * b.a02));
    let k22 = e0.mul_add(e1, -(b.a01 * b.a01));
    let k01 = b.a02.mul_add(b.a12, -(b.a01 * e2));
    let k02 = b.a01.mul_add(b.a12, -(b.a02 * e1));
    let k12 = b.a01.mul_add(b.a02, -(b.a12 * e0));
    // The diagonal of v vᵀ shows which column is the longest.
    let longer = if k00 < k11 {
        [k01, k11, k12]
    } else {
        [k00, k01, k02]
    };
    let [x, y, z] = if k00.max(k11) < k22 {
        [k02, k12, k22]
    } else {
        longer
    };
    let square = x.mul_add(x, y.mul_add(y, z * z));
    let inverse = L::new(1.0) / square.max(L::new(NULL)).sqrt();
    let along_z = if square > L::new(0.0) {
        z * inverse
    } else {
        L::new(1.0)
    };
    [x * inverse, y * inverse, along_z]
}

/// Unit vectors u, w across the unit vector v, with u × w = v (Duff et al., J. Comput. Graph. Tech. 6, 2017).
#[inline(always)]
fn complement<L: Lane>([x, y, z]: [L; 3]) -> ([L; 3], [L; 3]) {
    let one = L::new(1.0);
    let sign = one.copysign(z);
    let a = -(one / (sign + z));
    let b = x * y * a;
    let u = [(sign * x).mul_add(x * a, one), sign * b, -(sign * x)];
    let w = [b, y.mul_add(y * a, sign), -y];
    (u, w)
}

/// The 2×2 problem in the plane of u and w.
struct Pair<L> {
    /// Half the distance of the two eigenvalues.
    radius: L,
    /// Half the difference of the diagonal elements of u and of w.
    half_difference: L,
    /// Cosine and sine of the angle from u or w, whichever has the larger diagonal element, to the upper eigenvector.
    cosine: L,
    sine: L,
}

impl<L: Lane> Pair<L> {
    #[inline(always)]
    fn of(b: &Symmetric<L>, u: [L; 3], w: [L; 3]) -> Self {
        let (bu, bw) = (b.times_vector(u), b.times_vector(w));
        let off_diagonal = dot(w, bu);
        let half_difference = (dot(u, bu) - dot(w, bw)) * L::new(0.5);
        let radius = half_difference
            .mul_add(half_difference, off_diagonal * off_diagonal)
            .sqrt();
        // (|h| + ρ, m) is along the upper eigenvector, and its first component does not cancel.
        let along = half_difference.abs() + radius;
        let square = along.mul_add(along, off_diagonal * off_diagonal);
        let inverse = L::new(1.0) / square.max(L::new(NULL)).sqrt();
        let split = square > L::new(NULL);
        Self {
            radius,
            half_difference,
            cosine: if split { along * inverse } else { L::new(1.0) },
            sine: if split {
                off_diagonal * inverse
            } else {
                L::new(0.0)
            },
        }
    }

    /// The eigenvectors of the lower and of the upper eigenvalue; lower × upper = v.
    #[inline(always)]
    fn vectors(&self, u: [L; 3], w: [L; 3]) -> ([L; 3], [L; 3]) {
        let (c, s) = (self.cosine, self.sine);
        let ((p, q), (r, t)) = if self.half_difference < L::new(0.0) {
            ((c, -s), (s, c))
        } else {
            ((s, -c), (c, s))
        };
        (combine(p, u, q, w), combine(r, u, t, w))
    }
}

#[inline(always)]
fn combine<L: Lane>(p: L, u: [L; 3], q: L, w: [L; 3]) -> [L; 3] {
    [
        p.mul_add(u[0], q * w[0]),
        p.mul_add(u[1], q * w[1]),
        p.mul_add(u[2], q * w[2]),
    ]
}
