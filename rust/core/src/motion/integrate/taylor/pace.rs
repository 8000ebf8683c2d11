//! The length of a step with derivatives: as long as the series of the state and of each of its derivatives allow.

use super::row::{ORDER, VariedCoefficients};
use crate::motion::loads::variables::WIDTH;

/// The last terms of a series, relative to the largest that the series has been.
const LAST_TERM: f64 = 1e-17;
/// The first coefficients, which tell how large a derivative that is zero at the start is going to be.
const FIRST: usize = 5;
/// Rounds in which the step is found: each is closer by a factor of five or more.
const ROUNDS: usize = 4;

/// How large some numbers and their derivatives by each variable have been so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ConvergenceRadius {
    sizes: [f64; WIDTH + 1],
}

impl ConvergenceRadius {
    /// Comes to another unit: `ratio` of the old one to the new one.
    pub(super) fn rescale(&mut self, ratio: f64) {
        self.sizes = self.sizes.map(|size| size * ratio);
    }

    /// The longest step for which the last two terms of the series are small enough; infinite where they are zero, not a number
    /// where they are not. Rounded to a few bits, so that it is the same on every machine.
    ///
    /// What counts as large is what has been so far, or will be within the step: so that is found in a few rounds.
    /// Source: Jorba & Zou, Experimental Mathematics 14 (2005) 99.
    pub(super) fn longest_step(&mut self, rows: &[VariedCoefficients]) -> f64 {
        self.longest_step_of(&|k| sizes(rows, k))
    }

    /// The same, from the sums of magnitudes of the coefficients of each order.
    pub(super) fn longest_step_of(&mut self, sizes: &dyn Fn(usize) -> [f64; WIDTH + 1]) -> f64 {
        let first: [_; FIRST] = std::array::from_fn(sizes);
        for (most, size) in self.sizes.iter_mut().zip(first[0]) {
            *most = most.max(size);
        }
        let last = [ORDER - 1, ORDER].map(|k| (k, sizes(k)));
        if last
            .iter()
            .any(|(_, sizes)| sizes.iter().any(|size| !size.is_finite()))
        {
            return f64::NAN;
        }
        let mut h = 1.0_f64;
        for _ in 0..ROUNDS {
            let mut exponent = f64::INFINITY;
            for (number, most) in self.sizes.iter().enumerate() {
                let within = first
                    .iter()
                    .rev()
                    .fold(0.0, |sum, sizes| sum * h + sizes[number]);
                for (k, sizes) in &last {
                    let ratio = LAST_TERM * (most.max(within) / sizes[number]);
                    if sizes[number] > 0.0 {
                        exponent = exponent.min(ratio.log2() / *k as f64);
                    }
                }
            }
            h = exponent.exp2();
            if h.is_infinite() {
                break;
            }
        }
        f64::from_bits(h.to_bits() & 0xffff_0000_0000_0000)
    }
}

/// The sums of magnitudes of the coefficients of order `k`: of the values, and of each derivative.
fn sizes(rows: &[VariedCoefficients], k: usize) -> [f64; WIDTH + 1] {
    let mut sizes = [0.0; WIDTH + 1];
    for number in rows.iter().map(|row| row.get(k)) {
        let (values, slopes) = sizes.split_at_mut(1);
        values[0] += number.value.abs();
        for (size, slope) in slopes.iter_mut().zip(&number.slopes) {
            *size += slope.abs();
        }
    }
    sizes
}
