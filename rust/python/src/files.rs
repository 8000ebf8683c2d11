//! Triangles from files.

use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::{Path, PathBuf};

use numpy::{PyArray2, PyArrayMethods};
use polhode::Error;
use polhode::io::ply::PlyStream;
use polhode::io::stl::{self, StlStream};
use polhode::io::{TriangleMesh, plates};
use polhode::mass::polyhedron::Options;
use polhode::mass::polyhedron::stream::{StreamError, TriangleStream};
use polhode::mass::polyhedron::streaming;
use polhode::mass::surface;
use polhode::parallel::Halt;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::read_scalar;
use crate::body::PyRigidBody;
use crate::depth::RecursionGuard;
use crate::errors::{to_py, with_prefix};
use crate::interrupt::{Interrupt, watched};
use crate::meshes::{read_mesh, with_mesh};
use crate::shapes::amount;
use crate::stack::Stack;
use crate::uncertain::Weight;

/// Vertices (n, 3) and faces (m, 3).
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>);

/// Vertices (n, 3) and faces (m, 3) of a binary STL; corners with equal coordinates become one vertex.
#[pyfunction]
pub(crate) fn read_stl(py: Python<'_>, path: PathBuf) -> PyResult<Arrays<'_>> {
    let interrupt = Interrupt::new(None);
    let mesh = py.detach(|| {
        let file = File::open(&path)?;
        let held = file.metadata()?;
        if held.is_dir() {
            return Err(StreamError::Io(io::ErrorKind::IsADirectory.into()));
        }
        let source = InterruptibleFile(file, &interrupt);
        stl::read(io::BufReader::with_capacity(1 << 18, source), held.len())
    });
    interrupt.finish(py, false)?;
    match mesh {
        Ok(mesh) => to_arrays(py, mesh),
        Err(error) => Err(stream_error(py, &path, error)),
    }
}

/// What goes through a file once: the solid that the triangles of a binary STL or PLY bound, how many they are, the volume and
/// the area; coordinates are multiplied by `scale`.
#[pyfunction]
#[pyo3(signature = (path, *, scale=1.0, density=None, mass=None, orient=false, progress=None))]
pub(crate) fn stream_solid(
    py: Python<'_>,
    path: PathBuf,
    #[pyo3(from_py_with = read_scalar)] scale: f64,
    density: Option<Weight>,
    mass: Option<Weight>,
    orient: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PyRigidBody, usize, f64, f64)> {
    let _guard = RecursionGuard::run("from_file")?;
    let of = |weight: Option<&Weight>| weight.map(|weight| weight.value);
    let amount = amount(of(mass.as_ref()), of(density.as_ref()))?;
    let options = Options {
        orient,
        check: true,
    };
    let interrupt = Interrupt::new(progress);
    let outcome = py.detach(|| {
        let mut file = io::BufReader::with_capacity(1 << 18, File::open(&path)?);
        let held = file.get_ref().metadata()?.len();
        let is_ply = file.fill_buf()?.starts_with(b"ply");
        let mut stl;
        let mut ply;
        let stream: &mut dyn TriangleStream = if is_ply {
            ply = PlyStream::new(file, held)?;
            &mut ply
        } else {
            stl = StlStream::new(file, held)?;
            &mut stl
        };
        let watch = &mut |fraction| interrupt.poll(Some(fraction));
        streaming::stream_solid(stream, scale, amount, options, watch)
    });
    interrupt.finish(py, outcome.is_ok())?;
    let solid = outcome.map_err(|error| match error {
        StreamError::Failed(error) => to_py(py, &error), // the caller names the file
        other => stream_error(py, &path, other),
    })?;
    let body = PyRigidBody::from(Stack::one(solid.body)).weigh([density, mass, None])?;
    Ok((body, solid.triangles, solid.volume, solid.area))
}

/// A file that Ctrl-C ends, however long it is.
struct InterruptibleFile<'a, R>(R, &'a Interrupt);

impl<R: Read> Read for InterruptibleFile<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.1.poll(None).is_break() {
            return Err(io::Error::other("stopped"));
        }
        self.0.read(buffer)
    }
}

/// An error with the file's name in front.
fn stream_error(py: Python<'_>, path: &Path, error: StreamError) -> PyErr {
    match error {
        StreamError::Io(error) => os_error(path, &error),
        StreamError::Stopped => to_py(py, &Error::Stopped),
        StreamError::Failed(error @ (Error::Mesh(_) | Error::File(_))) => {
            with_prefix(py, &path.display().to_string(), &to_py(py, &error))
        }
        StreamError::Failed(error) => to_py(py, &error),
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
    #[pyo3(from_py_with = read_scalar)] index_base: usize,
) -> PyResult<Arrays<'_>> {
    if index_base > 1 {
        return Err(PyValueError::new_err(format!(
            "index_base: expected 0 or 1, got {index_base}"
        )));
    }
    let interrupt = Interrupt::new(None);
    let mesh = py.detach(|| {
        let mut bytes = Vec::new();
        InterruptibleFile(File::open(&path)?, &interrupt).read_to_end(&mut bytes)?;
        let watch = &mut |_| interrupt.poll(None);
        Ok(plates::read(
            &String::from_utf8_lossy(&bytes),
            index_base,
            watch,
        ))
    });
    interrupt.finish(py, false)?;
    match mesh.map_err(|error: io::Error| os_error(&path, &error))? {
        Ok(mesh) => to_arrays(py, mesh),
        Err(Halt::Failed(fault)) => {
            let error = to_py(py, &fault.into());
            Err(with_prefix(py, &path.display().to_string(), &error))
        }
        Err(Halt::Stopped) => Err(to_py(py, &Error::Stopped)),
    }
}

/// Area of a triangle mesh, open or closed.
#[pyfunction]
pub(crate) fn surface_area(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
) -> PyResult<f64> {
    let mesh = read_mesh(vertices, faces)?;
    let area = with_mesh!(mesh, |vertices, faces| {
        watched(py, |watch| surface::area(vertices, faces, watch))?
    });
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
