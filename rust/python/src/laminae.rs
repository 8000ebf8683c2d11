//! Homogeneous laminae.

use polhode::mass::laminae;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::body::PyRigidBody;
use crate::figure::{Outline, alone, figures_of_lengths};
use crate::shapes::{Amounts, Optional, shape_function};
use crate::stack::Broadcast;
use crate::uncertain::{Quantity, propagate_rows, quantity, quantity_list};

shape_function! {
    /// Disk about z: I_z = ½ m R², I_x = ¼ m R².
    ///
    /// Parameters
    /// ----------
    /// radius : array_like, shape (...)
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two; the density is mass per area.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import laminae
    /// >>> laminae.disk(2.0, mass=3.0).principal_moments
    /// array([3., 3., 6.])
    disk(radius) = laminae::disk
}

shape_function! {
    /// Disk with a concentric hole: I_z = ½ m (R² + r²). With equal radii a ring.
    ///
    /// Parameters
    /// ----------
    /// inner_radius, outer_radius : array_like, shape (...)
    ///     r and R, r ≤ R.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two; the density is mass per area.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import laminae
    /// >>> laminae.annulus(inner_radius=1.0, outer_radius=3.0, mass=2.0).principal_moments
    /// array([ 5.,  5., 10.])
    annulus(inner_radius, outer_radius) = laminae::annulus
}

shape_function! {
    /// Ellipse with its axes along x and y: I_x = ¼ m b², I_y = ¼ m a².
    ///
    /// Parameters
    /// ----------
    /// semi_axes : array_like, shape (..., 2)
    ///     a, b: half the lengths along x, y.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two; the density is mass per area.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import laminae
    /// >>> laminae.ellipse((4.0, 2.0), mass=1.0).principal_moments
    /// array([1., 4., 5.])
    ellipse([semi_axes; 2]) = laminae::ellipse
}

shape_function! {
    /// Rectangle with its edges along x and y: I_x = m y²/12, I_y = m x²/12.
    ///
    /// Parameters
    /// ----------
    /// size : array_like, shape (..., 2)
    ///     Full edge lengths.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two; the density is mass per area.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import laminae
    /// >>> laminae.rectangle((2.0, 4.0), mass=3.0).inertia.diagonal()
    /// array([4., 1., 5.])
    rectangle([size; 2]) = laminae::rectangle
}

/// Triangle in the x-y plane, where its corners are.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (..., 3, 2)
///     x, y of the corners, in any order.
/// mass, density : array_like, shape (...)
///     Exactly one of the two; the density is mass per area.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import laminae
/// >>> triangle = laminae.triangle([(0, 0), (6, 0), (0, 3)], density=1.0)
/// >>> triangle.mass, triangle.center_of_mass
/// (9.0, array([2., 1., 0.]))
/// >>> triangle.inertia
/// array([[ 4.5,  4.5,  0. ],
///        [ 4.5, 18. ,  0. ],
///        [ 0. ,  0. , 22.5]])
#[pyfunction]
#[pyo3(signature = (vertices, *, mass=None, density=None))]
pub(crate) fn triangle(
    vertices: &Bound<'_, PyAny>,
    mass: Optional<'_, '_>,
    density: Optional<'_, '_>,
) -> PyResult<PyRigidBody> {
    let corners: Quantity<[[f64; 2]; 3]> = quantity(vertices, "vertices")?;
    let amounts = Amounts::read((mass, density))?;
    let shapes = [&corners.values.shape[..], &amounts.values.shape];
    let grid = Broadcast::of(["vertices", "mass or density"], shapes)?;
    let bodies = grid.try_map(vertices.py(), |[v, a]| {
        laminae::triangle(&corners.values[v], amounts.values[a])
    })?;
    let is_uncertain = corners.is_uncertain() || amounts.given.is_uncertain();
    let uncertainties = propagate_rows(vertices.py(), &grid, is_uncertain, |[v, a]| {
        amounts.doubt_of_polygon(a, corners.row(v))
    })?;
    let figures = figures_of_lengths("laminae::polygon", grid.len(), |row| {
        corners.values[grid.operands(row)[0]]
            .as_flattened()
            .to_vec()
    });
    Ok(PyRigidBody::with_uncertainty(bodies, uncertainties).with_shapes(figures))
}

/// Simple polygon in the x-y plane, where its corners are.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (..., n, 2)
///     x, y of the corners along the boundary, either way round; the last joins the first. Edges must not
///     cross; a hole is cut out by subtracting another polygon.
/// mass, density : array_like, shape (...)
///     Exactly one of the two; the density is mass per area.
///
/// Returns
/// -------
/// RigidBody
///
/// Raises
/// ------
/// PolhodeError
///     Naming the edges that cross.
///
/// Examples
/// --------
/// An L:
///
/// >>> from polhode import laminae
/// >>> corners = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
/// >>> laminae.polygon(corners, density=2.0).center_of_mass
/// array([1.1, 1.1, 0. ])
#[pyfunction]
#[pyo3(signature = (vertices, *, mass=None, density=None))]
pub(crate) fn polygon(
    vertices: &Bound<'_, PyAny>,
    mass: Optional<'_, '_>,
    density: Optional<'_, '_>,
) -> PyResult<PyRigidBody> {
    let py = vertices.py();
    let corners: Quantity<[f64; 2]> = quantity_list(vertices, "vertices", "..., n")?;
    let [shape @ .., n] = &corners.values.shape[..] else {
        return Err(PyValueError::new_err(
            "vertices: expected a list of corners",
        ));
    };
    let (n, amounts) = (*n, Amounts::read((mass, density))?);
    let shapes = [shape, &amounts.values.shape];
    let grid = Broadcast::of(["vertices", "mass or density"], shapes)?;
    let bodies = grid.try_map_watched(py, |[v, a], watch| {
        laminae::polygon(
            &corners.values.rows[v * n..(v + 1) * n],
            amounts.values[a],
            watch,
        )
    })?;
    let is_uncertain = corners.is_uncertain() || amounts.given.is_uncertain();
    let uncertainties = propagate_rows(py, &grid, is_uncertain, |[v, a]| {
        let numbers = (v * n..(v + 1) * n)
            .flat_map(|row| corners.row(row))
            .collect();
        amounts.doubt_of_polygon(a, numbers)
    })?;
    let is_alone = grid.shape.is_empty();
    let outline = is_alone
        .then(|| Outline::of_points("laminae::polygon", &corners.values.rows))
        .flatten();
    Ok(PyRigidBody::with_uncertainty(bodies, uncertainties).with_shapes(alone(outline)))
}
