//! Doubts as arrays, for pickles and files.

use std::sync::Arc;

use numpy::{PyArray1, PyArrayMethods};
use polhode::uncertainty::{Doubt, PROBES, Tangent, Variable};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::floats;
use crate::body::PyRigidBody;

/// Numbers of the second-order terms of one body.
const BENDS: usize = PROBES * 10;

#[pymethods]
impl PyRigidBody {
    /// The doubts as arrays: how many variables each body depends on, the variables (n, 2) in halves of their numbers, the
    /// tangents (n, 10), and the second-order terms (bodies, 16, 10); nothing of bodies without.
    #[pyo3(name = "_doubts")]
    pub(crate) fn stored_doubts<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(doubts) = &self.doubts else {
            return Ok(None);
        };
        let all = || doubts.iter().flat_map(|doubt| &doubt.tangents);
        let counts: Vec<i64> = (doubts.iter())
            .map(|doubt| i64::try_from(doubt.tangents.len()).unwrap_or(i64::MAX))
            .collect();
        let words: Vec<u64> = all()
            .flat_map(|(variable, _)| variable.to_words())
            .collect();
        let tangents: Vec<f64> = all().flat_map(|(_, change)| change.to_array()).collect();
        let bends: Vec<f64> = (doubts.iter())
            .flat_map(|doubt| doubt.bends.iter().flat_map(Tangent::to_array))
            .collect();
        let count = words.len() / 2;
        let state = PyDict::new(py);
        state.set_item("counts", PyArray1::from_vec(py, counts))?;
        state.set_item(
            "variables",
            PyArray1::from_vec(py, words).reshape((count, 2))?,
        )?;
        state.set_item(
            "tangents",
            PyArray1::from_vec(py, tangents).reshape((count, 10))?,
        )?;
        state.set_item(
            "bends",
            PyArray1::from_vec(py, bends).reshape((doubts.len(), PROBES, 10))?,
        )?;
        Ok(Some(state))
    }

    /// First- and second-order terms of the ten numbers of one body along its probes, shape (2, 16, 10).
    fn _probes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let doubt = self.row(0).1;
        let terms = [doubt.slopes(), doubt.bends].concat();
        let numbers: Vec<f64> = terms.iter().flat_map(Tangent::to_array).collect();
        PyArray1::from_vec(py, numbers).call_method1("reshape", ((2, PROBES, 10),))
    }
}

impl PyRigidBody {
    /// The same bodies with the doubts that [`Self::stored_doubts`] took apart.
    pub(crate) fn with_doubts(&self, state: &Bound<'_, PyDict>) -> PyResult<Self> {
        let item = |name: &str| {
            state
                .get_item(name)?
                .ok_or_else(|| damaged(&format!("{name} is missing")))
        };
        let counts: Vec<usize> = item("counts")?.call_method0("tolist")?.extract()?;
        let variables: Vec<[u64; 2]> = item("variables")?.call_method0("tolist")?.extract()?;
        let tangents = floats(&item("tangents")?, "tangents")?;
        let bends = floats(&item("bends")?, "bends")?;
        let (tangents, bends) = (tangents.as_slice()?, bends.as_slice()?);
        let rows = self.bodies.rows.len();
        let is_whole = counts.len() == rows
            && counts.iter().sum::<usize>() == variables.len()
            && tangents.len() == 10 * variables.len()
            && bends.len() == BENDS * rows;
        if !is_whole {
            return Err(damaged("its arrays are not of one size"));
        }
        if tangents.iter().chain(bends).any(|x| !x.is_finite()) {
            return Err(damaged("a number is not finite"));
        }
        let mut all = variables.iter().zip(tangents.as_chunks::<10>().0);
        let doubts = (counts.iter().zip(bends.as_chunks::<BENDS>().0))
            .map(|(&count, bends)| {
                let tangents = (all.by_ref().take(count))
                    .map(|(&words, change)| {
                        (Variable::from_words(words), Tangent::from_array(change))
                    })
                    .collect();
                let bends = std::array::from_fn(|probe| {
                    Tangent::from_array(&bends.as_chunks::<10>().0[probe])
                });
                Doubt::of(tangents, bends)
            })
            .collect();
        Ok(Self {
            doubts: Some(Arc::new(doubts)),
            ..self.clone()
        })
    }
}

fn damaged(what: &str) -> PyErr {
    PyValueError::new_err(format!("doubts: not what was stored: {what}"))
}
