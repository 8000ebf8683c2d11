//! Ways to a body.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use polhode::error::{BodyFault, CellFault};
use polhode::mass::density::{Effort, Estimate, from_density, from_radial_density};
use polhode::mass::inertial_parameters::InertialParameters;
use polhode::mass::particles::{
    label_ranks, labelled_particles, particle_stack, particles_watched,
};
use polhode::mass::polyhedron::{Index, MeshSolid, Options, closure, polyhedron_watched};
use polhode::mass::regions::Region;
use polhode::mass::tetrahedra::{CellDensity, tetrahedra};
use polhode::mass::{Amount, balls, curve, surface, thick_shell};
use polhode::parallel::{self, Watch};
use polhode::uncertainty::{
    FromPrincipal, FromTensor, FromTensorAboutOrigin, of_mesh, of_particles,
};
use polhode::{Error, RigidBody};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Argument, Item, floats, read, read_indices, read_list, read_scalar, write};
use crate::attitudes::read_rotation;
use crate::body::PyRigidBody;
use crate::depth::RecursionGuard;
use crate::errors::{at_label, at_row, to_py};
use crate::figure::{MOST_FACES, MOST_POINTS, Outline, alone};
use crate::hints::{no_faces, refuse_unknown};
use crate::interrupt::{Beat, Interrupt, watched};
use crate::lazy_arrays::{handed_over, is_any};
use crate::memory;
use crate::meshes::{finish, read_mesh, with_mesh};
use crate::particles::{ParticleArrays, read_labels};
use crate::regions::PyRegion;
use crate::shape::tuple;
use crate::shapes::amount;
use crate::stack::{BLOCK, Broadcast, Stack, extend};
use crate::uncertain::{
    Quantity, Weight, holds_uncertain, is_uncertain, of_numbers, propagate_rows, quantity,
    quantity_list, quantity_or, symmetric, value_of,
};
use crate::voxels::{Frame, of_voxels};

/// An optional argument of any array-like kind.
type Optional<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// A constructor of the core: mass, tensor, centre of mass, rtol.
type Constructor = fn(f64, &Matrix3<f64>, &Vector3<f64>, f64) -> Result<RigidBody, Error>;

