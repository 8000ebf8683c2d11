//! Euler's equations (mln27): `I_P ω̇ + ω × I_P ω = N_P`.

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, MotionFault};
use crate::mass::RigidBody;
use crate::mass::provenance::MomentsFrom;
use crate::mass::refined::RefinedPrincipal;
use crate::mass::validity::ROUNDING;
use crate::numerics::double_double::DoubleDouble;
use crate::principal::PrincipalAxes;

/// Euler's equations of one body about one point: its principal moments and axes there.
///
/// The point is the centre of mass of a body that moves freely, or a point of the body that is fixed in space.
///
/// # Examples
///
/// ```
/// use polhode::mass::refined::RefinedPrincipal;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::euler_equations::EulerEquations;
/// use polhode::nalgebra::Vector3;
///
/// // A brick of 12 kg, its moments 5, 8 and 5 kg m² about x, y and z … in ascending order 15, 37 and 52.
/// let brick = solids::cuboid(&[6.0, 3.0, 2.0_f64.sqrt() * 2.0], Amount::Mass(12.0))?;
/// let equations = EulerEquations::about(&brick, &Vector3::zeros());
/// let (omega, torque) = (Vector3::new(0.1, 2.0, 0.3), Vector3::new(1.0, 0.0, -2.0));
/// // ω̇₁ = (N₁ + (I₂ − I₃) ω₂ ω₃)/I₁ along the principal axes,
/// let ([i1, ..], [d1, ..]) = (equations.moments(), equations.differences());
/// let along = equations.principal_acceleration(&omega, &torque)?;
/// assert!((along.x - (1.0 + d1 * 2.0 * 0.3) / i1).abs() < 1e-15);
/// // and in the body frame the torque that it takes is the one that was given.
/// let found = equations.angular_acceleration(&omega, &torque)?;
/// assert!((equations.torque(&omega, &found) - torque).amax() < 1e-13);
/// // For long motions the moments are found to twice the precision first.
/// let refined = EulerEquations::refined_about(&brick, &Vector3::zeros());
/// assert_eq!(refined, EulerEquations::of_refined(&RefinedPrincipal::of(&brick)));
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EulerEquations {
    moments: [f64; 3],
    /// I₂ − I₃, I₃ − I₁, I₁ − I₂.
    differences: [f64; 3],
    axes: Matrix3<f64>,
}

impl EulerEquations {
    /// The equations of `body` about the point P (from the origin of B).
    #[must_use]
    pub fn about(body: &RigidBody, point: &Vector3<f64>) -> Self {
        let PrincipalAxes { moments, axes } = body.principal_about(point);
        let [i1, i2, i3] = moments;
        Self {
            moments,
            differences: [i2 - i3, i3 - i1, i1 - i2],
            axes,
        }
    }

    /// As [`Self::about`], for long motions: about the centre of mass, moments, their differences and axes are found to
    /// twice the precision before they are rounded.
    ///
    /// Eigenvalues of a tensor are good to about ε I₃; beside the least moment of a thin body, or the gap of two that are
    /// nearly equal, that is much.
    #[must_use]
    pub fn refined_about(body: &RigidBody, point: &Vector3<f64>) -> Self {
        if *point != body.center_of_mass() || body.provenance().moments != MomentsFrom::Tensor {
            return Self::about(body, point);
        }
        Self::of_refined(&RefinedPrincipal::of(body))
    }

    /// Of moments and axes that are known to twice the precision.
    #[must_use]
    pub fn of_refined(refined: &RefinedPrincipal) -> Self {
        let [i1, i2, i3] = refined.moments;
        Self {
            moments: refined.moments.map(DoubleDouble::rounded),
            differences: [i2 - i3, i3 - i1, i1 - i2].map(DoubleDouble::rounded),
            axes: refined.rounded_axes(),
        }
    }

    /// Principal moments about P, ascending.
    #[must_use]
    pub fn moments(&self) -> [f64; 3] {
        self.moments
    }

    /// `I₂ − I₃`, `I₃ − I₁`, `I₁ − I₂`: what drives ω₁, ω₂ and ω₃ without a torque.
    #[must_use]
    pub fn differences(&self) -> [f64; 3] {
        self.differences
    }

    /// Principal axes about P (columns, in B).
    #[must_use]
    #[inline]
    pub fn axes(&self) -> &Matrix3<f64> {
        &self.axes
    }

    /// Forward: the angular acceleration ω̇ under the torque N about P; components in B.
    ///
    /// # Errors
    /// [`MotionFault::TorqueAlongMasslessAxis`].
    #[inline]
    pub fn angular_acceleration(
        &self,
        omega: &Vector3<f64>,
        torque: &Vector3<f64>,
    ) -> Result<Vector3<f64>, Error> {
        let (w, n) = (self.axes.tr_mul(omega), self.axes.tr_mul(torque));
        Ok(self.axes * self.principal_acceleration(&w, &n)?)
    }

