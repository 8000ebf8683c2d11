//! How a term was made: the function of `polhode.loads` and its arguments, by which it is pickled and described.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::interrupt::Beat;

/// The name of a function and its arguments as a tuple.
pub(super) fn recipe<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyResult<Py<PyTuple>> {
    let arguments = arguments.into_pyobject(py)?;
    Ok((name, arguments).into_pyobject(py)?.unbind())
}

/// A recipe of recipes, innermost first. There may be very many: no function here calls itself for each.
pub(super) fn unfold<'py>(
    recipe: &Bound<'py, PyTuple>,
) -> PyResult<Vec<(String, Bound<'py, PyTuple>)>> {
    let mut steps: Vec<(String, Bound<'py, PyTuple>)> = vec![recipe.extract()?];
    let mut beat = Beat::new(recipe.py());
    while let Some((name, arguments)) = steps.last()
        && ["_scaled", "_scheduled", "_picked", "_with_epoch"].contains(&name.as_str())
    {
        beat.mark()?;
        steps.push(arguments.get_item(0)?.extract()?);
    }
    steps.reverse();
    Ok(steps)
}

/// A recipe in words: the function that made the term, and what was done to it.
pub(super) fn describe(recipe: &Bound<'_, PyTuple>) -> PyResult<String> {
    let (mut before, mut after) = (Vec::new(), 0);
    let steps = unfold(recipe)?;
    for (name, arguments) in steps[1..].iter().rev() {
        match name.as_str() {
            "_scaled" => {
                let factor: f64 = arguments.get_item(1)?.extract()?;
                before.push(format!("{factor:?} * "));
            }
            "_scheduled" => {
                before.push("schedule(".to_owned());
                after += 1;
            }
            _ => (),
        }
    }
    let made_by = match steps[0].0.as_str() {
        "_unpicklable" => "compiled",
        name => name,
    };
    Ok(format!("{}{made_by}{}", before.concat(), ")".repeat(after)))
}
