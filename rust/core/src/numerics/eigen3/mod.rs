//! Eigenvalues and eigenvectors of symmetric 3×3 matrices: Jacobi's accuracy at a closed form's speed.
//!
//! Everywhere: only the lower triangle is read; values ascend; the eigenvectors are the **columns** of V, a
//! rotation (det V = +1) under the sign rule: in columns 0 and 1 the first component that is as large as the
//! largest, to 1e-8, is positive, and column 2 = column 0 × column 1. A matrix with an element that is not finite
//! gives NaN throughout, for itself alone. Elements may be anything from denormal to 5e307.
//!
//! | file | idea |
//! |---|---|
//! | `decomposition.rs` | one matrix, or many |
//! | `sign_rule.rs` | the sign rule for other rotations |
//! | `symmetric.rs` | the matrix and its decomposition in lanes; scaling, sign rule |
//! | `deviator.rs` | the deviator from differences, its isolated eigenvalue without trigonometry |
//! | `closed_form.rs` | its eigenvector, and the exact rotation that separates the other two |
//! | `jacobi.rs` | graded matrices: every eigenvalue to its own relative accuracy |
//! | `stack.rs` | which row goes to which method; from rows to lanes and back |

mod closed_form;
mod decomposition;
mod deviator;
mod jacobi;
mod sign_rule;
mod stack;
mod symmetric;

pub use decomposition::{eigen3, eigen3_many, eigenvalues3_many};
pub(crate) use sign_rule::with_sign_rule;
pub(crate) use symmetric::Eigen3;
