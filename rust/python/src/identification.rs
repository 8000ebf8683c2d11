//! Logs of tumbles and the bodies that fit them. `polhode.identify` reads their arguments.

use numpy::{PyArrayMethods, PyReadonlyArrayDyn};
use polhode::Error;
use polhode::motion::identification::{
    Bias, Fit, Sensor, Tumble, fit_tumble as fit_of, information as information_of,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::floats;
use crate::errors::to_py;
use crate::interrupt::Interrupt;

/// What is known beside the log, as numbers and rows of numbers.
struct Known {
    sigma: Option<[f64; 3]>,
    bias: Bias,
    momentum: [f64; 3],
    torque: [f64; 3],
    prior: Option<([f64; 6], [[f64; 6]; 6])>,
    attitude: Option<Measured<4>>,
    specific_force: Option<Measured<3>>,
    gyro_scale: bool,
    student: bool,
    starts: usize,
}

/// Rows of a sensor, and the standard deviations of its noise.
struct Measured<const N: usize> {
    rows: Vec<[f64; N]>,
    sigma: [f64; 3],
}

impl<const N: usize> Measured<N> {
    /// Read a pair of an array (n, N) and three numbers, or None.
    fn of(given: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<Self>> {
        if given.is_none() {
            return Ok(None);
        }
        let (rows, sigma): (Bound<'_, PyAny>, _) = given.extract()?;
        let rows = floats(&rows, name)?;
        let rows = rows.as_slice()?.as_chunks().0.to_vec();
        Ok(Some(Self { rows, sigma }))
    }

    fn sensor(&self) -> Sensor<'_, N> {
        Sensor {
            rows: &self.rows,
            sigma: self.sigma,
        }
    }
}

impl Known {
    fn of(given: &Bound<'_, PyDict>) -> PyResult<Self> {
        let item = |name: &str| {
            let found = given.get_item(name)?;
            found.ok_or_else(|| PyValueError::new_err(format!("known: expected the key {name:?}")))
        };
        let bias = item("bias")?;
        Ok(Self {
            sigma: item("sigma")?.extract()?,
            bias: if let Ok(free) = bias.extract::<bool>() {
                if free { Bias::Free } else { Bias::Zero }
            } else {
                let (mean, white) = bias.extract()?;
                Bias::Prior(mean, white)
            },
            momentum: item("momentum")?.extract()?,
            torque: item("torque")?.extract()?,
            prior: item("prior")?.extract()?,
            attitude: Measured::of(&item("attitude")?, "attitude")?,
            specific_force: Measured::of(&item("specific_force")?, "specific_force")?,
            gyro_scale: item("scale")?.extract()?,
            student: item("student")?.extract()?,
            starts: item("starts")?.extract()?,
        })
    }

    /// Return the log; every sensor has a row for each time.
    fn with<'a>(&'a self, t: &'a [f64], omega: &'a [[f64; 3]]) -> PyResult<Tumble<'a>> {
        let counts = [
            self.attitude.as_ref().map(|one| one.rows.len()),
            self.specific_force.as_ref().map(|one| one.rows.len()),
        ];
        if counts.iter().flatten().any(|count| *count != t.len()) {
            return Err(PyValueError::new_err(
                "known: expected a row of each sensor for each time",
            ));
        }
        Ok(Tumble {
            t,
            omega,
            sigma: self.sigma,
            bias: self.bias,
            momentum: self.momentum,
            torque: self.torque,
            prior: self.prior,
            attitude: self.attitude.as_ref().map(Measured::sensor),
            specific_force: self.specific_force.as_ref().map(Measured::sensor),
            gyro_scale: self.gyro_scale,
            student: self.student,
            starts: self.starts,
        })
    }
}

/// The times and the rows of the log.
fn log<'a>(
    t: &'a PyReadonlyArrayDyn<'_, f64>,
    omega: &'a PyReadonlyArrayDyn<'_, f64>,
    least: usize,
) -> PyResult<(&'a [f64], &'a [[f64; 3]])> {
    let (t, omega) = (t.as_slice()?, omega.as_slice()?.as_chunks().0);
    if t.len() < least || omega.len() != t.len() {
        return Err(PyValueError::new_err(format!(
            "t: needs at least {least} times and a row for each, got {} and {}",
            t.len(),
            omega.len()
        )));
    }
    check(t)?;
    if !omega.as_flattened().iter().all(|x| x.is_finite()) {
        return Err(PyValueError::new_err("omega: expected finite numbers"));
    }
    Ok((t, omega))
}

