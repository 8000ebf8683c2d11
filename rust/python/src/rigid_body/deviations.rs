//! Standard deviations of what a body has, as Python sees them.

use nalgebra::{Matrix3, Vector3};
use polhode::mass::ten::place;
use polhode::uncertainty::{Deviations, deviations, deviations_about};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::about::points;
use crate::arrays::{write_numbers_of, write_of};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

#[pymethods]
impl PyRigidBody {
    /// Standard deviations of mass, centre of mass, tensor, principal moments and axes, and radii of
    /// gyration; None where nothing is uncertain.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import Uncertain, solids
    /// >>> brick = solids.box(Uncertain((1, 2, 3), sigma=0.01), density=2.0)
    /// >>> round(brick.sigma.mass, 4), brick.sigma.principal_moments.round(4)
    /// (0.14, array([0.097 , 0.16  , 0.1965]))
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let found = self.deviations(py, None)?;
        found.map(|found| sigma_of(py, &found)).transpose()
    }

    /// Standard deviations as `sigma`, with tensor, principal moments, principal axes and radii of gyration
    /// about a given point.
    ///
    /// Parameters
    /// ----------
    /// point : {"center_of_mass", "origin"} or array_like, shape (..., 3)
    ///
    /// Returns
    /// -------
    /// Sigma or None
    ///
    /// Examples
    /// --------
    /// A disk on an axle that is not at its centre: the uncertainty of the distance counts.
    ///
    /// >>> from polhode import Uncertain, laminae
    /// >>> disk = laminae.disk(0.2, mass=Uncertain(5.0, 0.01)).translated(Uncertain((0.1, 0, 0), (0.001, 0, 0)))
    /// >>> round(disk.sigma_about("origin").inertia[2, 2], 5), round(disk.sigma.inertia[2, 2], 5)
    /// (np.float64(0.00104), np.float64(0.0002))
    fn sigma_about<'py>(
        &self,
        py: Python<'py>,
        point: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let points = points(py, &self.bodies, Some(point), "point")?;
        let found = self.deviations(py, Some(&points))?;
        found.map(|found| sigma_of(py, &found)).transpose()
    }
}

/// As `polhode.results.Sigma`.
fn sigma_of<'py>(py: Python<'py>, found: &Stack<Deviations>) -> PyResult<Bound<'py, PyAny>> {
    let center = |d: &Deviations| -> [f64; 3] { std::array::from_fn(|k| d.numbers[1 + k]) };
    let tensor = |d: &Deviations| Matrix3::from_fn(|i, j| d.numbers[4 + place(i, j)]);
    let results = py.import("polhode.results")?;
    let linear = results.getattr("Linear")?.call1((
        flags(py, found, &[], |d, out| out.push(d.is_linear[0]))?,
        flags(py, found, &[3], |d, out| out.extend(&d.is_linear[1..4]))?,
        flags(py, found, &[3, 3], |d, out| {
            out.extend((0..9).map(|k| d.is_linear[4 + place(k / 3, k % 3)]));
        })?,
        flags(py, found, &[3], |d, out| out.extend(d.moments_are_linear))?,
        flags(py, found, &[3], |d, out| out.extend(d.axes_are_linear))?,
        flags(py, found, &[3], |d, out| out.extend(d.radii_are_linear))?,
    ))?;
    results.getattr("Sigma")?.call1((
        write_numbers_of(py, found, |d| d.numbers[0])?,
        write_of(py, found, center)?,
        write_of(py, found, tensor)?,
        write_of(py, found, |d| d.moments)?,
        write_of(py, found, |d| d.axes)?,
        write_of(py, found, |d| d.radii)?,
        linear,
    ))
}

/// Gives a `polhode.results.PrincipalAxes` its twin.
fn with_twin<'py>(
    principal: Bound<'py, PyAny>,
    found: Option<&Stack<Deviations>>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(found) = found else {
        return Ok(principal);
    };
    let py = principal.py();
    let module = py.import("polhode.principal")?;
    let linear = module.getattr("PrincipalLinear")?.call1((
        flags(py, found, &[3], |d, out| out.extend(d.moments_are_linear))?,
        flags(py, found, &[3], |d, out| out.extend(d.axes_are_linear))?,
    ))?;
    let sigma = module.getattr("PrincipalSigma")?.call1((
        write_of(py, found, |d| d.moments)?,
        write_of(py, found, |d| d.axes)?,
        linear,
    ))?;
    // The class is frozen for those who use it.
    principal.getattr("__dict__")?.set_item("sigma", sigma)?;
    Ok(principal)
}

/// An array of flags; one flag for one value without axes.
fn flags<'py>(
    py: Python<'py>,
    found: &Stack<Deviations>,
    tail: &[usize],
    of: impl Fn(&Deviations, &mut Vec<bool>),
) -> PyResult<Bound<'py, PyAny>> {
    let mut all = Vec::new();
    found.rows.iter().for_each(|d| of(d, &mut all));
    let shape = [&found.shape[..], tail].concat();
    if shape.is_empty() {
        return Ok(all[0].into_pyobject(py)?.to_owned().into_any());
    }
    numpy::PyArray1::from_vec(py, all).call_method1("reshape", (PyTuple::new(py, shape)?,))
}

impl PyRigidBody {
    /// The standard deviations of each row, about C or about points of the body frame; nothing where nothing is uncertain.
    fn deviations(
        &self,
        py: Python<'_>,
        points: Option<&Stack<Vector3<f64>>>,
    ) -> PyResult<Option<Stack<Deviations>>> {
        if self.doubts.is_none() {
            return Ok(None);
        }
        let of = |row: usize| (&self.bodies[row], self.row(row).1);
        let found = match points {
            None => Broadcast::of(["body"], [&self.bodies.shape])?.try_map(py, |[row]| {
                let (body, doubt) = of(row);
                Ok(deviations(body, doubt))
            }),
            Some(points) => self.with("point", points)?.try_map(py, |[row, p]| {
                let (body, doubt) = of(row);
                body.check_about(&points[p])?;
                deviations_about(body, doubt, &points[p])
            }),
        };
        found.map(Some)
    }

    /// As `polhode.results.PrincipalAxes`, with the deviations about C or about these points.
    pub(crate) fn with_sigma_of_axes<'py>(
        &self,
        principal: Bound<'py, PyAny>,
        points: Option<&Stack<Vector3<f64>>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let found = self.deviations(principal.py(), points)?;
        with_twin(principal, found.as_ref())
    }
}
