//! Surfaces that roll, their contact with a plane, and what the plane does along a motion.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use numpy::PyUntypedArrayMethods;
use polhode::Error;
use polhode::mass::RigidBody;
use polhode::motion::attitude::components;
use polhode::motion::loads::Term;
use polhode::motion::rolling::invariants::{self, ContactInvariants};
use polhode::motion::rolling::rolling_motion::Outside;
use polhode::motion::rolling::steady::{Rate, Upright, critical_rate, modes, steady, tippe_top};
use polhode::motion::rolling::{
    Contact, ContactPhase, Friction, Law, LiftOff, Resistance, RollingMotion, RollingState,
    RuledSurface, Surface, force,
};
use polhode::motion::simulate::gravity_alone;
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{
    Argument, Item, floats, read, read_or, read_scalar, write, write_any_of, write_of,
};
use crate::attitudes::{read_attitude_exactly, read_quaternion};
use crate::body::PyRigidBody;
use crate::errors::{at_row, new, to_py};
use crate::interrupt::Interrupt;
use crate::loads::PyLoad;
use crate::memory;
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

/// A convex surface, fixed in a body. Made by the functions of :mod:`polhode.rolling`.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> egg = rolling.ellipsoid((1, 1, 2))
/// >>> egg.contact((0, 0, 1))
/// array([ 0.,  0., -2.])
#[pyclass(name = "Surface", module = "polhode.rolling", frozen)]
pub(crate) struct PySurface {
    surface: Surface,
    /// The function that made it, and its arguments.
    function: &'static str,
    arguments: Vec<(&'static str, Py<PyAny>)>,
}

#[pymethods]
impl PySurface {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        call_of(py, self.function, &self.arguments)
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        parts_of(py, self.function, &self.arguments)
    }

    /// Compute the point of contact with a plane.
    ///
    /// Parameters
    /// ----------
    /// normal : array_like, shape (..., 3)
    ///     Normal of the plane, towards the body, components in the body frame.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     The point whose outward normal is opposite, from the origin of the body frame. NaN where the surface
    ///     has none, as for a disk that lies flat.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import rolling
    /// >>> rolling.disk(0.5).contact((1, 0, 1))
    /// array([-0.5,  0. ,  0. ])
    fn contact<'py>(
        &self,
        py: Python<'py>,
        normal: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let normals = unit_normals(py, normal)?;
        let points = normals.map(py, |normal| self.surface.contact(normal))?;
        Ok(write(py, &points)?.into_any())
    }

    /// Compute the principal curvatures at the point of contact with a plane.
    ///
    /// Parameters
    /// ----------
    /// normal : array_like, shape (..., 3)
    ///     Normal of the plane, towards the body, components in the body frame.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 2)
    ///     The smaller one first; across a sharp edge inf.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import rolling
    /// >>> rolling.ellipsoid((1, 2, 4)).curvatures((0, 0, 1))
    /// array([1., 4.])
    fn curvatures<'py>(
        &self,
        py: Python<'py>,
        normal: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let normals = unit_normals(py, normal)?;
        let curvatures = normals.map(py, |normal| self.surface.curvatures(normal))?;
        Ok(write(py, &curvatures)?.into_any())
    }
}

/// The call of a function of `polhode.rolling` with its arguments, as it is written.
fn call_of(
    py: Python<'_>,
    function: &str,
    arguments: &[(&'static str, Py<PyAny>)],
) -> PyResult<String> {
    let given = arguments.iter().map(|(name, value)| {
        let value = value.bind(py).repr()?;
        Ok(format!("{name}={value}"))
    });
    let given = given.collect::<PyResult<Vec<_>>>()?.join(", ");
    Ok(format!("rolling.{function}({given})"))
}

/// A function of `polhode.rolling` and its arguments, for pickle.
fn parts_of<'py>(
    py: Python<'py>,
    function: &str,
    arguments: &[(&'static str, Py<PyAny>)],
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
    let function = py.import("polhode.rolling")?.getattr(function)?;
    let given = arguments.iter().map(|(_, value)| value.bind(py));
    Ok((function, PyTuple::new(py, given)?))
}

/// Directions as unit vectors.
fn unit_normals(py: Python<'_>, normal: &Bound<'_, PyAny>) -> PyResult<Stack<Vector3<f64>>> {
    let normals: Stack<Vector3<f64>> = read(normal, "normal")?;
    if let Some(flat) = normals.rows.iter().find(|normal| {
        let length = normal.norm();
        !(length > 0.0 && length.is_finite())
    }) {
        return Err(PyValueError::new_err(format!(
            "normal: expected vectors that have a direction, got [{}, {}, {}]",
            flat.x, flat.y, flat.z
        )));
    }
    normals.map(py, Vector3::normalize)
}

/// Make a sphere.
///
/// Parameters
/// ----------
/// radius : float
/// center : array_like, shape (3,), optional
///     From the origin of the body frame; that origin by default. The centre of mass may be elsewhere.
///
/// Returns
/// -------
/// Surface
///
/// Raises
/// ------
/// PolhodeError
///     If the radius is not positive.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.sphere(0.5, center=(0, 0, 0.1)).contact((0, 0, 1))
/// array([ 0. ,  0. , -0.4])
#[pyfunction]
#[pyo3(
    name = "surface_sphere",
    signature = (radius, center=Argument::default()),
    text_signature = "(radius, center=(0.0, 0.0, 0.0))"
)]
pub(crate) fn sphere(
    py: Python<'_>,
    #[pyo3(from_py_with = read_scalar)] radius: f64,
    center: Argument<'_>,
) -> PyResult<PySurface> {
    let center = vector(&center, "center", [0.0; 3])?;
    let given = [
        ("radius", number(py, radius)?),
        ("center", list(py, &center)?),
    ];
    surface(py, Surface::sphere(radius, center), "sphere", given)
}

/// Make an ellipsoid.
///
/// Parameters
/// ----------
/// semi_axes : array_like, shape (3,)
/// center : array_like, shape (3,), optional
///     From the origin of the body frame; that origin by default.
/// axes : array_like, shape (3, 3), optional
///     Rotation matrix whose columns are the directions of the semi-axes in the body frame; x, y, z by default.
///
/// Returns
/// -------
/// Surface
///
/// Raises
/// ------
/// PolhodeError
///     If a semi-axis is not positive, or `axes` is no rotation.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.ellipsoid((3, 2, 1)).contact((0, 1, 0))
/// array([ 0., -2.,  0.])
#[pyfunction]
#[pyo3(
    name = "surface_ellipsoid",
    signature = (semi_axes, center=Argument::default(), axes=None),
    text_signature = "(semi_axes, center=(0.0, 0.0, 0.0), axes=None)"
)]
pub(crate) fn ellipsoid(
    py: Python<'_>,
    semi_axes: &Bound<'_, PyAny>,
    center: Argument<'_>,
    axes: Option<&Bound<'_, PyAny>>,
) -> PyResult<PySurface> {
    let semi_axes: [f64; 3] = single(read(semi_axes, "semi_axes")?, "semi_axes")?;
    let center = vector(&center, "center", [0.0; 3])?;
    let (axes, kept) = rotation(py, axes)?;
    let given = [
        ("semi_axes", list(py, &semi_axes.into())?),
        ("center", list(py, &center)?),
        ("axes", kept),
    ];
    surface(
        py,
        Surface::ellipsoid(semi_axes, center, axes),
        "ellipsoid",
        given,
    )
}

