//! What other objects become as arrays of NumPy, and what would be lost on the way.
//!
//! Large ones go piece by piece, so that Ctrl-C ends it: NumPy itself looks at no signal.

use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyFloat, PyInt, PyList, PyModule, PySlice, PyTuple};

use crate::depth::RecursionGuard;
use crate::errors;
use crate::interrupt::Beat;
use crate::memory;

/// Numbers that NumPy is given at a time; in a few milliseconds it is done with them.
const PIECE: usize = 1 << 18;
/// How deep lists may lie in lists: as many axes as an array of NumPy may have.
const DEPTH: usize = 64;

/// The most axes that an argument may have: the views that the core is handed have no more.
pub(crate) const AXES: usize = 32;

/// The module numpy.
pub(crate) fn numpy(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    Ok(MODULE
        .get_or_try_init(py, || py.import("numpy").map(Bound::unbind))?
        .bind(py))
}

/// Whether an object is a number as it comes out of an array of NumPy.
pub(crate) fn is_scalar(object: &Bound<'_, PyAny>) -> bool {
    static KIND: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = object.py();
    KIND.get_or_try_init(py, || numpy(py)?.getattr("generic").map(Bound::unbind))
        .and_then(|kind| object.is_instance(kind.bind(py)))
        .unwrap_or(false)
}

/// The array that NumPy makes of an object, unless that had masked elements or units, which it would drop.
pub(crate) fn as_array<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let py = object.py();
    if !object.is_exact_instance_of::<PyUntypedArray>() {
        let _guard = RecursionGuard::argument(name)?;
        let mut beat = Beat::new(py);
        nothing_lost(object, name, DEPTH, &mut beat)?;
        if let Some(array) = in_pieces(object, &mut beat)? {
            return Ok(array);
        }
    }
    let _guard = RecursionGuard::argument(name)?;
    let array = numpy(py)?
        .call_method1(intern!(py, "asarray"), (object,))
        .map_err(|error| {
            // What else the object raised comes back as it was.
            if is_of_numpy(&error, py) {
                PyErr::from_type(error.get_type(py), format!("{name}: {}", error.value(py)))
            } else {
                error
            }
        })?;
    let axes = array.cast::<PyUntypedArray>()?.ndim();
    if axes > AXES {
        return Err(PyValueError::new_err(format!(
            "{name}: an array of {axes} axes, where {AXES} are the most; reshape it"
        )));
    }
    Ok(array)
}

/// Whether this is how NumPy refuses what is no array of numbers.
fn is_of_numpy(error: &PyErr, py: Python<'_>) -> bool {
    let kind = error.get_type(py);
    kind.is(py.get_type::<PyValueError>()) || kind.is(py.get_type::<PyTypeError>())
}

/// Refuses what has masked elements or units, in lists too.
fn nothing_lost<'py>(
    object: &Bound<'py, PyAny>,
    name: &str,
    depth: usize,
    beat: &mut Beat<'py>,
) -> PyResult<()> {
    if object.is_exact_instance_of::<PyFloat>()
        || object.is_exact_instance_of::<PyInt>()
        || object.is_exact_instance_of::<PyUntypedArray>()
        || depth == 0
    {
        return Ok(());
    }
    if let Ok(list) = object.cast::<PyList>() {
        beat.mark()?;
        return (list.iter()).try_for_each(|item| nothing_lost(&item, name, depth - 1, beat));
    }
    if let Ok(tuple) = object.cast::<PyTuple>() {
        beat.mark()?;
        return (tuple.iter()).try_for_each(|item| nothing_lost(&item, name, depth - 1, beat));
    }
    refuse_masked(object, name)?;
    refuse_units(object, name)?;
    // xarray holds the arrays of others.
    if object.hasattr(intern!(object.py(), "dims"))?
        && let Some(held) = object.getattr_opt(intern!(object.py(), "data"))?
    {
        return nothing_lost(&held, name, depth - 1, beat);
    }
    Ok(())
}

/// A masked element has no value; an array of NumPy would have what lies below the mask.
fn refuse_masked(object: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    let py = object.py();
    if !object.is_instance_of::<PyUntypedArray>() || !object.hasattr(intern!(py, "mask"))? {
        return Ok(());
    }
    let masked = numpy(py)?.getattr("ma")?;
    if !object.is_instance(&masked.getattr("MaskedArray")?)? {
        return Ok(());
    }
    let mask = masked.call_method1("getmaskarray", (object,))?;
    if mask.getattr("dtype")?.getattr("names")?.is_none()
        && mask.call_method0("any")?.is_truthy()?
    {
        let first = mask.call_method0("argmax")?;
        let shape = mask.getattr("shape")?;
        let place = numpy(py)?.call_method1("unravel_index", (first, shape))?;
        let place: Vec<usize> = place.extract()?;
        let way_out = "is masked and has no value; leave such rows out, or give them values with .filled(value)";
        let [row, ref columns @ ..] = place[..] else {
            return Err(PyValueError::new_err(format!(
                "{name}: the element {way_out}"
            )));
        };
        let columns: Vec<String> = columns.iter().map(usize::to_string).collect();
        let columns = format!(", {}", columns.join(", "));
        // The row is a piece of its own: it changes where the caller passed a part of an array.
        let error = errors::new(py, "PolhodeError", String::new());
        let pieces = (
            format!("{name}: the element at ("),
            row,
            format!("{}) {way_out}", columns.trim_end()),
        );
        error.value(py).setattr("args", pieces)?;
        return Err(error);
    }
    Ok(())
}

