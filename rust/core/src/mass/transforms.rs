//! Bodies from bodies: moved, turned, mirrored, scaled.

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT, faint};
use super::provenance::{MomentsFrom, Provenance};
use super::scaling::Units;
use super::validity::{check_mass, check_rotation, mean_of_halves, trace};
use crate::error::{Error, all_finite, all_finite_of_body, finite};
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::principal::{PrincipalAxes, canonical, canonical_to_rounding, with_sign_rule};

impl RigidBody {
    /// The body moved by `d`.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(1.0))?.translated(&Vector3::new(1.0, 2.0, 3.0))?;
    /// assert_eq!(ball.center_of_mass().z, 3.0);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the new centre of mass is not finite.
    #[inline]
    pub fn translated(&self, d: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("displacement", d)?;
        let center_of_mass = self.center_of_mass + d;
        all_finite_of_body("center_of_mass", &center_of_mass)?;
        Ok(Self {
            center_of_mass,
            error_bound: self.error_bound.rounded(&center_of_mass, 0.0),
            ..*self
        })
    }

    /// The body turned about the origin by the rotation matrix R: `C → R C`, `I → R I Rᵀ`; its moments stay as they are.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Rotation3;
    /// use polhode::nalgebra::Vector3;
    ///
    /// let rod = solids::cuboid(&[0.0, 0.0, 6.0], Amount::Mass(1.0))?;
    /// let quarter = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    /// let lying = rod.rotated(&quarter.into_inner())?;
    /// assert!((lying.inertia()[(2, 2)] - 3.0).abs() < 1e-14); // along y now
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When R is not a rotation; a turned centre of mass or tensor that is not finite.
    pub fn rotated(&self, rotation: &Matrix3<f64>) -> Result<Self, Error> {
        check_rotation("rotation", rotation)?;
        let axes = with_sign_rule(rotation * self.principal.axes);
        self.in_new_axes(rotation, rotation * self.center_of_mass, axes)
    }

    /// The mirror image through the plane with this normal through a point: with `M = 1 − 2 n nᵀ`, `C → p + M (C − p)`, `I → M I M`; its
    /// moments stay as they are.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::RigidBody;
    /// use polhode::nalgebra::{Matrix3, Vector3};
    ///
    /// let tensor = Matrix3::new(4.0, -0.5, 0.25, -0.5, 5.0, 0.75, 0.25, 0.75, 6.0);
    /// let left = RigidBody::new(1.0, &tensor, &Vector3::new(1.0, 2.0, 3.0), 0.0)?;
    /// let right = left.mirrored(&Vector3::y(), &Vector3::zeros())?;
    /// assert_eq!(right.center_of_mass(), Vector3::new(1.0, -2.0, 3.0));
    /// assert_eq!(right.inertia()[(0, 1)], 0.5); // products with y change their sign
    /// assert_eq!(right.principal().moments, left.principal().moments);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the normal has no direction; a number that is not finite.
    pub fn mirrored(&self, normal: &Vector3<f64>, point: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("point", point)?;
        let n = unit_normal(normal)?;
        let mirror = Matrix3::identity() - n * n.transpose() * 2.0;
        let center_of_mass = point + mirror * (self.center_of_mass - point);
        let axes = mirror * self.principal.axes;
        let (u, v) = (axes.column(0).into_owned(), axes.column(1).into_owned());
        let axes = with_sign_rule(Matrix3::from_columns(&[u, v, u.cross(&v)]));
        let image = self.in_new_axes(&mirror, center_of_mass, axes)?;
        // The way to the plane is rounded, too.
        let way = ErrorBound::default().rounded(point, 0.0);
        Ok(Self {
            error_bound: ErrorBound {
                center_of_mass: image.error_bound.center_of_mass + 2.0 * way.center_of_mass,
                ..image.error_bound
            },
            ..image
        })
    }

