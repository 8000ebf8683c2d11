//! Principal axes and tops of bare tensors.

use std::cell::Cell;

use nalgebra::Matrix3;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use polhode::mass::validity::{ASYMMETRY, check_symmetry};
use polhode::parallel::Halt;
use polhode::principal as core;
use polhode::{PrincipalAxes, RigidBody};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

use crate::arrays::{
    Item, floats, numpy, read, read_scalar, write, write_numbers_of, write_of, write_words_of,
};
use crate::errors::{at_row, to_py, wrong_shape};
use crate::interrupt::Interrupt;
use crate::memory;
use crate::stack::{Broadcast, Stack};

type Array<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

/// Principal moments and axes of symmetric tensors.
///
/// Parameters
/// ----------
/// inertia : array_like, shape (..., 3, 3)
///     Symmetric to rounding, 8 ε of the largest element; the lower triangle is read. Any scale from
///     the smallest to the largest floats. A tensor with an element that is not finite gives NaN in
///     its own row only.
/// canonical : bool, optional
///     Whether moments that differ by 1e-6 of the largest or less count as equal where axes are chosen, as
///     :meth:`polhode.PrincipalAxes.canonical` does.
///
/// Returns
/// -------
/// PrincipalAxes
///     ``moments`` (..., 3), ascending, and ``axes`` (..., 3, 3), whose columns are the axes: right-handed,
///     ``inertia = axes @ diag(moments) @ axes.T``. The signs: in columns 0 and 1 the component of largest
///     size is positive (the first such, if several are equal to 1e-8). Where moments are equal, to rounding,
///     the axes nearest to the body axes.
///
/// Raises
/// ------
/// InvalidInertiaError
///     Naming the row whose tensor is not symmetric.
///
/// Notes
/// -----
/// Errors are a few units in the last place of the largest moment; small moments of graded tensors (whose
/// elements differ much in size) are accurate relative to their own size, and so are the axes of nearly
/// spherical tensors. A row's bits do not depend on its neighbours, nor on the number of threads.
///
/// Examples
/// --------
/// >>> from polhode import principal_axes
/// >>> found = principal_axes([(2, 1, 0), (1, 2, 0), (0, 0, 4)])
/// >>> found.moments
/// array([1., 3., 4.])
/// >>> found.top
/// 'asymmetric'
#[pyfunction]
#[pyo3(signature = (inertia, canonical=false))]
pub(crate) fn principal_axes<'py>(
    py: Python<'py>,
    inertia: &Bound<'py, PyAny>,
    canonical: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let array = floats(inertia, "inertia")?;
    let leading = leading_shape(array.shape())?.to_vec();
    let (tensors, _) = array.as_slice()?.as_chunks::<9>();
    if leading.is_empty() {
        let found = one(py, &tensors[0], canonical)?;
        return to_python(py, &Stack::one(found));
    }
    let moments = empty(py, &leading, &[3])?;
    let axes = empty(py, &leading, &[3, 3])?;
    {
        let (mut moments, mut axes) = (moments.readwrite(), axes.readwrite());
        let (moments, _) = moments.as_slice_mut()?.as_chunks_mut::<3>();
        let (axes, _) = axes.as_slice_mut()?.as_chunks_mut::<9>();
        run(py, tensors, &leading, |watch| {
            core::principal_axes_many(tensors, ASYMMETRY, moments, axes, watch)
        })?;
        if canonical {
            let interrupt = Interrupt::new(None);
            let watch = &mut |_| interrupt.poll(None);
            let outcome = py.detach(|| core::canonical_many(moments, axes, core::TOP_RTOL, watch));
            interrupt.finish(py, outcome.is_ok())?;
        }
    }
    results(py)?.call1((moments, axes))
}

/// Principal moments of symmetric tensors, without the axes; faster than `principal_axes`.
///
/// Parameters
/// ----------
/// inertia : array_like, shape (..., 3, 3)
///     As in `principal_axes`.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 3)
///     Ascending; equal to those of `principal_axes` but for the last bits.
///
/// Raises
/// ------
/// InvalidInertiaError
///     Naming the row whose tensor is not symmetric.
///
/// Examples
/// --------
/// >>> from polhode import principal_moments
/// >>> principal_moments([(2, 1, 0), (1, 2, 0), (0, 0, 4)])
/// array([1., 3., 4.])
#[pyfunction]
pub(crate) fn principal_moments<'py>(py: Python<'py>, inertia: &Bound<'py, PyAny>) -> Array<'py> {
    let array = floats(inertia, "inertia")?;
    let leading = leading_shape(array.shape())?.to_vec();
    let (tensors, _) = array.as_slice()?.as_chunks::<9>();
    let moments = empty(py, &leading, &[3])?;
    {
        let mut moments = moments.readwrite();
        let (moments, _) = moments.as_slice_mut()?.as_chunks_mut::<3>();
        run(py, tensors, &leading, |watch| {
            core::principal_moments_many(tensors, ASYMMETRY, moments, watch)
        })?;
    }
    Ok(moments)
}

