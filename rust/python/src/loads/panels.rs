//! The function of `polhode.loads` that makes plates in light or air, with its documentation.

use nalgebra::Vector3;
use numpy::PyUntypedArrayMethods;
use polhode::Error;
use polhode::error::MeshFault;
use polhode::motion::loads::{Panels, PiecewiseSignal, Plates, Stream, Surface, Term};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use super::load::{LoadPart, PyLoad};
use super::pickle_recipe::recipe;
use super::registry::register;
use crate::arrays::{
    copy_of, floats, list_floats, read, read_list, read_scalar, try_rows, try_series,
};
use crate::errors::{at_row, new, to_py};
use crate::interrupt::{Beat, watched};
use crate::meshes::{read_mesh, with_mesh};
use crate::shape::tuple;
use crate::stack::{BLOCK, Broadcast, Stack};

/// The pressure of sunlight, or the drag of thin air, on flat plates: a force and a torque.
///
/// With ``law="solar"`` the force on a plate of area A is
/// ``F = -p A cos θ ((1 - ρ_s) s + 2 (ρ_s cos θ + ρ_d/3) n)``, where s is the unit vector to the Sun, n the outward
/// normal, ``cos θ = s·n``, and p the pressure of the light. With ``law="drag"`` it is ``½ ρ v**2 C_d A cos θ`` along
/// the flow, where θ is the angle from n to the vector against the flow. A plate that is turned away,
/// ``cos θ <= 0``, feels nothing.
///
/// The force moves a free body. The torque is about the reference point of the motion. Shadows are not
/// computed: each plate feels light and air as if it were alone. For a convex body this is exact. For any other
/// body, parts in the shadow of others count as lit.
///
/// Parameters
/// ----------
/// surface : object
///     The plates in the body frame, in one of three forms: an object with ``vertices`` and ``faces``, as trimesh
///     has them; a tuple ``(vertices, faces)``, as :meth:`polhode.RigidBody.from_mesh` takes them; or a tuple
///     ``(centers, areas, normals)`` of shapes (n, 3), (n,) and (n, 3). A plate has one side, that of its outward
///     normal: a thin panel is two plates. The lengths of normals do not count.
/// law : {"solar", "drag"}, optional
/// coefficients : array_like, shape (2,) or (..., n, 2) of light, () or (..., n) of drag
///     Of light (ρ_s, ρ_d), the shares that a plate mirrors and scatters. Each is from 0 to 1, and their sum is at
///     most 1; the rest is absorbed. Of drag C_d. For all plates, or for each of the n plates or faces.
/// direction : array_like, shape (..., 3) or (..., k, 3), optional
///     Of light the direction from the body to the Sun, of drag the direction along the flow. Components are in
///     space, and the length does not count. Constant, or known at `times`, with a cubic spline in between.
/// pressure : array_like, shape (...) or (..., k), optional
///     Pressure of the light on a black plate at right angles to it; near the Earth 4.54e-6 Pa. Constant, or
///     known at `times`, with straight lines in between: zero in the shadow of a planet.
/// density : array_like, shape (...) or (..., k), optional
///     Density of the air, likewise.
/// velocity : array_like, shape (..., 3) or (..., k, 3), optional
///     Velocity of the body relative to the air, components in space. Constant, or known at `times`, with a cubic
///     spline in between. Beside `direction` it is the speed of the flow, of shape (...) or (..., k).
/// times : array_like, shape (k,), optional
///     Times of the tables, ascending, at least two.
///
/// Returns
/// -------
/// Load
///
/// Raises
/// ------
/// MeshError
///     If the mesh has no area, if a face stands twice or is not wound as its neighbours are, or if a closed mesh
///     is wound inward. An open mesh is a surface, and allowed; its normals cannot be checked.
/// ValueError
///     If a simulation needs a table before the first or after the last of its times.
///
/// Notes
/// -----
/// Light and air do not reach a cavity inside a body: leave its faces out.
///
/// The density and the velocity of the air do not depend on the state of the body. So the drag has no part that
/// slows a rotation down.
///
/// The force is continuous, and has a kink where a plate turns away. There is no Taylor series: the method
/// "auto" is "dop853", which makes shorter steps at a kink, and derivatives are by differences.
///
/// A shadow with a sharp edge is made by :func:`schedule`, which switches the load off and on at given times.
///
/// Examples
/// --------
/// A black panel of 3 m² in sunlight, and a mirror, which feels twice the force:
///
/// >>> from polhode import RigidBody, loads
/// >>> panel = ([(2.0, 0, 0)], [3.0], [(0, 0, 1)])
/// >>> body = RigidBody.from_principal(100.0, (20.0, 30.0, 40.0))
/// >>> rest = {"t": 0.0, "omega": (0, 0, 0), "quaternion": (0, 0, 0, 1), "body": body}
/// >>> black = loads.panels(panel, coefficients=(0, 0), direction=(0, 0, 1), pressure=4.5e-6)
/// >>> mirror = loads.panels(panel, coefficients=(1, 0), direction=(0, 0, 1), pressure=4.5e-6)
/// >>> black.force(**rest).round(9), mirror.force(**rest).round(9), mirror.torque(**rest).round(9)
/// (array([ 0.00e+00,  0.00e+00, -1.35e-05]), array([ 0.0e+00,  0.0e+00, -2.7e-05]), array([0.0e+00, 5.4e-05, 0.0e+00]))
///
/// The drag of a cube at a height of 400 km, from its mesh:
///
/// >>> corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
/// >>> faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
/// ...          (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
/// >>> air = loads.panels((corners, faces), "drag", coefficients=2.2, density=3e-12, velocity=(7670, 0, 0))
/// >>> air.force(**rest).round(9) + 0.0
/// array([-0.00019414,  0.        ,  0.        ])
#[pyfunction]
#[pyo3(signature = (surface, law="solar", *, coefficients, direction=None, pressure=None, density=None, velocity=None, times=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub(crate) fn panels(
    py: Python<'_>,
    surface: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] law: &str,
    coefficients: &Bound<'_, PyAny>,
    direction: Option<&Bound<'_, PyAny>>,
    pressure: Option<&Bound<'_, PyAny>>,
    density: Option<&Bound<'_, PyAny>>,
    velocity: Option<&Bound<'_, PyAny>>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyLoad> {
    let is_light = match law {
        "solar" => true,
        "drag" => false,
        other => {
            return Err(PyValueError::new_err(format!(
                "law: expected \"solar\" or \"drag\", got \"{other}\""
            )));
        }
    };
    let level = check_arguments(is_light, direction, pressure, density, velocity)?;
    let (plates, kept_surface) = read_surface(surface)?;
    let surfaces = read_coefficients(py, &plates, coefficients, is_light)?;
    let knots = match times {
        Some(times) => Some(list_floats(times, "times", "k", &[])?.as_slice()?.to_vec()),
        None => None,
    };
    let knots = knots.as_deref();
    let (what, (vectors, is_moving)) = match (velocity, direction) {
        (None, Some(direction)) => ("direction", read_vectors(direction, "direction", knots)?),
        (Some(velocity), None) => ("velocity", read_vectors(velocity, "velocity", knots)?),
        (Some(speed), Some(direction)) => ("velocity", read_wind(speed, direction, knots)?),
        (None, None) => return Err(PyTypeError::new_err("direction: is needed")), // refused above
    };
    let streams = match knots.filter(|_| is_moving) {
        Some(knots) => try_series(py, &vectors, |series, watch| {
            let of = if is_light {
                Stream::light_sampled
            } else {
                Stream::air_sampled
            };
            of(knots, series, watch)
        })?,
        None => try_rows(
            py,
            &vectors,
            if is_light { Stream::light } else { Stream::air },
        )?,
    };
    let name = if is_light { "pressure" } else { "density" };
    let (levels, is_changing) = read_levels(level, name, knots)?;
    if knots.is_some() && !is_moving && !is_changing {
        return Err(PyTypeError::new_err(format!(
            "times: neither {what} nor {name} is a table with a row for each of the times; give such a table, or leave times out"
        )));
    }
    let shapes = [&surfaces.shape[..], &streams.shape, &levels.shape];
    let terms = Broadcast::of(["coefficients", what, name], shapes)?.try_map(py, |[c, s, l]| {
        Panels::new(surfaces[c].clone(), streams[s].clone(), levels[l].clone()).map(Term::Panels)
    })?;
    // Arrays are copied.
    let options = PyDict::new(py);
    options.set_item("coefficients", copy_of(coefficients)?)?;
    for (name, given) in [
        ("direction", direction),
        ("pressure", pressure),
        ("density", density),
        ("velocity", velocity),
        ("times", times),
    ] {
        options.set_item(name, given.map(copy_of).transpose()?)?;
    }
    let recipe = recipe(py, "panels", (kept_surface, law, options))?;
    Ok(PyLoad::one(LoadPart::Term(terms.into()), recipe))
}

