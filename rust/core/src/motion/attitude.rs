//! The attitude `R_NB` as a unit quaternion: active, `v_N = R_NB v_B`, components (x, y, z, w).

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::error::{Error, all_finite};
use crate::mass::validity::check_rotation;
use crate::numerics::double_double::DoubleDouble;

/// How far from one the norm of a quaternion may be and still be rounding.
const UNIT: f64 = 1e-8;

/// The rotation with the components (x, y, z, w), which must have unit length to rounding; `what` names them in errors.
///
/// # Examples
///
/// ```
/// use polhode::motion::attitude::{components, from_components};
///
/// let half = from_components("attitude", &[0.0, 0.0, 1.0, 0.0])?; // half a turn about z
/// assert_eq!(components(&half), [0.0, 0.0, 1.0, 0.0]);
/// assert!(from_components("attitude", &[0.0, 0.0, 1.0, 1.0]).is_err());
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a component is not finite or the norm is not one.
#[inline]
pub fn from_components(
    what: &'static str,
    components: &[f64; 4],
) -> Result<UnitQuaternion<f64>, Error> {
    all_finite(what, components)?;
    let [x, y, z, w] = *components;
    let q = Quaternion::new(w, x, y, z);
    let norm = q.norm();
    if (norm - 1.0).abs() > UNIT {
        return Err(Error::NotAUnitQuaternion { what, norm });
    }
    Ok(UnitQuaternion::new_normalize(q))
}

/// Components (x, y, z, w).
#[must_use]
#[inline]
pub fn components(q: &UnitQuaternion<f64>) -> [f64; 4] {
    [q.i, q.j, q.k, q.w]
}

/// The quaternion of a rotation matrix, w ≥ 0.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Matrix3;
/// use polhode::motion::attitude::{components, from_matrix};
///
/// let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
/// let [_, _, z, w] = components(&from_matrix(&quarter)?);
/// assert!((z - 0.5_f64.sqrt()).abs() < 1e-15 && (w - z).abs() < 1e-15);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the matrix is not a rotation.
#[inline]
pub fn from_matrix(rotation: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, Error> {
    check_rotation("matrix", rotation)?;
    Ok(from_axes(rotation))
}

/// The quaternion of a matrix that is known to be a rotation, w ≥ 0.
#[must_use]
#[inline]
pub fn from_axes(rotation: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation));
    let q = UnitQuaternion::new_normalize(q.into_inner());
    if q.w < 0.0 {
        UnitQuaternion::new_unchecked(-q.into_inner())
    } else {
        q
    }
}

/// A quaternion that is nearly one of unit length, brought back to it: `q (1 − ½(|q|² − 1))`, the excess in double-double.
///
/// Rounded, |q|² is one wherever it is within half a unit below or a whole one above, so that quaternions divided by their
/// rounded length are too long on the average, by 10⁻¹⁶. A rotation by them is then not quite one, and the force of a potential
/// not quite its slope: over a million rotations that shows in the energy.
///
/// # Examples
///
/// ```
/// use polhode::motion::attitude::{from_axes, normalize};
/// use polhode::nalgebra::{Matrix3, Quaternion};
///
/// // A quaternion that a long product left a little too long.
/// let drifted = Quaternion::new(1.0 + 1e-9, 0.0, 0.0, 0.0);
/// assert!((normalize(&drifted).w - 1.0).abs() < 1e-17_f64.max(2e-18));
/// assert_eq!(from_axes(&Matrix3::identity()).w, 1.0);
/// ```
#[must_use]
#[inline]
pub fn normalize(q: &Quaternion<f64>) -> UnitQuaternion<f64> {
    let squares = (q.coords.iter()).fold(DoubleDouble::from(-1.0), |sum, &x| {
        sum + DoubleDouble::product(x, x)
    });
    let excess = 0.5 * squares.rounded();
    UnitQuaternion::new_unchecked(q - q * excess)
}

