//! NumPy layout: anything array-like in, C-ordered float64 arrays out.

use std::convert::Infallible;

use nalgebra::{Matrix3, Matrix4, Matrix6, Matrix6x3, Vector3, Vector6};
use numpy::ndarray::ArrayViewD;
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyFloat, PyInt, PyList, PyModule, PyTuple};

use crate::errors::{at_row, to_py, wrong_shape};
use crate::hints;
use crate::stack::{Stack, tuple};

/// Numbers that are sooner copied than handed over.
const FEW: usize = 1024;

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

/// A value that stands in the last axes of an array.
pub(crate) trait Item: Sized {
    /// Those axes.
    const TAIL: &'static [usize];
    /// From its numbers in C order.
    fn read(numbers: &[f64]) -> Self;
    /// Its numbers in C order.
    fn write(&self, out: &mut Vec<f64>);
}

impl Item for f64 {
    const TAIL: &'static [usize] = &[];

    fn read(numbers: &[f64]) -> Self {
        numbers[0]
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.push(*self);
    }
}

macro_rules! fixed_length {
    ($($n:literal)*) => {$(
        impl Item for [f64; $n] {
            const TAIL: &'static [usize] = &[$n];

            fn read(numbers: &[f64]) -> Self {
                std::array::from_fn(|i| numbers[i])
            }

            fn write(&self, out: &mut Vec<f64>) {
                out.extend_from_slice(self);
            }
        }
    )*};
}
fixed_length!(2 3 4 10 33 34);

/// The corners of a triangle in the plane.
impl Item for [[f64; 2]; 3] {
    const TAIL: &'static [usize] = &[3, 2];

    fn read(numbers: &[f64]) -> Self {
        std::array::from_fn(|i| [numbers[2 * i], numbers[2 * i + 1]])
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend(self.as_flattened());
    }
}

impl Item for Vector3<f64> {
    const TAIL: &'static [usize] = &[3];

    fn read(numbers: &[f64]) -> Self {
        Self::new(numbers[0], numbers[1], numbers[2])
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self.as_slice());
    }
}

macro_rules! square_matrix {
    ($($matrix:ident $n:literal)*) => {$(
        impl Item for $matrix<f64> {
            const TAIL: &'static [usize] = &[$n, $n];

            fn read(numbers: &[f64]) -> Self {
                Self::from_row_slice(numbers)
            }

            fn write(&self, out: &mut Vec<f64>) {
                out.extend_from_slice(self.transpose().as_slice()); // nalgebra stores columns
            }
        }
    )*};
}
square_matrix!(Matrix3 3 Matrix4 4 Matrix6 6);

impl Item for Matrix6x3<f64> {
    const TAIL: &'static [usize] = &[6, 3];

    fn read(numbers: &[f64]) -> Self {
        Self::from_row_slice(numbers)
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self.transpose().as_slice()); // nalgebra stores columns
    }
}

impl Item for Vector6<f64> {
    const TAIL: &'static [usize] = &[6];

    fn read(numbers: &[f64]) -> Self {
        Self::from_row_slice(numbers)
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self.as_slice());
    }
}

/// Items over the last axes and a stack over the leading ones.
pub(crate) fn read<T: Item>(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Stack<T>> {
    if let Some(numbers) = plain(object) {
        return stacked(name, &[numbers.len()], &numbers);
    }
    let array = floats(object, name)?;
    stacked(name, array.shape(), array.as_slice()?)
}

/// The items of an array with these numbers.
fn stacked<T: Item>(name: &str, shape: &[usize], numbers: &[f64]) -> PyResult<Stack<T>> {
    let depth = (shape.len().checked_sub(T::TAIL.len()))
        .filter(|&depth| shape[depth..] == *T::TAIL)
        .ok_or_else(|| wrong_shape(name, T::TAIL, shape))?;
    Ok(Stack {
        shape: shape[..depth].to_vec(),
        rows: numbers.chunks_exact(size::<T>()).map(T::read).collect(),
    })
}

/// The numbers of a list or tuple that holds floats and integers alone, as NumPy would read them and much sooner.
fn plain(object: &Bound<'_, PyAny>) -> Option<Vec<f64>> {
    let number = |item: Bound<'_, PyAny>| {
        if let Ok(float) = item.cast::<PyFloat>() {
            return Some(float.value());
        }
        let integer = item.cast_exact::<PyInt>().ok()?;
        Some(integer.extract::<i64>().ok()? as f64)
    };
    if let Ok(list) = object.cast_exact::<PyList>() {
        list.iter().map(number).collect()
    } else {
        object
            .cast_exact::<PyTuple>()
            .ok()?
            .iter()
            .map(number)
            .collect()
    }
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

/// The array of a stack.
pub(crate) fn write<'py, T: Item>(
    py: Python<'py>,
    stack: &Stack<T>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let mut numbers = Vec::with_capacity(stack.rows.len() * size::<T>());
    stack.rows.iter().for_each(|row| row.write(&mut numbers));
    shaped::<T>(py, numbers, &stack.shape)
}

