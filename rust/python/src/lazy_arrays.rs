//! Arrays that are not in memory: those of dask, zarr, h5py and xarray, and memory maps. Python does what is done with
//! them, a chunk at a time.

use numpy::PyUntypedArray;
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyList, PyTuple};

/// Libraries whose arrays may be computed or read later.
const LIBRARIES: [&str; 4] = ["dask", "h5py", "xarray", "zarr"];

/// Whether an argument may be such an array: by the name of its type, so that no library is imported.
fn may_be(object: &Bound<'_, PyAny>) -> bool {
    if object.is_exact_instance_of::<PyUntypedArray>()
        || object.is_exact_instance_of::<PyList>()
        || object.is_exact_instance_of::<PyTuple>()
        || object.is_exact_instance_of::<PyFloat>()
        || object.is_exact_instance_of::<PyInt>()
    {
        return false;
    }
    let kind = object.get_type();
    let is = |word: PyResult<Bound<'_, _>>, test: &dyn Fn(&str) -> bool| {
        word.is_ok_and(|word: Bound<'_, pyo3::types::PyString>| word.to_str().is_ok_and(test))
    };
    is(kind.module(), &|module| {
        let library = module.split('.').next().unwrap_or_default();
        LIBRARIES.contains(&library)
            || library == "numpy" && is(kind.name(), &|name| name == "memmap")
    })
}

/// Whether any of these may be such an array.
pub(crate) fn is_any(given: &[Option<&Bound<'_, PyAny>>]) -> bool {
    given.iter().flatten().any(|object| may_be(object))
}

/// What a function of `polhode.ensembles.lazy_arrays` makes of a call; nothing where the arrays are read as others are.
pub(crate) fn handed_over<'py>(
    py: Python<'py>,
    function: &str,
    arguments: impl PyCallArgs<'py>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let found = (py
        .import("polhode.ensembles.lazy_arrays")?
        .getattr(function)?)
    .call(arguments, options)?;
    Ok((!found.is_none()).then_some(found))
}
