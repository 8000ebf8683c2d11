//! The classes `Gyrostat` and `GyrostatMotion`: bodies with momentum inside, and their exact motions.

pub(crate) mod motion;
mod steady;

use nalgebra::{Matrix3, Vector3};
use polhode::DoubleDouble;
use polhode::motion::gyrostat::{Gyrostat, InternalMomentum};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{in_slabs, read, write, write_of};
use crate::body::PyRigidBody;
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

/// A gyrostat, or a stack of them: a rigid body with wheels or rotors that carry angular momentum.
///
/// Made by `RigidBody.gyrostat`. The object is immutable.
///
/// Attributes
/// ----------
/// body : RigidBody
///     The body, or the stack of them, with its wheels locked.
/// momentum : numpy.ndarray, shape (..., 3)
///     Angular momentum inside while the body does not turn, components in the body frame.
/// inertia : numpy.ndarray, shape (..., 3, 3)
///     The tensor of the motion: that of the body less ``J a aᵀ`` of free wheels.
/// wheels : tuple of Wheel
///     The wheels.
/// shape : tuple of int
///     Shape of the stack.
///
/// Examples
/// --------
/// >>> import polhode
/// >>> body = polhode.RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
/// >>> gyrostat = body.gyrostat(momentum=(0.0, 0.3, 0.0))
/// >>> gyrostat.free_motion((0.01, 1.0, 0.0)).at(10.0).omega.round(6)
/// array([ 0.122266,  0.971115, -0.199019])
#[pyclass(name = "Gyrostat", module = "polhode", frozen)]
pub(crate) struct PyGyrostat {
    #[pyo3(get)]
    pub(crate) body: Py<PyRigidBody>,
    given: Stack<Vector3<f64>>,
    #[pyo3(get)]
    wheels: Py<PyTuple>,
    pub(crate) gyrostats: Stack<Gyrostat>,
}

impl PyGyrostat {
    fn new(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        given: Stack<Vector3<f64>>,
        wheels: &Bound<'_, PyTuple>,
    ) -> PyResult<Self> {
        let mut inside = Broadcast::of(["momentum"], [&given.shape])?
            .try_map(py, |[m]| InternalMomentum::of(&given[m]))?;
        for (k, wheel) in wheels.iter().enumerate() {
            inside = with_wheel(py, &inside, &wheel, k)?;
        }
        let bodies = &body.get().bodies;
        let gyrostats = Broadcast::of(["body", "momentum"], [&bodies.shape, &inside.shape])?
            .try_map(py, |[b, h]| Gyrostat::of(&bodies[b], &inside[h]))?;
        Ok(Self {
            body,
            given,
            wheels: wheels.clone().unbind(),
            gyrostats,
        })
    }
}

/// With what a wheel of Python adds.
fn with_wheel(
    py: Python<'_>,
    inside: &Stack<InternalMomentum>,
    wheel: &Bound<'_, PyAny>,
    k: usize,
) -> PyResult<Stack<InternalMomentum>> {
    let part = |name: &str| {
        wheel.getattr(name).map_err(|_| {
            PyTypeError::new_err(format!(
                "wheels[{k}]: expected what polhode.wheel(axis=, inertia=, ...) makes, got {}",
                wheel
                    .get_type()
                    .name()
                    .map_or_else(|_| "something else".to_owned(), |name| name.to_string())
            ))
        })
    };
    let axis: Stack<Vector3<f64>> = read(&part("axis")?, "axis")?;
    let inertia: Stack<f64> = read(&part("inertia")?, "inertia")?;
    let momentum: Stack<f64> = read(&part("momentum")?, "momentum")?;
    let mode: String = part("mode")?.extract()?;
    let is_free = match mode.as_str() {
        "free" => true,
        "held" => false,
        _ => {
            return Err(PyValueError::new_err(format!(
                "wheels[{k}].mode: expected 'free' or 'held', got {mode:?}"
            )));
        }
    };
    let shapes = [
        &inside.shape[..],
        &axis.shape,
        &inertia.shape,
        &momentum.shape,
    ];
    Broadcast::of(["wheels", "axis", "inertia", "momentum"], shapes)?.try_map(py, |[i, a, j, h]| {
        inside[i].with(&axis[a], inertia[j], momentum[h], is_free)
    })
}

