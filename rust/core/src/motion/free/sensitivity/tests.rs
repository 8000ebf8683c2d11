use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::mass::refined::RefinedPrincipal;
use crate::motion::free::FreeMotion;

/// (moments, ω, t, ∂ω(t)/∂(ω, I) by rows): differences of Taylor series with mpmath 1.3 and 40 digits.
type Case = ([f64; 3], [f64; 3], f64, [[f64; 6]; 3]);
const CASES: [Case; 4] = [
    (
        [1.0, 2.0, 2.5],
        [0.3, 0.2, 1.1],
        7.0,
        [
            [
                -0.228_681_982_296_877_03,
                0.851_535_405_086_973_2,
                1.335_547_893_941_386_5,
                -1.217_549_654_752_585_5,
                -1.974_634_793_391_428_1,
                2.066_727_696_614_176_8,
            ],
            [
                -1.315_942_222_747_908_5,
                -0.042_996_549_655_228_165,
                0.759_242_820_166_371_1,
                -0.737_833_789_557_150_6,
                -1.328_077_924_480_664,
                1.357_595_855_407_391_5,
            ],
            [
                -0.247_845_076_673_341_02,
                0.091_173_244_754_125_42,
                1.166_730_670_378_610_2,
                -0.130_362_110_617_961_16,
                -0.288_838_801_479_120_1,
                0.283_215_885_430_480_54,
            ],
        ],
    ),
    (
        [1.0, 2.0, 2.5],
        [1.3, 0.2, -0.1],
        23.0,
        [
            [
                1.088_973_047_207_79,
                0.081_897_169_097_767_45,
                -0.024_456_801_709_917_354,
                -0.107_154_963_008_401_01,
                0.015_374_421_590_389_908,
                0.030_562_447_931_048_477,
            ],
            [
                2.954_021_160_617_068,
                -0.613_908_766_484_55,
                -0.752_678_578_580_173_5,
                -3.203_939_874_637_27,
                0.895_458_520_334_476_1,
                0.565_209_133_587_327,
            ],
            [
                0.588_688_647_697_036_3,
                0.502_285_733_022_651_6,
                -0.735_585_252_831_631_7,
                -0.657_194_988_967_659_5,
                0.262_607_526_162_261_96,
                0.052_791_974_657_254_194,
            ],
        ],
    ),
    (
        [2.0, 2.0, 2.5],
        [0.3, 0.4, 1.0],
        9.0,
        [
            [
                -0.628_173_622_722_739_1,
                -0.778_073_196_887_921_2,
                0.040_156_852_551_118_394,
                -0.283_949_403_087_418,
                0.183_557_271_709_622_02,
                0.080_313_705_102_236_79,
            ],
            [
                0.778_073_196_887_921_2,
                -0.628_173_622_722_739_1,
                -1.124_283_072_536_978_1,
                1.239_565_066_852_189_4,
                1.571_142_614_490_255_6,
                -2.248_566_145_073_956_2,
            ],
            [
                0.0,
                0.0,
                1.0,
                -0.127_745_173_679_911_17,
                0.127_745_173_679_911_17,
                0.0,
            ],
        ],
    ),
    (
        [1.0, 2.0, 2.5],
        [1e-3, 1.0, 1.1e-3],
        12.0,
        [
            [
                106.992_667_136_342_6,
                -0.132_004_945_651_368_08,
                -119.616_439_678_465_54,
                0.131_995_823_852_051_8,
                0.263_372_334_834_947_04,
                -0.263_496_197_408_778_4,
            ],
            [
                3.950_735_698_400_043,
                0.995_580_823_883_337_1,
                -4.415_194_470_847_644,
                0.004_721_069_529_293_087,
                0.009_041_620_161_856_912,
                -0.009_121_723_941_202_765,
            ],
            [
                -95.692_991_119_081_13,
                0.118_018_834_437_922_41,
                106.992_887_860_950_74,
                -0.118_010_679_106_181_1,
                -0.202_536_670_899_970_93,
                0.209_233_608_362_449_2,
            ],
        ],
    ),
];

fn motion(moments: [f64; 3], omega: Vector3<f64>) -> FreeMotion {
    let principal = RefinedPrincipal::from_principal(&moments, &Matrix3::identity());
    FreeMotion::refined(&principal, &omega, &UnitQuaternion::identity()).expect("finite")
}

#[test]
fn against_differences_in_many_digits() {
    for (moments, omega, t, exact) in CASES {
        let found = motion(moments, omega.into()).sensitivity(t);
        let size = (exact.as_flattened().iter()).fold(0.0, |a: f64, b| a.max(b.abs()));
        for (i, row) in exact.iter().enumerate() {
            for (j, want) in row.iter().enumerate() {
                let got = if j < 3 {
                    found.state[(3 + i, 3 + j)]
                } else {
                    found.moments[(3 + i, j - 3)]
                };
                let error = (got - want).abs();
                assert!(error < 4e-15 * size, "{omega:?} {i} {j}: {got} {want}");
            }
        }
    }
}

#[test]
fn scales() {
    let (moments, omega, t, _) = CASES[0];
    let plain = motion(moments, omega.into()).sensitivity(t);
    // Powers of two change no digit.
    let (heavy, fast) = (2.0_f64.powi(400), 2.0_f64.powi(-390));
    let scaled = motion(moments.map(|i| i * heavy), Vector3::from(omega) * fast);
    let scaled = scaled.sensitivity(t / fast);
    assert_eq!(scaled.state[(0, 4)] * fast, plain.state[(0, 4)]);
    assert_eq!(scaled.state[(4, 3)], plain.state[(4, 3)]);
    assert_eq!(scaled.moments[(1, 2)] * heavy, plain.moments[(1, 2)]);
    assert_eq!(scaled.moments[(4, 2)] * heavy / fast, plain.moments[(4, 2)]);
}

#[test]
fn two_spans_make_one() {
    // The derivatives of the later by the earlier, times those of the earlier by the start.
    for (moments, omega, t, _) in CASES {
        let first = motion(moments, omega.into());
        let middle = first.at(t);
        let principal = RefinedPrincipal::from_principal(&moments, &Matrix3::identity());
        let second = FreeMotion::refined(&principal, &middle.omega, &middle.attitude);
        let second = second.expect("finite").sensitivity(1e3);
        let (whole, early) = (first.sensitivity(t + 1e3), first.sensitivity(t));
        let size = second.state.norm() * early.state.norm();
        assert!((second.state * early.state - whole.state).norm() < 1e-13 * size);
        let moments = second.state * early.moments + second.moments;
        assert!((moments - whole.moments).norm() < 1e-12 * size);
    }
}

#[test]
fn where_moments_have_no_derivative() {
    let rod = motion([0.0, 1.0, 1.0], Vector3::new(0.5, 0.3, 0.4)).sensitivity(2.0);
    assert!(rod.state.iter().all(|x| x.is_finite()));
    assert!(rod.moments.iter().all(|x| x.is_nan()));
    let rest = motion([1.0, 2.0, 2.5], Vector3::zeros()).sensitivity(3.0);
    assert_eq!(rest.state[(0, 3)], 3.0);
    assert_eq!(rest.moments[(0, 0)], 0.0);
}