    /// The body whose tensor was taken by an orthogonal matrix, with its new centre of mass and principal axes.
    fn in_new_axes(
        &self,
        matrix: &Matrix3<f64>,
        center_of_mass: Vector3<f64>,
        axes: Matrix3<f64>,
    ) -> Result<Self, Error> {
        let inertia = mean_of_halves(&(matrix * self.inertia * matrix.transpose()));
        all_finite_of_body("center_of_mass", &center_of_mass)?;
        all_finite_of_body("inertia", &inertia)?;
        // The factors by which an element of a turned vector takes up three others are a row of R, whose sizes add up to √3 at
        // most; those of a turned tensor are products of two rows.
        let turned = ErrorBound {
            mass: self.error_bound.mass,
            center_of_mass: 1.75 * self.error_bound.center_of_mass,
            inertia: 3.01 * self.error_bound.inertia,
        };
        let principal = PrincipalAxes {
            moments: self.principal.moments,
            axes,
        };
        Ok(Self {
            mass: self.mass,
            center_of_mass,
            inertia,
            principal: if self.provenance.moments == MomentsFrom::Given {
                canonical(&principal, 0.0)
            } else {
                canonical_to_rounding(&principal)
            },
            error_bound: turned.rounded(&center_of_mass, trace(&inertia)),
            provenance: self.provenance,
        })
    }

    /// The same shape `length` times as large and `mass` times as heavy: `m → k m`, `C → s C`, `I → k s² I`.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?.scaled(2.0, 3.0)?; // twice as long, three times as heavy
    /// assert_eq!(ball.mass(), 15.0);
    /// assert!((ball.principal().moments[0] - 24.0).abs() < 1e-13);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When a factor is not positive and finite, or the result is beyond the range of float64 with all its digits.
    pub fn scaled(&self, length: f64, mass: f64) -> Result<Self, Error> {
        for (what, value) in [("length", length), ("mass", mass)] {
            finite(what, value)?;
            if value <= 0.0 {
                return Err(Error::OutOfDomain {
                    what,
                    law: "positive",
                    value,
                });
            }
        }
        let units = Units {
            mass: exponent(mass),
            length: exponent(length),
            place: exponent(length),
        };
        let (length, mass) = (
            times_power_of_two(length, -units.length),
            times_power_of_two(mass, -units.mass),
        );
        let scale = |x: f64| x * mass * length * length;
        // What moments below the normal numbers lack is seen when they are larger.
        let faint = faint(trace(&self.inertia));
        let scaled = units.in_user_units(&Self {
            mass: self.mass * mass,
            center_of_mass: self.center_of_mass * length,
            inertia: self.inertia.map(scale),
            principal: PrincipalAxes {
                moments: self.principal.moments.map(scale),
                ..self.principal
            },
            error_bound: ErrorBound {
                mass: self.error_bound.mass * mass + 2.0 * UNIT * self.mass * mass,
                center_of_mass: self.error_bound.center_of_mass * length,
                inertia: scale(self.error_bound.inertia + faint),
            }
            .rounded(&(self.center_of_mass * length), scale(trace(&self.inertia))),
            provenance: Provenance {
                rounding: times_power_of_two(self.provenance.rounding * length, units.length),
                ..self.provenance
            },
        })?;
        check_mass(scaled.mass)?;
        all_finite_of_body("inertia", &scaled.inertia)?;
        all_finite_of_body("center_of_mass", &scaled.center_of_mass)?;
        Ok(scaled)
    }
}

/// The unit vector along the normal of a plane.
///
/// # Errors
/// When a component is not finite, or all are zero.
pub(super) fn unit_normal(normal: &Vector3<f64>) -> Result<Vector3<f64>, Error> {
    all_finite("normal", normal)?;
    let largest = normal.amax();
    if largest == 0.0 {
        return Err(Error::NoDirection { what: "normal" });
    }
    let scaled = normal.map(|x| times_power_of_two(x, -exponent(largest)));
    Ok(scaled / scaled.norm())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_survive_rotations_exactly() {
        let axes = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let body = RigidBody::from_principal(
            2.0,
            &[3.0, 2.0, 4.0],
            &Matrix3::identity(),
            &Vector3::x(),
            0.0,
        )
        .expect("body");
        let turned = body.rotated(&axes).expect("turned");
        assert_eq!(turned.principal().moments, [2.0, 3.0, 4.0]);
        let expected = Matrix3::from_diagonal(&Vector3::new(2.0, 3.0, 4.0));
        assert_eq!(turned.inertia(), expected);
        assert_eq!(turned.center_of_mass(), Vector3::y());
    }
}
