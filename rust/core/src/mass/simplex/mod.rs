//! Sums over simplices: the segments of a wire, the triangles of a shell, the tetrahedra that the triangles of a closed
//! mesh span with a point.
//!
//! A uniform simplex with corners `v_0 … v_k`, `s = Σ v` and content w (length, area, volume) has
//! `∫ dm = w`, `∫ r dm = w s/(k + 1)`, `∫ r rᵀ dm = w (Σ v vᵀ + s sᵀ)/((k + 1)(k + 2))`.
//!
//! Coordinates are taken from a reference within the body, so that nothing cancels wherever the body stands. Simplex i
//! goes to lane `i mod 8` of block `i / 4096`; lanes and blocks are merged in a fixed tree (see
//! [`reduce`](crate::numerics::reduce)), so the bits depend neither on threads nor on how a stream is cut.
//!
//! | what | file |
//! |---|---|
//! | what the sums come to in a frame | `sums` |
//! | where coordinates are taken from, and how exactly | `frame` |
//! | lengths, areas, volumes | `kinds` |
//! | the sums over a block, and how blocks are merged | `block` |
//! | differences and products in lanes | `vectors` |

mod block;
mod frame;
mod kinds;
mod sums;
mod vectors;

pub(super) use block::{Corners, Partial, block_sum, merge};
pub(super) use frame::LocalFrame;
pub(super) use kinds::{FaintShell, Kind, Shell, Solid, Wire};
pub(super) use sums::{Sums, sums};
