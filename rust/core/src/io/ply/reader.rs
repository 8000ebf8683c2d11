//! The bytes of a PLY: numbers of any type in either order, and the vertices.

use std::io::{self, Error, ErrorKind, Read};

use super::header::{Element, Property, Scalar, bad};
use crate::error::FileFault;
use crate::mass::polyhedron::stream::StreamError;

/// Coordinates in the precision they are stored in.
#[derive(Debug)]
pub(super) enum Vertices {
    Single(Vec<[f32; 3]>),
    Double(Vec<[f64; 3]>),
}

impl Vertices {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Single(list) => list.len(),
            Self::Double(list) => list.len(),
        }
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Option<[f64; 3]> {
        match self {
            Self::Single(list) => list.get(index).map(|point| point.map(f64::from)),
            Self::Double(list) => list.get(index).copied(),
        }
    }
}

/// Numbers from bytes.
pub(super) struct Reader<'a, R> {
    source: &'a mut R,
    big_endian: bool,
}

impl<'a, R: Read> Reader<'a, R> {
    pub(super) fn new(source: &'a mut R, big_endian: bool) -> Self {
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
    pub(super) fn integer(&mut self, scalar: Scalar) -> io::Result<i64> {
        let number = self.number(scalar)?;
        Ok(if number.fract() == 0.0 {
            number as i64
        } else {
            -1
        })
    }

    /// How many items a list has; a number below zero is no count.
    pub(super) fn count(&mut self, scalar: Scalar) -> io::Result<u64> {
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
pub(super) fn truncated(element: &Element, held: usize, error: Error) -> StreamError {
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

pub(super) fn skip<R: Read>(
    reader: &mut Reader<'_, R>,
    element: &Element,
) -> Result<(), StreamError> {
    // What has no bytes takes none, however many of it the header promises.
    let rows = if element.properties.is_empty() {
        0
    } else {
        element.count
    };
    for row in 0..rows {
        for property in &element.properties {
            skip_property(reader, property).map_err(|error| truncated(element, row, error))?;
        }
    }
    Ok(())
}

pub(super) fn skip_property<R: Read>(
    reader: &mut Reader<'_, R>,
    property: &Property,
) -> io::Result<()> {
    match property {
        Property::Number(_, scalar) => reader.skip(scalar.size() as u64),
        Property::List(_, count, item) => {
            let count = reader.count(*count)?;
            reader.skip(count * item.size() as u64)
        }
    }
}

/// The coordinates; nothing is allocated before the file is seen to be long enough.
pub(super) fn read_vertices<R: Read>(
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
        return Err(truncated(element, room, ErrorKind::UnexpectedEof.into()));
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
                .map_err(|error| truncated(element, vertex, error))?;
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
