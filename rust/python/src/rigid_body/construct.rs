//! Ways to a body.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use polhode::uncertainty::{FromPrincipal, FromTensor, FromTensorAboutOrigin};
use polhode::{Error, RigidBody};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Argument, read_scalar};
use crate::attitudes::read_rotation;
use crate::body::PyRigidBody;
use crate::hints::refuse_unknown;
use crate::interrupt::Beat;
use crate::memory;
use crate::stack::{BLOCK, Broadcast, Stack, extend};
use crate::uncertain::{Quantity, carried, of_numbers, quantity, quantity_or, symmetric};

/// An optional argument of any array-like kind.
type Given<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

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
        inertia: Given<'_, '_>,
        center_of_mass: Argument<'_>,
        inertia_about_origin: Given<'_, '_>,
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
        let doubts = carried(py, &grid, is_uncertain, |[m, i, c]| {
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
        Self::doubtful(bodies, doubts).possible(py)
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
        axes: Given<'_, '_>,
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
        let doubts = carried(py, &grid, is_uncertain, |[m, i, v, c]| {
            let numbers = [mass.row(m), center.row(c), moments.row(i)].concat();
            of_numbers(&FromPrincipal(axes[v]), &numbers)
        })?;
        Self::doubtful(bodies, doubts).possible(py)
    }

    /// Body from any file that holds one: a mesh (STL, OBJ, PLY, OFF, DAE, 3MF, glTF, GLB, VTK, plate models), solids of CAD
    /// (STEP, IGES), a molecule (XYZ, PDB, MOL, SDF), each also packed with gzip; a body that `save` wrote (JSON, npz), with every
    /// bit of it; a report of the command line (JSON); an assembly (TOML). An argument that the file cannot use is refused.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// density, mass : float
    ///     For a mesh exactly one of the two; `density` may be a mapping of the names of components to their
    ///     densities. For a molecule neither, since its atoms have masses. CAD solids whose materials have
    ///     densities need neither.
    /// length_unit : str, optional
    ///     Unit of the coordinates, such as ``"mm"``. They are converted to metres, and the masses of a
    ///     molecule to kilograms. Without it, coordinates are converted to metres if the file or its format
    ///     states their unit (STEP, IGES, DAE, 3MF, glTF, GLB). All others stay as they are, and a molecule is
    ///     in u and angstrom. A saved body keeps the unit it was saved in. A unit that differs from the one in the
    ///     file is an error.
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
    #[pyo3(signature = (path, *, density=None, mass=None, length_unit=None, weld=0.0, closure=None, orient=false, union=false, repair=false, index_base=1, masses="most_common", progress=None))]
    #[expect(clippy::too_many_arguments, reason = "one for each of Python's")]
    fn from_file<'py>(
        py: Python<'py>,
        path: &Bound<'py, PyAny>,
        density: Option<&Bound<'py, PyAny>>,
        mass: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = read_scalar)] length_unit: Option<&str>,
        #[pyo3(from_py_with = read_scalar)] weld: f64,
        #[pyo3(from_py_with = read_scalar)] closure: Option<&str>,
        orient: bool,
        union: bool,
        repair: bool,
        #[pyo3(from_py_with = read_scalar)] index_base: i64,
        #[pyo3(from_py_with = read_scalar)] masses: &str,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = PyDict::new(py);
        options.set_item("density", density)?;
        options.set_item("mass", mass)?;
        options.set_item("length_unit", length_unit)?;
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
                crate::shape::tuple(shape),
                crate::shape::tuple(&other.get().bodies.shape)
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
        let is_uncertain = bodies.iter().any(|body| body.get().doubts.is_some());
        let doubts = is_uncertain.then(|| {
            let of = |body: &Bound<'_, Self>| {
                let body = body.get();
                (0..body.bodies.rows.len())
                    .map(|row| body.row(row).1.clone())
                    .collect::<Vec<_>>()
            };
            Arc::new(bodies.iter().flat_map(of).collect())
        });
        let figures = Self::stacked(bodies.iter().map(Bound::get));
        Ok(Self::doubtful(Stack { shape, rows }, doubts).looking(figures))
    }
}
