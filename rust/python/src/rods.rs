//! Homogeneous thin rods.

use polhode::mass::rods;
use pyo3::prelude::*;

use crate::body::PyRigidBody;
use crate::shapes::{Optional, lengths, shape, shape_function};

shape_function! {
    /// Thin rod along z: I_x = I_y = m L²/12, I_z = 0.
    ///
    /// Parameters
    /// ----------
    /// length : array_like, shape (...)
    ///     Full length L.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two; the density is mass per length.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import rods
    /// >>> rods.rod(2.0, mass=3.0).principal_moments
    /// array([0., 1., 1.])
    rod(length) = rods::rod
}

shape_function! {
    /// Thin ring about z: I_z = m R², I_x = I_y = ½ m R².
    ///
    /// Parameters
    /// ----------
    /// radius : array_like, shape (...)
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two; the density is mass per length.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import rods
    /// >>> rods.ring(2.0, mass=1.0).principal_moments
    /// array([2., 2., 4.])
    ring(radius) = rods::ring
}

/// Thin arc of a circle in the x-y plane, its middle toward +x, its centre of mass at the origin.
///
/// The centre of the circle is at x = −R sin(α/2)/(α/2).
///
/// Parameters
/// ----------
/// radius : array_like, shape (...)
///     R of the circle.
/// angle : array_like, shape (...)
///     α that the arc spans, in radians, at most 2π.
/// mass, density : array_like, shape (...)
///     Exactly one of the two; the density is mass per length.
/// degrees : bool, optional
///     The angle is in degrees, at most 360.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// Half a ring about the centre of its circle:
///
/// >>> import math
/// >>> from polhode import rods
/// >>> half = rods.arc(radius=2.0, angle=math.pi, mass=1.0)
/// >>> half.inertia_about((-4 / math.pi, 0, 0)).diagonal().round(12)
/// array([2., 2., 4.])
#[pyfunction]
#[pyo3(signature = (radius, angle, *, mass=None, density=None, degrees=false))]
pub(crate) fn arc(
    radius: &Bound<'_, PyAny>,
    angle: &Bound<'_, PyAny>,
    mass: Optional<'_, '_>,
    density: Optional<'_, '_>,
    degrees: bool,
) -> PyResult<PyRigidBody> {
    let (names, sizes) = (["radius", "angle"], [radius, angle]);
    if degrees {
        let turned = shape!(
            "rods::arc in degrees",
            |&[r, angle]| 2,
            rods::arc,
            r,
            angle * 1.0_f64.to_radians()
        );
        return lengths(names, sizes, (mass, density), turned);
    }
    let turned = shape!("rods::arc", |&[r, angle]| 2, rods::arc, r, angle);
    lengths(names, sizes, (mass, density), turned)
}
