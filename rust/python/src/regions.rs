//! Regions of space that a density is integrated over.

use nalgebra::Vector3;
use polhode::Error;
use polhode::mass::regions::Region;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Argument, Item, read, read_or, read_scalar};
use crate::errors::to_py;
use crate::interrupt::watched;
use crate::meshes::{read_mesh, with_mesh};
use crate::shape::tuple;
use crate::stack::Stack;

/// A region of space: where there is matter. Made by the functions of :mod:`polhode.regions`.
#[pyclass(name = "Region", module = "polhode.regions", frozen)]
pub(crate) struct PyRegion {
    pub(crate) region: Region,
    made_by: String,
}

#[pymethods]
impl PyRegion {
    fn __repr__(&self) -> &str {
        &self.made_by
    }
}

/// Box with its faces normal to the axes.
///
/// Parameters
/// ----------
/// low, high : array_like, shape (3,)
///     Two opposite corners, low below high along each axis.
///
/// Returns
/// -------
/// Region
///
/// Examples
/// --------
/// >>> from polhode import regions
/// >>> regions.box((0, 0, 0), (1, 2, 3))
/// regions.box(low=[0.0, 0.0, 0.0], high=[1.0, 2.0, 3.0])
#[pyfunction]
#[pyo3(name = "region_box")]
pub(crate) fn cuboid(low: &Bound<'_, PyAny>, high: &Bound<'_, PyAny>) -> PyResult<PyRegion> {
    let py = low.py();
    let (low, high): ([f64; 3], [f64; 3]) = (
        single(read(low, "low")?, "low")?,
        single(read(high, "high")?, "high")?,
    );
    make_region(
        py,
        Region::cuboid(&low.into(), &high.into()),
        format!("regions.box(low={low:?}, high={high:?})"),
    )
}

/// Ball, hollow when it has an inner radius.
///
/// Parameters
/// ----------
/// radius : float
/// center : array_like, shape (3,), optional
///     The origin by default.
/// inner_radius : float, optional
///     Radius of a concentric cavity.
///
/// Returns
/// -------
/// Region
///
/// Examples
/// --------
/// >>> from polhode import regions
/// >>> regions.ball(radius=2.0, inner_radius=1.0)
/// regions.ball(radius=2.0, center=[0.0, 0.0, 0.0], inner_radius=1.0)
#[pyfunction]
#[pyo3(
    name = "region_ball",
    signature = (radius, center=Argument::default(), *, inner_radius=0.0),
    text_signature = "(radius, center=(0.0, 0.0, 0.0), *, inner_radius=0.0)"
)]
pub(crate) fn ball(
    py: Python<'_>,
    #[pyo3(from_py_with = read_scalar)] radius: f64,
    center: Argument<'_>,
    #[pyo3(from_py_with = read_scalar)] inner_radius: f64,
) -> PyResult<PyRegion> {
    let center: [f64; 3] = single(read_or(&center, "center", [0.0; 3])?, "center")?;
    make_region(
        py,
        Region::ball(radius, &center.into(), inner_radius),
        format!(
            "regions.ball(radius={radius:?}, center={center:?}, inner_radius={inner_radius:?})"
        ),
    )
}

/// Ellipsoid with its axes along x, y, z.
///
/// Parameters
/// ----------
/// semi_axes : array_like, shape (3,)
/// center : array_like, shape (3,), optional
///     The origin by default.
///
/// Returns
/// -------
/// Region
///
/// Examples
/// --------
/// >>> from polhode import regions
/// >>> regions.ellipsoid((1, 2, 3))
/// regions.ellipsoid(semi_axes=[1.0, 2.0, 3.0], center=[0.0, 0.0, 0.0])
#[pyfunction]
#[pyo3(
    name = "region_ellipsoid",
    signature = (semi_axes, center=Argument::default()),
    text_signature = "(semi_axes, center=(0.0, 0.0, 0.0))"
)]
pub(crate) fn ellipsoid(semi_axes: &Bound<'_, PyAny>, center: Argument<'_>) -> PyResult<PyRegion> {
    let py = semi_axes.py();
    let semi_axes: [f64; 3] = single(read(semi_axes, "semi_axes")?, "semi_axes")?;
    let center: [f64; 3] = single(read_or(&center, "center", [0.0; 3])?, "center")?;
    make_region(
        py,
        Region::ellipsoid(&semi_axes.into(), &center.into()),
        format!("regions.ellipsoid(semi_axes={semi_axes:?}, center={center:?})"),
    )
}

