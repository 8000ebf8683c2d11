//! Bodies of particles by the thousand: molecules, fragments, the frames of a trajectory.

use std::ops::ControlFlow;

use super::{Watch, about_center, in_own_axes, is_thin, particles_watched};
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::second_moment::SecondMoment;
use crate::numerics::eigen3::{Eigen3, eigen3_many};
use crate::numerics::threads::{Halt, fill_blocks};

/// Bodies whose tensors are decomposed side by side.
const BATCH: usize = 64;

/// A body of more particles than this is shared among the threads, the smaller ones are shared out to them.
const LARGE: usize = 1 << 17;

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

/// The bodies `0..count`, each with the bits it has alone; `row` tells the particles of each.
///
/// About every 20 ms `watch` gets the fraction done and may end the work.
///
/// # Errors
/// The first body that cannot be, with its index, or [`Error::Stopped`].
pub fn particle_stack<'a>(
    count: usize,
    row: impl Fn(usize) -> Particles<'a> + Sync,
    watch: &mut Watch<'_>,
) -> Result<Vec<RigidBody>, (usize, Error)> {
    let is_large = |&index: &usize| row(index).masses.len() > LARGE;
    let (large, small): (Vec<_>, Vec<_>) = (0..count).partition(is_large);
    let mut batches: Vec<Vec<RigidBody>> = Vec::new();
    batches.resize_with(small.len().div_ceil(BATCH), Vec::new);
    let outcome = fill_blocks(&mut batches, 1, watch, |index, out| {
        let start = index * BATCH;
        let rows = &small[start..small.len().min(start + BATCH)];
        let particles: Vec<_> = rows.iter().map(|&index| row(index)).collect();
        out[0] = batch(&particles).map_err(|(k, error)| (rows[k], error))?;
        Ok(())
    });
    match outcome {
        Ok(()) => {}
        Err(Halt::Stopped) => return Err((0, Error::Stopped)),
        Err(Halt::Failed(fault)) => return Err(fault),
    }
    let mut small_bodies = batches.into_iter().flatten();
    if large.is_empty() {
        return Ok(small_bodies.collect());
    }
    let mut bodies = Vec::with_capacity(count);
    for index in large {
        bodies.extend(small_bodies.by_ref().take(index - bodies.len()));
        let Particles { masses, positions } = row(index);
        bodies.push(particles_watched(masses, positions, watch).map_err(|error| (index, error))?);
    }
    bodies.extend(small_bodies);
    Ok(bodies)
}

/// Few bodies on the calling thread, their tensors decomposed together.
fn batch(rows: &[Particles<'_>]) -> Result<Vec<RigidBody>, (usize, Error)> {
    let watch = &mut |_: f64| ControlFlow::Continue(());
    let mut moments = Vec::with_capacity(rows.len());
    for (k, &row) in rows.iter().enumerate() {
        moments.push(about_center(row, watch).map_err(|error| (k, error))?);
    }
    let mut bodies = Vec::with_capacity(rows.len());
    for (k, (matter, spectrum)) in moments.iter().zip(spectra(&moments)).enumerate() {
        bodies.push(RigidBody::with_spectrum(matter, &spectrum).map_err(|error| (k, error))?);
    }
    let thin: Vec<usize> = (0..rows.len()).filter(|&k| is_thin(&bodies[k])).collect();
    moments.clear();
    for &k in &thin {
        moments.push(in_own_axes(rows[k], &bodies[k], watch).map_err(|error| (k, error))?);
    }
    for (&k, (matter, spectrum)) in thin.iter().zip(moments.iter().zip(spectra(&moments))) {
        bodies[k] = RigidBody::with_spectrum(matter, &spectrum).map_err(|error| (k, error))?;
    }
    Ok(bodies)
}

/// The principal values and axes of at most [`BATCH`] second moments.
fn spectra(moments: &[SecondMoment]) -> impl Iterator<Item = Eigen3> + use<> {
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
    (0..count).map(move |k| Eigen3 {
        values: values[k],
        vectors: nalgebra::Matrix3::from_row_slice(&vectors[k]),
    })
}
