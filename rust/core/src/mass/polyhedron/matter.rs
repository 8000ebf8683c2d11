//! The body of what was summed over simplices: solids, shells and wires.

use crate::error::Error;
use crate::mass::amount::Amount;
use crate::mass::body::RigidBody;
use crate::mass::error_bound::{ErrorBound, UNIT};
use crate::mass::second_moment::SecondMoment;
use crate::mass::simplex::{LocalFrame, Sums};
use crate::mass::units::{QUANTUM, Units};
use crate::numerics::power_of_two::exponent;

/// Whether the frame is the body's own to a tenth: another turn would save no digits.
pub(in crate::mass) fn is_settled(sums: &Sums) -> bool {
    let (s, c) = (sums.central(), sums.center());
    [(0, 1), (0, 2), (1, 2)]
        .iter()
        .all(|&(i, j)| s[(i, j)].powi(2) <= 0.01 * s[(i, i)] * s[(j, j)])
        && (0..3).all(|k| c[k].powi(2) <= s[(k, k)])
}

/// The mass of what has these sums, whose content is counted in `2^content`, and its units.
pub(in crate::mass) fn in_units(
    sums: &Sums,
    content: i32,
    amount: Amount,
) -> Result<(f64, Units), Error> {
    let length = exponent(sums.frame.unit);
    let (mass, power) = amount.mass_in_units(sums.content.abs())?;
    let of_content = match amount {
        Amount::Mass(_) => 0,
        Amount::Density(_) => content,
    };
    let units = Units {
        mass: power + of_content,
        length,
        place: 0,
    };
    Ok((mass, units))
}

/// The body of this mass with these sums, whose content is known to `relative`.
pub(in crate::mass) fn matter(
    sums: &Sums,
    mass: f64,
    relative: f64,
    bound: ErrorBound,
    units: Units,
) -> Result<RigidBody, Error> {
    let LocalFrame {
        reference,
        unit,
        axes,
    } = sums.frame;
    let axes_or = axes.unwrap_or_else(nalgebra::Matrix3::identity);
    let center_of_mass = reference + axes_or * sums.center() * unit;
    let central = sums.central() * mass;
    // First and second moments are off by as much as the content, times the extent once and twice.
    let extent = sums.extent.norm();
    let error_bound = ErrorBound {
        center_of_mass: 2.0 * (relative + 16.0 * UNIT) * extent * unit
            + 4.0 * UNIT * center_of_mass.amax()
            + QUANTUM,
        inertia: 10.0 * (relative + 16.0 * UNIT) * mass * extent.powi(2),
        ..bound
    };
    units.told(&RigidBody::from_second_moment(&SecondMoment {
        mass,
        center_of_mass,
        central,
        axes: axes_or,
        error_bound,
    })?)
}
