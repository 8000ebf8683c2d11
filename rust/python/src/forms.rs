//! Other people's forms of a rigid body, to and from.

use nalgebra::{Matrix4, Matrix6, Vector3};
use numpy::PyArrayDyn;
use polhode::RigidBody;
use polhode::mass::forms::SpatialOrder;
use polhode::uncertainty::FromPositiveProducts;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Argument, read, read_scalar, try_rows, write, write_of};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{Quantity, of_numbers, propagate_rows, quantity, quantity_or};

type Floats<'py> = Bound<'py, PyArrayDyn<f64>>;
type Array<'py> = PyResult<Floats<'py>>;

#[pymethods]
impl PyRigidBody {
    /// Body from a table with *positive* products of inertia, as in many CAD and aerospace tables.
    ///
    /// Parameters
    /// ----------
    /// mass : array_like, shape (...)
    /// moments : array_like, shape (..., 3)
    ///     Ixx, Iyy, Izz about the centre of mass.
    /// products : array_like, shape (..., 3)
    ///     Pxy, Pxz, Pyz in this order, ``P_xy = ∫ x y dm``: the tensor's off-diagonal elements are minus these.
    /// center_of_mass : array_like, shape (..., 3), optional
    /// rtol : float, optional
    ///     Tolerance: violations of the triangle inequality up to this fraction are accepted.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> RigidBody.from_positive_products(1.0, (2.0, 3.0, 4.0), (0.5, 0.0, -0.25)).inertia
    /// array([[ 2.  , -0.5 ,  0.  ],
    ///        [-0.5 ,  3.  ,  0.25],
    ///        [ 0.  ,  0.25,  4.  ]])
    #[staticmethod]
    #[pyo3(
        signature = (mass, moments, products, center_of_mass=Argument::default(), *, rtol=None),
        text_signature = "(mass, moments, products, center_of_mass=(0.0, 0.0, 0.0), *, rtol=None)"
    )]
    fn from_positive_products(
        py: Python<'_>,
        mass: &Bound<'_, PyAny>,
        moments: &Bound<'_, PyAny>,
        products: &Bound<'_, PyAny>,
        center_of_mass: Argument<'_>,
        #[pyo3(from_py_with = read_scalar)] rtol: Option<f64>,
    ) -> PyResult<Self> {
        let mass: Quantity<f64> = quantity(mass, "mass")?;
        let moments: Quantity<[f64; 3]> = quantity(moments, "moments")?;
        let products: Quantity<[f64; 3]> = quantity(products, "products")?;
        let center = quantity_or(&center_of_mass, "center_of_mass", Vector3::zeros())?;
        let (m, i, p, c) = (
            &mass.values,
            &moments.values,
            &products.values,
            &center.values,
        );
        let grid = Broadcast::of(
            ["mass", "moments", "products", "center_of_mass"],
            [&m.shape, &i.shape, &p.shape, &c.shape],
        )?;
        let rtol = rtol.unwrap_or(0.0);
        let bodies = grid.try_map(py, |rows: [usize; 4]| {
            let [mass, moments, products, center] = rows;
            RigidBody::from_positive_products(m[mass], &i[moments], &p[products], &c[center], rtol)
        })?;
        let is_uncertain = mass.is_uncertain()
            || moments.is_uncertain()
            || products.is_uncertain()
            || center.is_uncertain();
        let uncertainties = propagate_rows(py, &grid, is_uncertain, |[m, i, p, c]| {
            let numbers = [mass.row(m), center.row(c), moments.row(i), products.row(p)].concat();
            of_numbers(&FromPositiveProducts, &numbers)
        })?;
        PyRigidBody::with_uncertainty(bodies, uncertainties).possible(py)
    }
}

/// Moments and *positive* products of inertia about the centre of mass.
///
/// Parameters
/// ----------
/// body : RigidBody
///
/// Returns
/// -------
/// moments, products : numpy.ndarray, shape (..., 3)
///     (Ixx, Iyy, Izz) and (Pxy, Pxz, Pyz), ``P_xy = ∫ x y dm``.
///
/// See Also
/// --------
/// polhode.RigidBody.from_positive_products : the inverse function.
///
/// Examples
/// --------
/// >>> from polhode import interop, solids
/// >>> interop.to_positive_products(solids.wedge((6, 2, 6), mass=36.0))
/// (array([ 84., 144.,  84.]), array([  0., -36.,   0.]))
#[pyfunction]
pub(crate) fn to_positive_products<'py>(
    py: Python<'py>,
    body: &PyRigidBody,
) -> PyResult<(Floats<'py>, Floats<'py>)> {
    let both = body.bodies.map(py, RigidBody::positive_products)?;
    Ok((
        write_of(py, &both, |(moments, _)| *moments)?,
        write_of(py, &both, |(_, products)| *products)?,
    ))
}

