//! What every homogeneous shape shares: an amount of matter, lengths, and the body of its second moment per unit mass.

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::ErrorBound;
use super::provenance::{BodySource, Checks, Provenance};
use super::scaling::Units;
use super::second_moment::SecondMoment;
use crate::error::{BodyFault, Error, finite, finite_of_body};
use crate::numerics::number::Real;
use crate::numerics::power_of_two::{exponent, halves, times_power_of_two};
use crate::numerics::split_vector::SplitVector;

/// How much matter: exactly one of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Total mass.
    Mass(f64),
    /// Mass per volume; of a lamina per area, of a rod per length.
    Density(f64),
}

impl Amount {
    /// The same as `mantissa·2^power` of a measure in some unit, so that neither a small volume times a large density nor the reverse leaves the range
    /// of float64.
    pub(super) fn mass_in_units(self, measure: f64) -> Result<(f64, i32), Error> {
        let value = self.check()?;
        let power = exponent(value);
        let own = times_power_of_two(value, -power);
        Ok(match self {
            Self::Mass(_) => (own, power),
            Self::Density(_) => (own * measure, power),
        })
    }

    /// Mass or density, positive and finite.
    pub(crate) fn check(self) -> Result<f64, Error> {
        let (what, value) = match self {
            Self::Mass(mass) => ("mass", mass),
            Self::Density(density) => ("density", density),
        };
        match self {
            Self::Mass(mass) => finite_of_body(what, mass)?,
            Self::Density(density) => finite(what, density)?,
        };
        if value <= 0.0 {
            return Err(Error::OutOfDomain {
                what,
                law: "positive",
                value,
            });
        }
        Ok(value)
    }
}

/// What a density is counted by, and how much of it a shape has.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub enum Measure<X> {
    /// Of a solid.
    Volume(X),
    /// Of a lamina.
    Area(X),
    /// Of a rod.
    Length(X),
}

impl<X> Measure<X> {
    /// The number itself.
    pub(super) fn value(self) -> X {
        match self {
            Self::Volume(value) | Self::Area(value) | Self::Length(value) => value,
        }
    }
}

impl Measure<f64> {
    fn name(self) -> &'static str {
        match self {
            Self::Volume(_) => "volume",
            Self::Area(_) => "area",
            Self::Length(_) => "length",
        }
    }

    /// How many lengths it is a product of, and the number.
    fn parts(self) -> (i32, f64) {
        match self {
            Self::Volume(value) => (3, value),
            Self::Area(value) => (2, value),
            Self::Length(value) => (1, value),
        }
    }

    /// The mass of the shape, whose lengths are counted in `unit`, as `mantissa·2^power`.
    fn mass(self, unit: Unit, amount: Amount) -> Result<(f64, i32), Error> {
        let (lengths, value) = self.parts();
        let (own, power) = amount.mass_in_units(value)?;
        if own == 0.0 {
            let what = self.name();
            return Err(BodyFault::Degenerate { what, value }.into());
        }
        let power = match amount {
            Amount::Mass(_) => power,
            Amount::Density(_) => power + lengths * unit.0,
        };
        let rest = exponent(own);
        Ok((times_power_of_two(own, -rest), power + rest))
    }
}

/// The unit `2^u` of a shape's lengths: their squares and their volume are numbers in it.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit(pub(super) i32);

/// Shapes with a length of more than `2^MODERATE`, or less than its inverse, have a unit of their own.
const MODERATE: i32 = 128;
/// In their unit the largest of the lengths is at most this power of two.
const LARGEST: i32 = 300;

impl Unit {
    /// That of lengths that are counted as they are.
    pub(super) const ONE: Self = Self(0);

    /// That of a shape with these lengths, and the lengths in it: between the largest and the least.
    #[inline]
    pub(super) fn of<const N: usize>(lengths: [f64; N]) -> (Self, [f64; N]) {
        let powers = (lengths.iter().filter(|&&length| length != 0.0)).map(|&x| exponent(x));
        let (least, most) = powers.fold((i32::MAX, i32::MIN), |(least, most), power| {
            (least.min(power), most.max(power))
        });
        if least > most || least >= -MODERATE && most <= MODERATE {
            return (Self(0), lengths);
        }
        let unit = i32::midpoint(least, most).max(most - LARGEST);
        (
            Self(unit),
            lengths.map(|length| times_power_of_two(length, -unit)),
        )
    }

