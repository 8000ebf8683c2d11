//! Eigenvalues and eigenvectors of symmetric 3×3 matrices: Jacobi's accuracy at a closed form's speed.
//!
//! Everywhere: only the lower triangle is read; values ascend; the eigenvectors are the **columns** of V, a
//! rotation (det V = +1) under the sign rule: in columns 0 and 1 the first component that is as large as the
//! largest, to 1e-8, is positive, and column 2 = column 0 × column 1. A matrix with an element that is not finite
//! gives NaN throughout, for itself alone. Elements may be anything from denormal to 5e307.

use std::ops::Range;

use nalgebra::Matrix3;

use super::dispatch::{Kernel, dispatch};
use super::lane::Lane;
use super::structure_of_arrays::{ROWS, RowFormula, StructureOfArrays};

// Symmetric 3×3 matrices and their spectral decompositions: scaling, products, the sign rule.

/// A = V diag(values) Vᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen3 {
    /// The eigenvalues, ascending.
    pub values: [f64; 3],
    /// The eigenvectors as columns, a rotation.
    pub vectors: Matrix3<f64>,
}

/// The six independent elements of a symmetric matrix.
#[derive(Clone, Copy, Debug)]
struct Symmetric<L> {
    a00: L,
    a01: L,
    a02: L,
    a11: L,
    a12: L,
    a22: L,
}

/// A matrix divided by a power of two, so that no product of two elements leaves the range of doubles.
#[derive(Clone, Copy, Debug)]
struct ScaledMatrix<L> {
    matrix: Symmetric<L>,
    /// The power of two that takes results back to the scale of the original.
    unscale: L,
    /// Zero; not a number where any element is not finite. Added to every result, since comparisons drop NaN.
    poison: L,
}

/// A = V diag(values) Vᵀ with ascending values; `vectors[k]` is column k of V, det V = +1.
#[derive(Clone, Copy, Debug)]
struct Spectrum<L> {
    values: [L; 3],
    vectors: [[L; 3]; 3],
    /// Zero; not a number where an element of A is not finite.
    poison: L,
}

/// The lower triangle of a row-major matrix, row by row.
#[inline(always)]
fn lower_triangle(a: &[f64; 9]) -> [f64; 6] {
    [a[0], a[3], a[4], a[6], a[7], a[8]]
}

impl<L: Lane> Symmetric<L> {
    #[inline(always)]
    fn from_lower_triangle([a00, a01, a11, a02, a12, a22]: [L; 6]) -> Self {
        Self {
            a00,
            a01,
            a02,
            a11,
            a12,
            a22,
        }
    }

    /// The largest magnitude among the elements.
    #[inline(always)]
    fn max_abs(&self) -> L {
        let diagonal = self.a00.abs().max(self.a11.abs()).max(self.a22.abs());
        diagonal
            .max(self.a01.abs())
            .max(self.a02.abs())
            .max(self.a12.abs())
    }

    #[inline(always)]
    fn times(&self, s: L) -> Self {
        Self {
            a00: self.a00 * s,
            a01: self.a01 * s,
            a02: self.a02 * s,
            a11: self.a11 * s,
            a12: self.a12 * s,
            a22: self.a22 * s,
        }
    }

    /// Scales the largest magnitude into [1, 2) (denormal: to at most 1; from 2¹⁰²³ on: to at most 4).
    #[inline(always)]
    fn scaled(&self) -> ScaledMatrix<L> {
        let (scale, unscale) = self.max_abs().power_of_two_scale();
        let matrix = self.times(scale);
        let sum = matrix.a00 + matrix.a01 + matrix.a02 + matrix.a11 + matrix.a12 + matrix.a22;
        ScaledMatrix {
            matrix,
            unscale,
            poison: sum.abs() * L::new(0.0),
        }
    }

    #[inline(always)]
    fn times_vector(&self, x: [L; 3]) -> [L; 3] {
        [
            dot([self.a00, self.a01, self.a02], x),
            dot([self.a01, self.a11, self.a12], x),
            dot([self.a02, self.a12, self.a22], x),
        ]
    }
}