register!(Panels by panels);

/// Refuses what does not belong to the law, and what is missing; the pressure or the density.
fn check_arguments<'a, 'py>(
    is_light: bool,
    direction: Option<&Bound<'py, PyAny>>,
    pressure: Option<&'a Bound<'py, PyAny>>,
    density: Option<&'a Bound<'py, PyAny>>,
    velocity: Option<&Bound<'py, PyAny>>,
) -> PyResult<&'a Bound<'py, PyAny>> {
    let refuse = |words: &str| Err(PyTypeError::new_err(words.to_owned()));
    if is_light {
        if density.is_some() || velocity.is_some() {
            let what = if density.is_some() {
                "density"
            } else {
                "velocity"
            };
            return refuse(&format!(
                "{what}: belongs to law=\"drag\"; the law \"solar\" takes direction= and pressure="
            ));
        }
        return match (direction, pressure) {
            (None, _) => refuse("direction: the law \"solar\" needs the direction to the Sun"),
            (_, None) => refuse("pressure: the law \"solar\" needs the pressure of the light"),
            (Some(_), Some(pressure)) => Ok(pressure),
        };
    }
    if pressure.is_some() {
        return refuse(
            "pressure: belongs to law=\"solar\"; the law \"drag\" takes density= and velocity=",
        );
    }
    match (density, velocity) {
        (None, _) => refuse("density: the law \"drag\" needs the density of the air"),
        (_, None) => refuse(
            "velocity: the law \"drag\" needs the velocity of the body relative to the air, or direction= and the speed",
        ),
        (Some(density), Some(_)) => Ok(density),
    }
}

