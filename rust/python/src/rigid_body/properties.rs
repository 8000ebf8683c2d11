//! What a body is, and bodies made from bodies.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use nalgebra::{Matrix3, Vector3};
use numpy::{PyArrayDyn, PyUntypedArrayMethods};
use polhode::RigidBody;
use polhode::mass::assemblies::combined;
use polhode::motion::angular_momentum::{AngularMomentum, angular_momentum};
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::kinetic_energy::{KineticEnergy, kinetic_energy};
use polhode::uncertainty::{Rotation, Scaling, Translation, together};
use pyo3::basic::CompareOp;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList, PyNotImplemented, PyTuple};

use crate::about::points;
use crate::arrays::{
    Argument, all_in_slabs, floats, in_slabs, numpy, read, read_or, read_scalar, try_items, write,
    write_any_of, write_numbers, write_numbers_of, write_of,
};
use crate::body::{PyRigidBody, Uncertainties};
use crate::figure::Placement;
use crate::hints::no_attribute;
use crate::indexing::{picked_by, picked_rows, to_index};
use crate::interrupt::Beat;
use crate::memory;
use crate::principal::{of_bodies, with_rtols};
use crate::shape::tuple;
use crate::stack::{BLOCK, Broadcast, Stack, extend};
use crate::uncertain::{
    Quantity, certain, propagate_rows, quantity, quantity_or, rotation_quantity,
};

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
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3)
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
    fn inertia_about<'py>(&self, py: Python<'py>, about: &Bound<'py, PyAny>) -> Array<'py> {
        let points = points(py, &self.bodies, Some(about), "about")?;
        let grid = self.with("about", &points)?;
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
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
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
    #[pyo3(signature = (axis, about=Argument::default()), text_signature = "($self, axis, about='center_of_mass')")]
    fn moment_about<'py>(
        &self,
        py: Python<'py>,
        axis: &Bound<'py, PyAny>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = points(py, &self.bodies, about.value(), "about")?;
        let axes: Stack<Vector3<f64>> = read(axis, "axis")?;
        let shapes = [&self.bodies.shape[..], &axes.shape, &points.shape];
        let grid = Broadcast::of(["body", "axis", "about"], shapes)?;
        let moments = grid.try_map(py, |[b, a, p]| {
            self.bodies[b].moment_about(&axes[a], &points[p])
        })?;
        write_numbers(py, &moments)
    }

    /// Principal moments and axes about a point.
    ///
    /// Parameters
    /// ----------
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3)
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
        about: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = points(py, &self.bodies, Some(about), "about")?;
        let grid = self.with("about", &points)?;
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
        let is_uncertain = self.uncertainties.is_some() || d.is_uncertain();
        let uncertainties = if d.is_uncertain() {
            propagate_rows(py, &grid, is_uncertain, |[b, i]| {
                self.propagate_row(b, &Translation, &d.row(i))
            })?
        } else if moved.shape == self.bodies.shape {
            self.uncertainties.clone()
        } else {
            self.uncertainties_of(grid.rows().map(|[b, _]| b))
        };
        let figures = self.place_figures(&grid, |[_, i]| Placement {
            shift: d.values[i],
            ..Placement::default()
        });
        Ok(Self::with_uncertainty(moved, uncertainties).with_shapes(figures))
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
        let is_uncertain = self.uncertainties.is_some() || angles.is_some();
        let uncertainties = propagate_rows(py, &grid, is_uncertain, |[b, r]| {
            if angles.is_none() {
                let turn = rotations[r];
                let rows = std::array::from_fn(|i| std::array::from_fn(|j| turn[(i, j)]));
                return Ok(self.row(b).1.map(|change| change.rotated(&rows)));
            }
            let mut small = [certain(0.0); 3];
            for (angle, form) in small.iter_mut().zip(angles.iter().flatten()) {
                angle.1 = form;
            }
            self.propagate_row(b, &Rotation(rotations[r]), &small)
        })?;
        let figures = self.place_figures(&grid, |[_, r]| Placement {
            turn: rotations[r],
            ..Placement::default()
        });
        Ok(Self::with_uncertainty(turned, uncertainties).with_shapes(figures))
    }

    /// The mirror image of the body through a plane: a right arm from a left one, the other half of a hull.
    ///
    /// With ``M = 1 − 2 n nᵀ``: C → p + M (C − p), I → M I M. Its principal moments stay exactly the same. What is
    /// uncertain of the body is uncertain of its image, from the same sources.
    ///
    /// Parameters
    /// ----------
    /// normal : array_like, shape (..., 3)
    ///     Normal of the plane, of any length: ``(0, 1, 0)`` exchanges left and right where y points to the left.
    /// point : array_like, shape (..., 3), optional
    ///     A point of the plane; by default the origin of the body frame.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> left = RigidBody(2.0, [(4, -0.5, 0.25), (-0.5, 5, 0.75), (0.25, 0.75, 6)], center_of_mass=(0.1, 0.2, 0.3))
    /// >>> right = left.mirrored((0, 1, 0))
    /// >>> right.center_of_mass
    /// array([ 0.1, -0.2,  0.3])
    /// >>> right.inertia
    /// array([[ 4.  ,  0.5 ,  0.25],
    ///        [ 0.5 ,  5.  , -0.75],
    ///        [ 0.25, -0.75,  6.  ]])
    #[pyo3(signature = (normal, point=Argument::default()), text_signature = "($self, normal, point=(0.0, 0.0, 0.0))")]
    fn mirrored(
        &self,
        py: Python<'_>,
        normal: &Bound<'_, PyAny>,
        point: Argument<'_>,
    ) -> PyResult<Self> {
        let normals: Stack<Vector3<f64>> = read(normal, "normal")?;
        let points = read_or(&point, "point", Vector3::zeros())?;
        let names = ["body", "normal", "point"];
        let grid = Broadcast::of(names, [&self.bodies.shape, &normals.shape, &points.shape])?;
        let images = grid.try_map(py, |[b, n, p]| {
            self.bodies[b].mirrored(&normals[n], &points[p])
        })?;
        let mirror = |n: usize| {
            let u = normals[n] / normals[n].amax();
            let u = u / u.norm();
            Matrix3::identity() - u * u.transpose() * 2.0
        };
        let is_uncertain = self.uncertainties.is_some();
        let uncertainties = propagate_rows(py, &grid, is_uncertain, |[b, n, _]| {
            let matrix = mirror(n);
            let rows = std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]));
            Ok(self.row(b).1.map(|change| change.rotated(&rows)))
        })?;
        let figures = self.place_figures(&grid, |[_, n, p]| Placement {
            turn: mirror(n),
            shift: points[p] - mirror(n) * points[p],
        });
        Ok(Self::with_uncertainty(images, uncertainties).with_shapes(figures))
    }

    /// The part of a solid on one side of a plane: a hull below its waterline, a casting without its riser.
    ///
    /// It is what lies where ``n · (x − point) ≥ 0``, closed by its section in the plane, of the same density. The cut is
    /// exact: the faces are cut along the plane, and the section adds nothing but itself.
    ///
    /// Parameters
    /// ----------
    /// normal : array_like, shape (3,)
    ///     Normal n of the plane, of any length, toward the part that is kept.
    /// point : array_like, shape (3,), optional
    ///     A point of the plane; by default the origin of the body frame.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///     Without covariance.
    ///
    /// Raises
    /// ------
    /// PolhodeError
    ///     When nothing is left, or the body is not one solid that holds its mesh: one from `from_mesh` or a mesh file of
    ///     at most 20,000 faces. :func:`polhode.io.cut_mesh` cuts any mesh.
    ///
    /// Examples
    /// --------
    /// The half of a cube above a plane through its middle:
    ///
    /// >>> from polhode import RigidBody
    /// >>> corners = [(x, y, z) for x in (0, 2) for y in (0, 2) for z in (0, 2)]
    /// >>> faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    /// >>> faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    /// >>> upper = RigidBody.from_mesh(corners, faces, density=1.0).cut((0, 0, 1), point=(0, 0, 1))
    /// >>> upper.mass, upper.center_of_mass
    /// (4.0, array([1. , 1. , 1.5]))
    #[pyo3(signature = (normal, point=Argument::default()), text_signature = "($self, normal, point=(0.0, 0.0, 0.0))")]
    fn cut<'py>(
        slf: &Bound<'py, Self>,
        normal: &Bound<'py, PyAny>,
        point: Argument<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let cut_body = py.import("polhode.io.cut")?.getattr("cut_body")?;
        match point.value() {
            Some(point) => cut_body.call1((slf, normal, point)),
            None => cut_body.call1((slf, normal)),
        }
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
        let is_uncertain =
            self.uncertainties.is_some() || length.is_uncertain() || mass.is_uncertain();
        let is_linear = !length.is_uncertain() && !mass.is_uncertain();
        let uncertainties = propagate_rows(py, &grid, is_uncertain, |[b, i, j]| {
            if is_linear {
                return Ok(self.row(b).1.map(|change| change.scaled(s[i], k[j])));
            }
            self.propagate_row(b, &Scaling, &[length.row(i), mass.row(j)].concat())
        })?;
        let figures = self.place_figures(&grid, |[_, i, _]| Placement {
            turn: Matrix3::identity() * s[i],
            ..Placement::default()
        });
        Ok(Self::with_uncertainty(scaled, uncertainties).with_shapes(figures))
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
        let mut equal = self.uncertainties == other.get().uncertainties;
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

