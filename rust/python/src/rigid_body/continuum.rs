//! Bodies from matter that fills space: tetrahedra, and densities over regions.

use polhode::Error;
use polhode::error::CellFault;
use polhode::mass::density::{Effort, Estimate, from_density, from_radial_density};
use polhode::mass::regions::Region;
use polhode::mass::tetrahedra::{CellDensity, tetrahedra};
use polhode::parallel;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{Item, read, read_indices, read_list, read_scalar, write};
use crate::body::PyRigidBody;
use crate::depth::Deeper;
use crate::errors::to_py;
use crate::interrupt::Interrupt;
use crate::meshes::finish;
use crate::regions::PyRegion;
use crate::shape::tuple;
use crate::stack::Stack;

#[pymethods]
impl PyRigidBody {
    /// Body made of tetrahedra, such as the cells of a finite-element mesh, by exact integrals.
    ///
    /// The nodes of a cell may be in either orientation. Where cells overlap, the overlap counts twice.
    ///
    /// Parameters
    /// ----------
    /// nodes : array_like, shape (n, 3)
    /// cells : array_like of int, shape (m, 4)
    ///     The four nodes of each tetrahedron, counted from zero.
    /// density : float or array_like, shape (m,) or (n,)
    ///     One number for all cells, one for each cell, or one for each node with linear interpolation in the
    ///     cells.
    /// at : {"cells", "nodes"}, optional
    ///     Whether an array of densities belongs to cells or nodes; needed only if there are as many cells as
    ///     nodes.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     Naming the cell, node or density that is at fault.
    ///
    /// Examples
    /// --------
    /// A density that grows with x:
    ///
    /// >>> from polhode import RigidBody
    /// >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    /// >>> body = RigidBody.from_tetrahedra(corners, [(0, 1, 2, 3)], density=[0, 24, 0, 0])
    /// >>> round(body.mass, 12), body.center_of_mass.round(12)
    /// (1.0, array([0.4, 0.2, 0.2]))
    #[staticmethod]
    #[pyo3(signature = (nodes, cells, *, density, at=None))]
    fn from_tetrahedra(
        py: Python<'_>,
        nodes: &Bound<'_, PyAny>,
        cells: &Bound<'_, PyAny>,
        density: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = read_scalar)] at: Option<&str>,
    ) -> PyResult<Self> {
        let nodes: Stack<[f64; 3]> = read_list(nodes, "nodes", "n")?;
        let cells = read_indices::<4>(cells, "cells")?.map_err(|(cell, index)| {
            let nodes = nodes.rows.len();
            to_py(
                py,
                &CellFault::IndexOutOfRange { cell, index, nodes }.into(),
            )
        })?;
        let density: Stack<f64> = read(density, "density")?;
        let given = placed(&density, at, cells.len(), nodes.rows.len())?;
        let interrupt = Interrupt::new(None);
        let watch = &mut |_| interrupt.poll(None);
        let body = py.detach(|| tetrahedra(&nodes.rows, &cells, given, watch));
        let body = finish(py, interrupt, body.map_err(parallel::Halt::from))?;
        Ok(Stack::one(body).into())
    }

    /// Body that fills a region of space with a density given as a function.
    ///
    /// The integrals are computed by adaptive cubature. The density should be smooth inside the region. If it
    /// has a jump, take one region on each side of the jump, and add the two bodies.
    ///
    /// The estimated error includes that of a jump inside the region. The integrals converge to any tolerance
    /// if the jump follows the coordinates of the region, like a plane parallel to the faces of a box or a
    /// sphere about the centre of a ball; other jumps allow a few digits only. A feature much smaller than a
    /// tenth of the region may be missed, so the bounds should be tight.
    ///
    /// Parameters
    /// ----------
    /// density : callable
    ///     ``density(points)``, with points of shape (n, 3), returns the densities there, shape (n,):
    ///     none negative.
    /// bounds : Region or array_like, shape (2, 3)
    ///     A region of :mod:`polhode.regions`, or two opposite corners of a box.
    /// rtol : float, optional
    ///     Bound on the estimated errors: of the mass, relative to the mass; of the centre of mass, relative
    ///     to the radius of gyration; of the second moments, relative to their sum.
    /// max_evaluations : int, optional
    ///     Largest number of points at which the density is evaluated. The search for jumps next to the faces
    ///     of the cells takes up to a sixth more.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// QuadratureError
    ///     When `max_evaluations` are not enough. The error has the estimate and its own estimated error.
    ///
    /// Examples
    /// --------
    /// A ball whose density decreases from the centre outward:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody, regions
    /// >>> ball = RigidBody.from_density(lambda r: 1 - (r**2).sum(axis=1), regions.ball(radius=1.0))
    /// >>> round(ball.mass / np.pi, 9)
    /// 0.533333333
    #[staticmethod]
    #[pyo3(signature = (density, bounds, *, rtol=1e-9, max_evaluations=10_000_000))]
    fn from_density(
        py: Python<'_>,
        density: &Bound<'_, PyAny>,
        bounds: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
        #[pyo3(from_py_with = read_scalar)] max_evaluations: i128,
    ) -> PyResult<Self> {
        let _deeper = Deeper::run("from_density")?;
        callable(density)?;
        let region = region(bounds)?;
        let effort = Effort {
            rtol,
            max_evaluations: count(max_evaluations)?,
        };
        let at = |points: &[[f64; 3]], values: &mut [f64]| ask(density, points, values);
        finished(py, from_density(&region, at, effort))
    }

    /// Ball whose density depends only on the distance from its centre: a star, a planet, a layered shell.
    ///
    /// Parameters
    /// ----------
    /// density : callable
    ///     ``density(radii)``, with radii of shape (n,), returns the densities there, shape (n,): none
    ///     negative.
    /// radii : float or array_like, shape (k,)
    ///     The radius; or ascending radii, at each of which the density may jump. If the first of them is not
    ///     zero, it is the radius of a cavity.
    /// rtol : float, optional
    ///     Bound on the estimated relative errors of mass and moments.
    /// max_evaluations : int, optional
    ///     Largest number of radii at which the density is evaluated. The search for jumps next to the
    ///     boundaries takes up to twice as many more.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// QuadratureError
    ///     When `max_evaluations` are not enough. The error has the estimate and its own estimated error.
    ///
    /// Examples
    /// --------
    /// A core twice as dense as the mantle:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody, solids
    /// >>> layers = lambda r: np.where(r < 0.5, 2.0, 1.0)
    /// >>> planet = RigidBody.from_radial_density(layers, [0, 0.5, 1])
    /// >>> core_and_all = solids.sphere(0.5, density=1.0) + solids.sphere(1.0, density=1.0)
    /// >>> planet.isclose(core_and_all, rtol=1e-14)
    /// True
    #[staticmethod]
    #[pyo3(signature = (density, radii, *, rtol=1e-9, max_evaluations=1_000_000))]
    fn from_radial_density(
        py: Python<'_>,
        density: &Bound<'_, PyAny>,
        radii: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
        #[pyo3(from_py_with = read_scalar)] max_evaluations: i128,
    ) -> PyResult<Self> {
        let _deeper = Deeper::run("from_radial_density")?;
        callable(density)?;
        let radii: Stack<f64> = read(radii, "radii")?;
        let boundaries = match radii.shape[..] {
            [] => vec![0.0, radii[0]],
            [k] if k >= 2 => radii.rows,
            _ => {
                return Err(PyValueError::new_err(format!(
                    "radii: expected one radius, or two and more in shape (k,), got {}",
                    tuple(&radii.shape)
                )));
            }
        };
        let effort = Effort {
            rtol,
            max_evaluations: count(max_evaluations)?,
        };
        let at = |points: &[f64], values: &mut [f64]| ask(density, points, values);
        finished(py, from_radial_density(&boundaries, at, effort))
    }
}

