//! Euler angles: all twelve sequences, intrinsic and extrinsic (msl25), and their rates (msl26).
//!
//! Each rate turns about its own axis: for `R_NB = R_1(α) R_2(β) R_3(γ)` about `e_1`, which the first turn leaves, about
//! the line of nodes `e_2`, and about `e_3`, which is fixed in the body. In the frame between the second and the third
//! turn, with k the axis across the first two and `e_k = s e_1×e_2`:
//!
//! | ω along | ZXZ and its like (third axis = first) | XYZ and its like (third axis = k) |
//! |---|---|---|
//! | the first axis | `α̇ cos β + γ̇` | `α̇ cos β` |
//! | the second axis | `β̇` | `β̇` |
//! | k | `s α̇ sin β` | `s α̇ sin β + γ̇` |
//!
//! The third turn takes these to components in B. Everything else is this one case told backwards: turned back, R is
//! `R_3(−γ) R_2(−β) R_1(−α)` and ω in B becomes −ω in N, while extrinsic angles are intrinsic ones of the reversed
//! sequence in reverse.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;
use std::str::FromStr;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::error::{Error, MotionFault, all_finite};
use crate::motion::kinematics::Frame;

/// Three axes to turn about one after the other.
///
/// Intrinsic (`"ZXZ"`): about the axes of the turning body, `R_NB = R_1(α) R_2(β) R_3(γ)`.
/// Extrinsic (`"zxz"`): about the axes fixed in space, `R_NB = R_3(γ) R_2(β) R_1(α)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sequence {
    axes: [usize; 3],
    intrinsic: bool,
}

impl FromStr for Sequence {
    type Err = Error;

    /// `"ZXZ"` (= `"goldstein"`, `"landau"`), `"ZYX"` (= `"aerospace"`) and so on; lower case is extrinsic.
    fn from_str(text: &str) -> Result<Self, Error> {
        let fault = || {
            Error::Motion(MotionFault::EulerSequence {
                got: text.to_owned(),
            })
        };
        let letters = match text {
            "goldstein" | "landau" => "ZXZ",
            "aerospace" => "ZYX",
            other => other,
        };
        let intrinsic = letters.chars().all(|c| c.is_ascii_uppercase());
        if !intrinsic && !letters.chars().all(|c| c.is_ascii_lowercase()) {
            return Err(fault());
        }
        let axes: Vec<usize> = letters
            .to_ascii_lowercase()
            .chars()
            .filter_map(|c| "xyz".find(c))
            .collect();
        match axes[..] {
            [a, b, c] if letters.len() == 3 && a != b && b != c => Ok(Self {
                axes: [a, b, c],
                intrinsic,
            }),
            _ => Err(fault()),
        }
    }
}

impl fmt::Display for Sequence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters = if self.intrinsic {
            ["X", "Y", "Z"]
        } else {
            ["x", "y", "z"]
        };
        self.axes
            .iter()
            .try_for_each(|&axis| f.write_str(letters[axis]))
    }
}

impl Sequence {
    /// Whether the first and the third axis are the same.
    #[inline]
    fn is_proper(self) -> bool {
        self.axes[0] == self.axes[2]
    }
}

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
        Ok([wrap_angle(first), middle, wrap_angle(third)])
    }
}

/// The same angle in [−π, π].
#[inline]
fn wrap_angle(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
    }
}

/// The one case: an intrinsic sequence, ω in B.
struct Turns {
    axes: [usize; 3],
    angles: [f64; 3],
    /// Whether first and third have changed places.
    reversed: bool,
}