/// The class `polhode.results.PrincipalAxes`.
fn results(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    CLASS.import(py, "polhode.results", "PrincipalAxes")
}

/// An array to be filled. NumPy's own allocation comes in large pages, which is faster by a multiple for large stacks.
fn empty<'py>(py: Python<'py>, leading: &[usize], tail: &[usize]) -> Array<'py> {
    memory::room("inertia", &[leading, tail].concat(), size_of::<f64>())?;
    let array = numpy(py)?.call_method1("empty", ([leading, tail].concat(),))?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?)
}

/// The axes of a stack of tensors.
fn leading_shape(shape: &[usize]) -> PyResult<&[usize]> {
    shape
        .strip_suffix(&[3, 3])
        .ok_or_else(|| wrong_shape("inertia", <Matrix3<f64>>::TAIL, shape))
}

fn one(py: Python<'_>, tensor: &[f64; 9], canonical: bool) -> PyResult<PrincipalAxes> {
    let tensor = Matrix3::from_row_slice(tensor);
    check_symmetry("inertia", &tensor, ASYMMETRY).map_err(|error| to_py(py, &error))?;
    let found = core::principal_axes(&tensor);
    Ok(if canonical {
        core::canonical(&found, core::TOP_RTOL)
    } else {
        found
    })
}

/// Runs `work` without the GIL, interruptible, and names the row that is not symmetric.
fn run(
    py: Python<'_>,
    tensors: &[[f64; 9]],
    shape: &[usize],
    work: impl FnOnce(&mut dyn FnMut(f64) -> std::ops::ControlFlow<()>) -> Result<(), Halt<usize>>
    + Send,
) -> PyResult<()> {
    let interrupt = Interrupt::new(None);
    let outcome = py.detach(|| work(&mut |_| interrupt.poll(None)));
    interrupt.finish(py, outcome.is_ok())?;
    if let Err(Halt::Failed(row)) = outcome {
        check_symmetry(
            "inertia",
            &Matrix3::from_row_slice(&tensors[row]),
            ASYMMETRY,
        )
        .map_err(|error| at_row(shape, row, &to_py(py, &error), py))?;
    }
    Ok(())
}

/// As `polhode.results.PrincipalAxes`.
fn to_python<'py>(py: Python<'py>, found: &Stack<PrincipalAxes>) -> PyResult<Bound<'py, PyAny>> {
    let moments = write_of(py, found, |principal| principal.moments)?;
    let axes = write_of(py, found, |principal| principal.axes)?;
    results(py)?.call1((moments, axes))
}

/// As [`to_python`], of bodies about their centres of mass, with the tolerances at which the classes are decided.
pub(crate) fn of_bodies<'py>(
    py: Python<'py>,
    bodies: &Stack<RigidBody>,
) -> PyResult<Bound<'py, PyAny>> {
    let is_rounded = Cell::new(false);
    let moments = write_of(py, bodies, |body| {
        is_rounded.set(is_rounded.get() || body.provenance().rounding != 0.0);
        body.principal().moments
    })?;
    let axes = write_of(py, bodies, |body| body.principal().axes)?;
    if !is_rounded.get() {
        return results(py)?.call1((moments, axes));
    }
    let rtols = write_of(py, bodies, |body| body.top_rtols(&body.principal().moments))?;
    results(py)?.call1((moments, axes, rtols))
}

/// As [`to_python`], each with the tolerances at which its class is decided.
pub(crate) fn with_rtols<'py>(
    py: Python<'py>,
    rows: &Stack<(PrincipalAxes, [f64; 3])>,
) -> PyResult<Bound<'py, PyAny>> {
    let moments = write_of(py, rows, |(principal, _)| principal.moments)?;
    let axes = write_of(py, rows, |(principal, _)| principal.axes)?;
    let rtols = write_of(py, rows, |(_, rtols)| *rtols)?;
    results(py)?.call1((moments, axes, rtols))
}

