//! What rounding can have done to a body's numbers.

use nalgebra::Vector3;

use crate::numerics::tree_sum::depth;

/// The unit of rounding, 2⁻⁵³.
pub(crate) const UNIT: f64 = 0.5 * f64::EPSILON;

/// Bounds on the errors of a body's numbers against exact arithmetic on the very floats that were given.
///
/// A number that was given, not computed, has the bound zero. The bounds are rigorous to first order in the unit of
/// rounding and doubled, so that higher orders are covered; they are worst cases, mostly far above the actual errors.
/// They say nothing of the errors that the given numbers themselves may have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorBound {
    /// Of the mass.
    pub mass: f64,
    /// Of each component of the centre of mass.
    pub center_of_mass: f64,
    /// Of each element of the tensor about the centre of mass.
    pub inertia: f64,
}

impl ErrorBound {
    /// Of sums over `terms` particles: the mass, the first moments and the second moments about a point within the body,
    /// whose trace is `spread`.
    #[must_use]
    #[inline]
    pub(crate) fn of_sums(
        terms: usize,
        mass: f64,
        center_of_mass: &Vector3<f64>,
        spread: f64,
    ) -> Self {
        Self::of_additions(depth(terms), mass, center_of_mass, spread)
    }

    /// As [`Self::of_sums`], for sums whose terms pass that many additions on their way to the total.
    #[must_use]
    #[inline]
    pub(crate) fn of_additions(
        additions: f64,
        mass: f64,
        center_of_mass: &Vector3<f64>,
        spread: f64,
    ) -> Self {
        // Each term is rounded a few times by itself, and once in each addition.
        let relative = 2.0 * UNIT * (additions + 20.0);
        Self {
            mass: relative * mass,
            // Σ m |d| is at most √(Σ m · Σ m d²).
            center_of_mass: relative * (spread / mass).sqrt() + 2.0 * UNIT * center_of_mass.amax(),
            inertia: 2.0 * relative * spread,
        }
    }

    /// Of a closed form of a few operations.
    #[must_use]
    #[inline]
    pub(crate) fn of_closed_form(mass: f64, trace: f64) -> Self {
        Self {
            mass: 16.0 * UNIT * mass,
            center_of_mass: 0.0,
            inertia: 16.0 * UNIT * trace,
        }
    }

    /// The same, and a few more roundings of a tensor with this trace and of this centre of mass. Where products of the bounds
    /// leave float64 there is none.
    #[inline]
    pub(crate) fn rounded(self, center_of_mass: &Vector3<f64>, trace: f64) -> Self {
        let bound = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
        let size = center_of_mass.amax();
        let place = if size > 0.0 { faint(size) } else { 0.0 };
        let moment = if trace > 0.0 { faint(trace) } else { 0.0 };
        Self {
            mass: bound(self.mass),
            center_of_mass: bound(self.center_of_mass + 8.0 * UNIT * size + place),
            inertia: bound(self.inertia + 32.0 * UNIT * trace + moment),
        }
    }
}

/// What a few products that come to about this size can have lost below the normal numbers, which have fewer digits.
#[inline]
pub(super) fn faint(size: f64) -> f64 {
    if size < f64::MIN_POSITIVE / f64::EPSILON {
        16.0 * f64::from_bits(1)
    } else {
        0.0
    }
}
