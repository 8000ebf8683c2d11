//! Anything array-like in.

use std::convert::Infallible;

use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyList, PyTuple};

use crate::arrays::read_scalar;
use crate::errors::{at_row, to_py, wrong_shape};
use crate::foreign::AXES;
use crate::foreign::{as_array, contiguous};
use crate::hints;
use crate::interrupt::Beat;
use crate::items::{Item, size};
use crate::memory;
use crate::shape::tuple;
use crate::stack::{BLOCK, Stack};

/// An argument with a default that is not None: None is a mistake, and read as one.
#[derive(Default)]
pub(crate) struct Argument<'py>(Option<Bound<'py, PyAny>>);

impl<'py> Argument<'py> {
    /// What was passed, if anything was.
    pub(crate) fn given(&self) -> Option<&Bound<'py, PyAny>> {
        self.0.as_ref()
    }
}

impl<'py> FromPyObject<'_, 'py> for Argument<'py> {
    type Error = Infallible;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self(Some(object.to_owned())))
    }
}

/// Items over the last axes and a stack over the leading ones.
pub(crate) fn read<T: Item>(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Stack<T>> {
    let py = object.py();
    if let Some(numbers) = plain(object)? {
        return stacked(py, name, &[numbers.len()], &numbers);
    }
    let array = floats(object, name)?;
    stacked(py, name, array.shape(), array.as_slice()?)
}

/// The items of an array with these numbers.
fn stacked<T: Item>(
    py: Python<'_>,
    name: &str,
    shape: &[usize],
    numbers: &[f64],
) -> PyResult<Stack<T>> {
    let shape = leading::<T>(name, shape)?;
    let mut rows = memory::vector(name, &shape, 0)?;
    let mut beat = Beat::new(py);
    for block in numbers.chunks(BLOCK * size::<T>()) {
        beat.mark()?;
        rows.extend(block.chunks_exact(size::<T>()).map(T::read));
    }
    Ok(Stack { shape, rows })
}

/// The shape of the stack of items whose array has this one.
fn leading<T: Item>(name: &str, shape: &[usize]) -> PyResult<Vec<usize>> {
    let depth = (shape.len().checked_sub(T::TAIL.len()))
        .filter(|&depth| shape[depth..] == *T::TAIL)
        .ok_or_else(|| wrong_shape(name, T::TAIL, shape))?;
    Ok(shape[..depth].to_vec())
}

/// The numbers of a list or tuple that holds floats and integers alone, as NumPy would read them and much sooner.
fn plain(object: &Bound<'_, PyAny>) -> PyResult<Option<Vec<f64>>> {
    if let Ok(list) = object.cast_exact::<PyList>() {
        all_numbers(object.py(), list.len(), list.iter())
    } else if let Ok(tuple) = object.cast_exact::<PyTuple>() {
        all_numbers(object.py(), tuple.len(), tuple.iter())
    } else {
        Ok(None)
    }
}

/// Those numbers, unless something else is among them.
fn all_numbers<'py>(
    py: Python<'py>,
    count: usize,
    items: impl Iterator<Item = Bound<'py, PyAny>>,
) -> PyResult<Option<Vec<f64>>> {
    let mut numbers = memory::vector("list", &[count], 0)?;
    let mut beat = Beat::new(py);
    for (row, item) in items.enumerate() {
        if row % BLOCK == 0 {
            beat.mark()?;
        }
        if let Ok(float) = item.cast::<PyFloat>() {
            numbers.push(float.value());
        } else if let Some(integer) =
            (item.cast_exact::<PyInt>().ok()).and_then(|integer| integer.extract::<i64>().ok())
        {
            numbers.push(integer as f64);
        } else {
            return Ok(None);
        }
    }
    Ok(Some(numbers))
}

/// As [`read`] for items in a row, shape (n, tail) or (..., n, tail): `leading` names the axes before the tail.
pub(crate) fn read_list<T: Item>(
    object: &Bound<'_, PyAny>,
    name: &str,
    leading: &str,
) -> PyResult<Stack<T>> {
    list_floats(object, name, leading, T::TAIL)?;
    read(object, name)
}

/// The numbers of items in a row, shape (n, tail) or (..., n, tail), not copied where they are C-ordered float64.
pub(crate) fn list_floats<'py>(
    object: &Bound<'py, PyAny>,
    name: &str,
    leading: &str,
    tail: &[usize],
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = floats(object, name)?;
    let shape = array.shape();
    let depth = shape.len().checked_sub(tail.len());
    let is_list = depth.is_some_and(|depth| {
        shape[depth..] == *tail && (depth == 1 || depth > 1 && leading.starts_with("..."))
    });
    if is_list {
        return Ok(array);
    }
    let tail: Vec<String> = tail.iter().map(usize::to_string).collect();
    let axes = [&[leading.to_owned()], &tail[..]].concat().join(", ");
    Err(PyValueError::new_err(format!(
        "{name}: expected shape ({axes}), got {}",
        tuple(shape)
    )))
}

