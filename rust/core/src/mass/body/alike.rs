//! When two bodies are the same, and when nearly.

use super::possible::RigidBody;
use crate::mass::validity::trace;
use crate::numerics::power_of_two::{length, root_of_ratio};

/// The same mass, centre, tensor, moments and axes; how well they are known and whence does not matter.
impl PartialEq for RigidBody {
    fn eq(&self, other: &Self) -> bool {
        self.mass == other.mass
            && self.center_of_mass == other.center_of_mass
            && self.inertia == other.inertia
            && self.principal == other.principal
    }
}

impl RigidBody {
    /// Whether the two agree: mass to `rtol` of itself, the tensor to `rtol` of its largest element, the centre of mass
    /// to `rtol` of its distance from the origin or of the radius of gyration, whichever is larger; each `+ atol`.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    ///
    /// let (a, b) = (solids::cube(1.0, Amount::Mass(1.0))?, solids::cube(1.001, Amount::Mass(1.0))?);
    /// assert!(a.is_close(&b, 1e-2, 0.0) && !a.is_close(&b, 1e-6, 0.0));
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn is_close(&self, other: &Self, rtol: f64, atol: f64) -> bool {
        // The trace may be beyond all numbers, and so may the distance.
        let gyration = 2.0 * root_of_ratio(trace(&(other.inertia * 0.25)), other.mass);
        let size = gyration.max(length(&other.center_of_mass)).min(f64::MAX);
        (self.mass - other.mass).abs() <= atol + rtol * other.mass
            && length(&(self.center_of_mass - other.center_of_mass)) <= atol + rtol * size
            && (self.inertia - other.inertia).abs().max() <= atol + rtol * other.inertia.abs().max()
    }
}
