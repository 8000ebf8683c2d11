//! NumPy layout: anything array-like in, C-ordered float64 arrays out.

use std::convert::Infallible;

use nalgebra::Vector3;
use numpy::ndarray::{ArrayView2, ArrayViewD};
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray1,
    PyReadonlyArrayDyn, PyUntypedArrayMethods, ToPyArray,
};
use polhode::Error;
use polhode::parallel::Watch;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyUnicodeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use crate::array_conversion::{AXES, slice};
use crate::errors::{at_row, to_py, wrong_shape};
use crate::interrupt::Beat;
use crate::items::size;
use crate::shape::tuple;
use crate::stack::{BLOCK, Stack, try_watched};
use crate::{hints, memory};

pub(crate) use crate::array_conversion::{as_array, contiguous, numpy};
pub(crate) use crate::items::Item;

// Anything array-like in.

/// An argument with a default that is not None: None is a mistake, and read as one.
#[derive(Default)]
pub(crate) struct Argument<'py>(Option<Bound<'py, PyAny>>);

impl<'py> Argument<'py> {
    /// What was passed, if anything was.
    pub(crate) fn value(&self) -> Option<&Bound<'py, PyAny>> {
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
        return to_stack(py, name, &[numbers.len()], &numbers);
    }
    let array = floats(object, name)?;
    to_stack(py, name, array.shape(), array.as_slice()?)
}

/// The items of an array with these numbers.
fn to_stack<T: Item>(
    py: Python<'_>,
    name: &str,
    shape: &[usize],
    numbers: &[f64],
) -> PyResult<Stack<T>> {
    let shape = leading_shape::<T>(name, shape)?;
    let mut rows = memory::vector(name, &shape, 0)?;
    let mut beat = Beat::new(py);
    for block in numbers.chunks(BLOCK * size::<T>()) {
        beat.mark()?;
        rows.extend(block.chunks_exact(size::<T>()).map(T::read));
    }
    Ok(Stack { shape, rows })
}

/// The shape of the stack of items whose array has this one.
fn leading_shape<T: Item>(name: &str, shape: &[usize]) -> PyResult<Vec<usize>> {
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
        .value()
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

/// A copy of an argument as an array of float64, which nobody else changes.
pub(crate) fn copy_of<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    // NumPy's own function takes several times as long for a few numbers.
    if let Ok(array) = given.cast_exact::<PyArrayDyn<f64>>()
        && let Ok(view) = array.try_readonly()
    {
        return Ok(view.as_array().to_pyarray(given.py()).into_any());
    }
    numpy(given.py())?.call_method1("array", (given, "float64"))
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
    f: impl Fn(&T) -> Result<R, Error>,
) -> PyResult<Stack<R>> {
    let py = object.py();
    let array = floats(object, name)?;
    let shape = leading_shape::<T>(name, array.shape())?;
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
    f: impl Fn(&T) -> Result<R, Error>,
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

// One number or one word as an argument: what Python cannot convert is refused as an argument of the wrong type, which PyO3
// names, and not by an error that says nothing of the argument.

/// What one argument can be.
pub(crate) trait Scalar<'a>: Sized {
    /// Read the argument.
    fn read(object: &'a Bound<'_, PyAny>) -> PyResult<Self>;
}

/// Read one number or one word: for `#[pyo3(from_py_with = read_scalar)]`.
pub(crate) fn read_scalar<'a, T: Scalar<'a>>(object: &'a Bound<'_, PyAny>) -> PyResult<T> {
    T::read(object)
}

impl<'a, T: Scalar<'a>> Scalar<'a> for Option<T> {
    fn read(object: &'a Bound<'_, PyAny>) -> PyResult<Self> {
        if object.is_none() {
            return Ok(None);
        }
        T::read(object).map(Some)
    }
}

impl<'a> Scalar<'a> for f64 {
    fn read(object: &'a Bound<'_, PyAny>) -> PyResult<Self> {
        object.extract().map_err(|error: PyErr| {
            if error.is_instance_of::<PyOverflowError>(object.py()) {
                PyTypeError::new_err(
                    "expected a number that a float can be, at most 1.8e308 in size",
                )
            } else {
                error
            }
        })
    }
}

impl<'a> Scalar<'a> for &'a str {
    fn read(object: &'a Bound<'_, PyAny>) -> PyResult<Self> {
        object
            .extract()
            .map_err(|error: PyErr| not_unicode(object.py(), error))
    }
}

impl<'a> Scalar<'a> for String {
    fn read(object: &'a Bound<'_, PyAny>) -> PyResult<Self> {
        object
            .extract()
            .map_err(|error: PyErr| not_unicode(object.py(), error))
    }
}

fn not_unicode(py: Python<'_>, error: PyErr) -> PyErr {
    if error.is_instance_of::<PyUnicodeError>(py) {
        PyTypeError::new_err("expected a word, got a string with half of a surrogate pair in it")
    } else {
        error
    }
}