// A stack as a container: shape, indexing, iteration, hash, pickle, repr.

#[pymethods]
impl PyRigidBody {
    /// Shape of the stack; ``()`` for one body.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.bodies.shape)
    }

    /// Asked where there is no such attribute.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<Py<PyAny>> {
        Err(no_attribute(slf.as_any(), name))
    }

    fn __len__(&self) -> PyResult<usize> {
        self.bodies
            .shape
            .first()
            .copied()
            .ok_or_else(|| PyTypeError::new_err("one body has no length: it is not a stack"))
    }

    /// A body is always true: `len` is about the shape of the stack.
    #[expect(clippy::unused_self, reason = "Python asks an instance")]
    fn __bool__(&self) -> bool {
        true
    }

    /// NumPy's indexing over the stack: integers, slices, masks, arrays, ``...`` and ``None``.
    fn __getitem__(&self, py: Python<'_>, key: &Bound<'_, PyAny>) -> PyResult<Self> {
        let picked = picked_by(py, &self.bodies.shape, key)?;
        let shape = picked.shape().to_vec();
        let grid = Broadcast::of(["key"], [&shape])?;
        let picked = picked.as_slice()?;
        let bodies = grid.try_map(py, |[k]| Ok(self.bodies[to_index(picked[k])]))?;
        let rows = picked.iter().map(|&row| to_index(row));
        let uncertainties = self.uncertainties_of(rows.clone());
        Ok(Self::with_uncertainty(bodies, uncertainties).with_shapes(self.figures_of(rows)))
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        if self.bodies.is_one() {
            return Err(PyTypeError::new_err(
                "one body cannot be iterated over: it is not a stack",
            ));
        }
        let shape = self.bodies.shape[1..].to_vec();
        let size = shape.iter().product::<usize>();
        let parts = PyList::empty(py);
        let mut beat = Beat::new(py);
        for i in 0..self.bodies.shape[0] {
            if (i * size.max(1)) % BLOCK < size.max(1) {
                beat.mark()?;
            }
            let mut rows = memory::vector("bodies", &shape, 0)?;
            extend(
                py,
                &mut rows,
                &self.bodies.rows[i * size..(i + 1) * size],
                |body| *body,
            )?;
            let shape = shape.clone();
            let own = i * size..(i + 1) * size;
            let part =
                Self::with_uncertainty(Stack { shape, rows }, self.uncertainties_of(own.clone()))
                    .with_shapes(self.figures_of(own));
            parts.append(Py::new(py, part)?)?;
        }
        parts.try_iter()
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<u64> {
        let mut hasher = DefaultHasher::new();
        self.bodies.shape.hash(&mut hasher);
        let mut beat = Beat::new(py);
        for (row, body) in self.bodies.rows.iter().enumerate() {
            if row % BLOCK == 0 {
                beat.mark()?;
            }
            // Equal bodies have equal hashes: zero is one number.
            (body.to_array()[..22].iter()).for_each(|x| (x + 0.0).to_bits().hash(&mut hasher)); // without the bounds, as ==
        }
        Ok(hasher.finish())
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let restore = py.get_type::<Self>().getattr("_from_numbers")?;
        let numbers = in_slabs(write_of(py, &self.bodies, RigidBody::to_array)?.into_any())?;
        let uncertainties = self.stored_uncertainties(py)?;
        uncertainties.as_ref().map_or(Ok(()), all_in_slabs)?;
        let state = match self.stored_figures(py)? {
            None => match uncertainties {
                None => (numbers,).into_pyobject(py)?,
                Some(uncertainties) => (numbers, uncertainties).into_pyobject(py)?,
            },
            Some(figures) => (numbers, uncertainties, figures).into_pyobject(py)?,
        };
        Ok((restore, state))
    }

    /// The bodies that `__reduce__` took apart, shape (..., 34), or (..., 33) without the rounding of coordinates, as before
    /// it was kept, their uncertainties if they have some, and their shapes if those are known; for pickle.
    #[staticmethod]
    #[pyo3(signature = (numbers, doubts=None, figures=None))]
    fn _from_numbers(
        numbers: &Bound<'_, PyAny>,
        doubts: Option<&Bound<'_, PyDict>>,
        figures: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let array = floats(numbers, "numbers")?;
        let bodies = Self::from(if array.shape().last() == Some(&33) {
            try_items(&array, "numbers", |row: &[f64; 33]| {
                RigidBody::from_array(&std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0)))
            })?
        } else {
            try_items(&array, "numbers", RigidBody::from_array)?
        });
        let bodies = doubts.map_or(Ok(bodies.clone()), |doubts| {
            bodies.with_uncertainties(doubts)
        })?;
        match figures {
            None => Ok(bodies),
            Some(figures) => bodies.with_figures(figures),
        }
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// One body as an expression that makes it; a stack by its shape.
    fn __repr__(&self) -> String {
        if !self.bodies.is_one() {
            let count = self.bodies.rows.len();
            return format!(
                "<RigidBody stack of shape {}: {count} bodies>",
                tuple(&self.bodies.shape)
            );
        }
        let body = &self.bodies[0];
        let row =
            |numbers: [f64; 3]| format!("[{:?}, {:?}, {:?}]", numbers[0], numbers[1], numbers[2]);
        let inertia = body.inertia();
        let rows = [0, 1, 2].map(|i| row([0, 1, 2].map(|j| inertia[(i, j)])));
        let center = row(body.center_of_mass().into());
        format!(
            "RigidBody(mass={:?}, inertia=[{}], center_of_mass={center})",
            body.mass(),
            rows.join(", ")
        )
    }
}

