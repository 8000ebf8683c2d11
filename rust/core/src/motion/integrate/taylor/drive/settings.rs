//! The order of the series and the size of their last terms.

use crate::motion::loads::SeriesStructure;

/// Relative to the tolerance of a step, the size of the last term of its series: the terms left out are a quarter of that,
/// and at the tightest tolerance stay below the rounding of the state even where they all have the same sign.
const LAST_TERM: f64 = 0.05;

/// What all motions of a run have in common.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Settings {
    /// The highest order of the series.
    pub(super) order: usize,
    /// The size of their last terms as a logarithm to base 2.
    pub(super) last_term: f64,
    /// The ω that counts as much as the largest |ω| so far: absolute over relative tolerance.
    pub(super) floor: f64,
    pub(in super::super) parts: SeriesStructure,
}

impl Settings {
    /// For motions with derivatives, whose series say themselves how long a step may be.
    pub(in super::super) fn of_derivatives(order: usize, parts: SeriesStructure) -> Self {
        Self {
            order,
            last_term: 0.0,
            floor: 0.0,
            parts,
        }
    }

    /// For the equations that `parts` says, with the order at which the work is least: it grows with the square of the order, the step with
    /// `tolerance^(1/order)`. No order is above `highest`.
    pub(in super::super) fn new(
        relative: f64,
        absolute: f64,
        highest: usize,
        parts: SeriesStructure,
    ) -> Self {
        let nats = -(LAST_TERM * relative).ln();
        let mut halves = (4..highest / 2).filter(|&half| half as f64 + 1.0 <= 0.36 * nats);
        let order = 2 * halves.next_back().map_or(4, |half| half + 1);
        Self {
            order,
            last_term: (LAST_TERM * relative).log2(),
            floor: absolute / relative,
            parts,
        }
    }
}
