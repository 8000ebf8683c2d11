//! The volume of a cell, however flat, small or large it is.

use crate::numerics::expansion;
use crate::numerics::power_of_two::{exponent, halves, times_power_of_two};
use crate::numerics::split_vector::{SplitVector, determinant};

/// Six times a volume: `mantissa·2^exponent`, to a unit or two of rounding and to `error·2^exponent`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Volume {
    pub(super) mantissa: f64,
    pub(super) exponent: i32,
    pub(super) error: f64,
}

/// A determinant of numbers below two is as good as exact in doubled precision, unless it is less than this.
const FLAT: f64 = 1.0 / (1_u64 << 40) as f64;

/// A smaller one has lost digits to underflow, no more than `LOST`.
const FAINT: f64 = f64::MIN_POSITIVE * (1_u128 << 120) as f64;
const LOST: f64 = f64::MIN_POSITIVE;

/// `|det(b − a, c − a, d − a)|`.
pub(super) fn sixfold([a, b, c, d]: &[[f64; 3]; 4]) -> Volume {
    let edge = |to| SplitVector::difference(to, a);
    let mut edges = [edge(b), edge(c), edge(d)];
    let mut power = 0;
    // Each coordinate in its own unit: a cell that is thin along an axis is none.
    for k in 0..3 {
        let largest = edges.iter().fold(0.0_f64, |m, e| m.max(e.high[k].abs()));
        let own = exponent(largest);
        power += own;
        let [p, q] = halves(-own);
        for edge in &mut edges {
            edge.high[k] = edge.high[k] * p * q;
            edge.low[k] = edge.low[k] * p * q;
        }
    }
    let [u, v, w] = &edges;
    let mut det = determinant(u, v, w).abs();
    if det < FLAT {
        det = expansion::determinant(u, v, w).abs();
    }
    let own = exponent(det);
    Volume {
        mantissa: times_power_of_two(det, -own),
        exponent: own + power,
        error: if det < FAINT {
            times_power_of_two(LOST, -own)
        } else {
            0.0
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_along_an_axis_in_the_air_and_beyond_all_doubles() {
        let cell = |x: f64, y: f64, z: f64| [[0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        for (size, power) in [
            (1.0, 0),
            (2.0_f64.powi(-300), -300),
            (2.0_f64.powi(340), 340),
        ] {
            let found = sixfold(&cell(size, size, size));
            assert_eq!((found.mantissa, found.exponent), (1.0, 3 * power));
        }
        let plate = sixfold(&cell(1.0, 1.0, 2.0_f64.powi(-1000)));
        assert_eq!(
            (plate.mantissa, plate.exponent, plate.error),
            (1.0, -1000, 0.0)
        );
    }

    #[test]
    fn a_corner_one_unit_above_its_plane() {
        // d = (b + c)/2 lifted by 2⁻⁵³ off the plane x = y: twice the area of the base times the lift, over √2.
        let up = 2.0_f64.powi(-53);
        let found = sixfold(&[
            [0.25, 0.25, 0.0],
            [0.75, 0.75, 0.0],
            [0.25, 0.25, 1.0],
            [0.5, 0.5 + up, 0.5],
        ]);
        assert_eq!((found.mantissa, found.exponent), (1.0, -54));
    }

    #[test]
    fn what_underflow_has_taken_is_told() {
        let tiny = 2.0_f64.powi(-900);
        let found = sixfold(&[
            [0.0; 3],
            [1.0, 1.0, 1.0],
            [1.0, 1.0 + f64::EPSILON, 1.0],
            [
                tiny,
                tiny * (1.0 + f64::EPSILON),
                tiny * (1.0 - f64::EPSILON),
            ],
        ]);
        assert!(found.error > 0.0);
    }
}
