//! Meshes as NumPy holds them: vertices, and faces of whatever integers, taken as they lie in memory.

use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use polhode::Error;
use polhode::parallel::Halt;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{as_array, contiguous, floats};
use crate::errors::to_py;
use crate::interrupt::Interrupt;
use crate::shape::tuple;

/// Vertices (n, 3) and faces (m, 3).
pub(crate) struct Mesh<'py> {
    pub(crate) vertices: PyReadonlyArrayDyn<'py, f64>,
    pub(crate) faces: Faces<'py>,
}

/// Faces of the integers that are not copied.
pub(crate) enum Faces<'py> {
    I32(PyReadonlyArrayDyn<'py, i32>),
    U32(PyReadonlyArrayDyn<'py, u32>),
    I64(PyReadonlyArrayDyn<'py, i64>),
    U64(PyReadonlyArrayDyn<'py, u64>),
}

/// Evaluates an expression with the vertices and faces of a mesh as slices of triples.
macro_rules! with_mesh {
    ($mesh:expr, |$vertices:ident, $faces:ident| $body:expr) => {{
        let $vertices = $mesh.vertices.as_slice()?.as_chunks::<3>().0;
        match &$mesh.faces {
            $crate::meshes::Faces::I32(faces) => {
                let $faces = faces.as_slice()?.as_chunks::<3>().0;
                $body
            }
            $crate::meshes::Faces::U32(faces) => {
                let $faces = faces.as_slice()?.as_chunks::<3>().0;
                $body
            }
            $crate::meshes::Faces::I64(faces) => {
                let $faces = faces.as_slice()?.as_chunks::<3>().0;
                $body
            }
            $crate::meshes::Faces::U64(faces) => {
                let $faces = faces.as_slice()?.as_chunks::<3>().0;
                $body
            }
        }
    }};
}
pub(crate) use with_mesh;

/// Reads a mesh; only its shapes and types are checked.
pub(crate) fn read_mesh<'py>(
    vertices: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
) -> PyResult<Mesh<'py>> {
    let vertices = floats(vertices, "vertices")?;
    if !matches!(vertices.shape(), [_, 3]) {
        return Err(PyValueError::new_err(format!(
            "vertices: expected shape (n, 3), got {}",
            tuple(vertices.shape())
        )));
    }
    Ok(Mesh {
        vertices,
        faces: read_faces(faces)?,
    })
}

fn read_faces<'py>(object: &Bound<'py, PyAny>) -> PyResult<Faces<'py>> {
    let array = as_array(object, "faces")?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let is_empty = shape == [0] || shape == [0, 3];
    if !"iu".contains(&kind) && !is_empty {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "faces: expected integers, got dtype {dtype}"
        )));
    }
    if !matches!(shape[..], [_, 3]) && !is_empty {
        return Err(PyValueError::new_err(format!(
            "faces: expected shape (m, 3), got {}",
            tuple(&shape)
        )));
    }
    if let Some(array) = as_it_is(&array) {
        return Ok(Faces::I64(array));
    }
    if let Some(array) = as_it_is(&array) {
        return Ok(Faces::I32(array));
    }
    if let Some(array) = as_it_is(&array) {
        return Ok(Faces::U32(array));
    }
    if let Some(array) = as_it_is(&array) {
        return Ok(Faces::U64(array));
    }
    let wide = if kind == "u" { "uint64" } else { "int64" };
    let array = contiguous(&array, "faces", wide)?;
    if kind == "u" {
        return Ok(Faces::U64(array.cast_into::<PyArrayDyn<u64>>()?.readonly()));
    }
    Ok(Faces::I64(array.cast_into::<PyArrayDyn<i64>>()?.readonly()))
}

/// The array when it has this type of elements, in C order.
fn as_it_is<'py, T: Element>(array: &Bound<'py, PyAny>) -> Option<PyReadonlyArrayDyn<'py, T>> {
    let array = array.cast::<PyArrayDyn<T>>().ok()?;
    (array.is_c_contiguous() && array.is_aligned()).then(|| array.readonly())
}

/// The result of work that Python may stop.
pub(crate) fn finish<T>(
    py: Python<'_>,
    interrupt: Interrupt,
    outcome: Result<T, Halt<Error>>,
) -> PyResult<T> {
    match outcome {
        Err(Halt::Failed(error)) => Err(to_py(py, &error)),
        Err(Halt::Stopped) => {
            interrupt.finish(py, false)?;
            Err(to_py(py, &Error::Stopped))
        }
        Ok(value) => {
            interrupt.finish(py, true)?;
            Ok(value)
        }
    }
}
