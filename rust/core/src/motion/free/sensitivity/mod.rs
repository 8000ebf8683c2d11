//! What a small change at the start, or of the moments, has become at a time t: exact, at any t.
//!
//! ω(t) is a rational function of ω(0), of the contrasts and of three elliptic [functions of time](super::clock), which are
//! smooth in all of them, so its derivatives follow by the rules. The attitude needs no integral of the third kind. Write
//! its change as a small rotation `δ`, components in B, `R → R exp(δ×)`:
//!
//! - across L: `L_N = R I ω` is constant, so its change is what it was at the start, `δ×L + I δω + δI ω` turned into the
//!   present body axes;
//! - along L: `d(δ·L)/dt = L·δω = δT − ½ ω·δI ω`, hence `δ·L = (δ·L)₀ + t δT − ½ Σ δI_k ∫ω_k² dt`.
//!
//! The integrals of `ω_k²` are of the second kind; they have the addition theorem
//! `∫ω₂² dt = A₁A₃ ∫y² dt + ω₂(0) ω₂(t) y`, and `α₂ω₁² + α₁ω₂² = A₃`, `α₃ω₂² + α₂ω₃² = A₁` give the others.
//!
//! | file | what it knows |
//! |---|---|
//! | `derivatives` | the derivatives of the state at a time |
//! | `rates` | those of ω |
//! | `half_periods` | what whole half periods leave of a time |

mod derivatives;
mod half_periods;
mod rates;
#[cfg(test)]
mod tests;

pub use derivatives::Sensitivity;
