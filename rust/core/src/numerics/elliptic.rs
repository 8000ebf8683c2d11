//! Elliptic integrals: complete ones of all three kinds by one chain of means, the incomplete one of the first kind.
//!
//! The modulus is always given by its complement `k′ = √(1 − k²)`, since near k = 1 that is what carries the digits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::double_double::DoubleDouble;
use super::quad_double::QuadDouble;

/// What the chain of means needs of a number: doubles, [`DoubleDouble`] and [`QuadDouble`].
pub(crate) trait MultiPrecision:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// π/2.
    const HALF_PI: Self;
    /// Two means this close, relative to themselves, are one after one more step.
    const CLOSE: f64;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// The number times a power of two.
    #[must_use]
    fn scaled(self, power_of_two: f64) -> Self;
    /// The nearest double.
    fn rounded(self) -> f64;
    /// The nearest number of twice the precision.
    fn twofold(self) -> DoubleDouble;

    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self {
        if self.rounded() < 0.0 { -self } else { self }
    }
}

impl MultiPrecision for f64 {
    const HALF_PI: Self = std::f64::consts::FRAC_PI_2;
    const CLOSE: f64 = 1e-8;

    #[inline]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline]
    fn scaled(self, power_of_two: f64) -> Self {
        self * power_of_two
    }

    #[inline]
    fn rounded(self) -> f64 {
        self
    }

    #[inline]
    fn twofold(self) -> DoubleDouble {
        self.into()
    }
}

impl MultiPrecision for DoubleDouble {
    const HALF_PI: Self = Self {
        high: Self::PI.high / 2.0,
        low: Self::PI.low / 2.0,
    };
    const CLOSE: f64 = 1e-16;

    #[inline]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline]
    fn scaled(self, power_of_two: f64) -> Self {
        self.scaled(power_of_two)
    }

    #[inline]
    fn rounded(self) -> f64 {
        self.high
    }

    #[inline]
    fn twofold(self) -> DoubleDouble {
        self
    }
}

impl MultiPrecision for QuadDouble {
    const HALF_PI: Self = Self::HALF_PI;
    const CLOSE: f64 = 1e-32;

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn scaled(self, power_of_two: f64) -> Self {
        self.scaled(power_of_two)
    }

    fn rounded(self) -> f64 {
        self.rounded()
    }

    fn twofold(self) -> DoubleDouble {
        self.twofold()
    }
}

/// The most steps of the chain: k′ = 1e-300 takes fifteen.
const STEPS: usize = 24;

/// The complete elliptic integral of the first kind,
/// `K = ∫₀^{π/2} dφ/√(cos²φ + k′² sin²φ)`, for k′ > 0 (infinite at zero).
#[must_use]
pub(crate) fn complete_first<T: MultiPrecision>(k_prime: T) -> T {
    let (mut arithmetic, mut geometric, mut doubled) = (T::from(1.0), k_prime, 1.0);
    for _ in 0..STEPS {
        let before = arithmetic;
        arithmetic = arithmetic + geometric;
        doubled *= 2.0;
        if (before - geometric).rounded().abs() <= before.rounded() * T::CLOSE {
            break;
        }
        geometric = T::from(2.0) * (before * geometric).sqrt();
    }
    T::HALF_PI * T::from(doubled) / arithmetic
}

/// Bulirsch's complete integral beside the first kind, `(K, cel)` with
/// `cel = ∫₀^{π/2} (a cos²φ + b sin²φ) / [(cos²φ + p sin²φ) √(cos²φ + k′² sin²φ)] dφ`, for k′ > 0 and p > 0.
///
/// With p = 1 and a = b = 1 it is K; with p = 1 − n and a = b = 1 it is Π(n, k). For a, b ≥ 0 all terms have one sign.
/// Source: R. Bulirsch, Numerical calculation of elliptic integrals and elliptic functions III, Numer. Math. 13 (1969) 305.
#[must_use]
pub(crate) fn complete_third<T: MultiPrecision>(k_prime: T, p: T, a: T, b: T) -> (T, T) {
    let two = T::from(2.0);
    let (mut mean, mut geometric, mut product) = (T::from(1.0), k_prime, k_prime);
    let mut p = p.sqrt();
    let (mut a, mut b) = (a, b / p);
    let mut doubled = 1.0;
    for _ in 0..STEPS {
        let (a_before, quotient, before) = (a, product / p, mean);
        a = a + b / p;
        b = two * (b + a_before * quotient);
        p = quotient + p;
        mean = mean + geometric;
        doubled *= 2.0;
        if (before - geometric).rounded().abs() <= before.rounded() * T::CLOSE {
            break;
        }
        geometric = two * product.sqrt();
        product = geometric * mean;
    }
    (
        T::HALF_PI * T::from(doubled) / mean,
        T::HALF_PI * (b + a * mean) / (mean * (mean + p)),
    )
}