// Composites: parts put to a body or taken out of it, stacks put together.

#[pymethods]
impl PyRigidBody {
    fn __add__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let other = other.get();
        let grid = self.with("other", &other.bodies)?;
        let sum = grid.try_map(py, |[a, b]| self.bodies[a].combined(&other.bodies[b]))?;
        let sum = Self::with_uncertainty(sum, self.with_part(py, &grid, 1.0, other)?)
            .with_shapes(self.join_figures(&grid, other, false));
        Ok(sum.into_pyobject(py)?.into_any())
    }

    /// `sum()` starts from zero.
    fn __radd__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if other.extract::<i64>().is_ok_and(|zero| zero == 0) {
            let same = Self::with_uncertainty(
                self.bodies.map(py, |body| *body)?,
                self.uncertainties.clone(),
            )
            .with_shapes(self.figures.clone());
            return Ok(same.into_pyobject(py)?.into_any());
        }
        Ok(PyNotImplemented::get(py).to_owned().into_any())
    }

    fn __sub__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(PyNotImplemented::get(py).to_owned().into_any());
        };
        let other = other.get();
        let shapes = [&self.bodies.shape[..], &other.bodies.shape];
        let grid = Broadcast::of(["body", "other"], shapes)?;
        let rest = grid.try_map(py, |[a, b]| self.bodies[a].without(&other.bodies[b]))?;
        let rest = Self::with_uncertainty(rest, self.with_part(py, &grid, -1.0, other)?)
            .with_shapes(self.join_figures(&grid, other, true));
        Ok(rest.into_pyobject(py)?.into_any())
    }

    /// Combine the bodies of a stack into one rigid body, or those along some axes of the stack.
    ///
    /// All bodies are summed about the common centre of mass in one pass. This is faster than adding body
    /// after body, and has smaller rounding errors. The smallest moment of collinear rods and particles stays
    /// accurate.
    ///
    /// Parameters
    /// ----------
    /// axis : int or tuple of int, optional
    ///     Axes of the stack along which bodies are combined; all axes by default.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// Wheels on an axle:
    ///
    /// >>> from polhode import laminae, rods
    /// >>> wheels = laminae.disk(1.0, mass=2.0).translated([(0, 0, -1), (0, 0, 1)])
    /// >>> (wheels.combined() + rods.rod(2.0, mass=3.0)).principal_moments
    /// array([2., 6., 6.])
    #[pyo3(signature = (axis=None))]
    fn combined(&self, py: Python<'_>, axis: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let np = numpy(py)?;
        // NumPy itself tells which rows come together: those axes last, as one.
        let rows = np
            .call_method1("arange", (self.bodies.rows.len(),))?
            .call_method1("reshape", (PyTuple::new(py, &self.bodies.shape)?,))?;
        let depth = self.bodies.shape.len();
        let axes: Vec<usize> = match axis {
            None => (0..depth).collect(),
            Some(axis) => np
                .getattr("lib")?
                .getattr("array_utils")?
                .call_method1("normalize_axis_tuple", (axis, depth))
                .map_err(|error| {
                    if error.is_instance_of::<PyOverflowError>(py) {
                        PyValueError::new_err(format!(
                            "axis: a number beyond any axis, of a stack with {depth}"
                        ))
                    } else {
                        error
                    }
                })?
                .extract()?,
        };
        let kept: Vec<usize> = (0..depth).filter(|k| !axes.contains(k)).collect();
        let shape: Vec<usize> = kept.iter().map(|&k| self.bodies.shape[k]).collect();
        let count: usize = axes.iter().map(|&k| self.bodies.shape[k]).product();
        let order = [&kept[..], &axes].concat();
        let rows = picked_rows(&np.call_method1("transpose", (rows, order))?)?;
        let rows = rows.as_slice()?;
        let parts = Broadcast::of(["body"], [&[rows.len()]])?
            .try_map(py, |[k]| Ok(self.bodies[to_index(rows[k])]))?
            .rows;
        let grid = Broadcast::of(["body"], [&shape])?;
        let whole = grid.try_map(py, |[row]| combined(&parts[row * count..(row + 1) * count]))?;
        let uncertainties = propagate_rows(py, &grid, self.uncertainties.is_some(), |[row]| {
            let parts: Vec<_> = (row * count..(row + 1) * count)
                .map(|k| {
                    let (numbers, uncertainty) = self.row(to_index(rows[k]));
                    (1.0, numbers, uncertainty)
                })
                .collect();
            Ok(together(&parts))
        })?;
        let order: Vec<usize> = rows.iter().map(|&row| to_index(row)).collect();
        let figures = self.gather(count, &order);
        Ok(Self::with_uncertainty(whole, uncertainties).with_shapes(figures))
    }
}