/// Make a disk, which touches a plane with its sharp edge; a hoop is the same surface.
///
/// Parameters
/// ----------
/// radius : float
/// axis : array_like, shape (3,), optional
///     Normal to the disk, components in the body frame; z by default.
/// center : array_like, shape (3,), optional
///     From the origin of the body frame; that origin by default.
///
/// Returns
/// -------
/// Surface
///
/// Raises
/// ------
/// PolhodeError
///     If the radius is not positive, or the axis is zero.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.disk(0.5).curvatures((1, 0, 0))
/// array([ 2., inf])
#[pyfunction]
#[pyo3(
    name = "surface_disk",
    signature = (radius, axis=Argument::default(), center=Argument::default()),
    text_signature = "(radius, axis=(0.0, 0.0, 1.0), center=(0.0, 0.0, 0.0))"
)]
pub(crate) fn disk(
    py: Python<'_>,
    #[pyo3(from_py_with = read_scalar)] radius: f64,
    axis: Argument<'_>,
    center: Argument<'_>,
) -> PyResult<PySurface> {
    let axis = vector(&axis, "axis", [0.0, 0.0, 1.0])?;
    let center = vector(&center, "center", [0.0; 3])?;
    let given = [
        ("radius", number(py, radius)?),
        ("axis", list(py, &axis)?),
        ("center", list(py, &center)?),
    ];
    surface(py, Surface::disk(radius, axis, center), "disk", given)
}

/// Make a torus: a disk with a round edge.
///
/// Parameters
/// ----------
/// major_radius : float
///     Radius of the circle of centres about `axis`.
/// minor_radius : float
///     Radius of the edge.
/// axis : array_like, shape (3,), optional
///     Components in the body frame; z by default.
/// center : array_like, shape (3,), optional
///     From the origin of the body frame; that origin by default.
///
/// Returns
/// -------
/// Surface
///
/// Raises
/// ------
/// PolhodeError
///     If a radius is not positive, or the axis is zero.
///
/// Notes
/// -----
/// A plane touches the outer side alone, where the torus is convex.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.torus(0.5, 0.1).contact((1, 0, 0))
/// array([-0.6,  0. ,  0. ])
#[pyfunction]
#[pyo3(
    name = "surface_torus",
    signature = (major_radius, minor_radius, axis=Argument::default(), center=Argument::default()),
    text_signature = "(major_radius, minor_radius, axis=(0.0, 0.0, 1.0), center=(0.0, 0.0, 0.0))"
)]
pub(crate) fn torus(
    py: Python<'_>,
    #[pyo3(from_py_with = read_scalar)] major_radius: f64,
    #[pyo3(from_py_with = read_scalar)] minor_radius: f64,
    axis: Argument<'_>,
    center: Argument<'_>,
) -> PyResult<PySurface> {
    let axis = vector(&axis, "axis", [0.0, 0.0, 1.0])?;
    let center = vector(&center, "center", [0.0; 3])?;
    let given = [
        ("major_radius", number(py, major_radius)?),
        ("minor_radius", number(py, minor_radius)?),
        ("axis", list(py, &axis)?),
        ("center", list(py, &center)?),
    ];
    let made = Surface::torus(major_radius, minor_radius, axis, center);
    surface(py, made, "torus", given)
}

/// Make an elliptic paraboloid, as of a boat or a rattleback: ``z = -apex + x²/(2 radii[0]) + y²/(2 radii[1])``.
///
/// Parameters
/// ----------
/// radii : array_like, shape (2,)
///     Radii of curvature at the apex.
/// apex : float
///     How far the apex is below the origin of the body frame. The surface ends at its rim, z = 0.
/// axes : array_like, shape (3, 3), optional
///     Rotation matrix whose columns are the axes of the surface in the body frame; x, y, z by default.
///
/// Returns
/// -------
/// Surface
///
/// Raises
/// ------
/// PolhodeError
///     If a radius or `apex` is not positive, or `axes` is no rotation.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.paraboloid((0.5, 0.25), apex=0.1).curvatures((0, 0, 1))
/// array([2., 4.])
#[pyfunction]
#[pyo3(name = "surface_paraboloid", signature = (radii, apex, axes=None))]
pub(crate) fn paraboloid(
    py: Python<'_>,
    radii: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] apex: f64,
    axes: Option<&Bound<'_, PyAny>>,
) -> PyResult<PySurface> {
    let radii: [f64; 2] = single(read(radii, "radii")?, "radii")?;
    let (axes, kept) = rotation(py, axes)?;
    let given = [
        (
            "radii",
            radii.to_vec().into_pyobject(py)?.into_any().unbind(),
        ),
        ("apex", number(py, apex)?),
        ("axes", kept),
    ];
    surface(
        py,
        Surface::paraboloid(radii, apex, axes),
        "paraboloid",
        given,
    )
}