/// Cylinder along z, hollow when it has an inner radius.
///
/// Parameters
/// ----------
/// radius, height : float
///     Its radius and its full height.
/// center : array_like, shape (3,), optional
///     The middle of its axis; the origin by default.
/// inner_radius : float, optional
///     Radius of a hole along the axis.
///
/// Returns
/// -------
/// Region
///
/// Examples
/// --------
/// >>> from polhode import regions
/// >>> regions.cylinder(radius=2.0, height=3.0)
/// regions.cylinder(radius=2.0, height=3.0, center=[0.0, 0.0, 0.0], inner_radius=0.0)
#[pyfunction]
#[pyo3(
    name = "region_cylinder",
    signature = (radius, height, center=Argument::default(), *, inner_radius=0.0),
    text_signature = "(radius, height, center=(0.0, 0.0, 0.0), *, inner_radius=0.0)"
)]
pub(crate) fn cylinder(
    py: Python<'_>,
    #[pyo3(from_py_with = read_scalar)] radius: f64,
    #[pyo3(from_py_with = read_scalar)] height: f64,
    center: Argument<'_>,
    #[pyo3(from_py_with = read_scalar)] inner_radius: f64,
) -> PyResult<PyRegion> {
    let center: [f64; 3] = single(read_or(&center, "center", [0.0; 3])?, "center")?;
    make_region(
        py,
        Region::cylinder(radius, height, &Vector3::from(center), inner_radius),
        format!(
            "regions.cylinder(radius={radius:?}, height={height:?}, center={center:?}, inner_radius={inner_radius:?})"
        ),
    )
}

/// InternalMomentum of a closed triangle mesh.
///
/// If the mesh is not star-shaped about its centroid, the density is also evaluated at points outside the
/// mesh, whose contributions cancel. Each face takes 343 evaluations or more.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
/// faces : array_like of int, shape (m, 3)
///     Vertices of each triangle, counted from zero, counter-clockwise seen from outside.
///
/// Returns
/// -------
/// Region
///
/// Raises
/// ------
/// MeshError
///     Naming the face, edge or vertex that keeps the mesh from bounding a solid.
///
/// Examples
/// --------
/// >>> from polhode import RigidBody, regions
/// >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
/// >>> inside = regions.mesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
/// >>> round(RigidBody.from_density(lambda r: r[:, 0], inside).mass, 12) == round(1 / 24, 12)
/// True
#[pyfunction]
#[pyo3(name = "region_mesh")]
pub(crate) fn mesh(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<PyRegion> {
    let py = vertices.py();
    let mesh = read_mesh(vertices, faces)?;
    with_mesh!(mesh, |vertices, faces| {
        let told = format!("<Region inside a mesh of {} faces>", faces.len());
        let region = watched(py, |watch| Region::mesh(vertices, faces, watch))?;
        make_region(py, region, told)
    })
}

fn make_region(
    py: Python<'_>,
    region: Result<Region, Error>,
    made_by: String,
) -> PyResult<PyRegion> {
    let region = region.map_err(|error| to_py(py, &error))?;
    Ok(PyRegion { region, made_by })
}

/// The one item where there must be no stack.
fn single<T: Item + Copy>(stack: Stack<T>, name: &str) -> PyResult<T> {
    if stack.is_one() {
        return Ok(stack[0]);
    }
    let tail: Vec<String> = T::TAIL.iter().map(usize::to_string).collect();
    Err(PyValueError::new_err(format!(
        "{name}: expected shape ({},), got {}",
        tail.join(", "),
        tuple(&[&stack.shape[..], T::TAIL].concat())
    )))
}
