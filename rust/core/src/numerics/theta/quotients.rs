//! Quotients of shifted theta functions: `ϑ₁(z + iy)/ϑ₄(z)` and `ϑ₂(z + iy)/ϑ₄(z)` with z = πu/2K, for fixed y.
//!
//! Their squared magnitudes are linear in sn²u, and their phases are elliptic integrals of the third kind but for a steady
//! part. The zero of either numerator lies at y = 0, so a small y keeps its digits; toward the other end of the strip,
//! `y = πK′/2K`, they become constant in magnitude, and nothing is lost there.
//!
//! Three of them come together, `ϑ₁` once and `ϑ₂` twice, with one denominator. Each may be scaled.

use super::{HalfPeriods, circular, hyperbolic};
use crate::numerics::lane::Lane;
use std::f64::consts::{FRAC_PI_2, PI};

/// The values of the three: real and imaginary parts.
pub type Values<L> = [[L; 2]; 3];

/// By sines and cosines of z, for K ≤ K′ or somewhat above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circular {
    /// 2q, 2q⁴, 2q⁹ of ϑ₄.
    below: [f64; 3],
    /// For each function the coefficients of its real and of its imaginary part.
    above: [[[f64; 4]; 2]; 3],
}

impl Circular {
    /// With the shifts `a = 2Ky/π`, |a| ≤ K′. Where K′ is infinite a may be.
    #[must_use]
    pub fn new(half: HalfPeriods, shifts: [f64; 3]) -> Self {
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
    pub fn scaled(mut self, factors: [f64; 3]) -> Self {
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
    pub fn values<L: Lane>(&self, z: &circular::Argument<L>) -> Values<L> {
        let odd = |of: &[L; 9]| [of[1], of[3], of[5], of[7]];
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

/// By hyperbolic functions of πu/2K′, for K ≥ K′ and K = ∞.
///
/// A [value](Self::values) has to be turned by a phase that grows with u: [`Hyperbolic::slopes`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hyperbolic {
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
    pub fn new(half: HalfPeriods, shifts: [f64; 3]) -> Self {
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
    pub fn scaled(mut self, factors: [f64; 3]) -> Self {
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
    pub fn slopes(&self) -> [f64; 3] {
        self.slopes
    }

    /// The three at u but for those phases.
    #[inline(always)]
    #[must_use]
    pub fn values<L: Lane>(&self, u: &hyperbolic::Argument<L>) -> Values<L> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::elliptic::complete_first;
    use crate::numerics::lane::Double;
    use crate::numerics::turns::{sin_cos_turns, whole_off};

    type One = Double<true>;
    /// k′, u/K, a/K′, and the values at u of the two quotients over those at K of the first and at 0 of the second.
    type Case = (f64, f64, f64, [f64; 2], [f64; 2]);

    /// By mpmath 1.3 with 40 digits: `jtheta`.
    const CASES: [Case; 18] = [
        (
            0.9,
            0.125,
            0.062_5,
            [0.205_073_795_300_603_18, 0.138_670_794_848_677_6],
            [0.978_742_498_006_160_1, -0.026_219_405_674_640_008],
        ),
        (
            0.9,
            0.125,
            -0.5,
            [0.204_150_345_598_892_53, -0.817_020_650_389_589_6],
            [0.978_568_238_385_575_4, 0.155_148_111_285_299_57],
        ),
        (
            0.9,
            0.125,
            1.0,
            [0.195_090_322_016_128_28, 0.980_785_280_403_230_4],
            [0.976_858_552_146_989_8, -0.194_309_247_202_622_85],
        ),
        (
            0.9,
            -0.75,
            0.062_5,
            [-0.930_773_775_542_189_5, 0.051_915_365_229_759_064],
            [0.365_561_970_487_640_44, 0.118_724_027_345_557_02],
        ),
        (
            0.9,
            -0.75,
            -0.5,
            [-0.930_136_077_160_308_4, -0.307_043_792_833_833_8],
            [0.364_101_435_754_796_2, -0.699_854_071_017_115_9],
        ),
        (
            0.9,
            -0.75,
            1.0,
            [-0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
            [0.349_772_023_057_481_34, 0.844_424_361_804_046_3],
        ),
        (
            0.3,
            0.125,
            0.062_5,
            [0.317_242_265_693_450_54, 0.096_427_136_504_871_64],
            [0.948_169_800_133_292_9, -0.013_155_308_951_979_25],
        ),
        (
            0.3,
            0.125,
            -0.5,
            [0.291_057_068_624_460_7, -0.690_166_230_914_396_4],
            [0.945_297_263_373_097_2, 0.100_836_080_530_593_55],
        ),
        (
            0.3,
            0.125,
            1.0,
            [0.195_090_322_016_128_28, 0.980_785_280_403_230_4],
            [0.934_677_545_757_887_9, -0.185_918_923_363_310_1],
        ),
        (
            0.3,
            -0.75,
            0.062_5,
            [-0.977_831_759_371_110_4, 0.027_839_678_595_301_866],
            [0.208_358_305_778_658_74, 0.031_000_271_462_230_337],
        ),
        (
            0.3,
            -0.75,
            -0.5,
            [-0.966_336_034_638_253_2, -0.212_022_522_860_485_62],
            [0.193_237_105_514_954_2, -0.224_107_279_440_513_8],
        ),
        (
            0.3,
            -0.75,
            1.0,
            [-0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
            [0.137_761_864_576_256_08, 0.332_586_561_837_803_05],
        ),
        (
            0.01,
            0.125,
            0.062_5,
            [0.632_625_735_819_260_5, 0.090_263_073_016_719_07],
            [0.772_843_519_163_984, -0.009_488_697_461_376_788],
        ),
        (
            0.01,
            0.125,
            -0.5,
            [0.515_821_002_337_435_4, -0.659_733_115_964_829_6],
            [0.769_190_732_697_543_5, 0.075_779_298_342_799_42],
        ),
        (
            0.01,
            0.125,
            1.0,
            [0.195_090_322_016_128_28, 0.980_785_280_403_230_4],
            [0.758_075_975_554_503_2, -0.150_790_686_951_189_97],
        ),
        (
            0.01,
            -0.75,
            0.062_5,
            [-0.999_474_848_892_065_7, 0.024_560_061_490_321_562],
            [0.021_188_454_679_641_713, 0.001_781_646_637_332_627],
        ),
        (
            0.01,
            -0.75,
            -0.5,
            [-0.980_650_321_933_224_1, -0.195_190_597_798_459_88],
            [0.017_969_156_715_301_637, -0.013_351_128_213_666_29],
        ),
        (
            0.01,
            -0.75,
            1.0,
            [-0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
            [0.008_983_850_452_887_463, 0.021_688_933_605_692_587],
        ),
    ];

    fn over([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
        let square = c * c + d * d;
        [(a * c + b * d) / square, (b * c - a * d) / square]
    }

    fn check(found: [f64; 2], exact: [f64; 2], what: &str) {
        let error = (found[0] - exact[0]).hypot(found[1] - exact[1]);
        assert!(error < 2e-15, "{what}: {found:?} {exact:?}");
    }

    fn plain(value: [One; 2]) -> [f64; 2] {
        [value[0].get(), value[1].get()]
    }

    #[test]
    fn quotients_of_either_kind() {
        for (k_prime, x, y, first, second) in CASES {
            let half = HalfPeriods {
                real: complete_first(k_prime),
                imaginary: complete_first(((1.0 - k_prime) * (1.0 + k_prime)).sqrt()),
            };
            let shifts = [y * half.imaginary; 3];
            let what = format!("{k_prime} {x} {y}");
            if half.imaginary > 0.7 * half.real {
                let quotients = Circular::new(half, shifts);
                let at = |x: f64| {
                    let (s, c) = sin_cos_turns(One::new(0.25 * x));
                    quotients.values(&circular::Argument::new(s, c)).map(plain)
                };
                let values = at(x);
                check(over(values[0], at(1.0)[0]), first, &what);
                check(over(values[1], at(0.0)[1]), second, &what);
                assert_eq!(values[1], values[2]);
            }
            if half.real > 0.99 * half.imaginary {
                let quotients = Hyperbolic::new(half, shifts);
                let end = FRAC_PI_2 * half.real / half.imaginary;
                let at = |x: f64| {
                    let argument = hyperbolic::Argument::new(One::new(end * x), One::new(end));
                    let values = quotients.values(&argument).map(plain);
                    let sign = 1.0_f64.copysign(x);
                    let [one, two, _] = quotients.slopes();
                    let phases = [one * 0.5 * x, two * 0.5 * (x - sign)];
                    [0, 1].map(|k| {
                        let (s, c) = sin_cos_turns(whole_off(One::new(phases[k])));
                        over(values[k], [c.get(), -s.get()])
                    })
                };
                let values = at(x);
                check(over(values[0], at(1.0)[0]), first, &what);
                check(over(values[1], at(0.0)[1]), second, &what);
            }
        }
    }

    #[test]
    fn ends_of_the_strip() {
        // Without modulus and at an infinite shift the quotients turn at a constant size; without complement they are a hyperbola.
        let flat = HalfPeriods {
            real: FRAC_PI_2,
            imaginary: f64::INFINITY,
        };
        let (s, c) = sin_cos_turns(One::new(0.1));
        let z = circular::Argument::new(s, c);
        let values = Circular::new(flat, [f64::INFINITY; 3])
            .values(&z)
            .map(plain);
        assert_eq!(values[0], [s.get(), c.get()]);
        assert_eq!(values[1], [c.get(), -s.get()]);
        let endless = HalfPeriods {
            real: f64::INFINITY,
            imaginary: FRAC_PI_2,
        };
        let argument = hyperbolic::Argument {
            from_middle: One::new((-0.7_f64).exp()),
            from_end: One::new(0.0),
            sign: One::new(1.0),
        };
        let values = Hyperbolic::new(endless, [0.0; 3])
            .values(&argument)
            .map(plain);
        assert!((values[0][0] - 0.7_f64.tanh()).abs() < 2e-16);
        assert!((values[1][0] - 0.5 / 0.7_f64.cosh()).abs() < 2e-16);
    }
}
