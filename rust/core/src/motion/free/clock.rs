//! The clock of a free motion: the three elliptic functions of time of which every free motion is a rational function.
//!
//! They solve `ẏ = c d`, `ċ = −p y d`, `ḋ = −q y c` from (0, 1, 1): with p ≥ q, `y = sn(λt)/λ`, `c = cn(λt)`, `d = dn(λt)`,
//! λ² = p, and with p < q the same with c and d, p and q exchanged. They are smooth in p and q down to zero and across
//! p = q, the separatrix, where Jacobi's functions change roles. With ω(0) and the [contrasts](super::invariants),
//!
//! - `ω₁(t) = (ω₁ c + ω̇₁ y d)/D`, `ω₂(t) = (ω₂ c d + ω̇₂ y)/D`, `ω₃(t) = (ω₃ d + ω̇₃ y c)/D`,
//! - `D = 1 − α₁α₃ω₂² y² = c² + α₁α₂ω₃² y² = d² + α₂α₃ω₁² y²`:
//!
//! the addition theorems of Jacobi's functions, with the present ω in place of their value at the start.

use super::invariants::Invariants;
use crate::numerics::jacobi::{carlson_rd, jacobi};

/// y, c and d at a time, with their derivatives at that time with respect to p and q.
#[derive(Clone, Copy, Debug)]
pub(super) struct JacobiFunctionsOfTime {
    /// y, c, d.
    pub value: [f64; 3],
    /// By p.
    pub by_short: [f64; 3],
    /// By q.
    pub by_long: [f64; 3],
    /// ∫₀ᵗ y² dt.
    pub square_integral: f64,
}

impl JacobiFunctionsOfTime {
    /// At a time within half of a half period, |t| ≤ K/λ, in the units of the motion.
    #[inline]
    pub(super) fn at(motion: &Invariants, t: f64) -> Self {
        let (p, q, k_prime) = motion.fast_and_slow();
        if p == 0.0 {
            return Self::without_rate(t);
        }
        Self::with_rate(t, p, q, k_prime).with_roles_of(motion)
    }

    /// p = q = 0: a body that does not drive its ω.
    #[inline]
    fn without_rate(t: f64) -> Self {
        Self {
            value: [t, 1.0, 1.0],
            by_short: [-t * t * t / 6.0, -0.5 * t * t, 0.0],
            by_long: [-t * t * t / 6.0, 0.0, -0.5 * t * t],
            square_integral: t * t * t / 3.0,
        }
    }

    /// For p ≥ q, p > 0.
    ///
    /// From `t = ∫₀^y dy/√((1 − py²)(1 − qy²))` follow `∂y/∂q = −½ c d ∫ y²/d² dt`, `∂y/∂p = −½ c d ∫ y²/c² dt`, and with
    /// them the rest. The integrals are Carlson's: `∫₀ᵗ y²/d² dt = ⅓ y³ R_D(c², 1, d²)`. Where c is small the derivative
    /// by p comes from the scaling law `2(p ∂_p + q ∂_q) y = t ẏ − y`.
    fn with_rate(t: f64, p: f64, q: f64, k_prime: f64) -> Self {
        let rate = p.sqrt();
        let (sine, c, d) = jacobi(rate * t, k_prime);
        let y = sine / rate;
        let third = y * y * y / 3.0;
        let (c2, d2) = (c * c, d * d);
        let over_d = third * carlson_rd(c2, 1.0, d2);
        // ∫ dt/d²
        let stretched = t + q * over_d;
        let y_q = -0.5 * c * d * over_d;
        let y_p = if c2 > 0.5 {
            -0.5 * c * d * third * carlson_rd(d2, 1.0, c2)
        } else {
            0.5 * (c * d * stretched - y) / p
        };
        Self {
            value: [y, c, d],
            by_short: [y_p, -0.5 * y * d * stretched, -q * y / d * y_p],
            by_long: [
                y_q,
                0.5 * p * y * d * over_d,
                -0.5 * y * y / d - q * y / d * y_q,
            ],
            square_integral: third * carlson_rd(c2, d2, 1.0),
        }
    }

    /// c and d, p and q exchanged where p < q.
    #[inline]
    fn with_roles_of(self, motion: &Invariants) -> Self {
        if motion.circles_third() {
            return self;
        }
        let exchanged = |[y, c, d]: [f64; 3]| [y, d, c];
        Self {
            value: exchanged(self.value),
            by_short: exchanged(self.by_long),
            by_long: exchanged(self.by_short),
            square_integral: self.square_integral,
        }
    }
}

/// What the half period T = 2K/λ brings, in the units of the motion. Near the separatrix it depends on p − q far more than
/// on either, which is why that stands by itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfPeriod {
    /// ∂T by the larger of p and q, their difference held.
    pub by_larger: f64,
    /// ∂T by |p − q|, the larger held.
    pub by_gap: f64,
    /// ∫₀ᵀ y² dt.
    pub square_integral: f64,
}

impl HalfPeriod {
    /// Of a motion with finite T, which is given: for p ≥ q, `∂T/∂q = ½ ∫₀ᵀ y²/d² dt` and, by the scaling law,
    /// `2(p ∂_p + q ∂_q)T = −T`.
    #[inline]
    pub(super) fn of(motion: &Invariants, half_period: f64) -> Self {
        let (p, _, k_prime) = motion.fast_and_slow();
        let m1 = k_prime * k_prime;
        let over_cube = 2.0 / (3.0 * p * p.sqrt());
        let over_d = over_cube * carlson_rd(0.0, 1.0, m1);
        Self {
            by_larger: 0.5 * (m1 * over_d - half_period / p),
            by_gap: -0.5 * over_d,
            square_integral: over_cube * carlson_rd(0.0, m1, 1.0),
        }
    }
}

impl Invariants {
    /// The larger and the smaller of p and q, and k′.
    #[inline]
    fn fast_and_slow(&self) -> (f64, f64, f64) {
        let (p, q) = (self.short_square.high, self.long_square.high);
        let (fast, slow) = if self.circles_third() { (p, q) } else { (q, p) };
        (fast, slow, self.complementary_modulus())
    }
}
