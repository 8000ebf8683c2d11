//! Principal moments and axes to twice the precision, and to four times.
//!
//! | what | file |
//! |---|---|
//! | to twice the precision | `principal` |
//! | to four times | `finest` |
//! | Jacobi's rotations | `jacobi` |
//! | vectors and matrices of such numbers | `vectors` |
//!
//! # Examples
//!
//! ```
//! use polhode::DoubleDouble;
//! use polhode::mass::refined::{RefinedPrincipal, Vector};
//! use polhode::mass::{Amount, solids};
//!
//! let brick = solids::cuboid(&[0.3, 0.2, 0.1], Amount::Mass(1.0))?;
//! let refined = RefinedPrincipal::of(&brick);
//! let moments: Vector = refined.moments;
//! // I₁ = m (b² + c²)/12, off by half a unit of rounding as a float64, and by far less as two.
//! assert!((moments[0].rounded() - 0.05 / 12.0).abs() < 1e-17);
//! let spin: Vector = refined.components(&[1.0, 2.0, 3.0].into());
//! assert_eq!(spin.map(DoubleDouble::rounded), [1.0, 2.0, 3.0]);
//! # Ok::<(), polhode::Error>(())
//! ```

mod finest;
mod jacobi;
mod principal;
mod vectors;

pub use principal::RefinedPrincipal;
pub use vectors::Vector;
