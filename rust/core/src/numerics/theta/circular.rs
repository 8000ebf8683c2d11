//! The two periods of Jacobi's functions.

use std::f64::consts::PI;

use crate::numerics::lane::Lane;

/// The half periods: K along the real axis, K′ along the imaginary one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfPeriods {
    /// K.
    pub real: f64,
    /// K′.
    pub imaginary: f64,
}

// Theta functions as sums of sines and cosines, for nomes up to 0.11.

/// Cosines and sines of z = πu/2K and its multiples up to 9 z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Argument<L> {
    /// cos nz.
    pub cos: [L; 10],
    /// sin nz.
    pub sin: [L; 10],
}

impl<L: Lane> Argument<L> {
    /// From sine and cosine of z.
    #[inline(always)]
    #[must_use]
    pub(crate) fn new(sine: L, cosine: L) -> Self {
        let (zero, one, two) = (L::new(0.0), L::new(1.0), L::new(2.0));
        let twice = |s: L, c: L| (two * s * c, one - two * s * s);
        let sum = |(s, c): (L, L), (t, d): (L, L)| (s * d + c * t, c * d - s * t);
        let first = (sine, cosine);
        let second = twice(sine, cosine);
        let fourth = twice(second.0, second.1);
        let sixth = sum(fourth, second);
        let eighth = twice(fourth.0, fourth.1);
        let all = [
            (zero, one),
            first,
            second,
            sum(second, first),
            fourth,
            sum(fourth, first),
            sixth,
            sum(sixth, first),
            eighth,
            sum(eighth, first),
        ];
        Self {
            cos: all.map(|(_, c)| c),
            sin: all.map(|(s, _)| s),
        }
    }
}

/// Jacobi's functions by `sn = (ϑ₃/ϑ₂)(0) ϑ₁/ϑ₄`, `cn = (ϑ₄/ϑ₂)(0) ϑ₂/ϑ₄`, `dn = (ϑ₄/ϑ₃)(0) ϑ₃/ϑ₄`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jacobi {
    /// q, q⁴, q⁹, q¹⁶ of ϑ₃ and ϑ₄, doubled.
    even: [f64; 4],
    /// q², q⁶, q¹² of ϑ₁ and ϑ₂.
    odd: [f64; 3],
    /// What stands before sn, cn, dn.
    factors: [f64; 3],
}

impl Jacobi {
    /// For the nome q ≤ 0.11.
    #[must_use]
    pub(crate) fn new(q: f64) -> Self {
        let even = [1, 4, 9, 16].map(|n| 2.0 * q.powi(n));
        let odd = [2, 6, 12].map(|n| q.powi(n));
        let theta_2 = 1.0 + odd[0] + odd[1] + odd[2]; // over 2 q^{1/4}
        let theta_3 = 1.0 + even[0] + even[1] + even[2] + even[3];
        let theta_4 = 1.0 - even[0] + even[1] - even[2] + even[3];
        Self {
            even,
            odd,
            factors: [theta_3 / theta_2, theta_4 / theta_2, theta_4 / theta_3],
        }
    }

    /// (sn, cn, dn).
    #[inline(always)]
    #[must_use]
    pub(crate) fn values<L: Lane>(&self, z: &Argument<L>) -> [L; 3] {
        let [q1, q4, q9, q16] = self.even.map(L::new);
        let [q2, q6, q12] = self.odd.map(L::new);
        let [sn, cn, dn] = self.factors.map(L::new);
        let (cos, sin) = (&z.cos, &z.sin);
        let one = L::new(1.0);
        let unchanged = q16.mul_add(cos[8], q4.mul_add(cos[4], one));
        let changing = q9.mul_add(cos[6], q1 * cos[2]);
        let theta_1 = (-q12).mul_add(sin[7], q6.mul_add(sin[5], (-q2).mul_add(sin[3], sin[1])));
        let theta_2 = q12.mul_add(cos[7], q6.mul_add(cos[5], q2.mul_add(cos[3], cos[1])));
        let reciprocal = one / (unchanged - changing);
        [
            sn * theta_1 * reciprocal,
            cn * theta_2 * reciprocal,
            dn * (unchanged + changing) * reciprocal,
        ]
    }
}

/// Θ(u + ia) for a fixed a, to N terms beside the one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shifted<const N: usize> {
    cosines: [f64; N],
    sines: [f64; N],
}

impl<const N: usize> Shifted<N> {
    /// With a itself, |a| ≤ K′.
    #[must_use]
    pub(crate) fn near_axis(half: HalfPeriods, a: f64) -> Self {
        Self::of_powers(|n| {
            let decay = n * half.imaginary;
            (
                -PI / half.real * n * (decay - a),
                -PI / half.real * n * (decay + a),
            )
        })
    }

    /// With the distance d = K′ − a from the zero, 0 ≤ d ≤ K′.
    #[must_use]
    pub(crate) fn near_zero(half: HalfPeriods, d: f64) -> Self {
        Self::of_powers(|n| {
            let (less, more) = ((n - 1.0) * half.imaginary, (n + 1.0) * half.imaginary);
            (
                -PI / half.real * n * (less + d),
                -PI / half.real * n * (more - d),
            )
        })
    }

    /// Where K′ is infinite and d is `−(K/π) ln ratio`: `1 − ratio·e^{−iπu/K}`.
    #[must_use]
    pub(crate) fn single(ratio: f64) -> Self {
        let mut single = Self {
            cosines: [0.0; N],
            sines: [0.0; N],
        };
        single.cosines[0] = -ratio;
        single.sines[0] = ratio;
        single
    }

    /// From the logarithms of `q^{n²} e^{nπa/K}` and `q^{n²} e^{−nπa/K}`.
    fn of_powers(logarithms: impl Fn(f64) -> (f64, f64)) -> Self {
        let powers: [(f64, f64); N] = std::array::from_fn(|k| {
            let (raised, lowered) = logarithms(k as f64 + 1.0);
            let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
            (sign * raised.exp(), sign * lowered.exp())
        });
        Self {
            cosines: powers.map(|(raised, lowered)| raised + lowered),
            sines: powers.map(|(raised, lowered)| lowered - raised),
        }
    }

    /// Real and imaginary part.
    #[inline(always)]
    #[must_use]
    pub(crate) fn value<L: Lane>(&self, z: &Argument<L>) -> (L, L) {
        let (mut re, mut im) = (L::new(0.0), L::new(0.0));
        let mut n = N;
        while n > 0 {
            re = L::new(self.cosines[n - 1]).mul_add(z.cos[2 * n], re);
            im = L::new(self.sines[n - 1]).mul_add(z.sin[2 * n], im);
            n -= 1;
        }
        (L::new(1.0) + re, im)
    }
}
