//! Bodies of more particles than fit into memory: chunk by chunk, on one machine or on many.
//!
//! Every particle has a number, its place in the whole. Whole blocks of 4096 are summed as they come and merged pairwise
//! like the digits of a binary counter; the particles of a block that is not complete yet are kept. So the result has the
//! same bits however the particles are cut into chunks and in whatever order the chunks come, and memory grows with the
//! logarithm of their number.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::particles::sums::{Addend, block_sums};
use super::particles::{ORDINARY, Particles, Watch, check, sample_center};
use super::provenance::Provenance;
use super::second_moment::SecondMoment;
use crate::error::{BodyFault, Error};
use crate::numerics::double_double::{DoubleDouble, two_sum};
use crate::numerics::eigen3::eigen3;
use crate::numerics::lane::Lane;
use crate::numerics::threads::{Halt, fill_blocks};
use crate::numerics::tree_sum::{BLOCK, depth};

// Particles in chunks, in whatever order they come, and the body of all of them.

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
    pieces: BTreeMap<u64, Piece>,
    /// Whether the places of the chunks were given, rather than one after the other.
    is_placed: bool,
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
            .map_err(|error| shift_index(error, odd.start))?;
        }
        let mut sums = vec![Moments::default(); (tail - head) / BLOCK];
        fill_blocks(&mut sums, SHARE, watch, |index, share| {
            for (block, sums) in (index..).zip(share) {
                let from = head + block * BLOCK;
                let range = from..from + BLOCK;
                *sums = Moments::of(Particles::new(&masses[range.clone()], &positions[range]))
                    .map_err(|error| shift_index(error, from))?;
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
        let matter = total.round(additions);
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
        let body = RigidBody::from_second_moment(&total.round(additions))?;
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
        // From the last on, the tree of `numerics::tree_sum`.
        let mut total = Moments::default();
        for piece in self.pieces.values().rev() {
            total = piece.matter.moments()?.merge(&total);
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
                (matter, start) = (left.matter.join(matter), from);
            } else if let Some(right) = self.pieces.get(&end)
                && joins(&matter, &right.matter, [start, end, right.end])
                && let Some(right) = self.pieces.remove(&end)
            {
                (matter, end) = (matter.join(right.matter), right.end);
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
fn shift_index(error: Error, by: usize) -> Error {
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

// What was added between two numbers of particles, and which two such pieces become one.

/// A block as a number of particles.
const WHOLE: u64 = BLOCK as u64;

/// The particles from some number up to `end`.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    end: u64,
    matter: Matter,
}

#[derive(Clone, Debug, PartialEq)]
enum Matter {
    /// Part of a block.
    Loose {
        masses: Vec<f64>,
        positions: Vec<[f64; 3]>,
    },
    Summed(Moments),
}

impl Matter {
    fn moments(&self) -> Result<Moments, Error> {
        match self {
            Self::Loose { masses, positions } => Moments::of(Particles::new(masses, positions)),
            Self::Summed(moments) => Ok(*moments),
        }
    }

    /// Two pieces of one kind that meet.
    fn join(self, right: Self) -> Self {
        match (self, right) {
            (Self::Summed(left), Self::Summed(right)) => Self::Summed(left.merge(&right)),
            (
                Self::Loose {
                    mut masses,
                    mut positions,
                },
                Self::Loose {
                    masses: more_masses,
                    positions: more_positions,
                },
            ) => {
                masses.extend(more_masses);
                positions.extend(more_positions);
                Self::Loose { masses, positions }
            }
            (left, _) => left,
        }
    }
}

/// Whether two pieces that meet become one: parts of the same block, the halves of a node of the tree, or sums of which
/// one belongs to no tree, because its accumulator was appended.
fn joins(left: &Matter, right: &Matter, [start, middle, end]: [u64; 3]) -> bool {
    let is_node = |from: u64, to: u64| {
        let count = to - from;
        count.is_multiple_of(WHOLE)
            && (count / WHOLE).is_power_of_two()
            && from.is_multiple_of(count)
    };
    match (left, right) {
        (Matter::Loose { .. }, Matter::Loose { .. }) => start / WHOLE == (end - 1) / WHOLE,
        (Matter::Summed(_), Matter::Summed(_)) => {
            is_node(start, end) && middle - start == end - middle
                || !is_node(start, middle)
                || !is_node(middle, end)
        }
        _ => false,
    }
}

/// Particles that a body may have; here their masses may all be zero.
fn check_loose(particles: Particles<'_>) -> Result<(), Error> {
    match check(particles) {
        Err(Error::Body(BodyFault::NoMass { .. })) => Ok(()),
        checked => checked,
    }
}

// Mass, centre of mass and second moment about it in double-double: what a chunk of particles leaves behind.

type Vector = [DoubleDouble; 3];

/// Where xx, xy, xz, yy, yz, zz stand in a symmetric matrix.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// How often a block is summed again at most.
const AGAIN: usize = 4;

/// m, C, and S = Σ m (r − c)(r − c)ᵀ, each to 2⁻¹⁰⁰ or so of the whole: enough that the smallest principal moment of a
/// rod 1e-8 as thick as long keeps fourteen digits, wherever the rod stands and whichever way it points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moments {
    mass: DoubleDouble,
    center: Vector,
    /// S: xx, xy, xz, yy, yz, zz.
    central: [DoubleDouble; 6],
}

impl Moments {
    /// Of at most a block of particles.
    fn of(particles: Particles<'_>) -> Result<Self, Error> {
        let mut reference = sample_center(particles);
        let mut found = Self::about(particles, reference)?;
        // A few particles far away may have drawn the sample out of the body.
        for _ in 0..AGAIN {
            let center = Vector3::from(found.center.map(DoubleDouble::rounded));
            let spread = found.central[0].high + found.central[3].high + found.central[5].high;
            if found.mass.high * (center - reference).norm_squared() <= spread {
                break;
            }
            reference = center;
            found = Self::about(particles, reference)?;
        }
        Ok(found)
    }

    fn about(particles: Particles<'_>, reference: Vector3<f64>) -> Result<Self, Error> {
        let (masses, positions) = (particles.masses, particles.positions);
        let sums = block_sums(masses, positions, Precise { reference });
        if !(sums[BELOW] == 0.0 && sums.iter().all(|sum| sum.is_finite())) {
            check(particles)?;
        }
        let sum = |k: usize| DoubleDouble::sum(sums[2 * k], sums[2 * k + 1]);
        let mass = sum(0);
        if mass.high == 0.0 {
            return Ok(Self::default());
        }
        let first = [sum(1), sum(2), sum(3)];
        let d = first.map(|first| first / mass);
        Ok(Self {
            mass,
            center: std::array::from_fn(|k| d[k] + reference[k].into()),
            central: std::array::from_fn(|k| {
                let (i, j) = PAIRS[k];
                sum(4 + k) - first[i] * d[j]
            }),
        })
    }

    /// Both together, from centre to centre: `S = S₁ + S₂ + μ d dᵀ`, μ = m₁m₂/(m₁+m₂), d = C₂ − C₁. Nothing cancels.
    fn merge(&self, other: &Self) -> Self {
        if self.mass.high == 0.0 {
            return *other;
        }
        let mass = self.mass + other.mass;
        let share = other.mass / mass;
        let reduced = self.mass * share;
        let d: Vector = std::array::from_fn(|k| other.center[k] - self.center[k]);
        Self {
            mass,
            center: std::array::from_fn(|k| self.center[k] + d[k] * share),
            central: std::array::from_fn(|k| {
                let (i, j) = PAIRS[k];
                self.central[k] + other.central[k] + reduced * d[i] * d[j]
            }),
        }
    }

    /// Rounded to doubles, in the principal axes so that the smallest moment survives; `additions` is the number that a
    /// particle has passed on its way here.
    fn round(&self, additions: f64) -> SecondMoment {
        let [xx, xy, xz, yy, yz, zz] = self.central.map(DoubleDouble::rounded);
        let center_of_mass = Vector3::from(self.center.map(DoubleDouble::rounded));
        let axes = eigen3(&Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)).vectors;
        let mass = self.mass.rounded();
        let spread = xx + yy + zz;
        let sums = of_sums(additions);
        SecondMoment {
            mass,
            center_of_mass,
            central: self.rotate(&axes),
            axes,
            error_bound: ErrorBound {
                mass: (2.0 * UNIT + sums) * mass,
                center_of_mass: sums * (spread / mass).sqrt() + 2.0 * UNIT * center_of_mass.amax(),
                inertia: (32.0 * UNIT + 2.0 * sums) * spread,
            },
        }
    }

    /// What rounding can have done to each of these principal moments of the rounded body: a few units of itself, and what
    /// the sums in double-double have lost of the whole.
    fn moment_bounds(&self, moments: [f64; 3], additions: f64) -> [f64; 3] {
        let spread = self.central[0].high + self.central[3].high + self.central[5].high;
        // A principal value changes by no more than the matrix, whose norm is at most three times its largest element, and
        // a moment is the sum of two.
        moments.map(|moment| 64.0 * UNIT * moment + 6.0 * of_sums(additions) * spread)
    }

    /// `axesᵀ S axes`, rounded last. Axes that are orthogonal but for rounding change each principal value by as small a
    /// part of itself (Ostrowski's theorem).
    fn rotate(&self, axes: &Matrix3<f64>) -> Matrix3<f64> {
        let mut s = [[DoubleDouble::default(); 3]; 3];
        for (&(i, j), &element) in PAIRS.iter().zip(&self.central) {
            (s[i][j], s[j][i]) = (element, element);
        }
        let axis = |k: usize| -> Vector { std::array::from_fn(|i| axes[(i, k)].into()) };
        let dot = |a: Vector, b: Vector| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let mut turned = Matrix3::zeros();
        for (i, j) in PAIRS {
            let element = dot(axis(i), s.map(|row| dot(row, axis(j)))).rounded();
            (turned[(i, j)], turned[(j, i)]) = (element, element);
        }
        turned
    }
}

/// Bound on the part of itself that a sum in double-double can lose, when its terms pass so many additions: the rests add up
/// in plain doubles, so their own rounding grows with the square (Ogita, Rump, Oishi 2005).
fn of_sums(additions: f64) -> f64 {
    2.0 * UNIT * UNIT * (additions * additions + 64.0)
}

/// Ten sums in two doubles each, m; m d (3); m d dᵀ (6); and the masses below zero.
const SUMS: usize = 21;

const BELOW: usize = 20;

/// Moments about a point with all rounding errors of differences, products and sums carried along: `d = r − reference`.
#[derive(Clone, Copy)]
struct Precise {
    reference: Vector3<f64>,
}

impl Addend<SUMS> for Precise {
    #[inline(always)]
    fn add<L: Lane>(&self, mass: L, r: [L; 3], sums: [L; SUMS]) -> [L; SUMS] {
        let c = &self.reference;
        let d = [
            two_sum(r[0], L::new(-c.x)),
            two_sum(r[1], L::new(-c.y)),
            two_sum(r[2], L::new(-c.z)),
        ];
        let md = [times(mass, d[0]), times(mass, d[1]), times(mass, d[2])];
        let zero = L::new(0.0);
        let mut sums = sums;
        add_to(&mut sums, 0, (mass, zero));
        add_to(&mut sums, 1, md[0]);
        add_to(&mut sums, 2, md[1]);
        add_to(&mut sums, 3, md[2]);
        add_to(&mut sums, 4, product(md[0], d[0]));
        add_to(&mut sums, 5, product(md[0], d[1]));
        add_to(&mut sums, 6, product(md[0], d[2]));
        add_to(&mut sums, 7, product(md[1], d[1]));
        add_to(&mut sums, 8, product(md[1], d[2]));
        add_to(&mut sums, 9, product(md[2], d[2]));
        sums[BELOW] = sums[BELOW] + mass.min(zero);
        sums
    }

    #[inline(always)]
    fn merge(a: [f64; SUMS], b: [f64; SUMS]) -> [f64; SUMS] {
        let mut merged = [a[BELOW] + b[BELOW]; SUMS];
        for k in (0..BELOW).step_by(2) {
            let sum = DoubleDouble::sum(a[k], a[k + 1]) + DoubleDouble::sum(b[k], b[k + 1]);
            (merged[k], merged[k + 1]) = (sum.high, sum.low);
        }
        merged
    }
}

/// A double times a double and a rest.
#[inline(always)]
fn times<L: Lane>(a: L, (b, b_rest): (L, L)) -> (L, L) {
    let (p, e) = a.two_product(b);
    (p, a.mul_add(b_rest, e))
}

/// The product of two doubles with rests, but for that of the rests.
#[inline(always)]
fn product<L: Lane>((a, a_rest): (L, L), (b, b_rest): (L, L)) -> (L, L) {
    let (p, e) = a.two_product(b);
    (p, a.mul_add(b_rest, a_rest.mul_add(b, e)))
}

/// Adds a double and its rest to sum k.
#[inline(always)]
fn add_to<L: Lane>(sums: &mut [L; SUMS], k: usize, (term, rest): (L, L)) {
    let (sum, error) = two_sum(sums[2 * k], term);
    sums[2 * k] = sum;
    sums[2 * k + 1] = sums[2 * k + 1] + (error + rest);
}

// An accumulator as bytes, to be stored or sent: numbers in little-endian order after a line that says what they are.

const HEADER: &[u8] = b"polhode mass accumulator 1\n";

const LOOSE: u64 = 0;

const SUMMED: u64 = 1;

impl MassAccumulator {
    /// All that has been added, as bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = HEADER.to_vec();
        let mut put = |number: u64| bytes.extend(number.to_le_bytes());
        put(u64::from(self.is_placed));
        put(self.pieces.len() as u64);
        for (&start, piece) in &self.pieces {
            put(start);
            put(piece.end);
            match &piece.matter {
                Matter::Loose { masses, positions } => {
                    put(LOOSE);
                    let numbers = masses.iter().chain(positions.as_flattened());
                    numbers.for_each(|number| put(number.to_bits()));
                }
                Matter::Summed(moments) => {
                    put(SUMMED);
                    numbers(moments).for_each(|number| put(number.to_bits()));
                }
            }
        }
        bytes
    }

    /// The accumulator that [`Self::to_bytes`] wrote, the same to the last bit.
    ///
    /// # Errors
    /// [`BodyFault::NotAnAccumulator`] when the bytes are something else.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let fault = Error::Body(BodyFault::NotAnAccumulator);
        let body = bytes.strip_prefix(HEADER).ok_or(fault.clone())?;
        let (numbers, rest) = body.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(fault);
        }
        let mut numbers = numbers.iter().map(|bytes| u64::from_le_bytes(*bytes));
        let (Some(is_placed @ (0 | 1)), Some(count)) = (numbers.next(), numbers.next()) else {
            return Err(fault);
        };
        let mut pieces = BTreeMap::new();
        let mut free = 0;
        while let Some(start) = numbers.next() {
            let (Some(end), Some(kind)) = (numbers.next(), numbers.next()) else {
                return Err(fault);
            };
            if start < free || end <= start {
                return Err(fault);
            }
            free = end;
            let floats = numbers.by_ref().map(f64::from_bits);
            let matter = match kind {
                LOOSE if end - start < WHOLE => loose(floats, end - start),
                SUMMED => sum_matter(floats),
                _ => None,
            };
            let matter = matter.ok_or(fault.clone())?;
            pieces.insert(start, Piece { end, matter });
        }
        if pieces.len() as u64 != count {
            return Err(fault);
        }
        Ok(Self {
            pieces,
            is_placed: is_placed == 1,
        })
    }
}

