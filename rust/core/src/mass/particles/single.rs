//! The particles of one body: what they must be, and a point near them all.

use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use super::sums::{Addend, Central, CentralInAxes, MOMENTS, block_sums};
use crate::error::{BodyFault, Error, finite, finite_of_body};
use crate::mass::body::RigidBody;
use crate::mass::error_bound::ErrorBound;
use crate::mass::integrator::{Matter, integrate};
use crate::mass::provenance::Provenance;
use crate::mass::scaling::{QUANTUM, Units};
use crate::mass::second_moment::SecondMoment;
use crate::mass::simplex::LocalFrame;
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::threads::Watch;
use crate::numerics::tree_sum::sum_blocks;

/// How many particles are asked for the point that the sums are taken about.
const SAMPLE: usize = 16;

/// The particles of one body.
#[derive(Clone, Copy, Debug)]
pub struct Particles<'a> {
    pub(crate) masses: &'a [f64],
    pub(crate) positions: &'a [[f64; 3]],
    /// What underflow may have taken, in units of the heaviest and farthest; zero where nothing is so light or so near.
    faint: f64,
}

impl<'a> Particles<'a> {
    /// A mass for each position.
    ///
    /// # Panics
    /// When the slices differ in length.
    #[must_use]
    pub fn new(masses: &'a [f64], positions: &'a [[f64; 3]]) -> Self {
        assert_eq!(masses.len(), positions.len(), "one position for each mass");
        Self {
            masses,
            positions,
            faint: 0.0,
        }
    }
}

/// The first particle that cannot be, where there is one.
pub(in crate::mass) fn check(particles: Particles<'_>) -> Result<(), Error> {
    let (masses, positions) = (particles.masses, particles.positions);
    for (index, (&mass, position)) in masses.iter().zip(positions).enumerate() {
        finite_of_body("masses", mass)?;
        if mass < 0.0 {
            return Err(BodyFault::NegativeMass { index, mass }.into());
        }
        for &x in position {
            finite("positions", x)?;
        }
    }
    let mass = masses.iter().fold(0.0, |sum, mass| sum + mass);
    if mass > 0.0 {
        Ok(())
    } else {
        Err(BodyFault::NoMass {
            count: masses.len(),
            mass,
        }
        .into())
    }
}

/// The centre of mass of a few particles spread over the list, of all when they are few: a point within or near the body,
/// so that nothing cancels wherever the body stands.
// Inlined, with what it calls: a body of a few particles is done in the time of some calls.
#[inline]
pub(in crate::mass) fn sample_center(particles: Particles<'_>) -> Vector3<f64> {
    let masses = particles.masses;
    let stride = masses.len().div_ceil(SAMPLE).max(1);
    let heaviest = |among: &mut dyn Iterator<Item = usize>| {
        among.max_by(|&i, &j| masses[i].total_cmp(&masses[j]))
    };
    // Index by index: to say how many steps there are `step_by` would divide, which takes as long as the sample.
    let mut index = 0;
    let found = loop {
        match masses.get(index) {
            Some(&mass) if mass > 0.0 => break Some(index),
            Some(_) => index += stride,
            None => break None,
        }
    };
    let Some(first) = found else {
        let base = heaviest(&mut (0..masses.len()));
        return base.map_or_else(Vector3::zeros, |base| {
            center_from(particles, base, stride).1
        });
    };
    let (mass, center) = center_from(particles, first, stride);
    if masses[first] * LIGHT >= mass || mass.is_nan() {
        return center;
    }
    // A light one may be so far away that its distances from the others blur them.
    let sample = &mut (0..masses.len()).step_by(stride);
    let base = heaviest(sample).unwrap_or(first);
    center_from(particles, base, stride).1
}

/// A particle that is so many times lighter than all that are asked stands apart: one that is not makes the body
/// larger than a sixteenth of its distance from the others.
const LIGHT: f64 = 256.0;

/// Mass and centre of mass of every `stride`-th particle, by distances from the one with the index `base`; its own place
/// where they are beyond all numbers.
#[inline]
fn center_from(particles: Particles<'_>, base: usize, stride: usize) -> (f64, Vector3<f64>) {
    let (masses, positions) = (particles.masses, particles.positions);
    let base = Vector3::from(positions[base]);
    let (mut mass, mut first) = (0.0, Vector3::zeros());
    let mut i = 0;
    while i < masses.len() {
        mass += masses[i];
        first += (Vector3::from(positions[i]) - base) * masses[i];
        i += stride;
    }
    let center = base + first / mass;
    if center.iter().all(|x| x.is_finite()) {
        (mass, center)
    } else {
        (mass, base)
    }
}

