//! Angular momentum of a rigid body in three parts.

use nalgebra::Vector3;

use crate::mass::RigidBody;
use crate::numerics::power_of_two::times_cross;

/// `L = m R×v + m [R×(ω×c_P) + c_P×v] + I_P ω` about the inertial origin.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::angular_momentum::{AngularMomentum, angular_momentum};
/// use polhode::nalgebra::Vector3;
///
/// // A wheel of 10 kg rolls along x, 3 m beside the origin: its spin is about −y of space, its path about −z.
/// let wheel = solids::cylinder(0.5, 0.1, Amount::Mass(10.0))?;
/// let (spin, velocity) = (Vector3::new(0.0, 0.0, 4.0), Vector3::new(2.0, 0.0, 0.0));
/// let AngularMomentum { orbital, mixed, spin } =
///     angular_momentum(&wheel, &spin, &velocity, &Vector3::new(0.0, 3.0, 0.0), &Vector3::zeros());
/// assert_eq!(orbital.z, -60.0);
/// assert_eq!(mixed, Vector3::zeros()); // about the centre of mass
/// assert!((spin.z - 5.0).abs() < 1e-14); // ½ m r² ω
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularMomentum {
    /// `m R×v`, of a particle of the body's mass at P.
    pub orbital: Vector3<f64>,
    /// `m [R×(ω×c_P) + c_P×v]`; zero for P = C.
    pub mixed: Vector3<f64>,
    /// `I_P ω`.
    pub spin: Vector3<f64>,
}

impl AngularMomentum {
    /// The sum of the three parts, which does not depend on P.
    #[must_use]
    pub fn total(&self) -> Vector3<f64> {
        self.orbital + self.mixed + self.spin
    }
}

/// Angular momentum of `body` about the inertial origin.
///
/// The point P of the body (`about`, from the origin of B) is at R (`position`) and moves with v (`velocity`) while the
/// body turns with ω (`omega`); all components in B. `c_P = C − P`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::angular_momentum::angular_momentum;
///
/// // A ball on an orbit: its spin I ω, and r × m v.
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
/// let (spin, velocity) = (Vector3::new(0.0, 0.0, 3.0), Vector3::new(0.0, 2.0, 0.0));
/// let place = Vector3::new(10.0, 0.0, 0.0);
/// let found = angular_momentum(&ball, &spin, &velocity, &place, &Vector3::zeros());
/// assert!((found.total().z - (2.0 * 3.0 + 5.0 * 10.0 * 2.0)).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn angular_momentum(
    body: &RigidBody,
    omega: &Vector3<f64>,
    velocity: &Vector3<f64>,
    position: &Vector3<f64>,
    about: &Vector3<f64>,
) -> AngularMomentum {
    let c = body.center_of_mass() - about;
    let m = body.mass();
    let swing = omega.cross(&c);
    AngularMomentum {
        orbital: times_cross(m, position, velocity),
        mixed: times_cross(m, position, &swing) + times_cross(m, &c, velocity),
        spin: spin(body, omega) + times_cross(m, &c, &swing),
    }
}

/// `I_C ω`, by the principal moments that define the body.
fn spin(body: &RigidBody, omega: &Vector3<f64>) -> Vector3<f64> {
    let principal = body.principal();
    let w = principal.axes.tr_mul(omega);
    principal.axes * Vector3::from(principal.moments).component_mul(&w)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids::cuboid};

    #[test]
    fn total_does_not_depend_on_the_point() {
        let body = cuboid(&[1.0, 2.0, 3.0], Amount::Mass(2.0))
            .and_then(|b| b.translated(&Vector3::new(0.3, -1.0, 0.2)));
        let body = body.expect("box");
        let (omega, v, r) = (
            Vector3::new(1.0, -2.0, 0.5),
            Vector3::new(0.1, 0.7, -3.0),
            Vector3::new(5.0, 1.0, 2.0),
        );
        let c = body.center_of_mass();
        let about_c = angular_momentum(&body, &omega, &v, &r, &c);
        assert_eq!(about_c.mixed, Vector3::zeros());
        // The same motion told of another point P: r_P = R + (P − C), v_P = v + ω×(P − C).
        let p = Vector3::new(-0.4, 0.9, 1.7);
        let about_p = angular_momentum(
            &body,
            &omega,
            &(v + omega.cross(&(p - c))),
            &(r + p - c),
            &p,
        );
        assert!((about_p.total() - about_c.total()).norm() < 1e-13 * about_c.total().norm());
    }
}
