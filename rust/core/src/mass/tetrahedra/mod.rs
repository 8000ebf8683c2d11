//! Bodies made of tetrahedra, their density uniform, one for each cell, or linear between nodes: exact integrals.
//!
//! In barycentric coordinates λ the integrals of a linear density `ρ = Σ ρ_i λ_i` over a cell of volume V are, with
//! `P = Σ ρ_i`, `∫ρ = V P/4`, `∫ρ λ_i = V (P + ρ_i)/20`, and `∫ρ λ_i λ_j = V (P + ρ_i + ρ_j)/120`, twice that for `i = j`.
//!
//! | what | file |
//! |---|---|
//! | the body of all cells | `cells` |
//! | what nodes, cells and densities must be | `check` |
//! | the volume of a cell, however flat | `volume` |
//! | the integrals of all cells | `sums` |

mod cells;
mod check;
mod sums;
mod volume;

pub use self::cells::tetrahedra;
pub use self::check::CellDensity;
