//! Grids of voxels: where their cells stand, densities, labels.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use polhode::mass::labelled_voxels::{Label, LabelledCells, count_labels};
use polhode::mass::voxels::{Grid, Voxel, edges_of_boxes, voxels};
use polhode::{Error, RigidBody};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{Argument, read, read_or};
use crate::body::PyRigidBody;
use crate::errors::{to_py, with_prefix};
use crate::interrupt::watched;
use crate::shape::tuple;
use crate::stack::{Stack, try_watched};

/// The edges of a cell, and the centre of the first one.
pub(crate) struct Frame {
    pub(crate) edges: [[f64; 3]; 3],
    pub(crate) origin: [f64; 3],
}

impl Frame {
    /// From `affine`, or from `spacing` and `origin`.
    pub(crate) fn read(
        py: Python<'_>,
        spacing: Option<&Bound<'_, PyAny>>,
        origin: &Argument<'_>,
        affine: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        match (spacing, affine) {
            (Some(spacing), None) => Self::of_boxes(py, spacing, origin),
            (None, Some(_)) if origin.value().is_some() => Err(PyTypeError::new_err(
                "origin= goes with spacing=: the last column of affine is the centre of the first voxel",
            )),
            (None, Some(affine)) => Self::of_affine(affine),
            _ => Err(PyTypeError::new_err(
                "give exactly one of spacing= (edges of a voxel along x, y, z) and affine= (a matrix (4, 4))",
            )),
        }
    }

    fn of_boxes(
        py: Python<'_>,
        spacing: &Bound<'_, PyAny>,
        origin: &Argument<'_>,
    ) -> PyResult<Self> {
        let spacing = match read::<f64>(spacing, "spacing")? {
            one if one.is_one() => [one[0]; 3],
            three if three.shape == [3] => [three[0], three[1], three[2]],
            other => {
                let message = format!(
                    "spacing: expected one edge or shape (3,), got {}",
                    tuple(&other.shape)
                );
                return Err(PyValueError::new_err(message));
            }
        };
        let origin: Stack<[f64; 3]> = read_or(origin, "origin", [0.0; 3])?;
        if !origin.is_one() {
            let message = format!("origin: expected shape (3,), got {}", tuple(&origin.shape));
            return Err(PyValueError::new_err(message));
        }
        let edges = edges_of_boxes(spacing).map_err(|error| to_py(py, &error))?;
        Ok(Self {
            edges,
            origin: origin[0],
        })
    }

    /// `x = A (i, j, k, 1)`.
    fn of_affine(affine: &Bound<'_, PyAny>) -> PyResult<Self> {
        let affine: Stack<f64> = read(affine, "affine")?;
        let is_whole = affine.shape == [4, 4];
        if !is_whole && affine.shape != [3, 4] {
            return Err(PyValueError::new_err(format!(
                "affine: expected shape (4, 4), x = A (i, j, k, 1), got {}",
                tuple(&affine.shape)
            )));
        }
        if is_whole && affine.rows[12..] != [0.0, 0.0, 0.0, 1.0] {
            return Err(PyValueError::new_err(format!(
                "affine: expected 0, 0, 0, 1 as its last row, got {:?}",
                &affine.rows[12..]
            )));
        }
        let column = |k: usize| [0, 1, 2].map(|i| affine.rows[4 * i + k]);
        Ok(Self {
            edges: [column(0), column(1), column(2)],
            origin: column(3),
        })
    }
}

/// The bodies of densities of this shape.
pub(crate) fn of_voxels<T: Voxel>(
    py: Python<'_>,
    density: &[T],
    shape: &[usize],
    frame: &Frame,
) -> PyResult<PyRigidBody> {
    let Some((leading, &cells)) = shape.split_last_chunk() else {
        let message = format!(
            "density: expected shape (..., nx, ny, nz), got {}",
            tuple(shape)
        );
        return Err(PyValueError::new_err(message));
    };
    let size: usize = cells.iter().product();
    let grids = (0..leading.iter().product()).map(|row| Grid {
        density: &density[row * size..(row + 1) * size],
        shape: cells,
        edges: frame.edges,
        origin: frame.origin,
    });
    let bodies = try_watched(py, leading.to_vec(), grids, |grid, watch| {
        voxels(&grid, watch)
    })?;
    Ok(bodies.into())
}

/// The labels of a grid and their bodies, of the densities that `choose` returns for the labels, their counts and the ranges of their
/// indices, (n, 3, 2); a label of density zero has none. Where `choose` returns None, so does this.
#[pyfunction]
pub(crate) fn labelled_voxels<'py>(
    py: Python<'py>,
    labels: &Bound<'py, PyAny>,
    spacing: Option<&Bound<'py, PyAny>>,
    origin: &Bound<'py, PyAny>,
    affine: Option<&Bound<'py, PyAny>>,
    choose: &Bound<'py, PyAny>,
) -> PyResult<Option<(Bound<'py, PyArray1<i64>>, PyRigidBody)>> {
    let origin = if origin.is_none() {
        Argument::default()
    } else {
        origin.extract()?
    };
    let frame = Frame::read(py, spacing, &origin, affine)?;
    macro_rules! counted {
        ($($kind:ty)*) => {
            $(if let Ok(array) = labels.cast::<PyArrayDyn<$kind>>() {
                count(py, &array.readonly(), frame)?
            } else)* {
                return Err(PyTypeError::new_err("labels: expected an array of real numbers"));
            }
        };
    }
    let (cells, frame) = counted!(u8 i8 u16 i16 u32 i32 u64 i64 f32 f64);
    let names: Vec<i64> = cells.iter().map(|cells| cells.label).collect();
    let counts: Vec<usize> = cells.iter().map(LabelledCells::count).collect();
    let ranges: Vec<usize> = cells
        .iter()
        .flat_map(|cells| cells.range.into_iter().flatten())
        .collect();
    let answer = choose.call1((
        PyArray1::from_vec(py, names),
        PyArray1::from_vec(py, counts),
        PyArray1::from_vec(py, ranges).reshape([cells.len(), 3, 2])?,
    ))?;
    if answer.is_none() {
        return Ok(None);
    }
    let densities: Stack<f64> = read(&answer, "density")?;
    let mut bodies: Vec<RigidBody> = Vec::new();
    let mut found: Vec<i64> = Vec::new();
    for (cells, &density) in cells.iter().zip(&densities.rows) {
        if density == 0.0 {
            continue;
        }
        let body = cells.body(&frame.edges, &frame.origin, density);
        let label = format!("label {}", cells.label);
        bodies.push(body.map_err(|error| with_prefix(py, &label, &to_py(py, &error)))?);
        found.push(cells.label);
    }
    let bodies = Stack {
        shape: vec![bodies.len()],
        rows: bodies,
    };
    Ok(Some((PyArray1::from_vec(py, found), bodies.into())))
}

/// The cells of each label, and the frame in whose order of axes the array lies in memory.
fn count<L: numpy::Element + Label>(
    py: Python<'_>,
    labels: &PyReadonlyArrayDyn<'_, L>,
    frame: Frame,
) -> PyResult<(Vec<LabelledCells>, Frame)> {
    let shape = match labels.shape() {
        [x, y, z] => [*x, *y, *z],
        other => {
            return Err(PyValueError::new_err(format!(
                "labels: expected shape (nx, ny, nz), got {}",
                tuple(other)
            )));
        }
    };
    let cells = labels.as_slice()?;
    let found: Result<Vec<LabelledCells>, Error> =
        watched(py, |watch| count_labels(cells, shape, watch))?;
    Ok((found.map_err(|error| to_py(py, &error))?, frame))
}
