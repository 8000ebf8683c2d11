//! The second moment of particles about their centre of mass, and whether one pass was enough for it.

use nalgebra::{Matrix3, Vector3};

use super::list::{Particles, check, sample_center};
use super::sums::{Addend, Central, MOMENTS, Turned, block_sums};
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::error_bound::ErrorBound;
use crate::mass::second_moment::SecondMoment;
use crate::numerics::reduce::sum_blocks;
use crate::numerics::threads::Watch;

/// Below this ratio of smallest to largest principal moment a body is thin: the smallest would lose digits in one pass.
const THIN: f64 = 0.05;

/// Whether one pass cost the smallest moment digits: its error is relative to the largest.
pub(in crate::mass) fn is_thin(body: &RigidBody) -> bool {
    let [smallest, _, largest] = body.principal().moments;
    smallest < THIN * largest
}

/// From 2⁻⁸⁰⁰ to 2¹⁰⁰⁰.
pub(in crate::mass) const ORDINARY: std::ops::Range<f64> =
    f64::from_bits((1023 - 800) << 52)..f64::from_bits((1023 + 1000) << 52);

/// From 2⁻⁴⁰⁰ to 2⁴⁰⁰: quotients of two such numbers are ordinary.
const TAME: std::ops::Range<f64> =
    f64::from_bits((1023 - 400) << 52)..f64::from_bits((1023 + 400) << 52);

/// Whether nothing can have under- or overflowed on the way to these moments.
///
/// A product m d below the normal numbers is off by 2⁻¹⁰⁷⁵ at most, and so is m d·d by d times as much. A particle that
/// has any mass has 2⁻¹⁰⁷⁴ at least, so d is at most √(2¹⁰⁷⁴ tr S): all such errors together are below
/// n·2⁻⁵³⁸ √(tr S), which is nothing beside the roundings of a trace of 2⁻⁸⁰⁰. What overflowed is not finite.
#[inline]
pub(super) fn is_ordinary(matter: &SecondMoment, particles: Particles<'_>) -> bool {
    let (spread, mass) = (matter.central.trace(), matter.mass);
    if !matter.center_of_mass.iter().all(|x| x.is_finite()) {
        return false;
    }
    if TAME.contains(&spread) && TAME.contains(&mass) {
        return true;
    }
    let is_point = spread == 0.0 && particles.masses.len() == 1;
    let is_matter = ORDINARY.contains(&spread) && ORDINARY.contains(&(spread / mass));
    ORDINARY.contains(&mass) && (is_matter || is_point)
}

/// Second moment about the centre of mass in body axes.
#[inline]
pub(super) fn about_center(
    particles: Particles<'_>,
    watch: &mut Watch<'_>,
) -> Result<SecondMoment, Error> {
    let reference = sample_center(particles);
    let found = second_moment(particles, reference, None, watch)?;
    let d = found.center_of_mass - reference;
    if found.mass * d.norm_squared() <= found.central.trace() {
        return Ok(found);
    }
    // The sample stood outside of the body, and what its distance added has cost digits to take away.
    second_moment(particles, found.center_of_mass, None, watch)
}

/// Second moment about the centre of mass in the principal axes of a first pass.
pub(super) fn in_own_axes(
    particles: Particles<'_>,
    first: &RigidBody,
    watch: &mut Watch<'_>,
) -> Result<SecondMoment, Error> {
    let axes = first.principal().axes;
    second_moment(particles, first.center_of_mass(), Some(axes), watch)
}

/// Second moment about the centre of mass from sums about the reference point, in the given axes or in those of the body.
#[inline]
fn second_moment(
    particles: Particles<'_>,
    reference: Vector3<f64>,
    axes: Option<Matrix3<f64>>,
    watch: &mut Watch<'_>,
) -> Result<SecondMoment, Error> {
    let sums = match axes {
        None => sum(particles, Central { reference }, watch)?,
        Some(axes) => sum(particles, Turned { reference, axes }, watch)?,
    };
    let [mass, x, y, z, xx, xy, xz, yy, yz, zz, below] = sums;
    if !(mass > 0.0 && below == 0.0 && sums.iter().all(|sum| sum.is_finite())) {
        check(particles)?;
    }
    let first = Vector3::new(x, y, z);
    let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let count = particles.masses.len();
    let bound = ErrorBound::of_sums(count, mass, &reference, second.trace());
    let about = SecondMoment::about_reference(&Vector3::zeros(), mass, &first, &second, bound);
    let axes = axes.unwrap_or_else(Matrix3::identity);
    Ok(SecondMoment {
        center_of_mass: reference + axes * about.center_of_mass,
        axes,
        ..about
    })
}

#[inline]
fn sum(
    particles: Particles<'_>,
    addend: impl Addend<MOMENTS>,
    watch: &mut Watch<'_>,
) -> Result<[f64; MOMENTS], Error> {
    let Particles { masses, positions } = particles;
    Ok(sum_blocks(masses.len(), watch, |block| {
        block_sums(&masses[block.clone()], &positions[block], addend)
    })?)
}
