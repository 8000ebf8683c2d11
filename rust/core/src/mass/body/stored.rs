//! A body as numbers, and the body of such numbers again: what pickles and files hold.

use nalgebra::{Matrix3, Vector3};

use super::possible::{RigidBody, tensor};
use crate::error::{Error, all_finite_of_body};
use crate::mass::error_bound::ErrorBound;
use crate::mass::provenance::{Checks, MomentsFrom, Provenance};
use crate::mass::validity::{check_mass, check_moments, check_rotation, trace};
use crate::principal::PrincipalAxes;

impl RigidBody {
    /// All that a body is, as numbers: mass, C, the upper triangle of `I_C` by rows, moments, axes by rows, bounds,
    /// provenance.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::RigidBody;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(3.0))?;
    /// let mut numbers = ball.to_array();
    /// assert_eq!(RigidBody::from_array(&numbers)?.to_array(), numbers);
    /// numbers[4] *= 2.0; // a tensor that its moments contradict
    /// assert!(RigidBody::from_array(&numbers).is_err());
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn to_array(&self) -> [f64; 34] {
        let (c, i) = (&self.center_of_mass, &self.inertia);
        let mut numbers = [0.0; 34];
        numbers[0] = self.mass;
        numbers[1..4].copy_from_slice(c.as_slice());
        numbers[4..10].copy_from_slice(&[i.m11, i.m12, i.m13, i.m22, i.m23, i.m33]);
        numbers[10..13].copy_from_slice(&self.principal.moments);
        numbers[13..22].copy_from_slice(self.principal.axes.transpose().as_slice());
        let bound = &self.error_bound;
        numbers[22..25].copy_from_slice(&[bound.mass, bound.center_of_mass, bound.inertia]);
        numbers[25..].copy_from_slice(&self.provenance.to_array());
        numbers
    }

    /// The body that [`Self::to_array`] took apart, the same to the last bit.
    ///
    /// # Errors
    /// When the numbers are not those of a body: moments, axes and tensor must agree.
    pub fn from_array(numbers: &[f64; 34]) -> Result<Self, Error> {
        let [mass, x, y, z, xx, xy, xz, yy, yz, zz, i1, i2, i3, ..] = *numbers;
        let moments = [i1, i2, i3];
        let axes = Matrix3::from_row_slice(&numbers[13..22]);
        let error_bound = ErrorBound {
            mass: numbers[22],
            center_of_mass: numbers[23],
            inertia: numbers[24],
        };
        let provenance = Provenance::from_array(&std::array::from_fn(|k| numbers[25 + k]));
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let center_of_mass = Vector3::new(x, y, z);
        check_mass(mass)?;
        all_finite_of_body("center_of_mass", &center_of_mass)?;
        all_finite_of_body("moments", &moments)?;
        all_finite_of_body("inertia", &inertia)?;
        check_rotation("axes", &axes)?;
        let principal = PrincipalAxes { moments, axes };
        let difference = (inertia - tensor(&principal)).abs().max();
        // The least numbers of float64 have few digits.
        let rounding = 1e-12 * trace(&inertia)
            + f64::MIN_POSITIVE * 64.0 * f64::EPSILON
            + 6.0 * error_bound.inertia.max(0.0);
        let is_ordered = i1 <= i2 && i2 <= i3;
        let may_be_negative = provenance.checks.contains(Checks::UNCHECKED);
        if difference > rounding || !is_ordered || !(i1 >= 0.0 || may_be_negative) {
            let law = "that of the ascending principal moments and the axes stored beside it";
            return Err(Error::OutOfDomain {
                what: "inertia",
                law,
                value: difference,
            });
        }
        // What a second moment gave obeys the law but for rounding, if it was checked; a tensor that was given, alone or as a part,
        // may have been admitted as it is.
        let is_summed = matches!(
            provenance.moments,
            MomentsFrom::SecondMoment | MomentsFrom::OwnAxes
        );
        let may_break = [Checks::UNCHECKED, Checks::TENSOR];
        if is_summed && !(may_break.into_iter()).any(|check| provenance.checks.contains(check)) {
            check_moments(&moments, 2.0 * error_bound.inertia.max(0.0), 1e-12, false)?;
        }
        for (what, value) in [
            ("error_bound.mass", error_bound.mass),
            ("error_bound.center_of_mass", error_bound.center_of_mass),
            ("error_bound.inertia", error_bound.inertia),
        ] {
            if value.is_nan() || value < 0.0 {
                let law = "zero or more";
                return Err(Error::OutOfDomain { what, law, value });
            }
        }
        Ok(Self {
            mass,
            center_of_mass,
            inertia,
            principal,
            error_bound,
            provenance,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_bounds_are_no_bounds() {
        let body = RigidBody::new(1.0, &Matrix3::identity(), &Vector3::zeros(), 0.0);
        let mut numbers = body.expect("body").to_array();
        for (place, value) in [(22, -1.0), (23, f64::NAN), (24, -0.5)] {
            let before = std::mem::replace(&mut numbers[place], value);
            let read = RigidBody::from_array(&numbers);
            assert!(matches!(read, Err(Error::OutOfDomain { .. })), "{read:?}");
            numbers[place] = before;
        }
    }
}
