//! What was added between two numbers of particles, and which two such pieces become one.

use super::moments::Moments;
use crate::error::{BodyFault, Error};
use crate::mass::particles::{Particles, check};
use crate::numerics::reduce::BLOCK;

/// A block as a number of particles.
pub(super) const WHOLE: u64 = BLOCK as u64;

/// The particles from some number up to `end`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) end: u64,
    pub(super) matter: Matter,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Matter {
    /// Part of a block.
    Loose {
        masses: Vec<f64>,
        positions: Vec<[f64; 3]>,
    },
    Summed(Moments),
}

impl Matter {
    pub(super) fn moments(&self) -> Result<Moments, Error> {
        match self {
            Self::Loose { masses, positions } => Moments::of(Particles::new(masses, positions)),
            Self::Summed(moments) => Ok(*moments),
        }
    }

    /// Two pieces of one kind that meet.
    pub(super) fn joined(self, right: Self) -> Self {
        match (self, right) {
            (Self::Summed(left), Self::Summed(right)) => Self::Summed(left.merged(&right)),
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
pub(super) fn joins(left: &Matter, right: &Matter, [start, middle, end]: [u64; 3]) -> bool {
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
pub(super) fn check_loose(particles: Particles<'_>) -> Result<(), Error> {
    match check(particles) {
        Err(Error::Body(BodyFault::NoMass { .. })) => Ok(()),
        checked => checked,
    }
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
