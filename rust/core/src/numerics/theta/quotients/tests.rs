//! Against theta functions in many digits, and at the ends of the strip.

use std::f64::consts::FRAC_PI_2;

use super::{Circular, Hyperbolic};
use crate::numerics::elliptic::complete_first;
use crate::numerics::lane::{AVX2, Double, Lane};
use crate::numerics::theta::{HalfPeriods, circular, hyperbolic};
use crate::numerics::turns::{sin_cos_turns, whole_off};

type One = Double<AVX2>;
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
