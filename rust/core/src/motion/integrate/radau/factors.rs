//! The matrices of Newton's iteration, factored.

use nalgebra::{Complex, DMatrix, SVector};

use super::tableau::{COMPLEX, REAL};
use super::triangles::Triangles;
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// `∂f/∂y`, and the sizes of the components of y.
#[derive(Clone, Debug)]
pub(super) struct Jacobian<const N: usize> {
    matrix: DMatrix<f64>,
    /// Exponents of the powers of two that are their units.
    units: SVector<i32, N>,
}

impl<const N: usize> Jacobian<N> {
    pub(super) fn zero() -> Self {
        Self {
            matrix: DMatrix::zeros(N, N),
            units: SVector::zeros(),
        }
    }

    /// The derivatives by component j, about as large as `size`, from a change of it.
    pub(super) fn set(&mut self, j: usize, size: f64, change: &SVector<f64, N>, by: f64) {
        self.units[j] = exponent(size);
        for i in 0..N {
            self.matrix[(i, j)] = change[i] / by;
        }
    }

    /// The matrix in units of the components and `2^time` of the time.
    fn in_units(&self, time: i32) -> DMatrix<f64> {
        DMatrix::from_fn(N, N, |i, j| {
            times_power_of_two(self.matrix[(i, j)], time + self.units[j] - self.units[i])
        })
    }
}

/// `γ/h − J` and `(α + iβ)/h − J`, factored, in the units of J and a unit of time near h: no product of pivots overflows or
/// underflows, and a pivot is large beside what it is to be compared with.
#[derive(Clone, Debug)]
pub(super) struct Factors<const N: usize> {
    pub(super) step: f64,
    /// Exponents of the powers of two that are the units.
    time: i32,
    units: SVector<i32, N>,
    real: Triangles<f64, N>,
    complex: Triangles<Complex<f64>, N>,
}

impl<const N: usize> Factors<N> {
    pub(super) fn of(jacobian: &Jacobian<N>, step: f64) -> Self {
        let time = exponent(step);
        let h = times_power_of_two(step, -time);
        let matrix = jacobian.in_units(time);
        let real = DMatrix::from_diagonal_element(N, N, REAL / h) - &matrix;
        let complex = DMatrix::from_diagonal_element(N, N, COMPLEX / h)
            - matrix.map(|x| Complex::new(x, 0.0));
        Self {
            step,
            time,
            units: jacobian.units,
            real: Triangles::of(real),
            complex: Triangles::of(complex),
        }
    }

    /// Not numbers where the matrix is singular or none.
    pub(super) fn solve_real(&self, right: &SVector<f64, N>) -> SVector<f64, N> {
        let right = SVector::from_fn(|i, _| self.inward(right[i], i));
        let solution = self.real.solve(&right);
        SVector::from_fn(|i, _| {
            (solution.as_ref()).map_or(f64::NAN, |x| times_power_of_two(x[i], self.units[i]))
        })
    }

    pub(super) fn solve_complex(
        &self,
        right: &SVector<Complex<f64>, N>,
    ) -> SVector<Complex<f64>, N> {
        let right = SVector::from_fn(|i, _| {
            Complex::new(self.inward(right[i].re, i), self.inward(right[i].im, i))
        });
        let solution = self.complex.solve(&right);
        SVector::from_fn(|i, _| {
            let none = Complex::new(f64::NAN, f64::NAN);
            let x = solution.as_ref().map_or(none, |x| x[i]);
            let outward = |x| times_power_of_two(x, self.units[i]);
            Complex::new(outward(x.re), outward(x.im))
        })
    }

    /// A rate of component i, in the units.
    #[inline]
    fn inward(&self, rate: f64, i: usize) -> f64 {
        times_power_of_two(rate, self.time - self.units[i])
    }
}
