//! Sigmas and covariances given to bodies, and the covariances of their numbers.

use std::sync::Arc;

use nalgebra::Matrix3;
use numpy::PyArrayDyn;
use polhode::uncertainty::doubt::plus;
use polhode::uncertainty::follow::directly;
use polhode::uncertainty::{Doubt, Given, Source, check_possible};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{Numbers, floats, read, read_scalar};
use crate::body::PyRigidBody;
use crate::errors::{at_row, to_py, with_prefix};
use crate::memory;
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

/// An optional argument of any array-like kind.
type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

#[pymethods]
impl PyRigidBody {
    /// The body with additional standard deviations of its numbers.
    ///
    /// The new errors are independent of one another and of those that the body has already: the variances
    /// add. Measured numbers are seldom independent. If their covariance is known, use `with_covariance`.
    ///
    /// Parameters
    /// ----------
    /// mass : array_like, shape (...), optional
    /// center_of_mass : array_like, shape (..., 3), optional
    /// inertia : array_like, shape (..., 3, 3), optional
    ///     Standard deviations of the elements of the tensor about C, symmetric.
    /// source : str, optional
    ///     A name for the source of the errors, as of `Uncertain`.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     When no body can have these standard deviations: for example, a number that is zero because the
    ///     body has no extent along an axis cannot vary.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> brick = solids.box((1, 2, 3), mass=12.0).with_sigma(mass=0.1, center_of_mass=(0.01, 0.01, 0.02))
    /// >>> brick.sigma.mass, brick.translated((0, 0, 5)).sigma.center_of_mass
    /// (0.1, array([0.01, 0.01, 0.02]))
    #[pyo3(signature = (*, mass=None, center_of_mass=None, inertia=None, source=None))]
    fn with_sigma(
        &self,
        py: Python<'_>,
        mass: Argument<'_, '_>,
        center_of_mass: Argument<'_, '_>,
        inertia: Argument<'_, '_>,
        #[pyo3(from_py_with = read_scalar)] source: Option<&str>,
    ) -> PyResult<Self> {
        if mass.is_none() && center_of_mass.is_none() && inertia.is_none() {
            let message = "give at least one of mass=, center_of_mass= and inertia=";
            return Err(PyTypeError::new_err(message));
        }
        let mass = mass.map_or(Ok(Stack::one(0.0)), |mass| read(mass, "mass"))?;
        let center = center_of_mass.map_or(Ok(Stack::one([0.0; 3])), |center| {
            read(center, "center_of_mass")
        })?;
        let tensor: Stack<Matrix3<f64>> = inertia
            .map_or(Ok(Stack::one(Matrix3::zeros())), |tensor| {
                read(tensor, "inertia")
            })?;
        if let Some(row) = tensor.rows.iter().find(|row| **row != row.transpose()) {
            let message = format!(
                "inertia: expected symmetric standard deviations, got the rows {:?}",
                <[[f64; 3]; 3]>::from(row.transpose())
            );
            return Err(PyValueError::new_err(message));
        }
        let grid = Broadcast::of(
            ["body", "mass", "center_of_mass", "inertia"],
            [
                &self.bodies.shape,
                &mass.shape,
                &center.shape,
                &tensor.shape,
            ],
        )?;
        let flat: Vec<f64> = tensor
            .rows
            .iter()
            .flat_map(|row| row.iter().copied())
            .collect();
        for (name, numbers) in [
            ("mass", &mass.rows[..]),
            ("center_of_mass", center.rows.as_flattened()),
            ("inertia", &flat),
        ] {
            if let Err(fault) = Given::independent(numbers, Source::named("checked")) {
                return Err(with_prefix(py, name, &to_py(py, &fault)));
            }
        }
        let mut sigma = memory::vector("with_sigma", &[&grid.shape[..], &[10]].concat(), 0)?;
        for [_, m, c, i] in grid.rows() {
            sigma.push(mass[m]);
            sigma.extend(center[c]);
            sigma.extend(polhode::mass::ten::ELEMENTS.map(|place| tensor[i][place]));
        }
        let given = Given::independent(&sigma, named(source)).map_err(|error| to_py(py, &error))?;
        let bodies = grid.try_map(py, |[b, ..]| Ok(self.bodies[b]))?;
        let own: Vec<usize> = grid.rows().map(|[b, ..]| b).collect();
        self.with_given(py, bodies, &own, &given)
    }

    /// The body with its `error_bound`, of quadrature or rounding, turned into standard deviations.
    ///
    /// A number that is known to ± a gets the standard deviation a/√3, that of a uniform distribution, as the
    /// GUM recommends.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> ball = RigidBody.from_radial_density(lambda r: np.exp(-r), (0, 1), rtol=1e-3)
    /// >>> bool(ball.with_error_bound().sigma.mass == ball.error_bound.mass / 3**0.5)
    /// True
    fn with_error_bound(&self, py: Python<'_>) -> PyResult<Self> {
        let sigma: Vec<f64> = (self.bodies.rows.iter())
            .flat_map(|body| {
                let bound = body.error_bound();
                let (c, i) = (bound.center_of_mass, bound.inertia);
                [bound.mass, c, c, c, i, i, i, i, i, i].map(|half| half / 3.0_f64.sqrt())
            })
            .collect();
        let given =
            Given::independent(&sigma, Source::fresh()).map_err(|error| to_py(py, &error))?;
        let own: Vec<usize> = (0..self.bodies.rows.len()).collect();
        self.with_given(py, self.bodies.clone(), &own, &given)
    }

