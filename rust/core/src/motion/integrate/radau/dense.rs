//! The step as the polynomial of its collocation.

use nalgebra::SVector;

use super::stages::{Stages, combine};
use super::tableau::POLYNOMIAL;

/// The states during one step as a polynomial of degree 3 in time.
#[derive(Clone, Debug)]
pub(super) struct Dense<const N: usize> {
    start: f64,
    pub(super) step: f64,
    y: SVector<f64, N>,
    coefficients: Stages<N>,
}

impl<const N: usize> Dense<N> {
    pub(super) fn new(start: f64, step: f64, y: &SVector<f64, N>, stages: &Stages<N>) -> Self {
        let column = |k: usize| combine(&POLYNOMIAL.map(|row| row[k]), stages);
        Self {
            start,
            step,
            y: *y,
            coefficients: [column(0), column(1), column(2)],
        }
    }

    /// The state at `elapsed` since the start of the integration.
    pub(super) fn at(&self, elapsed: f64) -> SVector<f64, N> {
        let x = (elapsed - self.start) / self.step;
        let [first, second, third] = &self.coefficients;
        self.y + (first + (second + third * x) * x) * x
    }
}
