//! Whether faces are a surface: which corners are one, and how faces meet at their edges.

use std::collections::HashMap;

use crate::error::{Corner, Count, MeshFault};
use crate::numerics::threads::{Halt, Watch, each_watched};

/// The number of the first vertex with the same coordinates (−0 is +0), for each vertex.
pub(super) fn same_corners(
    vertices: &[[f64; 3]],
    watch: &mut Watch<'_>,
) -> Result<Vec<usize>, Halt<MeshFault>> {
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::with_capacity(vertices.len());
    let mut same = Vec::with_capacity(vertices.len());
    each_watched(vertices.iter().enumerate(), watch, |(number, vertex)| {
        let bits = vertex.map(|x| (x + 0.0).to_bits());
        same.push(*numbers.entry(bits).or_insert(number));
        Ok(())
    })?;
    Ok(same)
}

/// Every edge has one face, or two that run along it in opposite directions.
///
/// The edges are brought together by their lower ends, so that no more than those of one vertex are sorted at a time.
pub(super) fn check_edges(
    faces: &[[usize; 3]],
    numbers: &[usize],
    vertices: usize,
    watch: &mut Watch<'_>,
) -> Result<(), Halt<MeshFault>> {
    let edges = |&[a, b, c]: &[usize; 3]| [(a, b), (b, c), (c, a)];
    let mut ends = vec![0; vertices + 1];
    for (from, to) in faces.iter().flat_map(edges) {
        ends[from.min(to) + 1] += 1;
    }
    for vertex in 0..vertices {
        ends[vertex + 1] += ends[vertex];
    }
    // The higher end, whether the face runs toward it, and the face.
    let mut runs = vec![(0, false, 0); 3 * faces.len()];
    let mut next = ends.clone();
    each_watched(faces.iter().zip(numbers), watch, |(corners, &face)| {
        for (from, to) in edges(corners) {
            let place = &mut next[from.min(to)];
            runs[*place] = (from.max(to), from < to, face);
            *place += 1;
        }
        Ok(())
    })?;
    each_watched(0..vertices, watch, |low| {
        let runs = &mut runs[ends[low]..ends[low + 1]];
        runs.sort_unstable();
        for group in runs.chunk_by(|p, q| p.0 == q.0) {
            check_edge(low, group)?;
        }
        Ok(())
    })
}

/// The edge from the vertex `low` to a higher one, with the faces at it.
fn check_edge(low: usize, group: &[(usize, bool, usize)]) -> Result<(), MeshFault> {
    match *group {
        [(high, p, first), (_, q, second)] if p == q => {
            let (from, to) = if p { (low, high) } else { (high, low) };
            Err(MeshFault::InconsistentWinding {
                from: Corner::Vertex(from),
                to: Corner::Vertex(to),
                first,
                second,
                count: Count {
                    seen: 1,
                    is_least: true,
                },
            })
        }
        [] | [_] | [_, _] => Ok(()),
        [(high, ..), ..] => Err(MeshFault::Branching {
            from: Corner::Vertex(low),
            to: Corner::Vertex(high),
            faces: group.len(),
        }),
    }
}