#[pymethods]
impl PyRigidBody {
    #[new]
    #[pyo3(
        signature = (mass, inertia=None, center_of_mass=Argument::default(), *, inertia_about_origin=None, rtol=None, **unknown),
        text_signature = "(mass, inertia=None, center_of_mass=(0.0, 0.0, 0.0), *, inertia_about_origin=None, rtol=None)"
    )]
    fn new(
        py: Python<'_>,
        mass: &Bound<'_, PyAny>,
        inertia: Optional<'_, '_>,
        center_of_mass: Argument<'_>,
        inertia_about_origin: Optional<'_, '_>,
        #[pyo3(from_py_with = read_scalar)] rtol: Option<f64>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let known = [
            "mass",
            "inertia",
            "center_of_mass",
            "inertia_about_origin",
            "rtol",
        ];
        refuse_unknown("RigidBody", &known, unknown)?;
        let (name, tensor, from): (_, _, Constructor) = match (inertia, inertia_about_origin) {
            (Some(tensor), None) => ("inertia", tensor, RigidBody::new),
            (None, Some(tensor)) => (
                "inertia_about_origin",
                tensor,
                RigidBody::from_inertia_about_origin,
            ),
            _ => {
                let message = "give exactly one of inertia= (about the centre of mass) and inertia_about_origin=";
                return Err(PyTypeError::new_err(message));
            }
        };
        let mass: Quantity<f64> = quantity(mass, "mass")?;
        let tensor: Quantity<Matrix3<f64>> = quantity(tensor, name)?;
        let center = quantity_or(&center_of_mass, "center_of_mass", Vector3::zeros())?;
        let grid = Broadcast::of(
            ["mass", name, "center_of_mass"],
            [
                &mass.values.shape,
                &tensor.values.shape,
                &center.values.shape,
            ],
        )?;
        let rtol = rtol.unwrap_or(0.0);
        let bodies = grid.try_map(py, |[m, i, c]| {
            from(mass.values[m], &tensor.values[i], &center.values[c], rtol)
        })?;
        let is_uncertain = mass.is_uncertain() || tensor.is_uncertain() || center.is_uncertain();
        let uncertainties = propagate_rows(py, &grid, is_uncertain, |[m, i, c]| {
            let numbers = [
                &mass.row(m)[..],
                &center.row(c),
                &symmetric(name, &tensor, i)?,
            ]
            .concat();
            if name == "inertia" {
                of_numbers(&FromTensor, &numbers)
            } else {
                of_numbers(&FromTensorAboutOrigin, &numbers)
            }
        })?;
        Self::with_uncertainty(bodies, uncertainties).possible(py)
    }

    /// Body with given principal moments about C.
    ///
    /// The body stores the moments exactly as given. A tensor in turned axes could not, because of rounding.
    ///
    /// Parameters
    /// ----------
    /// mass : array_like, shape (...)
    /// moments : array_like, shape (..., 3)
    ///     Principal moments, in any order.
    /// axes : array_like, shape (..., 3, 3), or rotation, optional
    ///     Principal axes in the body frame, in the order of `moments`: a right-handed rotation matrix with
    ///     the axes as columns, quaternions (..., 4) as (x, y, z, w), or anything with ``as_quat()``. The
    ///     body axes by default.
    /// center_of_mass : array_like, shape (..., 3), optional
    /// rtol : float, optional
    ///     Tolerance: violations of the triangle inequality up to this fraction are accepted.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     When no distribution of mass has these moments.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> top = RigidBody.from_principal(mass=1.0, moments=(2.0, 2.0, 3.0))
    /// >>> top.principal.top
    /// 'oblate'
    #[staticmethod]
    #[pyo3(
        signature = (mass, moments, axes=None, center_of_mass=Argument::default(), *, rtol=None, **unknown),
        text_signature = "(mass, moments, axes=None, center_of_mass=(0.0, 0.0, 0.0), *, rtol=None)"
    )]
    fn from_principal(
        py: Python<'_>,
        mass: &Bound<'_, PyAny>,
        moments: &Bound<'_, PyAny>,
        axes: Optional<'_, '_>,
        center_of_mass: Argument<'_>,
        #[pyo3(from_py_with = read_scalar)] rtol: Option<f64>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let known = ["mass", "moments", "axes", "center_of_mass", "rtol"];
        refuse_unknown("RigidBody.from_principal", &known, unknown)?;
        let mass: Quantity<f64> = quantity(mass, "mass")?;
        let moments: Quantity<[f64; 3]> = quantity(moments, "moments")?;
        let axes = match axes {
            Some(axes) => read_rotation(axes, "axes")?,
            None => Stack::one(Matrix3::identity()),
        };
        let center = quantity_or(&center_of_mass, "center_of_mass", Vector3::zeros())?;
        let names = ["mass", "moments", "axes", "center_of_mass"];
        let (m, i, c) = (&mass.values, &moments.values, &center.values);
        let grid = Broadcast::of(names, [&m.shape, &i.shape, &axes.shape, &c.shape])?;
        let rtol = rtol.unwrap_or(0.0);
        let bodies = grid.try_map(py, |rows: [usize; 4]| {
            let [mass, moments, turn, center] = rows;
            RigidBody::from_principal(m[mass], &i[moments], &axes[turn], &c[center], rtol)
        })?;
        let is_uncertain = mass.is_uncertain() || moments.is_uncertain() || center.is_uncertain();
        let uncertainties = propagate_rows(py, &grid, is_uncertain, |[m, i, v, c]| {
            let numbers = [mass.row(m), center.row(c), moments.row(i)].concat();
            of_numbers(&FromPrincipal(axes[v]), &numbers)
        })?;
        Self::with_uncertainty(bodies, uncertainties).possible(py)
    }

    /// Body from any file that holds one: a mesh (STL, OBJ, PLY, OFF, DAE, 3MF, glTF, GLB, VTK, plate models), solids of CAD
    /// (STEP, IGES), a molecule (XYZ, PDB, MOL, SDF), each also packed with gzip; an image of voxels (NIfTI, NRRD, NumPy's npy);
    /// a body that `save` wrote (JSON, npz), with every bit of it; a report of the command line (JSON); an assembly (TOML). An
    /// argument that the file cannot use is refused.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// density, mass : float
    ///     For a mesh exactly one of the two. For components of several densities a mapping of their names, or of
    ///     their numbers counted from 1, to densities, where ``"*"`` stands for all others. For an image `density` is a
    ///     factor of its values, a mapping of values to densities or a function of the values; see
    ///     :func:`polhode.images.body_of_image`. For a molecule neither, since its atoms have masses. CAD solids whose
    ///     materials have densities need neither.
    /// length_unit : str, optional
    ///     Unit of the coordinates, such as ``"mm"``. They are converted to metres, and the masses of a
    ///     molecule to kilograms. Without it, coordinates are converted to metres if the file or its format
    ///     states their unit (STEP, IGES, DAE, 3MF, glTF, GLB). All others stay as they are, and a molecule is
    ///     in u and angstrom. A saved body keeps the unit it was saved in. A unit that differs from the one in the
    ///     file is an error.
    /// thickness : float, optional
    ///     Thickness of a sheet, in the unit of the result: the mesh, open or closed, is then the middle of a shell, as
    ///     `from_surface` has it, and not the surface of a solid.
    /// weld : float, optional
    ///     Corners at most this far from each other, in the unit of the file, are joined; by default only
    ///     equal corners. Some exporters write the same corner with different last digits in each triangle,
    ///     so that the mesh is open.
    /// closure, orient
    ///     As of `from_mesh`, for a mesh that is open or wound inward.
    /// union : bool, optional
    ///     Whether to join overlapping components of a mesh, so that the common volume counts once; by
    ///     manifold3d (extra ``union``). The join moves corners by about 1e-12 of the size of the mesh. No
    ///     error bound includes this.
    /// repair : bool, optional
    ///     Whether to mend a mesh where there is need: weld corners, drop duplicate faces, turn faces so that
    ///     all are wound alike, fill holes. `provenance` then says "repaired";
    ///     :func:`polhode.io.solid_from_file` tells what was done.
    /// index_base : {1, 0}, optional
    ///     Number of the first vertex in an OBJ or plate file, to which its faces refer.
    /// masses : {"most_common", "average"}, optional
    ///     Masses of those atoms of a molecule whose label names no isotope: that of the most common isotope
    ///     of the element, or the average over its isotopes.
    /// progress : callable, optional
    ///     A function that is called now and then with the fraction of a large mesh file that has been read.
    ///     An exception that it raises ends the reading. Binary STL and binary PLY are read block by block, so
    ///     that a file may be larger than the memory.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     When solids of a CAD file or parts of an assembly overlap, or bonds or fragments of a molecule cross a side of the cell in its
    ///     file; see :func:`polhode.molecules.cell_crossings`.
    ///
    /// Raises
    /// ------
    /// FileFormatError
    ///     When the content of the file does not fit its name, or is damaged.
    /// MeshError
    ///     When the mesh does not bound a solid.
    ///
    /// See Also
    /// --------
    /// polhode.io : the readers, which also return vertices and faces.
    #[staticmethod]
    #[pyo3(
        signature = (path, *, density=None, mass=None, length_unit=None, thickness=None, weld=0.0, closure=None, orient=false, union=false, repair=false, index_base=1, masses="most_common", progress=None, **unknown),
        text_signature = "(path, *, density=None, mass=None, length_unit=None, thickness=None, weld=0.0, closure=None, orient=False, union=False, repair=False, index_base=1, masses=\"most_common\", progress=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "one for each of Python's")]
    fn from_file<'py>(
        py: Python<'py>,
        path: &Bound<'py, PyAny>,
        density: Option<&Bound<'py, PyAny>>,
        mass: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = read_scalar)] length_unit: Option<&str>,
        #[pyo3(from_py_with = read_scalar)] thickness: Option<f64>,
        #[pyo3(from_py_with = read_scalar)] weld: f64,
        #[pyo3(from_py_with = read_scalar)] closure: Option<&str>,
        orient: bool,
        union: bool,
        repair: bool,
        #[pyo3(from_py_with = read_scalar)] index_base: i64,
        #[pyo3(from_py_with = read_scalar)] masses: &str,
        progress: Option<Bound<'py, PyAny>>,
        unknown: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let known = [
            "path",
            "density",
            "mass",
            "length_unit",
            "thickness",
            "weld",
            "closure",
            "orient",
            "union",
            "repair",
            "index_base",
            "masses",
            "progress",
        ];
        refuse_unknown("RigidBody.from_file", &known, unknown)?;
        let options = PyDict::new(py);
        options.set_item("density", density)?;
        options.set_item("mass", mass)?;
        options.set_item("length_unit", length_unit)?;
        options.set_item("thickness", thickness)?;
        options.set_item("weld", weld)?;
        options.set_item("closure", closure)?;
        options.set_item("orient", orient)?;
        options.set_item("union", union)?;
        options.set_item("repair", repair)?;
        options.set_item("index_base", index_base)?;
        options.set_item("masses", masses)?;
        options.set_item("progress", progress)?;
        py.import("polhode.io.read")?
            .call_method("body_from_file", (path,), Some(&options))
    }

    /// Stack of bodies of equal shape along a new first axis.
    ///
    /// Parameters
    /// ----------
    /// bodies : iterable of RigidBody
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody, solids
    /// >>> RigidBody.stack([solids.sphere(1.0, mass=m) for m in (1.0, 2.0)]).mass
    /// array([1., 2.])
    #[staticmethod]
    fn stack(bodies: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = bodies.py();
        let mut beat = Beat::new(py);
        let bodies = bodies
            .try_iter()?
            .enumerate()
            .map(|(row, body)| {
                if row % BLOCK == 0 {
                    beat.mark()?;
                }
                Ok(body?.cast_into::<Self>()?)
            })
            .collect::<PyResult<Vec<_>>>()?;
        let Some(first) = bodies.first() else {
            return Err(PyValueError::new_err(
                "bodies: expected at least one body to stack, got none",
            ));
        };
        let shape = &first.get().bodies.shape;
        if let Some(other) = bodies.iter().find(|body| body.get().bodies.shape != *shape) {
            return Err(PyValueError::new_err(format!(
                "bodies: expected bodies of one shape, got {} and {}",
                tuple(shape),
                tuple(&other.get().bodies.shape)
            )));
        }
        let shape = [&[bodies.len()], &shape[..]].concat();
        let mut rows = memory::vector("bodies", &shape, 0)?;
        for (row, body) in bodies.iter().enumerate() {
            if row % BLOCK == 0 {
                beat.mark()?;
            }
            extend(py, &mut rows, &body.get().bodies.rows, |body| *body)?;
        }
        let is_uncertain = bodies.iter().any(|body| body.get().uncertainties.is_some());
        let uncertainties = is_uncertain.then(|| {
            let of = |body: &Bound<'_, Self>| {
                let body = body.get();
                (0..body.bodies.rows.len())
                    .map(|row| body.row(row).1.clone())
                    .collect::<Vec<_>>()
            };
            Arc::new(bodies.iter().flat_map(of).collect())
        });
        let figures = Self::stack_figures(bodies.iter().map(Bound::get));
        Ok(Self::with_uncertainty(Stack { shape, rows }, uncertainties).with_shapes(figures))
    }
}

