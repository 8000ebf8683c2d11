//! Binary STL: 80 bytes of anything, the number of triangles, then 50 bytes a triangle.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::path::Path;

use super::mesh::TriangleMesh;
use crate::error::FileFault;
use crate::mass::polyhedron::stream::{BLOCK, StreamError, Triangle, TriangleStream};

const HEADER: usize = 84;
const RECORD: usize = 50;
/// Triangles read at a time.
const CHUNK: usize = 1024;

/// Reads a binary STL of `held` bytes; corners with the same coordinates (−0 equals +0) become one vertex.
///
/// The length is checked against the header before anything is allocated; the stored normals and attributes are not read,
/// since the order of the corners says the same.
///
/// # Examples
///
/// ```
/// use polhode::io::stl;
///
/// let mut bytes = vec![0_u8; 80]; // a header, the count of triangles, and each with its normal and its corners
/// bytes.extend(1_u32.to_le_bytes());
/// for number in [0.0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
///     bytes.extend(number.to_le_bytes());
/// }
/// bytes.extend([0, 0]);
/// let mesh = stl::read(&bytes[..], bytes.len() as u64).unwrap();
/// assert_eq!((mesh.faces.len(), mesh.vertices[1]), (1, [1.0, 0.0, 0.0]));
/// ```
///
/// # Errors
/// When reading fails or the length is not what the header promises.
pub fn read(mut source: impl Read, held: u64) -> Result<TriangleMesh, StreamError> {
    let count = triangles(&mut source, held)?;
    let mut welder = Welder::default();
    let mut faces = Vec::new();
    // A sparse file can be longer than memory.
    (faces.try_reserve_exact(count)).map_err(|_| io::Error::from(ErrorKind::OutOfMemory))?;
    let mut buffer = vec![0; RECORD * CHUNK.min(count)];
    while faces.len() < count {
        let records = &mut buffer[..RECORD * CHUNK.min(count - faces.len())];
        source.read_exact(records)?;
        faces.extend(
            records
                .chunks_exact(RECORD)
                .map(|record| [12, 24, 36].map(|at| welder.vertex(&record[at..at + 12]))),
        );
    }
    Ok(TriangleMesh {
        vertices: welder.vertices,
        faces,
    })
}

/// Reads a file as [`read`] does.
///
/// # Errors
/// When the file cannot be opened, and as [`read`].
pub fn read_file(path: impl AsRef<Path>) -> Result<TriangleMesh, StreamError> {
    let file = File::open(path)?;
    let held = file.metadata()?.len();
    read(BufReader::with_capacity(RECORD * CHUNK, file), held)
}

/// The number of triangles that the header promises and the length confirms; `source` is then at the first of them.
fn triangles(source: &mut impl Read, held: u64) -> Result<usize, StreamError> {
    let mut header = [0; HEADER];
    if held < HEADER as u64 {
        return Err(FileFault::NoStlHeader { held }.into());
    }
    source.read_exact(&mut header)?;
    let triangles = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    let promised = HEADER as u64 + RECORD as u64 * u64::from(triangles);
    match held.cmp(&promised) {
        Ordering::Less => Err(FileFault::TruncatedStl {
            held,
            promised,
            triangles,
        }
        .into()),
        Ordering::Greater => Err(FileFault::NotStl {
            held,
            promised,
            triangles,
        }
        .into()),
        Ordering::Equal => Ok(triangles as usize),
    }
}

/// A binary STL as a stream of triangles.
#[derive(Debug)]
pub struct StlStream<R> {
    source: R,
    count: usize,
}

impl StlStream<File> {
    /// A file by its path: as large as the disk, since its triangles are never all in memory.
    ///
    /// # Errors
    /// When the file cannot be opened, and as [`Self::new`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, StreamError> {
        let file = File::open(path)?;
        let held = file.metadata()?.len();
        Self::new(file, held)
    }
}

impl<R: Read + Seek> StlStream<R> {
    /// A file of `held` bytes, read from its beginning.
    ///
    /// # Errors
    /// When reading fails or the length is not what the header promises.
    pub fn new(mut source: R, held: u64) -> Result<Self, StreamError> {
        let count = triangles(&mut source, held)?;
        Ok(Self { source, count })
    }
}

impl<R: Read + Seek> TriangleStream for StlStream<R> {
    fn blocks(
        &mut self,
        visit: &mut dyn FnMut(&[Triangle], f64) -> ControlFlow<()>,
    ) -> Result<(), StreamError> {
        self.source.seek(SeekFrom::Start(HEADER as u64))?;
        let mut buffer = vec![0; RECORD * BLOCK.min(self.count)];
        let mut block = Vec::with_capacity(BLOCK.min(self.count));
        let mut done = 0;
        while done < self.count {
            let size = BLOCK.min(self.count - done);
            let records = &mut buffer[..RECORD * size];
            self.source.read_exact(records)?;
            block.clear();
            block.extend(
                records.chunks_exact(RECORD).map(|record| {
                    [12, 24, 36].map(|at| point(&record[at..at + 12]).map(f64::from))
                }),
            );
            done += size;
            if visit(&block, done as f64 / self.count as f64).is_break() {
                return Ok(());
            }
        }
        Ok(())
    }
}

/// Three coordinates as stored.
#[inline(always)]
fn point(corner: &[u8]) -> [f32; 3] {
    [0, 4, 8].map(|k| f32::from_le_bytes([corner[k], corner[k + 1], corner[k + 2], corner[k + 3]]))
}

/// Number the corners; equal corners have the same number.
#[derive(Default)]
struct Welder {
    numbers: HashMap<[u32; 3], usize>,
    vertices: Vec<[f64; 3]>,
}

impl Welder {
    fn vertex(&mut self, corner: &[u8]) -> usize {
        let point = point(corner).map(|x| x + 0.0);
        let next = self.vertices.len();
        let number = *self.numbers.entry(point.map(f32::to_bits)).or_insert(next);
        if number == next {
            self.vertices.push(point.map(f64::from));
        }
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    fn file(triangles: u32, corners: &[[f32; 3]]) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes.extend(triangles.to_le_bytes());
        for triangle in corners.chunks_exact(3) {
            bytes.extend([0; 12]);
            bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn corners_are_welded() {
        let a = [0.0, 0.0, 0.0];
        let b = [1.0, 0.0, -0.0];
        let c = [0.0, 1.0, 0.0];
        let bytes = file(2, &[a, b, c, c, [1.0, -0.0, 0.0], [1.0, 1.0, 0.0]]);
        let mesh = read(&bytes[..], bytes.len() as u64).expect("valid");
        assert_eq!(mesh.vertices.len(), 4);
        assert_eq!(mesh.faces, [[0, 1, 2], [2, 1, 3]]);
    }

    #[test]
    fn a_boastful_header_allocates_nothing() {
        let bytes = file(4_000_000_000, &[]);
        let error = read(&bytes[..], bytes.len() as u64).expect_err("truncated");
        assert!(matches!(
            error,
            StreamError::Failed(Error::File(FileFault::TruncatedStl { held: 84, .. }))
        ));
        let error = read(&bytes[..10], 10).expect_err("too short");
        assert!(matches!(
            error,
            StreamError::Failed(Error::File(FileFault::NoStlHeader { held: 10 }))
        ));
    }
}
