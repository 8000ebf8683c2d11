//! Bodies of particles by the thousand: molecules, fragments, the frames of a trajectory.

use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use super::single::{Particles, about_center, in_units, is_ordinary, particles_watched};
use crate::error::{BodyFault, Error};
use crate::mass::body::RigidBody;
use crate::mass::integrator::{Matter, is_thin, own_frame};
use crate::mass::provenance::Provenance;
use crate::mass::second_moment::SecondMoment;
use crate::numerics::eigen3::{Eigen3, eigen3_many};
use crate::numerics::threads::{Halt, Watch, fill_blocks};

/// Bodies whose tensors are decomposed side by side.
const BATCH: usize = 64;

/// Particles that a thread does at a time, where they make up more than one body.
const SHARE: usize = 1 << 15;

/// A body of more particles than this is shared among the threads, the smaller ones are shared out to them.
const LARGE: usize = 1 << 17;

/// The bodies `0..count`, each with the bits it has alone; `size` tells how many particles each has, `row` which.
///
/// About every 20 ms `watch` gets the fraction done and may end the work.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::particles::{Particles, particle_stack};
///
/// let positions = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
/// let masses = [[1.0, 1.0], [2.0, 2.0]];
/// let row = |k: usize| Particles::new(&masses[k], &positions);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let bodies = particle_stack(2, |_| 2, row, go_on).map_err(|(_, error)| error)?;
/// assert_eq!(bodies[1].inertia()[(2, 2)], 4.0);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// The first body that cannot be, with its index, [`Error::NoMemory`], or [`Error::Stopped`].
pub fn particle_stack<'a>(
    count: usize,
    size: impl Fn(usize) -> usize + Sync,
    row: impl Fn(usize) -> Particles<'a> + Sync,
    watch: &mut Watch<'_>,
) -> Result<Vec<RigidBody>, (usize, Error)> {
    // A point of unit mass stands in each place until it is filled.
    let point =
        RigidBody::from_principal(1.0, &[0.0; 3], &Matrix3::identity(), &Vector3::zeros(), 0.0);
    let mut bodies = Vec::new();
    let refused = |_| Error::NoMemory {
        what: "bodies",
        count,
        bytes: count as f64 * size_of::<RigidBody>() as f64,
    };
    (bodies.try_reserve_exact(count)).map_err(|error| (0, refused(error)))?;
    bodies.resize(count, point.map_err(|error| (0, error))?);
    let (mut largest, mut total) = (0, 0);
    for size in (0..count).map(&size) {
        (largest, total) = (size.max(largest), size + total);
    }
    let is_small = |index: usize| largest <= LARGE || size(index) <= LARGE;
    let rows = (count.saturating_mul(SHARE) / total.max(1)).clamp(1, BATCH);
    let outcome = fill_blocks(&mut bodies, rows, watch, |start, bodies| {
        let small: Vec<usize> = (0..bodies.len()).filter(|k| is_small(start + k)).collect();
        batch(&small, &|k| row(start + k), bodies).map_err(|(k, error)| (start + k, error))
    });
    let fault = match outcome {
        Ok(()) => None,
        Err(Halt::Stopped) => return Err((0, Error::Stopped)),
        Err(Halt::Failed(fault)) => Some(fault),
    };
    let before = fault.as_ref().map_or(count, |(index, _)| *index);
    for index in (0..before).filter(|&index| !is_small(index)) {
        let row = row(index);
        let body = particles_watched(row.masses, row.positions, watch);
        bodies[index] = body.map_err(|error| (index, error))?;
    }
    fault.map_or(Ok(bodies), Err)
}