/// A cylinder or a cone, fixed in a body: a surface of straight lines, which lies on a plane along one of them.
///
/// Made by :func:`polhode.rolling.cylinder` and :func:`polhode.rolling.cone`, for
/// :meth:`polhode.RigidBody.rolling_motion`.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.cone(3, 4).line_of_contact((1, 0, 0))
/// array([[ 0.,  0.,  3.],
///        [-3.,  0., -1.]])
#[pyclass(name = "RuledSurface", module = "polhode.rolling", frozen)]
pub(crate) struct PyRuledSurface {
    surface: RuledSurface,
    /// The function that made it, and its arguments.
    function: &'static str,
    arguments: [(&'static str, Py<PyAny>); 4],
}

#[pymethods]
impl PyRuledSurface {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        call_of(py, self.function, &self.arguments)
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        parts_of(py, self.function, &self.arguments)
    }

    /// Compute the ends of the line on which the surface lies.
    ///
    /// Parameters
    /// ----------
    /// normal : array_like, shape (..., 3)
    ///     Normal of the plane, towards the body, components in the body frame. Its part along the axis does not
    ///     matter.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 2, 3)
    ///     Of a cone the apex first, of a cylinder the end to which its axis points; from the origin of the body
    ///     frame. NaN where the normal is along the axis.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import rolling
    /// >>> rolling.cylinder(0.5, 2).line_of_contact((0, 1, 0))
    /// array([[ 0. , -0.5,  1. ],
    ///        [ 0. , -0.5, -1. ]])
    fn line_of_contact<'py>(
        &self,
        py: Python<'py>,
        normal: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let normals = unit_normals(py, normal)?;
        let shape = [&normals.shape[..], &[2]].concat();
        let ends = (normals.rows.iter()).flat_map(|normal| self.surface.line_of_contact(normal));
        let rows = ends.collect();
        Ok(write(py, &Stack { shape, rows })?.into_any())
    }
}

/// Make a cylinder, which lies on a plane along a line.
///
/// Parameters
/// ----------
/// radius : float
/// height : float
///     Length along the axis.
/// axis : array_like, shape (3,), optional
///     Components in the body frame; z by default.
/// center : array_like, shape (3,), optional
///     Its middle, from the origin of the body frame; that origin by default.
///
/// Returns
/// -------
/// RuledSurface
///
/// Raises
/// ------
/// PolhodeError
///     If a length is not positive, or the axis is zero.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.cylinder(0.1, 0.5)
/// rolling.cylinder(radius=0.1, height=0.5, axis=[0.0, 0.0, 1.0], center=[0.0, 0.0, 0.0])
#[pyfunction]
#[pyo3(
    name = "ruled_cylinder",
    signature = (radius, height, axis=Argument::default(), center=Argument::default()),
    text_signature = "(radius, height, axis=(0.0, 0.0, 1.0), center=(0.0, 0.0, 0.0))"
)]
pub(crate) fn cylinder(
    py: Python<'_>,
    #[pyo3(from_py_with = read_scalar)] radius: f64,
    #[pyo3(from_py_with = read_scalar)] height: f64,
    axis: Argument<'_>,
    center: Argument<'_>,
) -> PyResult<PyRuledSurface> {
    ruled(
        py,
        "cylinder",
        RuledSurface::cylinder,
        [radius, height],
        [&axis, &center],
    )
}

/// Make a cone, which lies on a plane along a line from its apex to its rim.
///
/// Parameters
/// ----------
/// radius : float
///     Of the base.
/// height : float
/// axis : array_like, shape (3,), optional
///     From the base to the apex, components in the body frame; z by default.
/// center : array_like, shape (3,), optional
///     Its centroid, a quarter of the height above the base, from the origin of the body frame; that origin by
///     default, as for :func:`polhode.solids.cone`.
///
/// Returns
/// -------
/// RuledSurface
///
/// Raises
/// ------
/// PolhodeError
///     If a length is not positive, or the axis is zero.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.cone(0.1, 0.5)
/// rolling.cone(radius=0.1, height=0.5, axis=[0.0, 0.0, 1.0], center=[0.0, 0.0, 0.0])
#[pyfunction]
#[pyo3(
    name = "ruled_cone",
    signature = (radius, height, axis=Argument::default(), center=Argument::default()),
    text_signature = "(radius, height, axis=(0.0, 0.0, 1.0), center=(0.0, 0.0, 0.0))"
)]
pub(crate) fn cone(
    py: Python<'_>,
    #[pyo3(from_py_with = read_scalar)] radius: f64,
    #[pyo3(from_py_with = read_scalar)] height: f64,
    axis: Argument<'_>,
    center: Argument<'_>,
) -> PyResult<PyRuledSurface> {
    ruled(
        py,
        "cone",
        RuledSurface::cone,
        [radius, height],
        [&axis, &center],
    )
}

fn ruled(
    py: Python<'_>,
    function: &'static str,
    make: impl FnOnce(f64, f64, Vector3<f64>, Vector3<f64>) -> Result<RuledSurface, Error>,
    [radius, height]: [f64; 2],
    [axis, center]: [&Argument<'_>; 2],
) -> PyResult<PyRuledSurface> {
    let axis = vector(axis, "axis", [0.0, 0.0, 1.0])?;
    let center = vector(center, "center", [0.0; 3])?;
    let surface = make(radius, height, axis, center).map_err(|error| to_py(py, &error))?;
    Ok(PyRuledSurface {
        surface,
        function,
        arguments: [
            ("radius", number(py, radius)?),
            ("height", number(py, height)?),
            ("axis", list(py, &axis)?),
            ("center", list(py, &center)?),
        ],
    })
}

/// The states of bodies that roll in closed form, and what the plane does: arrays by name, of the shape of the stack and then that of `t`.
#[pyfunction]
pub(crate) fn rolling_states<'py>(
    body: &Bound<'py, PyRigidBody>,
    surface: &Bound<'py, PyAny>,
    omega: &Bound<'py, PyAny>,
    attitude: Option<&Bound<'py, PyAny>>,
    gravity: &Bound<'py, PyAny>,
    turntable: f64,
    t: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = body.py();
    let outside = if let Ok(surface) = surface.cast::<PySurface>() {
        Outside::Point(surface.get().surface)
    } else if let Ok(surface) = surface.cast::<PyRuledSurface>() {
        Outside::Line(surface.get().surface)
    } else {
        return Err(PyValueError::new_err(format!(
            "surface: expected rolling.sphere, rolling.cylinder or rolling.cone, got {}",
            surface.get_type()
        )));
    };
    let bodies = &body.get().bodies;
    let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
    let gravity: Stack<Vector3<f64>> = read(gravity, "gravity")?;
    let attitude = match attitude {
        None => Stack::one(None),
        given => read_attitude_exactly(given, "attitude")?.map(py, |q| Some(*q))?,
    };
    let grid = Broadcast::of(
        ["body", "omega", "attitude", "gravity"],
        [&bodies.shape, &omega.shape, &attitude.shape, &gravity.shape],
    )?;
    let motions = grid.try_map(py, |[b, w, q, g]| {
        RollingMotion::new(
            &bodies[b],
            &outside,
            &omega[w],
            attitude[q],
            gravity[g],
            turntable,
        )
    })?;
    let times = floats(t, "t")?;
    let shape = [&motions.shape[..], times.shape()].concat();
    memory::room("t", &shape, 2 * size_of::<RollingState>())?;
    let times = times.as_slice()?;
    for (row, motion) in motions.rows.iter().enumerate() {
        for &t in times {
            motion
                .reaches(t)
                .map_err(|error| at_row(&motions.shape, row, &to_py(py, &error), py))?;
        }
    }
    let interrupt = Interrupt::new(None);
    let mut rows = Vec::new();
    let is_complete = py.detach(|| {
        for motion in &motions.rows {
            for part in times.chunks(STATES_AT_ONCE) {
                rows.extend(motion.states(part));
                if interrupt.poll(None).is_break() {
                    return false;
                }
            }
        }
        true
    });
    interrupt.finish(py, is_complete)?;
    let found = Stack { shape, rows };
    let arrays = PyDict::new(py);
    arrays.set_item("omega", write_of(py, &found, |at| at.omega)?)?;
    arrays.set_item(
        "quaternion",
        write_of(py, &found, |at| components(&at.attitude))?,
    )?;
    arrays.set_item("position", write_of(py, &found, |at| at.position)?)?;
    arrays.set_item("velocity", write_of(py, &found, |at| at.velocity)?)?;
    arrays.set_item("force", write_of(py, &found, |at| at.force)?)?;
    arrays.set_item("pressure", write_of(py, &found, |at| at.pressure)?)?;
    let [from, to] = (times.iter().filter(|t| t.is_finite()))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], t| {
            [from.min(*t), to.max(*t)]
        });
    if motions
        .rows
        .iter()
        .all(|motion| motion.extremes(0.0, 0.0).is_some())
    {
        let of = |motion: &RollingMotion| (motion.extremes(from, to)).unwrap_or([[f64::NAN; 2]; 2]);
        let [most, least] = [0, 1].map(|which| write_of(py, &motions, |motion| of(motion)[which]));
        arrays.set_item("extremes", (most?, least?))?;
    }
    arrays.set_item("tips", write_any_of(py, &found, |at| at.tips)?)?;
    Ok(arrays)
}

