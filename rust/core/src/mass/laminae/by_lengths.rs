//! Laminae known by lengths, about the origin.

use std::f64::consts::PI;

use crate::error::Error;
use crate::mass::amount::{Amount, Measure, check_order, length};
use crate::mass::inertial_parameters::{Size, diagonal};

/// Disk of radius R: `I_z = ½ m R²`, `I_x = I_y = ¼ m R²`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, laminae};
///
/// let body = laminae::disk(2.0, Amount::Mass(1.0))?;
/// let expected = [1.0, 1.0, 2.0]; // m r²/4, m r²/2
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the radius is negative or not finite, or the amount is not positive.
pub fn disk<X: Size>(radius: X, amount: Amount) -> Result<X::Body, Error> {
    length("radius", radius)?;
    ellipse(&[radius; 2], amount)
}

/// Disk with a concentric hole, between the radii r and R: `I_z = ½ m (R² + r²)`; for r = R a ring.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, laminae};
///
/// let body = laminae::annulus(1.0, 2.0, Amount::Mass(4.0))?;
/// let expected = [5.0, 5.0, 10.0]; // m (a² + b²)/2 about its axis
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a radius is negative or not finite, the inner one is the larger, or the amount is not positive.
pub fn annulus<X: Size>(
    inner_radius: X,
    outer_radius: X,
    amount: Amount,
) -> Result<X::Body, Error> {
    check_order(
        ("inner_radius", inner_radius),
        ("outer_radius", outer_radius),
    )?;
    let (unit, [r, R]) = X::in_unit([inner_radius, outer_radius]);
    let across = (R * R + r * r) / 4.0;
    diagonal(
        unit,
        Measure::Area((R - r) * PI * (R + r)),
        amount,
        [across, across, X::zero()],
    )
}

/// Ellipse with semi-axes a along x and b along y: `I_x = ¼ m b²`, `I_y = ¼ m a²`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, laminae};
///
/// let body = laminae::ellipse(&[2.0, 4.0], Amount::Mass(1.0))?;
/// let expected = [1.0, 4.0, 5.0]; // m a²/4, m b²/4 and their sum
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn ellipse<X: Size>(semi_axes: &[X; 2], amount: Amount) -> Result<X::Body, Error> {
    for &semi_axis in semi_axes {
        length("semi_axes", semi_axis)?;
    }
    let (unit, [a, b]) = X::in_unit(*semi_axes);
    diagonal(
        unit,
        Measure::Area(a * PI * b),
        amount,
        [a * a / 4.0, b * b / 4.0, X::zero()],
    )
}

/// Rectangle with full edge lengths x and y: `I_x = m y²/12`, `I_y = m x²/12`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, laminae};
///
/// let body = laminae::rectangle(&[2.0, 4.0], Amount::Mass(3.0))?;
/// let expected = [1.0, 4.0, 5.0]; // m a²/12, m b²/12 and their sum
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn rectangle<X: Size>(size: &[X; 2], amount: Amount) -> Result<X::Body, Error> {
    for &edge in size {
        length("size", edge)?;
    }
    let (unit, [x, y]) = X::in_unit(*size);
    diagonal(
        unit,
        Measure::Area(x * y),
        amount,
        [x * x / 12.0, y * y / 12.0, X::zero()],
    )
}
