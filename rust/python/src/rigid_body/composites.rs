//! Composites: parts put to a body or taken out of it, stacks put together.

use polhode::mass::composites::combined;
use polhode::uncertainty::together;
use pyo3::exceptions::{PyOverflowError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyNotImplemented, PyTuple};

use crate::arrays::numpy;
use crate::body::{Doubts, PyRigidBody};
use crate::indexing::{picked_rows, to_index};
use crate::stack::Broadcast;
use crate::uncertain::carried;

#[pymethods]
impl PyRigidBody {
    fn __add__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let other = other.get();
        let grid = self.with("other", &other.bodies)?;
        let sum = grid.try_map(py, |[a, b]| self.bodies[a].combined(&other.bodies[b]))?;
        let sum = Self::doubtful(sum, self.with_part(py, &grid, 1.0, other)?)
            .looking(self.joined(&grid, other, false));
        Ok(sum.into_pyobject(py)?.into_any())
    }

    /// `sum()` starts from zero.
    fn __radd__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if other.extract::<i64>().is_ok_and(|zero| zero == 0) {
            let same = Self::doubtful(self.bodies.map(py, |body| *body)?, self.doubts.clone())
                .looking(self.figures.clone());
            return Ok(same.into_pyobject(py)?.into_any());
        }
        Ok(PyNotImplemented::get(py).to_owned().into_any())
    }

    fn __sub__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let other = other.get();
        let shapes = [&self.bodies.shape[..], &other.bodies.shape];
        let grid = Broadcast::of(["body", "other"], shapes)?;
        let rest = grid.try_map(py, |[a, b]| self.bodies[a].without(&other.bodies[b]))?;
        let rest = Self::doubtful(rest, self.with_part(py, &grid, -1.0, other)?)
            .looking(self.joined(&grid, other, true));
        Ok(rest.into_pyobject(py)?.into_any())
    }

    /// Combine the bodies of a stack into one rigid body, or those along some axes of the stack.
    ///
    /// All bodies are summed about the common centre of mass in one pass. This is faster than adding body
    /// after body, and has smaller rounding errors. The smallest moment of collinear rods and particles stays
    /// accurate.
    ///
    /// Parameters
    /// ----------
    /// axis : int or tuple of int, optional
    ///     Axes of the stack along which bodies are combined; all axes by default.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// Wheels on an axle:
    ///
    /// >>> from polhode import laminae, rods
    /// >>> wheels = laminae.disk(1.0, mass=2.0).translated([(0, 0, -1), (0, 0, 1)])
    /// >>> (wheels.combined() + rods.rod(2.0, mass=3.0)).principal_moments
    /// array([2., 6., 6.])
    #[pyo3(signature = (axis=None))]
    fn combined(&self, py: Python<'_>, axis: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let np = numpy(py)?;
        // NumPy itself tells which rows come together: those axes last, as one.
        let rows = np
            .call_method1("arange", (self.bodies.rows.len(),))?
            .call_method1("reshape", (PyTuple::new(py, &self.bodies.shape)?,))?;
        let depth = self.bodies.shape.len();
        let axes: Vec<usize> = match axis {
            None => (0..depth).collect(),
            Some(axis) => np
                .getattr("lib")?
                .getattr("array_utils")?
                .call_method1("normalize_axis_tuple", (axis, depth))
                .map_err(|error| {
                    if error.is_instance_of::<PyOverflowError>(py) {
                        PyValueError::new_err(format!(
                            "axis: a number beyond any axis, of a stack with {depth}"
                        ))
                    } else {
                        error
                    }
                })?
                .extract()?,
        };
        let kept: Vec<usize> = (0..depth).filter(|k| !axes.contains(k)).collect();
        let shape: Vec<usize> = kept.iter().map(|&k| self.bodies.shape[k]).collect();
        let count: usize = axes.iter().map(|&k| self.bodies.shape[k]).product();
        let order = [&kept[..], &axes].concat();
        let rows = picked_rows(&np.call_method1("transpose", (rows, order))?)?;
        let rows = rows.as_slice()?;
        let parts = Broadcast::of(["body"], [&[rows.len()]])?
            .try_map(py, |[k]| Ok(self.bodies[to_index(rows[k])]))?
            .rows;
        let grid = Broadcast::of(["body"], [&shape])?;
        let whole = grid.try_map(py, |[row]| combined(&parts[row * count..(row + 1) * count]))?;
        let doubts = carried(py, &grid, self.doubts.is_some(), |[row]| {
            let parts: Vec<_> = (row * count..(row + 1) * count)
                .map(|k| {
                    let (numbers, doubt) = self.row(to_index(rows[k]));
                    (1.0, numbers, doubt)
                })
                .collect();
            Ok(together(&parts))
        })?;
        let order: Vec<usize> = rows.iter().map(|&row| to_index(row)).collect();
        let figures = self.gathered(count, &order);
        Ok(Self::doubtful(whole, doubts).looking(figures))
    }
}

impl PyRigidBody {
    /// The doubts of each body with a part put to it (the sign +1) or taken out of it (−1).
    pub(super) fn with_part(
        &self,
        py: Python<'_>,
        grid: &Broadcast<'_, 2>,
        sign: f64,
        part: &Self,
    ) -> PyResult<Doubts> {
        let is_uncertain = self.doubts.is_some() || part.doubts.is_some();
        carried(py, grid, is_uncertain, |[a, b]| {
            let ((own, doubt), (its, other)) = (self.row(a), part.row(b));
            Ok(together(&[(1.0, own, doubt), (sign, its, other)]))
        })
    }
}
