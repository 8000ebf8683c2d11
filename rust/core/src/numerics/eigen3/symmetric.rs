//! Symmetric 3×3 matrices and their spectral decompositions, in lanes.

use crate::numerics::lane::Lane;

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

/// A = V diag(values) Vᵀ, values ascending; `vectors[k]` is column k of V, det V = +1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spectrum<L> {
    pub(super) values: [L; 3],
    pub(super) vectors: [[L; 3]; 3],
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

impl<L: Lane> Symmetric<L> {
    /// Reads the lower triangles of consecutive row-major matrices.
    #[inline(always)]
    pub(super) fn gather(rows: &[f64]) -> Self {
        Self {
            a00: L::gather(rows, 9, 0),
            a01: L::gather(rows, 9, 3),
            a02: L::gather(rows, 9, 6),
            a11: L::gather(rows, 9, 4),
            a12: L::gather(rows, 9, 7),
            a22: L::gather(rows, 9, 8),
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

    /// Scales the largest magnitude into [1, 2) (denormal: to at most 1; above 2^1023: to at most 4).
    #[inline(always)]
    pub(super) fn scaled(&self) -> Scaled<L> {
        let (scale, unscale) = self.max_abs().power_of_two_scale();
        let matrix = self.times(scale);
        let sum = matrix.a00 + matrix.a01 + matrix.a02 + matrix.a11 + matrix.a12 + matrix.a22;
        Scaled {
            matrix,
            unscale,
            poison: sum.abs() * L::splat(0.0),
        }
    }
}

impl<L: Lane> Spectrum<L> {
    /// The same decomposition under the sign rule: in columns 0 and 1 the first component that is as large as the
    /// largest, to 1e-8, is positive; column 2 turns with them, so that det V stays +1. No component is −0.
    #[inline(always)]
    pub(super) fn with_sign_rule(self, poison: L) -> Self {
        let [v0, v1, v2] = self.vectors;
        let (s0, s1) = (leading_sign(v0), leading_sign(v1));
        let signed = |v: [L; 3], s: L| {
            [
                v[0].mul_add(s, poison),
                v[1].mul_add(s, poison),
                v[2].mul_add(s, poison),
            ]
        };
        Self {
            values: self.values,
            vectors: [signed(v0, s0), signed(v1, s1), signed(v2, s0 * s1)],
        }
    }

    /// Writes the values, and the columns of V as row-major matrices.
    #[inline(always)]
    pub(super) fn scatter(&self, values: &mut [f64], vectors: &mut [f64]) {
        let mut column = 0;
        while column < 3 {
            self.values[column].scatter(values, 3, column);
            let mut row = 0;
            while row < 3 {
                self.vectors[column][row].scatter(vectors, 9, 3 * row + column);
                row += 1;
            }
            column += 1;
        }
    }
}

/// ±1: the sign of the first component within 1e-8 of the largest. Components that differ only by rounding
/// count as equal, so that a symmetric body's axes do not flip with its last bits.
#[inline(always)]
fn leading_sign<L: Lane>(v: [L; 3]) -> L {
    let enough = v[0].abs().max(v[1].abs()).max(v[2].abs()) * L::splat(1.0 - 1e-8);
    let later = L::select(enough.le(v[1].abs()), v[1], v[2]);
    L::splat(1.0).copysign(L::select(enough.le(v[0].abs()), v[0], later))
}
