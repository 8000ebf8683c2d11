//! The variables: which derivatives there are, and in which order.

use crate::motion::loads::{Parameter, Term};

/// The columns of a small rotation at the start, of ω at the start.
pub(super) const ATTITUDE: usize = 0;
pub(super) const RATES: usize = 3;
/// Of the principal moments, ascending, and of the elements 23, 31, 12 of the tensor in principal axes.
pub(super) const MOMENTS: usize = 6;
pub(super) const PRODUCTS: usize = 9;
/// Of the centre of mass and of the mass.
pub(super) const CENTER: usize = 12;
pub(super) const MASS: usize = 15;
/// Of the numbers of the load, term by term.
pub(super) const LOAD: usize = 16;

/// How many numbers a term has.
pub(super) fn count(term: &Term) -> usize {
    term.parameters().iter().map(Parameter::count).sum()
}