/// Why a cubature ended early: by its own law, or by an exception of the user's function.
enum Halt {
    Law(Error),
    Raised(PyErr),
}

impl From<Error> for Halt {
    fn from(error: Error) -> Self {
        Self::Law(error)
    }
}

impl From<PyErr> for Halt {
    fn from(error: PyErr) -> Self {
        Self::Raised(error)
    }
}

/// The body; or the user's own exception as it was; or what the law says, with the estimate where there is one.
fn finished(py: Python<'_>, outcome: Result<Estimate, Halt>) -> PyResult<PyRigidBody> {
    let found = match outcome {
        Ok(found) => found,
        Err(Halt::Raised(error)) => return Err(error),
        Err(Halt::Law(error)) => return Err(to_py(py, &error)),
    };
    match found.converged() {
        Ok(body) => Ok(Stack::one(body).into()),
        Err(error) => {
            let raised = to_py(py, &error);
            let value = raised.value(py);
            value.setattr("estimate", PyRigidBody::from(Stack::one(found.body)))?;
            value.setattr("error", found.error)?;
            value.setattr("evaluations", found.evaluations)?;
            Err(raised)
        }
    }
}

/// The user's function at these points.
fn ask<T: Item + Copy>(
    density: &Bound<'_, PyAny>,
    points: &[T],
    values: &mut [f64],
) -> Result<(), Halt> {
    let py = density.py();
    py.check_signals()?;
    let batch = Stack {
        shape: vec![points.len()],
        rows: points.to_vec(),
    };
    let answer = density.call1((write(py, &batch)?,))?;
    let densities: Stack<f64> = read(&answer, "density")?;
    if densities.shape != batch.shape {
        return Err(PyValueError::new_err(format!(
            "density: expected it to return shape {}, one number for each point, got {}",
            tuple(&batch.shape),
            tuple(&densities.shape)
        ))
        .into());
    }
    values.copy_from_slice(&densities.rows);
    Ok(())
}