/// So many numbers.
fn fixed<const N: usize>(given: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; N]> {
    let found = floats(given, name)?;
    let found = found.as_slice()?;
    found.try_into().map_err(|_| {
        let count = found.len();
        PyValueError::new_err(format!("{name}: expected {N} numbers, got {count}"))
    })
}

/// Times have to ascend.
fn check(t: &[f64]) -> PyResult<()> {
    if t.iter().all(|x| x.is_finite()) && t.windows(2).all(|pair| pair[0] < pair[1]) {
        return Ok(());
    }
    Err(PyValueError::new_err("t: expected finite, ascending times"))
}

fn dict<'py>(py: Python<'py>, fit: &Fit, rows: usize) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("omega", fit.omega)?;
    found.set_item("inertia", fit.inertia)?;
    found.set_item("bias", fit.bias)?;
    found.set_item("gyro_scale", fit.gyro_scale)?;
    found.set_item("attitude", fit.attitude)?;
    found.set_item("place", fit.place)?;
    found.set_item("sigma", fit.sigma)?;
    found.set_item("cost", fit.cost)?;
    found.set_item("chi2", fit.chi2)?;
    found.set_item("triangle", fit.triangle.clone())?;
    found.set_item("at_edge", fit.at_edge)?;
    found.set_item("converged", fit.converged)?;
    let residuals = numpy::PyArray1::from_vec(py, fit.residuals.as_flattened().to_vec());
    let width = 3 * fit.residuals.len() / rows;
    found.set_item("residuals", residuals.reshape([rows, width])?)?;
    Ok(found)
}

/// The maxima of the likelihood of a log t (n,), omega (n, 3), the best first.
#[pyfunction]
#[pyo3(signature = (t, omega, known, progress=None))]
pub(crate) fn fit_tumble<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    omega: &Bound<'py, PyAny>,
    known: &Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyList>> {
    let known = Known::of(known)?;
    let (t, omega) = (floats(t, "t")?, floats(omega, "omega")?);
    let (t, omega) = log(&t, &omega, 3)?;
    let tumble = known.with(t, omega)?;
    let interrupt = Interrupt::new(progress);
    let found = py.detach(|| fit_of(&tumble, &mut |done| interrupt.poll(Some(done))));
    interrupt.finish(py, found.is_ok())?;
    let found: Result<Vec<Fit>, Error> = found;
    let found = found.map_err(|error| to_py(py, &error))?;
    let found: Vec<_> = found
        .iter()
        .map(|fit| dict(py, fit, t.len()))
        .collect::<PyResult<_>>()?;
    PyList::new(py, found)
}

/// What the motion from `omega` of a body with the elements `inertia` would tell at the times t (n,), with an accelerometer at
/// `place`; None where it is not followed.
#[pyfunction]
pub(crate) fn tumble_information<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    omega: &Bound<'py, PyAny>,
    inertia: &Bound<'py, PyAny>,
    place: [f64; 3],
    known: &Bound<'py, PyDict>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let known = Known::of(known)?;
    let omega = fixed::<3>(omega, "omega")?;
    let inertia = fixed::<6>(inertia, "inertia")?;
    let t = floats(t, "t")?;
    let t = t.as_slice()?;
    if t.is_empty() {
        return Err(PyValueError::new_err("t: needs at least one time"));
    }
    check(t)?;
    let still = vec![[0.0; 3]; t.len()];
    let tumble = known.with(t, &still)?;
    let interrupt = Interrupt::new(None);
    let found = py.detach(|| {
        information_of(&tumble, (omega, inertia, place), &mut |_| {
            interrupt.poll(None)
        })
    });
    interrupt.finish(py, found.is_ok())?;
    let found = found.map_err(|error| to_py(py, &error))?;
    found.map(|fit| dict(py, &fit, t.len())).transpose()
}
