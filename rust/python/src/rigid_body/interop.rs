//! Bodies outside the library: other libraries' objects, files, notebooks. Python does it all.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::read_scalar;
use crate::body::PyRigidBody;

#[pymethods]
impl PyRigidBody {
    /// Body from a mesh object of another library, such as ``trimesh.Trimesh``.
    ///
    /// Parameters
    /// ----------
    /// mesh : object
    ///     Object with ``vertices`` (n, 3) and ``faces`` (m, 3); or a ``trimesh.Scene``, whose meshes are
    ///     placed by its transforms. The unit of the coordinates is kept.
    /// density, mass : float
    ///     Exactly one of the two. A density that the object itself has is not used.
    /// **options
    ///     `closure`, `orient` and `check` as of `from_mesh`.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     When the mesh does not bound a solid.
    /// TypeError
    ///     For an object without vertices and faces.
    ///
    /// Examples
    /// --------
    /// >>> from types import SimpleNamespace
    /// >>> from polhode import RigidBody
    /// >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    /// >>> mesh = SimpleNamespace(vertices=corners, faces=[(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    /// >>> RigidBody.from_mesh_object(mesh, density=6.0).mass
    /// 1.0
    #[staticmethod]
    #[pyo3(signature = (mesh, *, density=None, mass=None, **options))]
    fn from_mesh_object<'py>(
        mesh: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = read_scalar)] density: Option<f64>,
        #[pyo3(from_py_with = read_scalar)] mass: Option<f64>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = mesh.py();
        let all = PyDict::new(py);
        if let Some(options) = options {
            all.update(options.as_mapping())?;
        }
        all.set_item("density", density)?;
        all.set_item("mass", mass)?;
        py.import("polhode.interop.foreign_objects")?.call_method(
            "body_from_mesh",
            (mesh,),
            Some(&all),
        )
    }

    /// Body from a molecule of another library: an ``Atoms`` of ASE, or a ``Mol`` of RDKit with a conformer.
    ///
    /// Parameters
    /// ----------
    /// atoms : object
    ///     Object with ``get_chemical_symbols()`` and ``get_positions()`` (ASE), or with ``GetAtoms()`` and
    ///     ``GetConformer()`` (RDKit). Positions are in ångströms.
    /// conformer : int, optional
    ///     Number of the conformer of an RDKit molecule; its first by default.
    /// masses : {"most_common", "average"}
    ///     Mass of each element: that of its most common isotope, as in spectroscopy, or the average over its
    ///     isotopes, as for a substance in a bottle. Masses that were set in ASE and isotopes that were set
    ///     in RDKit take precedence. `provenance` tells which masses were used.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///     The body in daltons and ångströms.
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     When bonds or fragments cross a side of the cell of ASE's atoms, along the directions of its ``pbc``
    ///     (see :func:`polhode.molecules.cell_crossings`), or hydrogens of RDKit's molecule have no positions.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an object of another kind.
    /// ValueError
    ///     For a molecule without a conformer.
    /// PolhodeError
    ///     For an atom that is no element, an element without natural isotopes, or a conformer of RDKit that is a
    ///     drawing in the plane.
    #[staticmethod]
    #[pyo3(signature = (atoms, *, conformer=None, masses="most_common"))]
    fn from_atoms<'py>(
        atoms: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = read_scalar)] conformer: Option<i64>,
        #[pyo3(from_py_with = read_scalar)] masses: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        atoms
            .py()
            .import("polhode.interop.foreign_objects")?
            .call_method1("body_from_atoms", (atoms, conformer, masses))
    }

    /// Write the body or the stack to a file, with every bit of it.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     ``.json``: readable, after the schema in :mod:`polhode.io`; ``.npz``: arrays for NumPy.
    ///
    /// See Also
    /// --------
    /// RigidBody.from_file : reads it.
    #[pyo3(signature = (path))]
    fn save<'py>(slf: &Bound<'py, Self>, path: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("polhode.io.saved")?
            .call_method1("save_body", (slf, path))
    }

    /// Draw the ellipsoid of inertia and the principal axes; needs matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
    ///     Where to draw; a new figure by default.
    /// **options
    ///     As of `polhode.plot.ellipsoid`.
    ///
    /// Returns
    /// -------
    /// mpl_toolkits.mplot3d.axes3d.Axes3D
    #[pyo3(signature = (ax=None, **options))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("polhode.plot")?
            .call_method("ellipsoid", (slf, ax), options)
    }

    /// Show the body with its principal axes and ellipsoid of inertia in a window; needs pyvista.
    ///
    /// Parameters
    /// ----------
    /// plotter : pyvista.Plotter, optional
    ///     Where to show it; a new one by default.
    /// **options
    ///     As of `polhode.view.rigid_body`: `shape`, a mesh of the body, and `opacity` of the ellipsoid.
    ///
    /// Returns
    /// -------
    /// pyvista.Plotter
    ///     Its ``show()`` opens the window.
    #[pyo3(signature = (plotter=None, **options))]
    fn view<'py>(
        slf: &Bound<'py, Self>,
        plotter: Option<&Bound<'py, PyAny>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("polhode.view")?
            .call_method("rigid_body", (slf, plotter), options)
    }

    /// What a notebook shows: a table, and the ellipsoid of inertia as a drawing.
    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("polhode.draw.html")?
            .call_method1("body_html", (slf,))
    }
}
