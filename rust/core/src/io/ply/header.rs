//! The text at the head of a PLY: byte order, elements and the types of their properties.

use std::io::{BufRead, Read};

use crate::error::FileFault;
use crate::mass::polyhedron::stream::StreamError;

/// Longer than any header of use.
const LONGEST_HEADER: u64 = 1 << 16;

/// A number as stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
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

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Property {
    Number(String, Scalar),
    /// Name, type of the count, type of the items.
    List(String, Scalar, Scalar),
}

impl Property {
    /// What it is called; the two names that a list of corners goes by are one.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::List(name, ..) if name == "vertex_index" => "vertex_indices",
            Self::Number(name, _) | Self::List(name, ..) => name,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
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

pub(super) fn bad(why: impl Into<String>) -> StreamError {
    FileFault::BadPly { why: why.into() }.into()
}

/// Byte order and elements.
pub(super) fn header(source: &mut impl BufRead) -> Result<(bool, Vec<Element>), StreamError> {
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
            Scalar::named(count).filter(|count| count.is_integer())?,
            Scalar::named(item)?,
        )),
        [kind, name] => Some(Property::Number((*name).to_owned(), Scalar::named(kind)?)),
        _ => None,
    }
}
