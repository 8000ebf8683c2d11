//! Numbers with a sigma in, uncertainties of bodies carried along.

use std::sync::Arc;

use nalgebra::Matrix3;
use numpy::{PyArrayDescrMethods, PyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use polhode::Error;
use polhode::error::UncertaintyFault;
use polhode::mass::inertial_parameters::{ELEMENTS, InertialParameters};
use polhode::uncertainty::{
    BodyFunction, Form, Inputs, LinearForms, LinearUncertainty, Scaling, Source, Variable,
    propagate,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyList, PyTuple};

use crate::array_conversion::is_scalar;
use crate::arrays::{Argument, Item, floats, numpy, read, read_list, read_scalar, real_numbers};
use crate::attitudes::read_rotation;
use crate::body::{PyRigidBody, Uncertainties};
use crate::errors::to_py;
use crate::hints::refuse_unknown;
use crate::items::size;
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

// The class `Uncertain`: numbers with standard deviations or a covariance, from one source.

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
    given: LinearForms,
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
            (freeze(array)?, shape)
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
                let given = LinearForms::independent(sigma.as_slice()?, from);
                (given, Some(freeze(&sigma)?), None)
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
                let given = LinearForms::correlated(covariance.as_slice()?, from);
                (given, None, Some(freeze(&covariance)?))
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
    fn value<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
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
                .map(|(words, step)| (Variable::from_words(words), step))
                .collect()
        };
        Self {
            value,
            sigma,
            covariance,
            source,
            by_sigma,
            given: LinearForms {
                forms: variables.into_iter().map(form).collect(),
            },
        }
    }
}

impl PyUncertain {
    /// Whether standard deviations were given.
    fn is_by_sigma(&self) -> bool {
        self.by_sigma
    }

    /// A form for each number.
    pub(crate) fn forms(&self) -> &[Form] {
        &self.given.forms
    }

    /// Whether it is a rotation with three small angles.
    fn is_rotation(&self, py: Python<'_>) -> PyResult<bool> {
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
fn freeze<'py>(array: &Bound<'py, PyArrayDyn<f64>>) -> PyResult<Bound<'py, PyAny>> {
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

// Arguments that may be numbers with a sigma.

/// A number with the form of its uncertainties.
pub(crate) type Number<'a> = (f64, &'a [(Variable, f64)]);

/// Items over the last axes and a stack over the leading ones, with a form for each number where they are uncertain.
pub(crate) struct Quantity<T> {
    pub(crate) values: Stack<T>,
    forms: Option<Vec<Form>>,
    by_sigma: bool,
}

impl<T: Item> Quantity<T> {
    /// Numbers without uncertainties.
    fn certain(values: Stack<T>) -> Self {
        Self {
            values,
            forms: None,
            by_sigma: false,
        }
    }

    /// Whether its numbers have uncertainties.
    pub(crate) fn is_uncertain(&self) -> bool {
        self.forms.is_some()
    }

    /// The numbers of one row.
    pub(crate) fn row(&self, row: usize) -> Vec<Number<'_>> {
        let mut values = Vec::with_capacity(size::<T>());
        self.values.rows[row].write(&mut values);
        let forms = |k: usize| match &self.forms {
            Some(forms) => &forms[row * size::<T>() + k][..],
            None => &[],
        };
        values
            .into_iter()
            .enumerate()
            .map(|(k, value)| (value, forms(k)))
            .collect()
    }
}

/// A positive number of which a body has that much more or less mass: with the form of its relative uncertainty.
pub(crate) struct Weight {
    pub(crate) value: f64,
    pub(crate) relative: Form,
}

impl<'py> FromPyObject<'_, 'py> for Weight {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let uncertain = match read_scalar::<f64>(&object) {
            Ok(value) => {
                return Ok(Self {
                    value,
                    relative: Form::new(),
                });
            }
            Err(fault) => match object.cast::<PyUncertain>() {
                Ok(uncertain) => uncertain.to_owned(),
                Err(_) => joined_or(&object, fault)?,
            },
        };
        let value: f64 = uncertain.get().value(object.py())?.extract()?;
        let form = &uncertain.get().given.forms[0];
        Ok(Self {
            value,
            relative: factor(&[(value, form)]),
        })
    }
}

