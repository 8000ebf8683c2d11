//! The triangles of a file, read again whenever they are asked for.

use std::io::{BufRead, Seek, SeekFrom};
use std::ops::ControlFlow;

use super::header::{Element, Property, bad, header};
use super::reader::{Reader, Vertices, read_vertices, skip, skip_property, truncated};
use crate::error::MeshFault;
use crate::mass::polyhedron::stream::{BLOCK, StreamError, Triangle, TriangleStream};

/// A binary PLY as a stream of triangles.
#[derive(Debug)]
pub struct PlyStream<R> {
    source: R,
    big_endian: bool,
    faces: Element,
    after: Vec<Element>,
    /// Where the faces begin.
    start: u64,
    vertices: Vertices,
}

impl<R: BufRead + Seek> PlyStream<R> {
    /// A file of `held` bytes, read from its beginning: its header and its vertices.
    ///
    /// # Errors
    /// When reading fails, the header cannot be understood, or the file ends before its last vertex.
    pub fn new(mut source: R, held: u64) -> Result<Self, StreamError> {
        let (big_endian, elements) = header(&mut source)?;
        let place = |name: &str| elements.iter().position(|element| element.name == name);
        let (Some(of_vertices), Some(of_faces)) = (place("vertex"), place("face")) else {
            return Err(bad("it needs an element vertex and an element face"));
        };
        if of_faces < of_vertices {
            return Err(bad("its faces stand before its vertices"));
        }
        let mut reader = Reader::new(&mut source, big_endian);
        let mut vertices = None;
        for (place, element) in elements[..of_faces].iter().enumerate() {
            if place == of_vertices {
                vertices = Some(read_vertices(&mut reader, element, held)?);
            } else {
                skip(&mut reader, element)?;
            }
        }
        let start = source.stream_position()?;
        let vertices = vertices.ok_or_else(|| bad("it has no vertices"))?;
        Ok(Self {
            source,
            big_endian,
            faces: elements[of_faces].clone(),
            after: elements[of_faces + 1..].to_vec(),
            start,
            vertices,
        })
    }

    /// How many vertices the file has.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }
}

