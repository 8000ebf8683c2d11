//! Bodies of particles and of voxels.

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use polhode::Error;
use polhode::error::BodyFault;
use polhode::mass::particles::{labelled_particles, particle_stack, particles_watched};
use polhode::mass::voxels::{Grid, Voxel, voxels};
use polhode::uncertainty::of_particles;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Argument, floats, read, read_or, write};
use crate::body::PyRigidBody;
use crate::elsewhere::{handed_over, is_any};
use crate::errors::{at_label, at_row, to_py};
use crate::figure::{Outline, alone};
use crate::interrupt::watched;
use crate::particles::{ParticleArrays, read_labels};
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack, try_watched};
use crate::uncertain::{Quantity, carried, holds_uncertain, is_uncertain, quantity_list};

#[pymethods]
impl PyRigidBody {
    /// Body made of particles, or a stack of such bodies.
    ///
    /// ``I = Σ m (r² 1 − r rᵀ)``, summed about a point of the body, so that a large distance from the origin
    /// costs no accuracy. The smallest moment of a thin body is as accurate as the coordinates are. Arrays of
    /// C-ordered float64 are not copied; large ones are summed on all cores. The result has the same bits for
    /// any number of threads, and for a body alone or in any stack.
    ///
    /// Particles of one body that are not in memory are never loaded as a whole. Zarr arrays, HDF5 datasets
    /// (h5py) and memory maps are read piece by piece. Dask arrays are summed chunk by chunk where dask
    /// computes them, on the workers of its client if there is one. The sum is that of `MassAccumulator`: it
    /// has the same bits for any chunks.
    ///
    /// Parameters
    /// ----------
    /// masses : array_like, shape (..., n)
    ///     Masses of the particles; none negative, the sum positive.
    /// positions : array_like, shape (..., n, 3)
    ///     Positions of the particles in the body frame. Leading axes broadcast against those of `masses`:
    ///     for the frames of a trajectory, shape (T, n, 3), masses of shape (n,) will do.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     Naming the particle whose mass is negative.
    ///
    /// See Also
    /// --------
    /// from_labelled_particles : many bodies of different sizes in one list of particles.
    /// polhode.MassAccumulator : more particles than fit into memory.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> dumbbell = RigidBody.from_particles([1.0, 3.0], [(0, 0, 0), (4, 0, 0)])
    /// >>> dumbbell.center_of_mass
    /// array([3., 0., 0.])
    /// >>> dumbbell.principal_moments
    /// array([ 0., 12., 12.])
    ///
    /// Two frames of the same two particles:
    ///
    /// >>> frames = [[(0, 0, 0), (4, 0, 0)], [(0, 0, 0), (0, 8, 0)]]
    /// >>> RigidBody.from_particles([1.0, 3.0], frames).principal_moments
    /// array([[ 0., 12., 12.],
    ///        [ 0., 48., 48.]])
    #[staticmethod]
    fn from_particles<'py>(
        py: Python<'py>,
        masses: &Bound<'py, PyAny>,
        positions: &Bound<'py, PyAny>,
    ) -> PyResult<Self> {
        if is_any(&[Some(masses), Some(positions)])
            && let Some(body) = handed_over(py, "body_of_particles", (masses, positions), None)?
        {
            return Ok(body.cast_into::<Self>()?.get().clone());
        }
        if is_uncertain(masses) || is_uncertain(positions) {
            return of_uncertain_particles(py, masses, positions);
        }
        let arrays = match ParticleArrays::read(masses, positions, "..., n") {
            Ok(arrays) => arrays,
            Err(fault) => {
                if holds_uncertain(masses, &fault)? || holds_uncertain(positions, &fault)? {
                    return of_uncertain_particles(py, masses, positions);
                }
                return Err(fault);
            }
        };
        let grid = Broadcast::of(["masses", "positions"], arrays.shapes())?;
        let rows = arrays.rows()?;
        let bodies = watched(py, |watch| {
            if grid.shape.is_empty() {
                let body = particles_watched(rows.masses, rows.positions, watch);
                body.map(|body| vec![body]).map_err(|error| (0, error))
            } else {
                particle_stack(
                    grid.len(),
                    |_| rows.count,
                    |row| rows.row(grid.operands(row)),
                    watch,
                )
            }
        })?;
        let outline = (grid.shape.is_empty())
            .then(|| Outline::of_particles(rows.masses, rows.positions))
            .flatten();
        let figures = alone(outline);
        Ok(stack(py, grid.shape, bodies)?.looking(figures))
    }

    /// Bodies from one list of particles, where a label tells the body of each particle: haloes, fragments,
    /// residues.
    ///
    /// Parameters
    /// ----------
    /// masses : array_like, shape (n,)
    /// positions : array_like, shape (n, 3)
    /// labels : array_like of int, shape (n,)
    ///     Number of the body of each particle, counted from 0, in any order; −1 for a particle of no body.
    ///     Every number up to the largest must have some mass. For labels with gaps see
    ///     :mod:`polhode.labelled`.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///     A stack with one body for each label. Each has the same bits as `from_particles` gives for its
    ///     particles alone.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> positions = [(0, 0, 0), (5, 0, 0), (4, 0, 0), (5, 2, 0), (9, 9, 9)]
    /// >>> bodies = RigidBody.from_labelled_particles([1, 2, 3, 2, 7], positions, [0, 1, 0, 1, -1])
    /// >>> bodies.mass
    /// array([4., 4.])
    /// >>> bodies.principal_moments
    /// array([[ 0., 12., 12.],
    ///        [ 0.,  4.,  4.]])
    #[staticmethod]
    fn from_labelled_particles(
        py: Python<'_>,
        masses: &Bound<'_, PyAny>,
        positions: &Bound<'_, PyAny>,
        labels: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let arrays = ParticleArrays::read(masses, positions, "n")?;
        let rows = arrays.rows()?;
        let labels = read_labels(labels, rows.masses.len())?;
        let labels = labels.as_slice()?;
        let bodies = watched(py, |watch| {
            labelled_particles(rows.masses, rows.positions, labels, watch)
        })?;
        match bodies {
            Err((None, error)) => Err(to_py(py, &error)),
            Err((Some(label), error)) => {
                let way_out = way_out_of_label(&error);
                let error = to_py(py, &error);
                Err(at_label(py, label, way_out, &error))
            }
            Ok(bodies) => stack(py, vec![bodies.len()], Ok(bodies)),
        }
    }

    /// Body given by its density on a rectangular grid, where each cell is a homogeneous box.
    ///
    /// The integrals are exact for such cells. They include the second moment ``m h²/12`` of each cell along
    /// each of its edges, which a sum over the centres would miss.
    ///
    /// Parameters
    /// ----------
    /// density : array_like, shape (..., nx, ny, nz)
    ///     Mass per volume, not negative; ``density[i, j, k]`` runs along x, y, z. C-ordered float32 and
    ///     float64 arrays are not copied; sums are taken in double precision.
    /// spacing : float or array_like, shape (3,)
    ///     Edges of a cell.
    /// origin : array_like, shape (3,), optional
    ///     Centre of the cell ``density[0, 0, 0]``.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     Naming the cell whose density is negative.
    ///
    /// Examples
    /// --------
    /// A box of 1 × 2 × 3 cut into any cells is the same box:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> box = RigidBody.from_voxels(np.full((4, 4, 4), 2.0), spacing=(0.25, 0.5, 0.75))
    /// >>> box.mass
    /// 12.0
    /// >>> box.principal_moments
    /// array([ 5., 10., 13.])
    #[staticmethod]
    #[pyo3(signature = (density, spacing, origin=Argument::default()), text_signature = "(density, spacing, origin=(0.0, 0.0, 0.0))")]
    fn from_voxels(
        py: Python<'_>,
        density: &Bound<'_, PyAny>,
        spacing: &Bound<'_, PyAny>,
        origin: Argument<'_>,
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
        let origin: Stack<[f64; 3]> = read_or(&origin, "origin", [0.0; 3])?;
        if !origin.is_one() {
            let message = format!("origin: expected shape (3,), got {}", tuple(&origin.shape));
            return Err(PyValueError::new_err(message));
        }
        if let Ok(array) = density.cast_exact::<PyArrayDyn<f32>>()
            && array.is_c_contiguous()
            && array.is_aligned()
        {
            let array = array.readonly();
            return of_voxels(py, array.as_slice()?, array.shape(), spacing, origin[0]);
        }
        let array = floats(density, "density")?;
        of_voxels(py, array.as_slice()?, array.shape(), spacing, origin[0])
    }
}

