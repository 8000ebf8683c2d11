//! What is uncertain of the state at a start.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::class::PyUncertain;
use super::quantity::{rotation_of, value_of};

/// Angular velocity and attitude where they were given with a sigma.
#[derive(Default)]
pub(crate) struct UncertainStart {
    omega: Option<Py<PyUncertain>>,
    attitude: Option<Py<PyUncertain>>,
}

/// The plain values of an angular velocity and an attitude, and what is uncertain of them.
pub(crate) struct StartGiven<'py> {
    pub(crate) omega: Bound<'py, PyAny>,
    pub(crate) attitude: Option<Bound<'py, PyAny>>,
    pub(crate) uncertain: UncertainStart,
}

impl<'py> StartGiven<'py> {
    /// From the arguments `omega` and `attitude`.
    pub(crate) fn read(
        omega: &Bound<'py, PyAny>,
        attitude: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let (omega, of_omega) = value_of(omega)?;
        let (attitude, of_attitude) = match attitude {
            None => (None, None),
            Some(attitude) => {
                let (value, doubt) = rotation_of(attitude, "attitude")?;
                (Some(value), doubt)
            }
        };
        Ok(Self {
            omega,
            attitude,
            uncertain: UncertainStart {
                omega: of_omega.map(Bound::unbind),
                attitude: of_attitude.map(Bound::unbind),
            },
        })
    }
}

impl UncertainStart {
    /// Whether anything is.
    pub(crate) fn is_any(&self) -> bool {
        self.omega.is_some() || self.attitude.is_some()
    }

    /// As the attribute `uncertain_start` of motions.
    pub(crate) fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        (&self.omega, &self.attitude).into_pyobject(py)
    }

    /// From that.
    pub(crate) fn restored(
        (omega, attitude): (Option<Py<PyUncertain>>, Option<Py<PyUncertain>>),
    ) -> Self {
        Self { omega, attitude }
    }
}
