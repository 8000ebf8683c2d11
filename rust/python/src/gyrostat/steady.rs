//! The steady rotations of a gyrostat.

use nalgebra::{Matrix3, Vector3};
use numpy::{PyArray1, PyArrayMethods};
use polhode::motion::gyrostat::equilibria::{
    Bifurcation, Equilibria, Equilibrium, Extent, Meeting,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::PyGyrostat;
use super::motion::PyGyrostatMotion;
use crate::arrays::{read_scalar, write_of, write_words_of};
use crate::errors::to_py;
use crate::stack::Stack;

#[pymethods]
impl PyGyrostat {
    /// All steady rotations with a given length of L = I ω + h, and whether they are stable.
    ///
    /// Parameters
    /// ----------
    /// momentum : float
    ///     The length of L.
    ///
    /// Returns
    /// -------
    /// Equilibria
    ///     Two, four or six steady rotations. For a body with two equal moments, an entry may stand for a
    ///     circle of them.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a stack. For free wheels too, since their h depends on ω at the start; use
    ///     :attr:`GyrostatMotion.equilibria`.
    ///
    /// Examples
    /// --------
    /// A wheel along the middle axis makes the spin about that axis stable, if it has enough momentum:
    ///
    /// >>> import polhode
    /// >>> body = polhode.RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> print(*body.gyrostat((0, 0.2, 0)).equilibria(2.0).kind)
    /// minimum minimum saddle saddle maximum maximum
    /// >>> print(*body.gyrostat((0, 2.5, 0)).equilibria(2.0).kind)
    /// minimum maximum
    fn equilibria<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] momentum: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let [one] = &self.gyrostats.rows[..] else {
            return Err(PyValueError::new_err(
                "equilibria: expected one gyrostat, got a stack; ask them one by one",
            ));
        };
        if one.inside.free.iter().flatten().any(|x| x.high != 0.0) {
            return Err(PyValueError::new_err(
                "equilibria: the momentum of free wheels depends on ω at the start; ask `equilibria` of the motion, or give \
                 momentum= in place of wheels",
            ));
        }
        let found = one
            .equilibria(momentum, &Vector3::zeros())
            .map_err(|error| to_py(py, &error))?;
        table(py, found)
    }

    /// Inertia tensor in the equations of motion, in the body frame, shape (..., 3, 3).
    ///
    /// It is that of the body minus ``J a aᵀ`` of each free wheel, whose moment about its axis does not
    /// count.
    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let tensor = |one: &polhode::motion::gyrostat::Gyrostat| -> Matrix3<f64> { one.inertia() };
        Ok(write_of(py, &self.gyrostats, tensor)?.into_any())
    }
}

#[pymethods]
impl PyGyrostatMotion {
    /// All steady rotations with the length of L and the h of this motion, as :meth:`Gyrostat.equilibria`
    /// gives them.
    #[getter]
    fn equilibria<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let ([motion], [gyrostat]) = (
            &self.motions.rows[..],
            &self.gyrostat.get().gyrostats.rows[..],
        ) else {
            return Err(PyValueError::new_err(
                "equilibria: expected one motion, got a stack; ask them one by one",
            ));
        };
        let momentum = motion.angular_momentum.norm();
        let found = gyrostat
            .equilibria(momentum, &motion.initial.omega)
            .map_err(|error| to_py(py, &error))?;
        table(py, found)
    }
}

/// As `polhode.motion.gyrostat.Equilibria`.
fn table(py: Python<'_>, found: Equilibria) -> PyResult<Bound<'_, PyAny>> {
    let stack = |count: usize| vec![count];
    let all = Stack {
        shape: stack(found.found.len()),
        rows: found.found,
    };
    let changes = Stack {
        shape: stack(found.bifurcations.len()),
        rows: found.bifurcations,
    };
    let circle = |one: &Equilibrium| match one.extent {
        Extent::Circle(axis) => axis,
        Extent::Point | Extent::Sphere => [0.0; 3],
    };
    let word = |one: &Bifurcation| match one.meeting {
        Meeting::Fold => "fold",
        Meeting::Pitchfork => "pitchfork",
    };
    let module = py.import("polhode.motion.gyrostat")?;
    let bifurcations = module.getattr("Bifurcations")?.call1((
        write_words_of(py, &changes, word, "<U9")?,
        write_of(py, &changes, |one| one.direction)?,
        numbers(py, &changes, |one| one.momentum)?,
        numbers(py, &changes, |one| one.rotor)?,
    ))?;
    module.getattr("Equilibria")?.call1((
        write_of(py, &all, |one| one.direction)?,
        write_of(py, &all, |one| one.omega)?,
        numbers(py, &all, |one| one.kinetic_energy)?,
        numbers(py, &all, |one| one.squared_rate)?,
        write_words_of(py, &all, |one| one.kind.as_str(), "<U10")?,
        write_of(py, &all, circle)?,
        bifurcations,
    ))
}

fn numbers<'py, T>(
    py: Python<'py>,
    stack: &Stack<T>,
    of: impl Fn(&T) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    let numbers: Vec<f64> = stack.rows.iter().map(of).collect();
    Ok(PyArray1::from_vec(py, numbers)
        .reshape(stack.shape.clone())?
        .into_any())
}
