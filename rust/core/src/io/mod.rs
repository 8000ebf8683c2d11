//! Triangles from files.
//!
//! | format | file |
//! |---|---|
//! | binary STL | [`stl`] |
//! | binary PLY | [`ply`] |
//! | `v`/`f` text: OBJ geometry and plate models | [`plates`] |

mod mesh;
pub mod plates;
pub mod ply;
pub mod stl;

pub use mesh::TriangleMesh;
