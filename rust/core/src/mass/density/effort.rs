//! How far a cubature may go, and how far it came.

use crate::error::{BodyFault, Error, finite};
use crate::mass::body::RigidBody;

/// What the bound is of the error told. Of one jump between two nodes of a box the Kronrod rule is off by no more than
/// 1.22 times its difference from the Gauss rule, where the volume element grows across the box by 2, and of two jumps in
/// one box, which may cancel in the difference, seldom by more than 5; of what is smooth by far less.
pub(super) const JUMP: f64 = 8.0;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Bound on the errors of the mass relative to itself, of C relative to the radius of gyration, and of the second
    /// moments relative to their trace.
    pub rtol: f64,
    /// How often the density may be evaluated at most by the rules of the cubature; to look for jumps beside the faces of
    /// its cells takes up to a sixth more.
    pub max_evaluations: usize,
}

impl Effort {
    /// Enough for the first look at every cell, with a tolerance that is one.
    pub(super) fn check(self, needed: usize) -> Result<Self, Error> {
        finite("rtol", self.rtol)?;
        if !(self.rtol > 0.0 && self.rtol < 1.0) {
            return Err(Error::OutOfDomain {
                what: "rtol",
                law: "more than 0 and less than 1",
                value: self.rtol,
            });
        }
        if self.max_evaluations < needed {
            return Err(BodyFault::TooFewEvaluations {
                needed,
                given: self.max_evaluations,
            }
            .into());
        }
        Ok(self)
    }
}

/// What a cubature found: the body as far as it is known, and how well.
///
/// # Examples
///
/// ```
/// use polhode::Error;
/// use polhode::mass::density::{Effort, Estimate, from_density};
/// use polhode::mass::regions::Region;
/// use polhode::nalgebra::Vector3;
///
/// // A cube whose density grows from 0 to 2 along x: m = 1, C_x = 2/3.
/// let cube = Region::cuboid(&Vector3::zeros(), &Vector3::repeat(1.0))?;
/// let density = |points: &[[f64; 3]], out: &mut [f64]| {
///     for (out, point) in out.iter_mut().zip(points) {
///         *out = 2.0 * point[0];
///     }
///     Ok::<_, Error>(())
/// };
/// let found: Estimate = from_density(&cube, density, Effort { rtol: 1e-10, max_evaluations: 100_000 })?;
/// assert!(found.error < found.rtol);
/// assert!((found.converged()?.center_of_mass().x - 2.0 / 3.0).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "an estimate is a body where the cubature has converged"]
pub struct Estimate {
    /// The body as far as it is known.
    pub body: RigidBody,
    /// The estimated relative error.
    pub error: f64,
    /// What was asked for.
    pub rtol: f64,
    /// How many evaluations it took.
    pub evaluations: usize,
}

impl Estimate {
    /// The body, where the cubature has converged.
    ///
    /// # Errors
    /// [`BodyFault::Quadrature`].
    pub fn converged(&self) -> Result<RigidBody, Error> {
        if self.error <= self.rtol {
            return Ok(self.body);
        }
        Err(BodyFault::Quadrature {
            error: self.error,
            rtol: self.rtol,
            evaluations: self.evaluations,
        }
        .into())
    }
}
