//! Principal axes and tops: the frame in which a body's inertia tensor is diagonal, and what kind of top the body is.
//!
//! | what | file |
//! |---|---|
//! | I = V diag(I₁, I₂, I₃) Vᵀ | [`axes`] |
//! | the axes nearest to the body frame, where a body leaves them free | [`canonical`](mod@canonical) |
//! | what a small change of the tensor does | [`derivative`](mod@derivative) |
//! | which moments are equal | [`tops`] |
//! | the symmetric top | [`symmetric_top`] |

pub mod axes;
pub mod canonical;
pub mod derivative;
pub mod symmetric_top;
pub mod tops;

pub use axes::{
    PrincipalAxes, principal_axes, principal_axes_many, principal_moments_many, with_sign_rule,
};
pub use canonical::{ROUNDING_RTOL, canonical, canonical_many, canonical_to_rounding};
pub use derivative::{DEGENERATE_RTOL, PrincipalDerivative, derivative};
pub use symmetric_top::SymmetricTop;
pub use tops::{TOP_RTOL, Top, classify, classify_within, gaps, ray_kappa, rounding_rtols};
