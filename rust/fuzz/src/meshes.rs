//! Triangle meshes drawn from bytes: closed ones, and those with something wrong.

use arbitrary::Result;

use crate::draw::Draw;

/// Vertices and faces.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Coordinates.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of each triangle.
    pub faces: Vec<[i64; 3]>,
}

const TETRAHEDRON: ([[i8; 3]; 4], &[[i64; 3]]) = (
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
);
const OCTAHEDRON: ([[i8; 3]; 6], &[[i64; 3]]) = (
    [
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
    ],
    &[
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ],
);

/// A closed template with its vertices moved, perhaps a second one beside it or in it, and now and then a face turned, left
/// out, doubled or wild.
///
/// # Errors
/// When the bytes are used up.
pub fn mesh(draw: &mut Draw<'_>) -> Result<Mesh> {
    let mut mesh = Mesh {
        vertices: Vec::new(),
        faces: Vec::new(),
    };
    for _ in 0..=draw.up_to(2)? {
        add(draw, &mut mesh)?;
    }
    for _ in 0..draw.up_to(3)? {
        harm(draw, &mut mesh)?;
    }
    Ok(mesh)
}

fn add(draw: &mut Draw<'_>, mesh: &mut Mesh) -> Result<()> {
    let (corners, faces): (&[[i8; 3]], _) = if draw.coin()? {
        (&TETRAHEDRON.0, TETRAHEDRON.1)
    } else {
        (&OCTAHEDRON.0, OCTAHEDRON.1)
    };
    let first = i64::try_from(mesh.vertices.len()).unwrap_or_default();
    let (shift, scale) = (draw.vector()?, draw.vector()?);
    let jitter = if draw.coin()? { draw.tiny()? } else { 0.0 };
    for corner in corners {
        let mut point = [0.0; 3];
        for (k, x) in point.iter_mut().enumerate() {
            *x = f64::from(corner[k]) * scale[k] + shift[k];
            if jitter > 0.0 {
                *x += jitter * draw.number()?;
            }
        }
        mesh.vertices.push(point);
    }
    let turned = draw.up_to(3)? == 0;
    for &[a, b, c] in faces {
        let face = if turned { [a, c, b] } else { [a, b, c] };
        mesh.faces.push(face.map(|corner| first + corner));
    }
    Ok(())
}

fn harm(draw: &mut Draw<'_>, mesh: &mut Mesh) -> Result<()> {
    if mesh.faces.is_empty() {
        return Ok(());
    }
    let face = draw.up_to(mesh.faces.len() - 1)?;
    match draw.up_to(6)? {
        0 => mesh.faces[face].swap(0, 1),
        1 => {
            mesh.faces.remove(face);
        }
        2 => mesh.faces.push(mesh.faces[face]),
        3 => {
            let vertex = draw.up_to(mesh.vertices.len() - 1)?;
            mesh.faces[face][0] = i64::try_from(vertex).unwrap_or_default();
        }
        4 => {
            let (from, to) = (
                draw.up_to(mesh.vertices.len() - 1)?,
                draw.up_to(mesh.vertices.len() - 1)?,
            );
            mesh.vertices[to] = mesh.vertices[from];
        }
        5 => {
            let vertex = draw.up_to(mesh.vertices.len() - 1)?;
            mesh.vertices[vertex] = draw.numbers()?;
        }
        _ => {
            let wild = [-1, i64::MAX, i64::MIN, 99];
            mesh.faces[face][1] = draw.one_of(&wild)?;
        }
    }
    Ok(())
}
