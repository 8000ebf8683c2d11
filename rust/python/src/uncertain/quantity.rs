//! Arguments that may be numbers with a sigma.

use nalgebra::Matrix3;
use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use polhode::Error;
use polhode::error::UncertaintyFault;
use polhode::mass::ten::ELEMENTS;
use polhode::uncertainty::{Form, Variable};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyList, PyTuple};

use super::class::PyUncertain;
use crate::arrays::{Argument, Item, read, read_list};
use crate::attitudes::read_rotation;
use crate::foreign::is_scalar;
use crate::items::size;
use crate::stack::Stack;

/// A number with the form of its doubts.
pub(crate) type Number<'a> = (f64, &'a [(Variable, f64)]);

/// Items over the last axes and a stack over the leading ones, with a form for each number where they are uncertain.
pub(crate) struct Quantity<T> {
    pub(crate) values: Stack<T>,
    forms: Option<Vec<Form>>,
    by_sigma: bool,
}

impl<T: Item> Quantity<T> {
    /// Numbers without doubts.
    fn known(values: Stack<T>) -> Self {
        Self {
            values,
            forms: None,
            by_sigma: false,
        }
    }

    /// Whether its numbers have doubts.
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

/// A positive number of which a body has that much more or less mass: with the form of its relative doubt.
pub(crate) struct Weight {
    pub(crate) value: f64,
    pub(crate) relative: Form,
}

impl<'py> FromPyObject<'_, 'py> for Weight {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let uncertain = match object.extract::<f64>() {
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
pub(super) fn rotation_of<'py>(
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
        Err(_) => joined(object)?,
    };
    match found {
        Some(uncertain) => Ok((uncertain.get().value(object.py())?, Some(uncertain))),
        None => Ok((object.clone(), None)),
    }
}

/// Deeper lists are looked at by `joined`.
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
    Ok(is_about_values(fault, object.py()) && joined(object)?.is_some())
}

/// Reads an argument that may be an `Uncertain`, or hold such or numbers of the package `uncertainties`.
pub(crate) fn quantity<T: Item>(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Quantity<T>> {
    if let Ok(uncertain) = object.cast::<PyUncertain>() {
        return with_forms(uncertain, name);
    }
    // Plain numbers are not asked: what has a sigma is refused first.
    match read(object, name) {
        Ok(values) => Ok(Quantity::known(values)),
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
            Ok(values) => Ok(Quantity::known(values)),
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
    argument.given().map_or_else(
        || Ok(Quantity::known(Stack::one(default))),
        |object| quantity(object, name),
    )
}

/// The `Uncertain` that numbers of the package `uncertainties` become, or a list of numbers among which some are uncertain;
/// nothing of what else was refused.
fn joined<'py>(object: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyUncertain>>> {
    let found = object
        .py()
        .import("polhode.uncertainty")?
        .call_method1("joined", (object,))?;
    Ok(found.cast_into::<PyUncertain>().ok())
}

/// As [`joined`], of an argument that was refused for this fault.
fn joined_or<'py>(object: &Bound<'py, PyAny>, fault: PyErr) -> PyResult<Bound<'py, PyUncertain>> {
    // Ctrl-C and lack of memory end the call at once.
    if is_about_values(&fault, object.py()) {
        joined(object)?.ok_or(fault)
    } else {
        Err(fault)
    }
}

fn is_about_values(fault: &PyErr, py: Python<'_>) -> bool {
    fault.is_instance_of::<PyTypeError>(py) || fault.is_instance_of::<PyValueError>(py)
}

/// The relative doubt of an amount, as a factor of one.
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

/// A number without doubts.
pub(crate) fn known(value: f64) -> Number<'static> {
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
