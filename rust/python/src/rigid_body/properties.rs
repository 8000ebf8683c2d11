//! What a body is, and bodies made from bodies.

use nalgebra::{Matrix3, Vector3};
use numpy::PyArrayDyn;
use polhode::RigidBody;
use polhode::uncertainty::{Rotated, Scaled, Translated};
use pyo3::basic::CompareOp;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyNotImplemented;

use crate::about::points;
use crate::arrays::{
    Argument, read, read_scalar, write, write_any_of, write_numbers, write_numbers_of, write_of,
};
use crate::body::PyRigidBody;
use crate::figure::Place;
use crate::interrupt::Beat;
use crate::principal::{of_bodies, with_rtols};
use crate::stack::{BLOCK, Broadcast, Stack};
use crate::uncertain::{Quantity, carried, known, quantity, quantity_or, rotation_quantity};

type Array<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

#[pymethods]
impl PyRigidBody {
    /// Mass: a float, or an array of the stack's shape.
    #[getter]
    fn mass<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        write_numbers_of(py, &self.bodies, RigidBody::mass)
    }

    /// Centre of mass C from the origin of the body frame, shape (..., 3).
    #[getter]
    fn center_of_mass<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.bodies, RigidBody::center_of_mass)
    }

    /// Inertia tensor about C in the body frame, shape (..., 3, 3); off-diagonal elements are minus the products.
    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.bodies, RigidBody::inertia)
    }

    /// Principal moments about C, ascending, shape (..., 3).
    #[getter]
    fn principal_moments<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.bodies, |body| body.principal().moments)
    }

    /// Principal moments and axes about C, with the class of the top.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.cylinder(radius=1.0, height=4.0, mass=12.0).principal.top
    /// 'prolate'
    #[getter]
    fn principal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with_sigma_of_axes(of_bodies(py, &self.bodies)?, None)
    }

    /// Radii of gyration √(I/m) about the principal axes through C, ascending, shape (..., 3).
    #[getter]
    fn radii_of_gyration<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.bodies, RigidBody::radii_of_gyration)
    }

    /// Inertia tensor about a point P: the parallel-axis theorem ``I_P = I_C + m (d² 1 − d dᵀ)``.
    ///
    /// Parameters
    /// ----------
    /// point : {"center_of_mass", "origin"} or array_like, shape (..., 3)
    ///     P in the body frame.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3, 3)
    ///
    /// Examples
    /// --------
    /// A cube about its corner:
    ///
    /// >>> from polhode import solids
    /// >>> solids.cube(1.0, mass=12.0).inertia_about((0.5, 0.5, 0.5))
    /// array([[ 8., -3., -3.],
    ///        [-3.,  8., -3.],
    ///        [-3., -3.,  8.]])
    fn inertia_about<'py>(&self, py: Python<'py>, point: &Bound<'py, PyAny>) -> Array<'py> {
        let points = points(py, &self.bodies, Some(point), "point")?;
        let grid = self.with("point", &points)?;
        write(
            py,
            &grid.try_map(py, |[b, p]| {
                self.bodies[b].check_about(&points[p])?;
                Ok(self.bodies[b].inertia_about(&points[p]))
            })?,
        )
    }

    /// Moment of inertia about an axis through a point, ``n·I_P·n`` with n the unit vector along the axis.
    ///
    /// Parameters
    /// ----------
    /// axis : array_like, shape (..., 3)
    ///     Direction of the axis in the body frame, as a vector of any length but zero.
    /// point : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     A point on the axis.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray, shape (...)
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.sphere(1.0, mass=5.0).moment_about((0, 0, 3))
    /// 2.0
    #[pyo3(signature = (axis, point=Argument::default()), text_signature = "($self, axis, point='center_of_mass')")]
    fn moment_about<'py>(
        &self,
        py: Python<'py>,
        axis: &Bound<'py, PyAny>,
        point: Argument<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = points(py, &self.bodies, point.given(), "point")?;
        let axes: Stack<Vector3<f64>> = read(axis, "axis")?;
        let shapes = [&self.bodies.shape[..], &axes.shape, &points.shape];
        let grid = Broadcast::of(["body", "axis", "point"], shapes)?;
        let moments = grid.try_map(py, |[b, a, p]| {
            self.bodies[b].moment_about(&axes[a], &points[p])
        })?;
        write_numbers(py, &moments)
    }

    /// Principal moments and axes about a point.
    ///
    /// Parameters
    /// ----------
    /// point : {"center_of_mass", "origin"} or array_like, shape (..., 3)
    ///
    /// Returns
    /// -------
    /// PrincipalAxes
    ///
    /// Examples
    /// --------
    /// A cube about its corner: the small moment belongs to the diagonal.
    ///
    /// >>> from polhode import solids
    /// >>> solids.cube(1.0, mass=12.0).principal_about((0.5, 0.5, 0.5)).moments.round(12)
    /// array([ 2., 11., 11.])
    fn principal_about<'py>(
        &self,
        py: Python<'py>,
        point: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = points(py, &self.bodies, Some(point), "point")?;
        let grid = self.with("point", &points)?;
        let found = grid.try_map(py, |[b, p]| {
            self.bodies[b].check_about(&points[p])?;
            let found = self.bodies[b].principal_about(&points[p]);
            Ok((found, self.bodies[b].top_rtols(&found.moments)))
        })?;
        self.with_sigma_of_axes(with_rtols(py, &found)?, Some(&points))
    }

    /// The body after a displacement: C → C + displacement.
    ///
    /// Parameters
    /// ----------
    /// displacement : array_like, shape (..., 3)
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.sphere(1.0, mass=5.0).translated((0, 0, 2)).center_of_mass
    /// array([0., 0., 2.])
    fn translated(&self, py: Python<'_>, displacement: &Bound<'_, PyAny>) -> PyResult<Self> {
        let d: Quantity<Vector3<f64>> = quantity(displacement, "displacement")?;
        let grid = self.with("displacement", &d.values)?;
        let moved = grid.try_map(py, |[b, i]| self.bodies[b].translated(&d.values[i]))?;
        let is_uncertain = self.doubts.is_some() || d.is_uncertain();
        let doubts = if d.is_uncertain() {
            carried(py, &grid, is_uncertain, |[b, i]| {
                self.changed(b, &Translated, &d.row(i))
            })?
        } else if moved.shape == self.bodies.shape {
            self.doubts.clone()
        } else {
            self.doubts_of(grid.rows().map(|[b, _]| b))
        };
        let figures = self.placed(&grid, |[_, i]| Place {
            shift: d.values[i],
            ..Place::default()
        });
        Ok(Self::doubtful(moved, doubts).looking(figures))
    }

    /// The body after a rotation about the origin: C → R C, I → R I Rᵀ. Its principal moments stay exactly
    /// the same.
    ///
    /// Parameters
    /// ----------
    /// rotation : array_like, shape (..., 3, 3) or (..., 4), or rotation
    ///     Rotation matrices, unit quaternions (x, y, z, w), or anything with ``as_quat()`` such as
    ///     SciPy's Rotation.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> quarter_turn = [(0, -1, 0), (1, 0, 0), (0, 0, 1)]
    /// >>> solids.box((1, 2, 3), mass=12.0).rotated(quarter_turn).inertia.diagonal()
    /// array([10., 13.,  5.])
    fn rotated(&self, py: Python<'_>, rotation: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (rotations, angles) = rotation_quantity(rotation, "rotation")?;
        let grid = self.with("rotation", &rotations)?;
        let turned = grid.try_map(py, |[b, r]| self.bodies[b].rotated(&rotations[r]))?;
        let is_uncertain = self.doubts.is_some() || angles.is_some();
        let doubts = carried(py, &grid, is_uncertain, |[b, r]| {
            if angles.is_none() {
                let turn = rotations[r];
                let rows = std::array::from_fn(|i| std::array::from_fn(|j| turn[(i, j)]));
                return Ok(self.row(b).1.map(|change| change.rotated(&rows)));
            }
            let mut small = [known(0.0); 3];
            for (angle, form) in small.iter_mut().zip(angles.iter().flatten()) {
                angle.1 = form;
            }
            self.changed(b, &Rotated(rotations[r]), &small)
        })?;
        let figures = self.placed(&grid, |[_, r]| Place {
            turn: rotations[r],
            ..Place::default()
        });
        Ok(Self::doubtful(turned, doubts).looking(figures))
    }

    /// The same shape ``length`` times as large and ``mass`` times as heavy: m → k m, C → s C, I → k s² I.
    ///
    /// Parameters
    /// ----------
    /// length, mass : array_like, shape (...), optional
    ///     Positive factors.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.sphere(1.0, mass=5.0).scaled(length=2).principal_moments
    /// array([8., 8., 8.])
    #[pyo3(signature = (length=Argument::default(), mass=Argument::default()), text_signature = "($self, length=1.0, mass=1.0)")]
    fn scaled(&self, py: Python<'_>, length: Argument<'_>, mass: Argument<'_>) -> PyResult<Self> {
        let (length, mass) = (
            quantity_or(&length, "length", 1.0)?,
            quantity_or(&mass, "mass", 1.0)?,
        );
        let (s, k) = (&length.values, &mass.values);
        let shapes = [&self.bodies.shape[..], &s.shape, &k.shape];
        let grid = Broadcast::of(["body", "length", "mass"], shapes)?;
        let scaled = grid.try_map(py, |[b, i, j]| self.bodies[b].scaled(s[i], k[j]))?;
        let is_uncertain = self.doubts.is_some() || length.is_uncertain() || mass.is_uncertain();
        let is_linear = !length.is_uncertain() && !mass.is_uncertain();
        let doubts = carried(py, &grid, is_uncertain, |[b, i, j]| {
            if is_linear {
                return Ok(self.row(b).1.map(|change| change.scaled(s[i], k[j])));
            }
            self.changed(b, &Scaled, &[length.row(i), mass.row(j)].concat())
        })?;
        let figures = self.placed(&grid, |[_, i, _]| Place {
            turn: Matrix3::identity() * s[i],
            ..Place::default()
        });
        Ok(Self::doubtful(scaled, doubts).looking(figures))
    }

    /// Whether bodies agree within tolerances, one answer for each pair.
    ///
    /// The test compares masses, tensors (relative to the largest element) and centres of mass (relative to
    /// the distance from the origin or to the radius of gyration, whichever is larger).
    ///
    /// Parameters
    /// ----------
    /// other : RigidBody
    /// rtol, atol : float, optional
    ///
    /// Returns
    /// -------
    /// bool or numpy.ndarray of bool, shape (...)
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> cube = solids.cube(1.0, mass=1.0)
    /// >>> cube.isclose(solids.cube(1.0 + 1e-12, mass=1.0)), cube == cube.scaled(length=1.1)
    /// (True, False)
    #[pyo3(signature = (other, rtol=1e-9, atol=0.0))]
    fn isclose<'py>(
        &self,
        py: Python<'py>,
        other: &Self,
        #[pyo3(from_py_with = read_scalar)] rtol: f64,
        #[pyo3(from_py_with = read_scalar)] atol: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let grid = self.with("other", &other.bodies)?;
        let close = grid.try_map(py, |[a, b]| {
            Ok(self.bodies[a].is_close(&other.bodies[b], rtol, atol))
        })?;
        if close.is_one() {
            return Ok(close[0].into_pyobject(py)?.to_owned().into_any());
        }
        write_any_of(py, &close, |close| *close)
    }

    /// A body is no array: NumPy leaves ``array == body`` and ``array + body`` to the body.
    #[classattr]
    fn __array_ufunc__() -> Option<bool> {
        None
    }

    fn __richcmp__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
        op: CompareOp,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let mut equal = self.doubts == other.get().doubts;
        let (own, other) = (&self.bodies, &other.get().bodies);
        equal = equal && own.shape == other.shape;
        let mut beat = Beat::new(py);
        for (own, other) in own.rows.chunks(BLOCK).zip(other.rows.chunks(BLOCK)) {
            beat.mark()?;
            equal = equal && own == other;
        }
        match op {
            CompareOp::Eq => Ok(equal.into_pyobject(py)?.to_owned().into_any()),
            CompareOp::Ne => Ok((!equal).into_pyobject(py)?.to_owned().into_any()),
            _ => Err(PyTypeError::new_err(
                "bodies have no order: compare their masses or moments",
            )),
        }
    }
}

impl PyRigidBody {
    /// The bodies lined up with one other argument.
    pub(super) fn with<'a, T>(
        &self,
        name: &'a str,
        other: &Stack<T>,
    ) -> PyResult<Broadcast<'a, 2>> {
        Broadcast::of(["body", name], [&self.bodies.shape, &other.shape])
    }
}