/// Between looks at Ctrl-C.
const STATES_AT_ONCE: usize = 1 << 16;

/// The contact of a surface with a plane. Made by :func:`polhode.rolling.plane`.
///
/// Attributes
/// ----------
/// surface : Surface
/// normal : numpy.ndarray, shape (3,)
///     Unit normal of the plane, towards the body, in space.
/// point : numpy.ndarray, shape (3,)
///     A point of the plane, in space.
/// turntable : float
///     Rate of the plane about `normal` through `point`.
/// lift : str
///     What follows when the normal force falls through zero: "stop", "fly" or "hold".
/// law : str
///     "rolling", "sliding" or "dry".
/// friction : float or None
///     Coefficient of Coulomb's friction.
/// viscous : float, tuple or None
///     Coefficient of viscous friction.
/// resistance : Resistance or None
///     Resistance to rolling and pivoting.
///
/// Examples
/// --------
/// >>> from polhode import rolling
/// >>> rolling.plane(rolling.sphere(0.5), normal=(0, 3, 4)).normal
/// array([0. , 0.6, 0.8])
#[pyclass(name = "Contact", module = "polhode.rolling", frozen)]
pub(crate) struct PyContact {
    pub(crate) contact: Contact,
    /// Return the surface of the body.
    #[pyo3(get)]
    surface: Py<PySurface>,
}

#[pymethods]
impl PyContact {
    /// Return the unit normal of the plane, in space.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(write(py, &Stack::one(*self.contact.normal))?.into_any())
    }

    /// Return a point of the plane, in space.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(write(py, &Stack::one(self.contact.point))?.into_any())
    }

    /// Return the rate of the plane about its normal.
    #[getter]
    fn turntable(&self) -> f64 {
        self.contact.turntable
    }

    /// Return what follows when the body lifts off.
    #[getter]
    fn lift(&self) -> &'static str {
        match self.contact.lift {
            LiftOff::Stop => "stop",
            LiftOff::Fly => "fly",
            LiftOff::Hold => "hold",
        }
    }

    /// Return the law of the force of the plane.
    #[getter]
    fn law(&self) -> &'static str {
        match self.contact.law {
            Law::Rolling => "rolling",
            Law::Sliding(_) => "sliding",
            Law::Dry(_) => "dry",
        }
    }

    /// Return the coefficient of Coulomb's friction; None without it.
    #[getter]
    fn friction(&self) -> Option<f64> {
        match self.contact.law {
            Law::Dry(mu) | Law::Sliding(Friction::Coulomb(mu)) => Some(mu),
            _ => None,
        }
    }

    /// Return the coefficient of viscous friction as it was given; None without it.
    #[getter]
    fn viscous<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(match self.contact.law {
            Law::Sliding(Friction::Viscous(c)) => Some(c.into_pyobject(py)?.into_any()),
            Law::Sliding(Friction::ViscousNormal(k)) => {
                Some(("normal", k).into_pyobject(py)?.into_any())
            }
            _ => None,
        })
    }

    /// Return the resistance to rolling and pivoting; None without one.
    #[getter]
    fn resistance<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Resistance {
            viscous,
            pivoting,
            arm,
        } = self.contact.resistance;
        if !self.contact.resistance.acts() {
            return Ok(None);
        }
        (py.import("polhode.rolling")?.getattr("Resistance")?)
            .call1((viscous, pivoting, arm))
            .map(Some)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let surface = self.surface.bind(py).repr()?;
        let [normal, point] = [self.contact.normal.into_inner(), self.contact.point]
            .map(|vector| format!("{:?}", vector.as_slice()));
        let (turntable, lift) = (self.contact.turntable, self.lift());
        let law = match self.contact.law {
            Law::Rolling => String::new(),
            _ => format!("law='{}', ", self.law()),
        };
        let friction = match (self.friction(), self.viscous(py)?) {
            (Some(mu), _) => format!("friction={mu:?}, "),
            (_, Some(viscous)) => format!("viscous={}, ", viscous.repr()?),
            _ => String::new(),
        };
        let resistance = match self.resistance(py)? {
            Some(resistance) => format!("resistance=rolling.{}, ", resistance.repr()?),
            None => String::new(),
        };
        Ok(format!(
            "rolling.plane({surface}, {law}{friction}{resistance}normal={normal}, point={point}, turntable={turntable:?}, lift='{lift}')"
        ))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_parts")?;
        let parts = (
            self.surface.bind(py),
            self.normal(py)?,
            self.point(py)?,
            self.contact.turntable,
            self.lift(),
            self.law(),
            self.friction(),
            self.viscous(py)?,
            self.resistance(py)?,
        );
        Ok((restore, parts.into_pyobject(py)?))
    }

    /// Make the contact that `__reduce__` took apart; for pickle.
    #[staticmethod]
    #[expect(clippy::too_many_arguments, reason = "arguments in Python")]
    fn _from_parts(
        surface: &Bound<'_, PySurface>,
        normal: &Bound<'_, PyAny>,
        point: &Bound<'_, PyAny>,
        turntable: f64,
        lift: &str,
        law: &str,
        friction: Option<f64>,
        viscous: Option<&Bound<'_, PyAny>>,
        resistance: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let normal = single(read(normal, "normal")?, "normal")?;
        let point = single(read(point, "point")?, "point")?;
        let law = read_law(law, friction, viscous)?;
        let resistance = read_resistance(resistance)?;
        make_contact(surface, [normal, point], turntable, lift, (law, resistance))
    }
}

