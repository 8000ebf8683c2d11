//! Powers of two as units: moments are taken of numbers near one, and told in the user's units at the end.
//!
//! A body of 1e-90 has a volume of 1e-270 and moments of 1e-450; with a density of 1e200 the moments are numbers again.
//! What lies between must neither vanish nor overflow, so lengths and masses are first divided by powers of two, which
//! rounds nothing. Only what is told at the end can be too large or too small, and then that is said.

use super::body::RigidBody;
use super::error_bound::ErrorBound;
use crate::error::{BodyFault, Error};
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// The least step between two numbers, 2⁻¹⁰⁷⁴: what rounding below the normal numbers is worth.
pub(super) const QUANTUM: f64 = f64::from_bits(1);

/// Masses are counted in `2^mass`, lengths in `2^length`, the centre of mass in `2^place`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Units {
    pub(super) mass: i32,
    pub(super) length: i32,
    pub(super) place: i32,
}

impl Units {
    /// The body in the user's units.
    ///
    /// # Errors
    /// [`BodyFault::OutOfRange`] when mass or moments are beyond the largest number, or so small that digits are lost.
    pub(super) fn in_user_units(self, body: &RigidBody) -> Result<RigidBody, Error> {
        let moment = self.mass + 2 * self.length;
        let i3 = body.principal.moments[2];
        let told = Self::convert_number("mass", body.mass, self.mass)?;
        // A mass that rounding has touched is refused, one that is stored as it is may be as small as it likes.
        if told < f64::MIN_POSITIVE && times_power_of_two(told, -self.mass) != body.mass {
            return Err(Self::out_of_range("mass", body.mass, self.mass));
        }
        let largest = Self::convert_number("largest principal moment of inertia", i3, moment)?;
        if i3 > 0.0 && largest < f64::MIN_POSITIVE {
            let what = "largest principal moment of inertia";
            return Err(Self::out_of_range(what, i3, moment));
        }
        // Of what is no matter, as of surfaces that cross, other elements may be larger than the largest moment.
        let element = body.inertia.amax();
        Self::convert_number("largest element of the inertia tensor", element, moment)?;
        let mut principal = body.principal;
        principal.moments = principal.moments.map(|x| times_power_of_two(x, moment));
        let bound = body.error_bound;
        Ok(RigidBody {
            mass: told,
            center_of_mass: body
                .center_of_mass
                .map(|x| times_power_of_two(x, self.place)),
            inertia: body.inertia.map(|x| times_power_of_two(x, moment)),
            principal,
            error_bound: ErrorBound {
                mass: upward(bound.mass, self.mass),
                center_of_mass: upward(bound.center_of_mass, self.place),
                inertia: upward(bound.inertia, moment),
            },
            provenance: body.provenance,
        })
    }

    fn convert_number(what: &'static str, value: f64, power: i32) -> Result<f64, Error> {
        let told = times_power_of_two(value, power);
        if told.is_finite() {
            return Ok(told);
        }
        Err(Self::out_of_range(what, value, power))
    }

    fn out_of_range(what: &'static str, value: f64, power: i32) -> Error {
        let own = exponent(value);
        Error::Body(BodyFault::OutOfRange {
            what,
            mantissa: times_power_of_two(value, -own),
            exponent: own + power,
        })
    }
}

/// A bound in the user's units, with what rounding there may add; a number that was given has none.
fn upward(bound: f64, power: i32) -> f64 {
    if bound == 0.0 {
        return 0.0;
    }
    times_power_of_two(bound, power) + QUANTUM
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;

    fn convert(mass: i32, length: i32) -> Result<RigidBody, Error> {
        let moments = [1.0, 2.0, 2.5];
        let body =
            RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0);
        let place = 0;
        Units {
            mass,
            length,
            place,
        }
        .in_user_units(&body.expect("body"))
    }

    #[test]
    fn both_sides_of_the_range() {
        let limit = |outcome: Result<RigidBody, Error>, name: &str| match outcome {
            Err(Error::Body(BodyFault::OutOfRange { what, .. })) => {
                assert!(what.contains(name), "{what}");
            }
            other => panic!("expected a refusal, got {other:?}"),
        };
        // The largest moment is 1.25·2^(1 + mass + 2 length).
        assert_eq!(
            convert(0, 511).expect("in range").principal().moments[2],
            2.5 * 2.0_f64.powi(1022)
        );
        limit(convert(1, 511), "moment");
        let least = convert(-1, -511).expect("in range");
        assert_eq!(least.principal().moments[2], 1.25 * f64::MIN_POSITIVE);
        assert!(least.error_bound().inertia >= QUANTUM);
        limit(convert(-2, -511), "moment");
        // 2^-1074 is the least mass, and exact.
        assert_eq!(convert(-1074, 100).expect("in range").mass(), QUANTUM);
        limit(convert(-1075, 100), "mass");
        limit(convert(1024, -100), "mass");
    }

    #[test]
    fn the_number_is_told_beyond_the_range_too() {
        let message = convert(-2000, 0).expect_err("too small").to_string();
        assert!(message.contains("8.71e-603"), "{message}");
    }
}