/// The plates, and copies of what made them.
fn read_surface<'py>(surface: &Bound<'py, PyAny>) -> PyResult<(Plates, Bound<'py, PyTuple>)> {
    let py = surface.py();
    let parts: Vec<Bound<'py, PyAny>> =
        if surface.hasattr("faces")? && surface.hasattr("vertices")? {
            vec![surface.getattr("vertices")?, surface.getattr("faces")?]
        } else if surface.hasattr("to_mesh")? {
            let mesh = surface.call_method0("to_mesh")?;
            vec![mesh.getattr("vertices")?, mesh.getattr("faces")?]
        } else if surface.is_instance_of::<PyTuple>() || surface.is_instance_of::<PyList>() {
            surface.try_iter()?.collect::<PyResult<_>>()?
        } else {
            Vec::new()
        };
    let plates = match &parts[..] {
        [vertices, faces] => read_faces(vertices, faces)?,
        [centers, areas, normals] => read_plates(centers, areas, normals)?,
        _ => {
            let got = if parts.is_empty() {
                surface.get_type().name()?.to_string()
            } else {
                format!("{} parts", parts.len())
            };
            return Err(PyTypeError::new_err(format!(
                "surface: expected a mesh, a tuple (vertices, faces) or a tuple (centers, areas, normals), got {got}"
            )));
        }
    };
    let numpy = crate::arrays::numpy(py)?;
    let copies: Vec<_> = (parts.iter())
        .map(|part| numpy.call_method1("array", (part,)))
        .collect::<PyResult<_>>()?;
    Ok((plates, PyTuple::new(py, copies)?))
}