impl<R: BufRead + Seek> TriangleStream for PlyStream<R> {
    fn blocks(
        &mut self,
        visit: &mut dyn FnMut(&[Triangle], f64) -> ControlFlow<()>,
    ) -> Result<(), StreamError> {
        self.source.seek(SeekFrom::Start(self.start))?;
        let mut reader = Reader::new(&mut self.source, self.big_endian);
        let mut block: Vec<Triangle> = Vec::with_capacity(BLOCK);
        let mut corners = Vec::new();
        for face in 0..self.faces.count {
            corners.clear();
            let truncated = |error| truncated(&self.faces, face, error);
            for property in &self.faces.properties {
                match property {
                    Property::List(_, count, item) if property.name() == "vertex_indices" => {
                        let count = reader.count(*count).map_err(truncated)?;
                        for _ in 0..count {
                            corners.push(reader.integer(*item).map_err(truncated)?);
                        }
                    }
                    other => skip_property(&mut reader, other).map_err(truncated)?,
                }
            }
            let [first, rest @ ..] = &corners[..] else {
                return Err(bad(format!("face {face} has no corners")));
            };
            if rest.len() < 2 {
                let count = corners.len();
                return Err(bad(format!(
                    "face {face} has {count} corners where three are needed"
                )));
            }
            for pair in rest.windows(2) {
                let mut triangle = [[0.0; 3]; 3];
                for (corner, &index) in triangle.iter_mut().zip([*first, pair[0], pair[1]].iter()) {
                    let position = usize::try_from(index).unwrap_or(usize::MAX);
                    let vertices = self.vertices.len();
                    *corner = self.vertices.get(position).ok_or_else(|| {
                        StreamError::Failed(
                            MeshFault::IndexOutOfRange {
                                face,
                                index,
                                vertices,
                            }
                            .into(),
                        )
                    })?;
                }
                block.push(triangle);
                if block.len() == BLOCK {
                    let fraction = face as f64 / self.faces.count as f64;
                    if visit(&block, fraction).is_break() {
                        return Ok(());
                    }
                    block.clear();
                }
            }
        }
        for element in &self.after {
            skip(&mut reader, element)?;
        }
        if !self.source.fill_buf()?.is_empty() {
            return Err(bad("there are bytes after its last element"));
        }
        if !block.is_empty() && visit(&block, 1.0).is_break() {
            return Ok(());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    /// A square of two vertices' types and orders: a quad with a colour.
    fn square(big_endian: bool) -> Vec<u8> {
        let order = if big_endian { "big" } else { "little" };
        let header = format!(
            "ply\nformat binary_{order}_endian 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\n\
             property uchar red\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nproperty short s\n\
             element edge 1\nproperty int a\nend_header\n"
        );
        let mut bytes = header.into_bytes();
        let mut put = |number: &[u8]| {
            let mut number = number.to_vec();
            if big_endian {
                number.reverse();
            }
            bytes.extend(number);
        };
        for (x, y) in [(0.0_f32, 0.0_f32), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            put(&x.to_le_bytes());
            put(&y.to_le_bytes());
            put(&[7]);
            put(&2.0_f32.to_le_bytes());
        }
        put(&[4]);
        for index in 0..4_i32 {
            put(&index.to_le_bytes());
        }
        put(&3_i16.to_le_bytes());
        put(&9_i32.to_le_bytes());
        bytes
    }

    fn triangles(bytes: &[u8]) -> Result<Vec<Triangle>, StreamError> {
        let mut stream = PlyStream::new(Cursor::new(bytes), bytes.len() as u64)?;
        let mut all = Vec::new();
        stream.blocks(&mut |block, _| {
            all.extend_from_slice(block);
            ControlFlow::Continue(())
        })?;
        Ok(all)
    }

    #[test]
    fn a_square_in_both_byte_orders() {
        for big_endian in [false, true] {
            let expected = [
                [[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 2.0]],
                [[0.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]],
            ];
            assert_eq!(triangles(&square(big_endian)).expect("square"), expected);
        }
    }

    #[test]
    fn what_has_no_bytes_takes_no_time() {
        let mut bytes = square(false);
        let end = b"element edge 1\nproperty int a\n";
        let place = (bytes.windows(end.len())).position(|window| window == end);
        let place = place.expect("the last element");
        let empty = b"element nothing 18446744073709551615\n";
        bytes.splice(place..place, empty.iter().copied());
        assert_eq!(triangles(&bytes).expect("square").len(), 2);
    }

    #[test]
    fn headers_that_leave_open_what_counts() {
        let refused = |from: &str, to: &str| {
            let bytes = square(false);
            let text = String::from_utf8_lossy(&bytes).replacen(from, to, 1);
            assert_ne!(text.as_bytes(), bytes, "{from}");
            let Err(StreamError::Failed(error)) = triangles(text.as_bytes()) else {
                return String::new();
            };
            error.to_string()
        };
        for (from, to, told) in [
            (
                "property short s",
                "property list uchar int vertex_index",
                "two properties named vertex_indices",
            ),
            (
                "property uchar red",
                "property float x",
                "two properties named x",
            ),
            (
                "element edge 1",
                "element face 1",
                "two elements named face",
            ),
            (
                "list uchar int",
                "list float int",
                "property list float int vertex_indices",
            ),
        ] {
            let message = refused(from, to);
            assert!(message.contains(told), "{to}: {message}");
        }
    }

    #[test]
    fn a_list_of_fewer_than_no_items() {
        let text = "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
                    property float z\nelement edge 1\nproperty list char int a\nelement face 0\nend_header\n";
        let bytes = [text.as_bytes(), &[0xff]].concat();
        let Err(StreamError::Failed(error)) = triangles(&bytes) else {
            panic!("accepted");
        };
        assert!(
            error
                .to_string()
                .contains("a list of -1 items in edge number 0"),
            "{error}"
        );
    }

    #[test]
    fn whatever_is_cut_off_or_added_is_missed() {
        let whole = square(false);
        for length in 0..whole.len() {
            assert!(triangles(&whole[..length]).is_err(), "{length}");
        }
        let longer = [&whole[..], &[0]].concat();
        assert!(triangles(&longer).is_err());
    }
}
