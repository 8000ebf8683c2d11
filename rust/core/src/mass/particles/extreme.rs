//! Particles whose moments leave the range of float64 on their way: in units of their own size and mass.

use super::about_center::{about_center, in_own_axes, is_thin};
use super::list::{Particles, check};
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::provenance::Provenance;
use crate::mass::second_moment::SecondMoment;
use crate::mass::simplex::LocalFrame;
use crate::mass::units::{QUANTUM, Units};
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::threads::Watch;
use nalgebra::Vector3;

/// The body of these particles, whatever their size and mass.
///
/// Those without mass are left out: they may be farther away than the others' unit of length can tell.
pub(super) fn in_units(
    particles: Particles<'_>,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    check(particles)?;
    let Particles { masses, positions } = particles;
    let heavy = || (masses.iter().zip(positions)).filter(|(mass, _)| **mass > 0.0);
    let heaviest = heavy().fold(0.0_f64, |most, (&mass, _)| most.max(mass));
    let at = || heavy().map(|(_, &r)| Vector3::from(r));
    let low = at().fold(Vector3::repeat(f64::INFINITY), |low, r| low.inf(&r));
    let high = at().fold(Vector3::repeat(f64::NEG_INFINITY), |high, r| high.sup(&r));
    let length = exponent(LocalFrame::of_box(&low, &high).unit);
    let units = Units {
        mass: exponent(heaviest),
        length,
        place: length,
    };
    let own_masses: Vec<f64> = heavy()
        .map(|(&mass, _)| times_power_of_two(mass, -units.mass))
        .collect();
    let own_positions: Vec<[f64; 3]> = heavy()
        .map(|(_, r)| r.map(|x| times_power_of_two(x, -length)))
        .collect();
    let scaled = Particles::new(&own_masses, &own_positions);
    let provenance = Provenance::of_particles(masses.len());
    let count = masses.len() as f64;
    // What underflows of the lightest and nearest ones, in units of the heaviest and farthest.
    let faint = |matter: SecondMoment| {
        let mut bound = matter.error_bound;
        bound.mass += QUANTUM * count;
        bound.center_of_mass += 8.0 * QUANTUM * count;
        bound.inertia += 32.0 * QUANTUM * count;
        SecondMoment {
            error_bound: bound,
            ..matter
        }
    };
    let body = RigidBody::from_second_moment(&faint(about_center(scaled, watch)?))?;
    if is_thin(&body) {
        let matter = faint(in_own_axes(scaled, &body, watch)?);
        let again = RigidBody::from_second_moment(&matter)?;
        return units.told(&again.with_provenance(provenance.in_own_axes()));
    }
    units.told(&body.with_provenance(provenance))
}
