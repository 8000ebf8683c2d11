//! The torque-free symmetric top: body cone, space cone and the two rates of precession (part II).

use nalgebra::Vector3;

use crate::error::Error;
use crate::principal::SymmetricTop;

/// How the symmetry axis n, the angular velocity ω and the angular momentum L of a torque-free symmetric top move.
///
/// The three lie in one plane, which turns about L. In the body ω describes the body cone about n, in space the space
/// cone about L; the body cone rolls on the space cone without slipping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreePrecession {
    /// n, unit vector along the symmetry axis, in B; toward the side of ω.
    pub axis: Vector3<f64>,
    /// `Ω = (I_s − I_t) ω_s/I_t`: rate at which ω and L circle about n, seen from the body. Negative for a prolate top.
    pub body_rate: f64,
    /// `L/I_t`: rate at which n and ω circle about L, seen from space.
    pub space_rate: f64,
    /// Angle between n and ω, in [0, π/2]: half the opening of the body cone.
    pub body_cone: f64,
    /// Angle between L and ω, in [0, π/2): half the opening of the space cone.
    pub space_cone: f64,
    /// Angle between n and L, in [0, π/2]: the Euler angle θ with L along z.
    pub nutation: f64,
}

/// Torque-free precession of a symmetric top: `Ω = (I_s − I_t) ω_s/I_t` in the body, `L/I_t` in space.
///
/// `top`: about C of a free body, or about a fixed point without torque. `omega`: of B relative to N, components in B.
/// With L along z the Euler angles (ZXZ, third axis n) are θ = `nutation`, `φ̇ = space_rate`, `ψ̇ = −body_rate`.
/// Source: part II; Landau and Lifshitz, Mechanics, §33 and §36; Goldstein, Classical Mechanics, §5.6.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::free_precession::{FreePrecession, free_precession};
/// use polhode::nalgebra::Vector3;
/// use polhode::principal::{SymmetricTop, TOP_RTOL};
///
/// // A plate thrown into the air: it wobbles nearly twice as fast as it spins.
/// let plate = solids::cylinder(0.1, 0.0, Amount::Mass(0.3))?;
/// let top = SymmetricTop::of(&plate.principal(), TOP_RTOL)?;
/// let FreePrecession { space_rate, body_rate, nutation, .. } = free_precession(&top, &Vector3::new(0.1, 0.0, 10.0))?;
/// assert!((body_rate - 10.0).abs() < 1e-12); // (I_s − I_t)/I_t = 1
/// assert!((space_rate - 20.0).abs() < 0.01);
/// assert!((nutation.tan() - 0.1 / 20.0).abs() < 1e-15);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`Error::OutOfDomain`] for a point, which has no moment of inertia.
pub fn free_precession(top: &SymmetricTop, omega: &Vector3<f64>) -> Result<FreePrecession, Error> {
    let &SymmetricTop {
        axis,
        axial,
        transverse,
    } = top;
    if transverse == 0.0 {
        return Err(Error::OutOfDomain {
            what: "the transverse moment",
            law: "positive for a body to precess",
            value: transverse,
        });
    }
    let along = omega.dot(&axis);
    let axis = if along < 0.0 { -axis } else { axis };
    let spin = along.abs();
    let across = omega.cross(&axis).norm();
    // In units of I_t, so that the moments may be of any size.
    let ratio = axial / transverse;
    let excess = (axial - transverse) / transverse;
    // L/I_t, split along ω and across it: L×ω = (I_t − I_s) ω_s n×ω.
    let (aligned, askew) = (
        across * across + ratio * spin * spin,
        excess.abs() * spin * across,
    );
    Ok(FreePrecession {
        axis,
        body_rate: excess * spin,
        space_rate: across.hypot(ratio * spin),
        body_cone: across.atan2(spin),
        space_cone: askew.atan2(aligned),
        nutation: across.atan2(ratio * spin),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disk_wobbles_twice_for_each_turn() {
        // Feynman's plate: I_s = 2 I_t, and a slight wobble.
        let plate = SymmetricTop {
            axis: Vector3::z(),
            axial: 2.0,
            transverse: 1.0,
        };
        let wobble = free_precession(&plate, &Vector3::new(1e-9, 0.0, 3.0)).expect("plate");
        assert!((wobble.space_rate - 6.0).abs() < 1e-15);
        assert_eq!(wobble.body_rate, 3.0);
        assert!((wobble.nutation - 1e-9 / 6.0).abs() < 1e-25);
    }

    #[test]
    fn cones_touch_along_omega() {
        for axial in [0.0, 0.4, 1.0, 1.9] {
            let top = SymmetricTop {
                axis: Vector3::z(),
                axial,
                transverse: 1.0,
            };
            let found = free_precession(&top, &Vector3::new(0.3, 0.4, -1.2)).expect("top");
            let sign = if axial > 1.0 { 1.0 } else { -1.0 };
            let sum = found.nutation + sign * found.space_cone;
            assert!((sum - found.body_cone).abs() < 1e-15, "{found:?}");
            assert_eq!(found.axis, -Vector3::z());
        }
        let point = SymmetricTop {
            axis: Vector3::z(),
            axial: 0.0,
            transverse: 0.0,
        };
        assert!(free_precession(&point, &Vector3::x()).is_err());
    }
}
