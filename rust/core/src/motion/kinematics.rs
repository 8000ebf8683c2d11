//! Kinematics of a rigid body: the velocity and acceleration of any of its points, and rates seen from moving frames
//! (mln24, mln27).

use nalgebra::Vector3;

/// The frame that the components of a vector refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// B, which turns with the body.
    Body,
    /// N, which is inertial.
    Space,
}

/// Velocity of a point of the body: `v = v_P + ω×r`.
///
/// `arm`: r, from the point P of the body to the point asked for. `omega`: of B relative to N. `velocity`: `v_P`, of P
/// relative to N. All components in the same axes, whichever; in those the result is.
/// Source: mln24.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::kinematics::point_velocity;
///
/// // The top of a wheel of radius 1 that rolls with 2 m/s is twice as fast, the place that touches at rest.
/// let (spin, velocity) = (Vector3::new(0.0, 2.0, 0.0), Vector3::new(2.0, 0.0, 0.0));
/// assert_eq!(point_velocity(&Vector3::z(), &spin, &velocity).x, 4.0);
/// assert_eq!(point_velocity(&-Vector3::z(), &spin, &velocity).x, 0.0);
/// ```
#[inline(always)]
#[must_use]
pub fn point_velocity(
    arm: &Vector3<f64>,
    omega: &Vector3<f64>,
    velocity: &Vector3<f64>,
) -> Vector3<f64> {
    velocity + omega.cross(arm)
}

/// Acceleration of a point of the body: `a = a_P + ω̇×r + ω×(ω×r)`, of which the last part points to the axis.
///
/// `arm`: r, from the point P of the body to the point asked for. `omega`, `angular_acceleration`: of B relative to N.
/// `acceleration`: `a_P`, of P relative to N. All components in the same axes, whichever; in those the result is.
/// (ω̇ needs no frame: `(dω/dt)_N = (dω/dt)_B`, since ω×ω = 0.)
/// Source: mln24.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::kinematics::point_acceleration;
///
/// let (arm, spin, none) = (Vector3::x() * 0.5, Vector3::z() * 4.0, Vector3::zeros());
/// assert_eq!(point_acceleration(&arm, &spin, &none, &none).x, -8.0); // −ω² r
/// ```
#[inline(always)]
#[must_use]
pub fn point_acceleration(
    arm: &Vector3<f64>,
    omega: &Vector3<f64>,
    angular_acceleration: &Vector3<f64>,
    acceleration: &Vector3<f64>,
) -> Vector3<f64> {
    acceleration + angular_acceleration.cross(arm) + omega.cross(&omega.cross(arm))
}

/// Rate of a vector A in the inertial frame from its rate in a turning one: `(dA/dt)_N = (dA/dt)_F + Ω×A`.
///
/// `rate_in_frame`: derivatives of the components of A in F. `frame_omega`: Ω, of F relative to N. All components in the
/// same axes, whichever; in those the result is. From N back to F the same formula serves with −Ω.
/// Source: mln27; for A = L and F = B it gives Euler's equations.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::kinematics::transport;
///
/// // A vector at rest in a frame that turns: ω × v.
/// let rate = transport(&Vector3::zeros(), &Vector3::x(), &(Vector3::z() * 3.0));
/// assert_eq!(rate, Vector3::new(0.0, 3.0, 0.0));
/// ```
#[doc(alias = "Coriolis theorem")]
#[inline(always)]
#[must_use]
pub fn transport(
    rate_in_frame: &Vector3<f64>,
    vector: &Vector3<f64>,
    frame_omega: &Vector3<f64>,
) -> Vector3<f64> {
    rate_in_frame + frame_omega.cross(vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wheel_rolling_without_slip() {
        // Along x with speed v on the plane y = 0, axis through (0, R): ω = −v/R about z.
        let (v, radius) = (3.0, 0.5);
        let (omega, velocity) = (
            Vector3::new(0.0, 0.0, -v / radius),
            Vector3::new(v, 0.0, 0.0),
        );
        let contact = Vector3::new(0.0, -radius, 0.0);
        assert_eq!(
            point_velocity(&contact, &omega, &velocity),
            Vector3::zeros()
        );
        let top = point_velocity(&-contact, &omega, &velocity);
        assert_eq!(top, Vector3::new(2.0 * v, 0.0, 0.0));
        let still = Vector3::zeros();
        let upward = point_acceleration(&contact, &omega, &still, &still);
        assert_eq!(upward, Vector3::new(0.0, v * v / radius, 0.0));
    }

    #[test]
    fn vector_fixed_in_a_turning_frame() {
        let rate = transport(&Vector3::zeros(), &Vector3::x(), &(Vector3::z() * 2.0));
        assert_eq!(rate, Vector3::new(0.0, 2.0, 0.0));
        assert_eq!(
            transport(&rate, &Vector3::x(), &(Vector3::z() * -2.0)),
            Vector3::zeros()
        );
    }
}
