//! The way out of mistakes that many make: what to write instead of an argument that cannot be read.

use pyo3::exceptions::{PyAttributeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

/// Names under which people look for an argument, by the argument.
const OTHER_NAMES: [(&str, &[&str]); 7] = [
    (
        "center_of_mass",
        &[
            "center",
            "centre",
            "centre_of_mass",
            "com",
            "cog",
            "center_of_gravity",
        ],
    ),
    ("mass", &["m"]),
    ("inertia", &["I", "tensor", "inertia_tensor"]),
    ("moments", &["inertia", "principal_moments"]),
    ("omega", &["w", "angular_velocity", "rate", "rates"]),
    ("attitude", &["q", "quaternion", "orientation", "rotation"]),
    ("load", &["loads", "torque", "force"]),
];

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
pub(crate) fn for_kind(kind: &str) -> &'static str {
    if kind == "U" {
        "; convert units first: numpy.deg2rad(30) is 30 deg/s in rad/s"
    } else {
        ""
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

/// An attribute that a body does not have, with what people look for under its name.
pub(crate) fn no_attribute(name: &str) -> PyErr {
    let way_out = match name {
        "energy" => "; kinetic_energy(omega) gives it, and its .total the sum",
        "com" | "center" | "centre_of_mass" | "centroid" => "; center_of_mass is it",
        "moments" => "; principal_moments are they",
        "axes" | "principal_axes" => "; principal.axes are they",
        "moment_of_inertia" | "inertia_tensor" | "tensor" | "I" => {
            "; inertia is the tensor about the centre of mass, inertia_about(point) that about another"
        }
        _ => "",
    };
    PyAttributeError::new_err(format!(
        "'RigidBody' object has no attribute '{name}'{way_out}"
    ))
}

/// Refuse keyword arguments that `function` does not have, with the one that was meant.
pub(crate) fn refuse_unknown(
    function: &str,
    known: &[&str],
    unknown: Option<&Bound<'_, PyDict>>,
) -> PyResult<()> {
    let Some(given) = unknown.and_then(|unknown| unknown.keys().iter().next()) else {
        return Ok(());
    };
    let given: String = given.extract()?;
    let meant = OTHER_NAMES
        .iter()
        .find(|(name, others)| known.contains(name) && others.contains(&given.as_str()))
        .map(|(name, _)| (*name).to_owned());
    let meant = match meant {
        Some(name) => Some(name),
        None => nearest(unknown, &given, known)?,
    };
    let way_out = match meant {
        _ if given == "gravity" => {
            "; it is a load: load=loads.uniform_gravity((0, 0, -9.81))".to_owned()
        }
        Some(name) => format!("; did you mean {name}=?"),
        None => format!("; it takes {}", known.join(", ")),
    };
    Err(PyTypeError::new_err(format!(
        "{function}() got an unexpected keyword argument '{given}'{way_out}"
    )))
}

/// The known name that is spelt most nearly so.
fn nearest(
    any: Option<&Bound<'_, PyDict>>,
    given: &str,
    known: &[&str],
) -> PyResult<Option<String>> {
    let Some(py) = any.map(Bound::py) else {
        return Ok(None);
    };
    let found: Vec<String> = py
        .import("difflib")?
        .call_method1("get_close_matches", (given, known.to_vec(), 1))?
        .extract()?;
    Ok(found.into_iter().next())
}
