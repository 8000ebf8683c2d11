//! Powers of two as units: what is scaled by them keeps its digits.

/// The exponent e of `|x| = 2^e·(1…2)`; zero for zero.
#[must_use]
pub fn exponent(x: f64) -> i32 {
    if x == 0.0 {
        return 0;
    }
    let (x, shift) = if x.abs() < f64::MIN_POSITIVE {
        (x * 2.0_f64.powi(64), 64)
    } else {
        (x, 0)
    };
    let field = (x.to_bits() >> 52) & 0x7ff;
    i32::try_from(field).map_or(0, |field| field - 1023 - shift)
}

/// `x·2^e`, rounded only where it is a denormal number.
#[must_use]
pub fn times_power_of_two(x: f64, e: i32) -> f64 {
    let (mut x, mut rest) = (x, e);
    // Upward or downward in strides that are themselves numbers.
    while rest != 0 && x != 0.0 && x.is_finite() {
        let stride = rest.clamp(-1000, 1000);
        x *= 2.0_f64.powi(stride);
        rest -= stride;
    }
    x
}

/// `2^e` as two factors that are numbers, for many products: `x·a·b`, rounded only where it is a denormal number.
#[must_use]
pub fn halves(e: i32) -> [f64; 2] {
    let half = e / 2;
    [2.0_f64.powi(half), 2.0_f64.powi(e - half)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_and_scales_undo_each_other() {
        for x in [1.0, -1.5, 5e-324, 3e-310, 1e-150, 1.7e308] {
            let e = exponent(x);
            let mantissa = times_power_of_two(x, -e);
            assert!((1.0..2.0).contains(&mantissa.abs()), "{x:e}");
            assert_eq!(times_power_of_two(mantissa, e), x);
        }
        assert_eq!((exponent(0.0), times_power_of_two(0.0, 99)), (0, 0.0));
        assert_eq!(times_power_of_two(1.0, -5000), 0.0);
        assert!(times_power_of_two(1.0, 5000).is_infinite());
        for (x, e) in [
            (3e-310, 1074),
            (1.5, -1023),
            (1.0, 0),
            (-1e300, -1999),
            (5e-324, 2000),
        ] {
            let [a, b] = halves(e);
            assert_eq!(x * a * b, times_power_of_two(x, e));
        }
    }
}
