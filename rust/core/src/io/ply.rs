//! Binary PLY: a text header that names elements and their properties, then their bytes.
//!
//! The vertices are kept in memory as they are stored, since faces name them in any order; the faces are a stream. A face of
//! more than three corners becomes a fan of triangles.

use std::io::{BufRead, Read, Seek, SeekFrom};
use std::ops::ControlFlow;

use super::{BLOCK, FileFault, StreamError, Triangle, TriangleStream};
use crate::mass::polyhedron::MeshFault;

/// Longer than any header of use.
const LONGEST_HEADER: u64 = 1 << 16;

/// A number as stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Property {
    Number(String, Scalar),
    /// Name, type of the count, type of the items.
    List(String, Scalar, Scalar),
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// Coordinates in the precision they are stored in.
#[derive(Debug)]
enum Vertices {
    Single(Vec<[f32; 3]>),
    Double(Vec<[f64; 3]>),
}

impl Vertices {
    fn len(&self) -> usize {
        match self {
            Self::Single(list) => list.len(),
            Self::Double(list) => list.len(),
        }
    }

    #[inline(always)]
    fn get(&self, index: usize) -> Option<[f64; 3]> {
        match self {
            Self::Single(list) => list.get(index).map(|point| point.map(f64::from)),
            Self::Double(list) => list.get(index).copied(),
        }
    }
}

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

fn bad(why: impl Into<String>) -> StreamError {
    FileFault::BadPly { why: why.into() }.into()
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

/// Byte order and elements.
fn header(source: &mut impl BufRead) -> Result<(bool, Vec<Element>), StreamError> {
    let mut elements: Vec<Element> = Vec::new();
    let mut big_endian = None;
    let mut source = source.take(LONGEST_HEADER);
    for number in 0.. {
        let mut line = Vec::new();
        if source.read_until(b'\n', &mut line)? == 0 {
            return Err(bad("its header has no line end_header"));
        }
        let line = String::from_utf8_lossy(&line);
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["ply"] if number == 0 => {}
            _ if number == 0 => return Err(bad("it does not begin with the line ply")),
            ["format", "binary_little_endian", ..] => big_endian = Some(false),
            ["format", "binary_big_endian", ..] => big_endian = Some(true),
            ["element", name, count] => elements.push(Element {
                name: name.to_owned(),
                count: count
                    .parse()
                    .map_err(|_| bad(format!("header line {:?}", line.trim_end())))?,
                properties: Vec::new(),
            }),
            ["property", ref rest @ ..] => {
                let property = property(rest);
                match (elements.last_mut(), property) {
                    (Some(element), Some(property)) => element.properties.push(property),
                    _ => return Err(bad(format!("header line {:?}", line.trim_end()))),
                }
            }
            ["end_header"] => break,
            ["comment" | "obj_info", ..] | [] => {}
            _ => return Err(bad(format!("header line {:?}", line.trim_end()))),
        }
    }
    match big_endian {
        Some(big_endian) => Ok((big_endian, elements)),
        None => Err(bad(
            "its format is neither binary_little_endian nor binary_big_endian",
        )),
    }
}

fn property(words: &[&str]) -> Option<Property> {
    match words {
        ["list", count, item, name] => Some(Property::List(
            (*name).to_owned(),
            Scalar::named(count)?,
            Scalar::named(item)?,
        )),
        [kind, name] => Some(Property::Number((*name).to_owned(), Scalar::named(kind)?)),
        _ => None,
    }
}

/// Numbers from bytes.
struct Reader<'a, R> {
    source: &'a mut R,
    big_endian: bool,
}

impl<'a, R: Read> Reader<'a, R> {
    fn new(source: &'a mut R, big_endian: bool) -> Self {
        Self { source, big_endian }
    }

