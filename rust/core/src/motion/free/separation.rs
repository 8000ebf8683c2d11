//! How far a motion is from its separatrix: the one difference that large terms may leave small.
//!
//! All that a free motion is made of is a sum of terms with one sign, but for
//!
//! - `D = L² − 2T I₂ = I₃(I₃ − I₂) ω₃² − I₁(I₂ − I₁) ω₁²`.
//!
//! Near the separatrix the period is as `−ln |D|`, so what D loses of its digits is an error of every period for ever after. It loses them
//! where its terms are nearly equal, and where ω is so near to the intermediate axis that `ω₁` and `ω₃` are differences of
//! projections themselves. There D is taken from what defines the body, in four times the precision.

use nalgebra::Vector3;

use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::MultiPrecision;
use crate::numerics::lane::{BASELINE, Double, Lane};
use crate::numerics::quad_double::QuadDouble;

/// D, to twice the precision of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Separation {
    /// In units of the moments' squared times those of the rate.
    pub(super) size: DoubleDouble,
    /// A power of two near the larger of `ω₁` and `ω₃`, in units of `rate_unit`.
    pub(super) unit: f64,
    /// A power of two.
    pub(super) rate_unit: f64,
}

/// A part of D that is worth no more than [`PHASE_ERROR`](crate::numerics::turns::PHASE_ERROR).
const HARMLESS: f64 = 2.0e-28; // 2⁻⁹²
/// A few units in the last place of what has twice the precision.
const ROUNDING: f64 = 4.9e-32; // 2⁻¹⁰⁴
/// A few in that of what has four times the precision, over [`ROUNDING`].
const FINER_ROUNDING: f64 = 8.1e-28; // 2⁻⁹⁰

impl Separation {
    /// Of moments and of ω in the principal axes, the moments of the order of one.
    pub(super) fn of(moments: &Vector, w: &Vector) -> Self {
        let unit = Unit::of(w[0], w[2]);
        Self {
            size: difference(moments, &[w[0], w[2]].map(|rate| rate.scaled(unit.inverse))),
            unit: unit.size,
            rate_unit: 1.0,
        }
    }

    /// As it is, and ω as it is, where D has the digits that long times need; else both from what the axes were refined from, in
    /// four times the precision. `omega`: in B; `moments`, `w`: what `principal` makes of it, in units of `inertia_unit`.
    ///
    /// Where nothing of D is left, or nothing of `ω₁` and `ω₃`, it is zero, or they are.
    pub(super) fn with_digits(
        self,
        principal: &RefinedPrincipal,
        omega: &Vector3<f64>,
        moments: &Vector,
        w: &Vector,
    ) -> (Self, Vector) {
        let [i1, i2, i3] = moments.map(DoubleDouble::rounded);
        // The period in turns is as the inverse of how unequal the moments are.
        let pace = ((i3 - i1) / i2).min(1.0);
        if self.size.high.abs() * HARMLESS >= pace * self.rounding_loss(principal, moments, w) {
            return (self, *w);
        }
        let finest = principal.finest();
        let largest = omega.amax();
        let exact = [omega.x, omega.y, omega.z].map(QuadDouble::from);
        let components = finest.components(&exact).map(|rate| {
            if rate.rounded().abs() <= ROUNDING * FINER_ROUNDING * largest {
                QuadDouble::default()
            } else {
                rate
            }
        });
        let w = components.map(QuadDouble::twofold);
        let unit = Unit::of(w[0], w[2]);
        let inertia = Unit::of(principal.moments[2], DoubleDouble::default()).inverse;
        let sides = [components[0], components[2]].map(|rate| rate.scaled(unit.inverse));
        let size = difference(&finest.moments.map(|moment| moment.scaled(inertia)), &sides);
        let there = Self {
            size: size.twofold(),
            unit: unit.size,
            ..self
        };
        let least = FINER_ROUNDING * there.rounding_loss(principal, moments, &w);
        if there.size.high.abs() <= least {
            let size = DoubleDouble::default();
            return (Self { size, ..there }, w);
        }
        (there, w)
    }

    /// The same where a unit of the rates is `rate_unit`, a power of two.
    pub(super) fn in_units_of(self, rate_unit: f64) -> Self {
        Self { rate_unit, ..self }
    }

    /// What rounding to twice the precision may have taken from D: of its terms, and of moments and axes where these are rounded.
    fn rounding_loss(&self, principal: &RefinedPrincipal, moments: &Vector, w: &Vector) -> f64 {
        let [i1, i2, i3] = moments.map(DoubleDouble::rounded);
        let [x, z] = [w[0], w[2]].map(|rate| (rate.high / self.unit).abs());
        let [first, third] = [i1 * (i2 - i1) * x, i3 * (i3 - i2) * z];
        let terms = first * x + third * z;
        if principal.is_exact() {
            return ROUNDING * terms;
        }
        let longest = w
            .iter()
            .fold(0.0_f64, |most, rate| most.max(rate.high.abs()));
        let of_axes = (first + third) * (longest / self.unit);
        let of_moments = (i1 * x * x + i3 * z * z) * i3;
        ROUNDING * (terms + of_axes + of_moments)
    }
}

/// D of the moments and of `ω₁` and `ω₃`, in products that are exact where they can be.
fn difference<T: MultiPrecision>(&[i1, i2, i3]: &[T; 3], &[x, z]: &[T; 2]) -> T {
    i3 * (i3 - i2) * (z * z) - i1 * (i2 - i1) * (x * x)
}

/// A unit of two numbers, a power of two near the larger.
#[derive(Clone, Copy)]
pub(super) struct Unit {
    pub(super) size: f64,
    pub(super) inverse: f64,
}

impl Unit {
    pub(super) fn of(a: DoubleDouble, b: DoubleDouble) -> Self {
        let larger = Double::<BASELINE>::new(a.high.abs().max(b.high.abs()));
        let (inverse, size) = larger.power_of_two_scale();
        Self {
            size: size.get(),
            inverse: inverse.get(),
        }
    }

    pub(super) fn square(self, rate: DoubleDouble) -> DoubleDouble {
        let rate = rate.scaled(self.inverse);
        rate * rate
    }
}
