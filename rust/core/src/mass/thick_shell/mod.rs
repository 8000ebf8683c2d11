//! Shells of finite thickness: what a surface sweeps when its faces are moved to both sides.
//!
//! The mid-surface has corners v and, at each, a direction d (`offset`): at the distance s it has the corners `v + s d`,
//! and s runs over ±t/2. With the barycentric coordinates λ of a triangle, edges e and f,
//!
//! `∫ g dV = ∫ ds ∫ g(x) Σ λ_i J_i dλ`, `x = Σ λ_i (v_i + s d_i)`, `J_i = d_i · (e(s) × f(s))`,
//!
//! which is the solid between the outer and the inner offset, walls along the open rim included, without their difference:
//! all J are positive, so a shell as thin as you like keeps its digits. Over λ the integrals are closed forms, over s
//! polynomials of the fourth degree, for which three points of Gauss are exact.

//!
//! | what | file |
//! |---|---|
//! | the body of a shell | `shell` |
//! | the integrals over what its faces sweep | `placed` |
//! | where vertices go, and how thick a shell may be | `offset` |
//! | whether faces are a surface | `edges` |

mod edges;
mod offset;
mod placed;
mod shell;

pub use shell::thick_shell;
