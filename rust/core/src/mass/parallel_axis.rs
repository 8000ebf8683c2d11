//! Parallel-axis theorem (mex69).

use nalgebra::{Matrix3, Vector3};

/// `m (d·d 1 − d dᵀ)`: the inertia tensor about P of a particle of mass `m` at the displacement `d` from P.
///
/// Each diagonal element is a sum of squares, so that nothing cancels.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Matrix3;
/// use polhode::nalgebra::Vector3;
/// use polhode::mass::parallel_axis::point_inertia;
///
/// let inertia = point_inertia(2.0, &Vector3::new(3.0, 0.0, 0.0)); // m (d² 1 − d dᵀ)
/// assert_eq!(inertia, Matrix3::from_diagonal(&Vector3::new(0.0, 18.0, 18.0)));
/// ```
#[doc(alias = "point mass")]
#[must_use]
pub fn point_inertia(mass: f64, d: &Vector3<f64>) -> Matrix3<f64> {
    let md = d * mass;
    let (xx, yy, zz) = (md.x * d.x, md.y * d.y, md.z * d.z);
    let (xy, xz, yz) = (0.0 - md.x * d.y, 0.0 - md.x * d.z, 0.0 - md.y * d.z); // no negative zeros
    Matrix3::new(yy + zz, xy, xz, xy, xx + zz, yz, xz, yz, xx + yy)
}

/// Parallel-axis (Steiner, Huygens) theorem, from the centre of mass: `I_P = I_C + m (d·d 1 − d dᵀ)`.
///
/// `inertia`: about C, in any axes. `d`: from C to P or from P to C (its sign does not matter), same axes.
/// Valid only *from* C: between two other points go through C.
/// Source: mex69; Goldstein, Classical Mechanics, §5.3.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Matrix3;
/// use polhode::nalgebra::Vector3;
/// use polhode::mass::parallel_axis::from_center_of_mass;
///
/// // A ball of 2/5 m r² = 1 kg m² rolls about the line that it touches: m r² more.
/// let about = from_center_of_mass(&Matrix3::identity(), 2.5, &Vector3::new(0.0, 0.0, 1.0));
/// assert_eq!(about[(0, 0)], 1.0 + 2.5);
/// ```
#[doc(alias = "Steiner")]
#[doc(alias = "Huygens")]
#[must_use]
pub fn from_center_of_mass(inertia: &Matrix3<f64>, mass: f64, d: &Vector3<f64>) -> Matrix3<f64> {
    inertia + point_inertia(mass, d)
}

/// Parallel-axis theorem, to the centre of mass: `I_C = I_P − m (d·d 1 − d dᵀ)`.
///
/// `inertia`: about P. `d`: from C to P or back. The difference loses digits when P is many radii of gyration away;
/// whether it is a possible tensor is for [`RigidBody`](crate::RigidBody) to say.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Matrix3;
/// use polhode::nalgebra::Vector3;
/// use polhode::mass::parallel_axis::{from_center_of_mass, to_center_of_mass};
///
/// let (central, d) = (Matrix3::identity(), Vector3::new(1.0, 2.0, 3.0));
/// let about = from_center_of_mass(&central, 2.0, &d);
/// assert_eq!(to_center_of_mass(&about, 2.0, &d), central);
/// ```
#[must_use]
#[inline]
pub fn to_center_of_mass(inertia: &Matrix3<f64>, mass: f64, d: &Vector3<f64>) -> Matrix3<f64> {
    inertia - point_inertia(mass, d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rod_about_its_end_has_four_times_the_moment() {
        let (m, l) = (3.0, 2.0);
        let about_center =
            Matrix3::from_diagonal(&Vector3::new(m * l * l / 12.0, m * l * l / 12.0, 0.0));
        let about_end = from_center_of_mass(&about_center, m, &Vector3::new(0.0, 0.0, l / 2.0));
        assert!((about_end[(0, 0)] - m * l * l / 3.0).abs() < 1e-15);
        assert_eq!(about_end[(2, 2)], 0.0);
        let back = to_center_of_mass(&about_end, m, &Vector3::new(0.0, 0.0, -l / 2.0));
        assert!((back - about_center).abs().max() < 1e-15);
    }
}
