//! Errors of the core as exceptions of `polhode.errors`.

use polhode::Error;
use polhode::error::{Kind, MeshFault};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

use crate::advice::{CLOSE, in_words, of_body};
use crate::hints;
use crate::shape::tuple;

/// The exception for an error of the core.
pub(crate) fn to_py(py: Python<'_>, error: &Error) -> PyErr {
    let name = match error.kind() {
        Kind::Inertia => "InvalidInertiaError",
        Kind::Mesh => "MeshError",
        Kind::File => "FileFormatError",
        Kind::SingularAttitude => "SingularAttitudeError",
        Kind::Quadrature => "QuadratureError",
        Kind::Integration => "IntegrationError",
        Kind::Memory => return PyMemoryError::new_err(in_words(error)),
        _ => "PolhodeError",
    };
    let exception = new(py, name, in_words(error));
    let value = exception.value(py);
    let told = match error {
        Error::Mesh(MeshFault::Open { .. }) => {
            (value.setattr("law", "closed")).and_then(|()| value.setattr("way_out", CLOSE))
        }
        Error::Body(fault) if fault.kind() == Kind::Inertia => value.setattr(
            "way_out",
            of_body(fault).trim_start_matches([';', ':', ' ']),
        ),
        _ => Ok(()),
    };
    match told {
        Ok(()) => exception,
        Err(error) => error,
    }
}

/// The same exception with words in front.
pub(crate) fn with_prefix(py: Python<'_>, prefix: &str, error: &PyErr) -> PyErr {
    let value = error.value(py);
    let raised = PyErr::from_type(error.get_type(py), format!("{prefix}: {value}"));
    for name in ["law", "way_out"] {
        // Not every error has them.
        if let Ok(told) = value.getattr(name)
            && let Err(error) = raised.value(py).setattr(name, told)
        {
            return error;
        }
    }
    raised
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
    with_prefix(py, &format!("row {named}"), error)
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
