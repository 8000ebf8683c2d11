//! What makes mass properties possible, each law relative to the tensor's own size.

use nalgebra::{Matrix3, SMatrix};

use crate::error::{BodyFault, Error, all_finite, all_finite_of_body, check_rtol, finite_of_body};

/// Violations of a law up to this times the trace of the tensor are rounding, not physics.
///
/// # Examples
///
/// ```
/// use polhode::RigidBody;
/// use polhode::mass::validity::ROUNDING;
/// use polhode::nalgebra::{Matrix3, Vector3};
///
/// // A flat body, I₁ + I₂ = I₃, with a deficit on either side of what rounding may do.
/// let body = |deficit: f64| {
///     let moments = Vector3::new(1.0, 1.0, 2.0 + 4.0 * deficit);
///     RigidBody::new(1.0, &Matrix3::from_diagonal(&moments), &Vector3::zeros(), 0.0)
/// };
/// assert!(body(0.9 * ROUNDING).is_ok() && body(1.1 * ROUNDING).is_err());
/// ```
pub const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Asymmetry up to this times the largest element is rounding: the mean of the two elements is taken.
pub const ASYMMETRY: f64 = 8.0 * f64::EPSILON;

/// m > 0 and finite.
pub(super) fn check_mass(mass: f64) -> Result<(), Error> {
    finite_of_body("mass", mass)?;
    if mass > 0.0 {
        Ok(())
    } else {
        Err(BodyFault::NonPositiveMass { mass }.into())
    }
}

/// m ≥ 0, of matter that may be missing; NaN passes.
///
/// # Examples
///
/// ```
/// use polhode::mass::validity::check_not_negative_mass;
///
/// assert!(check_not_negative_mass(0.0).is_ok() && check_not_negative_mass(-1.0).is_err());
/// ```
///
/// # Errors
/// [`Error::OutOfDomain`].
pub fn check_not_negative_mass(mass: f64) -> Result<(), Error> {
    if mass < 0.0 {
        return Err(Error::OutOfDomain {
            what: "mass",
            law: "zero or more (the tensor of a cavity is subtracted)",
            value: mass,
        });
    }
    Ok(())
}

/// Ascending moments: none negative, and no two less than the third. `noise` is an absolute, `allowed` a relative bound of
/// rounding.
pub(super) fn check_moments(
    moments: &[f64; 3],
    noise: f64,
    allowed: f64,
    is_from_origin: bool,
) -> Result<(), Error> {
    let [i1, i2, i3] = *moments;
    if i1 < -noise.max(allowed * i3) {
        return Err(BodyFault::NegativeMoment {
            moments: *moments,
            is_from_origin,
            is_possible_as_given: false,
        }
        .into());
    }
    let deficit = i3 - i2 - i1;
    // In fractions of the largest, so that moments near the ends of the float64 range do not overflow.
    let relative = (deficit / i3) / (1.0 + i2 / i3 + i1 / i3);
    if i3 > 0.0 && relative > allowed && deficit > noise {
        return Err(BodyFault::TriangleInequality {
            moments: *moments,
            deficit,
            relative,
            is_given: true,
        }
        .into());
    }
    Ok(())
}

/// The mean of a tensor and its transpose, when they differ by rounding or by `rtol` at most.
pub(super) fn symmetrize(
    what: &'static str,
    a: &Matrix3<f64>,
    rtol: f64,
) -> Result<Matrix3<f64>, Error> {
    all_finite_of_body(what, a)?;
    check_rtol(rtol)?;
    check_symmetry(what, a, ASYMMETRY.max(rtol))?;
    Ok(mean_of_halves(a))
}

/// `|a_ij − a_ji| ≤ allowed · max |a|`; a tensor with an element that is not finite passes.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Matrix3;
/// use polhode::mass::validity::{ASYMMETRY, check_symmetry};
///
/// let mut tensor = Matrix3::identity();
/// tensor[(0, 1)] = 0.1;
/// assert!(check_symmetry("inertia", &tensor, ASYMMETRY).is_err());
/// assert!(check_symmetry("inertia", &tensor, 0.1).is_ok());
/// ```
///
/// # Errors
/// [`BodyFault::NotSymmetric`] with the first pair that differs.
pub fn check_symmetry<const N: usize>(
    what: &'static str,
    a: &SMatrix<f64, N, N>,
    allowed: f64,
) -> Result<(), Error> {
    let largest = a.amax();
    for row in 0..N {
        for column in row + 1..N {
            let (a, b) = (a[(row, column)], a[(column, row)]);
            let relative = (a / largest - b / largest).abs();
            if relative > allowed {
                return Err(BodyFault::NotSymmetric {
                    what,
                    row,
                    column,
                    a,
                    b,
                    relative,
                    allowed,
                }
                .into());
            }
        }
    }
    Ok(())
}

/// `RᵀR = 1` and `det R = +1`, to what a few multiplications of rotations may leave.
pub(crate) fn check_rotation(what: &'static str, rotation: &Matrix3<f64>) -> Result<(), Error> {
    all_finite(what, rotation)?;
    let deviation = (rotation.tr_mul(rotation) - Matrix3::identity())
        .abs()
        .max();
    let determinant = rotation.determinant();
    if deviation <= 1e-12 && determinant > 0.0 {
        Ok(())
    } else {
        Err(Error::NotARotation {
            what,
            deviation,
            determinant,
        })
    }
}

/// `(A + Aᵀ)/2`, halved before it is added so that nothing overflows.
pub(super) fn mean_of_halves(a: &Matrix3<f64>) -> Matrix3<f64> {
    let mut mean = *a;
    for (row, column) in [(0, 1), (0, 2), (1, 2)] {
        let (x, y) = (a[(row, column)], a[(column, row)]);
        let m = if x == y { x } else { 0.5 * x + 0.5 * y };
        mean[(row, column)] = m;
        mean[(column, row)] = m;
    }
    mean
}

/// The trace, by the sizes of its elements.
pub(super) fn trace(a: &Matrix3<f64>) -> f64 {
    a[(0, 0)].abs() + a[(1, 1)].abs() + a[(2, 2)].abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_column_of_a_rotation_counts() {
        let told = |matrix: Matrix3<f64>| check_rotation("axes", &matrix).is_ok();
        for k in 0..3 {
            // RᵀR is off by twice as much, in one place.
            let with = |more: f64| {
                let mut matrix = Matrix3::identity();
                matrix[(k, k)] += more;
                matrix
            };
            assert!(told(with(0.4e-12)) && !told(with(0.6e-12)), "{k}");
            assert!(!told(with(-2.0)), "a reflection");
        }
    }
}