/// The resistance to rolling and pivoting.
fn read_resistance(resistance: Option<&Bound<'_, PyAny>>) -> PyResult<Resistance> {
    let Some(resistance) = resistance.filter(|given| !given.is_none()) else {
        return Ok(Resistance::default());
    };
    let (viscous, pivoting, arm) = resistance.extract::<(f64, f64, f64)>().map_err(|_| {
        PyValueError::new_err(format!(
            "resistance: expected one of rolling.resistance(viscous=, pivoting=, arm=), got {}",
            resistance.get_type()
        ))
    })?;
    Resistance::new(viscous, pivoting, arm).map_err(|error| to_py(resistance.py(), &error))
}

/// The law of a contact and its friction.
fn read_law(law: &str, friction: Option<f64>, viscous: Option<&Bound<'_, PyAny>>) -> PyResult<Law> {
    match (law, friction, viscous) {
        ("rolling", None, None) => Ok(Law::Rolling),
        ("rolling", ..) => Err(PyValueError::new_err(
            "friction, viscous: the law \"rolling\" takes whatever friction it needs; leave them out, or give law=\"dry\" or \"sliding\"",
        )),
        ("dry", Some(mu), None) => Ok(Law::Dry(mu)),
        ("dry", ..) => Err(PyValueError::new_err(
            "friction: the law \"dry\" needs the coefficient friction, and no viscous one",
        )),
        ("sliding", Some(mu), None) => Ok(Law::Sliding(Friction::Coulomb(mu))),
        ("sliding", None, Some(viscous)) => {
            if let Ok(c) = viscous.extract::<f64>() {
                return Ok(Law::Sliding(Friction::Viscous(c)));
            }
            match viscous.extract::<(String, f64)>() {
                Ok((word, k)) if word == "normal" => Ok(Law::Sliding(Friction::ViscousNormal(k))),
                _ => Err(PyValueError::new_err(format!(
                    "viscous: expected a number c of F = -c v, or (\"normal\", k) of F = -k N v, got {}",
                    viscous.repr()?
                ))),
            }
        }
        ("sliding", ..) => Err(PyValueError::new_err(
            "friction: the law \"sliding\" needs exactly one of friction and viscous; friction=0.0 for a smooth plane",
        )),
        _ => Err(PyValueError::new_err(format!(
            "law: expected \"rolling\", \"sliding\" or \"dry\", got \"{law}\""
        ))),
    }
}

/// Make the contact of a surface that rolls or slips on a plane.
///
/// Parameters
/// ----------
/// surface : Surface
///     The surface of the body.
/// law : {"rolling", "sliding", "dry"}, optional
///     * "rolling": without slipping, whatever force that takes.
///     * "sliding": with the slip v the force is ``N (n + f)``, where f is ``-friction v/|v|`` or ``-k v``, or the force across
///       the normal is ``-c v``. Coulomb's friction has no direction without slip: where the slip ceases the run
///       ends, with the status "roll".
///     * "dry": the body rolls while that takes no more than ``friction`` times the normal force, and slips with
///       Coulomb's friction else. Each change is an event, "slip" or "roll".
/// friction : float, optional
///     Coefficient of Coulomb's friction, for "sliding" and "dry"; 0.0 for a smooth plane.
/// viscous : float or tuple, optional
///     For "sliding": c of the force ``-c v``, in units of force over speed; or ``("normal", k)`` of ``-k N v``, in
///     units of time over length.
/// resistance : Resistance, optional
///     Resistance to rolling and pivoting, from :func:`resistance`; none by default.
/// normal : array_like, shape (3,), optional
///     Normal of the plane, towards the body, in space; z by default.
/// point : array_like, shape (3,), optional
///     A point of the plane, in space; the origin by default.
/// turntable : float, optional
///     Rate at which the plane turns about `normal` through `point`, in radians per unit of time; zero by
///     default.
/// lift : {"stop", "fly", "hold"}, optional
///     What follows when the normal force falls through zero, so that the plane would have to pull. "stop" ends
///     the run there, with the status "lift-off". "fly" goes on as free flight until the surface touches again,
///     and ends there with the status "landing": impacts are not computed. The force across the normal ceases with the
///     normal force; where it does not vanish with it, under the law "rolling" and with ``viscous=c``, the body may touch
///     again at once. "hold" goes on, as theory does, and
///     ``motion.contact.normal_force`` is negative for a while; not under the law "dry".
///
/// Returns
/// -------
/// Contact
///     For ``contact=`` of :meth:`polhode.RigidBody.simulate`.
///
/// Raises
/// ------
/// PolhodeError
///     If a number is not finite, a coefficient is negative or the normal is zero.
///
/// Examples
/// --------
/// A ball that is thrown without spin slips for ``2 v/(7 µ g)``, and then rolls with 5/7 of its speed:
///
/// >>> from polhode import loads, rolling, solids
/// >>> ball = solids.sphere(0.11, mass=7.0)
/// >>> alley = rolling.plane(rolling.sphere(0.11), law="dry", friction=0.04)
/// >>> gravity = loads.uniform_gravity((0, 0, -9.81))
/// >>> motion = ball.simulate([0, 8], omega=(0, 0, 0), velocity=(8, 0, 0), load=gravity, contact=alley)
/// >>> motion.events.t.round(6), round(2 * 8 / (7 * 0.04 * 9.81), 6)
/// (array([5.82496]), 5.82496)
///
/// A ball rolls down an incline with 5/7 of the acceleration of a body that glides:
///
/// >>> import numpy as np
/// >>> from polhode import loads, rolling, solids
/// >>> ball = solids.sphere(0.5, mass=2.0)
/// >>> incline = rolling.plane(rolling.sphere(0.5), normal=(0.6, 0, 0.8))
/// >>> gravity = loads.uniform_gravity((0, 0, -9.81))
/// >>> motion = ball.simulate([0, 1], omega=(0, 0, 0), load=gravity, contact=incline)
/// >>> round(float(np.linalg.norm(motion.velocity[-1]) / (9.81 * 0.6)), 12) == round(5 / 7, 12)
/// True
/// >>> motion.contact.friction_needed.round(6)
/// array([0.214286, 0.214286])
#[pyfunction]
#[pyo3(
    name = "rolling_plane",
    signature = (
        surface, *, law="rolling", friction=None, viscous=None, resistance=None, normal=Argument::default(), point=Argument::default(),
        turntable=0.0, lift="stop"
    ),
    text_signature = "(surface, *, law=\"rolling\", friction=None, viscous=None, resistance=None, normal=(0.0, 0.0, 1.0), point=(0.0, 0.0, 0.0), turntable=0.0, lift=\"stop\")"
)]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub(crate) fn plane(
    surface: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] law: &str,
    #[pyo3(from_py_with = read_scalar)] friction: Option<f64>,
    viscous: Option<&Bound<'_, PyAny>>,
    resistance: Option<&Bound<'_, PyAny>>,
    normal: Argument<'_>,
    point: Argument<'_>,
    #[pyo3(from_py_with = read_scalar)] turntable: f64,
    #[pyo3(from_py_with = read_scalar)] lift: &str,
) -> PyResult<PyContact> {
    let surface = surface.cast::<PySurface>().map_err(|_| {
        if surface.is_instance_of::<PyRuledSurface>() {
            return PyValueError::new_err(
                "surface: a cylinder or a cone touches a plane along a line, not in a point: RigidBody.rolling_motion(surface, ...) \
                 computes its motion in closed form",
            );
        }
        PyValueError::new_err(format!(
            "surface: expected a surface of polhode.rolling, as rolling.sphere(radius), got {}",
            surface.get_type()
        ))
    })?;
    let normal = vector(&normal, "normal", [0.0, 0.0, 1.0])?;
    let point = vector(&point, "point", [0.0; 3])?;
    let law = (
        read_law(law, friction, viscous)?,
        read_resistance(resistance)?,
    );
    make_contact(surface, [normal, point], turntable, lift, law)
}

