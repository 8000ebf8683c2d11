//! Powers of two as units: what is scaled by them keeps its digits.

use nalgebra::Vector3;

/// The exponent e of `|x| = 2^e·(1…2)`; zero for zero.
#[must_use]
#[inline]
pub(crate) fn exponent(x: f64) -> i32 {
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
#[inline]
pub(crate) fn times_power_of_two(x: f64, e: i32) -> f64 {
    let (mut x, mut rest) = (x, e);
    // Upward or downward in strides that are themselves numbers.
    while rest != 0 && x != 0.0 && x.is_finite() {
        let stride = rest.clamp(-1000, 1000);
        x *= f64::from_bits(u64::from((1023 + stride).cast_unsigned()) << 52);
        rest -= stride;
    }
    x
}

/// The power of two at or below a positive number, as a unit, kept where its reciprocal is a normal number; one of what is no
/// positive number.
#[must_use]
#[inline]
pub(crate) fn power_below(x: f64) -> f64 {
    if x > 0.0 && x.is_finite() {
        times_power_of_two(1.0, exponent(x).clamp(-1022, 1022))
    } else {
        1.0
    }
}

/// The length of a vector, whose squares may be beyond float64.
#[must_use]
#[inline]
pub(crate) fn length(vector: &Vector3<f64>) -> f64 {
    let size = exponent(vector.amax());
    let scaled = vector.map(|x| times_power_of_two(x, -size));
    times_power_of_two(scaled.norm(), size)
}

/// The unit vector along another, whose squares may be beyond float64; `None` of zero.
#[must_use]
#[inline]
pub(crate) fn direction_of(vector: &Vector3<f64>) -> Option<Vector3<f64>> {
    let size = exponent(vector.amax());
    vector
        .map(|x| times_power_of_two(x, -size))
        .try_normalize(0.0)
}

/// Products of this size and more have lost nothing to underflow that they would have kept.
const SAFE: std::ops::Range<f64> = 1e-250..1e250;

/// `k a·b`, whose parts may be beyond float64 where the whole is not.
#[must_use]
#[inline]
pub(crate) fn times_dot(k: f64, a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let product = a.dot(b);
    if SAFE.contains(&product.abs()) {
        return k * product;
    }
    let (a, b, (k, power)) = (near_one(a), near_one(b), split(k));
    times_power_of_two(k * a.0.dot(&b.0), a.1 + b.1 + power)
}

/// `k a×b`, whose parts may be beyond float64 where the whole is not.
#[must_use]
#[inline]
pub(crate) fn times_cross(k: f64, a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    let product = a.cross(b);
    if SAFE.contains(&product.amax()) {
        return product * k;
    }
    let (a, b, (k, power)) = (near_one(a), near_one(b), split(k));
    (a.0.cross(&b.0) * k).map(|x| times_power_of_two(x, a.1 + b.1 + power))
}

/// A vector as one near one times a power of two.
#[inline]
fn near_one(vector: &Vector3<f64>) -> (Vector3<f64>, i32) {
    let power = exponent(vector.amax());
    (vector.map(|x| times_power_of_two(x, -power)), power)
}

/// A number as one near one times a power of two.
#[inline]
fn split(x: f64) -> (f64, i32) {
    let power = exponent(x);
    (times_power_of_two(x, -power), power)
}

/// `2^e` as two factors that are numbers, for many products: `x·a·b`, rounded only where it is a denormal number.
#[must_use]
#[inline]
pub(crate) fn halves(e: i32) -> [f64; 2] {
    let half = e / 2;
    [2.0_f64.powi(half), 2.0_f64.powi(e - half)]
}

/// `√(a/b)`, where a/b may be beyond all numbers too.
#[must_use]
#[inline]
pub(crate) fn root_of_ratio(a: f64, b: f64) -> f64 {
    let ratio = a / b;
    if ratio.is_normal() || a == 0.0 {
        ratio.sqrt()
    } else {
        a.sqrt() / b.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_of_any_size_have_lengths_and_directions() {
        for size in [1e-300, 1e-200, 1.0, 1e200, 1e307] {
            let unit = 2.0_f64.powi(exponent(size));
            let vector = Vector3::new(2.0, -3.0, 6.0) * unit;
            assert_eq!(length(&vector), 7.0 * unit);
            let direction = direction_of(&vector).expect("a direction");
            assert!((direction.y + 3.0 / 7.0).abs() < 1e-15);
        }
        assert_eq!(length(&Vector3::zeros()), 0.0);
        assert_eq!(direction_of(&Vector3::zeros()), None);
    }

    #[test]
    fn products_of_any_size() {
        let (a, b) = (Vector3::new(2.0, -3.0, 6.0), Vector3::new(1.0, 4.0, 0.5));
        let (dot, cross) = (3.0 * a.dot(&b), a.cross(&b) * 3.0);
        for (k, e, f) in [
            (0, 0, 0),
            (70, -531, -531),
            (-70, 531, 531),
            (900, -900, -900),
            (-700, 900, -900),
        ] {
            let told = k + e + f;
            let k = times_power_of_two(3.0, k);
            let a = a.map(|x| times_power_of_two(x, e));
            let b = b.map(|x| times_power_of_two(x, f));
            assert_eq!(times_dot(k, &a, &b), times_power_of_two(dot, told));
            let expected = cross.map(|x| times_power_of_two(x, told));
            assert_eq!(times_cross(k, &a, &b), expected);
        }
        let nothing = Vector3::zeros();
        assert_eq!(times_dot(3.0, &a, &nothing), 0.0);
        assert_eq!(times_cross(3.0, &nothing, &b), nothing);
        assert!(times_dot(1.0, &a, &Vector3::repeat(f64::NAN)).is_nan());
        assert!(times_dot(1.0, &a, &Vector3::new(f64::INFINITY, 0.0, 0.0)).is_infinite());
    }

    #[test]
    fn units_have_reciprocals() {
        for x in [5e-324, 3e-308, 1.0, 6.6e-34, 1.7e308] {
            let unit = power_below(x);
            assert!(unit.is_normal() && unit.recip().is_normal());
            assert!(unit <= x.max(f64::MIN_POSITIVE) && (x / unit < 4.0), "{x}");
        }
        assert_eq!(
            (power_below(5e-324), power_below(1e308)),
            (f64::MIN_POSITIVE, 2.0_f64.powi(1022))
        );
        assert_eq!(
            [0.0, -1.0, f64::NAN, f64::INFINITY].map(power_below),
            [1.0; 4]
        );
    }

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
