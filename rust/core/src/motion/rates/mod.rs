//! Rates along the rows of a record, and what they integrate to: polynomials through neighbouring rows.
//!
//! | what | file |
//! |---|---|
//! | ω of attitudes, rates of vectors, their errors; white noise of rows | [`derivatives`] |
//! | attitudes of an angular velocity, impulses of torques | [`integrals`] |
//! | rotation vectors and their quaternions | `rotations` |

pub mod derivatives;
pub mod integrals;
mod rotations;