/// As [`read`], with a default for an argument that was not given.
pub(crate) fn read_or<T: Item>(
    argument: &Argument<'_>,
    name: &str,
    default: T,
) -> PyResult<Stack<T>> {
    argument
        .given()
        .map_or_else(|| Ok(Stack::one(default)), |object| read(object, name))
}

/// A C-ordered float64 array with the numbers of `object`, which must be real.
pub(crate) fn floats<'py>(
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    if let Ok(array) = object.cast_exact::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
        && array.is_aligned()
        && array.ndim() <= AXES
    {
        return Ok(array.readonly());
    }
    let array = as_array(object, name)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"biuf".contains(&kind) {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "{name}: expected real numbers, got dtype {dtype}{}",
            hints::for_kind(name, &kind)
        )));
    }
    let array = contiguous(&array, name, "float64")?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?.readonly())
}

/// The float64 array of real numbers that an argument is, for the Python part of the package.
///
/// Parameters
/// ----------
/// values : array_like
/// name : str
///     What errors call them.
///
/// Returns
/// -------
/// numpy.ndarray
///     C-ordered; the values themselves where they are so already.
#[pyfunction]
pub(crate) fn real_numbers<'py>(
    values: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let array = floats(values, name)?;
    let array: &Bound<'py, PyArrayDyn<f64>> = &array;
    Ok(array.clone())
}

/// Rows of N indices, or the row that has a negative index, and that index.
type Indices<const N: usize> = Result<Vec<[usize; N]>, (usize, i64)>;

/// Rows of N indices, shape (n, N); a negative one comes back as the row and the number.
pub(crate) fn read_indices<const N: usize>(
    object: &Bound<'_, PyAny>,
    name: &str,
) -> PyResult<Indices<N>> {
    let array = as_array(object, name)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if shape == [0] || shape == [0, N] {
        return Ok(Ok(Vec::new()));
    }
    if !"iu".contains(&kind) {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "{name}: expected integers, got dtype {dtype}"
        )));
    }
    if !matches!(shape[..], [_, columns] if columns == N) {
        return Err(PyValueError::new_err(format!(
            "{name}: expected shape (n, {N}), got {}",
            tuple(&shape)
        )));
    }
    let array = contiguous(&array, name, "int64")?;
    let array = array.cast_into::<PyArrayDyn<i64>>()?.readonly();
    let mut rows = memory::vector(name, &shape[..1], 0)?;
    let mut beat = Beat::new(object.py());
    for (row, numbers) in array.as_slice()?.chunks_exact(N).enumerate() {
        if row % BLOCK == 0 {
            beat.mark()?;
        }
        let mut indices = [0; N];
        for (index, &number) in indices.iter_mut().zip(numbers) {
            match usize::try_from(number) {
                Ok(valid) => *index = valid,
                Err(_) => return Ok(Err((row, number))),
            }
        }
        rows.push(indices);
    }
    Ok(Ok(rows))
}

/// `f` of each item of an array, as [`read`] would give it but without a copy of all; names the row that fails.
pub(crate) fn try_items<T: Item, R>(
    object: &Bound<'_, PyAny>,
    name: &str,
    f: impl Fn(&T) -> Result<R, polhode::Error>,
) -> PyResult<Stack<R>> {
    let py = object.py();
    let array = floats(object, name)?;
    let shape = leading::<T>(name, array.shape())?;
    let mut rows = memory::vector("result", &shape, 0)?;
    let mut beat = Beat::new(py);
    for (row, numbers) in array.as_slice()?.chunks_exact(size::<T>()).enumerate() {
        if row % BLOCK == 0 {
            beat.mark()?;
        }
        let made = f(&T::read(numbers));
        rows.push(made.map_err(|error| at_row(&shape, row, &to_py(py, &error), py))?);
    }
    Ok(Stack { shape, rows })
}

/// `f` of each row, naming the row that fails.
pub(crate) fn try_rows<T, R>(
    py: Python<'_>,
    stack: &Stack<T>,
    f: impl Fn(&T) -> Result<R, polhode::Error>,
) -> PyResult<Stack<R>> {
    let mut rows = memory::vector("result", &stack.shape, 0)?;
    let mut beat = Beat::new(py);
    for (row, value) in stack.rows.iter().enumerate() {
        if row % BLOCK == 0 {
            beat.mark()?;
        }
        let made = f(value);
        rows.push(made.map_err(|error| at_row(&stack.shape, row, &to_py(py, &error), py))?);
    }
    Ok(Stack {
        shape: stack.shape.clone(),
        rows,
    })
}
