//! Particles in arrays: shapes and layout, without copying what is C-ordered float64.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use polhode::mass::particles::Particles;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{as_array, contiguous, list_floats};

/// Arrays of masses (..., n) and positions (..., n, 3).
pub(crate) struct ParticleArrays<'py> {
    masses: PyReadonlyArrayDyn<'py, f64>,
    positions: PyReadonlyArrayDyn<'py, f64>,
    /// How many particles a body has.
    count: usize,
}

impl<'py> ParticleArrays<'py> {
    /// `leading` is "n", or "..., n" where stacks are meant.
    pub(crate) fn read(
        masses: &Bound<'py, PyAny>,
        positions: &Bound<'py, PyAny>,
        leading: &str,
    ) -> PyResult<Self> {
        let masses = list_floats(masses, "masses", leading, &[])?;
        let positions = list_floats(positions, "positions", leading, &[3])?;
        let (n, m) = (
            masses.shape()[masses.ndim() - 1],
            positions.shape()[positions.ndim() - 2],
        );
        if n != m {
            return Err(PyValueError::new_err(format!(
                "masses and positions: expected shapes ({leading}) and ({leading}, 3), got n = {n} and n = {m}"
            )));
        }
        Ok(Self {
            masses,
            positions,
            count: n,
        })
    }

    /// The shapes of the stacks.
    pub(crate) fn shapes(&self) -> [&[usize]; 2] {
        let [masses, positions] = [self.masses.shape(), self.positions.shape()];
        [
            &masses[..masses.len() - 1],
            &positions[..positions.len() - 2],
        ]
    }

    /// The arrays, row after row.
    pub(crate) fn rows(&self) -> PyResult<Rows<'_>> {
        Ok(Rows {
            masses: self.masses.as_slice()?,
            positions: self.positions.as_slice()?.as_chunks().0,
            count: self.count,
        })
    }
}

/// The rows of both arrays.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub(crate) masses: &'a [f64],
    pub(crate) positions: &'a [[f64; 3]],
    /// Particles in each row.
    pub(crate) count: usize,
}

impl<'a> Rows<'a> {
    /// The masses of row i with the positions of row j.
    pub(crate) fn row(&self, [i, j]: [usize; 2]) -> Particles<'a> {
        let n = self.count;
        Particles::new(
            &self.masses[i * n..(i + 1) * n],
            &self.positions[j * n..(j + 1) * n],
        )
    }
}

/// Labels, shape (n,), as many as there are particles.
pub(crate) fn read_labels<'py>(
    object: &Bound<'py, PyAny>,
    count: usize,
) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let array = as_array(object, "labels")?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if shape != [count] {
        return Err(PyValueError::new_err(format!(
            "labels: expected shape ({count},), one for each particle, got {}",
            crate::shape::tuple(&shape)
        )));
    }
    if count > 0 && !"iu".contains(&kind) {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "labels: expected integers, got dtype {dtype}"
        )));
    }
    if count > 0 && kind == "u" {
        let largest = array.call_method0("max")?;
        if largest.extract::<i64>().is_err() {
            return Err(PyValueError::new_err(format!(
                "labels: {largest} is beyond the whole numbers of 64 bits; number the bodies by smaller ones"
            )));
        }
    }
    contiguous(&array, "labels", "int64")?.extract()
}