    /// A vector of such lengths in it.
    pub(super) fn counts<const N: usize>(self, vector: &SplitVector<N>) -> SplitVector<N> {
        let [a, b] = halves(-self.0);
        vector.scaled(a).scaled(b)
    }
}

/// The body with C at the origin whose second moment per unit mass is this, in the unit of its lengths squared.
pub(super) fn body_of_shape(
    unit: Unit,
    measure: Measure<f64>,
    amount: Amount,
    per_mass: &Matrix3<f64>,
) -> Result<RigidBody, Error> {
    let source = match measure {
        Measure::Volume(_) => BodySource::Solid,
        Measure::Area(_) => BodySource::Lamina,
        Measure::Length(_) => BodySource::Rod,
    };
    let of_mass = |mass: f64| SecondMoment {
        mass,
        center_of_mass: Vector3::zeros(),
        central: per_mass * mass,
        axes: Matrix3::identity(),
        error_bound: closed_form(amount, mass, 2.0 * (mass * per_mass.trace())),
    };
    of_matter(unit, measure, amount, source, of_mass)
}

/// The body with the second moment that `of_mass` gives for the mass of a shape, its lengths counted in `unit` but for the
/// centre of mass.
pub(super) fn of_matter(
    unit: Unit,
    measure: Measure<f64>,
    amount: Amount,
    source: BodySource,
    of_mass: impl Fn(f64) -> SecondMoment,
) -> Result<RigidBody, Error> {
    let (own, power) = measure.mass(unit, amount)?;
    let provenance = Provenance::of_matter(source, 1, Checks::FINITE);
    if unit == Unit(0) && power.abs() <= 2 * LARGEST {
        let body = RigidBody::from_second_moment(&of_mass(times_power_of_two(own, power)))?;
        return Ok(body.with_provenance(provenance));
    }
    let units = Units {
        mass: power,
        length: unit.0,
        place: 0,
    };
    let body = RigidBody::from_second_moment(&of_mass(own))?;
    Ok(units.in_user_units(&body)?.with_provenance(provenance))
}

/// What a few operations can have done to mass and tensor; a mass that was given is exact.
pub(super) fn closed_form(amount: Amount, mass: f64, trace: f64) -> ErrorBound {
    let bound = ErrorBound::of_closed_form(mass, trace);
    match amount {
        Amount::Mass(_) => ErrorBound { mass: 0.0, ..bound },
        Amount::Density(_) => bound,
    }
}

/// A length is finite and not negative.
pub(super) fn length<X: Real>(what: &'static str, value: X) -> Result<(), Error> {
    let value = value.rounded();
    finite(what, value)?;
    if value < 0.0 {
        return Err(Error::OutOfDomain {
            what,
            law: "zero or more",
            value,
        });
    }
    Ok(())
}

/// Two lengths of which the first must not exceed the second.
pub(super) fn check_order<X: Real>(
    (smaller, a): (&'static str, X),
    (larger, b): (&'static str, X),
) -> Result<(), Error> {
    length(smaller, a)?;
    length(larger, b)?;
    let (a, b) = (a.rounded(), b.rounded());
    if a <= b {
        return Ok(());
    }
    Err(Error::OutOfOrder {
        smaller,
        a,
        larger,
        b,
    })
}

/// `a/b` for lengths `a ≤ b`, and 1 where both are zero: a point has whatever shape is asked of it.
pub(super) fn ratio<X: Real>(a: X, b: X) -> X {
    if b.rounded() == 0.0 { X::one() } else { a / b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_beyond_the_moderate_have_a_unit_between_them() {
        let two = |power: i32| 2.0_f64.powi(power);
        assert_eq!(Unit::of([0.0, 0.0]), (Unit(0), [0.0, 0.0]));
        let moderate = [two(MODERATE) * 1.5, two(-MODERATE)];
        assert_eq!(Unit::of(moderate), (Unit(0), moderate));
        let small = Unit::of([two(-MODERATE - 1), 0.0]);
        assert_eq!(small, (Unit(-MODERATE - 1), [1.0, 0.0]));
        assert_eq!(Unit::of([two(400), two(-100)]).0, Unit(150));
        // The largest stays below 2^LARGEST, however small the least is.
        assert_eq!(Unit::of([two(400), two(-1000)]).0, Unit(100));
        assert_eq!(Unit::of([two(200), two(-400)]).0, Unit(-100));
        assert_eq!(Unit::of([two(200), two(-401)]).0, Unit(-100));
    }
}
