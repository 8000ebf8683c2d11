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

#[cfg(test)]
mod tests {
    use super::{TOP_RTOL, Top, classify, gaps, ray_kappa};

    #[test]
    fn classes_do_not_depend_on_the_scale() {
        for scale in [5e-324 * 1e10, 1e-300, 1e-47, 1.0, 1e37, 1e300] {
            let class = |moments: [f64; 3]| classify(&moments.map(|x| x * scale), TOP_RTOL);
            assert_eq!(class([1.0, 1.0, 1.0]), Top::Spherical);
            assert_eq!(class([1.0, 1.0, 2.0]), Top::Oblate);
            assert_eq!(class([1.0, 2.0, 2.0]), Top::Prolate);
            assert_eq!(class([2.0, 3.0, 4.0]), Top::Asymmetric);
            assert_eq!(class([0.0, 1.0, 1.0]), Top::Linear);
            assert_eq!(class([0.0, 0.0, 0.0]), Top::Point);
        }
    }

    #[test]
    fn what_belongs_to_no_body_has_no_class() {
        let class = |moments| classify(&moments, 0.0);
        assert_eq!(class([1.0, 1.0, 2.0 + 1e-12]), Top::None);
        assert_eq!(class([1.0, 1.0, 2.0 + 4.0 * f64::EPSILON]), Top::Oblate);
        assert_eq!(class([-1e-12, 1.0, 1.0]), Top::None);
        assert_eq!(class([0.0, 1.0, 2.0]), Top::None);
        assert_eq!(class([0.0, 0.0, 1.0]), Top::None);
        assert_eq!(class([-3.0, -2.0, -1.0]), Top::None);
        assert_eq!(class([-1.0, 0.0, 0.0]), Top::None);
        assert_eq!(class([f64::NAN; 3]), Top::None);
        assert_eq!(class([1.0, 1.0, f64::INFINITY]), Top::None);
        assert_eq!(classify(&[1.0, 1.0, 2.0 + 1e-7], 1e-6), Top::Oblate);
    }

    #[test]
    fn gaps_and_kappa() {
        assert_eq!(gaps(&[1.0, 3.0, 4.0]), [0.5, 0.25]);
        assert_eq!(gaps(&[0.0; 3]), [0.0, 0.0]);
        assert_eq!(ray_kappa(&[1.0, 2.0, 2.0]), -1.0);
        assert_eq!(ray_kappa(&[1.0, 1.0, 2.0]), 1.0);
        assert_eq!(ray_kappa(&[0.0, 2.0, 2.0]), -1.0);
        assert!(ray_kappa(&[1.0; 3]).is_nan());
        // A, B, C = 1, 1/2, 1/4: (1 − 5/4)/(3/4).
        assert!((ray_kappa(&[1.0, 2.0, 4.0]) + 1.0 / 3.0).abs() < 1e-15);
    }
}