impl PyRigidBody {
    /// The uncertainties of each body with a part put to it (the sign +1) or taken out of it (−1).
    pub(super) fn with_part(
        &self,
        py: Python<'_>,
        grid: &Broadcast<'_, 2>,
        sign: f64,
        part: &Self,
    ) -> PyResult<Uncertainties> {
        let is_uncertain = self.uncertainties.is_some() || part.uncertainties.is_some();
        propagate_rows(py, grid, is_uncertain, |[a, b]| {
            let ((own, uncertainty), (its, other)) = (self.row(a), part.row(b));
            Ok(together(&[(1.0, own, uncertainty), (sign, its, other)]))
        })
    }
}

// Energy, momentum and Euler's equations.

#[pymethods]
impl PyRigidBody {
    /// Kinetic energy in three parts, ``½ m v² + m v·(ω×c_P) + ½ ω·I_P·ω`` with ``c_P = C − P``.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// velocity : array_like, shape (..., 3), optional
    ///     Velocity of P relative to space, components in the body frame.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     The point P of the body. The parts depend on it, their sum does not.
    ///
    /// Returns
    /// -------
    /// KineticEnergy
    ///     ``translational``, ``mixed``, ``rotational`` and their ``total``.
    ///
    /// Examples
    /// --------
    /// A cylinder that rolls with unit speed, seen from its axis and from the line of contact:
    ///
    /// >>> from polhode import solids
    /// >>> cylinder = solids.cylinder(radius=1.0, height=2.0, mass=4.0)
    /// >>> cylinder.kinetic_energy((0, 0, 1), velocity=(1, 0, 0))
    /// KineticEnergy(translational=2.0, mixed=0.0, rotational=1.0)
    /// >>> cylinder.kinetic_energy((0, 0, 1), about=(0, 1, 0))
    /// KineticEnergy(translational=0.0, mixed=0.0, rotational=3.0)
    #[pyo3(
        signature = (omega, velocity=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, velocity=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn kinetic_energy<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        velocity: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let velocity = read_or(&velocity, "velocity", Vector3::zeros())?;
        let about = points(py, &self.bodies, about.value(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &velocity.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "velocity", "about"], shapes)?;
        let energy = grid.try_map(py, |[b, w, v, p]| {
            Ok(kinetic_energy(
                &self.bodies[b],
                &omega[w],
                &velocity[v],
                &about[p],
            ))
        })?;
        let part = |part: fn(&KineticEnergy) -> f64| write_numbers_of(py, &energy, part);
        let parts = (
            part(|t| t.translational)?,
            part(|t| t.mixed)?,
            part(|t| t.rotational)?,
        );
        py.import("polhode.results")?
            .getattr("KineticEnergy")?
            .call1(parts)
    }