macro_rules! whole_numbers {
    ($($kind:ty: $range:literal)+) => {
        $(impl<'a> Scalar<'a> for $kind {
            fn read(object: &'a Bound<'_, PyAny>) -> PyResult<Self> {
                object.extract().map_err(|error: PyErr| {
                    if error.is_instance_of::<PyOverflowError>(object.py()) {
                        PyTypeError::new_err(concat!("expected a whole number ", $range))
                    } else {
                        error
                    }
                })
            }
        })+
    };
}

whole_numbers! {
    i64: "from -2^63 to 2^63 - 1"
    u64: "from 0 to 2^64 - 1"
    usize: "from 0 to 2^64 - 1"
    i128: "of at most 38 digits"
}

// Vectors known at some times.

/// Times, and the vectors of shape (..., n, 3) that belong to them; their names are those of the arguments.
pub(crate) fn samples(
    [times, values]: [&Bound<'_, PyAny>; 2],
    [when, what]: [&'static str; 2],
) -> PyResult<(Vec<f64>, Stack<Vector3<f64>>)> {
    let times: Vec<f64> = list_floats(times, when, "n", &[])?.as_slice()?.to_vec();
    let values: Stack<Vector3<f64>> = read_list(values, what, "..., n")?;
    let count = values.shape.last().copied().unwrap_or(0);
    if count != times.len() {
        return Err(PyValueError::new_err(format!(
            "{what}: expected one for each of the {} times, got {count}",
            times.len()
        )));
    }
    Ok((times, values))
}

/// `f` of each series of vectors of shape (..., n, 3), while other threads of Python go on; names the series that fails.
pub(crate) fn try_series<R: Send>(
    py: Python<'_>,
    values: &Stack<Vector3<f64>>,
    f: impl Fn(&[Vector3<f64>], &mut Watch<'_>) -> Result<R, Error> + Sync,
) -> PyResult<Stack<R>> {
    let (count, shape) = match values.shape.split_last() {
        Some((&count, leading)) => (count, leading.to_vec()),
        None => (0, Vec::new()),
    };
    try_watched(py, shape, values.rows.chunks(count.max(1)), f)
}

// Large arrays in pickles, in slabs: nobody looks for Ctrl-C while pickle copies an array, so each slab does.

/// Numbers of a slab, which a few milliseconds copy.
const SLAB: usize = 1 << 20;

/// What a pickle takes in place of an array: a large one in slabs, a small one as it is.
pub(crate) fn in_slabs(array: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    match array.cast::<PyArrayDyn<f64>>() {
        Ok(large) if large.len() > SLAB => {
            let py = array.py();
            Ok(Bound::new(py, Slabs(large.clone().unbind()))?.into_any())
        }
        _ => Ok(array),
    }
}

/// As [`in_slabs`] of all arrays of a dictionary.
pub(crate) fn all_in_slabs(arrays: &Bound<'_, PyDict>) -> PyResult<()> {
    for (name, array) in arrays.copy()? {
        arrays.set_item(name, in_slabs(array)?)?;
    }
    Ok(())
}

/// A large array on its way into a pickle, or one of its slabs.
#[pyclass(frozen, name = "Slabs", module = "polhode._core")]
pub(crate) struct Slabs(Py<PyArrayDyn<f64>>);

#[pymethods]
impl Slabs {
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        py.check_signals()?;
        let restore = py.get_type::<Self>().getattr("_joined")?;
        let array = self.0.bind(py);
        let shape = PyTuple::new(py, array.shape())?;
        if array.len() <= SLAB {
            return Ok((restore, (shape, array).into_pyobject(py)?));
        }
        let flat = array.reshape([array.len()])?;
        let mut parts = vec![shape.into_any()];
        for from in (0..flat.len()).step_by(SLAB) {
            let to = flat.len().min(from + SLAB);
            let slab = flat.get_item(slice(py, from, to)?)?.cast_into()?;
            parts.push(Bound::new(py, Self(slab.unbind()))?.into_any());
        }
        Ok((restore, PyTuple::new(py, parts)?))
    }

    /// The array of these slabs, one after the other; a single one is the array.
    #[staticmethod]
    #[pyo3(signature = (shape, *slabs))]
    fn _joined<'py>(
        py: Python<'py>,
        shape: Vec<usize>,
        slabs: &Bound<'py, PyTuple>,
    ) -> PyResult<Bound<'py, PyAny>> {
        py.check_signals()?;
        if let Ok((slab,)) = slabs.extract() {
            return Ok(slab);
        }
        let mut numbers = memory::vector("pickle", &shape, 0)?;
        let mut beat = Beat::new(py);
        for slab in slabs {
            let slab: PyReadonlyArray1<'_, f64> = slab.extract()?;
            for block in slab.as_slice()?.chunks(BLOCK) {
                beat.mark()?;
                numbers.extend_from_slice(block);
            }
        }
        Ok(numbers.into_pyarray(py).reshape(shape)?.into_any())
    }
}

// C-ordered float64 arrays out.

/// Numbers that are sooner copied than handed over.
const FEW: usize = 1024;

