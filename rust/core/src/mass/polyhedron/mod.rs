//! Solids bounded by a closed triangle mesh.
//!
//! The divergence theorem turns the volume integrals into sums over triangles: each triangle (a, b, c) spans a signed
//! tetrahedron with a reference point, of volume `a·((b − a)×(c − a))/6`. The sums are those of the solid only when the
//! mesh is closed and consistently wound; an open mesh would give numbers that depend on where it stands, so it is refused.
//!
//! | what | file |
//! |---|---|
//! | whether the mesh is closed, the edge at which it is not, faces that stand twice | `boundary` |
//! | which components lie in which | `nesting` |
//! | the solid inside triangles, wherever they come from | `solid` |
//! | meshes in memory | `in_memory`, `view` |
//! | meshes larger than memory | [`stream`], [`streaming`] |
//! | open meshes closed on request | [`closure`] |

mod boundary;
pub mod closure;
mod in_memory;
mod nesting;
mod solid;
pub mod stream;
pub mod streaming;
mod view;

pub use in_memory::{MeshSolid, polyhedron, polyhedron_watched};
pub(super) use nesting::find_components;
pub use solid::Options;
pub(super) use solid::{in_units, matter};
pub use view::Index;
pub(super) use view::{View, widen};