// Bodies from meshes, surfaces and curves.

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
        solid: &MeshSolid,
    ) -> Option<Outline> {
        if faces.len() > MOST_FACES {
            return None;
        }
        match self {
            Self::AsGiven => Outline::of_mesh("mesh", vertices, &solid.outward(faces)),
            Self::ByHull(hull) => Outline::of_mesh("mesh", vertices, &solid.outward(hull)),
            Self::ByCaps => {
                let (vertices, faces) = closure::with_caps(vertices, faces).ok()?;
                Outline::of_mesh("mesh", &vertices, &solid.outward(&faces))
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
    #[pyo3(
        signature = (vertices, faces=None, *, density=None, mass=None, closure=None, orient=false, check=true),
        text_signature = "(vertices, faces, *, density=None, mass=None, closure=None, orient=False, check=True)"
    )]
    #[expect(clippy::too_many_arguments, reason = "one for each of Python's")]
    fn from_mesh(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        density: Option<Weight>,
        mass: Option<Weight>,
        #[pyo3(from_py_with = read_scalar)] closure: Option<&str>,
        orient: bool,
        check: bool,
    ) -> PyResult<Self> {
        Self::with_volume(py, vertices, faces, density, mass, closure, orient, check)
            .map(|(body, _)| body)
    }

    /// As `from_mesh`, and the volume that the mesh encloses.
    #[staticmethod]
    #[pyo3(
        name = "_from_mesh",
        signature = (vertices, faces=None, *, density=None, mass=None, closure=None, orient=false, check=true)
    )]
    #[expect(clippy::too_many_arguments, reason = "one for each of Python's")]
    fn with_volume(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        density: Option<Weight>,
        mass: Option<Weight>,
        #[pyo3(from_py_with = read_scalar)] closure: Option<&str>,
        orient: bool,
        check: bool,
    ) -> PyResult<(Self, f64)> {
        let faces = faces.ok_or_else(|| no_faces(vertices))?;
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
                    py.detach(|| closure::close_with_caps(vertices, faces, amount, options, watch))
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
                    py.detach(|| closure::close_with_hull(vertices, faces, hull, amount, watch))
                })
            }
            Some(other) => {
                return Err(PyValueError::new_err(format!(
                    "closure: expected None, \"caps\" or \"hull\", got \"{other}\""
                )));
            }
        };
        let solid = finish(py, interrupt, outcome)?;
        let mut uncertainties = None;
        if let Some(uncertain) = uncertain {
            let (body, forms) = (InertialParameters::of(&solid.body), uncertain.get().forms());
            let is_of_mass = mass.is_some();
            let interrupt = Interrupt::new(None);
            let watch = &mut |_| interrupt.poll(None);
            let found = with_mesh!(mesh, |vertices, faces| {
                py.detach(|| of_mesh(&body, vertices, faces, forms, is_of_mass, watch))
            });
            interrupt.finish(py, found.is_ok())?;
            let uncertainty = found.map_err(|error| to_py(py, &error))?;
            uncertainties = Some(Arc::new(vec![uncertainty]));
        }
        let outline = with_mesh!(mesh, |vertices, faces| {
            py.detach(|| closed_by.outline(vertices, faces, &solid))
        });
        let body = Self::with_uncertainty(Stack::one(solid.body), uncertainties)
            .with_shapes(alone(outline))
            .weigh([density, mass, None])?;
        Ok((body, solid.volume))
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
        let body =
            Self::from(Stack::one(finish(py, interrupt, outcome)?)).with_shapes(alone(outline));
        body.weigh([areal_density, density, mass])
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
            .with_shapes(alone(outline))
            .weigh([linear_density, mass, None])
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

