//! What every homogeneous shape shares: an amount of matter, lengths, and the body of its second moment per unit mass.

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::ErrorBound;
use super::provenance::{Checks, Provenance, Source};
use super::second_moment::SecondMoment;
use crate::error::{Error, finite};
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// How much matter: exactly one of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Total mass.
    Mass(f64),
    /// Mass per volume; of a lamina per area, of a rod per length.
    Density(f64),
}

impl Amount {
    /// The mass in a volume, an area or a length.
    ///
    /// # Errors
    /// When mass or density is not positive and finite.
    pub fn mass(self, measure: f64) -> Result<f64, Error> {
        let value = self.checked()?;
        Ok(match self {
            Self::Mass(_) => value,
            Self::Density(_) => value * measure,
        })
    }

    /// The same as `mantissa·2^power` of a measure in some unit, so that neither a small volume times a large density nor the reverse leaves the range
    /// of float64.
    pub(super) fn mass_in_units(self, measure: f64) -> Result<(f64, i32), Error> {
        let value = self.checked()?;
        let power = exponent(value);
        let own = times_power_of_two(value, -power);
        Ok(match self {
            Self::Mass(_) => (own, power),
            Self::Density(_) => (own * measure, power),
        })
    }

    /// Mass or density, positive and finite.
    fn checked(self) -> Result<f64, Error> {
        let (what, value) = match self {
            Self::Mass(mass) => ("mass", mass),
            Self::Density(density) => ("density", density),
        };
        finite(what, value)?;
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
#[derive(Clone, Copy, Debug)]
pub(super) enum Measure {
    Volume(f64),
    Area(f64),
    Length(f64),
}

impl Measure {
    /// The mass of the shape.
    pub(super) fn mass(self, amount: Amount) -> Result<f64, Error> {
        let (what, value) = match self {
            Self::Volume(value) => ("volume", value),
            Self::Area(value) => ("area", value),
            Self::Length(value) => ("length", value),
        };
        let mass = amount.mass(value)?;
        if mass == 0.0 {
            let law = "positive when density= is given (a degenerate shape takes mass=)";
            return Err(Error::OutOfDomain { what, law, value });
        }
        Ok(mass)
    }
}

/// The body with C at the origin whose second moment per unit mass is diagonal in the body axes.
pub(super) fn diagonal(
    measure: Measure,
    amount: Amount,
    per_mass: [f64; 3],
) -> Result<RigidBody, Error> {
    centered(
        measure,
        amount,
        &Matrix3::from_diagonal(&Vector3::from(per_mass)),
    )
}

/// The body with C at the origin whose second moment per unit mass is this.
pub(super) fn centered(
    measure: Measure,
    amount: Amount,
    per_mass: &Matrix3<f64>,
) -> Result<RigidBody, Error> {
    let mass = measure.mass(amount)?;
    let error_bound = closed_form(amount, mass, 2.0 * (mass * per_mass.trace()));
    let body = RigidBody::from_second_moment(&SecondMoment {
        mass,
        center_of_mass: Vector3::zeros(),
        central: per_mass * mass,
        axes: Matrix3::identity(),
        error_bound,
    })?;
    let source = match measure {
        Measure::Volume(_) => Source::Solid,
        Measure::Area(_) => Source::Lamina,
        Measure::Length(_) => Source::Rod,
    };
    Ok(body.with_provenance(Provenance::of_matter(source, 1, Checks::FINITE)))
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
pub(super) fn length(what: &'static str, value: f64) -> Result<f64, Error> {
    finite(what, value)?;
    if value < 0.0 {
        return Err(Error::OutOfDomain {
            what,
            law: "zero or more",
            value,
        });
    }
    Ok(value)
}

/// Two lengths of which the first must not exceed the second.
pub(super) fn ordered(
    (smaller, a): (&'static str, f64),
    (larger, b): (&'static str, f64),
) -> Result<(), Error> {
    length(smaller, a)?;
    length(larger, b)?;
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
pub(super) fn ratio(a: f64, b: f64) -> f64 {
    if b == 0.0 { 1.0 } else { a / b }
}
