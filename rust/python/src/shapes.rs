//! What all homogeneous shapes share: mass or density, lengths that broadcast.

use polhode::mass::Amount;
use polhode::{Error, RigidBody};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::{Item, read};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

/// An optional argument of any array-like kind.
pub(crate) type Given<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

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
pub(crate) fn amounts(mass: Given<'_, '_>, density: Given<'_, '_>) -> PyResult<Stack<Amount>> {
    match (mass, density) {
        (Some(mass), None) => read::<f64>(mass, "mass")?.map(mass.py(), |&mass| Amount::Mass(mass)),
        (None, Some(density)) => {
            read::<f64>(density, "density")?.map(density.py(), |&density| Amount::Density(density))
        }
        _ => Err(PyTypeError::new_err(
            "give exactly one of mass= and density=",
        )),
    }
}

/// A shape with one size.
pub(crate) fn one<T: Item + Sync>(
    size: &Bound<'_, PyAny>,
    name: &str,
    (mass, density): (Given<'_, '_>, Given<'_, '_>),
    shape: impl Fn(&T, Amount) -> Result<RigidBody, Error> + Sync,
) -> PyResult<PyRigidBody> {
    let (sizes, amounts): (Stack<T>, _) = (read(size, name)?, amounts(mass, density)?);
    let grid = Broadcast::of([name, "mass or density"], [&sizes.shape, &amounts.shape])?;
    Ok(grid
        .try_map(size.py(), |[s, a]| shape(&sizes[s], amounts[a]))?
        .into())
}

/// A shape with several lengths.
pub(crate) fn lengths<const N: usize>(
    names: [&str; N],
    lengths: [&Bound<'_, PyAny>; N],
    (mass, density): (Given<'_, '_>, Given<'_, '_>),
    shape: impl Fn(&[f64; N], Amount) -> Result<RigidBody, Error> + Sync,
) -> PyResult<PyRigidBody> {
    let py = lengths[0].py();
    let mut read_in = Vec::with_capacity(N);
    for (length, name) in lengths.iter().zip(names) {
        read_in.push(read::<f64>(length, name)?);
    }
    let shapes = std::array::from_fn(|k| &read_in[k].shape[..]);
    let together = Broadcast::of(names, shapes)?
        .try_map(py, |rows| Ok(std::array::from_fn(|k| read_in[k][rows[k]])))?;
    let amounts = amounts(mass, density)?;
    let all = names.join(", ");
    let grid = Broadcast::of([&all, "mass or density"], [&together.shape, &amounts.shape])?;
    Ok(grid
        .try_map(py, |[l, a]| shape(&together[l], amounts[a]))?
        .into())
}
