//! Bodies from meshes, surfaces and curves.

use std::sync::Arc;

use numpy::{PyArrayDyn, PyArrayMethods};
use polhode::mass::polyhedron::{Index, Options, closure, outward, polyhedron_watched};
use polhode::mass::ten::Ten;
use polhode::mass::{Amount, curve, surface, thick_shell};
use polhode::parallel::Watch;
use polhode::uncertainty::of_mesh;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{read_list, read_scalar};
use crate::body::PyRigidBody;
use crate::errors::to_py;
use crate::figure::{MOST_FACES, Outline, alone};
use crate::interrupt::Interrupt;
use crate::meshes::{finish, read_mesh, with_mesh};
use crate::shapes::amount;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{Weight, value_of};

/// How the surface of a solid came from the mesh that was given.
enum Closed {
    AsGiven,
    ByCaps,
    /// By the faces of its hull instead.
    ByHull(Vec<[i64; 3]>),
}

impl Closed {
    /// The surface that was summed, if its faces are not too many.
    fn outline<I: Index + TryInto<u32>>(
        &self,
        vertices: &[[f64; 3]],
        faces: &[[I; 3]],
        orient: bool,
    ) -> Option<Outline> {
        if faces.len() > MOST_FACES {
            return None;
        }
        match self {
            Self::AsGiven if orient => {
                Outline::of_mesh("mesh", vertices, &outward(vertices, faces))
            }
            Self::AsGiven => Outline::of_mesh("mesh", vertices, faces),
            Self::ByHull(hull) => Outline::of_mesh("mesh", vertices, &outward(vertices, hull)),
            Self::ByCaps => {
                let (vertices, faces) = closure::with_caps(vertices, faces).ok()?;
                Outline::of_mesh("mesh", &vertices, &outward(&vertices, &faces))
            }
        }
    }
}