/// The triangles of a mesh.
fn read_faces(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Plates> {
    let py = vertices.py();
    let mesh = read_mesh(vertices, faces)?;
    let plates = with_mesh!(mesh, |vertices, faces| watched(py, |watch| {
        Plates::of_mesh(vertices, faces, watch)
    }))?;
    plates.map_err(|error| match &error {
        // The remedy for a solid is an option that is not here.
        Error::Mesh(MeshFault::Inverted { .. } | MeshFault::InsideOut { .. }) => {
            new(py, "MeshError", error.to_string())
        }
        error => to_py(py, error),
    })
}

/// Plates one by one.
fn read_plates(
    centers: &Bound<'_, PyAny>,
    areas: &Bound<'_, PyAny>,
    normals: &Bound<'_, PyAny>,
) -> PyResult<Plates> {
    let py = centers.py();
    let centers: Stack<Vector3<f64>> = read_list(centers, "centers", "n")?;
    let areas: Vec<f64> = list_floats(areas, "areas", "n", &[])?.as_slice()?.to_vec();
    let normals: Stack<Vector3<f64>> = read_list(normals, "normals", "n")?;
    let count = centers.rows.len();
    for (what, given) in [("areas", areas.len()), ("normals", normals.rows.len())] {
        if given != count {
            return Err(PyValueError::new_err(format!(
                "{what}: expected one for each of the {count} plates, whose centers are given, got {given}"
            )));
        }
    }
    if count == 0 {
        return Err(PyValueError::new_err(
            "centers: expected at least one plate, got none",
        ));
    }
    let (mut plates, mut beat) = (Plates::default(), Beat::new(py));
    for k in 0..count {
        if k % BLOCK == 0 {
            beat.mark()?;
        }
        (plates.add(&centers[k], areas[k], &normals[k]))
            .map_err(|error| at_row(&[count], k, &to_py(py, &error), py))?;
    }
    Ok(plates)
}

/// Plates with their coefficients, or a stack of such.
fn read_coefficients(
    py: Python<'_>,
    plates: &Plates,
    coefficients: &Bound<'_, PyAny>,
    is_light: bool,
) -> PyResult<Stack<Surface>> {
    let array = floats(coefficients, "coefficients")?;
    let (shape, numbers, count) = (array.shape(), array.as_slice()?, plates.count());
    let (each, expected) = if is_light {
        (shape.strip_suffix(&[2]), format!("(2,) or ({count}, 2)"))
    } else {
        (Some(shape), format!("() or ({count},)"))
    };
    // Coefficients of one plate for all, or of each.
    let leading = each.and_then(|each| match each {
        [] => Some((&[][..], 1)),
        [leading @ .., own] if *own == count || *own == 1 => Some((leading, *own)),
        _ => None,
    });
    let Some((leading, own)) = leading else {
        let of = if is_light {
            "the shares of light that are mirrored and scattered, for all plates or for each"
        } else {
            "a drag coefficient, for all plates or for each"
        };
        return Err(PyValueError::new_err(format!(
            "coefficients: expected the shape {expected}, {of}, got {}",
            tuple(shape)
        )));
    };
    let width = if is_light { 2 * own } else { own };
    let mut beat = Beat::new(py);
    let mut rows = Vec::new();
    for (row, numbers) in numbers.chunks_exact(width).enumerate() {
        beat.mark()?;
        let made = with_coefficients(plates, numbers, is_light).map_err(|error| {
            // Which plate has them: they are refused without a plate too.
            let none = Plates::default();
            let place = (numbers.chunks_exact(width / own))
                .position(|alone| with_coefficients(&none, alone, is_light).is_err());
            let error = to_py(py, &error);
            match place {
                Some(place) if own > 1 => at_row(&[own], place, &error, py),
                _ => error,
            }
        });
        rows.push(made.map_err(|error| at_row(leading, row, &error, py))?);
    }
    Ok(Stack {
        shape: leading.to_vec(),
        rows,
    })
}

/// Plates with coefficients, those of one for all or of each.
fn with_coefficients(plates: &Plates, numbers: &[f64], is_light: bool) -> Result<Surface, Error> {
    if is_light {
        plates.reflecting(numbers.as_chunks::<2>().0)
    } else {
        plates.dragging(numbers)
    }
}

/// Vectors, and whether they are those at the times.
fn read_vectors(
    given: &Bound<'_, PyAny>,
    what: &'static str,
    knots: Option<&[f64]>,
) -> PyResult<(Stack<Vector3<f64>>, bool)> {
    let vectors: Stack<Vector3<f64>> = read(given, what)?;
    let is_table = is_table(what, &vectors.shape, knots, &[3])?;
    Ok((vectors, is_table))
}

/// Whether what has this shape, and then the axes `tail`, is a table: beside times it is one, unless it is a single row.
fn is_table(what: &str, shape: &[usize], knots: Option<&[f64]>, tail: &[usize]) -> PyResult<bool> {
    let Some(knots) = knots.filter(|_| !shape.is_empty()) else {
        return Ok(false);
    };
    if shape.last() == Some(&knots.len()) {
        return Ok(true);
    }
    let expected = [&[knots.len()], tail].concat();
    Err(PyValueError::new_err(format!(
        "{what}: expected one for each of the {} times, the last axes of the shape {}, got {}",
        knots.len(),
        tuple(&expected),
        tuple(&[shape, tail].concat())
    )))
}

/// The velocity relative to air that flows along a direction with a speed, and whether it is that at the times.
fn read_wind(
    speed: &Bound<'_, PyAny>,
    direction: &Bound<'_, PyAny>,
    knots: Option<&[f64]>,
) -> PyResult<(Stack<Vector3<f64>>, bool)> {
    let py = speed.py();
    let (along, is_moving) = read_vectors(direction, "direction", knots)?;
    let along = try_rows(py, &along, |vector| Stream::light(vector).map(|_| *vector))?;
    let speeds: Stack<f64> = read(speed, "velocity")?;
    let is_changing = is_table("velocity", &speeds.shape, knots, &[])?;
    let speeds = try_rows(py, &speeds, |&speed| {
        if speed >= 0.0 && speed.is_finite() {
            return Ok(speed);
        }
        Err(Error::OutOfDomain {
            what: "velocity",
            law: "a speed along direction, positive or zero (a vector needs no direction)",
            value: speed,
        })
    })?;
    let shapes = [&along.shape[..], &speeds.shape];
    let velocities = Broadcast::of(["direction", "velocity"], shapes)?.try_map(py, |[d, v]| {
        let along = along[d] / along[d].amax();
        Ok(along.normalize() * -speeds[v])
    })?;
    Ok((velocities, is_moving || is_changing))
}

/// Pressures or densities, and whether they are those at the times.
fn read_levels(
    given: &Bound<'_, PyAny>,
    what: &'static str,
    knots: Option<&[f64]>,
) -> PyResult<(Stack<PiecewiseSignal>, bool)> {
    let py = given.py();
    let levels: Stack<f64> = read(given, what)?;
    let Some(knots) = knots.filter(|_| !levels.shape.is_empty()) else {
        let levels = try_rows(py, &levels, |&level| PiecewiseSignal::constant(what, level))?;
        return Ok((levels, false));
    };
    is_table(what, &levels.shape, Some(knots), &[])?;
    let leading = levels.shape[..levels.shape.len() - 1].to_vec();
    let rows = levels.rows.chunks(knots.len().max(1));
    let tables = Stack {
        shape: leading,
        rows: rows.collect::<Vec<_>>(),
    };
    let tables = try_rows(py, &tables, |row| PiecewiseSignal::table(what, knots, row))?;
    Ok((tables, true))
}
