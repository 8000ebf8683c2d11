//! Where a body's numbers come from, and how well they are known.

use polhode::RigidBody;
use polhode::mass::provenance::BodySource;
use polhode::mass::{ErrorBound, Provenance};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{read_scalar, write_any_of, write_numbers_of, write_words_of};
use crate::body::PyRigidBody;

#[pymethods]
impl PyRigidBody {
    /// Origin of the numbers: what the body was made of, what was checked, and what was changed.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    /// >>> faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    /// >>> print(RigidBody.from_mesh(corners, faces, density=6.0).provenance)
    /// mesh of 4 elements; checked: indices, finite, closed, winding, orientation, volume, duplicates, cavities; moments from the second moment
    #[getter]
    fn provenance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let provenance = self.bodies.map(py, RigidBody::provenance)?;
        let words = |of: fn(&Provenance) -> String| write_words_of(py, &provenance, of, "str");
        let counts = |of: fn(&Provenance) -> usize| -> PyResult<Bound<'py, PyAny>> {
            if provenance.is_one() {
                return of(&provenance[0]).into_bound_py_any(py);
            }
            write_any_of(py, &provenance, |p| {
                i64::try_from(of(p)).unwrap_or(i64::MAX)
            })
        };
        let closure = |p: &Provenance| p.closure.map(|closure| closure.to_string());
        let fields = (
            words(|p| p.source.to_string())?,
            counts(|p| p.elements)?,
            words(|p| p.checks.to_string())?,
            counts(|p| p.welded)?,
            write_words_of(py, &provenance, |p| closure(p).unwrap_or_default(), "str")?,
            write_numbers_of(py, &provenance, |p| p.volume_change)?,
            words(|p| p.moments.to_string())?,
            counts(|p| p.rounded_to_zero.into())?,
            write_numbers_of(py, &provenance, |p| p.rounding)?,
        );
        py.import("polhode.results")?
            .getattr("Provenance")?
            .call1(fields)
    }

    /// Bounds on the rounding errors of mass, centre of mass and tensor.
    ///
    /// The bounds are on the difference from exact arithmetic with the same input. They are worst cases,
    /// mostly far above the actual errors. A number that was given directly has the bound zero. Errors of the
    /// input itself are not included.
    ///
    /// The error of a principal moment is at most three times the bound for the elements of the tensor, plus
    /// a few roundings of the trace. For thin bodies it is mostly much smaller; for particles in chunks see
    /// `MassAccumulator.moment_bounds`.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_particles([1.0, 2.0], [(0, 0, 0), (0.1, 0.2, 0.3)])
    /// >>> body.error_bound.inertia < 1e-13
    /// True
    #[getter]
    fn error_bound<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let of = |f: fn(&ErrorBound) -> f64| {
            write_numbers_of(py, &self.bodies, |body| f(&body.error_bound()))
        };
        let fields = (
            of(|bound| bound.mass)?,
            of(|bound| bound.center_of_mass)?,
            of(|bound| bound.inertia)?,
        );
        py.import("polhode.results")?
            .getattr("ErrorBound")?
            .call1(fields)
    }

    /// The same bodies, of atoms whose masses are `masses` and whose coordinates were rounded by at most `rounding` each.
    fn _of_atoms(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = read_scalar)] masses: &str,
        #[pyo3(from_py_with = read_scalar)] rounding: f64,
    ) -> PyResult<Self> {
        let source = match masses {
            "most_common" => BodySource::CommonIsotopes,
            "average" => BodySource::AverageAtoms,
            "own" => BodySource::OwnAtoms,
            other => {
                return Err(PyValueError::new_err(format!(
                    "masses: expected \"most_common\", \"average\" or \"own\", got \"{other}\""
                )));
            }
        };
        let of_atoms = |body: &RigidBody| {
            let provenance = Provenance {
                source,
                rounding,
                ..body.provenance()
            };
            body.with_provenance(provenance)
        };
        Ok(
            Self::with_uncertainty(self.bodies.map(py, of_atoms)?, self.uncertainties.clone())
                .with_shapes(self.figures.clone()),
        )
    }

    /// The same bodies, of meshes of which so many corners were joined to others on request.
    fn _welded(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = read_scalar)] corners: usize,
    ) -> PyResult<Self> {
        let welded = |body: &RigidBody| {
            let provenance = Provenance {
                welded: corners,
                ..body.provenance()
            };
            body.with_provenance(provenance)
        };
        Ok(
            Self::with_uncertainty(self.bodies.map(py, welded)?, self.uncertainties.clone())
                .with_shapes(self.figures.clone()),
        )
    }
}