#[inline(always)]
fn dot<L: Lane>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

impl<L: Lane> Spectrum<L> {
    /// The same decomposition under the sign rule: in columns 0 and 1 the first component that is as large as the
    /// largest, to 1e-8, is positive; column 2 turns with them, so that det V stays +1. No component is −0.
    #[inline(always)]
    fn with_sign_rule(self) -> Self {
        let ([v0, v1, v2], poison) = (self.vectors, self.poison);
        let (s0, s1) = (leading_sign(v0), leading_sign(v1));
        let vectors = [
            times(v0, s0, poison),
            times(v1, s1, poison),
            times(v2, s0 * s1, poison),
        ];
        Self { vectors, ..self }
    }
}

#[inline(always)]
fn times<L: Lane>(v: [L; 3], sign: L, poison: L) -> [L; 3] {
    [
        v[0].mul_add(sign, poison),
        v[1].mul_add(sign, poison),
        v[2].mul_add(sign, poison),
    ]
}

/// ±1: the sign of the first component within 1e-8 of the largest. Components that differ only by rounding count as
/// equal, so that a symmetric body's axes do not flip with its last bits.
#[inline(always)]
fn leading_sign<L: Lane>(v: [L; 3]) -> L {
    let enough = v[0].abs().max(v[1].abs()).max(v[2].abs()) * L::new(1.0 - 1e-8);
    let later = if v[1].abs() >= enough { v[1] } else { v[2] };
    let leading = if v[0].abs() >= enough { v[0] } else { later };
    L::new(1.0).copysign(leading)
}

// The deviator B = A − (tr A/3) 1, and its isolated eigenvalue without trigonometry.
//
// The eigenvectors of A are those of B, and B is formed from *differences* of the elements of A. So the axes of a
// nearly spherical body are as accurate as its spread allows: A itself has lost them in rounding long before.

/// A = unscale · (mean · 1 + ratio · B): scaled by a power of two, and its deviator by another.
#[derive(Clone, Copy, Debug)]
struct Deviator<L> {
    /// B.
    matrix: Symmetric<L>,
    /// The eigenvalue μ of B that stands farther from the other two than they from each other: where it is negative the
    /// smallest, else the largest.
    isolated: L,
    /// The mean of the eigenvalues of the scaled A.
    mean: L,
    ratio: L,
    unscale: L,
    /// Zero; not a number where an element of A is not finite.
    poison: L,
    /// Sum of the squares of the off-diagonal elements of B; zero where A is diagonal.
    off_diagonal: L,
}

/// The numbers of a deviator.
const DEVIATOR_NUMBERS: usize = 12;

impl<L: Lane> Deviator<L> {
    #[inline(always)]
    fn of(a: &Symmetric<L>) -> Self {
        let ScaledMatrix {
            matrix: a,
            unscale,
            poison,
        } = a.scaled();
        let third = L::new(1.0 / 3.0);
        let (d01, d02, d12) = (a.a00 - a.a11, a.a00 - a.a22, a.a11 - a.a22);
        let unscaled = Symmetric {
            a00: (d01 + d02) * third,
            a11: (d12 - d01) * third,
            a22: -((d02 + d12) * third),
            ..a
        };
        let (scale, ratio) = unscaled.max_abs().power_of_two_scale();
        let b = unscaled.times(scale);
        let off_diagonal = b.a01.mul_add(b.a01, b.a02.mul_add(b.a02, b.a12 * b.a12));
        Self {
            matrix: b,
            isolated: isolated_eigenvalue(&b, off_diagonal),
            mean: (a.a00 + a.a11 + a.a22) * third,
            ratio,
            unscale,
            poison,
            off_diagonal,
        }
    }

    /// An eigenvalue of B as one of A.
    #[inline(always)]
    fn back(&self, eigenvalue: L) -> L {
        (eigenvalue.mul_add(self.ratio, self.mean) + self.poison) * self.unscale
    }

