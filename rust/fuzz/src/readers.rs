//! Every reader of bytes or text.

use std::io::Cursor;
use std::ops::ControlFlow;

use arbitrary::Result;
use polhode::RigidBody;
use polhode::io::ply::PlyStream;
use polhode::io::stl::{self, StlStream};
use polhode::io::{TriangleMesh, plates};
use polhode::mass::polyhedron::stream::{StreamError, Triangle, TriangleStream};
use polhode::mass::polyhedron::streaming::stream_solid;
use polhode::mass::polyhedron::{Options, polyhedron_watched};
use polhode::mass::provenance::{Checks, MomentsFrom};
use polhode::mass::{Amount, MassAccumulator, Provenance};
use polhode::motion::euler_angles::Sequence;

use crate::draw::{Draw, patience};
use crate::laws::is_body;
use crate::meshes::{Mesh, mesh};

/// Takes the bytes as one of the formats.
///
/// # Panics
/// When a law is broken.
pub fn run(data: &[u8]) {
    let _ = Draw::new(data).and_then(one);
}

fn one(mut draw: Draw<'_>) -> Result<()> {
    match draw.up_to(10)? {
        0 => stl_bytes(draw.rest()),
        1 => {
            let mesh = mesh(&mut draw)?;
            stl_bytes(&harmed(&mut draw, stl_of(&mesh))?);
        }
        2 => ply_bytes(draw.rest()),
        3..=5 => ply_bytes(&ply(draw)?),
        6 => text(&String::from_utf8_lossy(draw.rest())),
        7 => text(&lines(draw)?),
        8 => accumulator(draw)?,
        9 => array(draw)?,
        _ => {
            let text = String::from_utf8_lossy(draw.rest());
            if let Ok(sequence) = text.parse::<Sequence>() {
                assert_eq!(sequence.to_string().parse(), Ok(sequence));
            }
        }
    }
    Ok(())
}

/// Cut off, a byte changed, or as they are.
fn harmed(draw: &mut Draw<'_>, mut bytes: Vec<u8>) -> Result<Vec<u8>> {
    match draw.up_to(3)? {
        0 => bytes.truncate(draw.up_to(bytes.len())?),
        1 if !bytes.is_empty() => {
            let place = draw.up_to(bytes.len() - 1)?;
            bytes[place] ^= 1 << draw.up_to(7)?;
        }
        2 => bytes.extend(draw.bytes(3)?),
        _ => {}
    }
    Ok(bytes)
}

fn is_mesh(mesh: &TriangleMesh) {
    assert!(!mesh.faces.is_empty() || mesh.vertices.is_empty());
}

fn triangles(stream: &mut dyn TriangleStream) -> core::result::Result<Vec<Triangle>, StreamError> {
    let mut all = Vec::new();
    let mut last = 0.0;
    stream.blocks(&mut |block, fraction| {
        assert!((last..=1.0).contains(&fraction), "fraction {fraction:?}");
        last = fraction;
        all.extend_from_slice(block);
        ControlFlow::Continue(())
    })?;
    Ok(all)
}

fn stl_bytes(bytes: &[u8]) {
    let held = bytes.len() as u64;
    let read = stl::read(bytes, held);
    let stream = StlStream::new(Cursor::new(bytes), held);
    assert_eq!(
        read.is_ok(),
        stream.is_ok(),
        "memory and stream differ on whether this is an STL"
    );
    let (Ok(mesh), Ok(mut stream)) = (read, stream) else {
        return;
    };
    is_mesh(&mesh);
    let Ok(all) = triangles(&mut stream) else {
        return;
    };
    let of_mesh = (mesh.faces.iter()).map(|face| face.map(|corner| mesh.vertices[corner]));
    assert_eq!(all.len(), mesh.faces.len());
    for (a, b) in all.iter().zip(of_mesh) {
        let bits = |t: &Triangle| t.map(|p| p.map(|x| (x + 0.0).to_bits()));
        assert_eq!(bits(a), bits(&b));
    }
    both_ways(&mut stream, &mesh);
}

/// A stream gives the solid that the same triangles in memory give.
fn both_ways(stream: &mut dyn TriangleStream, mesh: &TriangleMesh) {
    let amount = Amount::Density(1.0);
    let options = Options {
        orient: false,
        check: true,
    };
    let of_stream = stream_solid(stream, 1.0, amount, options, &mut patience(1000));
    let (vertices, faces) = (&mesh.vertices, &mesh.faces);
    let in_memory = polyhedron_watched(vertices, faces, amount, options, &mut patience(1000))
        .map(|solid| solid.body);
    assert_eq!(
        of_stream.is_ok(),
        in_memory.is_ok(),
        "a stream gives {of_stream:?} where memory gives {in_memory:?}"
    );
    if let (Ok(solid), Ok(body)) = (of_stream, in_memory) {
        is_body(&solid.body, 0.0);
        is_body(&body, 0.0);
        let allowed = solid.body.error_bound().mass + body.error_bound().mass;
        let off = (solid.body.mass() - body.mass()).abs();
        assert!(off <= allowed, "masses differ by {off:e} > {allowed:e}");
        assert_eq!(solid.triangles, faces.len());
    }
}

