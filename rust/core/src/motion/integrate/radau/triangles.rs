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
