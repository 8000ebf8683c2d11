//! Solids bounded by a closed triangle mesh.
//!
//! The divergence theorem turns the volume integrals into sums over triangles: each triangle (a, b, c) spans a signed
//! tetrahedron with a reference point, of volume `a·((b − a)×(c − a))/6`. The sums are those of the solid only when the
//! mesh is closed and consistently wound; an open mesh would give numbers that depend on where it stands, so it is refused.
//!
//! | what | file |
//! |---|---|
//! | whether the mesh is closed, and the edge at which it is not | `boundary` |
//! | faces that stand twice | `duplicates` |
//! | which components lie in which | `nesting` |
//! | the solid inside triangles, wherever they come from | `solid` |
//! | the body of what was summed | `matter` |
//! | meshes in memory | `in_memory`, `view`, `faces` |
//! | meshes larger than memory | [`stream`], `passes`, [`streamed`] |
//! | open meshes closed on request | [`closure`] |

mod boundary;
pub mod closure;
mod duplicates;
mod faces;
mod in_memory;
mod matter;
mod nesting;
mod passes;
mod solid;
pub mod stream;
pub mod streamed;
mod view;

pub use in_memory::{outward, polyhedron, polyhedron_watched};
pub(super) use matter::{in_units, is_settled, matter};
pub(super) use nesting::find_components;
pub use solid::Options;
pub use view::Index;
pub(super) use view::{View, widen};
