//! Motions in closed form: at the times asked for, as a `Trajectory`, and what stays constant along them.

use nalgebra::Vector3;
use numpy::{PyArrayMethods, PyUntypedArrayMethods, dtype};
use polhode::motion::closed_form::{ClosedForm, sample_many};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};

use crate::arrays::{floats, numpy, write, write_numbers_of, write_of, zeros};
use crate::body::PyRigidBody;
use crate::errors::{at_row, to_py};
use crate::interrupt::Interrupt;
use crate::memory;
use crate::stack::Stack;
use crate::uncertain::UncertainStart;

/// That every motion knows its state at each of the times.
fn within_reach<M: ClosedForm>(py: Python<'_>, motions: &Stack<M>, times: &[f64]) -> PyResult<()> {
    let least = |least: f64, motion: &M| least.min(motion.reach());
    let reach = motions.rows.iter().fold(f64::INFINITY, least);
    // Without a branch, several times at once.
    if !times.iter().fold(false, |any, t| any | (t.abs() > reach)) {
        return Ok(());
    }
    for (row, motion) in motions.rows.iter().enumerate() {
        for &t in times {
            motion
                .reaches(t)
                .map_err(|error| at_row(&motions.shape, row, &to_py(py, &error), py))?;
        }
    }
    Ok(())
}

/// The trajectory of `body` that moves as `motions` say, through the times `t`, whose axes follow those of the stack.
///
/// `about`: the reference points, in B. `uncertain`: what is, of the state at t = 0, and the motion as
/// Python has it. `fields`: what else the trajectory is to know.
pub(crate) fn trajectory<'py, M: ClosedForm>(
    py: Python<'py>,
    body: &Py<PyRigidBody>,
    motions: &Stack<M>,
    t: &Bound<'py, PyAny>,
    about: &Stack<Vector3<f64>>,
    uncertain: (&UncertainStart, &Bound<'py, PyAny>),
    fields: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    let times = floats(t, "t")?;
    within_reach(py, motions, times.as_slice()?)?;
    let shape = [&motions.shape[..], times.shape()].concat();
    // Quaternions, angular velocities, and zeros that are positions and velocities.
    memory::room("t", &shape, (4 + 3 + 3) * size_of::<f64>())?;
    let array = |components: usize| zeros(py, "t", &[&shape[..], &[components]].concat());
    let (quaternion, omega) = (array(4)?, array(3)?);
    let interrupt = Interrupt::new(None);
    {
        let (mut quaternion, mut omega) = (quaternion.readwrite(), omega.readwrite());
        let (attitudes, omegas) = (quaternion.as_slice_mut()?, omega.as_slice_mut()?);
        let times = times.as_slice()?;
        let outcome = py.detach(|| {
            sample_many(
                &motions.rows,
                times,
                attitudes.as_chunks_mut().0,
                omegas.as_chunks_mut().0,
                &mut |_| interrupt.poll(None),
            )
        });
        interrupt.finish(py, outcome.is_ok())?;
    }
    let starts_at_zero = times.ndim() == 1 && times.as_slice()?.first() == Some(&0.0);
    let (uncertain, motion) = uncertain;
    if starts_at_zero {
        fields.set_item("uncertain_start", uncertain.to_python(py)?)?;
    } else if body.get().uncertainties.is_some() || uncertain.is_any() {
        // How uncertain the first of these states is the motion knows, which began at t = 0.
        fields.set_item("uncertain_start", motion)?;
    }
    let np = numpy(py)?;
    let still = array(3)?;
    let none = np.call_method1("zeros", (motions.shape.clone(), dtype::<i64>(py)))?;
    fields.set_item("body", body)?;
    fields.set_item("t", np.call_method1("array", (&*times,))?)?;
    fields.set_item("omega", omega)?;
    fields.set_item("quaternion", quaternion)?;
    fields.set_item("position", &still)?;
    fields.set_item("velocity", &still)?;
    fields.set_item("about", write(py, about)?)?;
    fields.set_item("steps", &none)?;
    fields.set_item("evaluations", &none)?;
    class(py)?.call((), Some(&fields))
}

/// The kinetic energy of each motion as a `KineticEnergy`: that of the rotation about C, which rests.
pub(crate) fn kinetic_energy<'py, T>(
    py: Python<'py>,
    stack: &Stack<T>,
    energy: impl Fn(&T) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    let none = write_numbers_of(py, stack, |_| 0.0)?;
    let parts = (&none, &none, write_numbers_of(py, stack, energy)?);
    (py.import("polhode.results")?)
        .getattr("KineticEnergy")?
        .call1(parts)
}

/// The angular momentum of each motion as an `AngularMomentum`: that about C, which rests. `in_space` and `in_body`: its components
/// in N, and those in B at t = 0.
pub(crate) fn angular_momentum<'py, M: ClosedForm>(
    py: Python<'py>,
    motions: &Stack<M>,
    frame: &str,
    in_space: impl Fn(&M) -> Vector3<f64>,
    in_body: impl Fn(&M) -> Vector3<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let spin = match frame {
        "space" => write_of(py, motions, in_space)?,
        "body" => write_of(py, motions, in_body)?,
        _ => {
            return Err(PyValueError::new_err(format!(
                "frame: {frame:?} is not \"space\" or \"body\""
            )));
        }
    };
    let none = write_of(py, motions, |_| Vector3::<f64>::zeros())?;
    (py.import("polhode.results")?)
        .getattr("AngularMomentum")?
        .call1((&none, &none, spin))
}

/// Where a trajectory comes from: `polhode.motion.trajectory.Origin` with one field.
pub(crate) fn origin<'py>(
    py: Python<'py>,
    field: &str,
    value: impl IntoPyObject<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item(field, value)?;
    (py.import("polhode.motion.trajectory")?)
        .getattr("Origin")?
        .call((), Some(&fields))
}

/// The class `polhode.motion.trajectory.Trajectory`.
fn class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    CLASS.import(py, "polhode.motion.trajectory", "Trajectory")
}
