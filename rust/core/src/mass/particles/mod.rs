//! Bodies made of particles: `I = Σ m (r² 1 − r rᵀ)` (mln25).
//!
//! | file | idea |
//! |---|---|
//! | `sums.rs` | the sums, eight particles side by side |
//! | `stack.rs` | many bodies at a time; frames of a trajectory |
//! | `extreme.rs` | particles too small, too far apart, too light or too heavy to be squared |
//! | `labelled.rs` | particles that say which body they belong to |
//!
//! One pass over an ordinary body, about a point that a few of its particles are asked for; a thin one is summed again in
//! its own axes. The same bits for any number of threads, and for a body alone or in any stack.

mod extreme;
mod labelled;
mod stack;
pub(crate) mod sums;

use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use self::extreme::in_units;
use self::sums::{Addend, Central, MOMENTS, Turned, block_sums};
use super::body::RigidBody;
use super::error_bound::ErrorBound;
use super::second_moment::SecondMoment;
use crate::error::{Error, finite};
use crate::mass::provenance::Provenance;
use crate::numerics::reduce::sum_blocks;

pub use labelled::labelled_particles;
pub use stack::{Particles, particle_stack};

/// Below this ratio of smallest to largest principal moment a body is thin: the smallest would lose digits in one pass.
const THIN: f64 = 0.05;

/// How many particles are asked for the point that the sums are taken about.
const SAMPLE: usize = 16;

pub use crate::numerics::threads::Watch;

/// The body of the particles with these masses at these positions.
///
/// One pass gives mass, centre of mass and second moment. For a thin body a second pass takes the second moment again in
/// the axes that the first one found, which leaves the smallest principal moment as accurate as the coordinates are.
///
/// # Errors
/// When a mass is negative, the total is not positive, or a number is not finite.
///
/// # Panics
/// When the slices differ in length.
pub fn particles(masses: &[f64], positions: &[[f64; 3]]) -> Result<RigidBody, Error> {
    particles_watched(masses, positions, &mut |_| ControlFlow::Continue(()))
}

/// As [`particles`]; about every 20 ms `watch` is asked whether to go on.
///
/// # Errors
/// As [`particles`], and [`Error::Stopped`] when `watch` said so.
///
/// # Panics
/// When the slices differ in length.
pub fn particles_watched(
    masses: &[f64],
    positions: &[[f64; 3]],
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    let particles = Particles::new(masses, positions);
    let provenance = Provenance::of_particles(masses.len());
    let matter = about_center(particles, watch)?;
    if !is_ordinary(&matter, particles) {
        return in_units(particles, watch);
    }
    let body = RigidBody::from_second_moment(&matter)?;
    if is_thin(&body) {
        let again = RigidBody::from_second_moment(&in_own_axes(particles, &body, watch)?)?;
        return Ok(again.with_provenance(provenance.in_own_axes()));
    }
    Ok(body.with_provenance(provenance))
}

/// Whether one pass cost the smallest moment digits: its error is relative to the largest.
pub(super) fn is_thin(body: &RigidBody) -> bool {
    let [smallest, _, largest] = body.principal().moments;
    smallest < THIN * largest
}

/// From 2⁻⁸⁰⁰ to 2¹⁰⁰⁰.
pub(super) const ORDINARY: std::ops::Range<f64> =
    f64::from_bits((1023 - 800) << 52)..f64::from_bits((1023 + 1000) << 52);

/// Whether nothing can have under- or overflowed on the way to these moments.
///
/// A product m d below the normal numbers is off by 2⁻¹⁰⁷⁵ at most, and so is m d·d by d times as much. A particle that
/// has any mass has 2⁻¹⁰⁷⁴ at least, so d is at most √(2¹⁰⁷⁴ tr S): all such errors together are below
/// n·2⁻⁵³⁸ √(tr S), which is nothing beside the roundings of a trace of 2⁻⁸⁰⁰. What overflowed is not finite.
pub(super) fn is_ordinary(matter: &SecondMoment, particles: Particles<'_>) -> bool {
    let (spread, center) = (matter.central.trace(), matter.center_of_mass);
    let is_point = spread == 0.0 && particles.masses.len() == 1;
    let is_matter = ORDINARY.contains(&spread) && ORDINARY.contains(&(spread / matter.mass));
    ORDINARY.contains(&matter.mass)
        && (is_matter || is_point)
        && center.iter().all(|x| x.is_finite())
}

