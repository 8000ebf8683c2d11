//! Rates along the rows of a record, and what they integrate to. `polhode.kinematics` reads their arguments.

use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use polhode::Error;
use polhode::motion::rates::derivatives::{Rows, noise, rates as rates_of};
use polhode::motion::rates::integrals::{attitudes as attitudes_of, impulses as impulses_of};
use polhode::parallel::Watch;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arrays::{floats, list_floats, read_scalar};
use crate::attitudes::read_quaternion;
use crate::errors::{to_py, wrong_shape};
use crate::interrupt::watched;
use crate::kinematics::parse_frame;
use crate::memory;

type Floats<'py> = Bound<'py, PyArrayDyn<f64>>;

/// At least so many times.
fn times<'py>(t: &Bound<'py, PyAny>, least: usize) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let times = list_floats(t, "t", "n", &[])?;
    memory::room("t", times.shape(), 8 * size_of::<f64>())?;
    if times.len() < least {
        return Err(PyValueError::new_err(format!(
            "t: needs at least {least} times, got {}",
            times.len()
        )));
    }
    Ok(times)
}

/// A row of so many numbers for each time.
fn rows<'py>(
    object: &Bound<'py, PyAny>,
    name: &str,
    shape: [usize; 2],
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = floats(object, name)?;
    if array.shape() != shape {
        return Err(wrong_shape(name, &shape, array.shape()));
    }
    Ok(array)
}

/// Attitudes or vectors, by their last axis.
fn record<'a>(
    array: &'a PyReadonlyArrayDyn<'_, f64>,
    name: &str,
    count: usize,
) -> PyResult<Rows<'a>> {
    let numbers = array.as_slice()?;
    match *array.shape() {
        [rows, 4] if rows == count => Ok(Rows::Attitudes(numbers.as_chunks().0)),
        [rows, 3] if rows == count => Ok(Rows::Vectors(numbers.as_chunks().0)),
        _ => Err(wrong_shape(name, &[count, 3], array.shape())),
    }
}

/// What is computed without the lock of the interpreter, or its error.
fn computed<R: Send>(
    py: Python<'_>,
    work: impl FnOnce(&mut Watch<'_>) -> Result<R, Error> + Send,
) -> PyResult<R> {
    watched(py, work)?.map_err(|error| to_py(py, &error))
}

/// The array of rows of N numbers.
fn array<const N: usize>(py: Python<'_>, rows: Vec<[f64; N]>) -> PyResult<Floats<'_>> {
    let shape = vec![rows.len(), N];
    rows.into_flattened().into_pyarray(py).reshape(shape)
}

/// Rates of attitudes (n, 4) or vectors (n, 3) at the times t, and their errors; with sigma, of polynomials that fit.
#[pyfunction]
#[pyo3(signature = (t, rows, order=None, sigma=None))]
pub(crate) fn rates<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    rows: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] order: Option<usize>,
    #[pyo3(from_py_with = read_scalar)] sigma: Option<f64>,
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let (t, known) = (times(t, 3)?, floats(rows, "rows")?);
    let (t, known) = (t.as_slice()?, record(&known, "rows", t.len())?);
    let (rates, errors) = computed(py, |watch| rates_of(t, known, order, sigma, watch))?;
    Ok((array(py, rates)?, errors.into_pyarray(py).to_dyn().clone()))
}

/// Standard deviation of white noise of each component of attitudes (n, 4) or vectors (n, 3) at the times t.
#[pyfunction]
pub(crate) fn white_noise<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    rows: &Bound<'py, PyAny>,
) -> PyResult<f64> {
    let (t, known) = (times(t, 3)?, floats(rows, "rows")?);
    let (t, known) = (t.as_slice()?, record(&known, "rows", t.len())?);
    computed(py, |watch| noise(t, known, watch))
}

/// Attitudes (n, 4) of the angular velocity omega (n, 3) at the times t, from the first one on, and their errors.
#[pyfunction]
pub(crate) fn attitudes<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    omega: &Bound<'py, PyAny>,
    attitude: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] frame: &str,
    #[pyo3(from_py_with = read_scalar)] order: usize,
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let frame = parse_frame(frame)?;
    let first = read_quaternion(attitude, "attitude")?;
    if !first.is_one() {
        return Err(wrong_shape("attitude", &[4], &first.shape));
    }
    let t = times(t, 2)?;
    let omega = rows(omega, "omega", [t.len(), 3])?;
    let (t, omega, first) = (t.as_slice()?, omega.as_slice()?.as_chunks().0, first[0]);
    let (attitudes, errors) = computed(py, |watch| {
        attitudes_of(t, omega, first, frame, order, watch)
    })?;
    Ok((
        array(py, attitudes)?,
        errors.into_pyarray(py).to_dyn().clone(),
    ))
}

/// Integrals of R N from the first of the times t to each, in space, of each of the torques N (n, 3) along attitudes (n, 4).
#[pyfunction]
pub(crate) fn impulses<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    quaternion: &Bound<'py, PyAny>,
    torques: Vec<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyList>> {
    let t = times(t, 2)?;
    let attitudes = rows(quaternion, "quaternion", [t.len(), 4])?;
    let mut series = Vec::with_capacity(torques.len());
    for torque in &torques {
        series.push(rows(torque, "torques", [t.len(), 3])?);
    }
    let mut torques: Vec<&[[f64; 3]]> = Vec::with_capacity(series.len());
    for one in &series {
        torques.push(one.as_slice()?.as_chunks().0);
    }
    let (t, attitudes) = (t.as_slice()?, attitudes.as_slice()?.as_chunks().0);
    let found = computed(py, |watch| impulses_of(t, attitudes, &torques, watch))?;
    let found: Vec<_> = (found.into_iter().map(|one| array(py, one))).collect::<PyResult<_>>()?;
    PyList::new(py, found)
}