/// The bodies of particles whose masses or positions have a sigma.
fn of_uncertain_particles<'py>(
    py: Python<'py>,
    masses: &Bound<'py, PyAny>,
    positions: &Bound<'py, PyAny>,
) -> PyResult<PyRigidBody> {
    let m: Quantity<f64> = quantity_list(masses, "masses", "..., n")?;
    let r: Quantity<[f64; 3]> = quantity_list(positions, "positions", "..., n")?;
    let bodies = PyRigidBody::from_particles(
        py,
        write(py, &m.values)?.as_any(),
        write(py, &r.values)?.as_any(),
    )?;
    let ([first @ .., n], [second @ .., _]) = (&m.values.shape[..], &r.values.shape[..]) else {
        return Ok(bodies);
    };
    let grid = Broadcast::of(["masses", "positions"], [first, second])?;
    let doubts = carried(py, &grid, true, |[i, j]| {
        Ok(of_particles(
            (0..*n).map(|k| (m.row(i * n + k), r.row(j * n + k))),
        ))
    })?;
    Ok(PyRigidBody { doubts, ..bodies })
}

/// The bodies of densities of this shape.
fn of_voxels<T: Voxel>(
    py: Python<'_>,
    density: &[T],
    shape: &[usize],
    spacing: [f64; 3],
    origin: [f64; 3],
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
        spacing,
        origin,
    });
    let bodies = try_watched(py, leading.to_vec(), grids, |grid, watch| {
        voxels(&grid, watch)
    })?;
    Ok(bodies.into())
}

/// The bodies under their shape, or the error with its row.
fn stack(
    py: Python<'_>,
    shape: Vec<usize>,
    bodies: Result<Vec<polhode::RigidBody>, (usize, Error)>,
) -> PyResult<PyRigidBody> {
    match bodies {
        Ok(rows) => Ok(Stack { shape, rows }.into()),
        Err((row, error)) => Err(at_row(&shape, row, &to_py(py, &error), py)),
    }
}

/// What to do about a label without mass.
fn way_out_of_label(error: &Error) -> &'static str {
    match error {
        Error::Body(BodyFault::NoMass { count: 0, .. }) => {
            "; every label from 0 to the largest needs a particle here: polhode.labelled.bodies takes labels with gaps"
        }
        Error::Body(BodyFault::NoMass { .. }) => {
            "; give its particles their masses, or the label -1 where they belong to no body"
        }
        _ => "",
    }
}
