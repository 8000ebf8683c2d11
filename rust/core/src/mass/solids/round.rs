//! Balls and ellipsoids, whole, hollow and halved.

use std::f64::consts::PI;

use super::super::amount::{Amount, Measure, check_order, length, ratio};
use super::super::inertial_parameters::{Size, diagonal};
use crate::error::Error;

/// Ellipsoid with semi-axes (a, b, c): `s_x = m a²/5`, so `I_x = m (b² + c²)/5` (mex254).
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::ellipsoid(&[1.0, 2.0, 3.0], Amount::Mass(5.0))?;
/// let expected = [5.0, 10.0, 13.0]; // m (a² + b²)/5 and so on
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn ellipsoid<X: Size>(semi_axes: &[X; 3], amount: Amount) -> Result<X::Body, Error> {
    for &semi_axis in semi_axes {
        length("semi_axes", semi_axis)?;
    }
    let (unit, semi_axes) = X::in_unit(*semi_axes);
    let [a, b, c] = semi_axes;
    diagonal(
        unit,
        Measure::Volume(a * (4.0 / 3.0 * PI) * b * c),
        amount,
        semi_axes.map(|semi_axis| semi_axis * semi_axis / 5.0),
    )
}

/// Ball of radius R: `I = ⅖ m R²` (mex253).
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::sphere(3.0, Amount::Mass(5.0))?;
/// let expected = [18.0, 18.0, 18.0]; // 2/5 m r²
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the radius is negative or not finite, or the amount is not positive.
pub fn sphere<X: Size>(radius: X, amount: Amount) -> Result<X::Body, Error> {
    length("radius", radius)?;
    ellipsoid(&[radius; 3], amount)
}

/// Ball of radius R with a concentric cavity of radius r: `I = ⅖ m (R⁵ − r⁵)/(R³ − r³)`, which for r = R is the thin shell,
/// `I = ⅔ m R²`.
///
/// Both differences have the factor `R − r`, which is divided out:
/// `I = ⅖ m R² (1 + t + t² + t³ + t⁴)/(1 + t + t²)` with `t = r/R`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::hollow_sphere(3.0, 3.0, Amount::Mass(1.0))?;
/// let expected = [6.0, 6.0, 6.0]; // without thickness: 2/3 m r²
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a radius is negative or not finite, the inner one is the larger, or the amount is not positive.
pub fn hollow_sphere<X: Size>(
    inner_radius: X,
    outer_radius: X,
    amount: Amount,
) -> Result<X::Body, Error> {
    check_order(
        ("inner_radius", inner_radius),
        ("outer_radius", outer_radius),
    )?;
    let (unit, [r, R]) = X::in_unit([inner_radius, outer_radius]);
    let t = ratio(r, R);
    let one = X::one();
    let quadratic = one + t * (one + t);
    let quartic = one + t * (one + t * quadratic);
    diagonal(
        unit,
        Measure::Volume((R - r) * (4.0 / 3.0 * PI) * (R * R * quadratic)),
        amount,
        [R * R / 5.0 * (quartic / quadratic); 3],
    )
}

/// Half of a ball of radius R, its dome toward +z and its flat face at −3R/8 from C:
/// `s_x = s_y = m R²/5`, `s_z = m R²/5 − m (3R/8)² = 19 m R²/320`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let half = solids::hemisphere(1.0, Amount::Mass(1.0))?;
/// assert!((half.inertia()[(2, 2)] - 0.4).abs() < 1e-15); // as of the whole ball: 2/5 m r²
/// assert!((half.inertia()[(0, 0)] - 83.0 / 320.0).abs() < 1e-15); // about C, 3/8 r above the base
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the radius is negative or not finite, or the amount is not positive.
pub fn hemisphere<X: Size>(radius: X, amount: Amount) -> Result<X::Body, Error> {
    length("radius", radius)?;
    let (unit, [radius]) = X::in_unit([radius]);
    let square = radius * radius;
    diagonal(
        unit,
        Measure::Volume(square * (2.0 / 3.0 * PI) * radius),
        amount,
        [square / 5.0, square / 5.0, square * 19.0 / 320.0],
    )
}
