//! Homogeneous solids.

use polhode::mass::Amount;
use polhode::mass::solids;
use polhode::{Error, RigidBody};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::{Item, read};
use crate::rigid_body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

/// An optional argument of any array-like kind.
type Given<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Exactly one of mass and density.
pub(crate) fn amount(mass: Option<f64>, density: Option<f64>) -> PyResult<Amount> {
    match (mass, density) {
        (Some(mass), None) => Ok(Amount::Mass(mass)),
        (None, Some(density)) => Ok(Amount::Density(density)),
        _ => Err(PyTypeError::new_err(
            "give exactly one of mass= and density=",
        )),
    }
}

/// Exactly one of masses and densities.
fn amounts(mass: Given<'_, '_>, density: Given<'_, '_>) -> PyResult<Stack<Amount>> {
    match (mass, density) {
        (Some(mass), None) => Ok(read::<f64>(mass, "mass")?.map(|&mass| Amount::Mass(mass))),
        (None, Some(density)) => {
            Ok(read::<f64>(density, "density")?.map(|&density| Amount::Density(density)))
        }
        _ => Err(PyTypeError::new_err(
            "give exactly one of mass= and density=",
        )),
    }
}

/// A solid with one size.
fn one<T: Item + Sync>(
    size: &Bound<'_, PyAny>,
    name: &str,
    (mass, density): (Given<'_, '_>, Given<'_, '_>),
    solid: impl Fn(&T, Amount) -> Result<RigidBody, Error> + Sync,
) -> PyResult<PyRigidBody> {
    let (sizes, amounts): (Stack<T>, _) = (read(size, name)?, amounts(mass, density)?);
    let grid = Broadcast::of([name, "mass or density"], [&sizes.shape, &amounts.shape])?;
    Ok(grid
        .try_map(size.py(), |[s, a]| solid(&sizes[s], amounts[a]))?
        .into())
}

/// A solid with a radius and a height.
fn radius_and_height(
    radius: &Bound<'_, PyAny>,
    height: &Bound<'_, PyAny>,
    (mass, density): (Given<'_, '_>, Given<'_, '_>),
    solid: impl Fn(f64, f64, Amount) -> Result<RigidBody, Error> + Sync,
) -> PyResult<PyRigidBody> {
    let (radii, heights): (Stack<f64>, Stack<f64>) =
        (read(radius, "radius")?, read(height, "height")?);
    let amounts = amounts(mass, density)?;
    let grid = Broadcast::of(
        ["radius", "height", "mass or density"],
        [&radii.shape, &heights.shape, &amounts.shape],
    )?;
    Ok(grid
        .try_map(radius.py(), |[r, h, a]| {
            solid(radii[r], heights[h], amounts[a])
        })?
        .into())
}

/// Box with its faces normal to the axes: I_x = m (y² + z²)/12.
///
/// Parameters
/// ----------
/// size : array_like, shape (..., 3)
///     Full edge lengths along x, y, z.
/// mass, density : array_like, shape (...)
///     Exactly one of the two.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import solids
/// >>> solids.box((1, 2, 3), mass=12.0).principal_moments
/// array([ 5., 10., 13.])
#[pyfunction]
#[pyo3(name = "box", signature = (size, *, mass=None, density=None))]
pub(crate) fn cuboid(
    size: &Bound<'_, PyAny>,
    mass: Given<'_, '_>,
    density: Given<'_, '_>,
) -> PyResult<PyRigidBody> {
    one(size, "size", (mass, density), solids::cuboid)
}

/// Cube with its faces normal to the axes: I = m a²/6.
///
/// Parameters
/// ----------
/// side : array_like, shape (...)
///     Full edge length.
/// mass, density : array_like, shape (...)
///     Exactly one of the two.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import solids
/// >>> solids.cube(2.0, density=1.0).mass
/// 8.0
#[pyfunction]
#[pyo3(signature = (side, *, mass=None, density=None))]
pub(crate) fn cube(
    side: &Bound<'_, PyAny>,
    mass: Given<'_, '_>,
    density: Given<'_, '_>,
) -> PyResult<PyRigidBody> {
    one(side, "side", (mass, density), |&side: &f64, amount| {
        solids::cube(side, amount)
    })
}

/// Ball: I = ⅖ m R².
///
/// Parameters
/// ----------
/// radius : array_like, shape (...)
/// mass, density : array_like, shape (...)
///     Exactly one of the two.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import solids
/// >>> solids.sphere(1.0, mass=5.0).principal_moments
/// array([2., 2., 2.])
#[pyfunction]
#[pyo3(signature = (radius, *, mass=None, density=None))]
pub(crate) fn sphere(
    radius: &Bound<'_, PyAny>,
    mass: Given<'_, '_>,
    density: Given<'_, '_>,
) -> PyResult<PyRigidBody> {
    one(
        radius,
        "radius",
        (mass, density),
        |&radius: &f64, amount| solids::sphere(radius, amount),
    )
}

/// Ellipsoid with its axes along x, y, z: I_x = m (b² + c²)/5.
///
/// Parameters
/// ----------
/// semi_axes : array_like, shape (..., 3)
///     a, b, c: half the lengths along x, y, z.
/// mass, density : array_like, shape (...)
///     Exactly one of the two.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import solids
/// >>> solids.ellipsoid((1, 2, 3), mass=5.0).principal_moments
/// array([ 5., 10., 13.])
#[pyfunction]
#[pyo3(signature = (semi_axes, *, mass=None, density=None))]
pub(crate) fn ellipsoid(
    semi_axes: &Bound<'_, PyAny>,
    mass: Given<'_, '_>,
    density: Given<'_, '_>,
) -> PyResult<PyRigidBody> {
    one(semi_axes, "semi_axes", (mass, density), solids::ellipsoid)
}

/// Cylinder along z: I_z = ½ m R², I_x = m (3R² + h²)/12. A flat one is a disk, a thin one a rod.
///
/// Parameters
/// ----------
/// radius, height : array_like, shape (...)
///     R and the full height h.
/// mass, density : array_like, shape (...)
///     Exactly one of the two.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import solids
/// >>> solids.cylinder(radius=2.0, height=6.0, mass=1.0).principal_moments
/// array([2., 4., 4.])
#[pyfunction]
#[pyo3(signature = (radius, height, *, mass=None, density=None))]
pub(crate) fn cylinder(
    radius: &Bound<'_, PyAny>,
    height: &Bound<'_, PyAny>,
    mass: Given<'_, '_>,
    density: Given<'_, '_>,
) -> PyResult<PyRigidBody> {
    radius_and_height(radius, height, (mass, density), solids::cylinder)
}

/// Cone along z with its apex toward +z, at 3h/4 from the centre of mass: I_z = (3/10) m R², I_x = (3/20) m (R² + h²/4).
///
/// Parameters
/// ----------
/// radius, height : array_like, shape (...)
///     R of the base and the full height h.
/// mass, density : array_like, shape (...)
///     Exactly one of the two.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// About its apex:
///
/// >>> from polhode import solids
/// >>> solids.cone(radius=2.0, height=4.0, mass=10.0).inertia_about((0, 0, 3)).diagonal().round(12)
/// array([102., 102.,  12.])
#[pyfunction]
#[pyo3(signature = (radius, height, *, mass=None, density=None))]
pub(crate) fn cone(
    radius: &Bound<'_, PyAny>,
    height: &Bound<'_, PyAny>,
    mass: Given<'_, '_>,
    density: Given<'_, '_>,
) -> PyResult<PyRigidBody> {
    radius_and_height(radius, height, (mass, density), solids::cone)
}