/// The array of one item for each row of a stack.
pub(crate) fn write_of<'py, R, T: Item>(
    py: Python<'py>,
    stack: &Stack<R>,
    item: impl Fn(&R) -> T,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let mut numbers = Vec::with_capacity(stack.rows.len() * size::<T>());
    (stack.rows.iter()).for_each(|row| item(row).write(&mut numbers));
    shaped::<T>(py, numbers, &stack.shape)
}

/// How many numbers an item has.
fn size<T: Item>() -> usize {
    T::TAIL.iter().product()
}

/// An array of items with these numbers: in the memory they are in, or, as is sooner done with few, in its own.
pub(crate) fn shaped<'py, T: Item>(
    py: Python<'py>,
    numbers: Vec<f64>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let shape = [shape, T::TAIL].concat();
    if numbers.len() <= FEW
        && let Ok(view) = ArrayViewD::from_shape(&shape[..], &numbers)
    {
        return Ok(PyArrayDyn::from_array(py, &view));
    }
    numbers.into_pyarray(py).reshape(shape)
}

/// A float for one value, an array for a stack.
pub(crate) fn write_numbers<'py>(
    py: Python<'py>,
    stack: &Stack<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    if stack.is_one() {
        return Ok(stack[0].into_pyobject(py)?.into_any());
    }
    Ok(write(py, stack)?.into_any())
}

/// A C-ordered float64 array with the numbers of `object`, which must be real.
pub(crate) fn floats<'py>(
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    if let Ok(array) = object.cast::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
    {
        return Ok(array.readonly());
    }
    let array = as_array(object, name)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"biuf".contains(&kind) {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "{name}: expected real numbers, got dtype {dtype}{}",
            hints::for_kind(&kind)
        )));
    }
    let array = numpy(object.py())?.call_method1("ascontiguousarray", (&array, "float64"))?;
    // ascontiguousarray makes one axis of none.
    let array = array.call_method1("reshape", (as_array(object, name)?.getattr("shape")?,))?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?.readonly())
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
    let array = numpy(object.py())?.call_method1("ascontiguousarray", (&array, "int64"))?;
    let array = array.cast_into::<PyArrayDyn<i64>>()?.readonly();
    let mut rows = Vec::with_capacity(shape[0]);
    for (row, numbers) in array.as_slice()?.chunks_exact(N).enumerate() {
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

/// `f` of each row, naming the row that fails.
pub(crate) fn try_rows<T, R>(
    py: Python<'_>,
    stack: &Stack<T>,
    f: impl Fn(&T) -> Result<R, polhode::Error>,
) -> PyResult<Stack<R>> {
    let rows = (stack.rows.iter().enumerate())
        .map(|(row, value)| {
            f(value).map_err(|error| at_row(&stack.shape, row, &to_py(py, &error), py))
        })
        .collect::<PyResult<_>>()?;
    Ok(Stack {
        shape: stack.shape.clone(),
        rows,
    })
}

pub(crate) fn as_array<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let py = object.py();
    numpy(py)?
        .call_method1("asarray", (object,))
        .map_err(|error| {
            PyErr::from_type(error.get_type(py), format!("{name}: {}", error.value(py)))
        })
}

/// The module numpy.
pub(crate) fn numpy(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    Ok(MODULE
        .get_or_try_init(py, || py.import("numpy").map(Bound::unbind))?
        .bind(py))
}