/// As [`value_of`] for a rotation, which with a sigma must be one of a library's with three small angles.
fn rotation_of<'py>(
    object: &Bound<'py, PyAny>,
    name: &'static str,
) -> PyResult<(Bound<'py, PyAny>, Option<Bound<'py, PyUncertain>>)> {
    let found = value_of(object)?;
    if found.1.is_some() {
        rotation_quantity(object, name)?;
    }
    Ok(found)
}

/// The plain value of an argument, and where it has a sigma the `Uncertain` that it is.
pub(crate) fn value_of<'py>(
    object: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyAny>, Option<Bound<'py, PyUncertain>>)> {
    let found = match object.cast::<PyUncertain>() {
        Ok(uncertain) => Some(uncertain.clone()),
        Err(_) if is_plain(object, NESTED) => None,
        Err(_) => join_uncertain(object)?,
    };
    match found {
        Some(uncertain) => Ok((uncertain.get().value(object.py())?, Some(uncertain))),
        None => Ok((object.clone(), None)),
    }
}

/// RecursionGuard lists are looked at by `join`.
const NESTED: usize = 4;

/// Whether an argument is an array, a number, or lists of such.
fn is_plain(object: &Bound<'_, PyAny>, depth: usize) -> bool {
    let inside = |item: Bound<'_, PyAny>| depth > 0 && is_plain(&item, depth - 1);
    if let Ok(list) = object.cast_exact::<PyList>() {
        list.iter().all(inside)
    } else if let Ok(tuple) = object.cast_exact::<PyTuple>() {
        tuple.iter().all(inside)
    } else {
        object.is_exact_instance_of::<PyFloat>()
            || object.is_exact_instance_of::<PyInt>()
            || (object.cast::<PyUntypedArray>()).is_ok_and(|array| array.dtype().kind() != b'O')
            || is_scalar(object)
    }
}

/// Whether an argument is an `Uncertain`.
pub(crate) fn is_uncertain(object: &Bound<'_, PyAny>) -> bool {
    object.is_instance_of::<PyUncertain>()
}

/// Whether numbers of an argument that was refused are uncertain.
pub(crate) fn holds_uncertain(object: &Bound<'_, PyAny>, fault: &PyErr) -> PyResult<bool> {
    Ok(is_about_values(fault, object.py()) && join_uncertain(object)?.is_some())
}

/// Reads an argument that may be an `Uncertain`, or hold such or numbers of the package `uncertainties`.
pub(crate) fn quantity<T: Item>(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Quantity<T>> {
    if let Ok(uncertain) = object.cast::<PyUncertain>() {
        return with_forms(uncertain, name);
    }
    // Plain numbers are not asked: what has a sigma is refused first.
    match read(object, name) {
        Ok(values) => Ok(Quantity::certain(values)),
        Err(fault) => with_forms(&joined_or(object, fault)?, name),
    }
}

fn with_forms<T: Item>(uncertain: &Bound<'_, PyUncertain>, name: &str) -> PyResult<Quantity<T>> {
    let (py, uncertain) = (uncertain.py(), uncertain.get());
    if uncertain.is_rotation(py)? {
        let message = format!("{name}: expected numbers with a sigma, got a rotation with one");
        return Err(PyTypeError::new_err(message));
    }
    Ok(Quantity {
        values: read(&uncertain.value(py)?, name)?,
        forms: Some(uncertain.given.forms.clone()),
        by_sigma: uncertain.is_by_sigma(),
    })
}

/// As [`quantity`] for items in a row, shape (n, tail) or (..., n, tail): `leading` names the axes before the tail.
pub(crate) fn quantity_list<T: Item>(
    object: &Bound<'_, PyAny>,
    name: &str,
    leading: &str,
) -> PyResult<Quantity<T>> {
    match object.cast::<PyUncertain>() {
        Ok(uncertain) => {
            let forms = Some(uncertain.get().given.forms.clone());
            let value = uncertain.get().value(object.py())?;
            Ok(Quantity {
                values: read_list(&value, name, leading)?,
                forms,
                by_sigma: uncertain.get().is_by_sigma(),
            })
        }
        Err(_) => match read_list(object, name, leading) {
            Ok(values) => Ok(Quantity::certain(values)),
            Err(fault) => quantity_list(joined_or(object, fault)?.as_any(), name, leading),
        },
    }
}

/// As [`quantity`], with a default for an argument that was not given.
pub(crate) fn quantity_or<T: Item>(
    argument: &Argument<'_>,
    name: &str,
    default: T,
) -> PyResult<Quantity<T>> {
    argument.value().map_or_else(
        || Ok(Quantity::certain(Stack::one(default))),
        |object| quantity(object, name),
    )
}

/// The `Uncertain` that numbers of the package `uncertainties` become, or a list of numbers among which some are uncertain;
/// nothing of what else was refused.
fn join_uncertain<'py>(object: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyUncertain>>> {
    let found = object
        .py()
        .import("polhode.uncertainty")?
        .call_method1("join", (object,))?;
    Ok(found.cast_into::<PyUncertain>().ok())
}

