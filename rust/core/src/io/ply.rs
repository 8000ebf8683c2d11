//! Binary PLY: a text header that names elements and their properties, then their bytes.
//!
//! The vertices are kept in memory as they are stored, since faces name them in any order; the faces are a stream. A face of
//! more than three corners becomes a fan of triangles.

use std::io::{self, BufRead, Error, ErrorKind, Read, Seek, SeekFrom};
use std::ops::ControlFlow;

use crate::error::{FileFault, MeshFault};
use crate::mass::polyhedron::stream::{BLOCK, StreamError, Triangle, TriangleStream};

// The text at the head of a PLY: byte order, elements and the types of their properties.

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
    fn from_name(name: &str) -> Option<Self> {
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

    fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
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

impl Property {
    /// What it is called; the two names that a list of corners goes by are one.
    fn name(&self) -> &str {
        match self {
            Self::List(name, ..) if name == "vertex_index" => "vertex_indices",
            Self::Number(name, _) | Self::List(name, ..) => name,
        }
    }
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

impl Element {
    /// Two properties of one name would leave open which of them counts.
    fn add(&mut self, property: Property) -> Result<(), StreamError> {
        let name = property.name();
        if self.properties.iter().any(|other| other.name() == name) {
            let element = &self.name;
            return Err(bad(format!(
                "its element {element} has two properties named {name}"
            )));
        }
        self.properties.push(property);
        Ok(())
    }
}

fn bad(why: impl Into<String>) -> StreamError {
    FileFault::BadPly { why: why.into() }.into()
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
            ["element", name, _] if elements.iter().any(|element| element.name == name) => {
                return Err(bad(format!("it has two elements named {name}")));
            }
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
                    (Some(element), Some(property)) => element.add(property)?,
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
            Scalar::from_name(count).filter(|count| count.is_integer())?,
            Scalar::from_name(item)?,
        )),
        [kind, name] => Some(Property::Number(
            (*name).to_owned(),
            Scalar::from_name(kind)?,
        )),
        _ => None,
    }
}

// The bytes of a PLY: numbers of any type in either order, and the vertices.

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

/// Numbers from bytes.
struct Reader<'a, R> {
    source: &'a mut R,
    big_endian: bool,
}

impl<'a, R: Read> Reader<'a, R> {
    fn new(source: &'a mut R, big_endian: bool) -> Self {
        Self { source, big_endian }
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.source.read_exact(&mut bytes)?;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// A number of any type; all integers of PLY are exact as doubles.
    fn number(&mut self, scalar: Scalar) -> io::Result<f64> {
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

    /// A number that numbers something; −1 for one that does not.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the cast saturates, and no list is so long"
    )]
    fn integer(&mut self, scalar: Scalar) -> io::Result<i64> {
        let number = self.number(scalar)?;
        Ok(if number.fract() == 0.0 {
            number as i64
        } else {
            -1
        })
    }

    /// How many items a list has; a number below zero is no count.
    fn count(&mut self, scalar: Scalar) -> io::Result<u64> {
        let number = self.integer(scalar)?;
        u64::try_from(number).map_err(|_| {
            let why = format!("a list of {number} items");
            Error::new(ErrorKind::InvalidData, why)
        })
    }

    fn skip(&mut self, bytes: u64) -> io::Result<()> {
        let mut rest = self.source.take(bytes);
        if io::copy(&mut rest, &mut io::sink())? < bytes {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        Ok(())
    }
}

/// The end of the file as the fault that it is.
fn truncation_error(element: &Element, held: usize, error: Error) -> StreamError {
    match error.kind() {
        ErrorKind::UnexpectedEof => FileFault::TruncatedPly {
            element: element.name.clone(),
            promised: element.count,
            held,
        }
        .into(),
        ErrorKind::InvalidData => bad(format!("{error} in {} number {held}", element.name)),
        _ => error.into(),
    }
}

fn skip<R: Read>(reader: &mut Reader<'_, R>, element: &Element) -> Result<(), StreamError> {
    // What has no bytes takes none, however many of it the header promises.
    let rows = if element.properties.is_empty() {
        0
    } else {
        element.count
    };
    for row in 0..rows {
        for property in &element.properties {
            skip_property(reader, property)
                .map_err(|error| truncation_error(element, row, error))?;
        }
    }
    Ok(())
}

fn skip_property<R: Read>(reader: &mut Reader<'_, R>, property: &Property) -> io::Result<()> {
    match property {
        Property::Number(_, scalar) => reader.skip(scalar.size() as u64),
        Property::List(_, count, item) => {
            let count = reader.count(*count)?;
            reader.skip(count * item.size() as u64)
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
        return Err(truncation_error(
            element,
            room,
            ErrorKind::UnexpectedEof.into(),
        ));
    }
    let is_single = [x, y, z].iter().all(|&place| types[place] == Scalar::F32);
    let (mut single, mut double) = (Vec::new(), Vec::new());
    let reserved = if is_single {
        single.try_reserve_exact(element.count)
    } else {
        double.try_reserve_exact(element.count)
    };
    reserved.map_err(|_| Error::from(ErrorKind::OutOfMemory))?;
    let mut row = vec![0.0; types.len()];
    for vertex in 0..element.count {
        for (number, scalar) in row.iter_mut().zip(&types) {
            *number = reader
                .number(*scalar)
                .map_err(|error| truncation_error(element, vertex, error))?;
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

// The triangles of a file, read again whenever they are asked for.

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
            let truncated = |error| truncation_error(&self.faces, face, error);
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
    use super::*;
    use std::io::Cursor;

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
