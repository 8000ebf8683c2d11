//! Numbers of any precision and powers of two.

use crate::numerics::elliptic::MultiPrecision;
use crate::numerics::power_of_two::exponent;

/// `x 2^e`.
pub(super) fn times<T: MultiPrecision>(x: T, e: i32) -> T {
    let (mut x, mut rest) = (x, e);
    while rest != 0 && x.rounded() != 0.0 {
        let stride = rest.clamp(-1000, 1000);
        x = x.scaled(2.0_f64.powi(stride));
        rest -= stride;
    }
    x
}

/// The vector times a power of two that makes its largest component one or somewhat more.
pub(super) fn near_one<T: MultiPrecision>(vector: &[T; 3]) -> [T; 3] {
    let largest = (vector.iter()).fold(0.0_f64, |most, x| most.max(x.rounded().abs()));
    vector.map(|x| times(x, -exponent(largest)))
}

pub(super) fn sum_of_squares<T: MultiPrecision>(numbers: &[T]) -> T {
    (numbers.iter()).fold(T::from(0.0), |sum, &x| sum + x * x)
}
