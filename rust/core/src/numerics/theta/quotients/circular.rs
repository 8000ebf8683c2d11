//! The quotients by sines and cosines.

use std::f64::consts::{FRAC_PI_2, PI};

use super::series::{Values, dot};
use crate::numerics::lane::Lane;
use crate::numerics::theta::{HalfPeriods, circular};

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
