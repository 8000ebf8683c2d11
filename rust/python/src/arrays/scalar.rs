//! One number or one word as an argument: what Python cannot convert is refused as an argument of the wrong type, which PyO3
//! names, and not by an error that says nothing of the argument.

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyUnicodeError};
use pyo3::prelude::*;

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