impl Sequence {
    /// Angular velocity ω of B relative to N, from angles and their rates; components in `frame`.
    ///
    /// For ZXZ in B: `(φ̇ sin θ sin ψ + θ̇ cos ψ, φ̇ sin θ cos ψ − θ̇ sin ψ, φ̇ cos θ + ψ̇)`; in N:
    /// `(θ̇ cos φ + ψ̇ sin θ sin φ, θ̇ sin φ − ψ̇ sin θ cos φ, φ̇ + ψ̇ cos θ)`. Defined at every angle.
    /// Source: msl26; Goldstein, Classical Mechanics, §4.9; Landau and Lifshitz, Mechanics, §35.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::nalgebra::Vector3;
    /// use polhode::motion::euler_angles::Sequence;
    /// use polhode::motion::kinematics::Frame;
    ///
    /// let sequence: Sequence = "ZXZ".parse()?;
    /// let (angles, rates) = ([0.4, 1.1, -0.2], [2.0, 0.0, 0.0]); // precession alone
    /// let omega = sequence.angular_velocity(&angles, &rates, Frame::Space);
    /// assert!((omega - Vector3::new(0.0, 0.0, 2.0)).amax() < 1e-15);
    /// assert!((sequence.rates(&angles, &omega, Frame::Space)?[0] - 2.0).abs() < 1e-14);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn angular_velocity(
        self,
        angles: &[f64; 3],
        rates: &[f64; 3],
        frame: Frame,
    ) -> Vector3<f64> {
        let turns = self.turns(angles, frame);
        let [first, middle, third] = turns.in_order(*rates);
        let ([a, b, c], (sine, cosine)) = (turns.axes, turns.angles[1].sin_cos());
        let (k, sign) = across(a, b);
        let mut between = Vector3::zeros();
        between[a] = first * cosine;
        between[b] = middle;
        between[k] = sign * first * sine;
        between[c] += third;
        rotate_vector(&between, c, -turns.angles[2])
    }

    /// Rates of the angles, from angles and angular velocity ω of B relative to N with components in `frame`.
    ///
    /// For ZXZ from ω in B: `φ̇ = (ω_x sin ψ + ω_y cos ψ)/sin θ`, `θ̇ = ω_x cos ψ − ω_y sin ψ`, `ψ̇ = ω_z − φ̇ cos θ`.
    /// Source: msl26; mln27, second step.
    ///
    /// # Errors
    /// [`MotionFault::SingularEulerRates`] where the sine of the middle angle (for sequences of three different axes its cosine)
    /// is below [`SINGULAR`].
    pub fn rates(
        self,
        angles: &[f64; 3],
        omega: &Vector3<f64>,
        frame: Frame,
    ) -> Result<[f64; 3], Error> {
        let (turns, [first, middle, third], divisor) = self.rates_and_divisor(angles, omega, frame);
        if divisor.abs() < SINGULAR {
            return Err(MotionFault::SingularEulerRates {
                sequence: self.to_string(),
                middle: angles[1],
            }
            .into());
        }
        Ok(turns.in_order([first, middle, third]))
    }

    /// Rate of the middle angle, which is defined where those of the others are not.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::motion::euler_angles::{SINGULAR, Sequence};
    /// use polhode::motion::kinematics::Frame;
    /// use polhode::nalgebra::Vector3;
    ///
    /// // A top that stands upright and begins to lean: θ̇ is known, φ̇ and ψ̇ are not.
    /// let sequence: Sequence = "ZXZ".parse()?;
    /// let upright = [0.3, 0.5 * SINGULAR, 0.0];
    /// let omega = Vector3::new(0.7, 0.0, 9.0);
    /// assert_eq!(sequence.middle_rate(&upright, &omega, Frame::Body), 0.7);
    /// assert!(sequence.rates(&upright, &omega, Frame::Body).is_err());
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn middle_rate(self, angles: &[f64; 3], omega: &Vector3<f64>, frame: Frame) -> f64 {
        let (_, [_, middle, _], _) = self.rates_and_divisor(angles, omega, frame);
        middle
    }

    /// The turns, their three rates, and what the first and the third have been divided by.
    fn rates_and_divisor(
        self,
        angles: &[f64; 3],
        omega: &Vector3<f64>,
        frame: Frame,
    ) -> (Turns, [f64; 3], f64) {
        let turns = self.turns(angles, frame);
        let ([a, b, c], (sine, cosine)) = (turns.axes, turns.angles[1].sin_cos());
        let (k, sign) = across(a, b);
        let between = rotate_vector(omega, c, turns.angles[2]);
        let (first, third, divisor) = if self.is_proper() {
            let first = sign * between[k] / sine;
            (first, between[a] - first * cosine, sine)
        } else {
            let first = between[a] / cosine;
            (first, between[k] - sign * first * sine, cosine)
        };
        (turns, [first, between[b], third], divisor)
    }

    fn turns(self, angles: &[f64; 3], frame: Frame) -> Turns {
        let (mut axes, mut angles) = (self.axes, *angles);
        let is_space = frame == Frame::Space;
        let reversed = self.intrinsic == is_space;
        if reversed {
            axes.reverse();
            angles.reverse();
        }
        if is_space {
            angles = angles.map(|angle| -angle);
        }
        Turns {
            axes,
            angles,
            reversed,
        }
    }
}

