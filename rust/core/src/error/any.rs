//! The error that every function of this crate returns: what can be wrong with any argument, or the fault of a family.

use thiserror::Error as ThisError;

use super::body::BodyFault;
use super::file::FileFault;
use super::kind::Kind;
use super::mesh::{CellFault, MeshFault};
use super::motion::MotionFault;
use super::polygon::PolygonFault;
use super::uncertainty::UncertaintyFault;

/// An input that breaks a law of mechanics, of geometry or of the numbers themselves.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum Error {
    /// A number is NaN or infinite.
    #[error("{what} must be finite, got {value:?}")]
    NonFinite {
        /// The argument.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A length, scale or density is negative, or zero where it must not be.
    #[error("{what} must be {law}, got {value:?}")]
    OutOfDomain {
        /// The argument.
        what: &'static str,
        /// What it must be.
        law: &'static str,
        /// The number.
        value: f64,
    },
    /// Two lengths are the wrong way round.
    #[error("{smaller} must not exceed {larger}, got {smaller} = {a:?} and {larger} = {b:?}")]
    OutOfOrder {
        /// The length that should be the smaller.
        smaller: &'static str,
        /// What it is.
        a: f64,
        /// The length that should be the larger.
        larger: &'static str,
        /// What it is.
        b: f64,
    },
    /// An interval is empty.
    #[error("{smaller} must be below {larger}, got {smaller} = {a:?} and {larger} = {b:?}")]
    NotBelow {
        /// What should be below.
        smaller: &'static str,
        /// What it is.
        a: f64,
        /// What should be above.
        larger: &'static str,
        /// What it is.
        b: f64,
    },
    /// There is nothing where something is needed.
    #[error("{what} must not be empty")]
    Empty {
        /// The argument.
        what: &'static str,
    },
    /// A direction of zero length.
    #[error("{what} must not be the zero vector: it has no direction")]
    NoDirection {
        /// The argument.
        what: &'static str,
    },
    /// A matrix is not a rotation.
    #[error(
        "{what} must be a right-handed rotation matrix: its columns deviate from an orthonormal set by {deviation:.2e} \
         and its determinant is {determinant:?}"
    )]
    NotARotation {
        /// The argument.
        what: &'static str,
        /// Largest element of `RᵀR − 1`.
        deviation: f64,
        /// The determinant.
        determinant: f64,
    },
    /// A quaternion does not have unit length.
    #[error(
        "{what} must be a unit quaternion (x, y, z, w): its norm is {norm:?}; divide it by its norm"
    )]
    NotAUnitQuaternion {
        /// The argument.
        what: &'static str,
        /// Its norm.
        norm: f64,
    },
    /// More results than there is memory for; nothing has been computed.
    #[error(
        "{count} {what} would take {bytes:.3e} bytes, for which there is no memory: ask for fewer at a time"
    )]
    NoMemory {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
        /// All together.
        bytes: f64,
    },
    /// Whoever watched the work asked it to stop.
    #[error("the computation was stopped before it was finished")]
    Stopped,
    /// The numbers, particles or densities make no such body.
    #[error(transparent)]
    Body(#[from] BodyFault),
    /// The mesh cannot be used; the message says which part of it and why.
    #[error(transparent)]
    Mesh(#[from] MeshFault),
    /// The corners do not bound a polygon; the message says where and why.
    #[error(transparent)]
    Polygon(#[from] PolygonFault),
    /// The numbers are no covariance, or none of a body.
    #[error(transparent)]
    Uncertainty(#[from] UncertaintyFault),
    /// The tetrahedra cannot be used; the message says which and why.
    #[error(transparent)]
    Cells(#[from] CellFault),
    /// The file cannot be used; the message says where and why.
    #[error(transparent)]
    File(#[from] FileFault),
    /// The motion, the attitude or the load cannot be told; the message says why.
    #[error(transparent)]
    Motion(#[from] MotionFault),
}

impl Error {
    /// The kind of mistake.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::nalgebra::Matrix3;
    /// use polhode::nalgebra::Vector3;
    /// use polhode::RigidBody;
    /// use polhode::error::Kind;
    ///
    /// let tensor = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0));
    /// let error = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0).unwrap_err();
    /// assert_eq!(error.kind(), Kind::Inertia);
    /// ```
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Body(fault) => fault.kind(),
            Self::Motion(fault) => fault.kind(),
            Self::Mesh(fault) => fault.kind(),
            Self::Cells(fault) => fault.kind(),
            Self::Polygon(fault) => fault.kind(),
            Self::File(fault) => fault.kind(),
            Self::Uncertainty(fault) => fault.kind(),
            Self::NoMemory { .. } => Kind::Memory,
            Self::NonFinite { .. }
            | Self::OutOfDomain { .. }
            | Self::OutOfOrder { .. }
            | Self::NotBelow { .. }
            | Self::Empty { .. }
            | Self::NoDirection { .. }
            | Self::NotARotation { .. }
            | Self::NotAUnitQuaternion { .. }
            | Self::Stopped => Kind::Argument,
        }
    }
}
