//! Triangles from files.
//!
//! | format | file |
//! |---|---|
//! | binary STL | [`stl`] |
//! | binary PLY | [`ply`] |
//! | `v`/`f` text: OBJ geometry and plate models | [`plates`] |
//!
//! # Examples
//!
//! ```
//! use std::fs;
//! use std::ops::ControlFlow;
//! use polhode::io::ply::PlyStream;
//! use polhode::io::stl::{self, StlStream};
//! use polhode::io::TriangleMesh;
//! use polhode::mass::Amount;
//! use polhode::mass::polyhedron::stream::StreamError;
//! use polhode::mass::polyhedron::{Options, polyhedron, streaming::{StreamedSolid, stream_solid}};
//!
//! // The corner of a cube in both binary formats: corners, and faces that count them.
//! let corners: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let mut ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
//!     property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n".to_vec();
//! ply.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
//! let mut bytes = vec![b' '; 80];
//! bytes.extend(4_u32.to_le_bytes());
//! for face in faces {
//!     bytes.extend([0; 12]);
//!     bytes.extend(face.iter().flat_map(|&k: &usize| corners[k]).flat_map(f32::to_le_bytes));
//!     bytes.extend([0; 2]);
//!     ply.push(3);
//!     ply.extend(face.iter().flat_map(|&k| (k as i32).to_le_bytes()));
//! }
//!
//! // A file that fits into memory,
//! let path = std::env::temp_dir().join(format!("polhode-doc-{}.stl", std::process::id()));
//! fs::write(&path, &bytes)?;
//! let TriangleMesh { vertices, faces } = stl::read_file(&path)?;
//! let body = polyhedron(&vertices, &faces, Amount::Density(6000.0), false).map_err(StreamError::from)?;
//! assert!((body.mass() - 1000.0).abs() < 1e-9); // a sixth of a cubic metre
//!
//! // and the same as a stream, of which it keeps nothing but sums.
//! let go_on = &mut |_| ControlFlow::Continue(());
//! let mut stream = StlStream::open(&path)?;
//! let StreamedSolid { volume, .. } =
//!     stream_solid(&mut stream, 1.0, Amount::Density(6000.0), Options::default(), go_on)?;
//! assert!((volume - 1.0 / 6.0).abs() < 1e-15);
//! fs::remove_file(&path)?;
//!
//! let held = ply.len() as u64;
//! let mut stream = PlyStream::new(std::io::Cursor::new(ply), held)?;
//! assert_eq!(stream.vertex_count(), 4);
//! let solid = stream_solid(&mut stream, 1.0, Amount::Density(6000.0), Options::default(), go_on)?;
//! assert_eq!(solid.body.mass(), body.mass());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod mesh;
pub mod plates;
pub mod ply;
pub mod stl;

pub use mesh::TriangleMesh;