/// Pseudo-inertia about the origin, ``J = ∫ (r; 1)(r; 1)ᵀ dm = [[∫ r rᵀ dm, m c], [m cᵀ, m]]``.
///
/// A body is possible exactly when J is positive semidefinite.
///
/// Parameters
/// ----------
/// body : RigidBody
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 4, 4)
///
/// Examples
/// --------
/// >>> from polhode import interop, solids
/// >>> interop.to_pseudo_inertia(solids.box((1, 2, 3), mass=12.0).translated((0, 0, 1)))
/// array([[ 1.,  0.,  0.,  0.],
///        [ 0.,  4.,  0.,  0.],
///        [ 0.,  0., 21., 12.],
///        [ 0.,  0., 12., 12.]])
#[pyfunction]
pub(crate) fn to_pseudo_inertia<'py>(py: Python<'py>, body: &PyRigidBody) -> Array<'py> {
    write_of(py, &body.bodies, RigidBody::pseudo_inertia)
}

/// Body with this pseudo-inertia about the origin.
///
/// Parameters
/// ----------
/// pseudo_inertia : array_like, shape (..., 4, 4)
///     ``[[∫ r rᵀ dm, m c], [m cᵀ, m]]``.
/// rtol : float, optional
///     Tolerance: asymmetry and violations of the triangle inequality up to this fraction are accepted.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import interop
/// >>> interop.from_pseudo_inertia(np.diag([1.0, 4.0, 9.0, 12.0])).principal_moments
/// array([ 5., 10., 13.])
#[pyfunction]
#[pyo3(signature = (pseudo_inertia, *, rtol=None))]
pub(crate) fn from_pseudo_inertia(
    pseudo_inertia: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] rtol: Option<f64>,
) -> PyResult<PyRigidBody> {
    let rows: Stack<Matrix4<f64>> = read(pseudo_inertia, "pseudo_inertia")?;
    let body = |row: &Matrix4<f64>| RigidBody::from_pseudo_inertia(row, rtol.unwrap_or(0.0));
    try_rows(pseudo_inertia.py(), &rows, body).map(PyRigidBody::from)
}

/// Spatial inertia about the origin: the matrix that gives the spatial momentum from the spatial velocity of
/// the point at the origin.
///
/// Parameters
/// ----------
/// body : RigidBody
/// order : {"angular-linear", "linear-angular"}
///     ``[[I_O, m c×], [−m c×, m 1]]`` (Featherstone, Drake), or ``[[m 1, −m c×], [m c×, I_O]]`` (Pinocchio).
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 6, 6)
///
/// Examples
/// --------
/// >>> from polhode import interop, solids
/// >>> interop.to_spatial_inertia(solids.cube(1.0, mass=6.0)).diagonal()
/// array([1., 1., 1., 6., 6., 6.])
#[pyfunction]
#[pyo3(signature = (body, order="angular-linear"))]
pub(crate) fn to_spatial_inertia<'py>(
    py: Python<'py>,
    body: &PyRigidBody,
    #[pyo3(from_py_with = read_scalar)] order: &str,
) -> Array<'py> {
    let order = spatial_order(order)?;
    write_of(py, &body.bodies, |body| body.spatial_inertia(order))
}

/// Body with this spatial inertia about the origin.
///
/// Parameters
/// ----------
/// spatial_inertia : array_like, shape (..., 6, 6)
/// order : {"angular-linear", "linear-angular"}
///     ``[[I_O, m c×], [−m c×, m 1]]`` (Featherstone, Drake), or ``[[m 1, −m c×], [m c×, I_O]]`` (Pinocchio).
/// rtol : float, optional
///     Tolerance: deviations from this structure and violations of the triangle inequality up to this
///     fraction are accepted.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import interop
/// >>> interop.from_spatial_inertia(np.diag([1.0, 2.0, 2.5, 3.0, 3.0, 3.0])).mass
/// 3.0
#[pyfunction]
#[pyo3(signature = (spatial_inertia, order="angular-linear", *, rtol=None))]
pub(crate) fn from_spatial_inertia(
    spatial_inertia: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] order: &str,
    #[pyo3(from_py_with = read_scalar)] rtol: Option<f64>,
) -> PyResult<PyRigidBody> {
    let order = spatial_order(order)?;
    let rows: Stack<Matrix6<f64>> = read(spatial_inertia, "spatial_inertia")?;
    let body =
        |row: &Matrix6<f64>| RigidBody::from_spatial_inertia(row, order, rtol.unwrap_or(0.0));
    try_rows(spatial_inertia.py(), &rows, body).map(PyRigidBody::from)
}