    /// Whether A is diagonal, or so nearly that the squares of the other elements underflow.
    #[inline(always)]
    fn is_diagonal(&self) -> bool {
        self.off_diagonal == L::new(0.0)
    }

    #[inline(always)]
    fn into_numbers(self) -> [L; DEVIATOR_NUMBERS] {
        let Symmetric {
            a00,
            a01,
            a02,
            a11,
            a12,
            a22,
        } = self.matrix;
        let Self {
            isolated,
            mean,
            ratio,
            unscale,
            poison,
            off_diagonal,
            ..
        } = self;
        [
            a00,
            a01,
            a02,
            a11,
            a12,
            a22,
            isolated,
            mean,
            ratio,
            unscale,
            poison,
            off_diagonal,
        ]
    }

    #[inline(always)]
    fn from_numbers(numbers: [L; DEVIATOR_NUMBERS]) -> Self {
        let [
            a00,
            a01,
            a02,
            a11,
            a12,
            a22,
            isolated,
            mean,
            ratio,
            unscale,
            poison,
            off_diagonal,
        ] = numbers;
        let matrix = Symmetric {
            a00,
            a01,
            a02,
            a11,
            a12,
            a22,
        };
        Self {
            matrix,
            isolated,
            mean,
            ratio,
            unscale,
            poison,
            off_diagonal,
        }
    }
}

/// The isolated eigenvalue of B, with the sum of the squares of its off-diagonal elements.
///
/// With J₂ = ½ tr B² and p = J₂/3 it is μ = ±2 √p x, where x ∈ [cos 30°, 1] is the largest root of
/// 4x³ − 3x = r = ½ |det B| / p^{3/2}: there the slope is at least 6, so the root is well conditioned and one step of
/// Newton's method from a polynomial is exact to rounding. It bears the sign of det B.
#[inline(always)]
fn isolated_eigenvalue<L: Lane>(b: &Symmetric<L>, off_diagonal: L) -> L {
    let minor00 = b.a11.mul_add(b.a22, -(b.a12 * b.a12));
    let minor01 = b.a12.mul_add(b.a02, -(b.a01 * b.a22));
    let minor02 = b.a01.mul_add(b.a12, -(b.a11 * b.a02));
    let determinant = b
        .a00
        .mul_add(minor00, b.a01.mul_add(minor01, b.a02 * minor02));
    let diagonal = b.a00.mul_add(b.a00, b.a11.mul_add(b.a11, b.a22 * b.a22));
    let p = diagonal.mul_add(L::new(0.5), off_diagonal) * L::new(1.0 / 3.0);
    let root_p = p.sqrt();
    // The floor turns the 0/0 of B = 0 into 0.
    let r = determinant.abs() * L::new(0.5) / (p * root_p).max(L::new(1e-300));
    let r = r.min(L::new(1.0));
    let x = third_of_the_angle(r);
    let square = x * x;
    let excess = x.mul_add(square.mul_add(L::new(4.0), L::new(-3.0)), -r);
    let slope = square.mul_add(L::new(12.0), L::new(-3.0));
    ((root_p + root_p) * (x - excess / slope)).copysign(determinant)
}

/// cos(⅓ arccos r) on [0, 1], by the polynomial of degree 8 with the smallest largest error, 1.4e-9 (Remez's algorithm).
#[inline(always)]
fn third_of_the_angle<L: Lane>(r: L) -> L {
    const ASCENDING: [f64; 9] = [
        0.866_025_405_165_467_4,
        0.166_666_425_501_640_6,
        -0.048_105_564_873_728_43,
        0.024_613_175_366_369_61,
        -0.015_141_821_319_003_284,
        0.009_456_456_260_046_852,
        -0.005_015_555_920_979_552,
        0.001_817_410_034_595_74,
        -0.000_315_931_595_437_814_8,
    ];
    let mut sum = L::new(ASCENDING[8]);
    let mut k = 8;
    while k > 0 {
        k -= 1;
        sum = sum.mul_add(r, L::new(ASCENDING[k]));
    }
    sum
}