/// `q̇ = ½ q ∘ (ω, 0)` for the attitude `q_NB` and ω of B relative to N, components in B.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::attitude::rate;
/// use polhode::nalgebra::Quaternion;
///
/// // q̇ = ½ q∘ω
/// let found = rate(&Quaternion::identity(), &Vector3::new(0.0, 0.0, 2.0));
/// assert_eq!((found.w, found.k), (0.0, 1.0));
/// ```
#[inline(always)]
#[must_use]
pub fn rate(q: &Quaternion<f64>, omega: &Vector3<f64>) -> Quaternion<f64> {
    q * Quaternion::from_imag(omega * 0.5)
}

/// Return the shortest rotation that takes one unit vector to another; None where they are opposite, so that there are many.
///
/// Its vector part is that of a × b, so that small angles keep their digits; the cosine alone would lose half of them.
pub(crate) fn shortest_turn(from: &Vector3<f64>, to: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let (across, along) = (from.cross(to), from.dot(to));
    // 1 + cos = sin²/(1 − cos).
    let scalar = if along >= 0.0 {
        1.0 + along
    } else {
        across.norm_squared() / (1.0 - along)
    };
    let turn = Quaternion::from_parts(scalar, across);
    (turn.norm() > 0.0).then(|| UnitQuaternion::new_normalize(turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small and large angles about several axes: the vector arrives to rounding.
    #[test]
    fn shortest_turns_keep_the_digits_of_small_angles() {
        let from = Vector3::new(0.3, -0.5, 0.8).normalize();
        let axis = from.cross(&Vector3::x()).normalize();
        let side = axis.cross(&from);
        for angle in [
            0.0, 1e-300, 1e-12, 1e-8, 1e-4, 0.1, 1.0, 1.5, 1.6, 3.0, 3.12,
        ] {
            let (sin, cos) = f64::sin_cos(angle);
            let to = from * cos + side * sin;
            let turn = shortest_turn(&from, &to).expect("a rotation");
            // Near a half turn the axis is that of vectors nearly opposite.
            let rounding = 5e-16 / if cos < 0.0 { sin } else { 1.0 };
            assert!((turn * from - to).norm() < 1e-15, "{angle}");
            let across = turn.vector().into_owned() - axis * (0.5 * angle).sin();
            assert!(across.norm() < rounding, "{angle}");
        }
        let z = Vector3::z();
        assert!(shortest_turn(&z, &-z).is_none());
        let nearly = Vector3::new(1e-9, 0.0, -1.0).normalize();
        let turn = shortest_turn(&z, &nearly).expect("a rotation");
        assert!((turn * z - nearly).norm() < 1e-15);
    }

    #[test]
    fn quarter_turn_about_z_takes_x_to_y() {
        let h = 0.5_f64.sqrt();
        let q = from_components("q", &[0.0, 0.0, h, h]).expect("unit");
        assert!((q * Vector3::x() - Vector3::y()).norm() < 1e-15);
        let back = from_matrix(&q.to_rotation_matrix().into_inner()).expect("rotation");
        assert!(back.angle_to(&q) < 1e-15);
    }

    #[test]
    fn restored_quaternions_are_as_often_too_short_as_too_long() {
        let excess = |q: &UnitQuaternion<f64>| {
            let squares = q.coords.iter().map(|&x| DoubleDouble::product(x, x));
            (squares.fold(DoubleDouble::from(-1.0), |sum, x| sum + x)).rounded()
        };
        let turn = UnitQuaternion::from_euler_angles(0.1, -0.2, 0.3);
        let (mut q, mut sum) = (turn, 0.0);
        for _ in 0..10_000 {
            q = normalize(&(q * turn).into_inner());
            assert!(excess(&q).abs() < 4e-16);
            sum += excess(&q) / 1e4;
        }
        assert!(sum.abs() < 5e-18, "{sum:e}");
    }

    #[test]
    fn rate_of_a_steady_spin() {
        let q = Quaternion::identity();
        assert_eq!(
            rate(&q, &Vector3::new(0.0, 0.0, 2.0)),
            Quaternion::new(0.0, 0.0, 0.0, 1.0)
        );
    }
}
