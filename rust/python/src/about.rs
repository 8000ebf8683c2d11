//! What the argument `about` stands for.

use nalgebra::Vector3;
use polhode::RigidBody;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::read;
use crate::stack::Stack;

/// Words for the centre of mass.
const CENTER: [&str; 2] = ["center_of_mass", "com"];

/// The points that an argument `about` (or `point`) stands for.
pub(crate) fn points(
    py: Python<'_>,
    bodies: &Stack<RigidBody>,
    about: Option<&Bound<'_, PyAny>>,
    name: &str,
) -> PyResult<Stack<Vector3<f64>>> {
    let Some(about) = about else {
        return bodies.map(py, RigidBody::center_of_mass);
    };
    match about.extract::<String>() {
        Ok(word) if CENTER.contains(&word.as_str()) => bodies.map(py, RigidBody::center_of_mass),
        Ok(word) if word == "origin" => Ok(Stack::one(Vector3::zeros())),
        Ok(word) => Err(PyValueError::new_err(format!(
            "{name}: expected \"center_of_mass\", \"origin\" or a point of shape (..., 3), got \"{word}\""
        ))),
        Err(_) => read(about, name),
    }
}

/// Whether the word `about` fixes the origin.
pub(crate) fn is_pivot(about: &str) -> PyResult<bool> {
    match about {
        "origin" => Ok(true),
        word if CENTER.contains(&word) => Ok(false),
        _ => Err(PyValueError::new_err(format!(
            "about: expected \"center_of_mass\" or \"origin\", got \"{about}\"; to fix another point move the body with translated()"
        ))),
    }
}