// Bodies of particles and of voxels.

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
        Ok(stack(py, grid.shape, bodies)?.with_shapes(figures))
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
    ///     Every number up to the largest must have some mass.
    /// return_labels : bool, optional
    ///     If true, the labels may be any whole numbers, also with gaps; −1 is still a particle of no body.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///     A stack with one body for each label. Each has the same bits as `from_particles` gives for its
    ///     particles alone. With `return_labels` a pair: the labels, ascending, shape (k,), and the stack of
    ///     their bodies.
    ///
    /// See Also
    /// --------
    /// LabelledMassAccumulator : The same for particles in chunks.
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
    ///
    /// Labels with gaps:
    ///
    /// >>> names = [4, 1007, 4, 1007, -1]
    /// >>> labels, bodies = RigidBody.from_labelled_particles(
    /// ...     [1, 2, 3, 2, 7], positions, names, return_labels=True
    /// ... )
    /// >>> labels
    /// array([   4, 1007])
    #[staticmethod]
    #[pyo3(signature = (masses, positions, labels, *, return_labels=false))]
    fn from_labelled_particles<'py>(
        py: Python<'py>,
        masses: &Bound<'py, PyAny>,
        positions: &Bound<'py, PyAny>,
        labels: &Bound<'py, PyAny>,
        return_labels: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arrays = ParticleArrays::read(masses, positions, "n")?;
        let rows = arrays.rows()?;
        let labels = read_labels(labels, rows.masses.len())?;
        let labels = labels.as_slice()?;
        let ranked = return_labels.then(|| py.detach(|| label_ranks(labels)));
        let ranks = ranked.as_ref().map_or(labels, |(_, ranks)| ranks);
        let bodies = watched(py, |watch| {
            labelled_particles(rows.masses, rows.positions, ranks, watch)
        })?;
        let bodies = match bodies {
            Err((None, error)) => return Err(to_py(py, &error)),
            Err((Some(rank), error)) => {
                let label = match &ranked {
                    Some((names, _)) => names[rank],
                    None => i64::try_from(rank)?,
                };
                let way_out = way_out_of_label(&error);
                return Err(at_label(py, label, way_out, &to_py(py, &error)));
            }
            Ok(bodies) => stack(py, vec![bodies.len()], Ok(bodies))?,
        };
        match ranked {
            Some((names, _)) => (PyArray1::from_vec(py, names), bodies).into_bound_py_any(py),
            None => bodies.into_bound_py_any(py),
        }
    }

    /// Union of overlapping balls of uniform density: a clump of a granular simulation, a molecule of hard spheres, a
    /// bunch of grapes. What several balls cover counts once.
    ///
    /// The volume and the moments are exact: the union is cut into one part for each ball along the planes of the circles
    /// in which spheres meet, and each part is integrated in closed form. Balls inside others, equal balls and balls that
    /// touch are allowed.
    ///
    /// Parameters
    /// ----------
    /// centers : array_like, shape (n, 3)
    /// radii : float or array_like, shape (n,)
    ///     Radii of the balls, positive; one number for equal balls.
    /// density, mass : float
    ///     Mass per volume, or the total mass of the union: exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///     Its centre of mass is where it is in the frame of the centers.
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     Naming the ball whose radius is not positive.
    ///
    /// Examples
    /// --------
    /// Two unit balls at a distance of 1. A sum over the balls would have the mass 8.38 and count the lens between them
    /// twice:
    ///
    /// >>> from polhode import RigidBody
    /// >>> clump = RigidBody.from_balls([(0, 0, 0), (1, 0, 0)], [1.0, 1.0], density=1.0)
    /// >>> round(clump.mass, 8)
    /// 7.06858347
    /// >>> clump.principal_moments.round(8)
    /// array([3.00414797, 5.21308031, 5.21308031])
    #[staticmethod]
    #[pyo3(signature = (centers, radii, *, density=None, mass=None))]
    fn from_balls(
        py: Python<'_>,
        centers: &Bound<'_, PyAny>,
        radii: &Bound<'_, PyAny>,
        density: Option<Weight>,
        mass: Option<Weight>,
    ) -> PyResult<Self> {
        let amount = amount(number(mass.as_ref()), number(density.as_ref()))?;
        let centers: Stack<[f64; 3]> = read_list(centers, "centers", "n")?;
        let n = centers.rows.len();
        let radii: Stack<f64> = read(radii, "radii")?;
        let radii = match radii.shape[..] {
            [] => vec![radii[0]; n],
            [k] if k == n => radii.rows,
            _ => {
                return Err(PyValueError::new_err(format!(
                    "radii: expected one radius or shape ({n},), one for each ball, got {}",
                    tuple(&radii.shape)
                )));
            }
        };
        let body = watched(py, |watch| {
            balls::balls(&centers.rows, &radii, amount, watch)
        })?;
        let body = body.map_err(|error| to_py(py, &error))?;
        let numbers = || [&radii[..], centers.rows.as_flattened()].concat();
        let outline = (n <= MOST_POINTS).then(|| Outline::of("balls", numbers()));
        Self::from(Stack::one(body))
            .with_shapes(alone(outline))
            .weigh([density, mass, None])
    }

    /// Body given by its density on a grid, where each cell (voxel) is homogeneous: an image of a scanner, a simulation.
    ///
    /// The integrals are exact for such cells. They include the second moment ``m h²/12`` of each cell along
    /// each of its edges, which a sum over the centres would miss.
    ///
    /// Parameters
    /// ----------
    /// density : array_like, shape (..., nx, ny, nz)
    ///     Mass per volume, not negative. C-ordered float32 and float64 arrays are not copied; sums are taken in double
    ///     precision.
    /// spacing : float or array_like, shape (3,)
    ///     Edges of a cell; ``density[i, j, k]`` then runs along x, y, z.
    /// origin : array_like, shape (3,), optional
    ///     Centre of the cell ``density[0, 0, 0]``.
    /// affine : array_like, shape (4, 4)
    ///     Instead of `spacing` and `origin`: the matrix A that takes the indices of a cell to its centre,
    ///     ``x = A (i, j, k, 1)``, in lengths of the body. Any sign of the determinant and any shear are allowed, so the
    ///     affine of a NIfTI image is taken as it is.
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
    /// See Also
    /// --------
    /// from_labelled_voxels : a body for each label of a segmented image.
    /// from_file : images as files, NIfTI, NRRD and NumPy.
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
    ///
    /// A scanner whose first axis runs to the left:
    ///
    /// >>> affine = [(-0.25, 0, 0, 1), (0, 0.5, 0, 0), (0, 0, 0.75, 0), (0, 0, 0, 1)]
    /// >>> RigidBody.from_voxels(np.full((4, 4, 4), 2.0), affine=affine).center_of_mass
    /// array([0.625, 0.75 , 1.125])
    #[staticmethod]
    #[pyo3(
        signature = (density, spacing=None, origin=Argument::default(), *, affine=None),
        text_signature = "(density, spacing=None, origin=(0.0, 0.0, 0.0), *, affine=None)"
    )]
    fn from_voxels(
        py: Python<'_>,
        density: &Bound<'_, PyAny>,
        spacing: Optional<'_, '_>,
        origin: Argument<'_>,
        affine: Optional<'_, '_>,
    ) -> PyResult<Self> {
        let frame = Frame::read(py, spacing, &origin, affine)?;
        if let Ok(array) = density.cast_exact::<PyArrayDyn<f32>>()
            && array.is_c_contiguous()
            && array.is_aligned()
        {
            let array = array.readonly();
            return of_voxels(py, array.as_slice()?, array.shape(), &frame);
        }
        let array = floats(density, "density")?;
        of_voxels(py, array.as_slice()?, array.shape(), &frame)
    }

    /// A body for each label of a segmented image: bones of a scan, grains of a tomogram, cells of a microscope.
    ///
    /// All bodies are summed in one pass. Their moments are exact for cells that are homogeneous boxes or parallelepipeds,
    /// for any number of labels.
    ///
    /// Parameters
    /// ----------
    /// labels : array_like of int, shape (nx, ny, nz); str or os.PathLike
    ///     The label of each cell. The label 0 is background, unless `density` names it. A path is that of an image: NIfTI or
    ///     NRRD (extra ``image``), or NumPy's ``.npy``; see :func:`polhode.images.read_image`.
    /// density : float, mapping or array_like
    ///     Mass per volume: one number for all labels; ``{label: number}``, which leaves out labels that it does not name,
    ///     and where ``"*"`` stands for all others; or an array of the shape of `labels` with the density of each cell.
    /// spacing, origin, affine
    ///     As of :meth:`from_voxels`; a file has its own.
    /// length_unit : str, optional
    ///     Unit of lengths of a file that states none. They are converted to metres.
    ///
    /// Returns
    /// -------
    /// labels : numpy.ndarray of int, shape (k,)
    ///     Ascending.
    /// bodies : RigidBody
    ///     A stack of shape (k,).
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> image = np.zeros((2, 2, 4), dtype=np.uint8)
    /// >>> image[:, :, :2], image[:, :, 3] = 5, 9
    /// >>> labels, bodies = RigidBody.from_labelled_voxels(image, {5: 1000.0, 9: 1900.0}, spacing=0.01)
    /// >>> labels
    /// array([5, 9])
    /// >>> bodies.mass.round(9)
    /// array([0.008 , 0.0076])
    #[staticmethod]
    #[pyo3(
        signature = (labels, density, *, spacing=None, origin=None, affine=None, length_unit=None),
        text_signature = "(labels, density, *, spacing=None, origin=(0.0, 0.0, 0.0), affine=None, length_unit=None)"
    )]
    fn from_labelled_voxels<'py>(
        py: Python<'py>,
        labels: &Bound<'py, PyAny>,
        density: &Bound<'py, PyAny>,
        spacing: Optional<'_, 'py>,
        origin: Optional<'_, 'py>,
        affine: Optional<'_, 'py>,
        length_unit: Optional<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        py.import("polhode.io.images")?.call_method1(
            "bodies_of_labels",
            (labels, density, spacing, origin, affine, length_unit),
        )
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
    let uncertainties = propagate_rows(py, &grid, true, |[i, j]| {
        Ok(of_particles(
            (0..*n).map(|k| (m.row(i * n + k), r.row(j * n + k))),
        ))
    })?;
    Ok(PyRigidBody {
        uncertainties,
        ..bodies
    })
}

