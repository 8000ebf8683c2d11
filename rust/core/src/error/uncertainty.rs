//! Why numbers are no standard deviations or covariances, or none of a body.

use thiserror::Error as ThisError;

use super::kind::Kind;

/// Why a covariance is none.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum UncertaintyFault {
    /// A variance below zero.
    #[error(
        "covariance must have no negative variance: element [{index}][{index}] is {variance:?}"
    )]
    NegativeVariance {
        /// Which.
        index: usize,
        /// The element of the diagonal.
        variance: f64,
    },
    /// The matrix is not symmetric.
    #[error(
        "covariance must be symmetric: element [{row}][{column}] is {a:?} but [{column}][{row}] is {b:?}"
    )]
    NotSymmetric {
        /// Row of the first element.
        row: usize,
        /// Column of the first element.
        column: usize,
        /// The first element.
        a: f64,
        /// Its mirror image.
        b: f64,
    },
    /// Correlations beyond one.
    #[error(
        "covariance must be positive semidefinite: number {index} would have {left:.3e} of its variance left beside what the \
         numbers before it explain"
    )]
    NotPositive {
        /// The first number whose correlations with those before it are too strong.
        index: usize,
        /// What is left of its variance, relative to it.
        left: f64,
    },
    /// A variance that no body can have.
    #[error(
        "no body has this covariance: its extent along the axis ({:.3}, {:.3}, {:.3}) is zero, and what is never negative and \
         zero on average has no variance, where ∫ x² dm along it would have the standard deviation {sigma:?}; \
         model a thickness, with a sigma of its own",
        axis[0], axis[1], axis[2]
    )]
    NoBody {
        /// Along which the body has no extent.
        axis: [f64; 3],
        /// Standard deviation of its second moment there.
        sigma: f64,
    },
}

impl UncertaintyFault {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::NoBody { .. } => Kind::Inertia,
            Self::NegativeVariance { .. }
            | Self::NotSymmetric { .. }
            | Self::NotPositive { .. } => Kind::Argument,
        }
    }
}