/// Some of at most [`BATCH`] bodies on the calling thread, their tensors decomposed together.
fn batch<'a>(
    which: &[usize],
    row: &impl Fn(usize) -> Particles<'a>,
    bodies: &mut [RigidBody],
) -> Result<(), (usize, Error)> {
    let watch = &mut |_: f64| ControlFlow::Continue(());
    let count = which.len();
    let (mut particles, mut moments) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for &k in which {
        let row = row(k);
        moments.push(about_center(row, watch).map_err(|error| (k, error))?);
        if moments
            .last()
            .is_some_and(|matter| is_ordinary(matter, row))
        {
            particles.push((k, row));
        } else {
            moments.pop();
            bodies[k] = in_units(row, watch).map_err(|error| (k, error))?;
        }
    }
    decompose(&particles, &moments, |provenance| provenance, bodies)?;
    let is_thin = |&(k, _): &(usize, Particles<'_>)| is_thin(&bodies[k].principal());
    let thin: Vec<_> = particles.into_iter().filter(is_thin).collect();
    if thin.is_empty() {
        return Ok(());
    }
    moments.clear();
    for &(k, row) in &thin {
        let again = row.moments(&own_frame(&bodies[k]), watch);
        moments.push(again.map_err(|error| (k, error))?);
    }
    decompose(&thin, &moments, Provenance::in_own_axes, bodies)
}

/// At most [`BATCH`] bodies with these second moments, each in its place.
fn decompose(
    particles: &[(usize, Particles<'_>)],
    moments: &[SecondMoment],
    provenance: impl Fn(Provenance) -> Provenance,
    bodies: &mut [RigidBody],
) -> Result<(), (usize, Error)> {
    let mut matrices = [[0.0; 9]; BATCH];
    let (mut values, mut vectors) = ([[0.0; 3]; BATCH], [[0.0; 9]; BATCH]);
    let count = moments.len();
    for (matrix, matter) in matrices.iter_mut().zip(moments) {
        // The columns of a symmetric matrix are its rows, and only the lower triangle of rows is read.
        matrix.copy_from_slice(matter.central.transpose().as_slice());
    }
    eigen3_many(
        &matrices[..count],
        &mut values[..count],
        &mut vectors[..count],
    );
    for (i, (&(k, row), matter)) in particles.iter().zip(moments).enumerate() {
        let spectrum = Eigen3 {
            values: values[i],
            vectors: Matrix3::from_row_slice(&vectors[i]),
        };
        let body = &mut bodies[k];
        *body = RigidBody::with_spectrum(matter, &spectrum).map_err(|error| (k, error))?;
        body.provenance = provenance(Provenance::of_particles(row.masses.len()));
    }
    Ok(())
}

// Particles that say which body they belong to: haloes, fragments, residues.

/// The label of a particle that belongs to no body.
const NO_BODY: i64 = -1;

/// Particles between two looks at `watch`.
const STRETCH: usize = 1 << 16;

/// Body k is made of the particles with the label k; those with the label −1 belong to none.
///
/// One pass over the particles brings those of each body together, in their order, unless they stand so already. Each body
/// then has the bits that [`particles`](super::particles) gives its particles alone.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::particles::labelled_particles;
///
/// let (masses, labels) = ([1.0, 2.0, 4.0], [0, 1, 0]);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let bodies = labelled_particles(&masses, &[[0.0; 3]; 3], &labels, go_on).map_err(|(_, error)| error)?;
/// assert_eq!((bodies[0].mass(), bodies[1].mass()), (5.0, 2.0));
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`BodyFault::Label`] for a number below −1, the first body that cannot be, with its index, or [`Error::Stopped`]. Every
/// label from zero to the largest must own some mass.
///
/// # Panics
/// When the slices differ in length.
pub fn labelled_particles(
    masses: &[f64],
    positions: &[[f64; 3]],
    labels: &[i64],
    watch: &mut Watch<'_>,
) -> Result<Vec<RigidBody>, (Option<usize>, Error)> {
    assert_eq!(masses.len(), positions.len(), "one position for each mass");
    assert_eq!(masses.len(), labels.len(), "one label for each mass");
    let ends = ends_of_bodies(labels).map_err(|error| (None, error))?;
    let bodies = ends.len().saturating_sub(1);
    let size = |k: usize| ends[k + 1] - ends[k];
    let named = |(index, error)| (Some(index), error);
    if labels.is_sorted() {
        let skipped = labels.partition_point(|&label| label == NO_BODY);
        let row = |k: usize| {
            let range = skipped + ends[k]..skipped + ends[k + 1];
            Particles::new(&masses[range.clone()], &positions[range])
        };
        return particle_stack(bodies, size, row, watch).map_err(named);
    }
    let owned = ends.last().copied().unwrap_or(0);
    let (mut own_masses, mut own_positions) = (vec![0.0; owned], vec![[0.0; 3]; owned]);
    let mut next = ends.clone();
    for start in (0..labels.len()).step_by(STRETCH) {
        if watch(0.0).is_break() {
            return Err((None, Error::Stopped));
        }
        for i in start..labels.len().min(start + STRETCH) {
            let body = usize::try_from(labels[i]).unwrap_or(usize::MAX);
            if let Some(next) = next[..bodies].get_mut(body) {
                own_masses[*next] = masses[i];
                own_positions[*next] = positions[i];
                *next += 1;
            }
        }
    }
    let row = |k: usize| {
        let range = ends[k]..ends[k + 1];
        Particles::new(&own_masses[range.clone()], &own_positions[range])
    };
    particle_stack(bodies, size, row, watch).map_err(named)
}

/// The labels that name a body, ascending, and for each particle the rank of its label among them.
///
/// The ranks are labels without gaps, as [`labelled_particles`] takes them; the label −1 stays what it is.
///
/// # Examples
///
/// ```
/// use polhode::mass::particles::label_ranks;
///
/// assert_eq!(label_ranks(&[1007, 4, -1, 1007]), (vec![4, 1007], vec![1, 0, -1, 1]));
/// ```
#[must_use]
pub fn label_ranks(labels: &[i64]) -> (Vec<i64>, Vec<i64>) {
    let mut names = labels.to_vec();
    names.sort_unstable();
    names.dedup();
    names.retain(|&name| name != NO_BODY);
    let rank = |label: &i64| {
        names
            .binary_search(label)
            .ok()
            .and_then(|rank| rank.try_into().ok())
    };
    let ranks = labels
        .iter()
        .map(|label| rank(label).unwrap_or(NO_BODY))
        .collect();
    (names, ranks)
}

/// Where the particles of each body begin when they are brought together, and after the last body where they end.
fn ends_of_bodies(labels: &[i64]) -> Result<Vec<usize>, Error> {
    if let Some(index) = labels.iter().position(|&label| label < NO_BODY) {
        let label = labels[index];
        return Err(BodyFault::Label { index, label }.into());
    }
    // Of more bodies than particles one has none: counting as many is enough to find it.
    let largest = labels.iter().copied().max().unwrap_or(NO_BODY);
    let bodies = usize::try_from(largest).map_or(0, |label| label.min(labels.len()) + 1);
    let mut ends = vec![0; bodies + 1];
    for &label in labels {
        let body = usize::try_from(label).unwrap_or(usize::MAX);
        if let Some(count) = ends[1..].get_mut(body) {
            *count += 1;
        }
    }
    for k in 0..bodies {
        ends[k + 1] += ends[k];
    }
    Ok(ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_bodies_than_memory_are_refused_before_any_is_made() {
        let go_on = &mut |_| ControlFlow::Continue(());
        let row = |_| Particles::new(&[1.0], &[[0.0; 3]]);
        match particle_stack(1 << 50, |_| 1, row, go_on) {
            Err((0, Error::NoMemory { count, bytes, .. })) => {
                assert_eq!(count, 1 << 50);
                assert!(bytes > 1e17);
            }
            other => panic!(
                "expected a refusal, got {:?}",
                other.map(|bodies| bodies.len())
            ),
        }
        assert_eq!(
            particle_stack(3, |_| 1, row, go_on).expect("bodies").len(),
            3
        );
    }
}