/// The bodies under their shape, or the error with its row.
fn stack(
    py: Python<'_>,
    shape: Vec<usize>,
    bodies: Result<Vec<RigidBody>, (usize, Error)>,
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
            "; every label from 0 to the largest needs a particle here: return_labels=True takes labels with gaps"
        }
        Error::Body(BodyFault::NoMass { .. }) => {
            "; give its particles their masses, or the label -1 where they belong to no body"
        }
        _ => "",
    }
}

// Bodies from matter that fills space: tetrahedra, and densities over regions.

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
        let _guard = RecursionGuard::run("from_density")?;
        callable(density)?;
        let region = region(bounds)?;
        let effort = Effort {
            rtol,
            max_evaluations: count(max_evaluations)?,
        };
        let at = |points: &[[f64; 3]], values: &mut [f64]| ask(density, points, values);
        finish_estimate(py, from_density(&region, at, effort))
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
        let _guard = RecursionGuard::run("from_radial_density")?;
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
        finish_estimate(py, from_radial_density(&boundaries, at, effort))
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
fn finish_estimate(py: Python<'_>, outcome: Result<Estimate, Halt>) -> PyResult<PyRigidBody> {
    let found = match outcome {
        Ok(found) => found,
        Err(Halt::Raised(error)) => return Err(error),
        Err(Halt::Law(error)) => return Err(to_py(py, &error)),
    };
    match found.require_converged() {
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