    /// Forward, all components in principal axes: `ω̇₁ = (N₁ + (I₂ − I₃) ω₂ ω₃)/I₁` and cyclic.
    ///
    /// Along an axis with zero moment ω stays constant, the limit of a thin symmetric rod.
    ///
    /// # Errors
    /// [`MotionFault::TorqueAlongMasslessAxis`].
    #[inline(always)]
    pub fn principal_acceleration(
        &self,
        w: &Vector3<f64>,
        n: &Vector3<f64>,
    ) -> Result<Vector3<f64>, Error> {
        match self.massive_acceleration(w, n) {
            Some([x, y, z]) => Ok(Vector3::new(x, y, z)),
            None => self.massless_acceleration(w, n),
        }
    }

    /// As [`Self::principal_acceleration`] where all moments are positive, else nothing. Three numbers by themselves: they stay in
    /// registers, where a result with an error would be written and read again.
    #[inline(always)]
    pub(crate) fn massive_acceleration(
        &self,
        w: &Vector3<f64>,
        n: &Vector3<f64>,
    ) -> Option<[f64; 3]> {
        let [i1, i2, i3] = self.moments;
        if i1 == 0.0 {
            return None;
        }
        let [d1, d2, d3] = self.differences;
        Some([
            (n.x + d1 * w.y * w.z) / i1,
            (n.y + d2 * w.z * w.x) / i2,
            (n.z + d3 * w.x * w.y) / i3,
        ])
    }

    /// As [`Self::principal_acceleration`] where one or all moments are zero.
    #[cold]
    pub(crate) fn massless_acceleration(
        &self,
        w: &Vector3<f64>,
        n: &Vector3<f64>,
    ) -> Result<Vector3<f64>, Error> {
        let [_, i2, i3] = self.moments;
        let noise = ROUNDING * n.norm();
        let along = |moment: f64, torque: f64, gyroscopic: f64| {
            if moment > 0.0 {
                Ok((torque + gyroscopic) / moment)
            } else if torque.abs() > noise {
                Err(Error::Motion(MotionFault::TorqueAlongMasslessAxis {
                    torque,
                }))
            } else {
                Ok(0.0 * noise) // zero, or NaN with the torque's
            }
        };
        Ok(Vector3::new(
            along(0.0, n.x, 0.0)?,
            along(i2, n.y, i3 * w.z * w.x)?,
            along(i3, n.z, -i2 * w.x * w.y)?,
        ))
    }

    /// Inverse: the torque about P that gives the angular acceleration ω̇; components in B.
    #[must_use]
    pub fn torque(
        &self,
        omega: &Vector3<f64>,
        angular_acceleration: &Vector3<f64>,
    ) -> Vector3<f64> {
        let (w, a) = (
            self.axes.tr_mul(omega),
            self.axes.tr_mul(angular_acceleration),
        );
        let ([i1, i2, i3], [d1, d2, d3]) = (self.moments, self.differences);
        self.axes
            * Vector3::new(
                i1 * a.x - d1 * w.y * w.z,
                i2 * a.y - d2 * w.z * w.x,
                i3 * a.z - d3 * w.x * w.y,
            )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids};

    #[test]
    fn inverse_undoes_forward() {
        let body = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(2.0)).expect("box");
        let equations = EulerEquations::about(&body, &Vector3::new(0.5, 0.1, -0.7));
        let (omega, torque) = (Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 0.2, -4.0));
        let acceleration = equations
            .angular_acceleration(&omega, &torque)
            .expect("solid");
        assert!((equations.torque(&omega, &acceleration) - torque).norm() < 1e-14);
    }

    #[test]
    fn rod_keeps_its_spin_and_refuses_to_be_twisted() {
        let rod = solids::cylinder(0.0, 2.0, Amount::Mass(3.0)).expect("rod");
        let equations = EulerEquations::about(&rod, &Vector3::zeros());
        let omega = Vector3::new(0.0, 2.0, 5.0);
        let free = equations
            .angular_acceleration(&omega, &Vector3::zeros())
            .expect("free");
        assert_eq!(free.z, 0.0);
        // Ω×L with I₁ = 0 along z: ω̇_x = −ω_y ω_z, ω̇_y = ω_z ω_x.
        assert!((free.x - (-10.0)).abs() < 1e-14 || (free.x - 10.0).abs() < 1e-14);
        let twisted = equations.angular_acceleration(&omega, &Vector3::z());
        assert!(matches!(
            twisted,
            Err(Error::Motion(MotionFault::TorqueAlongMasslessAxis { .. }))
        ));
    }
}
