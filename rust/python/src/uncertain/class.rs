//! The class `Uncertain`: numbers with standard deviations or a covariance, from one source.

use numpy::{PyArrayDyn, PyUntypedArrayMethods};
use polhode::uncertainty::{Form, Given, Source};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{floats, numpy, read_scalar, real_numbers};
use crate::errors::to_py;
use crate::hints::refuse_unknown;
use crate::shape::tuple;

/// Numbers that are not known exactly: values with standard deviations or a covariance.
///
/// An `Uncertain` is accepted wherever a body is made from numbers: by the constructors of `RigidBody`, the
/// solids, laminae and rods, and by `RigidBody.translated`, `RigidBody.rotated` and `RigidBody.scaled`. A
/// body that is made from it carries the covariance.
///
/// The errors of an `Uncertain` are random variables. Together they are called its *source*. If two bodies are
/// made from the same `Uncertain`, both have these errors, and their numbers are correlated.
///
/// Parameters
/// ----------
/// value : array_like, or rotation
///     The numbers; for `RigidBody.rotated` a rotation, as any object with ``as_quat()`` such as SciPy's
///     Rotation. The error of a rotation is a small rotation that follows it: `sigma` then gives the standard
///     deviations of its angles about the fixed axes x, y and z, in radians.
/// sigma : array_like, optional
///     Standard deviations, of a shape that broadcasts to that of the numbers. The errors of the numbers are
///     independent of each other.
/// covariance : array_like, shape (n, n), optional
///     In place of `sigma`: covariance of the n numbers, in C order.
/// source : str, optional
///     A name for the source. Objects with the same name have the same errors, number by number, each in
///     multiples of its own standard deviation; their values and sigmas may differ. Objects with a
///     `covariance` have the same errors only if the covariances are equal too. Without a name the errors of
///     each object are independent of all others.
///
/// Raises
/// ------
/// PolhodeError
///     For a negative sigma, or a matrix that is no covariance.
///
/// Notes
/// -----
/// The errors are taken as normally distributed, and results are computed to first order in them. The field
/// ``linear`` of `RigidBody.sigma` tells for which results the first order is not enough.
///
/// Examples
/// --------
/// Two wheels from one drawing:
///
/// >>> from polhode import Uncertain, laminae
/// >>> radius = Uncertain(0.3, sigma=0.001)
/// >>> front, rear = laminae.disk(radius, mass=8.0), laminae.disk(radius, mass=8.0)
/// >>> axle = front.translated((0, 0, 0.5)) + rear.translated((0, 0, -0.5))
/// >>> axle.sigma.inertia.diagonal().round(6)
/// array([0.0024, 0.0024, 0.0048])
#[pyclass(name = "Uncertain", module = "polhode", frozen)]
pub(crate) struct PyUncertain {
    value: Py<PyAny>,
    sigma: Option<Py<PyAny>>,
    covariance: Option<Py<PyAny>>,
    source: Option<String>,
    /// Whether standard deviations were given, so that the two mirrored elements of a tensor stand for one number.
    by_sigma: bool,
    /// A form for each number, or for each of the three small angles.
    pub(super) given: Given,
}

