//! Against theta functions in many digits.

use std::f64::consts::PI;

use super::{HalfPeriods, circular, hyperbolic};
use crate::numerics::elliptic::complete_first;
use crate::numerics::lane::{AVX2, Double, Lane};
use crate::numerics::turns::{sin_cos_turns, whole_off};

type One = Double<AVX2>;

/// (k′, u/K, sn, cn, dn) by mpmath 1.3 with 60 digits: `ellipfun`.
const JACOBI: [(f64, f64, f64, f64, f64); 10] = [
    (
        0.999,
        0.125,
        0.195_184_211_483_877_66,
        0.980_766_599_955_064_2,
        0.999_961_921_447_037_5,
    ),
    (
        0.999,
        -0.75,
        -0.923_947_195_435_734_8,
        0.382_520_038_751_488_4,
        0.999_146_384_089_194_9,
    ),
    (
        0.8,
        0.125,
        0.216_494_009_405_166_2,
        0.976_283_946_345_363_1,
        0.991_527_570_872_844_3,
    ),
    (
        0.8,
        -0.75,
        -0.937_962_370_425_399_5,
        0.346_737_064_165_291_76,
        0.826_608_476_244_798_6,
    ),
    (
        0.25,
        0.125,
        0.336_915_740_122_064_3,
        0.941_534_802_361_549_3,
        0.945_294_820_441_949,
    ),
    (
        0.25,
        -0.75,
        -0.982_246_946_376_846_1,
        0.187_592_474_085_079_9,
        0.309_016_994_374_947_45,
    ),
    (
        0.05,
        0.125,
        0.499_087_879_704_988,
        0.866_551_376_625_517_4,
        0.866_910_612_526_314_8,
    ),
    (
        0.05,
        -0.75,
        -0.997_795_511_609_461,
        0.066_363_521_696_892_68,
        0.083_024_735_588_160_18,
    ),
    (
        1e-09,
        0.125,
        0.992_078_790_243_607_9,
        0.125_617_172_189_073_84,
        0.125_617_172_189_073_84,
    ),
    (
        1e-09,
        -0.75,
        -0.999_999_999_999_992_1,
        1.257_413_547_914_711_3e-07,
        1.257_453_311_451_149_6e-07,
    ),
];

/// (k′, u/K, a/K′, cos, sin) of the phase of Θ(u + ia), by mpmath 1.3 with 60 digits: the sum over `q^{n²}`.
const PHASE: [(f64, f64, f64, f64, f64); 20] = [
    (
        0.999,
        0.125,
        0.25,
        0.999_999_899_646_617_7,
        0.000_448_003_074_206_760_24,
    ),
    (
        0.999,
        0.125,
        0.875,
        0.984_543_226_789_819_1,
        0.175_141_755_678_909_4,
    ),
    (
        0.999,
        -0.75,
        0.25,
        0.999_999_658_706_342_7,
        -0.000_826_188_355_110_099_8,
    ),
    (
        0.999,
        -0.75,
        0.875,
        0.982_968_880_329_318_2,
        -0.183_772_087_935_373_1,
    ),
    (
        0.8,
        0.125,
        0.25,
        0.999_724_807_289_655_5,
        0.023_458_680_475_701_592,
    ),
    (
        0.8,
        0.125,
        0.875,
        0.858_623_264_315_156_9,
        0.512_607_149_751_917,
    ),
    (
        0.8,
        -0.75,
        0.25,
        0.999_277_352_992_925_3,
        -0.038_010_153_846_737_435,
    ),
    (
        0.8,
        -0.75,
        0.875,
        0.954_960_871_738_435_2,
        -0.296_731_753_354_048_5,
    ),
    (
        0.25,
        0.125,
        0.25,
        0.996_182_297_091_169_9,
        0.087_297_370_877_708_21,
    ),
    (
        0.25,
        0.125,
        0.875,
        0.653_482_896_871_757_2,
        0.756_941_281_405_695_5,
    ),
    (
        0.25,
        -0.75,
        0.25,
        0.996_156_605_532_223_4,
        -0.087_590_052_257_766,
    ),
    (
        0.25,
        -0.75,
        0.875,
        0.943_491_321_282_861_5,
        -0.331_397_233_941_262_97,
    ),
    (
        0.05,
        0.125,
        0.25,
        0.988_066_129_641_854_8,
        0.154_030_267_981_865_45,
    ),
    (
        0.05,
        0.125,
        0.875,
        0.523_776_611_768_218_7,
        0.851_855_657_353_171_9,
    ),
    (
        0.05,
        -0.75,
        0.25,
        0.995_279_897_015_425_5,
        -0.097_046_002_478_020_68,
    ),
    (
        0.05,
        -0.75,
        0.875,
        0.941_722_254_264_513,
        -0.336_391_432_445_839_7,
    ),
    (
        1e-09,
        0.125,
        0.25,
        0.942_484_940_105_867,
        0.334_248_616_562_044,
    ),
    (
        1e-09,
        0.125,
        0.875,
        0.361_319_570_772_410_17,
        0.932_442_045_264_391_3,
    ),
    (
        1e-09,
        -0.75,
        0.25,
        0.995_184_726_672_197_2,
        -0.098_017_140_329_557_81,
    ),
    (
        1e-09,
        -0.75,
        0.875,
        0.941_544_065_183_021_3,
        -0.336_889_853_392_218_6,
    ),
];