impl Turns {
    /// The three in the caller's order from ours, and the other way round.
    fn in_order(&self, [first, middle, third]: [f64; 3]) -> [f64; 3] {
        if self.reversed {
            [third, middle, first]
        } else {
            [first, middle, third]
        }
    }
}

/// The axis k across a and b, and the sign of `e_k` in `e_a×e_b`.
fn across(a: usize, b: usize) -> (usize, f64) {
    (3 - a - b, if (a + 1) % 3 == b { 1.0 } else { -1.0 })
}

/// The vector turned about an axis.
fn rotate_vector(vector: &Vector3<f64>, axis: usize, angle: f64) -> Vector3<f64> {
    let (sine, cosine) = angle.sin_cos();
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut result = *vector;
    result[i] = cosine * vector[i] - sine * vector[j];
    result[j] = sine * vector[i] + cosine * vector[j];
    result
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;

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

    const ANGLES: [f64; 3] = [0.7, 1.1, -2.3];
    const RATES: [f64; 3] = [0.4, -1.3, 2.9];

    #[test]
    fn zxz_as_textbooks_print_it() {
        let sequence: Sequence = "ZXZ".parse().expect("valid");
        let [(sin_phi, cos_phi), (sin, cos), (sin_psi, cos_psi)] = ANGLES.map(f64::sin_cos);
        let [phi, theta, psi] = RATES;
        let in_body = Vector3::new(
            phi * sin * sin_psi + theta * cos_psi,
            phi * sin * cos_psi - theta * sin_psi,
            phi * cos + psi,
        );
        let in_space = Vector3::new(
            theta * cos_phi + psi * sin * sin_phi,
            theta * sin_phi - psi * sin * cos_phi,
            phi + psi * cos,
        );
        for (frame, expected) in [(Frame::Body, in_body), (Frame::Space, in_space)] {
            let omega = sequence.angular_velocity(&ANGLES, &RATES, frame);
            assert!((omega - expected).norm() < 1e-15 * 4.0, "{frame:?}");
        }
    }

    #[test]
    fn every_sequence_agrees_with_its_rotation_and_there_and_back() {
        for text in [
            "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX",
        ] {
            for text in [text.to_owned(), text.to_lowercase()] {
                let sequence: Sequence = text.parse().expect("valid");
                let at = |t: f64| {
                    let angles = std::array::from_fn(|k| ANGLES[k] + t * RATES[k]);
                    sequence.to_quaternion(&angles).expect("finite")
                };
                // The turn in a short time around now, by symmetric differences of third order.
                let turn = |h: f64| (at(h) * at(-h).inverse()).scaled_axis() / (2.0 * h);
                let measured = (turn(1e-3) * 4.0 - turn(2e-3)) / 3.0;
                let in_space = sequence.angular_velocity(&ANGLES, &RATES, Frame::Space);
                assert!((in_space - measured).norm() < 1e-10, "{text}");
                let in_body = sequence.angular_velocity(&ANGLES, &RATES, Frame::Body);
                assert!((at(0.0) * in_body - in_space).norm() < 1e-14, "{text}");
                for (frame, omega) in [(Frame::Body, in_body), (Frame::Space, in_space)] {
                    let back = sequence.rates(&ANGLES, &omega, frame).expect("regular");
                    assert!(
                        (0..3).all(|k| (back[k] - RATES[k]).abs() < 1e-14),
                        "{text}: {back:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn poles_are_told_and_the_middle_rate_remains() {
        let (proper, mixed): (Sequence, Sequence) =
            ("ZXZ".parse().expect("valid"), "zyx".parse().expect("valid"));
        for (sequence, pole) in [(proper, 0.0), (mixed, FRAC_PI_2)] {
            let angles = [0.3, pole, 0.2];
            let omega = sequence.angular_velocity(&angles, &RATES, Frame::Body);
            let fault = sequence.rates(&angles, &omega, Frame::Body);
            assert!(matches!(
                fault,
                Err(Error::Motion(MotionFault::SingularEulerRates { .. }))
            ));
            let middle = sequence.middle_rate(&angles, &omega, Frame::Body);
            assert!((middle - RATES[1]).abs() < 1e-15 * 4.0);
        }
        let nan = proper.rates(&[0.1, f64::NAN, 0.2], &Vector3::x(), Frame::Body);
        assert!(nan.expect("not singular").iter().any(|x| x.is_nan()));
    }
}
