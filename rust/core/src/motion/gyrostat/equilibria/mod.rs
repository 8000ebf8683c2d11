//! Steady rotations of a gyrostat with a given total angular momentum: all of them, whether they are stable, and where
//! their number changes.
//!
//! A body with a constant momentum h inside turns steadily where ω is along L = I ω + h, `ω = μ L`, so that in principal
//! axes `L_i = h_i/(1 − μ I_i)`, and μ is a root of
//!
//! ```text
//! f(μ) = Σ h_i²/(1 − μ I_i)² = L².
//! ```
//!
//! f has poles at `1/I_i`, falls to zero on either side of all of them and is convex between two of them. So there is one
//! root on either side and none or two between two poles, as f's minimum there lies above or below L²: two, four or
//! six equilibria, counted without any polynomial. The minimum itself says where the number changes, by a *fold*. A pole
//! without its `h_i` is none, and `μ = 1/I_i` is then a multiplier of its own, with `L_i` of either sign and all that the other
//! components leave of L²; where they leave nothing, both meet a root of f: a *pitchfork*.
//!
//! On the sphere of L in the body an equilibrium is a stationary point of the energy `½ (L − h)·I⁻¹(L − h)`, whose second
//! variation is that of `I⁻¹ − μ` across L. Its determinant D gives the motion close by: L circles with the
//! frequency `|L| √D`, or departs as `exp(|L| √−D t)`.
//!
//! Everything is computed to twice the precision, each root as its distance from a pole in units of what is left of h there.
//! Derived here; phase portraits and bifurcations in papers by Elipe and Lanchares, stability in Hughes, Spacecraft Attitude
//! Dynamics.
//!
//! | file | what it knows |
//! |---|---|
//! | `axes` | axes of which equal moments have one along their part of h |
//! | `secular` | f: its roots and its minima |
//! | `steady` | directions, energies, rates, kinds; folds and pitchforks |

mod axes;
mod secular;
mod steady;
#[cfg(test)]
mod tests;

pub use steady::{Bifurcation, Equilibria, Equilibrium, Extent, Kind, Meeting, equilibria};
