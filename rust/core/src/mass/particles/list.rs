//! The particles of one body: what they must be, and a point near them all.

use nalgebra::Vector3;

use crate::error::{BodyFault, Error, finite, finite_of_body};

/// How many particles are asked for the point that the sums are taken about.
const SAMPLE: usize = 16;

/// The particles of one body.
#[derive(Clone, Copy, Debug)]
pub struct Particles<'a> {
    pub(crate) masses: &'a [f64],
    pub(crate) positions: &'a [[f64; 3]],
}

impl<'a> Particles<'a> {
    /// A mass for each position.
    ///
    /// # Panics
    /// When the slices differ in length.
    #[must_use]
    pub fn new(masses: &'a [f64], positions: &'a [[f64; 3]]) -> Self {
        assert_eq!(masses.len(), positions.len(), "one position for each mass");
        Self { masses, positions }
    }
}

/// The first particle that cannot be, where there is one.
pub(in crate::mass) fn check(Particles { masses, positions }: Particles<'_>) -> Result<(), Error> {
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
fn center_from(
    Particles { masses, positions }: Particles<'_>,
    base: usize,
    stride: usize,
) -> (f64, Vector3<f64>) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
