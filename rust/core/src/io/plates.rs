//! Vertices and faces as text: the geometry of an OBJ file, and the plate models in which asteroids are archived.
//!
//! Two layouts are read. Lettered: `v x y z` and `f i j k …`, any other keyword of OBJ passed over; faces of more than three
//! corners become a fan of triangles, `i/t/n` is vertex i, negative numbers count back from the last vertex so far, a
//! backslash at the end of a line joins it with the next.
//! Counted: a first line with the numbers of vertices and faces, then that many lines of three numbers each.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::str::SplitWhitespace;

use super::mesh::TriangleMesh;
use crate::error::FileFault;
use crate::numerics::threads::{Halt, Watch};

/// Reads `text`, in which faces count vertices from `index_base` (0 or 1).
///
/// Now and then `watch` gets the fraction read.
///
/// # Errors
/// [`FileFault`] with the line that cannot be understood. Whether a face names a vertex that exists is left to the check
/// of the mesh. [`Halt::Stopped`] where `watch` said so.
pub fn read(
    text: &str,
    index_base: usize,
    watch: &mut Watch<'_>,
) -> Result<TriangleMesh, Halt<FileFault>> {
    let first = text.lines().find(|line| !is_blank(line));
    let mesh = if first.is_some_and(|line| {
        line.split_whitespace()
            .all(|word| word.parse::<f64>().is_ok())
    }) {
        read_plate_model(text, index_base, watch)?
    } else {
        read_obj(text, index_base, watch)?
    };
    if mesh.faces.is_empty() {
        return Err(Halt::Failed(FileFault::NoFaces {
            vertices: mesh.vertices.len(),
        }));
    }
    Ok(mesh)
}

fn is_blank(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with('#')
}

/// Lines read between two looks at the watch.
const MANY: usize = 4096;

/// Asks the watch at some lines.
fn ask(
    text: &str,
    number: usize,
    line: &str,
    watch: &mut Watch<'_>,
) -> Result<(), Halt<FileFault>> {
    if !number.is_multiple_of(MANY) {
        return Ok(());
    }
    let read = line.as_ptr() as usize - text.as_ptr() as usize;
    match watch(read as f64 / text.len() as f64) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Halt::Stopped),
    }
}

fn read_obj(
    text: &str,
    index_base: usize,
    watch: &mut Watch<'_>,
) -> Result<TriangleMesh, Halt<FileFault>> {
    let mut mesh = TriangleMesh {
        vertices: Vec::new(),
        faces: Vec::new(),
    };
    let mut lines = (1..).zip(text.lines());
    while let Some((number, first)) = lines.next() {
        if is_blank(first) {
            continue;
        }
        ask(text, number, first, watch)?;
        let line = join_continuation(first, lines.by_ref().map(|(_, line)| line));
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => mesh
                .vertices
                .push(vertex(number, words).map_err(Halt::Failed)?),
            Some("f") => fan(number, words, index_base, &mut mesh).map_err(Halt::Failed)?,
            Some(word) if is_keyword(word) => {}
            _ => {
                let why = format!(
                    "neither a vertex, a face nor another OBJ keyword: {:?}",
                    shorten(&line)
                );
                return Err(Halt::Failed(FileFault::BadLine { line: number, why }));
            }
        }
    }
    Ok(mesh)
}

/// The line with those that follow it after a backslash at the end, which it takes from `rest`.
fn join_continuation<'a>(first: &'a str, mut rest: impl Iterator<Item = &'a str>) -> Cow<'a, str> {
    let more = |line: &'a str| line.trim_end().strip_suffix('\\');
    let Some(head) = more(first) else {
        return Cow::Borrowed(first);
    };
    let mut whole = head.to_owned();
    for line in rest.by_ref() {
        whole.push(' ');
        let Some(part) = more(line) else {
            whole.push_str(line);
            break;
        };
        whole.push_str(part);
    }
    Cow::Owned(whole)
}

/// Whether OBJ has a keyword like this: letters, perhaps with an underscore.
fn is_keyword(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn read_plate_model(
    text: &str,
    index_base: usize,
    watch: &mut Watch<'_>,
) -> Result<TriangleMesh, Halt<FileFault>> {
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !is_blank(line));
    let (number, header) = lines.next().unwrap_or((1, ""));
    let counts: Vec<usize> = header
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    let [vertices, faces] = counts[..] else {
        let why = format!(
            "expected the numbers of vertices and of faces, got {:?}",
            shorten(header)
        );
        return Err(Halt::Failed(FileFault::BadLine { line: number, why }));
    };
    let mut mesh = TriangleMesh {
        vertices: Vec::new(),
        faces: Vec::new(),
    };
    for (number, line) in lines {
        ask(text, number, line, watch)?;
        let words = line.split_whitespace();
        if mesh.vertices.len() < vertices {
            mesh.vertices
                .push(vertex(number, words).map_err(Halt::Failed)?);
        } else {
            fan(number, words, index_base, &mut mesh).map_err(Halt::Failed)?;
        }
    }
    if (mesh.vertices.len(), mesh.faces.len()) != (vertices, faces) {
        let (v, f) = (mesh.vertices.len(), mesh.faces.len());
        let why =
            format!("promises {vertices} vertices and {faces} triangles, but {v} and {f} follow");
        return Err(Halt::Failed(FileFault::BadLine { line: number, why }));
    }
    Ok(mesh)
}

