//! Binary PLY: a text header that names elements and their properties, then their bytes.
//!
//! The vertices are kept in memory as they are stored, since faces name them in any order; the faces are a stream. A face of
//! more than three corners becomes a fan of triangles.
//!
//! | what | file |
//! |---|---|
//! | the triangles of a file | `stream` |
//! | elements and their properties | `header` |
//! | numbers, and the vertices | `reader` |

mod header;
mod reader;
mod stream;

pub use stream::PlyStream;
