//! What internal dissipation does to the nutation of a free symmetric top: the energy-sink model with a slug.

use crate::error::{Error, finite};
use crate::principal::SymmetricTop;

/// How the angle θ between the symmetry axis and L changes under a small slug in a viscous fluid, to first order in its moment:
/// `tan θ = tan θ₀ e^{rate·t}`.
///
/// A body whose axis has the largest moment comes to rest in its nutation (rate < 0); one whose axis has the least goes over into
/// a flat spin, θ = π/2 (rate > 0): the major-axis rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NutationDamping {
    /// `k (L/I_t)²/((k/J)² + (L/I_t)²) (1/I_s − 1/I_t)`.
    pub rate: f64,
}

/// The energy-sink model: in space ω circles L with the rate `L/I_t` at the distance `L sin θ cos θ (1/I_s − 1/I_t)`, so the slug's
/// rate relative to the body, `η̇ = −(k/J) η − ω̇`, takes the power `k η²` from `T = ½L² (cos²θ/I_s + sin²θ/I_t)`.
///
/// `top`: about C. `momentum`: |L|. `inertia`, `damping`: J and k of the slug, see [`Slug`](super::loads::Slug). Source: Hughes,
/// Spacecraft Attitude Dynamics, chapter 5; Rahn, Barba, Journal of Guidance 14 (1991) 424.
///
/// # Examples
///
/// ```
/// use polhode::motion::nutation_damping::{NutationDamping, nutation_damping};
/// use polhode::principal::{PrincipalAxes, SymmetricTop, TOP_RTOL};
/// use polhode::nalgebra::Matrix3;
///
/// // The same damper steadies a coin and unsettles a cigar, as it did Explorer 1.
/// let rate = |moments| {
///     let top = SymmetricTop::of(&PrincipalAxes { moments, axes: Matrix3::identity() }, TOP_RTOL)?;
///     let NutationDamping { rate } = nutation_damping(&top, 100.0, 0.1, 2.0)?;
///     Ok::<_, polhode::Error>(rate)
/// };
/// assert!(rate([10.0, 10.0, 15.0])? < 0.0);
/// assert!(rate([5.0, 10.0, 10.0])? > 0.0);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// For moments, momentum, J or k that are not positive, and where the rate leaves float64.
pub fn nutation_damping(
    top: &SymmetricTop,
    momentum: f64,
    inertia: f64,
    damping: f64,
) -> Result<NutationDamping, Error> {
    let numbers = [
        ("the axial moment", top.axial),
        ("the transverse moment", top.transverse),
        ("momentum", momentum),
        ("inertia", inertia),
        ("damping", damping),
    ];
    for (what, value) in numbers {
        finite(what, value)?;
        if value <= 0.0 {
            return Err(Error::OutOfDomain {
                what,
                law: "positive",
                value,
            });
        }
    }
    // Ratios, so that numbers of any size stay within float64.
    let (precession, relaxation) = (momentum / top.transverse, damping / inertia);
    let part = precession / precession.hypot(relaxation);
    let excess = (top.transverse - top.axial) / top.axial;
    let rate = relaxation * part * part * (inertia / top.transverse) * excess;
    finite("the rate", rate)?;
    Ok(NutationDamping { rate })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn top(axial: f64) -> SymmetricTop {
        SymmetricTop {
            axis: Vector3::z(),
            axial,
            transverse: 1.0,
        }
    }

    #[test]
    fn the_major_axis_wins() {
        let rate = |axial| {
            nutation_damping(&top(axial), 2.0, 1e-3, 2e-3)
                .expect("positive")
                .rate
        };
        // K = k Λ²/((k/J)² + Λ²) with Λ = 2 and k/J = 2.
        assert!((rate(0.5) - 1e-3).abs() < 1e-18);
        assert!((rate(2.0) + 5e-4).abs() < 1e-18);
        assert_eq!(rate(1.0), 0.0);
    }

    #[test]
    fn any_size_will_do() {
        let small = SymmetricTop {
            axial: 0.5e-40,
            transverse: 1e-40,
            ..top(1.0)
        };
        let rate = nutation_damping(&small, 2e-40, 1e-43, 2e-43)
            .expect("positive")
            .rate;
        assert!((rate / 1e-3 - 1.0).abs() < 1e-14);
        for (momentum, inertia, damping) in
            [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, f64::NAN)]
        {
            assert!(nutation_damping(&top(0.5), momentum, inertia, damping).is_err());
        }
    }
}
