//! A factored matrix, and the solutions with it. Its size is known to the compiler, since a run solves with it thousands of
//! times.

use std::ops::AddAssign;

use nalgebra::{ComplexField, DMatrix, Dyn, PermutationSequence, SVector};

/// `P A = L U`: each column holds that of L below the diagonal, where L has ones, and that of U from the diagonal up.
#[derive(Clone, Debug)]
pub(super) struct Triangles<T: ComplexField, const N: usize> {
    rows: PermutationSequence<Dyn>,
    columns: Box<[[T; N]]>,
}

impl<T: ComplexField + Copy + AddAssign, const N: usize> Triangles<T, N> {
    pub(super) fn of(matrix: DMatrix<T>) -> Self {
        let (rows, lower, upper) = matrix.lu().unpack();
        let column =
            |j: usize| std::array::from_fn(|i| if i > j { lower[(i, j)] } else { upper[(i, j)] });
        Self {
            rows,
            columns: (0..N).map(column).collect(),
        }
    }

    /// The solution of `A x = right`; nothing where the matrix is singular.
    #[inline]
    pub(super) fn solve(&self, right: &SVector<T, N>) -> Option<SVector<T, N>> {
        let mut x = *right;
        self.rows.permute_rows(&mut x);
        for (j, column) in self.columns.iter().enumerate() {
            let part = -x[j];
            for i in j + 1..N {
                x[i] += part * column[i];
            }
        }
        for (j, column) in self.columns.iter().enumerate().rev() {
            if column[j].is_zero() {
                return None;
            }
            x[j] /= column[j];
            let part = -x[j];
            for i in 0..j {
                x[i] += part * column[i];
            }
        }
        Some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    fn check<T: ComplexField<RealField = f64> + Copy + AddAssign>(numbers: [T; 9]) {
        let matrix = DMatrix::from_row_slice(3, 3, &numbers);
        let right = SVector::from([numbers[1], numbers[3], numbers[8]]);
        let x = Triangles::<T, 3>::of(matrix.clone())
            .solve(&right)
            .expect("regular");
        assert!((matrix * x - right).norm() <= 1e-14 * x.norm());
    }

    #[test]
    fn solutions_solve_also_where_rows_change_their_places() {
        let numbers = [0.0, 2.0, 1.0, 1.0, 1e-9, -3.0, 4.0, -1.0, 0.5];
        check(numbers);
        check(numbers.map(|x| Complex::new(x, 1.0 - x * x)));
    }

    #[test]
    fn a_singular_matrix_has_no_solution() {
        let rows = |last: f64| DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, last]);
        let right = SVector::from([1.0, 1.0]);
        assert!(Triangles::<f64, 2>::of(rows(4.0)).solve(&right).is_none());
        assert!(
            Triangles::<f64, 2>::of(rows(4.0 + 1e-15))
                .solve(&right)
                .is_some()
        );
    }
}
