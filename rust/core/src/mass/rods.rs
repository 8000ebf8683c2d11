//! Homogeneous thin rods, straight and bent: mass along a line, centre of mass at the origin.

use std::f64::consts::{PI, TAU};

use super::amount::{Amount, Measure, length};
use super::inertial_parameters::{Size, diagonal};
use crate::error::{Error, finite};

/// Thin rod of length L along z: `I_x = I_y = m L²/12`, `I_z = 0`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, rods};
///
/// let body = rods::rod(6.0, Amount::Mass(2.0))?;
/// let expected = [0.0, 6.0, 6.0]; // m l²/12
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the length is negative or not finite, or the amount is not positive.
pub fn rod<X: Size>(length: X, amount: Amount) -> Result<X::Body, Error> {
    self::length("length", length)?;
    let (unit, [length]) = X::in_unit([length]);
    diagonal(
        unit,
        Measure::Length(length),
        amount,
        [X::zero(), X::zero(), length * length / 12.0],
    )
}

/// Thin ring of radius R about z: `I_z = m R²`, `I_x = I_y = ½ m R²`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, rods};
///
/// let body = rods::ring(2.0, Amount::Mass(1.0))?;
/// let expected = [2.0, 2.0, 4.0]; // m r²/2, m r²
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the radius is negative or not finite, or the amount is not positive.
pub fn ring<X: Size>(radius: X, amount: Amount) -> Result<X::Body, Error> {
    length("radius", radius)?;
    let (unit, [radius]) = X::in_unit([radius]);
    let across = radius * radius / 2.0;
    diagonal(
        unit,
        Measure::Length(radius * TAU),
        amount,
        [across, across, X::zero()],
    )
}

/// Thin arc of a circle of radius R in the x-y plane that spans the angle α, its middle toward +x and the centre of the
/// circle at `x = −R sin(α/2)/(α/2)` from C:
/// `s_y = ½ m R² (1 − sin α/α)`, `s_x = ½ m R² (1 + sin α/α) − m R² (sin(α/2)/(α/2))²`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, rods};
/// use std::f64::consts::PI;
///
/// // Half a ring is as heavy as it is long.
/// let arc = rods::arc(1.0, PI, Amount::Density(3.0))?;
/// assert!((arc.mass() - 3.0 * PI).abs() < 1e-14);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the radius is negative or not finite, the angle is not within 0 to 2π, or the amount is not positive.
pub fn arc<X: Size>(radius: X, angle: X, amount: Amount) -> Result<X::Body, Error> {
    length("radius", radius)?;
    finite("angle", angle.rounded())?;
    if !(0.0..=TAU).contains(&angle.rounded()) {
        return Err(Error::OutOfDomain {
            what: "angle",
            law: "from 0 to 2π",
            value: angle.rounded(),
        });
    }
    let (unit, [radius]) = X::in_unit([radius]);
    let square = radius * radius;
    diagonal(
        unit,
        Measure::Length(radius * angle),
        amount,
        [square * sagitta(angle), square * chord(angle), X::zero()],
    )
}

/// `½ (1 − sin α/α)`; of a short arc by its series, where the difference would cancel.
fn chord<X: Size>(angle: X) -> X {
    if angle.rounded() >= 2.0 {
        return (X::one() - angle.sine() / angle) * 0.5;
    }
    // Σ (−1)^(k+1) α^(2k)/(2k + 1)!, k = 1, 2, …
    let square = angle * angle;
    let mut term = square / 6.0;
    let mut sum = X::zero();
    for k in 1..16 {
        sum += term;
        let n = f64::from(2 * k + 2);
        term *= -square / (n * (n + 1.0));
    }
    sum * 0.5
}

/// `½ (1 + sin α/α) − (sin(α/2)/(α/2))²`; of all but long arcs by its series, where the difference would cancel.
fn sagitta<X: Size>(angle: X) -> X {
    if angle.rounded() >= 1.25 * PI {
        let half = (angle / 2.0).sine() / (angle / 2.0);
        let whole = angle.sine() / angle;
        return (X::one() + whole) * 0.5 - half * half;
    }
    // Σ (−1)^k (k − 1) α^(2k)/(2k + 2)!, k = 2, 3, …
    let square = angle * angle;
    let mut power = square * square / 720.0;
    let mut sum = X::zero();
    for k in 2..20 {
        sum += power * f64::from(k - 1);
        let n = f64::from(2 * k + 3);
        power *= -square / (n * (n + 1.0));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_ring_and_whole_ring() {
        let half = arc(2.0, PI, Amount::Mass(1.0)).expect("arc").inertia();
        // About the centre of the circle a half ring has half the moments of inertia of a ring in each direction.
        let offset = 2.0 * 2.0 / PI;
        assert!((half[(2, 2)] - (4.0 - offset * offset)).abs() < 4e-15);
        assert!((half[(0, 0)] - 2.0).abs() < 4e-15);
        let whole = arc(2.0, TAU, Amount::Mass(1.0)).expect("arc");
        assert!(whole.is_close(&ring(2.0, Amount::Mass(1.0)).expect("ring"), 1e-15, 0.0));
    }

    #[test]
    fn shallow_arc_is_a_rod_with_a_sagitta() {
        let (radius, angle) = (1e6, 1e-6);
        let [i1, i2, _] = arc(radius, angle, Amount::Mass(1.0))
            .expect("arc")
            .principal()
            .moments;
        assert!((i1 / (radius * radius * angle.powi(4) / 720.0) - 1.0).abs() < 1e-12);
        assert!((i2 - 1.0 / 12.0).abs() < 1e-12);
    }

    #[test]
    fn no_arc_spans_more_than_a_circle_or_less_than_nothing() {
        let one = |angle: f64| arc(1.0, angle, Amount::Mass(1.0));
        let above = f64::from_bits(TAU.to_bits() + 1);
        for angle in [above, 7.0, -1e-300, -1.0] {
            match one(angle) {
                Err(Error::OutOfDomain { what, value, .. }) => {
                    assert_eq!((what, value), ("angle", angle));
                }
                other => panic!("{angle:e}: {other:?}"),
            }
        }
        for angle in [TAU, 1e-300, 0.0] {
            assert!(one(angle).is_ok(), "{angle:e}");
        }
    }
}
