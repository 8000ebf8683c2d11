//! Triangles from files.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use numpy::{PyArray2, PyArrayMethods};
use polhode::io::{FileFault, TriangleMesh, plates, stl};
use polhode::mass::polyhedron;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

use crate::errors::{new, to_py};
use crate::rigid_body::mesh;

/// Vertices (n, 3) and faces (m, 3).
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>);

/// Vertices (n, 3) and faces (m, 3) of a binary STL; corners with equal coordinates become one vertex.
#[pyfunction]
pub(crate) fn read_stl(py: Python<'_>, path: PathBuf) -> PyResult<Arrays<'_>> {
    let mesh = py.detach(|| {
        let file = File::open(&path)?;
        let held = file.metadata()?;
        if held.is_dir() {
            return Err(stl::StlError::Io(io::ErrorKind::IsADirectory.into()));
        }
        stl::read(io::BufReader::new(file), held.len())
    });
    match mesh {
        Ok(mesh) => to_arrays(py, mesh),
        Err(stl::StlError::Io(error)) => Err(os_error(&path, &error)),
        Err(stl::StlError::Fault(fault)) => Err(file_error(py, &path, &fault)),
    }
}

/// Vertices (n, 3) and faces (m, 3) of `v`/`f` text: the geometry of OBJ files and plate models.
///
/// Faces in the file count vertices from `index_base`, 0 or 1; those returned count from zero.
#[pyfunction]
#[pyo3(signature = (path, index_base=1))]
pub(crate) fn read_plates(
    py: Python<'_>,
    path: PathBuf,
    index_base: usize,
) -> PyResult<Arrays<'_>> {
    if index_base > 1 {
        return Err(PyValueError::new_err(format!(
            "index_base: expected 0 or 1, got {index_base}"
        )));
    }
    let bytes = std::fs::read(&path).map_err(|error| os_error(&path, &error))?;
    let mesh = py.detach(|| plates::read(&String::from_utf8_lossy(&bytes), index_base));
    to_arrays(py, mesh.map_err(|fault| file_error(py, &path, &fault))?)
}

/// Area of a triangle mesh, open or closed.
#[pyfunction]
pub(crate) fn surface_area(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
) -> PyResult<f64> {
    let mesh = mesh(py, vertices, faces)?;
    let area = py.detach(|| polyhedron::surface_area(&mesh.vertices, &mesh.faces));
    area.map_err(|error| to_py(py, &error))
}

fn to_arrays(py: Python<'_>, mesh: TriangleMesh) -> PyResult<Arrays<'_>> {
    let (n, m) = (mesh.vertices.len(), mesh.faces.len());
    let indices = mesh
        .faces
        .into_iter()
        .flatten()
        .map(i64::try_from)
        .collect::<Result<Vec<i64>, _>>()?;
    let vertices = numpy::PyArray1::from_vec(py, mesh.vertices.into_flattened()).reshape([n, 3])?;
    Ok((
        vertices,
        numpy::PyArray1::from_vec(py, indices).reshape([m, 3])?,
    ))
}

/// As Python's own `open` reports it.
fn os_error(path: &Path, error: &io::Error) -> PyErr {
    match error
        .raw_os_error()
        .or((error.kind() == io::ErrorKind::IsADirectory).then_some(21))
    {
        Some(number) => {
            let message = error.to_string();
            let message = message
                .split(" (os error")
                .next()
                .unwrap_or_default()
                .to_owned();
            PyOSError::new_err((number, message, path.to_path_buf()))
        }
        None => PyOSError::new_err(format!("{}: {error}", path.display())),
    }
}

fn file_error(py: Python<'_>, path: &Path, fault: &FileFault) -> PyErr {
    new(
        py,
        "FileFormatError",
        format!("{}: {fault}", path.display()),
    )
}
