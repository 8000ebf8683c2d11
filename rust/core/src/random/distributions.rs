//! Words of 64 random bits as numbers of a law.

/// 2⁻⁵³.
const UNIT: f64 = 1.0 / 9_007_199_254_740_992.0;

/// 2⁻⁶⁵.
const TINY: f64 = 0.5 / 18_446_744_073_709_551_616.0;

/// A number between 0 and 1, neither of which it is: an odd multiple of 2⁻⁵³, all of them as likely.
///
/// # Examples
///
/// ```
/// use polhode::random::distributions::uniform;
///
/// assert_eq!(uniform(1 << 63), 0.5 + 2.0_f64.powi(-53));
/// ```
#[must_use]
#[inline]
pub fn uniform(word: u64) -> f64 {
    (word >> 11 | 1) as f64 * UNIT
}

/// A standard normal number, to a few units in the last place: the first bit is its sign, the others are how much of a half of the
/// law lies beyond it. It reaches to 9.1.
///
/// # Examples
///
/// ```
/// use polhode::random::distributions::normal;
///
/// let word = 0x1234_5678_9abc_def0;
/// assert_eq!(normal(word), -normal(word | 1 << 63)); // the first bit is the sign
/// assert!(normal(u64::MAX >> 1) < 1e-15); // all of a half lies beyond: the middle
/// ```
#[must_use]
#[inline]
pub fn normal(word: u64) -> f64 {
    // The middle of one of 2⁶³ equal parts of the half, in units of 2⁻⁶⁵, and how far that is from the centre: each rounded once.
    let place = word << 1 | 1;
    let (beyond, within) = (place as f64 * TINY, place.wrapping_neg() as f64 * TINY);
    let size = quantile(beyond, within);
    if word >> 63 == 1 { -size } else { size }
}

/// A rotation drawn uniformly, as a unit quaternion (x, y, z, w): the direction of four normal numbers.
#[must_use]
pub fn rotation(words: [u64; 4]) -> [f64; 4] {
    let [a, b, c, d] = words;
    let (x, y, z, w) = (normal(a), normal(b), normal(c), normal(d));
    // No word makes a zero.
    let length = ((x * x + y * y) + (z * z + w * w)).sqrt();
    [x / length, y / length, z / length, w / length]
}

/// The x ≥ 0 with the probability `beyond` above it and `within` between 0 and it, which add up to ½.
///
/// Source: M. J. Wichura, Algorithm AS 241: the percentage points of the normal distribution, Applied Statistics 37 (1988) 477,
/// `PPND16`: about 1 part in 10¹⁶ but for rounding.
#[inline]
fn quantile(beyond: f64, within: f64) -> f64 {
    if within <= 0.425 {
        return within * ratio(0.180_625 - within * within, &CENTRE);
    }
    let r = (-ln(beyond)).sqrt();
    if r <= 5.0 {
        ratio(r - 1.6, &SIDE)
    } else {
        ratio(r - 5.0, &TAIL)
    }
}

#[inline]
fn ratio(r: f64, [above, below]: &[[f64; 8]; 2]) -> f64 {
    let horner = |powers: &[f64; 8]| powers.iter().rev().fold(0.0, |sum, c| sum * r + c);
    horner(above) / horner(below)
}

#[expect(clippy::excessive_precision, reason = "as the source prints them")]
const CENTRE: [[f64; 8]; 2] = [
    [
        3.387_132_872_796_366_608,
        1.331_416_678_917_843_774_5e2,
        1.971_590_950_306_551_442_7e3,
        1.373_169_376_550_946_112_5e4,
        4.592_195_393_154_987_145_7e4,
        6.726_577_092_700_870_085_3e4,
        3.343_057_558_358_812_810_5e4,
        2.509_080_928_730_122_672_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091_125_2e1,
        6.871_870_074_920_579_082_2e2,
        5.394_196_021_424_751_107_7e3,
        2.121_379_430_158_659_586_7e4,
        3.930_789_580_009_271_061e4,
        2.872_908_573_572_194_267_4e4,
        5.226_495_278_852_854_561e3,
    ],
];

#[expect(clippy::excessive_precision, reason = "as the source prints them")]
const SIDE: [[f64; 8]; 2] = [
    [
        1.423_437_110_749_683_577_34,
        4.630_337_846_156_545_295_9,
        5.769_497_221_460_691_405_5,
        3.647_848_324_763_204_605_04,
        1.270_458_252_452_368_382_58,
        2.417_807_251_774_506_117_7e-1,
        2.272_384_498_926_918_458_33e-2,
        7.745_450_142_783_414_076_4e-4,
    ],
    [
        1.0,
        2.053_191_626_637_758_821_87,
        1.676_384_830_183_803_849_4,
        6.897_673_349_851_000_045_5e-1,
        1.481_039_764_274_800_745_9e-1,
        1.519_866_656_361_645_719_66e-2,
        5.475_938_084_995_344_946e-4,
        1.050_750_071_644_416_843_24e-9,
    ],
];

