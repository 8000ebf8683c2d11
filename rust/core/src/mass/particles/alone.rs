//! The body of one set of particles.

use std::ops::ControlFlow;

use super::about_center::{about_center, in_own_axes, is_ordinary, is_thin};
use super::extreme::in_units;
use super::list::Particles;
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::provenance::Provenance;
use crate::numerics::threads::Watch;

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
    let body = RigidBody::from_second_moment(&matter)?;
    if is_thin(&body) {
        let again = RigidBody::from_second_moment(&in_own_axes(particles, &body, watch)?)?;
        return Ok(again.with_provenance(provenance.in_own_axes()));
    }
    Ok(body.with_provenance(provenance))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

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
