//! Theta functions: Jacobi's sn, cn, dn, and the phase of Θ away from the real axis.
//!
//! All are of the real argument u, |u| ≤ K, in units in which the half periods are K and iK′. There are two kinds of
//! series for each: in [`circular`] functions of πu/2K, whose nome `q = e^{−πK′/K}` is small while K′ is not small beside
//! K, and, after Jacobi's imaginary transformation, in [`hyperbolic`] functions of πu/2K′, whose nome `e^{−πK/K′}`
//! vanishes where K is infinite. Either takes a handful of terms.
//!
//! `Θ(u) = ϑ₄(πu/2K) = 1 + 2 Σ (−1)ⁿ q^{n²} cos(nπu/K)` has its zeros at iK′ and a period away. Its phase on the line
//! u + ia, |a| < K′, is what an elliptic integral of the third kind is made of. Near the zero the distance K′ − a carries
//! the digits, so it is what the constructors ask for.
//!
//! Source: E. T. Whittaker, G. N. Watson, A Course of Modern Analysis, chapters 21 and 22.
//!
//! | what | file |
//! |---|---|
//! | K and K′, sums of sines and cosines | [`circular`] |
//! | sums of hyperbolic functions | [`hyperbolic`] |
//! | quotients of shifted functions | [`quotients`] |

pub(crate) mod circular;
pub(crate) mod hyperbolic;
pub(crate) mod quotients;
#[cfg(test)]
mod tests;

pub(crate) use circular::HalfPeriods;
