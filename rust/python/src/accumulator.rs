//! The class `MassAccumulator`.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::PyArrayDyn;
use polhode::mass::MassAccumulator;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::arrays::{read_scalar, write};
use crate::body::PyRigidBody;
use crate::errors::to_py;
use crate::interrupt::watched;
use crate::lazy_arrays::{handed_over, is_any};
use crate::particles::ParticleArrays;
use crate::stack::Stack;

/// Sum of particles in chunks: for files larger than memory, for streams, and for many machines.
///
/// Add the chunks one by one; `finish` then gives the body. Only a few kilobytes are kept between the chunks.
/// Second moments are summed in twice the precision, since a stream cannot be read a second time: the
/// smallest moment of a rod with a thickness of 1e-8 of its length is accurate to 1e-14. The result has the
/// same bits for any division into chunks, and for any order of chunks that have a `start`.
///
/// Accumulators can be pickled: each worker adds its own chunks, and then the accumulators are merged.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import MassAccumulator
/// >>> particles = MassAccumulator()
/// >>> for x in range(5):
/// ...     particles.add([1.0, 1.0], [(x, 1, 0), (x, -1, 0)])
/// >>> particles.count
/// 10
/// >>> particles.finish().principal_moments
/// array([10., 20., 30.])
///
/// A file of n rows (mass, x, y, z) that does not fit into memory::
///
///     rows = np.memmap(path, dtype=np.float64).reshape(-1, 4)
///     for start in range(0, len(rows), 1 << 20):
///         chunk = rows[start : start + (1 << 20)]
///         particles.add(chunk[:, 0], chunk[:, 1:])
#[pyclass(name = "MassAccumulator", module = "polhode", frozen)]
#[derive(Default)]
pub(crate) struct PyMassAccumulator {
    /// Locked only without the interpreter lock, which whoever holds it may be waiting for.
    sums: Mutex<MassAccumulator>,
}

#[pymethods]
impl PyMassAccumulator {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Add particles.
    ///
    /// Parameters
    /// ----------
    /// masses : array_like, shape (n,)
    ///     Masses of the particles.
    /// positions : array_like, shape (n, 3)
    ///     Positions of the particles. Arrays of dask, zarr, h5py and memory maps are not loaded as a whole.
    /// start : int, optional
    ///     Number of the first of these particles among all particles; by default it is the next number. With
    ///     `start` the chunks may come in any order, and from several accumulators that are merged.
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     When a mass is negative; the message names the particle, counted within the chunk.
    /// PolhodeError
    ///     When a particle with the same number has been added before. After any error nothing of the chunk
    ///     is added.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import MassAccumulator
    /// >>> particles = MassAccumulator()
    /// >>> particles.add([3.0], [(4, 0, 0)], start=1)
    /// >>> particles.add([1.0], [(0, 0, 0)], start=0)
    /// >>> particles.finish().center_of_mass
    /// array([3., 0., 0.])
    #[pyo3(signature = (masses, positions, start=None))]
    fn add<'py>(
        slf: &Bound<'py, Self>,
        masses: &Bound<'py, PyAny>,
        positions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = read_scalar)] start: Option<i128>,
    ) -> PyResult<()> {
        let (py, this) = (slf.py(), slf.get());
        let start = start.map(number_of_particle).transpose()?;
        if is_any(&[Some(masses), Some(positions)]) {
            let first = start.unwrap_or_else(|| py.detach(|| this.lock().end()));
            if let Some(chunk) = handed_over(py, "sum_particles", (masses, positions, first), None)?
            {
                let chunk = chunk.cast_into::<Self>()?;
                let chunk = chunk.get();
                let merged = py.detach(|| {
                    let chunk = chunk.lock().clone();
                    let mut sums = this.lock();
                    if start.is_some() {
                        sums.merge(&chunk)
                    } else {
                        sums.merge_next(&chunk)
                    }
                });
                return merged.map_err(|error| to_py(py, &error));
            }
        }
        let arrays = ParticleArrays::read(masses, positions, "n")?;
        let rows = arrays.rows()?;
        let added = watched(py, |watch| {
            this.lock().add(rows.masses, rows.positions, start, watch)
        })?;
        added.map_err(|error| to_py(py, &error))
    }

    /// Add the particles of another accumulator, which is not changed.
    ///
    /// Chunks that were added with a `start` keep their places. Those of an accumulator without places come
    /// after the last particle here; then the last bits may depend on how accumulators were merged.
    ///
    /// Parameters
    /// ----------
    /// other : MassAccumulator
    ///     Accumulator of other particles.
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     When a particle with the same number is in both; then nothing is added.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import MassAccumulator
    /// >>> left, right = MassAccumulator(), MassAccumulator()
    /// >>> left.add([1.0], [(0, 0, 0)])
    /// >>> right.add([3.0], [(4, 0, 0)])
    /// >>> left.merge(right)
    /// >>> left.finish().principal_moments
    /// array([ 0., 12., 12.])
    fn merge(&self, py: Python<'_>, other: &Self) -> PyResult<()> {
        let merged = py.detach(|| {
            let other = other.lock().clone();
            self.lock().merge(&other)
        });
        merged.map_err(|error| to_py(py, &error))
    }

    /// The body of all particles so far; more may be added afterwards.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     When the total mass is not positive.
    /// PolhodeError
    ///     When a particle is missing before the last one.
    fn finish(&self, py: Python<'_>) -> PyResult<PyRigidBody> {
        let body = py.detach(|| self.lock().finish());
        Ok(Stack::one(body.map_err(|error| to_py(py, &error))?).into())
    }

    /// Bounds on the errors of the principal moments of the body that `finish` returns.
    ///
    /// An error is the difference from the result of exact arithmetic with the same input. The bounds are
    /// worst cases, mostly far above the actual errors. They tell, for example, how accurate the smallest
    /// moment of a rod thinner than 1e-8 of its length is.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (3,)
    ///
    /// Examples
    /// --------
    /// >>> from polhode import MassAccumulator
    /// >>> rod = MassAccumulator()
    /// >>> rod.add([1.0, 1.0, 1.0], [(0, 0, 0), (1, 1e-6, 0), (2, 0, 0)])
    /// >>> bool((rod.moment_bounds() < 1e-13 * rod.finish().principal_moments).all())
    /// True
    fn moment_bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let bounds = py.detach(|| self.lock().moment_bounds());
        write(py, &Stack::one(bounds.map_err(|error| to_py(py, &error))?))
    }

    /// Number of particles that have been added.
    #[getter]
    fn count(&self, py: Python<'_>) -> u64 {
        py.detach(|| self.lock().count())
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("<MassAccumulator of {} particles>", self.count(py))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_bytes")?;
        let bytes = py.detach(|| self.lock().to_bytes());
        Ok((restore, PyTuple::new(py, [PyBytes::new(py, &bytes)])?))
    }

    /// The accumulator that `__reduce__` took apart; for pickle.
    #[staticmethod]
    fn _from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let sums = MassAccumulator::from_bytes(bytes).map_err(|error| to_py(py, &error))?;
        Ok(Self {
            sums: Mutex::new(sums),
        })
    }
}

impl PyMassAccumulator {
    /// Nothing that holds the lock can panic between two changes.
    fn lock(&self) -> MutexGuard<'_, MassAccumulator> {
        self.sums.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn number_of_particle(start: i128) -> PyResult<u64> {
    u64::try_from(start).map_err(|_| {
        PyValueError::new_err(format!(
            "start: expected the number of a particle, 0 or more, got {start}"
        ))
    })
}