/// Three coordinates; what OBJ allows after them (weight, colour) is passed over.
fn vertex(line: usize, mut words: SplitWhitespace<'_>) -> Result<[f64; 3], FileFault> {
    let mut point = [0.0; 3];
    for x in &mut point {
        let word = words.next().unwrap_or_default();
        *x = word.parse().map_err(|_| FileFault::BadLine {
            line,
            why: format!("expected three coordinates, got {:?}", shorten(word)),
        })?;
    }
    Ok(point)
}

/// The triangles (first, k, k + 1) of a face.
fn fan(
    line: usize,
    words: SplitWhitespace<'_>,
    index_base: usize,
    mesh: &mut TriangleMesh,
) -> Result<(), FileFault> {
    let corners = words
        .take_while(|word| !word.starts_with('#'))
        .map(|word| corner(line, word, index_base, mesh.vertices.len()))
        .collect::<Result<Vec<usize>, FileFault>>()?;
    let [first, ref rest @ ..] = corners[..] else {
        return Err(FileFault::BadLine {
            line,
            why: "a face without corners".to_owned(),
        });
    };
    if rest.len() < 2 {
        let why = format!("a face needs three corners, this one has {}", corners.len());
        return Err(FileFault::BadLine { line, why });
    }
    mesh.faces
        .extend(rest.windows(2).map(|pair| [first, pair[0], pair[1]]));
    Ok(())
}

/// The number of the vertex, from zero.
fn corner(line: usize, word: &str, index_base: usize, vertices: usize) -> Result<usize, FileFault> {
    let bad = |why: String| FileFault::BadLine { line, why };
    let number: i64 = word
        .split('/')
        .next()
        .unwrap_or_default()
        .parse()
        .map_err(|_| {
            bad(format!(
                "expected the number of a vertex, got {:?}",
                shorten(word)
            ))
        })?;
    match usize::try_from(number) {
        Ok(0) if index_base > 0 => Err(FileFault::IndexZero { line }),
        Ok(number) => Ok(number - index_base),
        Err(_) => usize::try_from(number.unsigned_abs())
            .ok()
            .and_then(|back| vertices.checked_sub(back))
            .ok_or_else(|| {
                bad(format!(
                    "vertex {number} counts back beyond the first of {vertices}"
                ))
            }),
    }
}

/// Enough of a line to recognise it by.
fn shorten(line: &str) -> String {
    line.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, index_base: usize) -> Result<TriangleMesh, FileFault> {
        let read = super::read(text, index_base, &mut |_| ControlFlow::Continue(()));
        read.map_err(|halt| match halt {
            Halt::Failed(fault) => fault,
            Halt::Stopped => panic!("nobody stops it"),
        })
    }

    #[test]
    fn obj_geometry() {
        let text = "# a square\no part\nv 0 0 0\nv 1 0 0\nv 1 1 0 0.5\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2//1 3/3 -1\n";
        let mesh = read(text, 1).expect("valid");
        assert_eq!(mesh.vertices[2], [1.0, 1.0, 0.0]);
        assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_backslash_joins_lines() {
        let text =
            "# C:\\\nv 0 \\\n 0 0\nv 1 0 0\nv 1 1 \\\n \\ \n 0\r\nvn 0 0 \\\n-1\nf 1 2 \\\r\n3\n";
        let mesh = read(text, 1).expect("valid");
        assert_eq!(mesh.vertices[2], [1.0, 1.0, 0.0]);
        assert_eq!(mesh.faces, [[0, 1, 2]]);
        assert!(matches!(
            read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 x\n", 1),
            Err(FileFault::BadLine { line: 4, .. })
        ));
    }

    #[test]
    fn counted_plates() {
        let text = "3 1\n0 0 0\n1 0 0\n0 1 0\n1 2 3\n";
        assert_eq!(read(text, 1).expect("valid").faces, [[0, 1, 2]]);
        assert!(matches!(
            read("3 2\n0 0 0\n1 0 0\n0 1 0\n1 2 3\n", 1),
            Err(FileFault::BadLine { line: 1, .. })
        ));
    }

    #[test]
    fn faults_name_the_line() {
        let zero = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n";
        assert_eq!(read(zero, 1), Err(FileFault::IndexZero { line: 4 }));
        assert_eq!(read(zero, 0).expect("from zero").faces, [[0, 1, 2]]);
        for text in [
            "v 0 0\n",
            "f 1 2\n",
            "v 0 0 0\nf 1 2 x\n",
            "v 0 0 0\nf 1 -2 1\n",
            "\u{1}\u{2}\n",
        ] {
            assert!(
                matches!(read(text, 1), Err(FileFault::BadLine { .. })),
                "{text:?}"
            );
        }
        assert_eq!(
            read("v 0 0 0\n", 1),
            Err(FileFault::NoFaces { vertices: 1 })
        );
    }
}
