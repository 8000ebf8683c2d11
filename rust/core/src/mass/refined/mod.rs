//! Principal moments and axes to twice the precision, and to four times.
//!
//! | what | file |
//! |---|---|
//! | to twice the precision | `principal` |
//! | to four times | `finest` |
//! | Jacobi's rotations | `jacobi` |
//! | vectors and matrices of such numbers | `vectors` |

mod finest;
mod jacobi;
mod principal;
mod vectors;

pub use principal::RefinedPrincipal;
pub use vectors::Vector;
