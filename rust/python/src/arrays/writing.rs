//! C-ordered float64 arrays out.

use numpy::ndarray::{ArrayView2, ArrayViewD};
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};

use crate::foreign::numpy;
use crate::interrupt::Beat;
use crate::items::{Item, size};
use crate::memory;
use crate::stack::{BLOCK, Stack};

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
    shaped::<T>(py, numbers, &[])
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
        shaped::<T>(self.py, self.found, shape)
    }
}

/// An array of items with these numbers: in the memory they are in, or, as is sooner done with few, in its own.
fn shaped<'py, T: Item>(
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
