//! The matrices of Newton's iteration, factored.

use nalgebra::{Complex, DMatrix, DVector, Dyn, LU, SVector};

use super::tableau::{COMPLEX, REAL};

/// `γ/h − J` and `(α + iβ)/h − J`, factored.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    pub(super) step: f64,
    real: LU<f64, Dyn, Dyn>,
    complex: LU<Complex<f64>, Dyn, Dyn>,
}

impl Factors {
    pub(super) fn of(jacobian: &DMatrix<f64>, step: f64) -> Self {
        let n = jacobian.nrows();
        let real = DMatrix::from_diagonal_element(n, n, REAL / step) - jacobian;
        let complex = DMatrix::from_diagonal_element(n, n, COMPLEX / step)
            - jacobian.map(|x| Complex::new(x, 0.0));
        Self {
            step,
            real: real.lu(),
            complex: complex.lu(),
        }
    }

    /// Not numbers where the matrix is singular or none.
    pub(super) fn solve_real<const N: usize>(&self, right: &SVector<f64, N>) -> SVector<f64, N> {
        let right = DVector::from_column_slice(right.as_slice());
        let solution = self.real.solve(&right);
        SVector::from_fn(|i, _| solution.as_ref().map_or(f64::NAN, |x| x[i]))
    }

    pub(super) fn solve_complex<const N: usize>(
        &self,
        right: &SVector<Complex<f64>, N>,
    ) -> SVector<Complex<f64>, N> {
        let right = DVector::from_column_slice(right.as_slice());
        let solution = self.complex.solve(&right);
        let none = Complex::new(f64::NAN, f64::NAN);
        SVector::from_fn(|i, _| solution.as_ref().map_or(none, |x| x[i]))
    }
}