fn stl_of(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(u32::try_from(mesh.faces.len()).unwrap_or(0).to_le_bytes());
    for face in &mesh.faces {
        bytes.extend([0; 12]);
        for &corner in face {
            let place = usize::try_from(corner).unwrap_or(0);
            let point = mesh.vertices.get(place).copied().unwrap_or([0.5; 3]);
            #[expect(clippy::cast_possible_truncation, reason = "so the format stores it")]
            bytes.extend(point.iter().flat_map(|&x| (x as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply_bytes(bytes: &[u8]) {
    let Ok(mut stream) = PlyStream::new(Cursor::new(bytes), bytes.len() as u64) else {
        return;
    };
    assert!(stream.vertex_count() <= bytes.len());
    let Ok(all) = triangles(&mut stream) else {
        return;
    };
    let faces = (0..all.len()).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    let mesh = TriangleMesh {
        vertices: all.as_flattened().to_vec(),
        faces: faces.collect(),
    };
    both_ways(&mut stream, &mesh);
}

const TYPES: [&str; 9] = [
    "char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int64",
];
const COUNTS: [&str; 6] = [
    "4294967295",
    "18446744073709551615",
    "1000000000000000000",
    "-1",
    "1e3",
    "",
];

/// A header of a PLY and bytes to it: sometimes a closed tetrahedron, with other elements and properties around it.
fn ply(mut draw: Draw<'_>) -> Result<Vec<u8>> {
    let big = draw.coin()?;
    let order = if big { "big" } else { "little" };
    let mut header = format!("ply\nformat binary_{order}_endian 1.0\n");
    let mut body = Vec::new();
    let names = ["vertex", "face", "edge", "face"];
    let elements = draw.list(4, |draw| draw.one_of(&names))?;
    let elements = if elements.len() < 2 {
        vec!["vertex", "face"]
    } else {
        elements
    };
    for element in elements {
        let rows = match element {
            _ if draw.up_to(15)? == 0 => usize::MAX,
            "vertex" | "face" => 4,
            _ => draw.up_to(3)?,
        };
        let count = if rows == usize::MAX {
            draw.one_of(&COUNTS)?.to_owned()
        } else {
            rows.to_string()
        };
        header.extend(["element ", element, " ", &count, "\n"]);
        let mut properties = Vec::new();
        match element {
            "vertex" => {
                let kind = draw.one_of(&TYPES[4..8])?;
                properties.extend(["x", "y", "z"].map(|name| (None, kind, name)));
            }
            "face" => {
                let (count, item) = (draw.one_of(&TYPES)?, draw.one_of(&TYPES)?);
                properties.push((Some(count), item, "vertex_indices"));
            }
            _ => {}
        }
        for _ in 0..draw.up_to(2)? {
            let count = if draw.coin()? {
                Some(draw.one_of(&TYPES)?)
            } else {
                None
            };
            let name = draw.one_of(&["red", "x", "vertex_index", "q"])?;
            let place = draw.up_to(properties.len())?;
            properties.insert(place, (count, draw.one_of(&TYPES)?, name));
        }
        for (count, kind, name) in &properties {
            match count {
                Some(count) => {
                    header.extend(["property list ", count, " ", kind, " ", name, "\n"]);
                }
                None => header.extend(["property ", kind, " ", name, "\n"]),
            }
        }
        for row in 0..rows.min(4) {
            for (axis, (count, kind, name)) in properties.iter().enumerate() {
                let is_indices = name.starts_with("vertex_ind");
                let items = if is_indices { 3 } else { draw.up_to(2)? };
                if let Some(count) = count {
                    put(&mut body, count, items as f64, big);
                }
                for item in 0..if count.is_some() { items } else { 1 } {
                    let number = match *name {
                        "x" | "y" | "z" => f64::from(u8::from(row == axis + 1)),
                        "vertex_indices" => [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
                            [row.min(3)][item.min(2)]
                        .into(),
                        _ => draw.number()?,
                    };
                    put(&mut body, kind, number, big);
                }
            }
        }
    }
    header += "end_header\n";
    let whole = [header.as_bytes(), &body].concat();
    harmed(&mut draw, whole)
}

/// A number as a PLY stores it.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "so the format stores it"
)]
fn put(bytes: &mut Vec<u8>, kind: &str, number: f64, big: bool) {
    let mut stored = match kind {
        "char" => (number as i8).to_le_bytes().to_vec(),
        "uchar" => (number as i64 as u8).to_le_bytes().to_vec(),
        "short" => (number as i16).to_le_bytes().to_vec(),
        "ushort" => (number as i64 as u16).to_le_bytes().to_vec(),
        "int" => (number as i32).to_le_bytes().to_vec(),
        "uint" => (number as i64 as u32).to_le_bytes().to_vec(),
        "float" => (number as f32).to_le_bytes().to_vec(),
        _ => number.to_le_bytes().to_vec(),
    };
    if big {
        stored.reverse();
    }
    bytes.extend(stored);
}

fn text(text: &str) {
    for base in [0, 1] {
        if let Ok(mesh) = plates::read(text, base, &mut patience(1000)) {
            assert!(!mesh.faces.is_empty());
            let lines = text.lines().count();
            assert!(mesh.vertices.len() <= lines);
        }
    }
}

const WORDS: [&str; 24] = [
    "v",
    "f",
    "vn",
    "#",
    "o",
    "1",
    "2",
    "3",
    "4",
    "-1",
    "0",
    "0.5",
    "1e999",
    "nan",
    "-inf",
    "1/2/3",
    "2//1",
    "-4",
    "99999999999999999999",
    "9223372036854775807",
    "-9223372036854775808",
    "+1",
    "1e3",
    "é",
];

fn lines(mut draw: Draw<'_>) -> Result<String> {
    let mut text = String::new();
    match draw.up_to(3)? {
        0 => text += "4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 3 2\n",
        1 => text += "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\n",
        _ => {}
    }
    for _ in 0..draw.up_to(12)? {
        let words = draw.list(6, |draw| draw.one_of(&WORDS))?;
        text += &words.join(" ");
        text += draw.one_of(&["\n", "\r\n", "\n\n", "\t\n"])?;
    }
    Ok(text)
}

/// The bytes of an accumulator, harmed or not.
fn accumulator(mut draw: Draw<'_>) -> Result<()> {
    let mut sums = MassAccumulator::new();
    for _ in 0..draw.up_to(3)? {
        let masses = draw.list(5, Draw::positive)?;
        let positions = masses
            .iter()
            .map(|_| draw.numbers())
            .collect::<Result<Vec<_>>>()?;
        let start = if draw.coin()? {
            Some(draw.one_of(&[0, 5, 4096, 4090, u64::MAX, u64::MAX - 3])?)
        } else {
            None
        };
        let _ = sums.add(&masses, &positions, start, &mut patience(1000));
    }
    let whole = sums.to_bytes();
    // Numbers that are not numbers are not equal, but their bytes are.
    let again = MassAccumulator::from_bytes(&whole).map(|again| again.to_bytes());
    assert_eq!(again.as_ref(), Ok(&whole), "as bytes");
    if let Ok(body) = sums.finish() {
        is_body(&body, 0.0);
    }
    let bytes = harmed(&mut draw, whole)?;
    if let Ok(again) = MassAccumulator::from_bytes(&bytes) {
        assert_eq!(again.to_bytes(), bytes, "as bytes");
        if let Ok(body) = again.finish() {
            // A negative sum of squares counts as rounding up to a part in 10¹² of the largest: so much damage passes.
            is_body(&body, 2e-12);
        }
        let mut both = again.clone();
        let _ = both.merge(&sums);
        let _ = both.add(&[1.0], &[[0.0; 3]], None, &mut patience(1000));
        let _ = both.finish();
    }
    Ok(())
}

/// A body as an array, one of its numbers another.
fn array(mut draw: Draw<'_>) -> Result<()> {
    let mut numbers = polhode::mass::solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(1.0))
        .map_or([0.0; 34], |body| body.to_array());
    for _ in 0..=draw.up_to(2)? {
        let place = draw.up_to(32)?;
        numbers[place] = draw.number()?;
    }
    if let Ok(body) = RigidBody::from_array(&numbers) {
        // Of moments that were given nobody knows what was admitted, of what was not checked nothing at all.
        let provenance = body.provenance();
        let is_given = matches!(provenance.moments, MomentsFrom::Given | MomentsFrom::Tensor);
        if !provenance.checks.contains(Checks::UNCHECKED) {
            is_body(&body, if is_given { 1.0 } else { 1e-10 });
        }
    }
    let provenance = Provenance::from_array(&draw.numbers::<9>()?);
    let numbers = provenance.to_array();
    let again = Provenance::from_array(&numbers).to_array();
    assert_eq!(again.map(f64::to_bits), numbers.map(f64::to_bits));
    Ok(())
}
