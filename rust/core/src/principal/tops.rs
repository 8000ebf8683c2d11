//! Tops: which principal moments of a body are equal.
//!
//! | class | moments |
//! |---|---|
//! | spherical | I₁ = I₂ = I₃ > 0 |
//! | oblate | I₁ = I₂ < I₃: a coin |
//! | prolate | 0 < I₁ < I₂ = I₃: a cigar |
//! | asymmetric | I₁ < I₂ < I₃ |
//! | linear | 0 = I₁ < I₂ = I₃: a thin rod, a diatomic molecule |
//! | point | 0 = I₁ = I₂ = I₃ |
//!
//! Equality is decided on the [gaps], relative to the largest moment, so the class of a body depends neither on
//! its units nor on its size.

use std::fmt;

/// Moments closer than this, relative to the largest, count as equal unless the caller says otherwise.
pub const TOP_RTOL: f64 = 1e-6;

/// The class of a top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Top {
    /// All three moments equal.
    Spherical,
    /// The two smaller moments equal.
    Oblate,
    /// The two larger moments equal.
    Prolate,
    /// No two moments equal.
    Asymmetric,
    /// The smallest moment zero, the others equal.
    Linear,
    /// All moments zero.
    Point,
    /// Not the moments of any body.
    None,
}

impl Top {
    /// The name in lower case.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Spherical => "spherical",
            Self::Oblate => "oblate",
            Self::Prolate => "prolate",
            Self::Asymmetric => "asymmetric",
            Self::Linear => "linear",
            Self::Point => "point",
            Self::None => "none",
        }
    }
}

impl fmt::Display for Top {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// The relative gaps (I₂ − I₁)/I₃ and (I₃ − I₂)/I₃ of ascending moments; zero for a point.
#[must_use]
pub fn gaps(moments: &[f64; 3]) -> [f64; 2] {
    let &[i1, i2, i3] = moments;
    if i1 == 0.0 && i2 == 0.0 && i3 == 0.0 {
        return [0.0, 0.0];
    }
    [(i2 - i1) / i3, (i3 - i2) / i3]
}

/// The class of a top with these ascending moments, those closer than `rtol` times the largest taken as equal.
///
/// [`Top::None`] where the moments belong to no body: not finite, not ascending, negative, or I₁ + I₂ < I₃, each by more
/// than rounding (16 ε times the sum of the moments) and by more than `rtol` times the largest.
#[must_use]
pub fn classify(moments: &[f64; 3], rtol: f64) -> Top {
    let &[i1, i2, i3] = moments;
    if i1 == 0.0 && i2 == 0.0 && i3 == 0.0 {
        return Top::Point;
    }
    // Relative to the largest, so that no sum overflows.
    let (x1, x2) = (i1 / i3, i2 / i3);
    let slack = rtol.max(16.0 * f64::EPSILON * (x1 + x2 + 1.0));
    let is_body = i3 > 0.0
        && i3.is_finite()
        && i1 <= i2
        && i2 <= i3
        && x1 >= -slack
        && x1 + x2 >= 1.0 - slack;
    if !is_body {
        return Top::None;
    }
    let [lower, upper] = gaps(moments);
    match (lower <= rtol, upper <= rtol) {
        (true, true) => Top::Spherical,
        (true, false) => Top::Oblate,
        (false, true) if x1 <= rtol => Top::Linear,
        (false, true) => Top::Prolate,
        (false, false) => Top::Asymmetric,
    }
}

/// Ray's asymmetry parameter κ = (2B − A − C)/(A − C) of the rotational constants A ≥ B ≥ C, which are inversely
/// proportional to the moments: −1 for a prolate top, +1 for an oblate one, NaN for a spherical one.
///
/// Written in the moments, κ = 2 I₁(I₃ − I₂)/(I₂(I₃ − I₁)) − 1, so that a zero moment (A infinite) has its limit −1.
#[must_use]
pub fn ray_kappa(moments: &[f64; 3]) -> f64 {
    let &[i1, i2, i3] = moments;
    2.0 * (i1 / i2) * ((i3 - i2) / (i3 - i1)) - 1.0
}
