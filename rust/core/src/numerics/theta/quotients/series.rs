//! The sums that the quotients are made of.

use crate::numerics::lane::Lane;

/// The values of the three: real and imaginary parts.
pub(crate) type Values<L> = [[L; 2]; 3];

/// `Σ aₙ xₙ`, from the end, where the small terms are.
#[inline(always)]
pub(super) fn dot<L: Lane, const N: usize>(a: &[f64; N], x: &[L; N]) -> L {
    let mut sum = L::new(a[N - 1]) * x[N - 1];
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = L::new(a[k]).mul_add(x[k], sum);
    }
    sum
}