// The closed form: no iteration, no branch, every lane the same instructions.
//
// 1. The deviator and its isolated eigenvalue μ.
// 2. The eigenvector of μ: the largest column of the adjugate of B − μ 1, which is a multiple of v vᵀ.
// 3. An orthonormal basis of the plane across v, and in it a symmetric 2×2 problem, solved by one exact rotation. This
//    is where the two close eigenvalues are told apart, so their distance is accurate however small it is.
//
// Eigenvalues come out accurate beside the largest, eigenvectors beside the spread of the eigenvalues.

/// Squares below this are those of vectors that are zero but for underflow.
const NULL: f64 = 1e-290;

/// The decomposition of a symmetric matrix from its deviator, signs as they come.
#[inline(always)]
fn closed_form<L: Lane>(deviator: &Deviator<L>) -> Spectrum<L> {
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

// Jacobi's method with a relative stop: every eigenvalue to its own relative accuracy.
//
// Rotations zero one off-diagonal element after the other until each is negligible beside the geometric mean of its two
// diagonal elements. For a graded matrix D S D, with S well conditioned, that keeps the small eigenvalues accurate however
// small they are (Demmel & Veselić, SIAM J. Matrix Anal. Appl. 13, 1992). The closed form cannot do this: it sees a small
// eigenvalue only beside the large ones.
//
// Rows go in lock-step, sweep by sweep. An element that is negligible is left as it is, so that further sweeps, which
// other rows may need, do not change a row's bits.

/// Cyclic Jacobi converges quadratically: 3×3 matrices take three to five sweeps.
const SWEEPS: usize = 12;

/// An off-diagonal element o is negligible when o² ≤ this · |`d_p` `d_q`|: about half a unit in the last place, squared.
const NEGLIGIBLE: f64 = 5e-32;

/// A matrix on its way to the diagonal form.
#[derive(Clone, Copy)]
struct Iterate<L> {
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
const ITERATE_NUMBERS: usize = 21;

const UNFINISHED: usize = 20;

/// The decomposition of one matrix, signs as they come.
#[inline(always)]
fn jacobi<L: Lane>(a: &Symmetric<L>) -> Spectrum<L> {
    let mut iterate = Iterate::start(a);
    let mut sweep = 0;
    while sweep < SWEEPS && iterate.is_unfinished() {
        iterate = iterate.sweep();
        sweep += 1;
    }
    iterate.spectrum()
}

impl<L: Lane> Iterate<L> {
    #[inline(always)]
    fn start(a: &Symmetric<L>) -> Self {
        let ScaledMatrix {
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
    fn is_unfinished(&self) -> bool {
        let [d0, d1, d2] = self.d;
        is_significant(self.o01, d0, d1)
            | is_significant(self.o02, d0, d2)
            | is_significant(self.o12, d1, d2)
    }

    /// One rotation in each plane.
    #[inline(always)]
    fn sweep(mut self) -> Self {
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
    fn spectrum(mut self) -> Spectrum<L> {
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
    fn into_numbers(self) -> [L; ITERATE_NUMBERS] {
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
    fn from_numbers(numbers: [L; ITERATE_NUMBERS]) -> Self {
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

// One matrix and stacks of them: which method a row goes to, and the passage from rows to planes and back.
//
// Every row goes through the closed form. The few whose smallest eigenvalue is small beside the largest, and the
// diagonal ones, are queued and done again by Jacobi's method. Which of the two a row gets depends on the row alone.

/// An eigenvalue below this part of the largest, by magnitude, is found by Jacobi's method. The closed form's error, a
/// few units in the last place of the largest, stays below twenty times as much of any other.
const GRADED: f64 = 0.05;

/// The numbers computed for a row: its eigenvalues, and 1 where it has to be done again, else 0.
const VALUES_ONLY: usize = 4;

/// The same and the elements of V, row by row.
const WITH_VECTORS: usize = 13;

/// Whether the closed form's spectrum is to be found again; also where it is not a number.
#[inline(always)]
fn needs_jacobi<L: Lane>(deviator: &Deviator<L>, spectrum: &Spectrum<L>) -> bool {
    let [first, middle, last] = spectrum.values.map(L::abs);
    let is_level = first.min(middle).min(last) > first.max(last) * L::new(GRADED);
    deviator.is_diagonal() || !is_level
}

/// The decomposition of one matrix.
struct One([f64; 9]);

impl Kernel for One {
    // As the caller returns it: a copy would wait until it is written.
    type Output = Eigen3;

    const IS_WIDE: bool = false;

    #[inline(always)]
    fn run<L: Lane>(self) -> Eigen3 {
        let a = Symmetric::from_lower_triangle(lower_triangle(&self.0).map(L::new));
        let deviator = Deviator::of(&a);
        let found = closed_form(&deviator);
        let spectrum = if needs_jacobi(&deviator, &found) {
            jacobi(&a)
        } else {
            found
        };
        let Spectrum {
            values, vectors, ..
        } = spectrum.with_sign_rule();
        Eigen3 {
            values: values.map(L::get),
            vectors: vectors.map(|column| column.map(L::get)).into(),
        }
    }
}

/// The decompositions of a stack: the first `N` results of each row, the same bits for any `N`.
struct Stack<'a, const N: usize> {
    matrices: &'a [[f64; 9]],
    check: &'a Check<'a>,
    values: &'a mut [[f64; 3]],
    /// Empty unless `WITH_VECTORS`.
    vectors: &'a mut [[f64; 9]],
}

/// The planes of one batch.
struct Work<const N: usize> {
    matrices: StructureOfArrays<6>,
    deviators: StructureOfArrays<{ DEVIATOR_NUMBERS }>,
    iterates: StructureOfArrays<{ ITERATE_NUMBERS }>,
    results: StructureOfArrays<N>,
}

impl<const N: usize> Kernel for Stack<'_, N> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn run<L: Lane>(mut self) -> Self::Output {
        let mut work = Work {
            matrices: StructureOfArrays::ZERO,
            deviators: StructureOfArrays::ZERO,
            iterates: StructureOfArrays::ZERO,
            results: StructureOfArrays::ZERO,
        };
        let mut queue = [0; 2 * ROWS];
        let mut queued = 0;
        let mut start = 0;
        while start < self.matrices.len() {
            let end = self.matrices.len().min(start + ROWS);
            if let Err(row) = (self.check)(&self.matrices[start..end]) {
                return Err(start + row);
            }
            self.closed_form_rows::<L>(start..end, &mut work);
            for row in start..end {
                queue[queued] = row;
                let [again] = work.results.get(row - start, VALUES_ONLY - 1);
                queued += usize::from(again != 0.0);
            }
            if queued >= ROWS {
                queued -= ROWS;
                self.jacobi_rows::<L>(&queue[queued..queued + ROWS], &mut work);
            }
            start = end;
        }
        self.jacobi_rows::<L>(&queue[..queued], &mut work);
        Ok(())
    }
}

impl<const N: usize> Stack<'_, N> {
    #[inline(always)]
    fn closed_form_rows<L: Lane>(&mut self, rows: Range<usize>, work: &mut Work<N>) {
        read_rows(&self.matrices[rows.clone()], &mut work.matrices);
        // In two loops: a processor looks only so far ahead, and overlaps the rows of a short loop better.
        work.matrices
            .map::<L, Deviate, { DEVIATOR_NUMBERS }>(rows.len(), &mut work.deviators);
        work.deviators
            .map::<L, Solve, N>(rows.len(), &mut work.results);
        write_values(&work.results, &mut self.values[rows.clone()]);
        if N == WITH_VECTORS {
            write_vectors(&work.results, &mut self.vectors[rows]);
        }
    }

    #[inline(always)]
    fn jacobi_rows<L: Lane>(&mut self, rows: &[usize], work: &mut Work<N>) {
        for (i, &row) in rows.iter().enumerate() {
            work.matrices.set(i, lower_triangle(&self.matrices[row]));
        }
        work.matrices
            .map::<L, Start, { ITERATE_NUMBERS }>(rows.len(), &mut work.iterates);
        let mut sweep = 0;
        while sweep < SWEEPS && work.iterates.any(UNFINISHED, rows.len()) {
            work.iterates.update::<L, Sweep>(rows.len());
            sweep += 1;
        }
        work.iterates
            .map::<L, Finish, N>(rows.len(), &mut work.results);
        for (i, &row) in rows.iter().enumerate() {
            self.values[row] = work.results.get(i, 0);
            if N == WITH_VECTORS {
                self.vectors[row] = work.results.get(i, VALUES_ONLY);
            }
        }
    }
}

// Turning rows into planes and back moves numbers and computes nothing. These functions stay outside the kernel, since
// inside the compiler would use the scatter instructions of AVX-512, which take twice as long.

#[inline(never)]
fn read_rows(matrices: &[[f64; 9]], planes: &mut StructureOfArrays<6>) {
    for (i, matrix) in matrices.iter().enumerate().take(ROWS) {
        planes.set(i, lower_triangle(matrix));
    }
}

#[inline(never)]
fn write_values<const N: usize>(results: &StructureOfArrays<N>, values: &mut [[f64; 3]]) {
    for (i, row) in values.iter_mut().enumerate().take(ROWS) {
        *row = results.get(i, 0);
    }
}

#[inline(never)]
fn write_vectors<const N: usize>(results: &StructureOfArrays<N>, vectors: &mut [[f64; 9]]) {
    for (i, row) in vectors.iter_mut().enumerate().take(ROWS) {
        *row = results.get(i, VALUES_ONLY);
    }
}

struct Deviate;

impl RowFormula<6, { DEVIATOR_NUMBERS }> for Deviate {
    #[inline(always)]
    fn apply<L: Lane>(lower_triangle: [L; 6]) -> [L; DEVIATOR_NUMBERS] {
        Deviator::of(&Symmetric::from_lower_triangle(lower_triangle)).into_numbers()
    }
}

struct Solve;

impl<const N: usize> RowFormula<{ DEVIATOR_NUMBERS }, N> for Solve {
    #[inline(always)]
    fn apply<L: Lane>(numbers: [L; DEVIATOR_NUMBERS]) -> [L; N] {
        let deviator = Deviator::from_numbers(numbers);
        let spectrum = closed_form(&deviator);
        results(spectrum, needs_jacobi(&deviator, &spectrum))
    }
}

struct Start;

impl RowFormula<6, { ITERATE_NUMBERS }> for Start {
    #[inline(always)]
    fn apply<L: Lane>(lower_triangle: [L; 6]) -> [L; ITERATE_NUMBERS] {
        Iterate::start(&Symmetric::from_lower_triangle(lower_triangle)).into_numbers()
    }
}

struct Sweep;

impl RowFormula<{ ITERATE_NUMBERS }, { ITERATE_NUMBERS }> for Sweep {
    #[inline(always)]
    fn apply<L: Lane>(numbers: [L; ITERATE_NUMBERS]) -> [L; ITERATE_NUMBERS] {
        Iterate::from_numbers(numbers).sweep().into_numbers()
    }
}

struct Finish;

impl<const N: usize> RowFormula<{ ITERATE_NUMBERS }, N> for Finish {
    #[inline(always)]
    fn apply<L: Lane>(numbers: [L; ITERATE_NUMBERS]) -> [L; N] {
        results(Iterate::from_numbers(numbers).spectrum(), false)
    }
}

/// The results of a row, or the first `N` of them.
#[inline(always)]
fn results<L: Lane, const N: usize>(spectrum: Spectrum<L>, again: bool) -> [L; N] {
    let again = L::new(if again { 1.0 } else { 0.0 });
    let Spectrum {
        values: [w0, w1, w2],
        vectors: [a, b, c],
        ..
    } = spectrum.with_sign_rule();
    let all = [
        w0, w1, w2, again, a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2],
    ];
    let mut some = [again; N];
    let mut k = 0;
    while k < N {
        some[k] = all[k];
        k += 1;
    }
    some
}

// The eigenvalues and eigenvectors of one matrix, or of many.

/// The decomposition of one matrix.
#[must_use]
#[inline]
pub fn eigen3(a: &Matrix3<f64>) -> Eigen3 {
    let [[a00, a10, a20], [_, a11, a21], [_, _, a22]] = a.data.0;
    dispatch(One([a00, a10, a20, a10, a11, a21, a20, a21, a22]))
}

/// Gets some matrices before they are decomposed, and returns the first that it refuses. They are few enough to be still in the
/// first-level cache then: a pass of its own over a long stack would read the memory twice.
pub(crate) type Check<'a> = dyn Fn(&[[f64; 9]]) -> Result<(), usize> + 'a;

/// Compute the decompositions of many matrices, on the calling thread; matrices and eigenvectors are row-major.
///
/// # Panics
/// If the lengths differ.
pub fn eigen3_many(matrices: &[[f64; 9]], values: &mut [[f64; 3]], vectors: &mut [[f64; 9]]) {
    let _ok = eigen3_many_checked(matrices, &|_| Ok(()), values, vectors);
}

/// Compute [`eigen3_many`] of matrices that pass `check`.
///
/// # Errors
/// The first row that `check` refuses. Values and vectors are then unspecified.
///
/// # Panics
/// If the lengths differ.
pub(crate) fn eigen3_many_checked(
    matrices: &[[f64; 9]],
    check: &Check<'_>,
    values: &mut [[f64; 3]],
    vectors: &mut [[f64; 9]],
) -> Result<(), usize> {
    assert_eq!(
        matrices.len(),
        values.len(),
        "as many triples of values as matrices"
    );
    assert_eq!(
        matrices.len(),
        vectors.len(),
        "as many triples of vectors as matrices"
    );
    dispatch(Stack::<WITH_VECTORS> {
        matrices,
        check,
        values,
        vectors,
    })
}

/// Compute the eigenvalues of many row-major matrices, on the calling thread: the bits of [`eigen3_many`] in less time.
///
/// # Panics
/// If the lengths differ.
pub fn eigenvalues3_many(matrices: &[[f64; 9]], values: &mut [[f64; 3]]) {
    let _ok = eigenvalues3_many_checked(matrices, &|_| Ok(()), values);
}

/// Compute [`eigenvalues3_many`] of matrices that pass `check`.
///
/// # Errors
/// The first row that `check` refuses. The values are then unspecified.
///
/// # Panics
/// If the lengths differ.
pub(crate) fn eigenvalues3_many_checked(
    matrices: &[[f64; 9]],
    check: &Check<'_>,
    values: &mut [[f64; 3]],
) -> Result<(), usize> {
    assert_eq!(
        matrices.len(),
        values.len(),
        "as many triples of values as matrices"
    );
    dispatch(Stack::<VALUES_ONLY> {
        matrices,
        check,
        values,
        vectors: &mut [],
    })
}

// The sign rule, for rotations that come from elsewhere.

/// A rotation under the sign rule: the same axes, turned by half turns about one of them.
#[must_use]
pub(crate) fn with_sign_rule(rotation: &Matrix3<f64>) -> Matrix3<f64> {
    dispatch(SignRule(rotation))
}

struct SignRule<'a>(&'a Matrix3<f64>);

impl Kernel for SignRule<'_> {
    type Output = Matrix3<f64>;

    const IS_WIDE: bool = false;

    #[inline(always)]
    fn run<L: Lane>(self) -> Matrix3<f64> {
        let vectors = self.0.data.0.map(|column| column.map(L::new));
        let spectrum = Spectrum {
            values: [L::new(0.0); 3],
            vectors,
            poison: L::new(0.0),
        };
        spectrum
            .with_sign_rule()
            .vectors
            .map(|column| column.map(L::get))
            .into()
    }
}
