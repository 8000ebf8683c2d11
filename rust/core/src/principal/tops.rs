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
//! its units nor on its size. Of particles whose coordinates were printed to few digits, [`rounding_rtols`] says how
//! close two moments must be to be equal as far as the digits tell.

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
///
/// # Examples
///
/// ```
/// use polhode::principal::{TOP_RTOL, Top, classify};
///
/// assert_eq!(classify(&[1.0, 1.0, 2.0], TOP_RTOL), Top::Oblate); // a coin
/// assert_eq!(classify(&[0.0, 1.0, 1.0], TOP_RTOL), Top::Linear);
/// assert_eq!(classify(&[1.0, 1.0, 3.0], TOP_RTOL), Top::None);
/// assert_eq!(Top::Oblate.as_str(), "oblate");
/// ```
#[must_use]
pub fn classify(moments: &[f64; 3], rtol: f64) -> Top {
    classify_within(moments, &[rtol; 3])
}

/// As [`classify`], with a tolerance each for I₁ = 0, I₁ = I₂ and I₂ = I₃, all relative to the largest moment.
#[must_use]
pub fn classify_within(moments: &[f64; 3], &[zero, lower, upper]: &[f64; 3]) -> Top {
    let &[i1, i2, i3] = moments;
    if i1 == 0.0 && i2 == 0.0 && i3 == 0.0 {
        return Top::Point;
    }
    // Relative to the largest, so that no sum overflows.
    let (x1, x2) = (i1 / i3, i2 / i3);
    let rounding = 16.0 * f64::EPSILON * (x1 + x2 + 1.0);
    let slack = rounding.max(zero).max(lower).max(upper);
    let is_body = i3 > 0.0
        && i3.is_finite()
        && i1 <= i2
        && i2 <= i3
        && x1 >= -slack
        && x1 + x2 >= 1.0 - slack;
    if !is_body {
        return Top::None;
    }
    let [low, high] = gaps(moments);
    match (low <= lower, high <= upper) {
        (true, true) => Top::Spherical,
        (true, false) => Top::Oblate,
        (false, true) if x1 <= zero => Top::Linear,
        (false, true) => Top::Prolate,
        (false, false) => Top::Asymmetric,
    }
}

/// How far rounding can take moments that are equal from each other, relative to the largest: I₁ from 0, I₁ from I₂ and
/// I₂ from I₃, of particles whose coordinates were rounded by at most `rounding` each. 0 of a point.
///
/// With rounded positions r from C, exact ones r + d, |d| ≤ δ = √3 `rounding`, and total mass M, the second moment changes
/// by `ΔS = Σ m (r dᵀ + d rᵀ) + Σ m d dᵀ` (less the shift of C, which only lessens the last sum). By Cauchy and Schwarz
/// `Σ m ρ |d| ≤ δ √(M I)`, ρ being the distances from an axis and I the moment about it, so that in the plane across axis k
/// no element of ΔS, and no half difference of two on its diagonal, exceeds
///
/// `o_k = δ √(M I_k) + M δ²/2`.
///
/// A pair that is equal in truth is at most `2 o` apart to first order, o of the axis across the pair. What remains is that
/// the axis itself is turned: by the minimax theorem of Courant and Fischer, in the other plane of the pair's nearer member
/// with the third axis, it is at most `√(x² + o'²) − x`, half the distance to the third moment being `x + o'`. And the
/// moment of a straight line is `Σ m d² ≤ M δ²` about the line through the rounded places. These bounds hold to all orders.
///
/// # Examples
///
/// ```
/// use polhode::principal::{Top, classify_within, gaps, rounding_rtols};
///
/// // Atoms whose coordinates are printed to 0.01: these moments may be those of a coin.
/// let moments = [1.0, 1.002, 2.001];
/// assert!((gaps(&moments)[0] - 0.002 / 2.001).abs() < 1e-15);
/// let told = rounding_rtols(4.0, &moments, 0.005);
/// assert_eq!(classify_within(&moments, &told), Top::Oblate);
/// assert_eq!(classify_within(&moments, &rounding_rtols(4.0, &moments, 0.5e-6)), Top::Asymmetric);
/// ```
#[must_use]
pub fn rounding_rtols(mass: f64, moments: &[f64; 3], rounding: f64) -> [f64; 3] {
    let &[i1, i2, i3] = moments;
    if rounding == 0.0 || i3 == 0.0 {
        return [0.0; 3];
    }
    // Moments and M δ² in units of I₃, which neither under- nor overflow.
    let (x1, x2) = (i1 / i3, i2 / i3);
    let length = (i3 / mass).sqrt();
    let zero = 3.0 * (rounding / length) * (rounding / length);
    let element = |x: f64| (zero * x).sqrt() + 0.5 * zero;
    let (o1, o3) = (element(x1), element(1.0));
    let turned = |distance: f64, o: f64| {
        let x = 0.5 * distance - o;
        let root = x.hypot(o);
        // The same in two forms, in neither of which digits cancel.
        if x > 0.0 {
            o * o / (root + x)
        } else {
            root - x
        }
    };
    [
        zero,
        2.0 * o3 + turned(1.0 - x2, o1),
        2.0 * o1 + turned(x2 - x1, o3),
    ]
}

