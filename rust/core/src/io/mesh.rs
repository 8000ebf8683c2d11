//! What a reader found, all of it in memory.

/// Vertices and the triangles that count them from zero.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// Coordinates as stored in the file.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of each triangle.
    pub faces: Vec<[usize; 3]>,
}