    /// Angular momentum about the origin of space in three parts, ``m R×v + m [R×(ω×c_P) + c_P×v] + I_P ω``.
    ///
    /// For P = C the mixed part is zero, and the sum is orbital + spin. For P fixed at the origin of space
    /// the sum is the spin alone.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// velocity, position : array_like, shape (..., 3), optional
    ///     Velocity and position of the point P relative to space, components in the body frame.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     The point P of the body; ``c_P = C − P``.
    ///
    /// Returns
    /// -------
    /// AngularMomentum
    ///     ``orbital``, ``mixed``, ``spin`` and their ``total``, each of shape (..., 3).
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.sphere(1.0, mass=5.0).angular_momentum((0, 0, 3), velocity=(0, 1, 0), position=(2, 0, 0)).total
    /// array([ 0.,  0., 16.])
    #[pyo3(
        signature = (omega, velocity=Argument::default(), position=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, velocity=(0.0, 0.0, 0.0), position=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn angular_momentum<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        velocity: Argument<'py>,
        position: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let velocity = read_or(&velocity, "velocity", Vector3::zeros())?;
        let position = read_or(&position, "position", Vector3::zeros())?;
        let about = points(py, &self.bodies, about.value(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &velocity.shape,
            &position.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "velocity", "position", "about"], shapes)?;
        let momentum = grid.try_map(py, |[b, w, v, r, p]| {
            Ok(angular_momentum(
                &self.bodies[b],
                &omega[w],
                &velocity[v],
                &position[r],
                &about[p],
            ))
        })?;
        let part = |part: fn(&AngularMomentum) -> Vector3<f64>| write_of(py, &momentum, part);
        let parts = (part(|l| l.orbital)?, part(|l| l.mixed)?, part(|l| l.spin)?);
        py.import("polhode.results")?
            .getattr("AngularMomentum")?
            .call1(parts)
    }

