//! Particles that say which body they belong to: haloes, fragments, residues.

use super::list::Particles;
use super::stack::particle_stack;
use crate::error::{BodyFault, Error};
use crate::mass::body::RigidBody;
use crate::numerics::threads::Watch;

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