/// As `join`, of an argument that was refused for this fault.
fn joined_or<'py>(object: &Bound<'py, PyAny>, fault: PyErr) -> PyResult<Bound<'py, PyUncertain>> {
    // Ctrl-C and lack of memory end the call at once.
    if is_about_values(&fault, object.py()) {
        join_uncertain(object)?.ok_or(fault)
    } else {
        Err(fault)
    }
}

fn is_about_values(fault: &PyErr, py: Python<'_>) -> bool {
    fault.is_instance_of::<PyTypeError>(py) || fault.is_instance_of::<PyValueError>(py)
}

/// The relative uncertainty of an amount, as a factor of one.
pub(crate) fn factor(amount: &[Number<'_>]) -> Form {
    let (value, form) = amount[0];
    form.iter()
        .map(|&(variable, step)| (variable, step / value))
        .collect()
}

/// Rotations, and the forms of the small angles that follow one.
type Rotations = (Stack<Matrix3<f64>>, Option<Vec<Form>>);

/// Reads rotations, or one with a sigma.
pub(crate) fn rotation_quantity(
    object: &Bound<'_, PyAny>,
    name: &'static str,
) -> PyResult<Rotations> {
    match object.cast::<PyUncertain>() {
        Err(_) => Ok((read_rotation(object, name)?, None)),
        Ok(uncertain) => {
            let (py, uncertain) = (object.py(), uncertain.get());
            if !uncertain.is_rotation(py)? {
                let message = format!(
                    "{name}: a rotation with a sigma is Uncertain(rotation, sigma=) of an object with as_quat(), such as \
                     scipy.spatial.transform.Rotation, and the sigma of three small angles in radians"
                );
                return Err(PyTypeError::new_err(message));
            }
            let rotations = read_rotation(&uncertain.value(py)?, name)?;
            if !rotations.is_one() {
                let message = format!("{name}: expected one rotation with a sigma, got a stack");
                return Err(PyTypeError::new_err(message));
            }
            Ok((rotations, Some(uncertain.given.forms.clone())))
        }
    }
}

/// A number without uncertainties.
pub(crate) fn certain(value: f64) -> Number<'static> {
    (value, &[])
}

/// The elements xx, yy, zz, xy, xz, yz of a symmetric tensor; each beside the diagonal is one number, given twice.
pub(crate) fn symmetric<'a>(
    what: &'static str,
    tensor: &'a Quantity<Matrix3<f64>>,
    row: usize,
) -> Result<[Number<'a>; 6], Error> {
    let by_sigma = tensor.by_sigma;
    let tensor = tensor.row(row);
    for (row, column) in [(0, 1), (0, 2), (1, 2)] {
        let (a, b) = (tensor[3 * row + column].1, tensor[3 * column + row].1);
        let sigma =
            |form: &[(Variable, f64)]| form.iter().map(|(_, step)| step * step).sum::<f64>().sqrt();
        // Standard deviations have a variable for each element; a covariance says what is one.
        let is_one = match (a, b) {
            ([(_, a)], [(_, b)]) if by_sigma => a.abs() == b.abs(),
            _ => sigma(&difference(a, b)) <= 1e-9 * sigma(a),
        };
        if !is_one {
            let (a, b) = (sigma(a), sigma(b));
            return Err(UncertaintyFault::Mirrored {
                what,
                row,
                column,
                a,
                b,
            }
            .into());
        }
    }
    Ok(ELEMENTS.map(|(i, j)| tensor[3 * i + j]))
}

/// The form of the difference of two numbers.
fn difference(a: &[(Variable, f64)], b: &[(Variable, f64)]) -> Form {
    let mut all: Form = a.to_vec();
    for &(variable, step) in b {
        match all.iter_mut().find(|(own, _)| *own == variable) {
            Some((_, own)) => *own -= step,
            None => all.push((variable, -step)),
        }
    }
    all
}

// The uncertainties of a stack of bodies, and how they go along.

