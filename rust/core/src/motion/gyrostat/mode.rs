//! The ways in which a gyrostat moves.

use std::fmt;

/// How a gyrostat moves: by the roots of the cubic of its curve, and where it is on it. The first that fits holds.
///
/// In the body L runs along a curve on the sphere |L| = constant, on which the energy is constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// ω is constant in the body, and L along it, or the body rests: an equilibrium.
    Steady,
    /// Two roots are equal and the elliptic functions are sines: a symmetric body with the momentum inside along its axis, a
    /// body with equal moments.
    Circular,
    /// Two roots are equal and the period is infinite: L leaves one unstable equilibrium and approaches it or another one.
    Separatrix,
    /// Three real roots: L has the choice of two closed curves with this energy, and is on one of them. Free motion without
    /// momentum inside is always so.
    Paired,
    /// One real root: there is one closed curve with this energy alone.
    Single,
}

impl Mode {
    /// The name in lower case.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Circular => "circular",
            Self::Separatrix => "separatrix",
            Self::Paired => "paired",
            Self::Single => "single",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
