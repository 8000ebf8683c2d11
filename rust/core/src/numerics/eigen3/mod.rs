//! Eigenvalues and eigenvectors of symmetric 3×3 matrices.
//!
//! Everywhere: only the lower triangle is read; values ascend; the eigenvectors are the **columns** of V, a
//! rotation (det V = +1) under the sign rule: in columns 0 and 1 the first component that is as large as the
//! largest, to 1e-8, is positive, and column 2 = column 0 × column 1. A matrix with an element that is not finite
//! gives NaN throughout, for itself alone. Elements may be anything from denormal to 5e307.

mod jacobi;
mod symmetric;

use nalgebra::Matrix3;

use super::dispatch::{Kernel, dispatch};
use super::lane::Lane;
use symmetric::{Spectrum, Symmetric};

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
    let row_major: [[f64; 3]; 3] = a.transpose().data.0;
    let (mut values, mut vectors) = ([[0.0; 3]], [[0.0; 9]]);
    eigen3_many(
        &[[
            row_major[0][0],
            0.0,
            0.0,
            row_major[1][0],
            row_major[1][1],
            0.0,
            row_major[2][0],
            row_major[2][1],
            row_major[2][2],
        ]],
        &mut values,
        &mut vectors,
    );
    Eigen3 {
        values: values[0],
        vectors: Matrix3::from_row_slice(&vectors[0]),
    }
}

/// The decompositions of many matrices, on the calling thread; matrices and eigenvectors are row-major.
///
/// # Panics
/// If the lengths differ.
pub fn eigen3_many(matrices: &[[f64; 9]], values: &mut [[f64; 3]], vectors: &mut [[f64; 9]]) {
    assert!(
        matrices.len() == values.len() && matrices.len() == vectors.len(),
        "as many values and vectors as matrices"
    );
    dispatch(Many {
        matrices,
        values,
        vectors,
    });
}

struct Many<'a> {
    matrices: &'a [[f64; 9]],
    values: &'a mut [[f64; 3]],
    vectors: &'a mut [[f64; 9]],
}

impl Kernel for Many<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lane>(self) {
        for ((a, w), v) in self.matrices.iter().zip(self.values).zip(self.vectors) {
            let (spectrum, poison): (Spectrum<L::Scalar>, _) =
                jacobi::jacobi(&Symmetric::gather(a));
            spectrum.with_sign_rule(poison).scatter(w, v);
        }
    }
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
        let zero = L::Scalar::splat(0.0);
        let vectors = self.0.data.0.map(|column| column.map(L::Scalar::splat));
        let signed = Spectrum {
            values: [zero; 3],
            vectors,
        }
        .with_sign_rule(zero);
        Matrix3::from_fn(|row, column| signed.vectors[column][row].get(0))
    }
}
