//! The deviator B = A − (tr A/3) 1, and its isolated eigenvalue without trigonometry.
//!
//! The eigenvectors of A are those of B, and B is formed from *differences* of the elements of A. So the axes of a
//! nearly spherical body are as accurate as its spread allows: A itself has lost them in rounding long before.

use super::symmetric::{Scaled, Symmetric};
use crate::numerics::lane::Lane;

/// A = mean · 1 + B/scale, with B scaled by a power of two of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviator<L> {
    pub(super) matrix: Symmetric<L>,
    /// The power of two that takes results back to the scale of A.
    pub(super) unscale: L,
    /// The mean of the eigenvalues of A.
    pub(super) mean: L,
    /// Sum of the squares of the off-diagonal elements of B; zero where A is diagonal.
    pub(super) off_diagonal: L,
    /// The determinant of B, never −0. Where it is negative the isolated eigenvalue is the smallest, else the largest.
    pub(super) determinant: L,
}

impl<L: Lane> Deviator<L> {
    #[inline(always)]
    pub(super) fn of(a: &Symmetric<L>) -> Self {
        let third = L::new(1.0 / 3.0);
        let (d01, d02, d12) = (a.a00 - a.a11, a.a00 - a.a22, a.a11 - a.a22);
        let unscaled = Symmetric {
            a00: (d01 + d02) * third,
            a11: (d12 - d01) * third,
            a22: -((d02 + d12) * third),
            ..*a
        };
        let (scale, unscale) = unscaled.max_abs().power_of_two_scale();
        let b = unscaled.times(scale);
        let minor00 = b.a11.mul_add(b.a22, -(b.a12 * b.a12));
        let minor01 = b.a12.mul_add(b.a02, -(b.a01 * b.a22));
        let minor02 = b.a01.mul_add(b.a12, -(b.a11 * b.a02));
        let determinant = b
            .a00
            .mul_add(minor00, b.a01.mul_add(minor01, b.a02 * minor02));
        Self {
            matrix: b,
            unscale,
            mean: (a.a00 + a.a11 + a.a22) * third,
            off_diagonal: b.a01.mul_add(b.a01, b.a02.mul_add(b.a02, b.a12 * b.a12)),
            determinant: determinant + L::new(0.0),
        }
    }

    /// The eigenvalue of B that stands farther from the other two than they from each other.
    ///
    /// With J₂ = ½ tr B² and p = J₂/3 it is μ = ±2 √p x, where x ∈ [cos 30°, 1] is the largest root of
    /// 4x³ − 3x = r = ½ |det B| / p^{3/2}: there the slope is at least 6, so the root is well conditioned and one step of
    /// Newton's method from a polynomial is exact to rounding. It bears the sign of det B.
    #[inline(always)]
    pub(super) fn isolated_eigenvalue(&self) -> L {
        let b = &self.matrix;
        let diagonal = b.a00.mul_add(b.a00, b.a11.mul_add(b.a11, b.a22 * b.a22));
        let j2 = diagonal.mul_add(L::new(0.5), self.off_diagonal);
        let p = j2 * L::new(1.0 / 3.0);
        let root_p = p.sqrt();
        // The floor turns the 0/0 of B = 0 into 0.
        let r = (self.determinant.abs() * L::new(0.5) / (p * root_p).max(L::new(1e-300)))
            .min(L::new(1.0));
        let x = third_of_the_angle(r);
        let square = x * x;
        let excess = x.mul_add(square.mul_add(L::new(4.0), L::new(-3.0)), -r);
        let slope = square.mul_add(L::new(12.0), L::new(-3.0));
        ((root_p + root_p) * (x - excess / slope)).copysign(self.determinant)
    }

    /// An eigenvalue of B as one of the original matrix.
    #[inline(always)]
    pub(super) fn back(&self, scaled: &Scaled<L>, eigenvalue: L) -> L {
        (eigenvalue.mul_add(self.unscale, self.mean) + scaled.poison) * scaled.unscale
    }
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
