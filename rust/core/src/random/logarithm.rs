//! The natural logarithm by sums, products and one quotient: the same bits on every machine, which a library's need not have.

/// ln 2 in two parts, the first short enough that its multiples are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
/// (ln(1 + f) − 2s)/s in powers of s², with s = f/(2 + f): the minimax polynomial of FreeBSD's `msun`.
const TAIL: [f64; 7] = [
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
    let tail = z * TAIL.iter().rev().fold(0.0, |sum, c| sum * z + c);
    let half = 0.5 * f * f;
    k * LN_2[0] - ((half - (s * (half + tail) + k * LN_2[1])) - f)
}

#[cfg(test)]
mod tests {
    use super::*;

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