    /// The body with an additional covariance of its ten numbers.
    ///
    /// The new errors are independent of those that the body has already: the covariances add.
    ///
    /// Parameters
    /// ----------
    /// covariance : array_like, shape (10, 10)
    ///     Covariance of m, Cx, Cy, Cz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz: the tensor's elements about C, off the diagonal
    ///     *minus* the products.
    /// source : str, optional
    ///     A name for the source of the errors, as of `Uncertain`.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     For a matrix that is no covariance.
    /// InvalidInertiaError
    ///     When no body can have this covariance.
    #[pyo3(signature = (covariance, source=None))]
    fn with_covariance(
        &self,
        py: Python<'_>,
        covariance: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = read_scalar)] source: Option<&str>,
    ) -> PyResult<Self> {
        let covariance = floats(covariance, "covariance")?;
        let shape = numpy::PyUntypedArrayMethods::shape(&*covariance);
        if shape != [10, 10] {
            let message = format!("covariance: expected shape (10, 10), got {}", tuple(shape));
            return Err(PyValueError::new_err(message));
        }
        if !self.bodies.is_one() {
            let message = "with_covariance: expected one body, got a stack; pick them one by one, and put them together by \
                           RigidBody.stack";
            return Err(PyValueError::new_err(message));
        }
        let given = Given::correlated(covariance.as_slice()?, named(source))
            .map_err(|error| to_py(py, &error))?;
        self.with_given(py, self.bodies.clone(), &[0], &given)
    }

    /// Covariance of m, Cx, Cy, Cz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz (the tensor's elements about C, off the diagonal *minus* the
    /// products), shape (..., 10, 10); None where nothing is uncertain.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import Uncertain, solids
    /// >>> ball = solids.sphere(Uncertain(1.0, 0.01), mass=5.0)
    /// >>> ball.covariance[4, 4].round(6), solids.sphere(1.0, mass=5.0).covariance
    /// (np.float64(0.0016), None)
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
        match &self.doubts {
            None => Ok(None),
            Some(_) => self.covariance_with(py, self).map(Some),
        }
    }

    /// Covariance of the ten numbers of one body with those of another, caused by sources of error that they
    /// share.
    ///
    /// Parameters
    /// ----------
    /// other : RigidBody
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 10, 10)
    ///     Rows are the numbers of this body, columns those of the other, in the order of `covariance`.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import Uncertain, solids
    /// >>> radius = Uncertain(1.0, 0.01, source="drawing")
    /// >>> a, b = solids.sphere(radius, density=1.0), solids.sphere(radius, density=2.0)
    /// >>> a.covariance_with(b)[0, 0] / (a.sigma.mass * b.sigma.mass)
    /// np.float64(1.0)
    fn covariance_with<'py>(
        &self,
        py: Python<'py>,
        other: &Self,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let shapes = [&self.bodies.shape[..], &other.bodies.shape];
        let grid = Broadcast::of(["body", "other"], shapes)?;
        let mut numbers =
            Numbers::of::<[f64; 10]>(py, "covariance", &[&grid.shape[..], &[10]].concat())?;
        numbers.put(grid.rows(), |[a, b], out| {
            let both = self.row(a).1.covariance_with(other.row(b).1);
            out.extend(both.transpose().as_slice()); // nalgebra stores columns
        })?;
        numbers.finish::<[f64; 10]>(&[&grid.shape[..], &[10]].concat())
    }
}

fn named(source: Option<&str>) -> Source {
    source.map_or_else(Source::fresh, Source::named)
}

impl PyRigidBody {
    /// Bodies with ten given forms for each, besides the doubts of the rows they are of.
    fn with_given(
        &self,
        py: Python<'_>,
        bodies: Stack<polhode::RigidBody>,
        own: &[usize],
        given: &Given,
    ) -> PyResult<Self> {
        let rows = (own.iter().zip(given.forms.as_chunks::<10>().0))
            .map(|(&row, forms)| {
                let (before, more) = (self.row(row).1, directly(forms));
                let bends = std::array::from_fn(|k| plus(&before.bends[k], &more.bends[k]));
                Doubt::of([&before.tangents[..], &more.tangents].concat(), bends)
            })
            .collect();
        let figures = self.figures_of(own.iter().copied());
        Self::doubtful(bodies, Some(Arc::new(rows)))
            .looking(figures)
            .possible(py)
    }

    /// The bodies, when bodies can have these doubts.
    pub(crate) fn possible(self, py: Python<'_>) -> PyResult<Self> {
        for (row, doubt) in self
            .doubts
            .iter()
            .flat_map(|doubts| doubts.iter())
            .enumerate()
        {
            check_possible(&self.bodies[row], doubt)
                .map_err(|error| at_row(&self.bodies.shape, row, &to_py(py, &error), py))?;
        }
        Ok(self)
    }
}