#[pymethods]
impl PyRigidBody {
    /// Solid of uniform density bounded by a closed triangle mesh.
    ///
    /// The mesh is checked before anything is computed: indices are in range, coordinates are finite, every
    /// edge is shared by two faces that run along it in opposite directions, no face is there twice, normals
    /// point outward, and the volume is larger than its rounding error. Corners with the same coordinates
    /// count as one vertex.
    ///
    /// The mesh may have several components and cavities. A cavity is a component that is wound inward and
    /// lies inside another one; a component that is wound inward elsewhere is an error. A large distance from
    /// the origin costs no accuracy, and the smallest moment of a thin shape is accurate too.
    ///
    /// Parameters
    /// ----------
    /// vertices : array_like, shape (n, 3)
    /// faces : array_like of int, shape (m, 3)
    ///     Vertices of each triangle, counted from zero, counter-clockwise seen from outside.
    /// density, mass : float
    ///     Exactly one of the two.
    /// closure : {"caps", "hull"}, optional
    ///     How to close an open mesh, which is an error by default. ``"caps"`` closes each hole by triangles
    ///     from its edges to the mean of their ends; a flat hole gets a flat cap. ``"hull"`` takes the convex
    ///     hull of the mesh (needs SciPy). `provenance` tells by how much the volume changed.
    /// orient : bool, optional
    ///     Whether to turn a mesh whose normals all point inward, and components that are inside out.
    /// check : bool, optional
    ///     False skips the checks that the mesh is closed, consistently wound and without duplicate faces.
    ///     The numbers of an open mesh then mean nothing. `provenance` says "unchecked".
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     Naming the face, edge or vertex that keeps the mesh from bounding a solid.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    /// >>> faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    /// >>> RigidBody.from_mesh(corners, faces, density=6.0).center_of_mass
    /// array([0.25, 0.25, 0.25])
    /// >>> RigidBody.from_mesh(corners, faces[:3], density=6.0)
    /// Traceback (most recent call last):
    ///     ...
    /// polhode.errors.MeshError: the mesh is not closed: the edge from vertex 2 to vertex 1 of faces[0] has no face on its other side (3 such edges in all); close the mesh (closure="caps" or "hull"), or model a thin shell instead
    /// >>> RigidBody.from_mesh(corners, faces[:3], density=6.0, closure="caps").mass
    /// 1.0
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, *, density=None, mass=None, closure=None, orient=false, check=true))]
    #[expect(clippy::too_many_arguments, reason = "one for each of Python's")]
    fn from_mesh(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        density: Option<Weight>,
        mass: Option<Weight>,
        #[pyo3(from_py_with = read_scalar)] closure: Option<&str>,
        orient: bool,
        check: bool,
    ) -> PyResult<Self> {
        let amount = amount(number(mass.as_ref()), number(density.as_ref()))?;
        let (vertices, uncertain) = &value_of(vertices)?;
        if uncertain.is_some() && (closure.is_some() || orient) {
            return Err(PyTypeError::new_err(
                "vertices: those with a sigma must be of a closed mesh with its faces wound outward; close and orient it first",
            ));
        }
        let mesh = read_mesh(vertices, faces)?;
        let options = Options { orient, check };
        let interrupt = Interrupt::new(None);
        let watch = &mut |_| interrupt.poll(None);
        let mut closed_by = Closed::AsGiven;
        let outcome = match closure {
            None => with_mesh!(mesh, |vertices, faces| {
                py.detach(|| polyhedron_watched(vertices, faces, amount, options, watch))
            }),
            Some("caps") => {
                closed_by = Closed::ByCaps;
                with_mesh!(mesh, |vertices, faces| {
                    py.detach(|| closure::capped(vertices, faces, amount, options, watch))
                })
            }
            Some("hull") => {
                let hull = py
                    .import("polhode.io.hull")?
                    .call_method1("hull", (vertices, faces))?
                    .cast_into::<PyArrayDyn<i64>>()?;
                let hull = hull.readonly();
                let hull = hull.as_slice()?.as_chunks::<3>().0;
                closed_by = Closed::ByHull(hull.to_vec());
                with_mesh!(mesh, |vertices, faces| {
                    py.detach(|| closure::hulled(vertices, faces, hull, amount, watch))
                })
            }
            Some(other) => {
                return Err(PyValueError::new_err(format!(
                    "closure: expected None, \"caps\" or \"hull\", got \"{other}\""
                )));
            }
        };
        let body = finish(py, interrupt, outcome)?;
        let mut doubts = None;
        if let Some(uncertain) = uncertain {
            let (solid, forms) = (Ten::of(&body), uncertain.get().forms());
            let is_of_mass = mass.is_some();
            let interrupt = Interrupt::new(None);
            let watch = &mut |_| interrupt.poll(None);
            let found = with_mesh!(mesh, |vertices, faces| {
                py.detach(|| of_mesh(&solid, vertices, faces, forms, is_of_mass, watch))
            });
            interrupt.finish(py, found.is_ok())?;
            let doubt = found.map_err(|error| to_py(py, &error))?;
            doubts = Some(Arc::new(vec![doubt]));
        }
        let outline = with_mesh!(mesh, |vertices, faces| {
            py.detach(|| closed_by.outline(vertices, faces, orient))
        });
        Self::doubtful(Stack::one(body), doubts)
            .looking(alone(outline))
            .weighed([density, mass, None])
    }

    /// Shell along an open or closed triangle mesh, thin or of finite thickness.
    ///
    /// A thin shell has a uniform mass per area, and its faces may be wound in any sense.
    ///
    /// With `thickness` the shell is a solid: it lies between two offset surfaces, at half the thickness on
    /// each side of the mesh, and has walls along an open rim. Faces must then be wound consistently, and at
    /// most two faces may share an edge. If at most three planes meet at a vertex, the offset faces are
    /// exactly at half the thickness. At other vertices the distances are met as well as possible, with the
    /// angles of the faces there as weights; for the mesh of a curved surface the error is of second order in
    /// the size of the triangles.
    ///
    /// A shell that folds over itself at a face is an error. Distant parts of a shell that overlap are not
    /// detected, and the overlap counts twice.
    ///
    /// Parameters
    /// ----------
    /// vertices : array_like, shape (n, 3)
    /// faces : array_like of int, shape (m, 3)
    ///     Vertices of each triangle, counted from zero.
    /// areal_density, density, mass : float
    ///     Mass per area of a thin shell, mass per volume of a shell with `thickness`, or the total mass:
    ///     exactly one of them.
    /// thickness : float, optional
    ///     Thickness from face to face; without it the shell is thin.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     For a bad face or vertex, or a mesh without area. Where the shell folds over itself, the message
    ///     names the face and the largest possible thickness.
    ///
    /// Examples
    /// --------
    /// A sheet in the x-y plane, thin and as a plate:
    ///
    /// >>> from polhode import RigidBody
    /// >>> corners = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
    /// >>> sheet = RigidBody.from_surface(corners, [(0, 1, 2), (0, 2, 3)], areal_density=6.0)
    /// >>> sheet.mass, sheet.principal_moments
    /// (12.0, array([ 1.,  4.,  5.]))
    /// >>> plate = RigidBody.from_surface(corners, [(0, 1, 2), (0, 2, 3)], density=6.0, thickness=1.0)
    /// >>> plate.mass, plate.principal_moments
    /// (12.0, array([ 2.,  5.,  5.]))
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, *, areal_density=None, density=None, mass=None, thickness=None))]
    fn from_surface(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        areal_density: Option<Weight>,
        density: Option<Weight>,
        mass: Option<Weight>,
        #[pyo3(from_py_with = read_scalar)] thickness: Option<f64>,
    ) -> PyResult<Self> {
        let [own, per_area, per_volume] =
            [&mass, &areal_density, &density].map(|weight| number(weight.as_ref()));
        let amount = match (thickness, per_area, per_volume) {
            (None, _, None) => amount_per("areal_density", own, per_area)?,
            (None, _, Some(_)) => {
                return Err(PyTypeError::new_err(
                    "density= needs thickness=: a thin shell has a mass= or an areal_density=",
                ));
            }
            (Some(_), None, _) => amount(own, per_volume)?,
            (Some(_), Some(_), _) => {
                return Err(PyTypeError::new_err(
                    "areal_density= is of a thin shell: with thickness= give mass= or density=",
                ));
            }
        };
        let mesh = read_mesh(vertices, faces)?;
        let interrupt = Interrupt::new(None);
        let watch = &mut |_| interrupt.poll(None);
        let outcome = with_mesh!(mesh, |vertices, faces| {
            py.detach(|| match thickness {
                None => surface::surface(vertices, faces, amount, watch),
                Some(t) => thick_shell::thick_shell(vertices, faces, t, amount, watch),
            })
        });
        let outline = with_mesh!(mesh, |vertices, faces| {
            Outline::of_mesh("surface", vertices, faces)
        });
        let body = Self::from(Stack::one(finish(py, interrupt, outcome)?)).looking(alone(outline));
        body.weighed([areal_density, density, mass])
    }

    /// Thin wire of uniform mass per length, made of straight segments.
    ///
    /// Parameters
    /// ----------
    /// points : array_like, shape (..., n, 3)
    ///     Ends of the segments in order, two or more; a closed wire ends at its first point.
    /// linear_density, mass : float
    ///     Mass per length, or the total mass: exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     When a coordinate is not finite, or the wire has no length.
    ///
    /// Examples
    /// --------
    /// A square of wire:
    ///
    /// >>> from polhode import RigidBody
    /// >>> corners = [(1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0), (1, 1, 0)]
    /// >>> RigidBody.from_curve(corners, mass=3.0).principal_moments
    /// array([2., 2., 4.])
    #[staticmethod]
    #[pyo3(signature = (points, *, linear_density=None, mass=None))]
    fn from_curve(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        linear_density: Option<Weight>,
        mass: Option<Weight>,
    ) -> PyResult<Self> {
        let amount = amount_per(
            "linear_density",
            number(mass.as_ref()),
            number(linear_density.as_ref()),
        )?;
        let points: Stack<[f64; 3]> = read_list(points, "points", "..., n")?;
        let [shape @ .., n] = &points.shape[..] else {
            return Err(PyValueError::new_err("points: expected a list of points"));
        };
        let grid = Broadcast::of(["points"], [shape])?;
        let body = |[row]: [usize; 1], watch: &mut Watch<'_>| {
            curve::curve(&points.rows[row * n..(row + 1) * n], amount, watch)
        };
        let bodies = grid.try_map_watched(py, body)?;
        let outline = (shape.is_empty())
            .then(|| Outline::of_points("wire", &points.rows))
            .flatten();
        Self::from(bodies)
            .looking(alone(outline))
            .weighed([linear_density, mass, None])
    }
}

/// The value of an amount.
fn number(weight: Option<&Weight>) -> Option<f64> {
    weight.map(|weight| weight.value)
}

/// Exactly one of the mass in all and a mass per length or area, under its own name.
fn amount_per(name: &str, mass: Option<f64>, density: Option<f64>) -> PyResult<Amount> {
    if let Some(value) = density
        && mass.is_none()
        && !(value > 0.0 && value.is_finite())
    {
        return Err(PyValueError::new_err(format!(
            "{name} must be positive and finite, got {value:?}"
        )));
    }
    amount(mass, density)
        .map_err(|_| PyTypeError::new_err(format!("give exactly one of mass= and {name}=")))
}
