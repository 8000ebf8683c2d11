//! The second moment of a mass distribution, from which its inertia tensor comes.

use nalgebra::{Matrix3, Vector3};

use super::error_bound::ErrorBound;
use crate::numerics::eigen3::Eigen3;
use crate::principal::{PrincipalAxes, canonical_to_rounding, with_sign_rule};

/// Mass, centre of mass and second moment `S = ∫ (r − c)(r − c)ᵀ dm` about it.
///
/// The inertia tensor is `I = tr(S) 1 − S`. Working with S keeps the smallest principal moment of a thin body:
/// `I₁ = s₁ + s₂` is a sum of positive numbers, where the same moment from a rounded I is a difference of large ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondMoment {
    /// ∫ dm.
    pub mass: f64,
    /// C, from the origin of the body frame.
    pub center_of_mass: Vector3<f64>,
    /// S = V `central` Vᵀ: about C, in the axes V, symmetric.
    pub central: Matrix3<f64>,
    /// V: a rotation whose columns are the axes that `central` is expressed in.
    pub axes: Matrix3<f64>,
    /// What rounding can have done to mass, centre of mass and inertia tensor.
    pub error_bound: ErrorBound,
}

impl SecondMoment {
    /// From sums about a reference point: mass, `∫ d dm` and `∫ d dᵀ dm` with `d = r − reference`.
    ///
    /// The reference should lie within the body: the parallel-axis step then costs no digits.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::RigidBody;
    /// use polhode::mass::{ErrorBound, SecondMoment};
    /// use polhode::nalgebra::{Matrix3, Vector3};
    ///
    /// // A rod along x from 0 to 6, of 1 kg: ∫ x dm = 3, ∫ x² dm = 12.
    /// let first = Vector3::new(3.0, 0.0, 0.0);
    /// let second = Matrix3::from_diagonal(&Vector3::new(12.0, 0.0, 0.0));
    /// let rod = SecondMoment::about_reference(&Vector3::zeros(), 1.0, &first, &second, ErrorBound::default());
    /// assert_eq!(rod.inertia()[(2, 2)], 3.0); // m l²/12
    /// assert_eq!(RigidBody::from_second_moment(&rod)?.center_of_mass().x, 3.0);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub fn about_reference(
        reference: &Vector3<f64>,
        mass: f64,
        first: &Vector3<f64>,
        second: &Matrix3<f64>,
        error_bound: ErrorBound,
    ) -> Self {
        let d = first / mass;
        Self {
            mass,
            center_of_mass: reference + d,
            central: second - first * d.transpose(),
            axes: Matrix3::identity(),
            error_bound,
        }
    }

    /// `S` in body axes.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{ErrorBound, SecondMoment};
    /// use polhode::nalgebra::{Matrix3, Rotation3, Vector3};
    ///
    /// // A rod whose own axis lies along y of the body frame.
    /// let rod = SecondMoment {
    ///     mass: 1.0,
    ///     center_of_mass: Vector3::zeros(),
    ///     central: Matrix3::from_diagonal(&Vector3::new(3.0, 0.0, 0.0)),
    ///     axes: Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2).into_inner(),
    ///     error_bound: ErrorBound::default(),
    /// };
    /// assert!((rod.in_body_axes()[(1, 1)] - 3.0).abs() < 1e-15);
    /// assert!((rod.inertia()[(0, 0)] - 3.0).abs() < 1e-15); // I = tr(S) 1 − S
    /// ```
    #[must_use]
    #[inline]
    pub fn in_body_axes(&self) -> Matrix3<f64> {
        if self.axes == Matrix3::identity() {
            return self.central;
        }
        let turned = self.axes * self.central * self.axes.transpose();
        (turned + turned.transpose()) * 0.5
    }

    /// Inertia tensor about C in body axes, `I = tr(S) 1 − S`, each diagonal element a sum of two of S's.
    #[must_use]
    #[inline]
    pub fn inertia(&self) -> Matrix3<f64> {
        let s = self.in_body_axes();
        let (xy, xz, yz) = (0.0 - s[(0, 1)], 0.0 - s[(0, 2)], 0.0 - s[(1, 2)]); // no negative zeros
        let (x, y, z) = (s[(0, 0)], s[(1, 1)], s[(2, 2)]);
        Matrix3::new(y + z, xy, xz, xy, x + z, yz, xz, yz, x + y)
    }

    /// Principal moments and axes about C, found before S is rounded to body axes; `s` decomposes [`Self::central`].
    ///
    /// The largest principal value of S belongs to the axis of the smallest moment.
    #[must_use]
    #[inline]
    pub(crate) fn principal_axes(&self, s: &Eigen3) -> PrincipalAxes {
        // S is a sum of squares. A negative value within rounding is set to zero. A larger negative value (an unchecked mesh)
        // is kept.
        let rounding = 1e-12 * s.values[2].abs() + 4.0 * self.error_bound.inertia;
        let [s1, s2, s3] = (s.values).map(|value| {
            if value < -rounding {
                value
            } else {
                value.max(0.0)
            }
        });
        let column = |k: usize| self.axes * s.vectors.column(k);
        let (u, v) = (column(2), column(1));
        canonical_to_rounding(&PrincipalAxes {
            moments: [s1 + s2, s1 + s3, s2 + s3],
            axes: with_sign_rule(Matrix3::from_columns(&[u, v, u.cross(&v)])),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::RigidBody;
    use crate::numerics::eigen3::eigen3;

    #[test]
    fn a_negative_square_is_zero_as_far_as_rounding_goes() {
        for bound in [0.0, 1e-6] {
            let limit = 1e-12 + 4.0 * bound;
            for (negative, is_rounding) in [(0.99 * limit, true), (1.01 * limit, false)] {
                let central = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -negative));
                let matter = SecondMoment {
                    mass: 1.0,
                    center_of_mass: Vector3::zeros(),
                    central,
                    axes: Matrix3::identity(),
                    error_bound: ErrorBound {
                        mass: 0.0,
                        center_of_mass: 0.0,
                        inertia: bound,
                    },
                };
                let [i1, _, i3] = matter.principal_axes(&eigen3(&central)).moments;
                assert_eq!(i1 == 1.0, is_rounding, "{negative:e} {i1:?}");
                assert_eq!(i3, 2.0);
            }
        }
    }

    /// A square of −s makes a deficit of 2 s, which may be 2·10⁻¹² of the largest moment and seven times the bound.
    #[test]
    fn beyond_rounding_no_matter_has_a_negative_square() {
        for bound in [0.0, 1e-6] {
            let limit = 2e-12 + 3.5 * bound;
            for (negative, is_rounding) in [(0.99 * limit, true), (1.01 * limit, false)] {
                let matter = SecondMoment {
                    mass: 1.0,
                    center_of_mass: Vector3::zeros(),
                    central: Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -negative)),
                    axes: Matrix3::identity(),
                    error_bound: ErrorBound {
                        inertia: bound,
                        ..ErrorBound::default()
                    },
                };
                let body = RigidBody::from_second_moment(&matter).expect("numbers");
                let found = body.check_possible();
                assert_eq!(found.is_ok(), is_rounding, "{negative:e} {found:?}");
            }
        }
    }
}