#[expect(clippy::excessive_precision, reason = "as the source prints them")]
const TAIL: [[f64; 8]; 2] = [
    [
        6.657_904_643_501_103_777_2,
        5.463_784_911_164_114_369_9,
        1.784_826_539_917_291_335_8,
        2.965_605_718_285_048_912_3e-1,
        2.653_218_952_657_612_309_3e-2,
        1.242_660_947_388_078_438_6e-3,
        2.711_555_568_743_487_578_15e-5,
        2.010_334_399_292_288_132_65e-7,
    ],
    [
        1.0,
        5.998_322_065_558_879_376_9e-1,
        1.369_298_809_227_358_053_1e-1,
        1.487_536_129_085_061_485_25e-2,
        7.868_691_311_456_132_591e-4,
        1.846_318_317_510_054_681_8e-5,
        1.421_511_758_316_445_888_7e-7,
        2.044_263_103_389_939_785_64e-15,
    ],
];

// The natural logarithm by sums, products and one quotient: the same bits on every machine, which a library's need not have.

/// ln 2 in two parts, the first short enough that its multiples are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// (ln(1 + f) − 2s)/s in powers of s², with s = f/(2 + f): the minimax polynomial of FreeBSD's `msun`.
const LOGARITHM_TAIL: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

const FRACTION: u64 = (1 << 52) - 1;

/// The fraction of √2.
const FRACTION_OF_ROOT: u64 = 0x6_A09E_667F_3BCD;

const BIAS: u64 = 1023;

/// ln x of a normal x, to less than a unit in the last place.
#[inline]
pub(super) fn ln(x: f64) -> f64 {
    let (fraction, exponent) = (x.to_bits() & FRACTION, x.to_bits() >> 52);
    // x = 2^k (1 + f) with 1 + f between √½ and √2.
    let shift = u64::from(fraction > FRACTION_OF_ROOT);
    let k = (exponent + shift) as f64 - BIAS as f64;
    let f = f64::from_bits(fraction | (BIAS - shift) << 52) - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let tail = z * LOGARITHM_TAIL.iter().rev().fold(0.0, |sum, c| sum * z + c);
    let half = 0.5 * f * f;
    k * LN_2[0] - ((half - (s * (half + tail) + k * LN_2[1])) - f)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_numbers_reach_neither_end() {
        assert_eq!(uniform(0), UNIT);
        assert_eq!(uniform(u64::MAX), 1.0 - UNIT);
        assert_eq!(uniform(1 << 63) - 0.5, UNIT);
    }

    #[test]
    fn normal_numbers_are_symmetric_and_reach_to_nine() {
        for word in [0, 1, 77, 1 << 40, 1 << 62, (1 << 63) - 1] {
            let one = normal(word);
            assert_eq!(normal(word | 1 << 63), -one);
            assert!(one > 0.0);
        }
        assert!(normal(0) > 9.0 && normal(0) < 9.2);
        assert!(normal((1 << 63) - 1) < 1e-18);
    }

    /// (word, normal) by mpmath 1.3 with 60 digits.
    const KNOWN: [(u64, f64); 18] = [
        (0x0, 9.155_293_772_686_072),
        (0x1, 9.035_918_848_571_939),
        (0x5, 8.892_719_663_165_623),
        (0x10_0000, 7.423_939_748_863_402),
        (0x1000_0000_0000, 4.763_001_034_267_808),
        (0x80_0000_0000_0000, 2.885_634_912_426_757_3),
        (0x1_2345_6789, 6.210_007_992_827_728_5),
        (0x123_4567_89ab_cdef, 2.616_298_203_643_961),
        (0x1000_0000_0000_0000, 1.534_120_544_352_546_3),
        (0x2fff_ffff_ffff_ffff, 0.887_146_559_018_876_1),
        (0x3333_3333_3333_3333, 0.841_621_233_572_914_2),
        (0x4666_6666_6666_6666, 0.597_760_126_042_478_4),
        (0x5a5a_5a5a_5a5a_5a5a, 0.377_391_943_828_553_84),
        (0x7fff_ffff_fff0_0000, 1.424_852_530_008_989_4e-13),
        (0x7fff_ffff_ffff_ffff, 6.794_229_552_421_306e-20),
        (0x9e37_79b9_7f4a_7c15, -1.184_872_207_599_307_4),
        (0xfedc_ba98_7654_3210, -0.011_140_800_566_449_761),
        (0x8000_0000_0000_0123, -8.440_477_113_693_541),
    ];

    #[test]
    fn normal_numbers_are_exact_to_a_few_units() {
        for (word, exact) in KNOWN {
            assert!((normal(word) / exact - 1.0).abs() < 9e-16, "{word:#x}");
        }
    }

    #[test]
    fn it_is_that_of_the_library_to_a_unit_in_the_last_place() {
        let mut x = 1e-300;
        while x < 1e300 {
            let (found, known) = (ln(x), x.ln());
            assert!((found - known).abs() <= 2.3e-16 * known.abs(), "{x:e}");
            x *= 1.003_7;
        }
        for step in -50_000..50_000 {
            let x = 1.0 + f64::from(step) * 9e-6;
            assert!((ln(x) - x.ln()).abs() <= 2.3e-16 * x.ln().abs(), "{x}");
        }
        assert_eq!(ln(1.0), 0.0);
    }
}