/// Those of the rows of a result, if any of what it is made of has some.
pub(crate) fn propagate_rows<const K: usize>(
    py: Python<'_>,
    grid: &Broadcast<'_, K>,
    is_uncertain: bool,
    uncertainty: impl Fn([usize; K]) -> Result<LinearUncertainty, Error> + Sync,
) -> PyResult<Uncertainties> {
    if !is_uncertain {
        return Ok(None);
    }
    Ok(Some(Arc::new(
        grid.try_map_into(py, LinearUncertainty::default(), uncertainty)?
            .rows,
    )))
}

/// The uncertainties of a body that is given by numbers.
pub(crate) fn of_numbers(
    change: &impl BodyFunction,
    numbers: &[Number<'_>],
) -> Result<LinearUncertainty, Error> {
    propagate(
        change,
        Inputs {
            bodies: &[],
            numbers,
        },
    )
}

impl PyRigidBody {
    /// Bodies with their uncertainties.
    pub(crate) fn with_uncertainty(
        bodies: Stack<polhode::RigidBody>,
        uncertainties: Uncertainties,
    ) -> Self {
        Self {
            uncertainties,
            ..bodies.into()
        }
    }

    /// The bodies, each with that relative uncertainty of its mass besides what it carries.
    pub(crate) fn weigh(self, weights: [Option<Weight>; 3]) -> PyResult<Self> {
        let Some(relative) = (weights.into_iter().flatten())
            .map(|weight| weight.relative)
            .find(|form| !form.is_empty())
        else {
            return Ok(self);
        };
        let numbers = &[(1.0, &[][..]), (1.0, &relative)];
        let uncertainties = (0..self.bodies.rows.len())
            .map(|row| {
                propagate(
                    &Scaling,
                    Inputs {
                        bodies: &[self.row(row)],
                        numbers,
                    },
                )
            })
            .collect::<Result<_, Error>>()
            .map_err(|error| Python::attach(|py| to_py(py, &error)))?;
        Ok(Self {
            uncertainties: Some(Arc::new(uncertainties)),
            ..self
        })
    }

    /// The uncertainties of a row after a change of it by some numbers.
    pub(crate) fn propagate_row(
        &self,
        row: usize,
        change: &impl BodyFunction,
        numbers: &[Number<'_>],
    ) -> Result<LinearUncertainty, Error> {
        let bodies = &[self.row(row)];
        propagate(change, Inputs { bodies, numbers })
    }

    /// One row: its ten numbers and its uncertainties.
    pub(crate) fn row(&self, row: usize) -> (InertialParameters<f64>, &LinearUncertainty) {
        static CERTAIN: std::sync::LazyLock<LinearUncertainty> =
            std::sync::LazyLock::new(LinearUncertainty::default);
        let uncertainty = match &self.uncertainties {
            Some(uncertainties) => &uncertainties[row],
            None => &CERTAIN,
        };
        (InertialParameters::of(&self.bodies[row]), uncertainty)
    }

    /// The uncertainties of rows of it.
    pub(crate) fn uncertainties_of(&self, rows: impl Iterator<Item = usize>) -> Uncertainties {
        self.uncertainties
            .as_ref()
            .map(|uncertainties| Arc::new(rows.map(|row| uncertainties[row].clone()).collect()))
    }
}

// What is uncertain of the state at a start.

/// Angular velocity and attitude where they were given with a sigma.
#[derive(Default)]
pub(crate) struct UncertainStart {
    omega: Option<Py<PyUncertain>>,
    attitude: Option<Py<PyUncertain>>,
}

/// The plain values of an angular velocity and an attitude, and what is uncertain of them.
pub(crate) struct StartArguments<'py> {
    pub(crate) omega: Bound<'py, PyAny>,
    pub(crate) attitude: Option<Bound<'py, PyAny>>,
    pub(crate) uncertain: UncertainStart,
}

impl<'py> StartArguments<'py> {
    /// From the arguments `omega` and `attitude`.
    pub(crate) fn read(
        omega: &Bound<'py, PyAny>,
        attitude: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let (omega, of_omega) = value_of(omega)?;
        let (attitude, of_attitude) = match attitude {
            None => (None, None),
            Some(attitude) => {
                let (value, uncertainty) = rotation_of(attitude, "attitude")?;
                (Some(value), uncertainty)
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
    pub(crate) fn restore(
        (omega, attitude): (Option<Py<PyUncertain>>, Option<Py<PyUncertain>>),
    ) -> Self {
        Self { omega, attitude }
    }
}
