//! Random numbers that are the same on every machine and in every release.
//!
//! | file | what it gives |
//! |---|---|
//! | [`stream`] | four words from a counter and a key; the words of each member of an ensemble |
//! | [`factor`] | a factor of a covariance, by which normal numbers get it |
//! | [`distributions`] | words as uniform and normal numbers and as rotations |
//!
//! A number is a function of its seed, of the name of what it is drawn for, of the member and of its place among the numbers of
//! that member: nothing is drawn in turn, so that no order, no cut into parts and no number of threads changes it. It takes
//! sums, products, quotients and square roots alone, which IEEE 754 rounds alike everywhere.

pub mod distributions;
pub mod stream;

pub use crate::numerics::cholesky::factor;
pub use stream::{Stream, philox};