fn make_contact(
    surface: &Bound<'_, PySurface>,
    [normal, point]: [Vector3<f64>; 2],
    turntable: f64,
    lift: &str,
    (law, resistance): (Law, Resistance),
) -> PyResult<PyContact> {
    let lift = match lift {
        "stop" => LiftOff::Stop,
        "fly" => LiftOff::Fly,
        "hold" => LiftOff::Hold,
        _ => {
            return Err(PyValueError::new_err(format!(
                "lift: expected \"stop\", \"fly\" or \"hold\", got \"{lift}\""
            )));
        }
    };
    let contact = Contact::rolling(surface.get().surface, normal, point, turntable, lift)
        .and_then(|contact| contact.with_law(law))
        .map(|contact| contact.with_resistance(resistance))
        .map_err(|error| to_py(surface.py(), &error))?;
    Ok(PyContact {
        contact,
        surface: surface.clone().unbind(),
    })
}

/// The steady motions of a body of revolution: the columns of `polhode.rolling.Steady` but for the eigenvalues, with λ².
#[pyfunction]
pub(crate) fn rolling_steady<'py>(
    body: &Bound<'py, PyRigidBody>,
    surface: &Bound<'py, PySurface>,
    inclination: f64,
    gravity: &Bound<'py, PyAny>,
    turn: Option<f64>,
    spin: Option<f64>,
) -> PyResult<Vec<Bound<'py, PyTuple>>> {
    let py = body.py();
    let rate = match (turn, spin) {
        (Some(turn), None) => Rate::Turn(turn),
        (None, Some(spin)) => Rate::Spin(spin),
        _ => {
            return Err(PyTypeError::new_err(
                "steady: give exactly one of turn= and spin=",
            ));
        }
    };
    let gravity = single(read(gravity, "gravity")?, "gravity")?;
    let found = steady(
        one(body)?,
        &surface.get().surface,
        inclination,
        &gravity,
        rate,
    );
    let found = found.map_err(|error| to_py(py, &error))?;
    (found.iter())
        .map(|steady| {
            let columns = (
                write(py, &Stack::one(steady.omega))?,
                write(py, &Stack::one(components(&steady.attitude)))?,
                steady.turn,
                steady.spin,
                steady.radius,
                steady.friction_needed,
                steady.squared_rate,
            );
            columns.into_pyobject(py)
        })
        .collect()
}

/// The rate from which an upright body of revolution is stable.
#[pyfunction]
pub(crate) fn rolling_critical_rate(
    body: &Bound<'_, PyRigidBody>,
    surface: &Bound<'_, PySurface>,
    gravity: &Bound<'_, PyAny>,
    motion: &str,
) -> PyResult<f64> {
    let motion = match motion {
        "rolling" => Upright::Rolling,
        "spinning" => Upright::Spinning,
        _ => {
            return Err(PyValueError::new_err(format!(
                "motion: expected \"rolling\" or \"spinning\", got \"{motion}\""
            )));
        }
    };
    let gravity = single(read(gravity, "gravity")?, "gravity")?;
    critical_rate(one(body)?, &surface.get().surface, &gravity, motion)
        .map_err(|error| to_py(body.py(), &error))
}

/// The fields of `polhode.rolling.TippeTop` after the verdict.
#[pyfunction]
pub(crate) fn rolling_tippe_top(
    body: &Bound<'_, PyRigidBody>,
    surface: &Bound<'_, PySurface>,
    spin: f64,
    gravity: &Bound<'_, PyAny>,
) -> PyResult<[f64; 4]> {
    let gravity = single(read(gravity, "gravity")?, "gravity")?;
    let found = tippe_top(one(body)?, &surface.get().surface, spin, &gravity)
        .map_err(|error| to_py(body.py(), &error))?;
    Ok([
        found.cos_theta,
        found.jellett,
        found.upright_unstable_beyond,
        found.inverted_stable_beyond,
    ])
}