/// Carlson's symmetric integral `R_F(x, y, z) = ½ ∫₀^∞ dt/√((t + x)(t + y)(t + z))`, for arguments that are not negative,
/// of which at most one is zero.
///
/// Source: B. C. Carlson, Computing elliptic integrals by duplication, Numer. Math. 33 (1979) 1.
#[must_use]
pub fn carlson_rf(x: f64, y: f64, z: f64) -> f64 {
    let mut arguments = [x, y, z];
    // Each duplication divides the differences by four. NaN stays NaN.
    for _ in 0..STEPS {
        let mean = (arguments[0] + arguments[1] + arguments[2]) / 3.0;
        let [x, y, z] = arguments;
        let (dx, dy, dz) = (1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean);
        if dx.abs().max(dy.abs()).max(dz.abs()) < 2e-3 {
            let (e2, e3) = (dx * dy - dz * dz, dx * dy * dz);
            let series = e2 * (-1.0 / 10.0 + e2 / 24.0 - 3.0 * e3 / 44.0 - 5.0 * e2 * e2 / 208.0)
                + e3 * (1.0 / 14.0 + 3.0 * e3 / 104.0);
            return (1.0 + series) / mean.sqrt();
        }
        let (rx, ry, rz) = (x.sqrt(), y.sqrt(), z.sqrt());
        let shift = rx * (ry + rz) + ry * rz;
        arguments = [0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift)];
    }
    f64::NAN
}

/// The integral of the first kind up to the angle with this sine and cosine,
/// `F = ∫₀^φ dφ/√(cos²φ + k′² sin²φ)`, −π/2 ≤ φ ≤ π/2.
#[must_use]
pub(crate) fn incomplete_first(sine: f64, cosine: f64, k_prime: f64) -> f64 {
    let (s2, c2) = (sine * sine, cosine * cosine);
    sine * carlson_rf(c2, c2 + k_prime * k_prime * s2, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (k′, K) by mpmath 1.3 with 50 digits: `ellipk(1 - k1**2)`, k′ the double; the value as a double and the rest.
    const FIRST: [(f64, f64, f64); 5] = [
        (0.9, 1.654_616_667_522_527, 1.849_520_977_927_159_2e-17),
        (0.5, 2.156_515_647_499_643_4, -1.822_784_772_617_928_3e-16),
        (0.001, 8.294_051_463_615_44, -8.023_311_253_989_47e-16),
        (1e-14, 33.622_485_663_036_53, 2.115_528_827_463_752_3e-15),
        (1e-200, 461.903_312_959_929_05, -2.580_932_000_468_967_3e-14),
    ];

    /// (k′, p, a, b, cel) by mpmath 1.3 with 80 digits: `a R_F(0, k′², 1) + (b − p a) R_J(0, k′², 1, p)/3`.
    const THIRD: [(f64, f64, f64, f64, f64, f64); 5] = [
        (
            0.9,
            2.0,
            1.0,
            1.0,
            1.159_492_862_261_477_5,
            3.954_316_650_050_861e-17,
        ),
        (
            0.5,
            1.5,
            1.0,
            0.25,
            1.020_497_085_616_143_7,
            -3.087_862_079_615_063e-17,
        ),
        (
            0.001,
            1e6,
            1.0,
            3.0,
            0.001_594_674_552_630_264,
            6.919_172_504_663_766e-20,
        ),
        (
            1e-14,
            7.0,
            1.0,
            4.0,
            19.419_865_763_319_944,
            6.706_249_042_906_903e-16,
        ),
        (
            0.3,
            1e+30,
            1.0,
            2e+29,
            0.525_554_666_416_87,
            -3.663_407_278_358_066_6e-18,
        ),
    ];

    fn relative(value: DoubleDouble, high: f64, low: f64) -> f64 {
        ((value - DoubleDouble { high, low }).high / high).abs()
    }

    #[test]
    fn first_kind() {
        for (k_prime, high, low) in FIRST {
            assert!((complete_first(k_prime) / high - 1.0).abs() < 5e-16);
            let double = complete_first(DoubleDouble::from(k_prime));
            assert!(relative(double, high, low) < 2e-31, "{k_prime:e}");
        }
    }

    #[test]
    fn third_kind() {
        for (k_prime, p, a, b, high, low) in THIRD {
            let (first, third) = complete_third(k_prime, p, a, b);
            assert!((third / high - 1.0).abs() < 1e-15);
            assert!((first / complete_first(k_prime) - 1.0).abs() < 5e-16);
            let (_, third) =
                complete_third::<DoubleDouble>(k_prime.into(), p.into(), a.into(), b.into());
            assert!(relative(third, high, low) < 5e-31, "{k_prime:e} {p:e}");
        }
    }

    #[test]
    fn incomplete() {
        // F(φ, 1) = asinh tan φ and F(φ, 0) = φ.
        for angle in [-1.5_f64, -0.3, 1e-9, 0.7, 1.4] {
            let (s, c) = angle.sin_cos();
            assert!((incomplete_first(s, c, 1.0) / angle - 1.0).abs() < 5e-16);
            assert!((incomplete_first(s, c, 0.0) / (s / c).asinh() - 1.0).abs() < 1e-15);
        }
        // Half way in the argument: F = K/2 where tan²φ = 1/k′.
        let k_prime: f64 = 1e-3;
        let (s, c) = (
            (1.0 / (1.0 + k_prime)).sqrt(),
            (k_prime / (1.0 + k_prime)).sqrt(),
        );
        assert!(
            (2.0 * incomplete_first(s, c, k_prime) / complete_first(k_prime) - 1.0).abs() < 1e-15
        );
        assert!(incomplete_first(f64::NAN, 0.0, 1.0).is_nan());
    }
}