/// The ten numbers in which the equations of motion are linear, about the origin.
///
/// Parameters
/// ----------
/// body : RigidBody
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 10)
///     m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz, with *minus* the products off the tensor's diagonal:
///     the order of Pinocchio's dynamic parameters.
///
/// Examples
/// --------
/// >>> from polhode import interop, solids
/// >>> interop.to_parameters(solids.box((1, 2, 3), mass=12.0).translated((0, 0, 1)))
/// array([12.,  0.,  0., 12., 25.,  0., 22.,  0.,  0.,  5.])
#[pyfunction]
pub(crate) fn to_parameters<'py>(py: Python<'py>, body: &PyRigidBody) -> Array<'py> {
    write_of(py, &body.bodies, RigidBody::parameters)
}

/// Body with these ten parameters about the origin.
///
/// Parameters
/// ----------
/// parameters : array_like, shape (..., 10)
///     m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz, with *minus* the products off the tensor's diagonal.
/// rtol : float, optional
///     Tolerance: violations of the triangle inequality up to this fraction are accepted.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import interop
/// >>> interop.from_parameters([12, 0, 0, 12, 25, 0, 22, 0, 0, 5]).principal_moments
/// array([ 5., 10., 13.])
#[pyfunction]
#[pyo3(signature = (parameters, *, rtol=None))]
pub(crate) fn from_parameters(
    parameters: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = read_scalar)] rtol: Option<f64>,
) -> PyResult<PyRigidBody> {
    let rows: Stack<[f64; 10]> = read(parameters, "parameters")?;
    let body = |row: &[f64; 10]| RigidBody::from_parameters(row, rtol.unwrap_or(0.0));
    try_rows(parameters.py(), &rows, body).map(PyRigidBody::from)
}

/// Log-Cholesky parameters: ten numbers without constraints, any values of which belong to a possible body.
///
/// The pseudo-inertia about the origin O is ``J = U Uᵀ`` with
/// ``U = e^α [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]]``.
/// Here ``e^(2α)`` is the mass, t the vector from O to the centre of mass C, and the upper left block belongs
/// to the second moment about C.
///
/// Parameters
/// ----------
/// body : RigidBody
///     A body with a thickness: for a lamina or a rod a logarithm is infinite.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 10)
///     α, d1, d2, d3, s12, s23, s13, t1, t2, t3: the order of Rucker and Wensing (2022) and of Pinocchio.
///
/// Raises
/// ------
/// InvalidInertiaError
///     For a body without thickness.
///
/// Examples
/// --------
/// >>> from polhode import interop, solids
/// >>> interop.to_log_cholesky(solids.box((12**0.5,) * 3, mass=1.0)).round(12) + 0.0
/// array([0., 0., 0., 0., 0., 0., 0., 0., 0., 0.])
#[pyfunction]
pub(crate) fn to_log_cholesky<'py>(py: Python<'py>, body: &PyRigidBody) -> Array<'py> {
    write(py, &try_rows(py, &body.bodies, RigidBody::log_cholesky)?)
}

/// Body with these log-Cholesky parameters.
///
/// Parameters
/// ----------
/// parameters : array_like, shape (..., 10)
///     α, d1, d2, d3, s12, s23, s13, t1, t2, t3, as of :func:`to_log_cholesky`.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// >>> from polhode import interop
/// >>> body = interop.from_log_cholesky([0, 0, 0, 0, 0, 0, 0, 1, 2, 3])
/// >>> body.principal_moments, body.center_of_mass
/// (array([2., 2., 2.]), array([1., 2., 3.]))
#[pyfunction]
pub(crate) fn from_log_cholesky(parameters: &Bound<'_, PyAny>) -> PyResult<PyRigidBody> {
    let rows: Stack<[f64; 10]> = read(parameters, "parameters")?;
    try_rows(parameters.py(), &rows, RigidBody::from_log_cholesky).map(PyRigidBody::from)
}

fn spatial_order(order: &str) -> PyResult<SpatialOrder> {
    match order {
        "angular-linear" => Ok(SpatialOrder::AngularLinear),
        "linear-angular" => Ok(SpatialOrder::LinearAngular),
        _ => Err(PyValueError::new_err(format!(
            "order: expected \"angular-linear\" or \"linear-angular\", got \"{order}\""
        ))),
    }
}
