//! The way out of mistakes that many make: what to write instead of an argument that cannot be read.

use pyo3::exceptions::{PyAttributeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

/// What to write instead of an array of this shape; "" where nothing is known.
pub(crate) fn for_shape(name: &str, shape: &[usize]) -> &'static str {
    match (name, shape) {
        ("inertia" | "inertia_about_origin", [.., 3]) => {
            "; RigidBody.from_principal takes the three principal moments"
        }
        ("gravity", []) => "; a strength g that pulls along -z is (0, 0, -g)",
        ("omega", []) => "; a rate about z is (0, 0, rate)",
        ("attitude", [.., 3]) => "; euler_angles.to_quaternion takes three angles",
        _ => "",
    }
}

/// What to write instead of something that is not numbers, by the kind of its dtype.
pub(crate) fn for_kind(name: &str, kind: &str) -> &'static str {
    match (name, kind) {
        ("axis" | "normal" | "direction", "U") => "; the axis z is (0, 0, 1)",
        ("point" | "displacement" | "position", "U") => {
            "; a point is three numbers, body.center_of_mass for example"
        }
        ("rotation" | "attitude", "U") => {
            "; euler_angles.to_quaternion((phi, theta, psi)) makes a rotation of angles"
        }
        (_, "U") => "; convert units first: numpy.deg2rad(30) is 30 deg/s in rad/s",
        _ => "",
    }
}

/// Something else where a load has to be.
pub(crate) fn not_a_load(object: &Bound<'_, PyAny>) -> PyErr {
    let way_out = if object.is_callable() {
        "wrap a function in loads.torque_callback"
    } else if object.is_instance_of::<PyString>() {
        "loads.uniform_gravity((0, 0, -9.81)) is one"
    } else {
        "a weight is loads.uniform_gravity((0, 0, -9.81)), a torque loads.constant_torque((0, 0, 1), \"space\")"
    };
    let kind = object.get_type();
    PyTypeError::new_err(format!(
        "load: expected a Load from polhode.loads, got {kind}; {way_out}"
    ))
}

/// A heavy top without its weight, whose size depends on the units.
pub(crate) fn no_gravity() -> PyErr {
    PyTypeError::new_err(
        "gravity: a heavy top needs it, as gravity=(0, 0, -9.81) in metres and seconds; a motion without weight is free_motion()",
    )
}

/// An attribute that an object does not have, with what people look for under its name.
pub(crate) fn no_attribute(object: &Bound<'_, PyAny>, name: &str) -> PyErr {
    let kind = object.get_type();
    let refused = |name: &str| -> PyResult<PyErr> {
        let words = kind.name()?;
        if name.starts_with('_') {
            return Ok(PyAttributeError::new_err(format!(
                "'{words}' object has no attribute '{name}'"
            )));
        }
        let hints = object.py().import("polhode._hints")?;
        let error = hints.call_method1("no_attribute", (words, name, kind.dir()?))?;
        Ok(PyErr::from_value(error))
    };
    refused(name).unwrap_or_else(|error| error)
}

/// Arguments that a function needs; they may be missing where a keyword is refused with the one that was meant.
pub(crate) fn require<'a, 'py, const N: usize>(
    function: &str,
    arguments: [(&str, Option<&'a Bound<'py, PyAny>>); N],
) -> PyResult<[&'a Bound<'py, PyAny>; N]> {
    let missing: Vec<String> = (arguments.iter())
        .filter(|(_, given)| given.is_none())
        .map(|(name, _)| format!("{name}="))
        .collect();
    let given: Vec<_> = arguments.iter().filter_map(|(_, given)| *given).collect();
    given.try_into().map_err(|_| {
        PyTypeError::new_err(format!(
            "{function}() needs {} too; give it",
            missing.join(", ")
        ))
    })
}

/// A mesh of another library where its vertices are asked for, and no faces.
pub(crate) fn no_faces(vertices: &Bound<'_, PyAny>) -> PyErr {
    let has_faces = vertices.hasattr("faces").unwrap_or(false);
    PyTypeError::new_err(if has_faces {
        "RigidBody.from_mesh() takes arrays, vertices and faces; RigidBody.from_mesh_object(mesh, density=...) takes a mesh"
    } else {
        "RigidBody.from_mesh() needs faces= too; give it"
    })
}

/// Refuse keyword arguments that `function` does not have, with the one that was meant.
pub(crate) fn refuse_unknown(
    function: &str,
    known: &[&str],
    unknown: Option<&Bound<'_, PyDict>>,
) -> PyResult<()> {
    let Some((given, _)) = unknown.and_then(|unknown| unknown.iter().next()) else {
        return Ok(());
    };
    let hints = given.py().import("polhode._hints")?;
    let error = hints.call_method1("no_keyword", (function, given, known.to_vec()))?;
    Err(PyErr::from_value(error))
}