/// How many evaluations are allowed.
fn count(max_evaluations: i128) -> PyResult<usize> {
    if max_evaluations < 0 {
        return Err(PyValueError::new_err(format!(
            "max_evaluations: expected a count, got {max_evaluations}"
        )));
    }
    Ok(usize::try_from(max_evaluations).unwrap_or(usize::MAX))
}

fn callable(density: &Bound<'_, PyAny>) -> PyResult<()> {
    if density.is_callable() {
        return Ok(());
    }
    let kind = density.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "density: expected a function of points, got {kind}; a uniform density goes to solids, from_mesh or \
         from_tetrahedra"
    )))
}

/// A region, or the box between two corners.
fn region(bounds: &Bound<'_, PyAny>) -> PyResult<Region> {
    if let Ok(region) = bounds.cast::<PyRegion>() {
        return Ok(region.get().region.clone());
    }
    let corners: Stack<[f64; 3]> = read_list(bounds, "bounds", "2")?;
    let [low, high] = &corners.rows[..] else {
        return Err(PyValueError::new_err(format!(
            "bounds: expected a region or two corners of shape (2, 3), got ({}, 3)",
            corners.rows.len()
        )));
    };
    Region::cuboid(&(*low).into(), &(*high).into()).map_err(|error| to_py(bounds.py(), &error))
}

/// Which of cells and nodes the densities belong to.
fn placed<'a>(
    density: &'a Stack<f64>,
    at: Option<&str>,
    cells: usize,
    nodes: usize,
) -> PyResult<CellDensity<'a>> {
    if !matches!(at, None | Some("cells" | "nodes")) {
        return Err(PyValueError::new_err(format!(
            "at: expected \"cells\" or \"nodes\", got {:?}",
            at.unwrap_or_default()
        )));
    }
    if density.is_one() {
        return Ok(CellDensity::Uniform(density[0]));
    }
    let fits = |count: usize| density.shape == [count];
    match at {
        None if cells == nodes && fits(cells) => Err(PyValueError::new_err(format!(
            "density: there are as many cells as nodes, {cells}; say which it belongs to by at=\"cells\" or at=\"nodes\""
        ))),
        None | Some("cells") if fits(cells) => Ok(CellDensity::PerCell(&density.rows)),
        None | Some("nodes") if fits(nodes) => Ok(CellDensity::PerNode(&density.rows)),
        _ => Err(PyValueError::new_err(format!(
            "density: expected one number, shape ({cells},) for the cells or ({nodes},) for the nodes, got {}",
            tuple(&density.shape)
        ))),
    }
}
