//! Random numbers of the members of ensembles, and factors of covariances.

use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use polhode::parallel::Halt;
use polhode::random::Stream;
use polhode::random::distributions::{normal, uniform};
use polhode::random::factor;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{floats, read_scalar};
use crate::errors::to_py;
use crate::interrupt::Interrupt;
use crate::memory;
use crate::shape::tuple;

/// What the numbers that members draw are.
enum Law {
    Bits,
    Uniform,
    Normal,
    Rotation,
}

/// Numbers that members of an ensemble draw: a function of the seed, the stream, the member and the place in its row.
///
/// Parameters
/// ----------
/// law : {"bits", "uniform", "normal", "rotation"}
///     Words of 64 bits; numbers between 0 and 1, neither of which they are; standard normal numbers; unit
///     quaternions (x, y, z, w) of rotations drawn uniformly.
/// seed, stream : int
///     Numbers from 0 to 2**64 - 1.
/// first, count : int
///     The first member and how many.
/// width : int
///     How many numbers each draws; 4 for "rotation".
///
/// Returns
/// -------
/// numpy.ndarray, shape (count, width)
///     Of uint64 for "bits", of float64 else.
#[pyfunction]
pub(crate) fn random_numbers<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = read_scalar)] law: &str,
    #[pyo3(from_py_with = read_scalar)] seed: u64,
    #[pyo3(from_py_with = read_scalar)] stream: u64,
    #[pyo3(from_py_with = read_scalar)] first: u64,
    #[pyo3(from_py_with = read_scalar)] count: usize,
    #[pyo3(from_py_with = read_scalar)] width: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let law = match law {
        "bits" => Law::Bits,
        "uniform" => Law::Uniform,
        "normal" => Law::Normal,
        "rotation" => Law::Rotation,
        other => {
            return Err(PyValueError::new_err(format!(
                "law: expected \"bits\", \"uniform\", \"normal\" or \"rotation\", got \"{other}\""
            )));
        }
    };
    if matches!(law, Law::Rotation) && width != 4 {
        return Err(PyValueError::new_err(format!(
            "width: a rotation has 4 numbers, got {width}"
        )));
    }
    if first.checked_add(count as u64).is_none() {
        return Err(PyValueError::new_err(format!(
            "first: there are members up to 2**64 - 1, got {first} and {count} of them"
        )));
    }
    let shape = [count, width];
    let items = memory::room("random numbers", &shape, size_of::<f64>())?;
    let stream = Stream::new(seed, stream);
    let interrupt = Interrupt::new(None);
    let watch = &mut |_| interrupt.poll(None);
    let (done, array) = match law {
        Law::Bits => {
            let mut out = vec![0_u64; items];
            let done = py.detach(|| stream.fill(first, width, &mut out, watch, |word| word));
            (done, out.into_pyarray(py).reshape(shape)?.into_any())
        }
        Law::Rotation => {
            let mut out = vec![[0.0; 4]; count];
            let done = py.detach(|| stream.fill_rotations(first, &mut out, watch));
            let flat = out.into_flattened();
            (done, flat.into_pyarray(py).reshape(shape)?.into_any())
        }
        Law::Uniform | Law::Normal => {
            let is_normal = matches!(law, Law::Normal);
            let mut out = vec![0.0; items];
            let done = py.detach(|| {
                if is_normal {
                    stream.fill(first, width, &mut out, watch, normal)
                } else {
                    stream.fill(first, width, &mut out, watch, uniform)
                }
            });
            (done, out.into_pyarray(py).reshape(shape)?.into_any())
        }
    };
    interrupt.finish(py, !matches!(done, Err(Halt::Stopped)))?;
    Ok(array)
}

/// S with ``S @ S.T`` the covariance, which may be semidefinite; columns beyond its rank are zero.
///
/// Parameters
/// ----------
/// covariance : array_like, shape (k, k)
///
/// Returns
/// -------
/// numpy.ndarray, shape (k, k)
#[pyfunction]
pub(crate) fn covariance_factor<'py>(
    py: Python<'py>,
    covariance: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let array = floats(covariance, "covariance")?;
    let shape = array.shape().to_vec();
    if !matches!(shape[..], [rows, columns] if rows == columns) {
        return Err(PyValueError::new_err(format!(
            "covariance: expected shape (k, k), got {}",
            tuple(&shape)
        )));
    }
    let found = factor(array.as_slice()?).map_err(|error| to_py(py, &error))?;
    found.into_pyarray(py).reshape(shape)
}
