//! The class `Load`: analytic terms, and Python functions.

use nalgebra::{UnitQuaternion, Vector3};
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::error::Kind;
use polhode::motion::attitude::{components, from_components};
use polhode::motion::loads::{Frame, Term, Torque};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyNotImplemented, PyTuple};

use crate::arrays::{read, read_quaternion, write};
use crate::errors::{at_row, new, to_py};
use crate::kinematics::parse_frame;
use crate::stack::{Broadcast, Stack, tuple};

/// What acts on a body: a sum of terms. Made by the functions of :mod:`polhode.loads`.
///
/// Examples
/// --------
/// >>> from polhode import loads
/// >>> loads.constant_torque((0, 0, 1)) + loads.constant_torque((0, 2, 0), frame="space")
/// <Load of 2 terms>
#[pyclass(name = "Load", module = "polhode.loads", frozen)]
#[derive(Default)]
pub(crate) struct PyLoad {
    pub(crate) terms: Vec<Term>,
    pub(crate) callbacks: Vec<Py<PyAny>>,
}

impl PyLoad {
    pub(crate) fn copied(&self, py: Python<'_>) -> Self {
        Self {
            terms: self.terms.clone(),
            callbacks: self
                .callbacks
                .iter()
                .map(|callback| callback.clone_ref(py))
                .collect(),
        }
    }

    /// The load as a torque that calls Python.
    pub(crate) fn calling<'a, 'py>(&'a self, py: Python<'py>) -> CallingTorque<'a, 'py> {
        CallingTorque { load: self, py }
    }
}

#[pymethods]
impl PyLoad {
    /// Torque of the load about the reference point of the motion, at a time and a state.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (...)
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// quaternion : array_like, shape (..., 4), or rotation
    ///     Attitude R_NB as (x, y, z, w), or anything with ``as_quat()``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     Components in the body frame; not a number where the quaternion is none.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import loads
    /// >>> upside_down = (1, 0, 0, 0)
    /// >>> loads.constant_torque((0, 2, 1), frame="space").torque(0.0, (0, 0, 0), upside_down)
    /// array([ 0., -2., -1.])
    fn torque<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        quaternion: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let t: Stack<f64> = read(t, "t")?;
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let quaternion = read_quaternion(quaternion, "quaternion")?;
        let shapes = [&t.shape[..], &omega.shape, &quaternion.shape];
        let grid = Broadcast::of(["t", "omega", "quaternion"], shapes)?;
        let mut torque = self.calling(py);
        let rows = (grid.rows().enumerate())
            .map(|(row, [k, w, q])| {
                if quaternion[q].iter().any(|x| x.is_nan()) {
                    return Ok(Vector3::repeat(f64::NAN));
                }
                from_components("quaternion", &quaternion[q])
                    .map_err(Fault::Core)
                    .and_then(|attitude| torque.torque(t[k], &omega[w], &attitude))
                    .map_err(|fault| match fault {
                        Fault::Core(error) => at_row(&grid.shape, row, &to_py(py, &error), py),
                        Fault::Python(error) => error,
                    })
            })
            .collect::<PyResult<_>>()?;
        let shape = grid.shape;
        write(py, &Stack { shape, rows })
    }

    fn __add__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let (mut sum, other) = (self.copied(py), other.get().copied(py));
        sum.terms.extend(other.terms);
        sum.callbacks.extend(other.callbacks);
        Ok(sum.into_pyobject(py)?.into_any())
    }

    /// The terms as the functions that make them, with their arguments; for pickle.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_parts")?;
        let mut parts = Vec::new();
        for term in &self.terms {
            let Term::ConstantTorque { vector, frame } = term else {
                return Err(PyTypeError::new_err("this load cannot be pickled"));
            };
            let frame = match frame {
                Frame::Body => "body",
                Frame::Space => "space",
            };
            let arguments = (write(py, &Stack::one(*vector))?, frame);
            parts.push(("constant_torque", arguments).into_pyobject(py)?);
        }
        for callback in &self.callbacks {
            parts.push(("torque_callback", (callback,)).into_pyobject(py)?);
        }
        Ok((restore, PyTuple::new(py, [parts])?))
    }

    /// The load that `__reduce__` took apart.
    #[staticmethod]
    fn _from_parts(py: Python<'_>, parts: Vec<(String, Bound<'_, PyTuple>)>) -> PyResult<Self> {
        let module = py.import("polhode.loads")?;
        let mut sum = Self::default();
        for (name, arguments) in parts {
            let made = module.getattr(name)?.call1(arguments)?;
            let part = made.cast::<Self>()?.get().copied(py);
            sum.terms.extend(part.terms);
            sum.callbacks.extend(part.callbacks);
        }
        Ok(sum)
    }

    fn __repr__(&self) -> String {
        match self.terms.len() + self.callbacks.len() {
            1 => "<Load of 1 term>".to_owned(),
            count => format!("<Load of {count} terms>"),
        }
    }
}

