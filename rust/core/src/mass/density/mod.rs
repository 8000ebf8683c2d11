//! Bodies of given density: `m = ∫ ρ dV`, `C = ∫ r ρ dV/m`, `S = ∫ (r − C)(r − C)ᵀ ρ dV`, by adaptive cubature.
//!
//! | what | file |
//! |---|---|
//! | the body that fills a region | `filled` |
//! | the integrand: mass and moments about the middle of each cell | `matter` |
//! | the whole of the cells about its own centre of mass | `total` |
//! | densities in a unit of their own | `scaled` |
//! | balls whose density depends on the radius alone | `radial` |
//! | how far a cubature may go, and how far it came | `effort` |

mod effort;
mod filled;
mod matter;
mod radial;
mod scaled;
mod total;

pub use effort::{Effort, Estimate};
pub use filled::from_density;
pub use radial::from_radial_density;
