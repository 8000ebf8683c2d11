//! Angles counted in turns, so that any number of whole turns is taken off without rounding.
//!
//! A phase that grows steadily is its rate times the time. With the rate to twice the precision and the whole turns taken
//! off each part of the product, what remains is as good after 10¹² turns as after one.

use super::double_double::{DoubleDouble, two_sum};
use super::lane::Lane;

/// `start + rate·t` less the nearest whole number, within [−½, ½]; a NaN for a product that is not finite.
///
/// Within 2⁻¹⁰³ |rate·t| of the exact remainder, and one rounding of it.
#[inline(always)]
#[must_use]
pub(crate) fn turns<L: Lane>(t: L, rate: DoubleDouble, start: DoubleDouble) -> L {
    let (p, e) = t.two_product(L::new(rate.high));
    let e = t.mul_add(L::new(rate.low), e);
    // Past 2⁵³ the rest of the product has whole turns of its own.
    let (p, e) = (whole_off(p), whole_off(e));
    let (x, rest) = two_sum(p, L::new(start.high));
    let x = whole_off(x) + (rest + (e + L::new(start.low)));
    whole_off(x)
}

/// A rate that is worth long times is known to this part of itself, 2⁻⁹⁰: so are the turns that it makes.
pub(crate) const PHASE_ERROR: f64 = 8.1e-28;
/// After more turns than this, 2⁸⁸, a phase is not known to a quarter of one.
pub(crate) const MOST_TURNS: f64 = 3.1e26;

/// The largest |t| at which phases of these rates, in turns for a unit of time, are known to a quarter of a turn.
#[must_use]
pub(crate) fn reach(rates: &[DoubleDouble]) -> f64 {
    let fastest = rates
        .iter()
        .fold(0.0_f64, |most, rate| most.max(rate.high.abs()));
    MOST_TURNS / fastest
}

/// x less the nearest integer.
#[inline(always)]
#[must_use]
pub(crate) fn whole_off<L: Lane>(x: L) -> L {
    x - x.round()
}

/// Sine and cosine of x turns, |x| ≤ ½.
#[inline(always)]
#[must_use]
pub(crate) fn sin_cos_turns<L: Lane>(x: L) -> (L, L) {
    // The nearest quarter turn, and what is left of the angle in radians.
    let quarter = (x * L::new(4.0)).round();
    let r = (x - quarter * L::new(0.25)) * L::new(std::f64::consts::TAU);
    let (s, c) = sin_cos_octant(r);
    let (zero, one) = (L::new(0.0), L::new(1.0));
    let distance = quarter.abs();
    let is_odd = distance == one;
    let sine = if is_odd { c } else { s };
    let cosine = if is_odd { s } else { c };
    let below = quarter == -one || distance > one;
    let behind = quarter == one || distance > one;
    (
        if below { zero - sine } else { sine },
        if behind { zero - cosine } else { cosine },
    )
}

/// Sine and cosine of r radians, |r| ≤ π/4, each to about a unit in the last place.
#[inline(always)]
fn sin_cos_octant<L: Lane>(r: L) -> (L, L) {
    let z = r * r;
    let s = horner(z, &SINE);
    let c = horner(z, &COSINE);
    let half = z * L::new(0.5);
    let head = L::new(1.0) - half;
    // What rounding took from the head is given back.
    let tail = (L::new(1.0) - head) - half;
    ((r * z).mul_add(s, r), head + (z * z).mul_add(c, tail))
}

/// (sin r − r)/r³ in powers of r²: the minimax polynomial of FreeBSD's `msun`.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// (cos r − 1 + r²/2)/r⁴ in powers of r²: the same source.
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// `e^{−x}` for x ≥ 0, to about a unit in the last place; past 700 the value at 700.
#[inline(always)]
#[must_use]
pub(crate) fn exp_minus<L: Lane>(x: L) -> L {
    let (n, r) = halvings(x);
    horner(-r, &EXPONENTIAL) * (-n).power_of_two()
}

/// `e^{−x}` for x ≥ 0, and what one has more, to about a unit in the last place of either; past 700 those at 700.
#[inline(always)]
#[must_use]
pub(crate) fn exp_minus_and_rest<L: Lane>(x: L) -> (L, L) {
    let (n, r) = halvings(x);
    let power = (-n).power_of_two();
    // e^{−r} − 1.
    let small = -r * horner(-r, &ITS_SLOPES);
    (
        power * (L::new(1.0) + small),
        power.mul_add(-small, L::new(1.0) - power),
    )
}

