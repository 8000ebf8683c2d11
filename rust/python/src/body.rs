//! The class `RigidBody`: one body, or a stack of them. Its methods are in `rigid_body`.

use std::sync::Arc;

use polhode::RigidBody;
use polhode::uncertainty::LinearUncertainty;
use pyo3::prelude::*;

use crate::figure::Figures;
use crate::stack::Stack;

/// The uncertainties of each body of a stack, or none where all is taken as known.
pub(crate) type Uncertainties = Option<Arc<Vec<LinearUncertainty>>>;

/// A rigid body, or a stack of bodies: mass, centre of mass C, inertia tensor about C.
///
/// Everything is expressed in the body frame B with origin O. A tensor that no body can have is an error: it
/// must be symmetric, have no negative principal moment about C, and obey the triangle inequality, all
/// relative to its own size. A body is immutable; operations return new bodies.
///
/// Parameters
/// ----------
/// mass : array_like, shape (...)
///     Positive.
/// inertia : array_like, shape (..., 3, 3), optional
///     Tensor about C, ``I_ij = ∫ (r² δ_ij − r_i r_j) dm``: off-diagonal elements are *minus* the
///     products of inertia.
/// center_of_mass : array_like, shape (..., 3), optional
///     Vector from the origin of the body frame to C; zero by default.
/// inertia_about_origin : array_like, shape (..., 3, 3), optional
///     Tensor about O, in place of `inertia` (give exactly one of the two).
/// rtol : float, optional
///     Tolerance for tables printed to few digits: asymmetry and violations of the triangle inequality up to
///     this fraction are accepted. By default only rounding errors are, 16 ε of the trace.
///
/// Raises
/// ------
/// InvalidInertiaError
///     If no body can have these properties. The message tells which law fails and by how much.
///
/// Notes
/// -----
/// Leading axes stack and broadcast as in NumPy, and ``body[index]`` takes bodies out of a stack. Other ways
/// to a body: `from_principal`, `from_particles`, `from_mesh`, `from_tetrahedra`, `from_density`,
/// `from_file`, and :mod:`polhode.solids`, :mod:`polhode.laminae`, :mod:`polhode.rods`. A principal moment
/// below 16 ε of the trace is stored as exactly zero, since a float64 tensor cannot tell it from zero.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> from polhode import RigidBody
/// >>> brick = RigidBody(mass=2.0, inertia=np.diag([1.0, 2.0, 2.5]), center_of_mass=(0, 0, 1))
/// >>> brick.principal_moments
/// array([1. , 2. , 2.5])
/// >>> brick.inertia_about("origin")
/// array([[3. , 0. , 0. ],
///        [0. , 4. , 0. ],
///        [0. , 0. , 2.5]])
/// >>> RigidBody(mass=1.0, inertia=np.diag([1.0, 1.0, 3.0]))
/// Traceback (most recent call last):
///     ...
/// polhode.errors.InvalidInertiaError: principal moments 1.0, 1.0, 3.0 break the triangle inequality I1 + I2 >= I3 by 1.0, 2.00e-1 of their sum: no distribution of mass has them; check the numbers and their units (validity.nearest_valid finds the nearest tensor that a body has)
#[pyclass(name = "RigidBody", module = "polhode", frozen)]
#[derive(Clone)]
pub(crate) struct PyRigidBody {
    pub(crate) bodies: Stack<RigidBody>,
    /// What is not known of them.
    pub(crate) uncertainties: Uncertainties,
    /// What they look like.
    pub(crate) figures: Figures,
}

impl From<Stack<RigidBody>> for PyRigidBody {
    fn from(bodies: Stack<RigidBody>) -> Self {
        Self {
            bodies,
            uncertainties: None,
            figures: None,
        }
    }
}
