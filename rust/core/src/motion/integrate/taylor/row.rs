//! The series of one number with its derivatives.

use crate::motion::loads::variables::{Varied, WIDTH};

/// The highest order of series with derivatives.
pub(super) const ORDER: usize = 24;

/// The derivatives of one coefficient: a register of the widest machines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Slopes(pub(super) [f64; WIDTH]);

/// The coefficients of one number of the motion.
#[derive(Clone, Debug)]
pub(super) struct VariedCoefficients {
    pub(super) values: [f64; ORDER + 1],
    pub(super) slopes: [Slopes; ORDER + 1],
}

impl VariedCoefficients {
    /// All zero.
    pub(super) fn new() -> Self {
        Self {
            values: [0.0; ORDER + 1],
            slopes: [Slopes([0.0; WIDTH]); ORDER + 1],
        }
    }

    /// Sets the coefficient of order `k` to a number times a factor.
    #[inline(always)]
    pub(super) fn set(&mut self, k: usize, number: &Varied, factor: f64) {
        self.values[k] = number.value * factor;
        for n in 0..WIDTH {
            self.slopes[k].0[n] = number.slopes[n] * factor;
        }
    }

    /// The coefficient of order `k`.
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> Varied {
        Varied {
            value: self.values[k],
            slopes: self.slopes[k].0,
        }
    }
}
