//! Sigmas and covariances given to bodies, and the covariances of their numbers.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use polhode::mass::inertial_parameters::place;
use polhode::uncertainty::linear_uncertainty::plus;
use polhode::uncertainty::propagate::directly;
use polhode::uncertainty::{
    LinearForms, LinearUncertainty, PROBES, Sigma, Source, Tangent, Variable, check_covariance,
    sigma, sigma_about,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::about::points;
use crate::arrays::{Numbers, floats, read, read_scalar, write_numbers_of, write_of};
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
            if let Err(fault) = LinearForms::independent(numbers, Source::named("checked")) {
                return Err(with_prefix(py, name, &to_py(py, &fault)));
            }
        }
        let mut sigma = memory::vector("with_sigma", &[&grid.shape[..], &[10]].concat(), 0)?;
        for [_, m, c, i] in grid.rows() {
            sigma.push(mass[m]);
            sigma.extend(center[c]);
            sigma
                .extend(polhode::mass::inertial_parameters::ELEMENTS.map(|place| tensor[i][place]));
        }
        let given = LinearForms::independent(&sigma, from_name(source))
            .map_err(|error| to_py(py, &error))?;
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
            LinearForms::independent(&sigma, Source::fresh()).map_err(|error| to_py(py, &error))?;
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
        let given = LinearForms::correlated(covariance.as_slice()?, from_name(source))
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
        match &self.uncertainties {
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

fn from_name(source: Option<&str>) -> Source {
    source.map_or_else(Source::fresh, Source::named)
}

impl PyRigidBody {
    /// Bodies with ten given forms for each, besides the uncertainties of the rows they are of.
    fn with_given(
        &self,
        py: Python<'_>,
        bodies: Stack<polhode::RigidBody>,
        own: &[usize],
        given: &LinearForms,
    ) -> PyResult<Self> {
        let rows = (own.iter().zip(given.forms.as_chunks::<10>().0))
            .map(|(&row, forms)| {
                let (before, more) = (self.row(row).1, directly(forms));
                let second_order =
                    std::array::from_fn(|k| plus(&before.second_order[k], &more.second_order[k]));
                LinearUncertainty::of(
                    [&before.tangents[..], &more.tangents].concat(),
                    second_order,
                )
            })
            .collect();
        let figures = self.figures_of(own.iter().copied());
        Self::with_uncertainty(bodies, Some(Arc::new(rows)))
            .with_shapes(figures)
            .possible(py)
    }

    /// The bodies, when bodies can have these uncertainties.
    pub(crate) fn possible(self, py: Python<'_>) -> PyResult<Self> {
        for (row, uncertainty) in self
            .uncertainties
            .iter()
            .flat_map(|uncertainties| uncertainties.iter())
            .enumerate()
        {
            check_covariance(&self.bodies[row], uncertainty)
                .map_err(|error| at_row(&self.bodies.shape, row, &to_py(py, &error), py))?;
        }
        Ok(self)
    }
}

// Standard deviations of what a body has, as Python sees them.

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
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3)
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
        about: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let points = points(py, &self.bodies, Some(about), "about")?;
        let found = self.deviations(py, Some(&points))?;
        found.map(|found| sigma_of(py, &found)).transpose()
    }
}

/// As `polhode.results.Sigma`.
fn sigma_of<'py>(py: Python<'py>, found: &Stack<Sigma>) -> PyResult<Bound<'py, PyAny>> {
    let center = |d: &Sigma| -> [f64; 3] { std::array::from_fn(|k| d.numbers[1 + k]) };
    let tensor = |d: &Sigma| Matrix3::from_fn(|i, j| d.numbers[4 + place(i, j)]);
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

/// Attach the standard deviations to a `polhode.results.PrincipalAxes`.
fn attach_sigma<'py>(
    principal: Bound<'py, PyAny>,
    found: Option<&Stack<Sigma>>,
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
    found: &Stack<Sigma>,
    tail: &[usize],
    of: impl Fn(&Sigma, &mut Vec<bool>),
) -> PyResult<Bound<'py, PyAny>> {
    let mut all = Vec::new();
    found.rows.iter().for_each(|d| of(d, &mut all));
    let shape = [&found.shape[..], tail].concat();
    if shape.is_empty() {
        return Ok(all[0].into_pyobject(py)?.to_owned().into_any());
    }
    PyArray1::from_vec(py, all).call_method1("reshape", (PyTuple::new(py, shape)?,))
}

