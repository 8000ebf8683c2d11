//! Quotients of shifted theta functions: `ϑ₁(z + iy)/ϑ₄(z)` and `ϑ₂(z + iy)/ϑ₄(z)` with z = πu/2K, for fixed y.
//!
//! Their squared magnitudes are linear in sn²u, and their phases are elliptic integrals of the third kind but for a steady
//! part. The zero of either numerator lies at y = 0, so a small y keeps its digits; toward the other end of the strip,
//! `y = πK′/2K`, they become constant in magnitude, and nothing is lost there.
//!
//! Three of them come together, `ϑ₁` once and `ϑ₂` twice, with one denominator. Each may be scaled.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{HalfPeriods, circular, hyperbolic};
use crate::numerics::lane::Lane;

// The sums that the quotients are made of.

/// The values of the three: real and imaginary parts.
pub(crate) type Values<L> = [[L; 2]; 3];

/// `Σ aₙ xₙ`, from the end, where the small terms are.
#[inline(always)]
fn dot<L: Lane, const N: usize>(a: &[f64; N], x: &[L; N]) -> L {
    let mut sum = L::new(a[N - 1]) * x[N - 1];
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = L::new(a[k]).mul_add(x[k], sum);
    }
    sum
}

// The quotients by sines and cosines.

/// By sines and cosines of z, for K ≤ K′ or somewhat above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circular {
    /// 2q, 2q⁴, 2q⁹ of ϑ₄.
    below: [f64; 3],
    /// For each function the coefficients of its real and of its imaginary part.
    above: [[[f64; 4]; 2]; 3],
}

impl Circular {
    /// With the shifts `a = 2Ky/π`, |a| ≤ K′. Where K′ is infinite a may be.
    #[must_use]
    pub(crate) fn new(half: HalfPeriods, shifts: [f64; 3]) -> Self {
        let rate = FRAC_PI_2 / half.real;
        // ln q; the series end where q is zero.
        let log_q = -PI * half.imaginary / half.real;
        let q = log_q.exp();
        let above = [0_usize, 1, 2].map(|function| {
            let y = rate * shifts[function].abs();
            let middle = (-2.0 * y).exp();
            // ϑ₁ alternates; ϑ₂ has its sine with the other sign.
            let (alternating, turn) = if function == 0 {
                (-1.0, 1.0)
            } else {
                (1.0, -1.0)
            };
            let turn = turn * shifts[function].signum();
            let mut parts = [[0.0; 4]; 2];
            for n in 0..4_u8 {
                let order = f64::from(n);
                // q^{n²+n} cosh (2n+1)y and sinh, over cosh y.
                let far = middle.powi(2 * i32::from(n) + 1);
                let (sinh, size) = match n {
                    0 => (-(-2.0 * y).exp_m1(), 1.0),
                    _ if q == 0.0 => (1.0, 0.0),
                    _ => (
                        1.0 - far,
                        (order * (order + 1.0) * log_q + 2.0 * order * y).exp(),
                    ),
                };
                let sign = if n % 2 == 1 { alternating } else { 1.0 };
                let size = sign * size / (1.0 + middle);
                parts[0][usize::from(n)] = size * (1.0 + far);
                parts[1][usize::from(n)] = turn * size * sinh;
            }
            parts
        });
        Self {
            below: [1, 4, 9].map(|n| 2.0 * q.powi(n)),
            above,
        }
    }

    /// Each function times a factor.
    #[must_use]
    pub(crate) fn scaled(mut self, factors: [f64; 3]) -> Self {
        for (function, factor) in self.above.iter_mut().zip(factors) {
            for coefficient in function.as_flattened_mut() {
                *coefficient *= factor;
            }
        }
        self
    }

    /// The three at z.
    #[inline(always)]
    #[must_use]
    pub(crate) fn values<L: Lane>(&self, z: &circular::Argument<L>) -> Values<L> {
        let odd = |of: &[L; 10]| [of[1], of[3], of[5], of[7]];
        let (sines, cosines) = (odd(&z.sin), odd(&z.cos));
        let [q1, q4, q9] = self.below;
        let (q1, q4, q9) = (L::new(q1), L::new(q4), L::new(q9));
        let below = q4.mul_add(
            z.cos[4],
            (-q1).mul_add(z.cos[2], (-q9).mul_add(z.cos[6], L::new(1.0))),
        );
        let reciprocal = L::new(1.0) / below;
        let [first, second, third] = &self.above;
        let part = |coefficients: &[f64; 4], of: &[L; 4]| dot(coefficients, of) * reciprocal;
        [
            [part(&first[0], &sines), part(&first[1], &cosines)],
            [part(&second[0], &cosines), part(&second[1], &sines)],
            [part(&third[0], &cosines), part(&third[1], &sines)],
        ]
    }
}

// The quotients by hyperbolic functions.