fn numbers(moments: &Moments) -> impl Iterator<Item = f64> + '_ {
    let Moments {
        mass,
        center,
        central,
    } = moments;
    let all = std::iter::once(mass).chain(center).chain(central);
    all.flat_map(|number| [number.high, number.low])
}

fn loose(mut floats: impl Iterator<Item = f64>, count: u64) -> Option<Matter> {
    let masses: Vec<f64> = (0..count).map_while(|_| floats.next()).collect();
    let positions: Vec<[f64; 3]> = (0..count)
        .map_while(|_| Some([floats.next()?, floats.next()?, floats.next()?]))
        .collect();
    let is_whole = masses.len() as u64 == count && positions.len() == masses.len();
    if !is_whole || check_loose(Particles::new(&masses, &positions)).is_err() {
        return None;
    }
    Some(Matter::Loose { masses, positions })
}

fn sum_matter(mut floats: impl Iterator<Item = f64>) -> Option<Matter> {
    let mut number = || {
        let (high, low) = (floats.next()?, floats.next()?);
        let number = DoubleDouble::sum(high, low);
        (number == DoubleDouble { high, low }).then_some(number)
    };
    let mut moments = Moments {
        mass: number()?,
        ..Moments::default()
    };
    for place in moments.center.iter_mut().chain(&mut moments.central) {
        *place = number()?;
    }
    let is_matter = moments.mass.high >= 0.0 && numbers(&moments).all(f64::is_finite);
    is_matter.then_some(Matter::Summed(moments))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tree has the blocks 0 and 1 below one node, and 2 and 3; 1 and 2 never meet but within all four.
    #[test]
    fn only_the_halves_of_a_node_become_one() {
        let sum = Matter::Summed(Moments::default());
        let join = |blocks: [u64; 3]| joins(&sum, &sum, blocks.map(|block| block * WHOLE));
        assert!(join([0, 1, 2]) && join([2, 3, 4]) && join([0, 2, 4]));
        assert!(!join([1, 2, 3]) && !join([0, 2, 3]) && !join([3, 4, 6]));
        // What is no node comes from an accumulator that was appended.
        assert!(join([0, 3, 4]) && join([3, 4, 7]));
    }
}
