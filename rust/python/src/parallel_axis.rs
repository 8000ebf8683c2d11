//! The parallel-axis theorem for bare tensors.

use nalgebra::{Matrix3, Vector3};
use numpy::PyArrayDyn;
use polhode::mass::parallel_axis::{from_center_of_mass, to_center_of_mass};
use polhode::mass::validity::{ASYMMETRY, check_not_negative_mass, check_symmetry};
use pyo3::prelude::*;

use crate::arrays::{read, write};
use crate::stack::{Broadcast, Stack};

/// A direction of the theorem: tensor, mass, displacement.
type Theorem = fn(&Matrix3<f64>, f64, &Vector3<f64>) -> Matrix3<f64>;

/// Parallel-axis theorem from the centre of mass: ``I_P = I_C + m (d² 1 − d dᵀ)``.
///
/// Parameters
/// ----------
/// inertia : array_like, shape (..., 3, 3)
///     Tensor about the centre of mass C, symmetric to rounding, off-diagonal elements minus the
///     products of inertia.
/// mass : array_like, shape (...)
///     Zero or more.
/// displacement : array_like, shape (..., 3)
///     Vector d from C to P, or from P to C, in the axes of the tensor.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3, 3)
///     Tensor about P. A row with a NaN gives NaN.
///
/// Raises
/// ------
/// InvalidInertiaError
///     For a tensor that is not symmetric.
/// PolhodeError
///     For a negative mass.
///
/// Notes
/// -----
/// The theorem holds only from or to the centre of mass C. Between two other points, apply it twice, through
/// C. For a body, `polhode.RigidBody.inertia_about` needs only the point.
///
/// Examples
/// --------
/// A thin rod about its end has four times the moment:
///
/// >>> import numpy as np
/// >>> from polhode import parallel_axis
/// >>> parallel_axis.from_center_of_mass(np.diag([1, 1, 0]), mass=3.0, displacement=(0, 0, 1))
/// array([[4., 0., 0.],
///        [0., 4., 0.],
///        [0., 0., 0.]])
#[pyfunction]
pub(crate) fn inertia_from_center_of_mass<'py>(
    py: Python<'py>,
    inertia: &Bound<'py, PyAny>,
    mass: &Bound<'py, PyAny>,
    displacement: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    shift(py, inertia, mass, displacement, from_center_of_mass)
}

/// Parallel-axis theorem to the centre of mass: ``I_C = I_P − m (d² 1 − d dᵀ)``.
///
/// Parameters
/// ----------
/// inertia : array_like, shape (..., 3, 3)
///     Tensor about a point P, symmetric to rounding.
/// mass : array_like, shape (...)
///     Zero or more.
/// displacement : array_like, shape (..., 3)
///     Vector d from P to C, or from C to P, in the axes of the tensor.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3, 3)
///     Tensor about C. A row with a NaN gives NaN.
///
/// Raises
/// ------
/// InvalidInertiaError
///     For a tensor that is not symmetric.
/// PolhodeError
///     For a negative mass.
///
/// Notes
/// -----
/// The difference loses digits if the distance of P from C is many radii of gyration. It is not tested
/// whether the result can be the tensor of a body; ``RigidBody(mass, inertia_about_origin=...)`` tests this.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import parallel_axis
/// >>> about_end = np.diag([4, 4, 0])
/// >>> parallel_axis.to_center_of_mass(about_end, mass=3.0, displacement=(0, 0, 1)).diagonal()
/// array([1., 1., 0.])
#[pyfunction]
pub(crate) fn inertia_to_center_of_mass<'py>(
    py: Python<'py>,
    inertia: &Bound<'py, PyAny>,
    mass: &Bound<'py, PyAny>,
    displacement: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    shift(py, inertia, mass, displacement, to_center_of_mass)
}

fn shift<'py>(
    py: Python<'py>,
    inertia: &Bound<'py, PyAny>,
    mass: &Bound<'py, PyAny>,
    displacement: &Bound<'py, PyAny>,
    theorem: Theorem,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let tensor: Stack<Matrix3<f64>> = read(inertia, "inertia")?;
    let mass: Stack<f64> = read(mass, "mass")?;
    let d: Stack<Vector3<f64>> = read(displacement, "displacement")?;
    let shapes = [&tensor.shape[..], &mass.shape, &d.shape];
    let grid = Broadcast::of(["inertia", "mass", "displacement"], shapes)?;
    let shifted = grid.try_map(py, |[i, m, p]| {
        check_symmetry("inertia", &tensor[i], ASYMMETRY)?;
        check_not_negative_mass(mass[m])?;
        Ok(theorem(&tensor[i], mass[m], &d[p]))
    })?;
    write(py, &shifted)
}