/// The array of a stack.
pub(crate) fn write<'py, T: Item>(
    py: Python<'py>,
    stack: &Stack<T>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    if stack.is_one() {
        return single(py, &stack[0]);
    }
    let mut numbers = Numbers::of::<T>(py, "result", &stack.shape)?;
    numbers.put(&stack.rows, T::write)?;
    numbers.finish::<T>(&stack.shape)
}

/// The array of one item for each row of a stack.
pub(crate) fn write_of<'py, R, T: Item>(
    py: Python<'py>,
    stack: &Stack<R>,
    item: impl Fn(&R) -> T,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    if stack.is_one() {
        return single(py, &item(&stack[0]));
    }
    let mut numbers = Numbers::of::<T>(py, "result", &stack.shape)?;
    numbers.put(&stack.rows, |row, out| item(row).write(out))?;
    numbers.finish::<T>(&stack.shape)
}

/// The array of one item. Its few numbers of axes are known when this is compiled, which NumPy is told sooner.
fn single<'py, T: Item>(py: Python<'py>, item: &T) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let mut numbers = Vec::with_capacity(size::<T>());
    item.write(&mut numbers);
    if let [_] = T::TAIL {
        return Ok(PyArray1::from_slice(py, &numbers).to_dyn().clone());
    }
    if let [rows, columns] = *T::TAIL
        && let Ok(view) = ArrayView2::from_shape([rows, columns], &numbers)
    {
        return Ok(PyArray2::from_array(py, &view).to_dyn().clone());
    }
    reshape::<T>(py, numbers, &[])
}

/// The numbers of an array that is being made: room for all of them was found before the first was computed.
pub(crate) struct Numbers<'py> {
    found: Vec<f64>,
    beat: Beat<'py>,
    py: Python<'py>,
}

impl<'py> Numbers<'py> {
    /// None yet, of an array of items under a shape; `what` asks for it.
    pub(crate) fn of<T: Item>(py: Python<'py>, what: &str, shape: &[usize]) -> PyResult<Self> {
        Ok(Self {
            found: match memory::few(shape, size_of::<f64>() * size::<T>()) {
                Some(rows) => Vec::with_capacity(rows * size::<T>()),
                None => memory::vector(what, &[shape, T::TAIL].concat(), 0)?,
            },
            beat: Beat::new(py),
            py,
        })
    }

    /// Those of some further rows.
    pub(crate) fn put<R>(
        &mut self,
        rows: impl IntoIterator<Item = R>,
        write: impl Fn(R, &mut Vec<f64>),
    ) -> PyResult<()> {
        let mut rows = rows.into_iter();
        loop {
            let before = self.found.len();
            (rows.by_ref().take(BLOCK)).for_each(|row| write(row, &mut self.found));
            if self.found.len() == before {
                return Ok(());
            }
            self.beat.mark()?;
        }
    }

    /// The array.
    pub(crate) fn finish<T: Item>(self, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        reshape::<T>(self.py, self.found, shape)
    }
}

/// An array of items with these numbers: in the memory they are in, or, as is sooner done with few, in its own.
fn reshape<'py, T: Item>(
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

/// As [`write_numbers`], of one number for each row of a stack.
pub(crate) fn write_numbers_of<'py, R>(
    py: Python<'py>,
    stack: &Stack<R>,
    number: impl Fn(&R) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    if stack.is_one() {
        return Ok(number(&stack[0]).into_pyobject(py)?.into_any());
    }
    Ok(write_of(py, stack, number)?.into_any())
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

/// An array of zeros in NumPy's own memory, whose large pages are there sooner than those of a plain vector.
pub(crate) fn zeros<'py>(
    py: Python<'py>,
    what: &str,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    memory::room(what, shape, size_of::<f64>())?;
    let array = numpy(py)?.call_method1("zeros", (shape,))?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?)
}

/// The array of one flag or integer for each row of a stack.
pub(crate) fn write_any_of<'py, R, T: Element>(
    py: Python<'py>,
    stack: &Stack<R>,
    item: impl FnMut(&R) -> T,
) -> PyResult<Bound<'py, PyAny>> {
    let Stack { shape, rows } = stack.map(py, item)?;
    PyArray1::from_vec(py, rows).call_method1("reshape", (shape,))
}

/// The array of one word for each row of a stack; a string for one value.
pub(crate) fn write_words_of<'py, R, W: AsRef<str>>(
    py: Python<'py>,
    stack: &Stack<R>,
    word: impl Fn(&R) -> W,
    dtype: &str,
) -> PyResult<Bound<'py, PyAny>> {
    if stack.is_one() {
        return Ok(PyString::new(py, word(&stack[0]).as_ref()).into_any());
    }
    let np = numpy(py)?;
    let (mut pieces, mut beat) = (Vec::new(), Beat::new(py));
    for block in stack.rows.chunks(16 * BLOCK) {
        beat.mark()?;
        let words = PyList::empty(py);
        for row in block {
            words.append(word(row).as_ref())?;
        }
        pieces.push(np.call_method1("array", (words, dtype))?);
    }
    if pieces.is_empty() {
        pieces.push(np.call_method1("array", (PyList::empty(py), dtype))?);
    }
    np.call_method1("concatenate", (pieces,))?
        .call_method1("reshape", (&stack.shape,))
}