/// The growth rates and frequencies of an upright spin.
#[pyfunction]
pub(crate) fn rolling_modes(
    body: &Bound<'_, PyRigidBody>,
    surface: &Bound<'_, PySurface>,
    gravity: &Bound<'_, PyAny>,
    rate: f64,
) -> PyResult<[[f64; 2]; 2]> {
    let gravity = single(read(gravity, "gravity")?, "gravity")?;
    let found = modes(one(body)?, &surface.get().surface, &gravity, rate)
        .map_err(|error| to_py(body.py(), &error))?;
    Ok([found.growth_rates, found.frequencies])
}

/// The one body where there must be no stack.
fn one<'a>(body: &'a Bound<'_, PyRigidBody>) -> PyResult<&'a RigidBody> {
    let bodies = &body.get().bodies;
    if bodies.is_one() {
        return Ok(&bodies[0]);
    }
    Err(PyValueError::new_err(format!(
        "body: expected one body, got a stack of shape {}; ask body by body",
        tuple(&bodies.shape)
    )))
}

/// The gravity of a load that a contact can be simulated with.
pub(crate) fn gravity_of(py: Python<'_>, load: &PyLoad, terms: &[Term]) -> PyResult<Vector3<f64>> {
    let alone = if load.is_analytic() {
        gravity_alone(terms)
    } else {
        None
    };
    alone.ok_or_else(|| {
        let message = "load: a body on a plane is simulated under uniform gravity alone; give loads.uniform_gravity(g), \
                       or leave contact out";
        new(py, "ContactError", message.to_owned())
    })
}

/// The argument `contact` of a run.
pub(crate) fn read_contact<'a, 'py>(
    contact: Option<&'a Bound<'py, PyAny>>,
) -> PyResult<Option<&'a Bound<'py, PyContact>>> {
    let Some(contact) = contact.filter(|given| !given.is_none()) else {
        return Ok(None);
    };
    contact.cast::<PyContact>().map(Some).map_err(|_| {
        PyValueError::new_err(format!(
            "contact: expected a contact, as rolling.plane(rolling.sphere(radius)), got {}",
            contact.get_type()
        ))
    })
}

/// A motion of bodies on a plane, row by row.
struct Rows {
    bodies: Stack<RigidBody>,
    contact: Contact,
    gravity: Stack<Vector3<f64>>,
    phases: [Stack<Vector3<f64>>; 3],
    attitudes: Stack<UnitQuaternion<f64>>,
}

impl Rows {
    fn read(
        body: &Bound<'_, PyRigidBody>,
        contact: &Bound<'_, PyContact>,
        load: Option<&Bound<'_, PyLoad>>,
        [omega, quaternion, position, velocity]: [&Bound<'_, PyAny>; 4],
    ) -> PyResult<Self> {
        let py = body.py();
        let gravity = match load {
            None => Stack::one(Vector3::zeros()),
            Some(load) => {
                let terms = load.get().terms(py)?;
                let rows = (terms.rows.iter()).map(|terms| gravity_of(py, load.get(), terms));
                Stack {
                    rows: rows.collect::<PyResult<_>>()?,
                    shape: terms.shape,
                }
            }
        };
        let bodies = &body.get().bodies;
        Ok(Self {
            bodies: Stack {
                shape: bodies.shape.clone(),
                rows: bodies.rows.clone(),
            },
            contact: contact.get().contact,
            gravity,
            phases: [
                read(omega, "omega")?,
                read(position, "position")?,
                read(velocity, "velocity")?,
            ],
            // States after the end of a run are not numbers.
            attitudes: read_quaternion(quaternion, "quaternion")?.map(py, |&[x, y, z, w]| {
                UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
            })?,
        })
    }

    /// Compute what the plane does to rows that roll, slip or fly: 0, 1 or 2.
    fn instants(&self, py: Python<'_>, phases: &Stack<f64>) -> PyResult<Stack<force::Instant>> {
        self.map(py, phases, |body, contact, gravity, state, number| {
            let phase = match number {
                0.0 => ContactPhase::Rolling,
                2.0 => ContactPhase::Flying,
                _ => ContactPhase::Sliding,
            };
            force::instant(body, contact, gravity, state, phase)
        })
    }

    fn map<T: Clone + Send>(
        &self,
        py: Python<'_>,
        numbers: &Stack<f64>,
        of: impl Fn(&RigidBody, &Contact, &Vector3<f64>, &Phase, f64) -> T + Sync,
    ) -> PyResult<Stack<T>> {
        let [omega, position, velocity] = &self.phases;
        let grid = Broadcast::of(
            [
                "body",
                "load",
                "omega",
                "quaternion",
                "position",
                "velocity",
                "phases",
            ],
            [
                &self.bodies.shape,
                &self.gravity.shape,
                &omega.shape,
                &self.attitudes.shape,
                &position.shape,
                &velocity.shape,
                &numbers.shape,
            ],
        )?;
        grid.try_map(py, |[b, g, w, q, r, v, s]| {
            let phase = Phase {
                attitude: self.attitudes[q],
                omega: omega[w],
                position: position[r],
                velocity: velocity[v],
                internal_state: Box::default(),
            };
            let (body, gravity) = (&self.bodies[b], &self.gravity[g]);
            Ok(of(body, &self.contact, gravity, &phase, numbers[s]))
        })
    }
}

#[pymethods]
impl PyRigidBody {
    /// The motion of a homogeneous ball, or of a cylinder or a cone that lies on a plane, in closed form.
    ///
    /// The plane is z = 0. Where it leans, gravity leans instead. The body rolls without slipping, whatever
    /// friction that takes.
    ///
    /// Parameters
    /// ----------
    /// surface : Surface or RuledSurface
    ///     `rolling.sphere` of a body with equal moments and its centre of mass at the centre; `rolling.cylinder` of one with
    ///     its centre of mass on the axis; `rolling.cone` of one with equal moments across the axis too.
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity at t = 0, components in the body frame; of a cylinder or a cone along its line of
    ///     contact.
    /// attitude : array_like, shape (..., 4), or rotation, optional
    ///     R_NB at t = 0: unit quaternions (x, y, z, w), or anything with ``as_quat()``. By default the identity
    ///     of a ball; the axis of a cylinder is along x, and the line of contact of a cone goes from its apex along x.
    /// gravity : array_like, shape (..., 3), optional
    ///     Components in space; (0, 0, -9.81) by default. Its third component is negative.
    /// turntable : float, optional
    ///     Rate at which the plane turns about z; zero by default, and for a cylinder or a cone.
    ///
    /// Returns
    /// -------
    /// RollingMotion
    ///     Bodies, angular velocities, attitudes and gravities broadcast together. A ball and a cylinder touch at
    ///     the origin below their centre of mass at t = 0; the apex of a cone rests at the origin.
    ///
    /// Raises
    /// ------
    /// ContactError
    ///     For a body without closed form.
    /// PolhodeError
    ///     If the body does not lie on the plane, ω is not along the line of contact, or gravity does not press.
    ///
    /// Examples
    /// --------
    /// A ball on a turntable goes in circles with 2/7 of its rate:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import rolling, solids
    /// >>> ball = solids.sphere(0.02, mass=0.1)
    /// >>> motion = ball.rolling_motion(rolling.sphere(0.02), (0, 5, 0), turntable=3.0)
    /// >>> motion.at([0, 7 / 2 * 2 * np.pi / 3.0]).position.round(12) + 0.0
    /// array([[0.  , 0.  , 0.02],
    ///        [0.  , 0.  , 0.02]])
    #[pyo3(signature = (surface, omega, attitude=None, gravity=None, turntable=0.0))]
    #[pyo3(
        text_signature = "($self, surface, omega, attitude=None, gravity=(0.0, 0.0, -9.81), turntable=0.0)"
    )]
    fn rolling_motion<'py>(
        slf: &Bound<'py, Self>,
        surface: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        attitude: Option<&Bound<'py, PyAny>>,
        gravity: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = read_scalar)] turntable: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        (slf.py().import("polhode.motion.rolling")?)
            .getattr("RollingMotion")?
            .call_method1(
                "_of_start",
                (slf, surface, omega, attitude, gravity, turntable),
            )
    }
}

