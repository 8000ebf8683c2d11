//! Rigid-body dynamics: from a mass distribution to its inertia tensor, to its principal axes, to its motion.
//!
//! Motion is built on mass, mass on principal axes, these on numerics; nothing points back up.
//!
//! | the page says | module |
//! |---|---|
//! | `I = ∫ (r² 1 − r rᵀ) dm`, `I_P = I_C + m (d² 1 − d dᵀ)` | [`mass`] |
//! | `I = V diag(I₁, I₂, I₃) Vᵀ` | [`principal`] |
//! | `I ω̇ + ω × I ω = N`, `q̇ = ½ q∘ω`, `T = ½ ω·I ω`, `L = I ω` | [`motion`] |
//! | `Σ = S Sᵀ`: what is not known of a body, and what it makes of all that follows | [`uncertainty`] |
//! | numbers drawn for the members of an ensemble | [`random`] |
//! | triangles from files | [`io`] |
//! | eigenvalues, sums, lanes, threads: the only part that is not physics | [`numerics`] |
//! | what can be wrong, as plain data | [`error`] |
//!
//! # Notation
//!
//! | symbol | meaning |
//! |---|---|
//! | N, B, P | inertial frame, body frame, principal axes (as a frame) or any point of the body (as a point) |
//! | C, O | centre of mass, origin of the body frame |
//! | `I_P` | inertia tensor about the point P, components in B; `I_ij = ∫ (r² δ_ij − r_i r_j) dm` |
//! | V | principal axes as columns, `v_B = V v_P` |
//! | `R_NB`, `q_NB` | attitude, active: `v_N = R_NB v_B`; quaternions are (x, y, z, w) |
//! | ω | angular velocity of B relative to N, components in B |
//!
//! Units are any coherent set.
//!
//! # Example
//!
//! ```
//! use polhode::mass::{Amount, solids};
//! use polhode::motion::euler_equations::EulerEquations;
//! use nalgebra::Vector3;
//!
//! let brick = solids::cuboid(&[8.0, 4.0, 2.25], Amount::Mass(1.0))?;
//! assert!((brick.principal().moments[2] - (8.0 * 8.0 + 4.0 * 4.0) / 12.0).abs() < 1e-14);
//! let equations = EulerEquations::about(&brick, &brick.center_of_mass());
//! let acceleration = equations.angular_acceleration(&Vector3::new(0.1, 0.2, 0.3), &Vector3::zeros())?;
//! assert!(acceleration.norm() > 0.0);
//! # Ok::<(), polhode::Error>(())
//! ```

// Symbols must match the page they come from.
#![allow(non_snake_case)]

pub mod error;
pub mod io;
pub mod mass;
pub mod motion;
pub mod numerics;
pub mod principal;
pub mod random;
pub mod uncertainty;

/// Vectors, matrices and quaternions of this crate's interface: its `nalgebra` is the one that fits.
pub use nalgebra;

pub use error::Error;
pub use mass::RigidBody;
pub use principal::PrincipalAxes;

/// The examples of the readme, which run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
