//! Quotients of shifted theta functions: `ϑ₁(z + iy)/ϑ₄(z)` and `ϑ₂(z + iy)/ϑ₄(z)` with z = πu/2K, for fixed y.
//!
//! Their squared magnitudes are linear in sn²u, and their phases are elliptic integrals of the third kind but for a steady
//! part. The zero of either numerator lies at y = 0, so a small y keeps its digits; toward the other end of the strip,
//! `y = πK′/2K`, they become constant in magnitude, and nothing is lost there.
//!
//! Three of them come together, `ϑ₁` once and `ϑ₂` twice, with one denominator. Each may be scaled.
//!
//! | what | file |
//! |---|---|
//! | the quotients as sums of sines and cosines | `circular` |
//! | the same as sums of hyperbolic functions | `hyperbolic` |
//! | the sums of both | `series` |

mod circular;
mod hyperbolic;
mod series;
#[cfg(test)]
mod tests;

pub(crate) use circular::Circular;
pub(crate) use hyperbolic::Hyperbolic;
pub(crate) use series::Values;
