//! Moments of inertia of a body about points and axes.

use nalgebra::{Matrix3, Vector3};

use super::possible::{RigidBody, clear_noise};
use crate::error::{Error, all_finite, finite};
use crate::mass::parallel_axis::from_center_of_mass;
use crate::mass::validity::trace;
use crate::numerics::power_of_two::{root_of_ratio, times_dot};
use crate::principal::{
    PrincipalAxes, TOP_RTOL, canonical_to_rounding, principal_axes, rounding_rtols,
};

impl RigidBody {
    /// Inertia tensor `I_P` about the point P (from the origin of the body frame).
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let rod = solids::cuboid(&[0.0, 0.0, 6.0], Amount::Mass(1.0))?;
    /// let end = Vector3::new(0.0, 0.0, 3.0);
    /// assert!((rod.inertia_about(&end)[(0, 0)] - 12.0).abs() < 1e-14); // m l²/3
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn inertia_about(&self, point: &Vector3<f64>) -> Matrix3<f64> {
        from_center_of_mass(&self.inertia, self.mass, &(point - self.center_of_mass))
    }

    /// Whether float64 holds the inertia tensor about the point P (from the origin of the body frame): `m d²` may not.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// assert!(ball.check_about(&Vector3::new(1e100, 0.0, 0.0)).is_ok());
    /// assert!(ball.check_about(&Vector3::new(1e200, 0.0, 0.0)).is_err()); // m d² is beyond float64
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NonFinite`], with the moment that is not finite.
    pub fn check_about(&self, point: &Vector3<f64>) -> Result<(), Error> {
        if point.iter().any(|x| !x.is_finite()) {
            return Ok(()); // it is for who takes points to say so
        }
        let moments = self.inertia_about(point).diagonal();
        finite("the moment of inertia about this point", moments.max()).map(|_| ())
    }

    /// Principal moments and axes about the point P.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// let about = ball.principal_about(&Vector3::new(1.0, 0.0, 0.0));
    /// assert!((about.moments[2] - 7.0).abs() < 1e-14); // 2/5 m r² + m r²
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn principal_about(&self, point: &Vector3<f64>) -> PrincipalAxes {
        if *point == self.center_of_mass {
            return self.principal;
        }
        let inertia = self.inertia_about(point);
        let mut about = canonical_to_rounding(&principal_axes(&inertia));
        clear_noise(&mut about, trace(&inertia));
        about
    }

    /// How close moments of this body, about any point, must be to be equal as far as its numbers tell, relative to the
    /// largest: for I₁ = 0, I₁ = I₂ and I₂ = I₃. [`TOP_RTOL`], and more where it is of particles whose coordinates were
    /// rounded by as much as its provenance says.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, Provenance, solids};
    /// use polhode::principal::{Top, classify_within};
    ///
    /// // Atoms of a file that prints three decimals: their moments differ by that rounding.
    /// let body = solids::ellipsoid(&[1.0, 1.0001, 3.0], Amount::Mass(1.0))?;
    /// let provenance = Provenance { rounding: 0.5e-3, ..Provenance::of_particles(4) };
    /// let read = body.with_provenance(provenance);
    /// let moments = read.principal().moments;
    /// let classified = |body: polhode::RigidBody| classify_within(&moments, &body.top_rtols(&moments));
    /// assert_eq!(classified(read), Top::Prolate);
    /// assert_eq!(classified(body), Top::Asymmetric);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn top_rtols(&self, moments: &[f64; 3]) -> [f64; 3] {
        rounding_rtols(self.mass, moments, self.provenance.rounding).map(|rtol| rtol.max(TOP_RTOL))
    }

    /// Moment of inertia about the axis through P with direction `axis`: `n·I_P·n`, n the unit vector along `axis`.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// let (axis, touched) = (Vector3::new(1.0, 1.0, 0.0), Vector3::new(0.0, 0.0, -1.0));
    /// assert!((ball.moment_about(&axis, &touched)? - 7.0).abs() < 1e-14);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When `axis` is zero or not finite, or the moment is beyond all numbers.
    pub fn moment_about(&self, axis: &Vector3<f64>, point: &Vector3<f64>) -> Result<f64, Error> {
        all_finite("axis", axis)?;
        let longest = axis.amax();
        if longest == 0.0 {
            return Err(Error::NoDirection { what: "axis" });
        }
        // Divided by n·n at the end, rather than normalized first, which would round the direction.
        let n = axis / longest;
        let (w, lever) = (
            self.principal.axes.tr_mul(&n),
            n.cross(&(point - self.center_of_mass)),
        );
        let [i1, i2, i3] = self.principal.moments;
        let central = i1 * w.x * w.x + i2 * w.y * w.y + i3 * w.z * w.z;
        let moment = (central + times_dot(self.mass, &lever, &lever)) / n.dot(&n);
        finite("the moment of inertia about the axis", moment)
    }

    /// Radii of gyration `√(I_k / m)` about the principal axes through C, ascending.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    ///
    /// let ring = solids::tube(2.0, 2.0, 0.0, Amount::Mass(3.0))?;
    /// assert!((ring.radii_of_gyration()[2] - 2.0).abs() < 1e-14); // √(I/m)
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn radii_of_gyration(&self) -> [f64; 3] {
        self.principal
            .moments
            .map(|moment| root_of_ratio(moment, self.mass))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagonal(x: f64, y: f64, z: f64) -> Matrix3<f64> {
        Matrix3::from_diagonal(&Vector3::new(x, y, z))
    }

    #[test]
    fn radii_of_what_is_very_heavy_and_light() {
        for (mass, moment, radius) in [
            (1e-200, 1e200, 1e200),
            (1e200, 1e-200, 1e-200),
            (2.0, 8.0, 2.0),
        ] {
            let body = RigidBody::new(
                mass,
                &diagonal(moment, moment, moment),
                &Vector3::zeros(),
                0.0,
            );
            let [found, ..] = body.expect("body").radii_of_gyration();
            assert!((found / radius - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn moments_beyond_all_numbers_are_told() {
        let at = |z: f64| {
            let center = Vector3::new(0.0, 0.0, z);
            RigidBody::from_principal(1.0, &[1.0, 1.0, 2.0], &Matrix3::identity(), &center, 0.0)
                .and_then(|body| body.check_about(&Vector3::zeros()))
        };
        assert_eq!(at(1e154), Ok(()));
        assert!(
            matches!(at(1.4e154), Err(Error::NonFinite { value, .. }) if value == f64::INFINITY)
        );
    }

    /// A point that is no point is for its reader to refuse, by its name.
    #[test]
    fn the_moment_is_not_blamed_for_the_point() {
        let ball = RigidBody::new(1.0, &Matrix3::identity(), &Vector3::zeros(), 0.0).expect("body");
        for x in [f64::NAN, f64::INFINITY] {
            assert_eq!(ball.check_about(&Vector3::new(0.0, x, 0.0)), Ok(()));
        }
    }
}
