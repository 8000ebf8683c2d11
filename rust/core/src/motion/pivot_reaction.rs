//! The force with which a pivot holds a body (mln24).

use nalgebra::{UnitQuaternion, Vector3};

use super::kinematics::point_acceleration;
use crate::mass::RigidBody;

/// Reaction of the pivot: `m [R_NB (ω̇×c_P + ω×(ω×c_P)) − g] − F`, from `m a_C = m g + F + reaction`.
///
/// The point P of the body (`about`, from the origin of B) is fixed in N, or moves uniformly; `c_P = C − P`.
/// `attitude`: `R_NB`. `omega`, `angular_acceleration`: of B relative to N, components in B. `gravity`: g, and `force`: F,
/// the sum of all other forces but the reaction, components in N. The result: force on the body, components in N.
/// Source: mln24.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::pivot_reaction::pivot_reaction;
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // A stone of 2 kg on a rod of 0.5 m, at its lowest place with 6 rad/s: m (g + ω² l).
/// let stone = solids::sphere(0.0, Amount::Mass(2.0))?.translated(&Vector3::new(0.0, 0.0, -0.5))?;
/// let (omega, gravity) = (Vector3::new(6.0, 0.0, 0.0), Vector3::new(0.0, 0.0, -9.81));
/// let zero = Vector3::zeros();
/// let force = pivot_reaction(&stone, &UnitQuaternion::identity(), &omega, &zero, &gravity, &zero, &zero);
/// assert!((force.z - 2.0 * (9.81 + 36.0 * 0.5)).abs() < 1e-13);
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn pivot_reaction(
    body: &RigidBody,
    attitude: &UnitQuaternion<f64>,
    omega: &Vector3<f64>,
    angular_acceleration: &Vector3<f64>,
    gravity: &Vector3<f64>,
    force: &Vector3<f64>,
    about: &Vector3<f64>,
) -> Vector3<f64> {
    let c = body.center_of_mass() - about;
    let of_center = point_acceleration(&c, omega, angular_acceleration, &Vector3::zeros());
    (attitude * of_center - gravity) * body.mass() - force
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids::cuboid};

    #[test]
    fn pendulum_at_its_lowest_point_weighs_more() {
        let (m, l, rate, g) = (2.0, 0.5, 3.0, 9.81);
        let bob = cuboid(&[0.0; 3], Amount::Mass(m))
            .and_then(|bob| bob.translated(&Vector3::new(0.0, 0.0, -l)))
            .expect("bob");
        let zero = Vector3::zeros();
        let force = pivot_reaction(
            &bob,
            &UnitQuaternion::identity(),
            &Vector3::new(rate, 0.0, 0.0),
            &zero,
            &Vector3::new(0.0, 0.0, -g),
            &zero,
            &zero,
        );
        let expected = m * (g + rate * rate * l);
        assert!((force - Vector3::new(0.0, 0.0, expected)).norm() < 1e-14 * expected);
    }
}
