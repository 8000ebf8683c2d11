//! From angles to the attitude and back.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::sequence::Sequence;
use crate::error::{Error, MotionFault, all_finite};

/// Where the sine (for sequences of three different axes the cosine) of the middle angle is below this, first and third
/// angle are not defined.
pub const SINGULAR: f64 = 1e-12;

impl Sequence {
    /// The attitude `q_NB` with these angles (radians).
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::motion::euler_angles::Sequence;
    ///
    /// let sequence: Sequence = "ZXZ".parse()?;
    /// let attitude = sequence.to_quaternion(&[0.1, 0.2, 0.3])?;
    /// let [a, b, c] = sequence.from_quaternion(&attitude)?;
    /// assert!((a - 0.1).abs() < 1e-15 && (b - 0.2).abs() < 1e-15 && (c - 0.3).abs() < 1e-15);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When an angle is not finite.
    #[inline]
    pub fn to_quaternion(self, angles: &[f64; 3]) -> Result<UnitQuaternion<f64>, Error> {
        all_finite("angles", angles)?;
        let turn = |k: usize| {
            let mut axis = Vector3::zeros();
            axis[self.axes[k]] = (0.5 * angles[k]).sin();
            Quaternion::from_parts((0.5 * angles[k]).cos(), axis)
        };
        let mut turns = [turn(0), turn(1), turn(2)];
        if !self.intrinsic {
            turns.reverse();
        }
        Ok(UnitQuaternion::new_normalize(
            turns[0] * turns[1] * turns[2],
        ))
    }

    /// The angles (α, β, γ) of the attitude `q_NB`, in radians, ranges as SciPy: α and γ in [−π, π], β in [0, π], or in
    /// [−π/2, π/2] for three different axes.
    ///
    /// The quaternion is turned so that one formula serves every sequence (Bernardes & Viollet, PLOS ONE 17 (2022)
    /// e0276302): two half-angle pairs whose `atan2` are the half sum and the half difference of α and γ.
    ///
    /// # Errors
    /// [`MotionFault::GimbalLock`], with the middle angle, where α and γ are not defined.
    pub fn from_quaternion(self, q: &UnitQuaternion<f64>) -> Result<[f64; 3], Error> {
        // Intrinsic angles are the extrinsic ones of the reversed sequence, in reverse.
        let [i, j, k] = if self.intrinsic {
            [self.axes[2], self.axes[1], self.axes[0]]
        } else {
            self.axes
        };
        let k = if self.is_proper() { 3 - i - j } else { k };
        let sign = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 }; // of the permutation (i, j, k)
        let (v, w) = (q.vector(), q.w);
        let [a, b, c, d] = if self.is_proper() {
            [w, v[i], v[j], sign * v[k]]
        } else {
            [w - v[j], v[i] + sign * v[k], v[j] + w, sign * v[k] - v[i]]
        };
        let (cosine, sine) = (a.hypot(b), c.hypot(d));
        let mut middle = 2.0 * sine.atan2(cosine);
        let (half_sum, half_difference) = (b.atan2(a), d.atan2(c));
        let (mut first, mut third) = (half_sum - half_difference, half_sum + half_difference);
        if !self.is_proper() {
            middle -= FRAC_PI_2;
            third *= sign;
        }
        if 2.0 * cosine * sine < SINGULAR * (cosine * cosine + sine * sine) {
            return Err(MotionFault::GimbalLock {
                sequence: self.to_string(),
                middle,
            }
            .into());
        }
        if self.intrinsic {
            (first, third) = (third, first);
        }
        Ok([wrapped(first), middle, wrapped(third)])
    }
}

/// The same angle in [−π, π].
#[inline]
fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    /// `R_x(a)`, `R_y(a)`, `R_z(a)` as textbooks print them.
    fn elementary(axis: usize, angle: f64) -> Matrix3<f64> {
        let (s, c) = angle.sin_cos();
        match axis {
            0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
            1 => Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c),
            _ => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
        }
    }

    #[test]
    fn every_sequence_there_and_back() {
        for first in "xyz".chars() {
            for second in "xyz".chars().filter(|&c| c != first) {
                for third in "xyz".chars().filter(|&c| c != second) {
                    let extrinsic: String = [first, second, third].iter().collect();
                    for text in [extrinsic.to_uppercase(), extrinsic] {
                        there_and_back(&text);
                    }
                }
            }
        }
    }

    fn there_and_back(text: &str) {
        let sequence: Sequence = text.parse().expect("valid");
        let middle = if sequence.is_proper() { 1.1 } else { -0.6 };
        let angles = [-2.8, middle, 2.9];
        let q = sequence.to_quaternion(&angles).expect("finite");
        let mut turns = [0, 1, 2].map(|k| elementary(sequence.axes[k], angles[k]));
        if !sequence.intrinsic {
            turns.reverse();
        }
        let expected = turns[0] * turns[1] * turns[2];
        assert!(
            (q.to_rotation_matrix().into_inner() - expected).abs().max() < 1e-15,
            "{text}"
        );
        let back = sequence.from_quaternion(&q).expect("regular");
        for (x, y) in back.iter().zip(angles) {
            assert!((x - y).abs() < 2e-15, "{text}: {back:?}");
        }
    }

    #[test]
    fn poles_are_told() {
        let goldstein: Sequence = "goldstein".parse().expect("alias");
        let upright = goldstein.to_quaternion(&[0.3, 0.0, 0.2]).expect("finite");
        assert!(matches!(
            goldstein.from_quaternion(&upright),
            Err(Error::Motion(MotionFault::GimbalLock { .. }))
        ));
        assert!("ZZX".parse::<Sequence>().is_err() && "zXz".parse::<Sequence>().is_err());
    }
}