impl PyRigidBody {
    /// The standard deviations of each row, about C or about points of the body frame; nothing where nothing is uncertain.
    fn deviations(
        &self,
        py: Python<'_>,
        points: Option<&Stack<Vector3<f64>>>,
    ) -> PyResult<Option<Stack<Sigma>>> {
        if self.uncertainties.is_none() {
            return Ok(None);
        }
        let of = |row: usize| (&self.bodies[row], self.row(row).1);
        let found = match points {
            None => Broadcast::of(["body"], [&self.bodies.shape])?.try_map(py, |[row]| {
                let (body, uncertainty) = of(row);
                Ok(sigma(body, uncertainty))
            }),
            Some(points) => self.with("point", points)?.try_map(py, |[row, p]| {
                let (body, uncertainty) = of(row);
                body.check_about(&points[p])?;
                sigma_about(body, uncertainty, &points[p])
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
        attach_sigma(principal, found.as_ref())
    }
}

// Uncertainties as arrays, for pickles and files.

/// Numbers of the second-order terms of one body.
const SECOND_ORDER: usize = PROBES * 10;

#[pymethods]
impl PyRigidBody {
    /// The uncertainties as arrays: how many variables each body depends on, the variables (n, 2) in halves of their numbers, the
    /// tangents (n, 10), and the second-order terms (bodies, 16, 10); nothing of bodies without.
    #[pyo3(name = "_doubts")]
    pub(crate) fn stored_uncertainties<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(uncertainties) = &self.uncertainties else {
            return Ok(None);
        };
        let all = || {
            uncertainties
                .iter()
                .flat_map(|uncertainty| &uncertainty.tangents)
        };
        let counts: Vec<i64> = (uncertainties.iter())
            .map(|uncertainty| i64::try_from(uncertainty.tangents.len()).unwrap_or(i64::MAX))
            .collect();
        let words: Vec<u64> = all()
            .flat_map(|(variable, _)| variable.to_words())
            .collect();
        let tangents: Vec<f64> = all().flat_map(|(_, change)| change.to_array()).collect();
        let second_order: Vec<f64> = (uncertainties.iter())
            .flat_map(|uncertainty| uncertainty.second_order.iter().flat_map(Tangent::to_array))
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
            PyArray1::from_vec(py, second_order).reshape((uncertainties.len(), PROBES, 10))?,
        )?;
        Ok(Some(state))
    }

    /// First- and second-order terms of the ten numbers of one body along its probes, shape (2, 16, 10).
    fn _probes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let uncertainty = self.row(0).1;
        let terms = [uncertainty.slopes(), uncertainty.second_order].concat();
        let numbers: Vec<f64> = terms.iter().flat_map(Tangent::to_array).collect();
        PyArray1::from_vec(py, numbers).call_method1("reshape", ((2, PROBES, 10),))
    }
}

impl PyRigidBody {
    /// The same bodies with the uncertainties that [`Self::stored_uncertainties`] took apart.
    pub(crate) fn with_uncertainties(&self, state: &Bound<'_, PyDict>) -> PyResult<Self> {
        let item = |name: &str| {
            state
                .get_item(name)?
                .ok_or_else(|| damage_error(&format!("{name} is missing")))
        };
        let counts: Vec<usize> = item("counts")?.call_method0("tolist")?.extract()?;
        let variables: Vec<[u64; 2]> = item("variables")?.call_method0("tolist")?.extract()?;
        let tangents = floats(&item("tangents")?, "tangents")?;
        let second_order = floats(&item("bends")?, "bends")?;
        let (tangents, second_order) = (tangents.as_slice()?, second_order.as_slice()?);
        let rows = self.bodies.rows.len();
        let is_whole = counts.len() == rows
            && counts.iter().sum::<usize>() == variables.len()
            && tangents.len() == 10 * variables.len()
            && second_order.len() == SECOND_ORDER * rows;
        if !is_whole {
            return Err(damage_error("its arrays are not of one size"));
        }
        if tangents.iter().chain(second_order).any(|x| !x.is_finite()) {
            return Err(damage_error("a number is not finite"));
        }
        let mut all = variables.iter().zip(tangents.as_chunks::<10>().0);
        let uncertainties = (counts
            .iter()
            .zip(second_order.as_chunks::<SECOND_ORDER>().0))
        .map(|(&count, second_order)| {
            let tangents = (all.by_ref().take(count))
                .map(|(&words, change)| (Variable::from_words(words), Tangent::from_array(change)))
                .collect();
            let second_order = std::array::from_fn(|probe| {
                Tangent::from_array(&second_order.as_chunks::<10>().0[probe])
            });
            LinearUncertainty::of(tangents, second_order)
        })
        .collect();
        Ok(Self {
            uncertainties: Some(Arc::new(uncertainties)),
            ..self.clone()
        })
    }
}

fn damage_error(what: &str) -> PyErr {
    PyValueError::new_err(format!("doubts: not what was stored: {what}"))
}
