//! Eigenvalues and eigenvectors of symmetric 3×3 matrices: Jacobi's accuracy at a closed form's speed.
//!
//! Everywhere: only the lower triangle is read; values ascend; the eigenvectors are the **columns** of V, a
//! rotation (det V = +1) under the sign rule: in columns 0 and 1 the first component that is as large as the
//! largest, to 1e-8, is positive, and column 2 = column 0 × column 1. A matrix with an element that is not finite
//! gives NaN throughout, for itself alone. Elements may be anything from denormal to 5e307.
//!
//! | file | idea |
//! |---|---|
//! | `symmetric.rs` | the matrix and its decomposition in lanes; scaling, sign rule |
//! | `deviator.rs` | the deviator from differences, its isolated eigenvalue without trigonometry |
//! | `closed_form.rs` | its eigenvector, and the exact rotation that separates the other two |
//! | `jacobi.rs` | graded matrices: every eigenvalue to its own relative accuracy |
//! | `stack.rs` | which row goes to which method; from rows to lanes and back |

mod closed_form;
mod deviator;
mod jacobi;
mod stack;
mod symmetric;

use nalgebra::Matrix3;

use super::dispatch::{Kernel, dispatch};
use super::lane::Lane;
use stack::{One, Stack, VALUES_ONLY, WITH_VECTORS};
use symmetric::Spectrum;

/// A = V diag(values) Vᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen3 {
    /// The eigenvalues, ascending.
    pub values: [f64; 3],
    /// The eigenvectors as columns, a rotation.
    pub vectors: Matrix3<f64>,
}

/// The decomposition of one matrix.
#[must_use]
pub fn eigen3(a: &Matrix3<f64>) -> Eigen3 {
    let [[a00, a10, a20], [_, a11, a21], [_, _, a22]] = a.data.0;
    let (values, vectors) = dispatch(One([a00, a10, a20, a10, a11, a21, a20, a21, a22]));
    Eigen3 {
        values,
        vectors: vectors.into(),
    }
}

/// The decompositions of many matrices, on the calling thread; matrices and eigenvectors are row-major.
///
/// # Panics
/// If the lengths differ.
pub fn eigen3_many(matrices: &[[f64; 9]], values: &mut [[f64; 3]], vectors: &mut [[f64; 9]]) {
    assert_eq!(
        matrices.len(),
        values.len(),
        "as many triples of values as matrices"
    );
    assert_eq!(
        matrices.len(),
        vectors.len(),
        "as many triples of vectors as matrices"
    );
    dispatch(Stack::<WITH_VECTORS> {
        matrices,
        values,
        vectors,
    });
}

/// The eigenvalues of many row-major matrices, on the calling thread: the bits of [`eigen3_many`] in less time.
///
/// # Panics
/// If the lengths differ.
pub fn eigenvalues3_many(matrices: &[[f64; 9]], values: &mut [[f64; 3]]) {
    assert_eq!(
        matrices.len(),
        values.len(),
        "as many triples of values as matrices"
    );
    dispatch(Stack::<VALUES_ONLY> {
        matrices,
        values,
        vectors: &mut [],
    });
}

/// A rotation under the sign rule: the same axes, turned by half turns about one of them.
#[must_use]
pub fn with_sign_rule(rotation: &Matrix3<f64>) -> Matrix3<f64> {
    dispatch(SignRule(rotation))
}

struct SignRule<'a>(&'a Matrix3<f64>);

impl Kernel for SignRule<'_> {
    type Output = Matrix3<f64>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Matrix3<f64> {
        let vectors = self.0.data.0.map(|column| column.map(L::new));
        let spectrum = Spectrum {
            values: [L::new(0.0); 3],
            vectors,
            poison: L::new(0.0),
        };
        spectrum
            .with_sign_rule()
            .vectors
            .map(|column| column.map(L::get))
            .into()
    }
}
