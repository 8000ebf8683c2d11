//! Particles in chunks, in whatever order they come, and the body of all of them.

use std::collections::BTreeMap;

use super::moments::Moments;
use super::pieces::{Matter, Piece, WHOLE, check_loose, joins};
use crate::error::{BodyFault, Error};
use crate::mass::body::RigidBody;
use crate::mass::particles::{ORDINARY, Particles, Watch};
use crate::mass::provenance::Provenance;
use crate::numerics::reduce::{BLOCK, depth};
use crate::numerics::threads::{Halt, fill_blocks};

/// Blocks that a thread does at a time.
const SHARE: usize = 4;

/// Particles in chunks, and in the end the body of all of them.
///
/// Second moments are kept in double-double: even a rod 1e-8 as thick as long keeps its smallest moment to 1e-14.
///
/// ```
/// use polhode::mass::MassAccumulator;
///
/// let mut sums = MassAccumulator::new();
/// sums.add(&[1.0], &[[0.0, 0.0, 0.0]], None, &mut |_| std::ops::ControlFlow::Continue(()))?;
/// sums.add(&[3.0], &[[4.0, 0.0, 0.0]], None, &mut |_| std::ops::ControlFlow::Continue(()))?;
/// assert_eq!(sums.finish()?.principal().moments, [0.0, 12.0, 12.0]);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MassAccumulator {
    /// What has been added, by the number of its first particle. None overlap, and what can be joined is.
    pub(super) pieces: BTreeMap<u64, Piece>,
    /// Whether the places of the chunks were given, rather than one after the other.
    pub(super) is_placed: bool,
}