/// Second moment about the centre of mass in body axes.
fn about_center(particles: Particles<'_>, watch: &mut Watch<'_>) -> Result<SecondMoment, Error> {
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
fn in_own_axes(
    particles: Particles<'_>,
    first: &RigidBody,
    watch: &mut Watch<'_>,
) -> Result<SecondMoment, Error> {
    let axes = first.principal().axes;
    second_moment(particles, first.center_of_mass(), Some(axes), watch)
}

/// Second moment about the centre of mass from sums about the reference point, in the given axes or in those of the body.
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

/// The centre of mass of a few particles spread over the list, of all when they are few: a point within or near the body,
/// so that nothing cancels wherever the body stands.
pub(super) fn sample_center(Particles { masses, positions }: Particles<'_>) -> Vector3<f64> {
    let count = masses.len();
    let stride = count.div_ceil(SAMPLE).max(1);
    let sample = || (0..count).step_by(stride);
    // From the heaviest of them, so that nothing cancels where another one is far away.
    let heaviest = sample().max_by(|&i, &j| masses[i].total_cmp(&masses[j]));
    let Some(base) = heaviest
        .filter(|&i| masses[i] > 0.0)
        .or_else(|| (0..count).max_by(|&i, &j| masses[i].total_cmp(&masses[j])))
    else {
        return Vector3::zeros();
    };
    let base = Vector3::from(positions[base]);
    let (mut mass, mut first) = (0.0, Vector3::zeros());
    for i in sample() {
        mass += masses[i];
        first += (Vector3::from(positions[i]) - base) * masses[i];
    }
    let center = base + first / mass;
    if center.iter().all(|x| x.is_finite()) {
        center
    } else {
        base
    }
}

/// The first particle that cannot be, where there is one.
pub(super) fn check(Particles { masses, positions }: Particles<'_>) -> Result<(), Error> {
    for (index, (&mass, position)) in masses.iter().zip(positions).enumerate() {
        finite("masses", mass)?;
        if mass < 0.0 {
            return Err(Error::NegativeMass { index, mass });
        }
        for &x in position {
            finite("positions", x)?;
        }
    }
    let mass = masses.iter().fold(0.0, |sum, mass| sum + mass);
    if mass > 0.0 {
        Ok(())
    } else {
        Err(Error::NoMass {
            count: masses.len(),
            mass,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_atomic_molecule() {
        // mex255: three m₁ on a triangle of side a, m₂ at height h above it.
        let (m1, m2, a, h) = (1.0, 3.0, 2.0, 1.5);
        let r = a / 3.0_f64.sqrt();
        let at = |k: f64| {
            let angle = k * 2.0 * std::f64::consts::PI / 3.0;
            [r * angle.cos(), r * angle.sin(), 0.0]
        };
        let body = particles(
            &[m1, m1, m1, m2],
            &[at(0.0), at(1.0), at(2.0), [0.0, 0.0, h]],
        )
        .expect("molecule");
        let inertia = body.inertia();
        assert!((inertia[(2, 2)] - m1 * a * a).abs() < 1e-14);
        let transverse = 0.5 * m1 * a * a + 3.0 * m1 * m2 / (3.0 * m1 + m2) * h * h;
        assert!((inertia[(0, 0)] - transverse).abs() < 1e-14);
    }

    #[test]
    fn oblique_rod_of_particles_is_thin_without_noise() {
        let direction = [3.0, 4.0, 12.0];
        let positions: Vec<[f64; 3]> = (-5..=5)
            .map(|k| direction.map(|x| x * f64::from(k)))
            .collect();
        let body = particles(&[1.0; 11], &positions).expect("rod");
        let [i1, i2, i3] = body.principal().moments;
        assert!(i1 / i3 < 1e-30, "{i1:e}");
        assert!((i2 / (169.0 * 110.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn weightless_particles_do_not_count() {
        for far in [[1e300, 0.0, 0.0], [0.0, -1e9, 1e9]] {
            let (mut masses, mut positions) = (vec![0.0; 5000], vec![far; 5000]);
            (masses[4321], positions[4321]) = (2.0, [1.0, 0.0, 0.0]);
            let body = particles(&masses, &positions).expect("point");
            assert_eq!(body.principal().moments, [0.0; 3]);
            assert_eq!(body.center_of_mass(), Vector3::x());
        }
    }

    #[test]
    fn a_light_particle_far_away_does_not_blur_the_others() {
        // The first particle of the sample is a million sizes away and weighs next to nothing.
        let mut positions = vec![[1e6, 0.0, 0.0]];
        let mut masses = vec![1e-30];
        for k in 0..200 {
            let angle = f64::from(k);
            positions.push([angle.cos(), angle.sin(), 0.0]);
            masses.push(1.0);
        }
        let body = particles(&masses, &positions).expect("ring");
        let alone = particles(&masses[1..], &positions[1..]).expect("ring");
        assert!((body.inertia() - alone.inertia()).abs().max() < 1e-13);
        assert!((body.inertia()[(2, 2)] - 200.0).abs() < 0.1);
    }
}