/// A number with a unit, as of pint or astropy, would become one without.
fn refuse_units(object: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    let of = |word: &str| object.getattr_opt(word);
    let (units, way_out) = if let Some(units) = of("units")?
        && object.hasattr("magnitude")?
    {
        (units, ".to(unit).magnitude")
    } else if let Some(unit) = of("unit")?
        && object.hasattr("to_value")?
    {
        (unit, ".to_value(unit)")
    } else if let Some(units) = of("units")?
        && object.hasattr("to_value")?
    {
        (units, ".to_value(unit)")
    } else {
        return Ok(());
    };
    let units = units.str().map_or_else(
        |_| "a unit".to_owned(),
        |words| words.to_string_lossy().into_owned(),
    );
    let kind = object.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "{name}: a {kind} in \"{units}\" would lose its unit; say which unit the number is to be in: {way_out}"
    )))
}

/// The array of a long list, if all its pieces are alike.
fn in_pieces<'py>(
    object: &Bound<'py, PyAny>,
    beat: &mut Beat<'py>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let py = object.py();
    let count = size_hint(object, 4);
    if count <= PIECE || !object.is_instance_of::<PyList>() && !object.is_instance_of::<PyTuple>() {
        return Ok(None);
    }
    let np = numpy(py)?;
    let (length, mut pieces) = (object.len()?, Vec::new());
    let each = count / length;
    if each > PIECE {
        for row in object.try_iter()? {
            beat.mark()?;
            let row = row?;
            let Some(piece) = in_pieces(&row, beat)? else {
                return Ok(None);
            };
            pieces.push(piece.get_item((py.None(), py.Ellipsis()))?);
        }
    } else {
        let step = (PIECE / each).max(1);
        for from in (0..length).step_by(step) {
            beat.mark()?;
            let rows = object.get_item(slice(py, from, length.min(from + step))?)?;
            match np.call_method1(intern!(py, "asarray"), (rows,)) {
                Ok(piece) => pieces.push(piece),
                // NumPy is to say itself what is wrong with the whole.
                Err(error) if is_of_numpy(&error, py) => return Ok(None),
                // NumPy does hear Ctrl-C now and then.
                Err(error) => return Err(error),
            }
        }
    }
    let (mut tail, mut kinds) = (None, Vec::new());
    for piece in &pieces {
        let shape: Vec<usize> = piece.getattr("shape")?.extract()?;
        let dtype = piece.getattr("dtype")?;
        let kind: String = dtype.getattr("kind")?.extract()?;
        if !"biuf".contains(&kind) || tail.get_or_insert(shape[1..].to_vec())[..] != shape[1..] {
            return Ok(None);
        }
        kinds.push(dtype);
    }
    let shape = [&[length][..], &tail.unwrap_or_default()].concat();
    memory::room("list", &shape, size_of::<f64>())?;
    let dtype = np.call_method1("result_type", PyTuple::new(py, kinds)?)?;
    let whole = np.call_method1("empty", (&shape, dtype))?;
    let mut from = 0;
    for piece in pieces {
        let to = from + piece.len()?;
        copy(&whole.get_item(slice(py, from, to)?)?, &piece, beat)?;
        from = to;
    }
    Ok(Some(whole))
}

/// How many numbers a list of lists has if all are as long as the first.
fn size_hint(object: &Bound<'_, PyAny>, depth: usize) -> usize {
    let is_list = object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>();
    if depth == 0 || !is_list {
        return 1;
    }
    let length = object.len().unwrap_or(0);
    if length == 0 {
        return 1;
    }
    let of_first = object
        .get_item(0)
        .map_or(1, |first| size_hint(&first, depth - 1));
    length.saturating_mul(of_first)
}

/// The same numbers in C order and of another type, or the array itself where it is so already.
pub(crate) fn contiguous<'py>(
    array: &Bound<'py, PyAny>,
    name: &str,
    dtype: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let py = array.py();
    let np = numpy(py)?;
    let known = array.cast::<PyUntypedArray>()?;
    let wanted = np.call_method1("dtype", (dtype,))?;
    let shape = known.shape().to_vec();
    if known.is_c_contiguous() && known.is_aligned() && known.dtype().eq(&wanted)? {
        return Ok(array.clone());
    }
    memory::room(name, &shape, size_of::<f64>())?;
    let copied = np.call_method1("empty", (&shape, wanted))?;
    copy(&copied, array, &mut Beat::new(py))?;
    Ok(copied)
}

/// Copies piece by piece, cut along the longest axis.
fn copy<'py>(
    to: &Bound<'py, PyAny>,
    from: &Bound<'py, PyAny>,
    beat: &mut Beat<'py>,
) -> PyResult<()> {
    let py = to.py();
    let shape: Vec<usize> = to.getattr("shape")?.extract()?;
    let longest = (0..shape.len()).max_by_key(|&axis| shape[axis]);
    if shape.iter().product::<usize>() > PIECE
        && let Some(axis) = longest
    {
        let half = shape[axis] / 2;
        for (start, end) in [(0, half), (half, shape[axis])] {
            let mut key = vec![slice(py, 0, isize::MAX as usize)?; axis];
            key.push(slice(py, start, end)?);
            let key = PyTuple::new(py, key)?;
            copy(&to.get_item(&key)?, &from.get_item(&key)?, beat)?;
        }
        return Ok(());
    }
    beat.mark()?;
    let arguments = pyo3::types::PyDict::new(py);
    arguments.set_item("casting", "unsafe")?;
    numpy(py)?.call_method("copyto", (to, from), Some(&arguments))?;
    Ok(())
}

/// `from:to`.
pub(crate) fn slice(py: Python<'_>, from: usize, to: usize) -> PyResult<Bound<'_, PySlice>> {
    Ok(PySlice::new(
        py,
        isize::try_from(from)?,
        isize::try_from(to)?,
        1,
    ))
}
