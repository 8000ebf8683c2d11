//! The deviator B = A − (tr A/3) 1, and its isolated eigenvalue without trigonometry.
//!
//! The eigenvectors of A are those of B, and B is formed from *differences* of the elements of A. So the axes of a
//! nearly spherical body are as accurate as its spread allows: A itself has lost them in rounding long before.

use super::symmetric::{Scaled, Symmetric};
use crate::numerics::lane::Lane;

/// A = unscale · (mean · 1 + ratio · B): scaled by a power of two, and its deviator by another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviator<L> {
    /// B.
    pub(super) matrix: Symmetric<L>,
    /// The eigenvalue μ of B that stands farther from the other two than they from each other: where it is negative the
    /// smallest, else the largest.
    pub(super) isolated: L,
    /// The mean of the eigenvalues of the scaled A.
    mean: L,
    ratio: L,
    unscale: L,
    /// Zero; not a number where an element of A is not finite.
    pub(super) poison: L,
    /// Sum of the squares of the off-diagonal elements of B; zero where A is diagonal.
    off_diagonal: L,
}

/// The numbers of a deviator.
pub(super) const NUMBERS: usize = 12;

impl<L: Lane> Deviator<L> {
    #[inline(always)]
    pub(super) fn of(a: &Symmetric<L>) -> Self {
        let Scaled {
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
    pub(super) fn back(&self, eigenvalue: L) -> L {
        (eigenvalue.mul_add(self.ratio, self.mean) + self.poison) * self.unscale
    }

    /// Whether A is diagonal, or so nearly that the squares of the other elements underflow.
    #[inline(always)]
    pub(super) fn is_diagonal(&self) -> bool {
        self.off_diagonal == L::new(0.0)
    }

    #[inline(always)]
    pub(super) fn into_numbers(self) -> [L; NUMBERS] {
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
    pub(super) fn from_numbers(numbers: [L; NUMBERS]) -> Self {
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