#[pymethods]
impl PyRigidBody {
    /// A gyrostat: this body with constant angular momentum inside.
    ///
    /// Parameters
    /// ----------
    /// momentum : array_like, shape (..., 3), optional
    ///     Angular momentum relative to the body that is held constant, components in the body frame.
    /// wheels : sequence of Wheel, optional
    ///     Wheels, made by :func:`polhode.wheel`. The inertia of this body includes them as if they were
    ///     locked.
    ///
    /// Returns
    /// -------
    /// Gyrostat
    ///     Bodies, momenta and wheels broadcast together.
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     When free wheels have a larger moment of inertia than the body.
    ///
    /// Notes
    /// -----
    /// If h is held constant, the equation of motion is ``I ω̇ + ω×(I ω + h) = 0``. For a free wheel ``h = J
    /// (Ω + a·ω)`` is constant instead, and I is replaced by ``I − J a aᵀ``.
    ///
    /// Examples
    /// --------
    /// >>> import polhode
    /// >>> body = polhode.RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> wheel = polhode.wheel(axis=(0, 1, 0), inertia=0.1, rate=50.0)
    /// >>> motion = body.gyrostat(wheels=[wheel]).free_motion((0.1, 0.2, 0.3))
    /// >>> motion.mode, round(motion.period, 6)
    /// ('single', 1.966414)
    #[pyo3(signature = (momentum=None, *, wheels=None))]
    fn gyrostat(
        slf: Py<Self>,
        py: Python<'_>,
        momentum: Option<&Bound<'_, PyAny>>,
        wheels: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyGyrostat> {
        let given = match momentum {
            Some(momentum) => read(momentum, "momentum")?,
            None => Stack::one(Vector3::zeros()),
        };
        let wheels = match wheels {
            Some(wheels) => {
                let list = wheels.try_iter().map_err(|_| {
                    PyTypeError::new_err(format!(
                        "wheels: expected a sequence of wheels, got {}; of one wheel [wheel]",
                        wheels.get_type()
                    ))
                })?;
                PyTuple::new(py, list.collect::<PyResult<Vec<_>>>()?)?
            }
            None => PyTuple::empty(py),
        };
        PyGyrostat::new(py, slf, given, &wheels)
    }
}

#[pymethods]
impl PyGyrostat {
    /// Angular momentum inside the body if the body is at rest: the given momentum plus ``J Ω a`` of each wheel.
    ///
    /// Components in the body frame, shape (..., 3). For a free wheel the momentum in the motion is ``J (Ω +
    /// a·ω) a``.
    #[getter]
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let momentum =
            |one: &Gyrostat| Vector3::from(one.inside.momentum.map(DoubleDouble::rounded));
        Ok(write_of(py, &self.gyrostats, momentum)?.into_any())
    }

    /// Shape of the stack, as a tuple of int; ``()`` for one.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.gyrostats.shape)
    }

    /// The momentum and, of the free wheels, Σ J a aᵀ: for trajectories.
    #[pyo3(name = "_rotor")]
    pub(crate) fn rotor<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let momentum = write_of(py, &self.gyrostats, |one| {
            Vector3::from(one.inside.momentum.map(DoubleDouble::rounded))
        })?;
        let free = write_of(py, &self.gyrostats, |one| {
            Matrix3::from(one.inside.free.map(|row| row.map(DoubleDouble::rounded)))
        })?;
        Ok((momentum.into_any(), free.into_any()))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_parts")?;
        let body = self.body.bind(py).clone().into_any();
        let wheels = self.wheels.bind(py).clone().into_any();
        let given = in_slabs(write(py, &self.given)?.into_any())?;
        Ok((restore, PyTuple::new(py, [body, given, wheels])?))
    }

    /// What `__reduce__` took apart; for pickle.
    #[staticmethod]
    fn _from_parts(
        py: Python<'_>,
        body: Py<PyRigidBody>,
        momentum: &Bound<'_, PyAny>,
        wheels: &Bound<'_, PyTuple>,
    ) -> PyResult<Self> {
        Self::new(py, body, read(momentum, "momentum")?, wheels)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// Equal bodies with equal momenta and wheels.
    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(false);
        };
        let other = other.get();
        let same = self.given == other.given && self.gyrostats == other.gyrostats;
        Ok(same
            && self.body.bind(py).eq(other.body.bind(py))?
            && self.wheels.bind(py).eq(other.wheels.bind(py))?)
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.body.bind(py).hash()
    }

    /// One gyrostat by what is inside; a stack by its shape.
    fn __repr__(&self, py: Python<'_>) -> String {
        let wheels = match self.wheels.bind(py).len() {
            0 => String::new(),
            1 => ", 1 wheel".to_owned(),
            n => format!(", {n} wheels"),
        };
        if !self.gyrostats.shape.is_empty() {
            return format!(
                "<Gyrostat stack of shape {}: {} gyrostats{wheels}>",
                tuple(&self.gyrostats.shape),
                self.gyrostats.rows.len()
            );
        }
        let [x, y, z] = (self.gyrostats[0].inside.momentum).map(DoubleDouble::rounded);
        format!("<Gyrostat: momentum=[{x:?}, {y:?}, {z:?}]{wheels}>")
    }
}
