//! What the environment of the process asks for, read once when the module is imported.

use std::env;
use std::num::NonZeroUsize;

use polhode::parallel::{Level, level, set_level, set_thread_limit, thread_count};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Limits the number of threads of long runs.
const THREADS: &str = "POLHODE_NUM_THREADS";
/// Names the instruction set, for tests and comparisons; by default the widest that the machine has.
const LEVEL: &str = "POLHODE_LEVEL";

/// Obeys the variables that are set.
pub(crate) fn obey() -> PyResult<()> {
    if let Some(text) = read(THREADS)? {
        let count = text.trim().parse::<NonZeroUsize>().map_err(|_| {
            PyValueError::new_err(format!(
                "{THREADS}: expected a positive number of threads, got {text:?}"
            ))
        })?;
        set_thread_limit(Some(count));
    }
    if let Some(text) = read(LEVEL)? {
        let names = || Level::ALL.map(|level| level.to_string()).join(", ");
        let level = Level::ALL
            .into_iter()
            .find(|level| level.to_string() == text)
            .ok_or_else(|| {
                PyValueError::new_err(format!(
                    "{LEVEL}: expected one of {}, got {text:?}",
                    names()
                ))
            })?;
        if !set_level(level) {
            return Err(PyValueError::new_err(format!(
                "{LEVEL}: this machine does not have {text}"
            )));
        }
    }
    Ok(())
}

/// What long runs use on this machine: the instruction set and the number of threads.
///
/// Returns
/// -------
/// tuple of str and int
#[pyfunction]
pub(crate) fn machine() -> (String, usize) {
    (level().to_string(), thread_count())
}

fn read(variable: &str) -> PyResult<Option<String>> {
    env::var_os(variable)
        .map(|text| {
            text.into_string().map_err(|text| {
                PyValueError::new_err(format!("{variable}: expected text, got {}", text.display()))
            })
        })
        .transpose()
}