/// Ray's asymmetry parameter κ = (2B − A − C)/(A − C) of the rotational constants A ≥ B ≥ C, which are inversely
/// proportional to the moments: −1 for a prolate top, +1 for an oblate one, NaN for a spherical one.
///
/// Written in the moments, κ = 2 I₁(I₃ − I₂)/(I₂(I₃ − I₁)) − 1, so that a zero moment (A infinite) has its limit −1.
///
/// # Examples
///
/// ```
/// use polhode::principal::ray_kappa;
///
/// // Ray's asymmetry of rotational constants: −1 for a cigar, 1 for a coin.
/// assert_eq!(ray_kappa(&[1.0, 2.0, 2.0]), -1.0);
/// assert_eq!(ray_kappa(&[1.0, 1.0, 2.0]), 1.0);
/// ```
#[must_use]
pub fn ray_kappa(moments: &[f64; 3]) -> f64 {
    let &[i1, i2, i3] = moments;
    2.0 * (i1 / i2) * ((i3 - i2) / (i3 - i1)) - 1.0
}

#[cfg(test)]
mod tests {
    use super::{TOP_RTOL, Top, classify, classify_within, gaps, ray_kappa, rounding_rtols};

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
    fn each_pair_has_its_tolerance() {
        let class = |moments: [f64; 3], rtols: [f64; 3]| classify_within(&moments, &rtols);
        let top = [1.0, 1.1, 1.6];
        assert_eq!(class(top, [0.0; 3]), Top::Asymmetric);
        assert_eq!(class(top, [0.0, 0.1, 0.0]), Top::Oblate);
        assert_eq!(class(top, [0.0, 0.0, 0.4]), Top::Prolate);
        assert_eq!(class(top, [0.0, 0.1, 0.4]), Top::Spherical);
        assert_eq!(class([0.01, 1.0, 1.005], [0.0, 0.0, 0.01]), Top::Prolate);
        assert_eq!(class([0.01, 1.0, 1.005], [0.01, 0.0, 0.01]), Top::Linear);
        assert_eq!(class([0.01, 1.0, 1.005], [0.01, 0.0, 0.0]), Top::Asymmetric);
    }

    #[test]
    fn rounding_of_coordinates() {
        // To first order 2 δ √(M I) of the axis across the pair; I = 1, 1, 2, M = 1, δ = √3/2 · 1e-6.
        let delta = 0.75_f64.sqrt() * 1e-6;
        let [zero, lower, upper] = rounding_rtols(1.0, &[1.0, 1.0, 2.0], 0.5e-6);
        assert!((zero / (delta * delta / 2.0) - 1.0).abs() < 1e-12);
        assert!((lower / (2.0 * delta * 2.0_f64.sqrt() / 2.0) - 1.0).abs() < 1e-5);
        // The pair of axes 2 and 3 has a third moment beside it, so that its plane may turn as far as it likes.
        assert!(upper > 2.0 * delta / 2.0 && upper < 10.0 * delta);
        // It depends neither on the unit of length nor on that of mass, and is 0 where nothing is known.
        for scale in [1e-120, 1e-20, 1e100] {
            let moments = [1.0, 1.0, 2.0].map(|moment: f64| moment * scale * scale * 1e-27);
            let rtols = rounding_rtols(1e-27, &moments, 0.5e-6 * scale);
            for (rtol, known) in rtols.into_iter().zip([zero, lower, upper]) {
                assert!(
                    (rtol / known - 1.0).abs() < 1e-12,
                    "{scale}: {rtol} {known}"
                );
            }
        }
        assert_eq!(rounding_rtols(1.0, &[1.0, 1.0, 2.0], 0.0), [0.0; 3]);
        assert_eq!(rounding_rtols(1.0, &[0.0; 3], 0.1), [0.0; 3]);
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