impl MassAccumulator {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// How many particles have been added.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.pieces
            .iter()
            .map(|(start, piece)| piece.end - start)
            .sum()
    }

    /// The number after that of the last particle.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.pieces
            .last_key_value()
            .map_or(0, |(_, piece)| piece.end)
    }

    /// Adds particles; `start` is the number of the first in the whole, by default the one after the last.
    ///
    /// About every 20 ms `watch` gets the fraction done and may end the work; then, and after any error, nothing of the
    /// chunk is added.
    ///
    /// # Errors
    /// When a mass is negative, a number is not finite, a particle with that number is already there, or `watch` said stop.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn add(
        &mut self,
        masses: &[f64],
        positions: &[[f64; 3]],
        start: Option<u64>,
        watch: &mut Watch<'_>,
    ) -> Result<(), Error> {
        let _ = Particles::new(masses, positions);
        let first = start.unwrap_or_else(|| self.end());
        let count = masses.len() as u64;
        let end = behind(first, count)?;
        self.check_free(first, end)?;
        // Up to the first whole block, the whole blocks, and what is left.
        let to_block = first.wrapping_neg() % WHOLE;
        let head = usize::try_from(to_block.min(count)).unwrap_or(masses.len());
        let tail = head + (masses.len() - head) / BLOCK * BLOCK;
        for odd in [0..head, tail..masses.len()] {
            check_loose(Particles::new(
                &masses[odd.clone()],
                &positions[odd.clone()],
            ))
            .map_err(|error| shifted(error, odd.start))?;
        }
        let mut sums = vec![Moments::default(); (tail - head) / BLOCK];
        fill_blocks(&mut sums, SHARE, watch, |index, share| {
            for (block, sums) in (index..).zip(share) {
                let from = head + block * BLOCK;
                let range = from..from + BLOCK;
                *sums = Moments::of(Particles::new(&masses[range.clone()], &positions[range]))
                    .map_err(|error| shifted(error, from))?;
            }
            Ok(())
        })
        .map_err(|halt| match halt {
            Halt::Stopped => Error::Stopped,
            Halt::Failed(error) => error,
        })?;
        let at = |index: usize| first + index as u64;
        self.insert_loose(first, &masses[..head], &positions[..head])?;
        for (block, sums) in sums.into_iter().enumerate() {
            let start = at(head + block * BLOCK);
            self.insert(start, start + WHOLE, Matter::Summed(sums))?;
        }
        self.insert_loose(at(tail), &masses[tail..], &positions[tail..])?;
        self.is_placed |= start.is_some();
        Ok(())
    }

    /// Adds what another accumulator holds.
    ///
    /// Chunks whose places were given keep them; those of an accumulator without places come after the last particle here.
    /// Then the bits may depend on how the accumulators were merged, the result agrees within its bound.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::MassAccumulator;
    /// use std::ops::ControlFlow;
    ///
    /// let go_on = &mut |_| ControlFlow::Continue(());
    /// let (mut one, mut other) = (MassAccumulator::new(), MassAccumulator::new());
    /// other.add(&[3.0], &[[4.0, 0.0, 0.0]], Some(1), go_on)?; // the second particle, wherever it is summed
    /// one.add(&[1.0], &[[0.0; 3]], Some(0), go_on)?;
    /// one.merge(&other)?;
    /// assert_eq!(one.finish()?.principal().moments, [0.0, 12.0, 12.0]);
    /// // What rounding can have done to them, at most:
    /// assert!(one.moment_bounds()?.iter().all(|bound| *bound < 1e-13));
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When a particle with the same number is in both; then nothing is added.
    pub fn merge(&mut self, other: &Self) -> Result<(), Error> {
        let shift = if other.is_placed { 0 } else { self.end() };
        behind(shift, other.end())?;
        for (start, piece) in &other.pieces {
            self.check_free(start + shift, piece.end + shift)?;
        }
        for (start, piece) in &other.pieces {
            match &piece.matter {
                Matter::Loose { masses, positions } => {
                    self.insert_loose(start + shift, masses, positions)?;
                }
                Matter::Summed(_) => {
                    self.insert(start + shift, piece.end + shift, piece.matter.clone())?;
                }
            }
        }
        self.is_placed |= other.is_placed;
        Ok(())
    }

    /// Adds the next chunk, which another accumulator has summed at its place: as if it had been added here without one.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::MassAccumulator;
    /// use std::ops::ControlFlow;
    ///
    /// let go_on = &mut |_| ControlFlow::Continue(());
    /// let (mut first, mut second) = (MassAccumulator::new(), MassAccumulator::new());
    /// first.add(&[1.0], &[[0.0; 3]], None, go_on)?;
    /// second.add(&[3.0], &[[0.0, 0.0, 2.0]], None, go_on)?;
    /// // What is sent to another machine is bytes.
    /// let second = MassAccumulator::from_bytes(&second.to_bytes())?;
    /// first.merge_next(&second)?; // its particles count on from those of the first
    /// assert_eq!((first.count(), first.end()), (2, 2));
    /// assert_eq!(first.finish()?.center_of_mass().z, 1.5);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// As of [`merge`](Self::merge).
    pub fn merge_next(&mut self, next: &Self) -> Result<(), Error> {
        let is_placed = self.is_placed;
        self.merge(next)?;
        self.is_placed = is_placed;
        Ok(())
    }

    /// The body of all particles so far; more may be added afterwards.
    ///
    /// # Errors
    /// When particles before the last have not been added, or the total mass is not positive.
    pub fn finish(&self) -> Result<RigidBody, Error> {
        let (total, additions) = self.total()?;
        let matter = total.rounded(additions);
        let spread = matter.central.trace();
        // As of particles, but what underflowed in a chunk cannot be summed again.
        if spread != 0.0 && !ORDINARY.contains(&spread) {
            return Err(Error::OutOfDomain {
                what: "the sum of the second moments",
                law: "from 1.5e-241 to 1.0e+301, so that nothing under- or overflows on the way to it: add the particles in \
                      other units of length or mass",
                value: spread,
            });
        }
        let body = RigidBody::from_second_moment(&matter)?;
        body.check_possible()?;
        let count = usize::try_from(self.count()).unwrap_or(usize::MAX);
        Ok(body.with_provenance(Provenance::of_particles(count)))
    }

    /// Bounds on the errors of the principal moments of the body that [`Self::finish`] gives, against exact arithmetic on
    /// the very floats that were added. Of a rod thinner than 1e-8 they say how far its smallest moment can be trusted.
    ///
    /// # Errors
    /// As [`Self::finish`].
    pub fn moment_bounds(&self) -> Result<[f64; 3], Error> {
        let (total, additions) = self.total()?;
        let body = RigidBody::from_second_moment(&total.rounded(additions))?;
        Ok(total.moment_bounds(body.principal().moments, additions))
    }

    /// The moments of all particles, and how many additions one of them has passed at most.
    fn total(&self) -> Result<(Moments, f64), Error> {
        let mut next = 0;
        for (&start, piece) in &self.pieces {
            if start > next {
                return Err(BodyFault::MissingParticles {
                    start: next,
                    end: start,
                }
                .into());
            }
            next = piece.end;
        }
        // From the last on, the tree of `numerics::reduce`.
        let mut total = Moments::default();
        for piece in self.pieces.values().rev() {
            total = piece.matter.moments()?.merged(&total);
        }
        let count = usize::try_from(self.count()).unwrap_or(usize::MAX);
        let mass = total.mass.rounded();
        if mass > 0.0 {
            return Ok((total, depth(count)));
        }
        Err(BodyFault::NoMass { count, mass }.into())
    }

    /// Nothing in `start..end` yet.
    fn check_free(&self, start: u64, end: u64) -> Result<(), Error> {
        match self.pieces.range(..end).next_back() {
            Some((&from, piece)) if start < end && piece.end > start => Err(BodyFault::Overlap {
                start,
                end,
                from,
                to: piece.end,
            }
            .into()),
            _ => Ok(()),
        }
    }

    /// Particles, of any block or blocks.
    fn insert_loose(
        &mut self,
        mut start: u64,
        mut masses: &[f64],
        mut positions: &[[f64; 3]],
    ) -> Result<(), Error> {
        while !masses.is_empty() {
            let left = WHOLE - start % WHOLE;
            let count = usize::try_from(left).map_or(masses.len(), |left| left.min(masses.len()));
            let end = start + count as u64;
            let matter = Matter::Loose {
                masses: masses[..count].to_vec(),
                positions: positions[..count].to_vec(),
            };
            self.insert(start, end, matter)?;
            (masses, positions, start) = (&masses[count..], &positions[count..], end);
        }
        Ok(())
    }

    /// A piece in its place, joined with its neighbours as far as it goes.
    fn insert(&mut self, mut start: u64, mut end: u64, mut matter: Matter) -> Result<(), Error> {
        loop {
            if let Matter::Loose { .. } = matter
                && end - start == WHOLE
            {
                matter = Matter::Summed(matter.moments()?);
            }
            let before = self.pieces.range(..start).next_back();
            if let Some((&from, left)) = before
                && left.end == start
                && joins(&left.matter, &matter, [from, start, end])
                && let Some(left) = self.pieces.remove(&from)
            {
                (matter, start) = (left.matter.joined(matter), from);
            } else if let Some(right) = self.pieces.get(&end)
                && joins(&matter, &right.matter, [start, end, right.end])
                && let Some(right) = self.pieces.remove(&end)
            {
                (matter, end) = (matter.joined(right.matter), right.end);
            } else {
                self.pieces.insert(start, Piece { end, matter });
                return Ok(());
            }
        }
    }
}

/// The number after the last of `count` particles from the number `first` on.
fn behind(first: u64, count: u64) -> Result<u64, Error> {
    first.checked_add(count).ok_or(Error::OutOfDomain {
        what: "start",
        law: "such that the last particle's number is below 2^64",
        value: first as f64,
    })
}

/// The error of part of a chunk, its particles counted from the chunk's first.
fn shifted(error: Error, by: usize) -> Error {
    match error {
        Error::Body(BodyFault::NegativeMass { index, mass }) => {
            Error::Body(BodyFault::NegativeMass {
                index: index + by,
                mass,
            })
        }
        error => error,
    }
}