/// K and K′; K′ of a modulus that rounds to one is π/2 to rounding.
fn half_periods(k_prime: f64) -> HalfPeriods {
    HalfPeriods {
        real: complete_first(k_prime),
        imaginary: complete_first(((1.0 - k_prime) * (1.0 + k_prime)).sqrt()),
    }
}

fn circular_argument(x: f64) -> circular::Argument<One> {
    let (s, c) = sin_cos_turns(One::new(0.25 * x));
    circular::Argument::new(s, c)
}

fn hyperbolic_argument(half: HalfPeriods, x: f64) -> hyperbolic::Argument<One> {
    let end = 0.5 * PI * half.real / half.imaginary;
    hyperbolic::Argument::new(One::new(end * x), One::new(end))
}

#[test]
fn functions_of_jacobi() {
    for (k_prime, x, sn, cn, dn) in JACOBI {
        let half = half_periods(k_prime);
        let check = |values: [One; 3]| {
            for (value, exact) in values.iter().zip([sn, cn, dn]) {
                assert!(
                    (value.get() - exact).abs() < 6e-16,
                    "{k_prime} {x}: {value:?} {exact}"
                );
            }
        };
        if half.imaginary > 0.7 * half.real {
            let q = (-PI * half.imaginary / half.real).exp();
            check(circular::Jacobi::new(q).values(&circular_argument(x)));
        }
        if half.real > 0.99 * half.imaginary {
            let q = (-PI * half.real / half.imaginary).exp();
            check(hyperbolic::Jacobi::new(q).values(&hyperbolic_argument(half, x)));
        }
    }
}

#[test]
fn phases_of_theta() {
    for (k_prime, x, y, cosine, sine) in PHASE {
        let half = half_periods(k_prime);
        let u = x * half.real;
        let (a, d) = (y * half.imaginary, (1.0 - y) * half.imaginary);
        let check = |(re, im): (One, One), turns: f64| {
            let (s, c) = sin_cos_turns(whole_off(One::new(turns)));
            let (re, im) = (re * c - im * s, re * s + im * c);
            let size = re.get().hypot(im.get());
            let error = (re.get() / size - cosine).hypot(im.get() / size - sine);
            assert!(error < 1.5e-15, "{k_prime} {x} {y}: {error:e}");
        };
        if half.imaginary > 0.99 * half.real {
            let z = circular_argument(x);
            check(circular::Shifted::<4>::near_axis(half, a).value(&z), 0.0);
            check(circular::Shifted::<4>::near_zero(half, d).value(&z), 0.0);
        }
        if half.real > 0.99 * half.imaginary {
            let argument = hyperbolic_argument(half, x);
            let (g, y) = (argument.from_middle, argument.from_end);
            let value =
                |shifted: &hyperbolic::Shifted<5>| shifted.value(g * g, y * y, argument.sign);
            let near_axis = hyperbolic::Shifted::near_axis(half, a);
            check(value(&near_axis), near_axis.slope() * u);
            let near_zero = hyperbolic::Shifted::near_zero(half, d);
            check(value(&near_zero), near_zero.slope() * u - 0.25 * x);
        }
    }
}