    fn bytes<const N: usize>(&mut self) -> std::io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.source.read_exact(&mut bytes)?;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// A number of any type; all integers of PLY are exact as doubles.
    fn number(&mut self, scalar: Scalar) -> std::io::Result<f64> {
        Ok(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.bytes()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.bytes()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.bytes()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.bytes()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.bytes()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.bytes()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.bytes()?)),
            Scalar::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    /// A number that counts or numbers something; −1 for one that is none.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "it is an integer below 2^32"
    )]
    fn integer(&mut self, scalar: Scalar) -> std::io::Result<i64> {
        let number = self.number(scalar)?;
        Ok(if number.fract() == 0.0 {
            number as i64
        } else {
            -1
        })
    }

    fn skip(&mut self, bytes: usize) -> std::io::Result<()> {
        let mut rest = self.source.take(bytes as u64);
        if std::io::copy(&mut rest, &mut std::io::sink())? < bytes as u64 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        Ok(())
    }
}

/// The end of the file as the fault that it is.
fn truncated(element: &Element, held: usize) -> impl Fn(std::io::Error) -> StreamError {
    let fault = FileFault::TruncatedPly {
        element: element.name.clone(),
        promised: element.count,
        held,
    };
    move |error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => fault.clone().into(),
        _ => error.into(),
    }
}

fn skip<R: Read>(reader: &mut Reader<'_, R>, element: &Element) -> Result<(), StreamError> {
    for row in 0..element.count {
        for property in &element.properties {
            skip_property(reader, property).map_err(truncated(element, row))?;
        }
    }
    Ok(())
}

fn skip_property<R: Read>(reader: &mut Reader<'_, R>, property: &Property) -> std::io::Result<()> {
    match property {
        Property::Number(_, scalar) => reader.skip(scalar.size()),
        Property::List(_, count, item) => {
            let count = usize::try_from(reader.integer(*count)?).unwrap_or(0);
            reader.skip(count * item.size())
        }
    }
}

/// The coordinates; nothing is allocated before the file is seen to be long enough.
fn read_vertices<R: Read>(
    reader: &mut Reader<'_, R>,
    element: &Element,
    held: u64,
) -> Result<Vertices, StreamError> {
    let mut types = Vec::new();
    let mut places = [None; 3];
    for (place, property) in element.properties.iter().enumerate() {
        let Property::Number(name, scalar) = property else {
            return Err(bad("its vertices have lists"));
        };
        if let Some(axis) = ["x", "y", "z"].iter().position(|axis| axis == name) {
            places[axis] = Some(place);
        }
        types.push(*scalar);
    }
    let [Some(x), Some(y), Some(z)] = places else {
        return Err(bad("its vertices have no x, y and z"));
    };
    let size: usize = types.iter().map(|scalar| scalar.size()).sum();
    let room = usize::try_from(held).unwrap_or(usize::MAX) / size.max(1);
    if room < element.count {
        let fault = truncated(element, room);
        return Err(fault(std::io::ErrorKind::UnexpectedEof.into()));
    }
    let is_single = [x, y, z].iter().all(|&place| types[place] == Scalar::F32);
    let (mut single, mut double) = (Vec::new(), Vec::new());
    if is_single {
        single.reserve_exact(element.count);
    } else {
        double.reserve_exact(element.count);
    }
    let mut row = vec![0.0; types.len()];
    for vertex in 0..element.count {
        for (number, scalar) in row.iter_mut().zip(&types) {
            *number = reader.number(*scalar).map_err(truncated(element, vertex))?;
        }
        let point = [row[x], row[y], row[z]];
        if is_single {
            #[expect(clippy::cast_possible_truncation, reason = "it was stored so")]
            single.push(point.map(|x| x as f32));
        } else {
            double.push(point);
        }
    }
    Ok(if is_single {
        Vertices::Single(single)
    } else {
        Vertices::Double(double)
    })
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
            let truncated = |error| truncated(&self.faces, face)(error);
            for property in &self.faces.properties {
                match property {
                    Property::List(name, count, item)
                        if name == "vertex_indices" || name == "vertex_index" =>
                    {
                        let count = reader.integer(*count).map_err(truncated)?;
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
    fn whatever_is_cut_off_or_added_is_missed() {
        let whole = square(false);
        for length in 0..whole.len() {
            assert!(triangles(&whole[..length]).is_err(), "{length}");
        }
        let longer = [&whole[..], &[0]].concat();
        assert!(triangles(&longer).is_err());
    }
}