// The second moment of particles about their centre of mass, and whether one pass was enough for it.

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
    let found = particles.moments(&LocalFrame::about(reference), watch)?;
    let d = found.center_of_mass - reference;
    if found.mass * d.norm_squared() <= found.central.trace() {
        return Ok(found);
    }
    // The sample stood outside of the body, and what its distance added has cost digits to take away.
    particles.moments(&LocalFrame::about(found.center_of_mass), watch)
}

impl Matter for Particles<'_> {
    type Moments = SecondMoment;

    /// Second moment about the centre of mass from sums about the reference point.
    #[inline]
    fn moments(&self, frame: &LocalFrame, watch: &mut Watch<'_>) -> Result<SecondMoment, Error> {
        let reference = frame.reference;
        let sums = match frame.axes {
            None => sum(*self, Central { reference }, watch)?,
            Some(axes) => sum(*self, CentralInAxes { reference, axes }, watch)?,
        };
        let [mass, x, y, z, xx, xy, xz, yy, yz, zz, below] = sums;
        if !(mass > 0.0 && below == 0.0 && sums.iter().all(|sum| sum.is_finite())) {
            check(*self)?;
        }
        let first = Vector3::new(x, y, z);
        let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let mut bound = ErrorBound::of_sums(self.masses.len(), mass, &reference, second.trace());
        bound.mass += self.faint;
        bound.center_of_mass += 8.0 * self.faint;
        bound.inertia += 32.0 * self.faint;
        let about = SecondMoment::about_reference(&Vector3::zeros(), mass, &first, &second, bound);
        let axes = frame.rotation();
        Ok(SecondMoment {
            center_of_mass: reference + axes * about.center_of_mass,
            axes,
            ..about
        })
    }
}

#[inline]
fn sum(
    particles: Particles<'_>,
    addend: impl Addend<MOMENTS>,
    watch: &mut Watch<'_>,
) -> Result<[f64; MOMENTS], Error> {
    let (masses, positions) = (particles.masses, particles.positions);
    Ok(sum_blocks(masses.len(), watch, |block| {
        block_sums(&masses[block.clone()], &positions[block], addend)
    })?)
}

// The body of one set of particles.

/// The body of the particles with these masses at these positions.
///
/// One pass gives mass, centre of mass and second moment. For a thin body a second pass takes the second moment again in
/// the axes that the first one found, which leaves the smallest principal moment as accurate as the coordinates are.
///
/// # Examples
///
/// ```
/// use polhode::mass::particles::particles;
///
/// // A dumb-bell: the reduced mass times the square of the distance.
/// let body = particles(&[1.0, 3.0], &[[0.0; 3], [0.0, 0.0, 2.0]])?;
/// assert_eq!(body.center_of_mass().z, 1.5);
/// assert!((body.principal().moments[2] - 0.75 * 4.0).abs() < 1e-15);
/// # Ok::<(), polhode::Error>(())
/// ```
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
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::particles::particles_watched;
///
/// let body = particles_watched(&[2.0], &[[1.0, 2.0, 3.0]], &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!((body.mass(), body.center_of_mass().z), (2.0, 3.0));
/// # Ok::<(), polhode::Error>(())
/// ```
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
    integrate(&particles, &matter, provenance, watch)
}

// Particles whose moments leave the range of float64 on their way: in units of their own size and mass.

/// The body of these particles, whatever their size and mass.
///
/// Those without mass are left out: they may be farther away than the others' unit of length can tell.
pub(super) fn in_units(
    particles: Particles<'_>,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    check(particles)?;
    let (masses, positions) = (particles.masses, particles.positions);
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
    let scaled = Particles {
        faint: QUANTUM * masses.len() as f64,
        ..Particles::new(&own_masses, &own_positions)
    };
    let provenance = Provenance::of_particles(masses.len());
    let matter = about_center(scaled, watch)?;
    units.in_user_units(&integrate(&scaled, &matter, provenance, watch)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn light_particles_far_away_are_no_point_to_start_from() {
        // Beside 15 of unit mass; the place is on neither side of the limit blurred by more than the body is large.
        for (mass, distance) in [
            (0.9, 1e17),
            (1.0 / 16.0, 1e17),
            (1.0 / 18.0, 1e17),
            (1e-30, 1e25),
        ] {
            let mut masses = vec![1.0; 16];
            let mut positions = vec![[1.0, 2.0, 3.0]; 16];
            (masses[0], positions[0]) = (mass, [distance, 0.0, 0.0]);
            let center = sample_center(Particles::new(&masses, &positions));
            let total = 15.0 + mass;
            let exact = [
                1.0 + mass * (distance - 1.0) / total,
                2.0 * 15.0 / total,
                3.0 * 15.0 / total,
            ];
            let gyration = distance * (15.0 * mass).sqrt() / total;
            for (x, exact) in center.iter().zip(exact) {
                assert!(
                    (x - exact).abs() <= 1e-14 * gyration.max(1.0),
                    "{mass:e}: {center:?}"
                );
            }
        }
    }

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
