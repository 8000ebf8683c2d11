//! Open meshes closed on request: by caps over the holes, or by the convex hull in their place.
//!
//! An open mesh has no volume of its own: what its faces span with a point depends on the point. Closing it is a choice,
//! and [`Provenance::volume_change`] tells what it came to: the volume of the closed mesh less the volume that the faces
//! span with the middle of their box.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::in_memory::{MeshSolid, polyhedron_watched};
use super::solid::Options;
use super::view::{Index, View};
use crate::error::{Corner, Count, Error, MeshFault};
use crate::mass::provenance::{Closure, Provenance};
use crate::mass::simplex::{Solid, sums};
use crate::mass::solids::Amount;
use crate::numerics::threads::{Halt, Watch};

/// The solid of a mesh whose holes are closed: each by triangles from the edges around it to the mean of their ends, which
/// for a flat hole is the flat cap, whatever its shape.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::Amount;
/// use polhode::mass::polyhedron::Options;
/// use polhode::mass::polyhedron::closure::{close_with_caps, close_with_hull};
/// use polhode::mass::provenance::Closure;
///
/// // The corner of a cube without its slanted face, which either way is put in again.
/// let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let open = [[0_usize, 2, 1], [0, 1, 3], [0, 3, 2]];
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let amount = Amount::Density(6.0);
/// let body = close_with_caps(&vertices, &open, amount, Options::default(), go_on)?.body;
/// assert!((body.mass() - 1.0).abs() < 1e-15);
/// assert_eq!(body.provenance().closure, Some(Closure::Caps));
/// let hull = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let body = close_with_hull(&vertices, &open, &hull, amount, go_on)?.body;
/// assert_eq!(body.provenance().closure, Some(Closure::Hull));
/// # Ok::<(), polhode::parallel::Halt<polhode::Error>>(())
/// ```
///
/// # Errors
/// As [`polyhedron`](super::polyhedron) of the closed mesh; faces that are wound inconsistently.
pub fn close_with_caps<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    options: Options,
    watch: &mut Watch<'_>,
) -> Result<MeshSolid, Halt<Error>> {
    let open = View { vertices, faces };
    let (vertices, closed) =
        with_caps(vertices, faces).map_err(|fault| Halt::Failed(fault.into()))?;
    instead(
        &open,
        &vertices,
        &closed,
        Closure::Caps,
        (amount, options),
        watch,
    )
}

/// Vertices and faces.
pub type CappedMesh = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// The mesh that [`close_with_caps`] sums: vertices and faces, the points in the middle of the holes and the caps last.
///
/// # Errors
/// Faces that count vertices wrongly, or are wound inconsistently.
///
/// # Examples
///
/// ```
/// use polhode::mass::polyhedron::closure::{CappedMesh, with_caps};
///
/// let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let open = [[0_usize, 2, 1], [0, 1, 3], [0, 3, 2]];
/// let (vertices, faces): CappedMesh = with_caps(&vertices, &open)?;
/// assert_eq!((vertices.len(), faces.len()), (5, 6)); // a point in the middle of the hole, three caps around it
/// # Ok::<(), polhode::error::MeshFault>(())
/// ```
pub fn with_caps<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
) -> Result<CappedMesh, MeshFault> {
    if let Some(fault) = (View { vertices, faces }).find_unusable() {
        return Err(fault);
    }
    let mut vertices = vertices.to_vec();
    let mut closed: Vec<[usize; 3]> = faces.iter().map(|face| face.map(Index::position)).collect();
    let caps = caps(&mut vertices, &closed)?;
    closed.extend(caps);
    Ok((vertices, closed))
}

/// The solid of a mesh replaced by a hull of the same vertices, in any orientation.
///
/// # Errors
/// As [`polyhedron`](super::polyhedron) of the hull.
pub fn close_with_hull<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    hull: &[[i64; 3]],
    amount: Amount,
    watch: &mut Watch<'_>,
) -> Result<MeshSolid, Halt<Error>> {
    let open = View { vertices, faces };
    if let Some(fault) = open.find_unusable() {
        return Err(Halt::Failed(fault.into()));
    }
    let options = Options {
        orient: true,
        check: true,
    };
    instead(
        &open,
        vertices,
        hull,
        Closure::Hull,
        (amount, options),
        watch,
    )
}

/// The solid of another mesh, which says so.
fn instead<I: Index, J: Index>(
    open: &View<'_, I>,
    vertices: &[[f64; 3]],
    faces: &[[J; 3]],
    closure: Closure,
    (amount, options): (Amount, Options),
    watch: &mut Watch<'_>,
) -> Result<MeshSolid, Halt<Error>> {
    let mut solid = polyhedron_watched(vertices, faces, amount, options, watch)?;
    let before = spanned_volume(open, watch)?;
    let after = spanned_volume(&View { vertices, faces }, watch)?;
    let outward = if closure == Closure::Caps {
        after.signum()
    } else {
        before.signum()
    };
    solid.body = solid.body.with_provenance(Provenance {
        closure: Some(closure),
        volume_change: after.abs() - outward * before,
        ..solid.body.provenance()
    });
    Ok(solid)
}

