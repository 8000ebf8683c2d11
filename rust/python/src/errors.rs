//! Errors of the core as exceptions of `polhode.errors`.

use polhode::Error;
use polhode::error::{BodyFault, FileFault, Kind, MeshFault, MotionFault};
use pyo3::exceptions::{PyBaseException, PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyTuple, PyType};

use crate::advice::{NEARLY_EQUAL, advice, in_words, is_rounded};
use crate::hints;
use crate::shape::tuple;

/// The exception for an error of the core: its words are pieces, and the remedy is one by itself.
pub(crate) fn to_py(py: Python<'_>, error: &Error) -> PyErr {
    let name = match error.kind() {
        Kind::Inertia => "InvalidInertiaError",
        Kind::Mesh => "MeshError",
        Kind::File => "FileFormatError",
        Kind::SingularAttitude => "SingularAttitudeError",
        Kind::Quadrature => "QuadratureError",
        Kind::Contact => "ContactError",
        Kind::Integration => "IntegrationError",
        Kind::Memory => return PyMemoryError::new_err(in_words(error)),
        _ => "PolhodeError",
    };
    let exception = new(py, name, error.to_string());
    match set_data(exception.value(py), error) {
        Ok(()) => exception,
        Err(error) => error,
    }
}

/// Adds the remedy to the pieces of the message, and says as data what is wrong.
fn set_data(value: &Bound<'_, PyBaseException>, error: &Error) -> PyResult<()> {
    let (words, remedy) = (error.to_string(), advice(error));
    if !remedy.is_empty() {
        value.setattr("args", (&words, &remedy))?;
        value.setattr("way_out", remedy.trim_start_matches([';', ':', ',', ' ']))?;
    }
    // The row is a piece of its own: it changes where the caller passed a part of an array.
    if let Error::Body(BodyFault::NegativeMass { index, .. }) = error
        && let Some((before, after)) = words.split_once(&index.to_string())
    {
        value.setattr("args", (before, index, after, remedy))?;
    }
    if let Error::Mesh(MeshFault::Open { .. }) = error {
        value.setattr("law", "closed")?;
    }
    match kind(error) {
        "" => Ok(()),
        kind => value.setattr("kind", kind),
    }
}

/// What is wrong, where files and the command line have remedies of their own.
fn kind(error: &Error) -> &'static str {
    match error {
        Error::Mesh(MeshFault::Open { .. }) => "open",
        Error::Mesh(MeshFault::Inverted { .. }) => "inverted",
        Error::Mesh(MeshFault::InsideOut { .. }) => "inside out",
        Error::File(FileFault::IndexZero { .. }) => "index zero",
        Error::Body(fault @ BodyFault::TriangleInequality { .. }) if is_rounded(fault) => "rounded",
        Error::Body(BodyFault::TriangleInequality { is_given: true, .. }) => "impossible",
        Error::Body(BodyFault::TriangleInequality { .. }) => "impossible matter",
        Error::Body(BodyFault::NotASymmetricTop { gap, .. }) if *gap <= NEARLY_EQUAL => {
            "nearly symmetric"
        }
        Error::Body(BodyFault::NotASymmetricTop { .. }) => "not symmetric",
        Error::Motion(MotionFault::PivotOffAxis { .. }) => "pivot off axis",
        _ => "",
    }
}

/// The same exception with words in front.
pub(crate) fn with_prefix(py: Python<'_>, prefix: &str, error: &PyErr) -> PyErr {
    let value = error.value(py);
    let raised = PyErr::from_type(error.get_type(py), format!("{prefix}: {value}"));
    // Only errors of polhode have data, and words in pieces.
    match copy_data(value, raised.value(py), prefix) {
        Ok(()) => raised,
        Err(error) => error,
    }
}

fn copy_data(
    from: &Bound<'_, PyBaseException>,
    to: &Bound<'_, PyBaseException>,
    prefix: &str,
) -> PyResult<()> {
    let Ok(data) = from.getattr("__dict__") else {
        return Ok(());
    };
    if from.hasattr("way_out")? {
        let pieces = from.getattr("args")?.cast_into::<PyTuple>()?;
        let first = PyTuple::new(from.py(), [prefix, ": "])?;
        to.setattr("args", first.add(pieces)?)?;
    }
    to.getattr("__dict__")?.call_method1("update", (data,))?;
    Ok(())
}

/// An exception of `polhode.errors` by its name.
pub(crate) fn new(py: Python<'_>, name: &str, message: String) -> PyErr {
    static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let class = MODULE
        .get_or_try_init(py, || py.import("polhode.errors").map(Bound::unbind))
        .and_then(|module| Ok(module.bind(py).getattr(name)?.cast_into::<PyType>()?));
    match class {
        Ok(class) => PyErr::from_type(class, message),
        Err(error) => error,
    }
}

/// The same exception with the row of the stack named in front; one value has no row to name.
pub(crate) fn at_row(shape: &[usize], row: usize, error: &PyErr, py: Python<'_>) -> PyErr {
    if shape.is_empty() {
        return error.clone_ref(py);
    }
    let mut index = vec![0; shape.len()];
    let mut rest = row;
    for (step, &length) in index.iter_mut().rev().zip(shape.iter().rev()) {
        *step = rest % length;
        rest /= length;
    }
    let named = match index[..] {
        [one] => one.to_string(),
        _ => tuple(&index),
    };
    let raised = with_prefix(py, &format!("row {named}"), error);
    if let Ok(true) = raised.value(py).hasattr("way_out")
        && let Err(error) = raised.value(py).setattr("stack_row", row)
    {
        return error;
    }
    raised
}

/// The same exception with the label of particles in front, a piece of its own, and a remedy behind.
pub(crate) fn at_label(py: Python<'_>, label: i64, remedy: &str, error: &PyErr) -> PyErr {
    let words = error.value(py);
    let raised = PyErr::from_type(
        error.get_type(py),
        format!("label {label}: {words}{remedy}"),
    );
    let value = raised.value(py);
    let told = match value.hasattr("way_out") {
        Ok(true) => (value.setattr("args", ("label ", label, format!(": {words}{remedy}"))))
            .and_then(|()| value.setattr("label", label)),
        _ => Ok(()),
    };
    told.err().unwrap_or(raised)
}

/// An argument of the wrong shape.
pub(crate) fn wrong_shape(name: &str, expected: &[usize], got: &[usize]) -> PyErr {
    let tail: Vec<String> = expected.iter().map(usize::to_string).collect();
    let expected = if tail.is_empty() {
        "(...)".to_owned()
    } else {
        format!("(..., {})", tail.join(", "))
    };
    PyValueError::new_err(format!(
        "{name}: expected shape {expected}, got {}{}",
        tuple(got),
        hints::for_shape(name, got)
    ))
}