/// `x = n ln 2 + r` for x ≥ 0 and up to 700, n whole and |r| ≤ ½ ln 2.
#[inline(always)]
fn halvings<L: Lane>(x: L) -> (L, L) {
    let x = L::new(700.0).min(x); // in this order NaN stays NaN
    let n = (x * L::new(std::f64::consts::LOG2_E)).round();
    // ln 2 in two parts, the first short enough that its multiples are exact.
    let r = n.mul_add(
        L::new(-1.908_214_929_270_587_7e-10),
        n.mul_add(L::new(-6.931_471_803_691_238e-1), x),
    );
    (n, r)
}

/// 1/n!: for |r| ≤ ½ ln 2 the next term is below 5e-18.
const EXPONENTIAL: [f64; 14] = [
    1.0,
    1.0,
    0.5,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// 1/(n + 1)!: of `(e^r − 1)/r`.
const ITS_SLOPES: [f64; 13] = {
    let mut slopes = [0.0; 13];
    let mut n = 0;
    while n < 13 {
        slopes[n] = EXPONENTIAL[n + 1];
        n += 1;
    }
    slopes
};

/// A polynomial, lowest coefficient first.
#[inline(always)]
fn horner<L: Lane, const N: usize>(x: L, coefficients: &[f64; N]) -> L {
    let mut value = L::new(coefficients[N - 1]);
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        value = value.mul_add(x, L::new(coefficients[k]));
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::lane::{AVX2, Double};

    type One = Double<AVX2>;

    #[test]
    fn whole_turns_leave_no_trace() {
        // A third of a turn and its multiples: (3 n + 1)/3 leaves one third, for n up to where times are integers.
        let third = DoubleDouble::from(1.0) / 3.0.into();
        for n in [0.0, 1.0, 1e6, 1e12, 2.0_f64.powi(50), 2.0_f64.powi(51)] {
            let t = 3.0 * n + 1.0;
            let x = turns(One::new(t), third, 0.0.into()).get();
            assert!((x - 1.0 / 3.0).abs() <= 6e-17, "{n:e} {x}");
        }
        // 10²⁰ turns: 7·10²⁰/3 = …333 and 1/3.
        let x = turns(One::new(7e20), third, DoubleDouble::from(0.25)).get();
        assert!((x.abs() - 0.416_666_666_666_666_7).abs() < 1e-11, "{x}");
        assert!(turns(One::new(f64::INFINITY), third, third).get().is_nan());
    }

    #[test]
    fn sines_of_turns() {
        for k in -4096..=4096 {
            let x = f64::from(k) / 8192.0 + 1e-9;
            let (s, c) = sin_cos_turns(One::new(x));
            let (s, c) = (s.get(), c.get());
            let (s_std, c_std) = (std::f64::consts::TAU * x).sin_cos();
            assert!(
                (s - s_std).abs() < 5e-16 && (c - c_std).abs() < 5e-16,
                "{x}"
            );
            assert!((s * s + c * c - 1.0).abs() < 4e-16);
        }
        let quarters = [
            (0.0, 0.0, 1.0),
            (0.25, 1.0, 0.0),
            (-0.25, -1.0, 0.0),
            (0.5, 0.0, -1.0),
            (-0.5, 0.0, -1.0),
        ];
        for (x, sine, cosine) in quarters {
            let (s, c) = sin_cos_turns(One::new(x));
            assert_eq!((s.get(), c.get()), (sine, cosine));
        }
    }

    #[test]
    fn exponentials() {
        for k in 0..7000 {
            let x = 0.1 * f64::from(k);
            let value = exp_minus(One::new(x)).get();
            assert!((value / (-x).exp() - 1.0).abs() < 5e-16, "{x}");
        }
        assert!(exp_minus(One::new(f64::NAN)).get().is_nan());
        assert!(exp_minus_and_rest(One::new(f64::NAN)).1.get().is_nan());
        for k in 0..7000 {
            let x = 0.97_f64.powi(k) * 690.0;
            let (value, rest) = exp_minus_and_rest(One::new(x));
            assert!((value.get() / (-x).exp() - 1.0).abs() < 5e-16, "{x}");
            assert!((rest.get() / -(-x).exp_m1() - 1.0).abs() < 5e-16, "{x}");
        }
        assert!(exp_minus(One::new(f64::INFINITY)).get() < 1e-300);
    }
}