/// What the faces span with the middle of their box: the volume where they are closed.
fn spanned_volume<I: Index>(mesh: &View<'_, I>, watch: &mut Watch<'_>) -> Result<f64, Halt<Error>> {
    let frame = mesh.used_frame();
    let sums = sums::<_, Solid, 3>(mesh, &frame, watch)?;
    Ok(sums.content * frame.unit * frame.unit * frame.unit)
}

/// Triangles over the holes; the points they meet in are added to the vertices.
fn caps(vertices: &mut Vec<[f64; 3]>, faces: &[[usize; 3]]) -> Result<Vec<[usize; 3]>, MeshFault> {
    let open = open_edges(vertices, faces)?;
    let mut holes = Forest::default();
    for &(from, to) in &open {
        holes.join(from, to);
    }
    let mut members: HashMap<usize, Vec<usize>> = HashMap::new();
    for &(from, _) in &open {
        members.entry(holes.root(from)).or_default().push(from);
    }
    let mut apexes: HashMap<usize, usize> = HashMap::new();
    for (from, _) in &open {
        let root = holes.root(*from);
        if apexes.contains_key(&root) {
            continue;
        }
        let first = Vector3::from(vertices[root]);
        let around = &members[&root];
        let sum: Vector3<f64> = around
            .iter()
            .map(|&k| Vector3::from(vertices[k]) - first)
            .sum();
        apexes.insert(root, vertices.len());
        vertices.push((first + sum / around.len() as f64).into());
    }
    Ok(open
        .iter()
        .map(|&(from, to)| [to, from, apexes[&holes.root(from)]])
        .collect())
}

/// The edges that one face more runs along one way than the other, in that way; corners with equal coordinates are one.
fn open_edges(
    vertices: &[[f64; 3]],
    faces: &[[usize; 3]],
) -> Result<Vec<(usize, usize)>, MeshFault> {
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
    let same: Vec<usize> = vertices
        .iter()
        .enumerate()
        .map(|(number, vertex)| {
            let bits = vertex.map(|x| (x + 0.0).to_bits());
            *numbers.entry(bits).or_insert(number)
        })
        .collect();
    let mut runs: Vec<(usize, usize, bool, usize)> = Vec::with_capacity(3 * faces.len());
    for (face, corners) in faces.iter().enumerate() {
        let [a, b, c] = corners.map(|k| same[k]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from != to {
                runs.push((from.min(to), from.max(to), from < to, face));
            }
        }
    }
    runs.sort_unstable();
    let mut open = Vec::new();
    for group in runs.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)) {
        let upward = group.iter().filter(|run| run.2).count();
        let downward = group.len() - upward;
        let (low, high, ..) = group[0];
        let (from, to) = if upward > downward {
            (low, high)
        } else {
            (high, low)
        };
        match upward.abs_diff(downward) {
            0 => {}
            1 => open.push((from, to)),
            _ => {
                let mut same_way = group.iter().filter(|run| run.2 == (upward > downward));
                let mut next = || same_way.next().map_or(0, |run| run.3);
                return Err(MeshFault::InconsistentWinding {
                    from: Corner::Vertex(from),
                    to: Corner::Vertex(to),
                    first: next(),
                    second: next(),
                    count: Count {
                        seen: 1,
                        is_least: true,
                    },
                });
            }
        }
    }
    Ok(open)
}

/// Sets of vertices that are joined one by one.
#[derive(Default)]
struct Forest(HashMap<usize, usize>);

impl Forest {
    fn root(&mut self, of: usize) -> usize {
        let mut at = of;
        while let Some(&parent) = self.0.get(&at)
            && parent != at
        {
            // Halving the way for whoever comes next.
            let above = self.0.get(&parent).copied().unwrap_or(parent);
            self.0.insert(at, above);
            at = above;
        }
        at
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0.insert(low, low);
        self.0.insert(high, low);
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    const CORNERS: [[f64; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    const FACES: [[i64; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    #[test]
    fn a_flat_cap_brings_back_the_missing_face() {
        let go_on = &mut |_| ControlFlow::Continue(());
        let amount = Amount::Density(6.0);
        for missing in 0..4 {
            let mut open = FACES.to_vec();
            open.remove(missing);
            let body = close_with_caps(&CORNERS, &open, amount, Options::default(), go_on)
                .expect("capped")
                .body;
            assert!((body.mass() - 1.0).abs() < 1e-15);
            let provenance = body.provenance();
            assert_eq!(provenance.closure, Some(Closure::Caps));
            // From the middle of the box, (½, ½, ½): the missing face spans ±1/12 or (the oblique one) −1/12.
            assert!((provenance.volume_change.abs() - 1.0 / 12.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_closed_mesh_is_not_changed() {
        let go_on = &mut |_| ControlFlow::Continue(());
        let amount = Amount::Density(6.0);
        let capped = close_with_caps(&CORNERS, &FACES, amount, Options::default(), go_on)
            .expect("closed")
            .body;
        assert_eq!(capped.provenance().volume_change, 0.0);
        assert_eq!(capped.provenance().elements, 4);
        let hulled = close_with_hull(&CORNERS, &FACES[..3], &FACES, amount, go_on)
            .expect("hull")
            .body;
        assert_eq!(hulled.inertia(), capped.inertia());
        assert_eq!(hulled.provenance().closure, Some(Closure::Hull));
    }
}