#[pymethods]
impl PyUncertain {
    #[new]
    #[pyo3(
        signature = (value, sigma=None, *, covariance=None, source=None, **unknown),
        text_signature = "(value, sigma=None, *, covariance=None, source=None)"
    )]
    fn new(
        value: &Bound<'_, PyAny>,
        sigma: Option<&Bound<'_, PyAny>>,
        covariance: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = read_scalar)] source: Option<String>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let known = ["value", "sigma", "covariance", "source"];
        refuse_unknown("Uncertain", &known, unknown)?;
        let py = value.py();
        let is_rotation = value.hasattr("as_quat")?;
        let (kept, shape) = if is_rotation {
            (value.clone(), vec![3])
        } else {
            let array = floats(value, "value")?;
            let (array, shape): (&Bound<'_, PyArrayDyn<f64>>, _) = (&array, array.shape().to_vec());
            (frozen(array)?, shape)
        };
        let from = (source.as_deref()).map_or_else(Source::fresh, Source::named);
        let (given, sigma, covariance) = match (sigma, covariance) {
            (Some(sigma), None) => {
                let sigma = numpy(py)?.call_method1(
                    "broadcast_to",
                    (real_numbers(sigma, "sigma")?, PyTuple::new(py, &shape)?),
                );
                let sigma = sigma.map_err(|_| {
                    PyValueError::new_err(format!(
                        "sigma: its shape does not broadcast to {}, the shape of the numbers",
                        tuple(&shape)
                    ))
                })?;
                let sigma = floats(&sigma, "sigma")?;
                let given = Given::independent(sigma.as_slice()?, from);
                (given, Some(frozen(&sigma)?), None)
            }
            (None, Some(covariance)) => {
                let covariance = floats(covariance, "covariance")?;
                let count: usize = shape.iter().product();
                if covariance.shape() != [count, count] {
                    return Err(PyValueError::new_err(format!(
                        "covariance: expected shape ({count}, {count}) for {count} numbers, got {}",
                        tuple(covariance.shape())
                    )));
                }
                let given = Given::correlated(covariance.as_slice()?, from);
                (given, None, Some(frozen(&covariance)?))
            }
            _ => {
                return Err(PyTypeError::new_err(
                    "give exactly one of sigma= and covariance=",
                ));
            }
        };
        Ok(Self {
            by_sigma: sigma.is_some(),
            value: kept.unbind(),
            sigma: sigma.map(Bound::unbind),
            covariance: covariance.map(Bound::unbind),
            source,
            given: given.map_err(|error| to_py(py, &error))?,
        })
    }

    /// Values of the numbers, or the rotation.
    #[getter]
    pub(super) fn value<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        scalar(self.value.bind(py))
    }

    /// Standard deviations of the numbers, in their units; of a rotation in radians.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match (&self.sigma, &self.covariance) {
            (Some(sigma), _) => scalar(sigma.bind(py)),
            (None, Some(covariance)) => {
                let variances = covariance.bind(py).call_method0("diagonal")?;
                let sigma = numpy(py)?.call_method1("sqrt", (variances,))?;
                let shape = match self.value.bind(py).getattr_opt("shape")? {
                    Some(shape) if !self.is_rotation(py)? => shape,
                    _ => (3,).into_pyobject(py)?.into_any(),
                };
                scalar(&sigma.call_method1("reshape", (shape,))?)
            }
            (None, None) => Ok(py.None().into_bound(py)),
        }
    }

    /// Covariance of the numbers in C order, shape (n, n).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let count = self.given.forms.len();
        let mut numbers = Vec::with_capacity(count * count);
        for i in 0..count {
            numbers.extend((0..count).map(|j| self.given.covariance(i, j)));
        }
        numpy::PyArray1::from_vec(py, numbers).call_method1("reshape", ((count, count),))
    }

    /// Name of the source, or None.
    #[getter]
    fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// It is no array of plain numbers: who takes it for one would lose the sigma.
    #[expect(clippy::unused_self, reason = "Python asks an instance")]
    #[pyo3(signature = (*_args, **_options))]
    fn __array__(
        &self,
        _args: &Bound<'_, PyAny>,
        _options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<PyAny>> {
        Err(plain_numbers())
    }

    /// As `__array__`.
    #[expect(clippy::unused_self, reason = "Python asks an instance")]
    fn __float__(&self) -> PyResult<f64> {
        Err(plain_numbers())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let word = |name: &str, object: &Bound<'_, PyAny>| -> PyResult<String> {
            let object = match object.call_method0("tolist") {
                Ok(list) => list,
                Err(_) => object.clone(),
            };
            Ok(format!("{name}{}", object.repr()?))
        };
        let mut parts = vec![word("", &self.value(py)?)?];
        match &self.covariance {
            Some(covariance) => parts.push(word("covariance=", covariance.bind(py))?),
            None => parts.push(word("sigma=", &self.sigma(py)?)?),
        }
        if let Some(source) = &self.source {
            parts.push(format!("source={source:?}"));
        }
        Ok(format!("Uncertain({})", parts.join(", ")))
    }

    /// The variables that each number depends on, each in halves of its number, with the number's change by one standard
    /// deviation of it.
    #[pyo3(name = "_forms")]
    fn stored_forms(&self) -> Vec<Vec<([u64; 2], f64)>> {
        (self.given.forms.iter())
            .map(|form| {
                form.iter()
                    .map(|(variable, step)| (variable.to_words(), *step))
                    .collect()
            })
            .collect()
    }

    /// What `_restored` takes: the variables too, so that the source stays the same.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let of = |object: &Option<Py<PyAny>>| object.as_ref().map(|object| object.clone_ref(py));
        let state = (
            own.value.clone_ref(py),
            of(&own.sigma),
            of(&own.covariance),
            own.source.clone(),
            own.stored_forms(),
            own.by_sigma,
        );
        Ok((
            py.get_type::<Self>().getattr("_restored")?,
            state.into_pyobject(py)?.into_any(),
        ))
    }

    /// What `__reduce__` took apart; for pickle.
    #[staticmethod]
    fn _restored(
        value: Py<PyAny>,
        sigma: Option<Py<PyAny>>,
        covariance: Option<Py<PyAny>>,
        #[pyo3(from_py_with = read_scalar)] source: Option<String>,
        variables: Vec<Vec<([u64; 2], f64)>>,
        by_sigma: bool,
    ) -> Self {
        let form = |form: Vec<([u64; 2], f64)>| -> Form {
            form.into_iter()
                .map(|(words, step)| (polhode::uncertainty::Variable::from_words(words), step))
                .collect()
        };
        Self {
            value,
            sigma,
            covariance,
            source,
            by_sigma,
            given: Given {
                forms: variables.into_iter().map(form).collect(),
            },
        }
    }
}

impl PyUncertain {
    /// Whether standard deviations were given.
    pub(super) fn is_by_sigma(&self) -> bool {
        self.by_sigma
    }

    /// A form for each number.
    pub(crate) fn forms(&self) -> &[Form] {
        &self.given.forms
    }

    /// Whether it is a rotation with three small angles.
    pub(super) fn is_rotation(&self, py: Python<'_>) -> PyResult<bool> {
        self.value.bind(py).hasattr("as_quat")
    }
}

/// Who asks for plain numbers.
fn plain_numbers() -> PyErr {
    PyTypeError::new_err(
        "an Uncertain is given where plain numbers are expected, and its sigma would be lost; pass its .value to go on \
         without",
    )
}

/// A copy of an array that nobody writes to.
fn frozen<'py>(array: &Bound<'py, PyArrayDyn<f64>>) -> PyResult<Bound<'py, PyAny>> {
    let copy = array.call_method0("copy")?;
    copy.getattr("flags")?.setattr("writeable", false)?;
    Ok(copy)
}

/// A float for an array without axes.
fn scalar<'py>(array: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    match array.cast::<PyArrayDyn<f64>>() {
        Ok(array) if array.ndim() == 0 => array.call_method0("item"),
        _ => Ok(array.clone()),
    }
}
