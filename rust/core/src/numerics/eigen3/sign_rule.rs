//! The sign rule, for rotations that come from elsewhere.

use nalgebra::Matrix3;

use super::symmetric::Spectrum;
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;

/// A rotation under the sign rule: the same axes, turned by half turns about one of them.
#[must_use]
pub(crate) fn with_sign_rule(rotation: &Matrix3<f64>) -> Matrix3<f64> {
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
