//! Theta functions after the imaginary transformation: sums of hyperbolic functions, for K of at least K′ and K = ∞.
//!
//! With W = πu/2K′ every term `q′^{n²…} cosh nW` is written by the decays `g = e^{−|W|}` from the middle and
//! `y = e^{−(πK/2K′ − |W|)}` from the end of the half period, neither above one: nothing overflows at any K.

use std::f64::consts::{FRAC_PI_2, PI};

use super::circular::HalfPeriods;
use crate::numerics::lane::Lane;
use crate::numerics::turns::exp_minus;

/// The decays of u, |u| ≤ K, and its sign.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Argument<L> {
    /// `e^{−π|u|/2K′}`.
    pub from_middle: L,
    /// `e^{−π(K − |u|)/2K′}`.
    pub from_end: L,
    /// 1 with the sign of u.
    pub sign: L,
}

impl<L: Lane> Argument<L> {
    /// From W = πu/2K′ and its value πK/2K′ at the end of the half period.
    #[inline(always)]
    #[must_use]
    pub(crate) fn new(w: L, end: L) -> Self {
        let size = w.abs();
        Self {
            from_middle: exp_minus(size),
            from_end: exp_minus(end - size),
            sign: L::new(1.0).copysign(w),
        }
    }
}

/// Jacobi's functions: the quotients of [`circular`](super::circular::Jacobi) with ϑ₂ and ϑ₄ exchanged and q′ for q.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jacobi {
    q: f64,
    /// What stands before sn, cn, dn.
    factors: [f64; 3],
}

impl Jacobi {
    /// For the nome `q′ = e^{−πK/K′} ≤ 0.05`.
    #[must_use]
    pub(crate) fn new(q: f64) -> Self {
        let theta_2 = 1.0 + q * q * (1.0 + q.powi(4) * (1.0 + q.powi(6))); // over 2 q^{1/4}
        let theta_3 = 1.0 + 2.0 * q * (1.0 + q.powi(3) * (1.0 + q.powi(5)));
        let theta_4 = 1.0 - 2.0 * q * (1.0 - q.powi(3) * (1.0 - q.powi(5)));
        Self {
            q,
            factors: [
                theta_3 / theta_4,
                2.0 * theta_2 / theta_4,
                2.0 * theta_2 / theta_3,
            ],
        }
    }

    /// (sn, cn, dn).
    #[inline(always)]
    #[must_use]
    pub(crate) fn values<L: Lane>(&self, u: &Argument<L>) -> [L; 3] {
        let (g, one) = (u.from_middle, L::new(1.0));
        let q = L::new(self.q);
        let [sn, cn, dn] = self.factors.map(L::new);
        let g2 = g * g;
        let g4 = g2 * g2;
        let (g6, g8) = (g4 * g2, g4 * g4);
        let y2 = u.from_end * u.from_end;
        let qy = q * y2;
        // q′^{n²+n} cosh (2n+1)W and sinh, over ½ e^{W}: q′^{n²} y^{2n} (1 ± g^{4n+2}).
        let (first, second, third) = (qy, qy * qy * q * q, {
            let q3 = q * q * q;
            qy * qy * qy * q3 * q3
        });
        let (g10, g14) = (g8 * g2, g8 * g6);
        let theta_2 = third.mul_add(
            one + g14,
            second.mul_add(one + g10, first.mul_add(one + g6, one + g2)),
        );
        let theta_1 = second.mul_add(
            one - g10,
            (-third).mul_add(one - g14, (-first).mul_add(one - g6, one - g2)),
        );
        // 2 q′^{n²} cosh 2nW = q′^{n²−n} y^{2n} (1 + g^{4n}).
        let (odd, even, next) = (y2 * (one + g4), qy * qy * (one + g8), {
            let y6 = y2 * qy * qy;
            let q2 = q * q;
            y6 * q2 * q2 * (one + g8 * g4)
        });
        let reciprocal = one / theta_2;
        [
            sn * u.sign * theta_1 * reciprocal,
            cn * g * ((one - odd) + (even - next)) * reciprocal,
            dn * g * ((one + odd) + (even + next)) * reciprocal,
        ]
    }
}

/// Θ(u + ia) for a fixed a but for a positive factor, to N terms.
///
/// [`Shifted::value`] has to be turned by a phase that grows with u: [`Shifted::slope`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shifted<const N: usize> {
    cosines: [f64; N],
    sines: [f64; N],
    slope: f64,
}

impl<const N: usize> Shifted<N> {
    /// With a itself, |a| ≤ K′: Θ(u + ia) is the [value](Self::value) times `e^{2πi slope u}`.
    #[must_use]
    pub(crate) fn near_axis(half: HalfPeriods, a: f64) -> Self {
        let b = FRAC_PI_2 * a / half.imaginary;
        Self::of_angles(half, -a, |n| {
            let angle = f64::from(2 * n + 1) * b;
            (angle.cos(), angle.sin())
        })
    }

    /// With the distance d = K′ − a from the zero, 0 ≤ d ≤ K′: `e^{iπu/2K} Θ(u + ia)` is the [value](Self::value) times
    /// `e^{2πi slope u}`.
    #[must_use]
    pub(crate) fn near_zero(half: HalfPeriods, d: f64) -> Self {
        let b = FRAC_PI_2 * d / half.imaginary;
        Self::of_angles(half, d, |n| {
            let angle = f64::from(2 * n + 1) * b;
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            (sign * angle.sin(), sign * angle.cos())
        })
    }

    fn of_angles(half: HalfPeriods, lever: f64, angles: impl Fn(u8) -> (f64, f64)) -> Self {
        let terms: [(f64, f64); N] = std::array::from_fn(|n| {
            let weight = (-PI * half.real / half.imaginary * (n * n) as f64).exp();
            // Fewer terms than a byte counts.
            let (cosine, sine) = angles(u8::try_from(n).unwrap_or(u8::MAX));
            let weight = if n == 0 { 1.0 } else { weight };
            (weight * cosine, weight * sine)
        });
        Self {
            cosines: terms.map(|(cosine, _)| cosine),
            sines: terms.map(|(_, sine)| sine),
            slope: lever / (4.0 * half.real * half.imaginary),
        }
    }

    /// Turns of phase for each unit of u that the value lacks; zero where K is infinite.
    #[must_use]
    pub(crate) fn slope(&self) -> f64 {
        self.slope
    }

    /// Real and imaginary part, but for a positive factor, from `g = e^{−π|u|/K′}` and `y = e^{−π(K − |u|)/K′}`:
    /// `Σ q′^{n²} yⁿ [cos((2n+1) πa/2K′)(1 + g^{2n+1}) + i sign(u) sin((2n+1) πa/2K′)(1 − g^{2n+1})]`.
    #[inline(always)]
    #[must_use]
    pub(crate) fn value<L: Lane>(&self, g: L, y: L, sign: L) -> (L, L) {
        let one = L::new(1.0);
        let (mut re, mut im) = (L::new(0.0), L::new(0.0));
        let (g2, mut power, mut decay) = (g * g, g, one);
        let mut n = 0;
        while n < N {
            re = (L::new(self.cosines[n]) * decay).mul_add(one + power, re);
            im = (L::new(self.sines[n]) * decay).mul_add(one - power, im);
            power = power * g2;
            decay = decay * y;
            n += 1;
        }
        (re, sign * im)
    }
}
