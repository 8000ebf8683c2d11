//! The constants of a free motion that multiply the time.

use crate::numerics::double_double::DoubleDouble;

/// What grows with time, and the modulus; in units of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Secular {
    /// The time after which ω has the opposite signs across the axis circled: half of the period 4K/λ of ω in the body.
    /// Infinite where ω circles nothing.
    pub half_period: DoubleDouble,
    /// Mean rate in radians at which the body precesses about L, `μ̇` over a period; of a spin |ω|.
    pub mean_precession: DoubleDouble,
    /// The modulus k of Jacobi's functions.
    pub modulus: f64,
    /// `k′ = √(1 − k²)`, with all its digits near the separatrix.
    pub complementary_modulus: f64,
}

impl Secular {
    pub(super) fn in_units_of(self, rate_unit: f64) -> Self {
        Self {
            half_period: self.half_period.scaled(1.0 / rate_unit),
            mean_precession: self.mean_precession.scaled(rate_unit),
            ..self
        }
    }
}