/// By hyperbolic functions of πu/2K′, for K ≥ K′ and K = ∞.
///
/// A [value](Self::values) has to be turned by a phase that grows with u: [`Hyperbolic::slopes`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hyperbolic {
    /// `q′^{n²}` and `q′^{n²+n}` of ϑ₂.
    below: [f64; 4],
    below_far: [f64; 3],
    /// `q′^{n²−n}` and `q′^{n²}` of ϑ₃, from n = 1 on.
    beside: [f64; 3],
    beside_far: [f64; 3],
    /// For each function the real part's coefficients and the imaginary part's.
    above: [[[f64; 4]; 2]; 3],
    above_far: [[[f64; 3]; 2]; 3],
    slopes: [f64; 3],
}

impl Hyperbolic {
    /// With the shifts a, |a| ≤ K′.
    #[must_use]
    pub(crate) fn new(half: HalfPeriods, shifts: [f64; 3]) -> Self {
        let q = (-PI * half.real / half.imaginary).exp();
        let near = [0, 1, 4, 9].map(|n| q.powi(n));
        let far = [0, 2, 6].map(|n| q.powi(n));
        let angles = shifts.map(|a| FRAC_PI_2 * a / half.imaginary);
        let above = angles.map(|p| {
            let waves = |n: u8| {
                let sign = if n % 2 == 1 { -1.0 } else { 1.0 };
                let (s, c) = (f64::from(2 * n + 1) * p).sin_cos();
                (sign * c, sign * s)
            };
            [0, 1, 2, 3].map(waves)
        });
        let times = |power: &[f64], part: fn((f64, f64)) -> f64, waves: &[(f64, f64); 4]| {
            let mut out = [0.0; 4];
            for ((out, power), &wave) in out.iter_mut().zip(power).zip(waves) {
                *out = power * part(wave);
            }
            out
        };
        let first_three = |[a, b, c, _]: [f64; 4]| [a, b, c];
        Self {
            below: near,
            below_far: far,
            beside: [1.0, far[1], far[2]],
            beside_far: [near[1], near[2], near[3]],
            above: above
                .map(|waves| [times(&near, |w| w.0, &waves), times(&near, |w| w.1, &waves)]),
            above_far: above.map(|waves| {
                [
                    first_three(times(&far, |w| w.0, &waves)),
                    first_three(times(&far, |w| w.1, &waves)),
                ]
            }),
            slopes: angles.map(|p| -p / PI),
        }
    }

    /// Each function times a factor.
    #[must_use]
    pub(crate) fn scaled(mut self, factors: [f64; 3]) -> Self {
        for (k, factor) in factors.into_iter().enumerate() {
            for coefficient in self.above[k].as_flattened_mut() {
                *coefficient *= factor;
            }
            for coefficient in self.above_far[k].as_flattened_mut() {
                *coefficient *= factor;
            }
        }
        self
    }

    /// The phases that are still to be added, in turns for each full 2K: that of ϑ₁ times u/2K, those of ϑ₂ times
    /// `(|u| − K)/2K` with the sign of u.
    #[must_use]
    pub(crate) fn slopes(&self) -> [f64; 3] {
        self.slopes
    }

    /// The three at u but for those phases.
    #[inline(always)]
    #[must_use]
    pub(crate) fn values<L: Lane>(&self, u: &hyperbolic::Argument<L>) -> Values<L> {
        let one = L::new(1.0);
        let (g2, y2) = (u.from_middle * u.from_middle, u.from_end * u.from_end);
        let (g4, y4) = (g2 * g2, y2 * y2);
        let g = [one, g2, g4, g4 * g2];
        let y = [one, y2, y4, y4 * y2];
        let front = |x: &[L; 4]| [x[0], x[1], x[2]];
        let back = |x: &[L; 4]| [x[1], x[2], x[3]];
        let reciprocal = one / g2.mul_add(dot(&self.below_far, &front(&g)), dot(&self.below, &y));
        let beside = one / (one + dot(&self.beside, &back(&g)) + dot(&self.beside_far, &back(&y)));
        let size = u.from_middle * beside;
        let parts = |k: usize, near: &[L; 4], far: &[L; 4]| {
            let scale = far[1];
            let [real, imaginary] = &self.above[k];
            let [real_far, imaginary_far] = &self.above_far[k];
            [
                (-scale).mul_add(dot(real_far, &front(far)), dot(real, near)),
                scale.mul_add(dot(imaginary_far, &front(far)), dot(imaginary, near)),
            ]
        };
        let [re, im] = parts(0, &y, &g);
        let [re_1, im_1] = parts(1, &g, &y);
        let [re_2, im_2] = parts(2, &g, &y);
        [
            [u.sign * re * reciprocal, im * reciprocal],
            [re_1 * size, -(u.sign * im_1 * size)],
            [re_2 * size, -(u.sign * im_2 * size)],
        ]
    }
}

#[cfg(test)]
mod tests;