/// The contact at every state of a motion: arrays by name.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "arguments in Python")]
pub(crate) fn contact_history<'py>(
    body: &Bound<'py, PyRigidBody>,
    contact: &Bound<'py, PyContact>,
    load: Option<&Bound<'py, PyLoad>>,
    omega: &Bound<'py, PyAny>,
    quaternion: &Bound<'py, PyAny>,
    position: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
    phases: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = body.py();
    let rows = Rows::read(body, contact, load, [omega, quaternion, position, velocity])?;
    let found = rows.instants(py, &read(phases, "phases")?)?;
    let arrays = PyDict::new(py);
    arrays.set_item("point", write_of(py, &found, |at| at.point)?)?;
    arrays.set_item(
        "point_in_body",
        write_of(py, &found, |at| at.point_in_body)?,
    )?;
    arrays.set_item("force", write_of(py, &found, |at| at.force)?)?;
    arrays.set_item("couple", write_of(py, &found, |at| at.couple)?)?;
    arrays.set_item("normal_force", write_of(py, &found, |at| at.normal_force)?)?;
    arrays.set_item(
        "friction_needed",
        write_of(py, &found, |at| at.friction_needed)?,
    )?;
    arrays.set_item("slip", write_of(py, &found, |at| at.slip)?)?;
    arrays.set_item("power", write_of(py, &found, |at| at.power)?)?;
    arrays.set_item("residual", write_of(py, &found, |at| at.residual)?)?;
    Ok(arrays)
}

/// What a motion keeps at every state, by name; None for what its case does not have.
#[pyfunction]
pub(crate) fn contact_invariants<'py>(
    body: &Bound<'py, PyRigidBody>,
    contact: &Bound<'py, PyContact>,
    load: Option<&Bound<'py, PyLoad>>,
    omega: &Bound<'py, PyAny>,
    quaternion: &Bound<'py, PyAny>,
    position: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = body.py();
    let rows = Rows::read(body, contact, load, [omega, quaternion, position, velocity])?;
    let found: Stack<ContactInvariants> =
        rows.map(py, &Stack::one(0.0), |body, contact, gravity, phase, _| {
            invariants::contact_invariants(body, contact, gravity, phase)
        })?;
    let arrays = PyDict::new(py);
    let put = |name: &str, of: fn(&ContactInvariants) -> Option<f64>| -> PyResult<()> {
        if found.rows.iter().all(|kept| of(kept).is_none()) {
            return arrays.set_item(name, py.None());
        }
        let values = write_of(py, &found, |kept| of(kept).unwrap_or(f64::NAN))?;
        arrays.set_item(name, values)
    };
    put("jellett", |kept| kept.jellett)?;
    put("routh", |kept| kept.routh)?;
    if found.rows.iter().all(|kept| kept.chaplygin.is_none()) {
        arrays.set_item("chaplygin", py.None())?;
    } else {
        let nan = Vector3::repeat(f64::NAN);
        let values = write_of(py, &found, |kept| kept.chaplygin.unwrap_or(nan))?;
        arrays.set_item("chaplygin", values)?;
    }
    Ok(arrays)
}

fn surface<const N: usize>(
    py: Python<'_>,
    made: Result<Surface, Error>,
    function: &'static str,
    arguments: [(&'static str, Py<PyAny>); N],
) -> PyResult<PySurface> {
    Ok(PySurface {
        surface: made.map_err(|error| to_py(py, &error))?,
        function,
        arguments: arguments.into(),
    })
}

fn number(py: Python<'_>, number: f64) -> PyResult<Py<PyAny>> {
    Ok(number.into_pyobject(py)?.into_any().unbind())
}

fn list(py: Python<'_>, vector: &Vector3<f64>) -> PyResult<Py<PyAny>> {
    Ok(vector
        .as_slice()
        .to_vec()
        .into_pyobject(py)?
        .into_any()
        .unbind())
}

fn vector(given: &Argument<'_>, name: &str, default: [f64; 3]) -> PyResult<Vector3<f64>> {
    single(read_or(given, name, default.into())?, name)
}

/// A rotation that may be left out, as a matrix and as it is kept for pickle.
fn rotation(
    py: Python<'_>,
    axes: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Option<Matrix3<f64>>, Py<PyAny>)> {
    let Some(axes) = axes else {
        return Ok((None, py.None()));
    };
    let matrix: Matrix3<f64> = single(read(axes, "axes")?, "axes")?;
    let rows: Vec<Vec<f64>> = (matrix.row_iter())
        .map(|row| row.iter().copied().collect())
        .collect();
    Ok((Some(matrix), rows.into_pyobject(py)?.into_any().unbind()))
}

/// The one item where there must be no stack.
fn single<T: Item + Copy>(stack: Stack<T>, name: &str) -> PyResult<T> {
    if stack.is_one() {
        return Ok(stack[0]);
    }
    let tail: Vec<String> = T::TAIL.iter().map(usize::to_string).collect();
    Err(PyValueError::new_err(format!(
        "{name}: expected shape ({}), got {}",
        tail.join(", ") + if tail.len() == 1 { "," } else { "" },
        tuple(&[&stack.shape[..], T::TAIL].concat())
    )))
}
