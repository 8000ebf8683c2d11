//! Symmetric 3×3 matrices and their spectral decompositions: scaling, products, the sign rule.

use nalgebra::Matrix3;

use crate::numerics::lane::Lane;

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
pub(super) struct Symmetric<L> {
    pub(super) a00: L,
    pub(super) a01: L,
    pub(super) a02: L,
    pub(super) a11: L,
    pub(super) a12: L,
    pub(super) a22: L,
}

/// A matrix divided by a power of two, so that no product of two elements leaves the range of doubles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scaled<L> {
    pub(super) matrix: Symmetric<L>,
    /// The power of two that takes results back to the scale of the original.
    pub(super) unscale: L,
    /// Zero; not a number where any element is not finite. Added to every result, since comparisons drop NaN.
    pub(super) poison: L,
}

/// A = V diag(values) Vᵀ with ascending values; `vectors[k]` is column k of V, det V = +1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spectrum<L> {
    pub(super) values: [L; 3],
    pub(super) vectors: [[L; 3]; 3],
    /// Zero; not a number where an element of A is not finite.
    pub(super) poison: L,
}

/// The lower triangle of a row-major matrix, row by row.
#[inline(always)]
pub(super) fn lower_triangle(a: &[f64; 9]) -> [f64; 6] {
    [a[0], a[3], a[4], a[6], a[7], a[8]]
}

impl<L: Lane> Symmetric<L> {
    #[inline(always)]
    pub(super) fn from_lower_triangle([a00, a01, a11, a02, a12, a22]: [L; 6]) -> Self {
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
    pub(super) fn max_abs(&self) -> L {
        let diagonal = self.a00.abs().max(self.a11.abs()).max(self.a22.abs());
        diagonal
            .max(self.a01.abs())
            .max(self.a02.abs())
            .max(self.a12.abs())
    }

    #[inline(always)]
    pub(super) fn times(&self, s: L) -> Self {
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
    pub(super) fn scaled(&self) -> Scaled<L> {
        let (scale, unscale) = self.max_abs().power_of_two_scale();
        let matrix = self.times(scale);
        let sum = matrix.a00 + matrix.a01 + matrix.a02 + matrix.a11 + matrix.a12 + matrix.a22;
        Scaled {
            matrix,
            unscale,
            poison: sum.abs() * L::new(0.0),
        }
    }

    #[inline(always)]
    pub(super) fn times_vector(&self, x: [L; 3]) -> [L; 3] {
        [
            dot([self.a00, self.a01, self.a02], x),
            dot([self.a01, self.a11, self.a12], x),
            dot([self.a02, self.a12, self.a22], x),
        ]
    }
}

#[inline(always)]
pub(super) fn dot<L: Lane>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

impl<L: Lane> Spectrum<L> {
    /// The same decomposition under the sign rule: in columns 0 and 1 the first component that is as large as the
    /// largest, to 1e-8, is positive; column 2 turns with them, so that det V stays +1. No component is −0.
    #[inline(always)]
    pub(super) fn with_sign_rule(self) -> Self {
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