    /// Angular acceleration by Euler's equations, ``I_P ω̇ + ω × I_P ω = N_P``.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// torque : array_like, shape (..., 3), optional
    ///     Torque about P, components in the body frame.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     P: the centre of mass of a body that moves freely, or a point fixed in space.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     ω̇, components in the body frame. Along an axis with zero moment it is zero.
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     For a torque along an axis with zero moment.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> body.angular_acceleration((1.0, 2.0, 4.0))
    /// array([-4. ,  3. , -0.8])
    #[pyo3(
        signature = (omega, torque=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, torque=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn angular_acceleration<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        torque: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let torque = read_or(&torque, "torque", Vector3::zeros())?;
        let about = points(py, &self.bodies, about.value(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &torque.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "torque", "about"], shapes)?;
        let acceleration = grid.try_map(py, |[b, w, n, p]| {
            self.bodies[b].check_about(&about[p])?;
            EulerEquations::about(&self.bodies[b], &about[p])
                .angular_acceleration(&omega[w], &torque[n])
        })?;
        write(py, &acceleration)
    }

    /// Torque that causes a given angular acceleration, by Euler's equations.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like, shape (..., 3)
    ///     Angular velocity relative to space, components in the body frame.
    /// angular_acceleration : array_like, shape (..., 3), optional
    ///     ω̇, components in the body frame; zero by default. The result is then the torque that keeps ω
    ///     constant in the body.
    /// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
    ///     P: the centre of mass of a body that moves freely, or a point fixed in space.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., 3)
    ///     ``N_P = I_P ω̇ + ω × I_P ω``, components in the body frame.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> body = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> body.torque((1.0, 2.0, 4.0))
    /// array([ 4., -6.,  2.])
    #[pyo3(
        signature = (omega, angular_acceleration=Argument::default(), about=Argument::default()),
        text_signature = "($self, omega, angular_acceleration=(0.0, 0.0, 0.0), about='center_of_mass')"
    )]
    fn torque<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        angular_acceleration: Argument<'py>,
        about: Argument<'py>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
        let acceleration = read_or(
            &angular_acceleration,
            "angular_acceleration",
            Vector3::zeros(),
        )?;
        let about = points(py, &self.bodies, about.value(), "about")?;
        let shapes = [
            &self.bodies.shape[..],
            &omega.shape,
            &acceleration.shape,
            &about.shape,
        ];
        let grid = Broadcast::of(["body", "omega", "angular_acceleration", "about"], shapes)?;
        let torque = grid.try_map(py, |[b, w, a, p]| {
            self.bodies[b].check_about(&about[p])?;
            Ok(EulerEquations::about(&self.bodies[b], &about[p])
                .torque(&omega[w], &acceleration[a]))
        })?;
        write(py, &torque)
    }
}
