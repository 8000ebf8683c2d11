//! Solids with flat faces.

use nalgebra::Matrix3;
use std::f64::consts::TAU;

use super::super::amount::{Amount, Measure, Unit, length};
use super::super::inertial_parameters::{Size, diagonal};
use crate::error::Error;

/// Box with full edge lengths (x, y, z): `s_x = m x²/12`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(12.0))?;
/// let expected = [5.0, 10.0, 13.0]; // m (a² + b²)/12 and so on
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn cuboid<X: Size>(size: &[X; 3], amount: Amount) -> Result<X::Body, Error> {
    let (unit, size) = lengths(size)?;
    let [x, y, z] = size;
    diagonal(
        unit,
        Measure::Volume(x * y * z),
        amount,
        size.map(|edge| edge * edge / 12.0),
    )
}

/// Cube with full edge length a: `I = m a²/6`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::cube(2.0, Amount::Mass(3.0))?;
/// let expected = [2.0, 2.0, 2.0]; // m a²/6
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the length is negative or not finite, or the amount is not positive.
pub fn cube<X: Size>(side: X, amount: Amount) -> Result<X::Body, Error> {
    length("side", side)?;
    cuboid(&[side; 3], amount)
}

/// Wedge: half of the box (x, y, z), cut along a diagonal of its x-z faces, its right angle at −x, −z:
/// `s_x = m x²/18`, `s_y = m y²/12`, `s_z = m z²/18`, `s_xz = −m x z/36`.
///
/// The corners are (−x/3, ±y/2, −z/3), (2x/3, ±y/2, −z/3) and (−x/3, ±y/2, 2z/3).
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// // Half of a box, of half its mass.
/// let wedge = solids::wedge(&[3.0, 2.0, 1.0], Amount::Density(5.0))?;
/// assert!((wedge.mass() - 5.0 * 3.0 * 2.0 * 1.0 / 2.0).abs() < 1e-13);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn wedge<X: Size>(size: &[X; 3], amount: Amount) -> Result<X::Body, Error> {
    let (unit, [x, y, z]) = lengths(size)?;
    let (zero, xz) = (X::zero(), -(x * z / 36.0));
    let (xx, yy, zz) = (x * x / 18.0, y * y / 12.0, z * z / 18.0);
    X::shape(
        unit,
        Measure::Volume(x * y * z / 2.0),
        amount,
        &Matrix3::new(xx, zero, xz, zero, yy, zero, xz, zero, zz),
    )
}

/// Upright prism of height h over a regular polygon with `sides` corners at the distance R from the axis, one of them
/// toward +x: `s_x = s_y = m R² (2 + cos 2π/n)/12`, `s_z = m h²/12`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// // Six sides around a circle of radius 1: the base has the area 3√3/2.
/// let nut = solids::prism(6, 1.0, 0.5, Amount::Density(2.0))?;
/// assert!((nut.mass() - 2.0 * 0.5 * 1.5 * 3.0_f64.sqrt()).abs() < 1e-14);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When there are fewer than three sides, a length is negative or not finite, or the amount is not positive.
pub fn prism<X: Size>(sides: u32, radius: X, height: X, amount: Amount) -> Result<X::Body, Error> {
    if sides < 3 {
        return Err(Error::OutOfDomain {
            what: "sides",
            law: "a whole number of 3 or more",
            value: f64::from(sides),
        });
    }
    length("radius", radius)?;
    length("height", height)?;
    let (unit, [radius, height]) = X::in_unit([radius, height]);
    let n = f64::from(sides);
    let (sin, cos) = (TAU / n).sin_cos();
    let across = radius * radius * (2.0 + cos) / 12.0;
    diagonal(
        unit,
        Measure::Volume(radius * (0.5 * n * sin) * radius * height),
        amount,
        [across, across, height * height / 12.0],
    )
}

/// Pyramid of height z over a rectangle x by y, apex toward +z at 3z/4 from C: `s_x = m x²/20`, `s_z = 3 m z²/80`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let pyramid = solids::pyramid(&[2.0, 2.0, 3.0], Amount::Mass(10.0))?;
/// assert!((pyramid.inertia()[(2, 2)] - 10.0 * (4.0 + 4.0) / 20.0).abs() < 1e-14); // m (a² + b²)/20
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn pyramid<X: Size>(size: &[X; 3], amount: Amount) -> Result<X::Body, Error> {
    let (unit, [x, y, z]) = lengths(size)?;
    diagonal(
        unit,
        Measure::Volume(x * y * z / 3.0),
        amount,
        [x * x / 20.0, y * y / 20.0, z * 3.0 * z / 80.0],
    )
}

/// Regular tetrahedron with edges a, apex toward +z: `I = m a²/20` about every axis through C.
///
/// The corners are (0, 0, a√6/4), (a/√3, 0, −a/√24) and (−a/√12, ±a/2, −a/√24).
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::tetrahedron(2.0, Amount::Mass(5.0))?;
/// let expected = [1.0, 1.0, 1.0]; // m a²/20
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the length is negative or not finite, or the amount is not positive.
pub fn tetrahedron<X: Size>(side: X, amount: Amount) -> Result<X::Body, Error> {
    length("side", side)?;
    let (unit, [side]) = X::in_unit([side]);
    diagonal(
        unit,
        Measure::Volume(side * side * side / 72.0_f64.sqrt()),
        amount,
        [side * side / 40.0; 3],
    )
}

fn lengths<X: Size>(size: &[X; 3]) -> Result<(Unit, [X; 3]), Error> {
    for &edge in size {
        length("size", edge)?;
    }
    Ok(X::in_unit(*size))
}
