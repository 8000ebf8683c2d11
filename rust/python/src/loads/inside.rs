//! What a body carries along under a load, asked for outside a run: momentum, energy, states.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::motion::loads::{Carried, Term};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::load::PyLoad;
use crate::arrays::{read, write_of};
use crate::stack::{Broadcast, Stack};

/// An array of float64.
type Floats<'py> = Bound<'py, PyArrayDyn<f64>>;

#[pymethods]
impl PyLoad {
    /// Angular momentum and energy of the wheels, rotors and slugs of the load, in addition to ``I ω`` and
    /// ``½ ω·I ω``. A rotor adds angular momentum, but no energy.
    ///
    /// Parameters
    /// ----------
    /// t : array_like, shape (...)
    /// omega : array_like, shape (..., 3)
    /// states : dict of str and array_like, shape (..., k), optional
    ///
    /// Returns
    /// -------
    /// momentum : numpy.ndarray, shape (..., 3)
    ///     Angular momentum, components in the body frame.
    /// energy : numpy.ndarray, shape (...)
    #[pyo3(signature = (t, omega, states=None))]
    fn carried<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        omega: &Bound<'py, PyAny>,
        states: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Floats<'py>, Floats<'py>)> {
        let (terms, t): (_, Stack<f64>) = (self.terms(py)?, read(t, "t")?);
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let states = self.read_states(states, true)?;
        let shapes = [&terms.shape[..], &t.shape, &omega.shape, &states.shape];
        let grid = Broadcast::of(["load", "t", "omega", "states"], shapes)?;
        let found = grid.try_map(py, |[l, k, w, s]| {
            Ok(carried_along(&terms[l], t[k], &omega[w], &states[s]))
        })?;
        Ok((
            write_of(py, &found, |found| found.0)?,
            write_of(py, &found, |found| found.1)?,
        ))
    }

    /// Whether the load has wheels, rotors or slugs, which the body carries.
    #[getter]
    fn carries(&self, py: Python<'_>) -> PyResult<bool> {
        let terms = self.terms(py)?;
        Ok(terms
            .rows
            .iter()
            .flatten()
            .any(|term| term.carried().is_some()))
    }

    /// Number of states of the load, by name.
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        for slot in self.slots() {
            named.set_item(slot.name, slot.count)?;
        }
        Ok(named)
    }
}

/// What the terms carry along at a time: momentum beside I ω and energy beside ½ ω·I ω, from the states as they are reported.
fn carried_along(
    terms: &[Term],
    t: f64,
    omega: &Vector3<f64>,
    reported: &[f64],
) -> (Vector3<f64>, f64) {
    let (mut momentum, mut energy, mut first) = (Vector3::zeros(), 0.0, 0);
    for carried in terms.iter().filter_map(Term::carried) {
        let mine = reported
            .get(first..first + carried.count())
            .unwrap_or_default();
        first += carried.count();
        let own = own_of(carried, mine, t, omega);
        momentum += carried.momentum(&own, omega);
        energy += carried.energy(&own, omega);
    }
    (momentum, energy)
}

fn own_of(carried: &dyn Carried, reported: &[f64], t: f64, omega: &Vector3<f64>) -> Vec<f64> {
    if carried.count() == 0 {
        Vec::new()
    } else {
        carried.resumed(reported, t, omega)
    }
}