/// A torque that stays constant, about the reference point of the motion.
///
/// Parameters
/// ----------
/// vector : array_like, shape (3,)
/// frame : {"body", "space"}, optional
///     Whose axes the components refer to: a torque constant in the body turns with it, one constant
///     in space keeps its direction.
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// >>> from polhode import loads, solids
/// >>> flywheel = solids.cylinder(radius=1.0, height=0.2, mass=4.0)
/// >>> flywheel.simulate([0, 5], omega=(0, 0, 0), load=loads.constant_torque((0, 0, 2))).omega[-1].round(9)
/// array([0., 0., 5.])
#[pyfunction]
#[pyo3(signature = (vector, frame="body"))]
pub(crate) fn constant_torque(
    py: Python<'_>,
    vector: &Bound<'_, PyAny>,
    frame: &str,
) -> PyResult<PyLoad> {
    let frame = parse_frame(frame)?;
    let vector: Stack<Vector3<f64>> = read(vector, "vector")?;
    if !vector.is_one() {
        let shape = [&vector.shape[..], &[3]].concat();
        return Err(PyValueError::new_err(format!(
            "vector: expected shape (3,), got {}",
            tuple(&shape)
        )));
    }
    let term = Term::constant_torque(&vector[0], frame).map_err(|error| to_py(py, &error))?;
    Ok(PyLoad {
        terms: vec![term],
        callbacks: Vec::new(),
    })
}

/// A torque computed by a Python function.
///
/// Parameters
/// ----------
/// function : callable
///     ``function(t, omega, quaternion)`` returns the torque about the reference point of the motion as
///     three numbers in the body frame, given the time, the angular velocity in the body frame, shape
///     (3,), and the attitude R_NB as (x, y, z, w), shape (4,).
///
/// Returns
/// -------
/// Load
///
/// Examples
/// --------
/// A body slowed down by a medium:
///
/// >>> from polhode import loads, solids
/// >>> ball = solids.sphere(1.0, mass=2.5)
/// >>> drag = loads.torque_callback(lambda t, omega, quaternion: -0.1 * omega)
/// >>> ball.simulate([0, 10], omega=(0, 0, 1), load=drag).omega[-1].round(6)
/// array([0.      , 0.      , 0.367879])
#[pyfunction]
pub(crate) fn torque_callback(function: &Bound<'_, PyAny>) -> PyResult<PyLoad> {
    if !function.is_callable() {
        return Err(PyTypeError::new_err(format!(
            "function: expected a callable, got {}",
            function.get_type()
        )));
    }
    Ok(PyLoad {
        terms: Vec::new(),
        callbacks: vec![function.clone().unbind()],
    })
}

/// What may go wrong while a load that calls Python is integrated.
pub(crate) enum Fault {
    /// In the core.
    Core(Error),
    /// In the function, whose exception this is.
    Python(PyErr),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Core(error)
    }
}

impl Fault {
    /// As an exception.
    pub(crate) fn into_py(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Core(error) => to_py(py, &error),
            Self::Python(error) => error,
        }
    }

    /// The exception, unless it is the integration itself that failed.
    pub(crate) fn not_of_integration(&self, py: Python<'_>) -> Option<PyErr> {
        match self {
            Self::Core(error) if error.kind() == Kind::Integration => None,
            Self::Core(error) => Some(to_py(py, error)),
            Self::Python(error) => Some(error.clone_ref(py)),
        }
    }
}

/// A load that calls Python.
pub(crate) struct CallingTorque<'a, 'py> {
    load: &'a PyLoad,
    py: Python<'py>,
}

impl Torque for CallingTorque<'_, '_> {
    type Error = Fault;

    fn torque(
        &mut self,
        t: f64,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Vector3<f64>, Fault> {
        let analytic = (&mut &self.load.terms[..]).torque(t, omega, attitude)?;
        self.load
            .callbacks
            .iter()
            .try_fold(analytic, |sum, callback| {
                let torque = call(self.py, callback, t, omega, attitude).map_err(Fault::Python)?;
                Ok(sum + torque)
            })
    }
}

fn call(
    py: Python<'_>,
    callback: &Py<PyAny>,
    t: f64,
    omega: &Vector3<f64>,
    attitude: &UnitQuaternion<f64>,
) -> PyResult<Vector3<f64>> {
    let arguments = (
        t,
        write(py, &Stack::one(*omega))?,
        write(py, &Stack::one(components(attitude)))?,
    );
    let returned = callback.bind(py).call1(arguments)?;
    let torque: Stack<Vector3<f64>> = read(&returned, "the torque that the callback returned")?;
    if !torque.is_one() {
        let shape = tuple(&[&torque.shape[..], &[3]].concat());
        let message =
            format!("the torque that the callback returned: expected shape (3,), got {shape}");
        return Err(PyValueError::new_err(message));
    }
    if let Some(&value) = torque[0].iter().find(|x| !x.is_finite()) {
        let message = format!(
            "the torque that the callback returned must be finite, got {value} at t = {t:?}"
        );
        return Err(new(py, "PolhodeError", message));
    }
    Ok(torque[0])
}