/// Axes (..., 3, 3) turned as `principal_axes` does with `canonical`, moments closer than rtol counting as equal.
#[pyfunction]
pub(crate) fn canonical_axes<'py>(
    py: Python<'py>,
    moments: &Bound<'py, PyAny>,
    axes: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] rtol: f64,
) -> Array<'py> {
    check_rtol(rtol)?;
    let (moments, axes) = (read::<[f64; 3]>(moments, "moments")?, read(axes, "axes")?);
    let grid = Broadcast::of(["moments", "axes"], [&moments.shape, &axes.shape])?;
    let turned = grid.try_map(py, |[m, a]| {
        let principal = PrincipalAxes {
            moments: moments[m],
            axes: axes[a],
        };
        Ok(core::canonical(&principal, rtol).axes)
    })?;
    write(py, &turned)
}

/// Of the moments, of the axes, and the degenerate pairs.
type Derivative<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyAny>,
);

/// Derivatives: of the moments (..., 3), of the axes (..., 3, 3), and which pairs (0, 1), (0, 2), (1, 2) are degenerate.
#[pyfunction]
pub(crate) fn principal_derivative<'py>(
    py: Python<'py>,
    moments: &Bound<'py, PyAny>,
    axes: &Bound<'py, PyAny>,
    tangent: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] rtol: f64,
) -> PyResult<Derivative<'py>> {
    check_rtol(rtol)?;
    let (moments, axes) = (read::<[f64; 3]>(moments, "moments")?, read(axes, "axes")?);
    let tangents: Stack<Matrix3<f64>> = read(tangent, "tangent")?;
    let shapes = [&moments.shape[..], &axes.shape, &tangents.shape];
    let grid = Broadcast::of(["moments", "axes", "tangent"], shapes)?;
    let found = grid.try_map(py, |[m, a, t]| {
        check_symmetry("tangent", &tangents[t], ASYMMETRY)?;
        let principal = PrincipalAxes {
            moments: moments[m],
            axes: axes[a],
        };
        Ok(core::derivative(&principal, &tangents[t], rtol))
    })?;
    let pairs: Vec<[bool; 3]> = found.map(py, |derivative| derivative.degenerate)?.rows;
    let pairs = PyArray1::from_vec(py, pairs.into_flattened())
        .call_method1("reshape", ([&grid.shape[..], &[3]].concat(),))?;
    Ok((
        write_of(py, &found, |d| d.moments)?,
        write_of(py, &found, |d| d.axes)?,
        pairs,
    ))
}

/// Ray's asymmetry parameter of ascending moments: −1 prolate to +1 oblate, NaN for a spherical top.
#[pyfunction]
pub(crate) fn ray_kappa<'py>(
    py: Python<'py>,
    moments: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    write_numbers_of(py, &read::<[f64; 3]>(moments, "moments")?, core::ray_kappa)
}

fn check_rtol(rtol: f64) -> PyResult<()> {
    if rtol >= 0.0 {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "rtol: expected zero or more, got {rtol}"
    )))
}

/// Relative gaps (I2 − I1)/I3 and (I3 − I2)/I3 of ascending moments, shape (..., 2).
#[pyfunction]
pub(crate) fn principal_gaps<'py>(
    py: Python<'py>,
    moments: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(write_of(py, &read::<[f64; 3]>(moments, "moments")?, core::gaps)?.into_any())
}

/// Class of the top with ascending moments: a string, or an array of them. The relative tolerance is one number, or three of
/// shape (..., 3) for I1 = 0, I1 = I2 and I2 = I3.
#[pyfunction]
pub(crate) fn classify_tops<'py>(
    py: Python<'py>,
    moments: &Bound<'py, PyAny>,
    rtol: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let rtols = match rtol.extract::<f64>() {
        Ok(one) => Stack::one([one; 3]),
        Err(_) => read::<[f64; 3]>(rtol, "rtol")?,
    };
    for &rtol in rtols.rows.as_flattened() {
        check_rtol(rtol)?;
    }
    let moments = read::<[f64; 3]>(moments, "moments")?;
    let grid = Broadcast::of(["moments", "rtol"], [&moments.shape, &rtols.shape])?;
    let classes = grid.try_map(py, |[m, r]| {
        Ok(core::classify_within(&moments[m], &rtols[r]).as_str())
    })?;
    write_words_of(py, &classes, |class| *class, "str")
}
