//! Which components of a closed mesh lie in which: a surface wound inward is a cavity only within another one.
//!
//! How often the others wind around a component is counted along a ray from one of its faces: each face that the ray passes
//! from the inside counts one, each from the outside minus one.

use std::collections::HashMap;
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector3;

use super::boundary::mark_of;
use super::view::{Index, View};
use crate::error::MeshFault;
use crate::mass::simplex::Corners;
use crate::numerics::threads::{Halt, Watch, each_watched, fill_blocks};
use crate::numerics::tree_sum::BLOCK;

/// A part of a mesh that is connected by its corners.
#[derive(Clone, Copy, Debug)]
struct Component {
    /// Its first face.
    face: usize,
    faces: usize,
    /// A corner from which its volume is summed.
    corner: Vector3<f64>,
    volume: f64,
    /// Whether it is wound inward, but in nothing.
    is_inside_out: bool,
}

/// The components of a mesh that are wound the wrong way.
#[derive(Clone, Debug)]
pub(super) struct InsideOut {
    components: Vec<Component>,
    /// Of each face.
    of_faces: Vec<usize>,
}

impl InsideOut {
    /// The first of them.
    pub(super) fn fault(&self) -> Option<MeshFault> {
        let first = self.components.iter().find(|part| part.is_inside_out)?;
        Some(MeshFault::InsideOut {
            face: first.face,
            faces: first.faces,
            volume: first.volume,
        })
    }

    /// The faces, those of these components turned over.
    pub(super) fn orient_faces<I: Index>(&self, faces: &[[I; 3]]) -> Vec<[I; 3]> {
        let components = self.of_faces.iter().map(|&k| &self.components[k]);
        faces
            .iter()
            .zip(components)
            .map(|(&[a, b, c], part)| {
                if part.is_inside_out {
                    [a, c, b]
                } else {
                    [a, b, c]
                }
            })
            .collect()
    }
}

/// The components of a closed mesh that are wound inward where there is nothing to be hollow, or outward in such a one;
/// with `sign` −1 the whole mesh counts as turned over. `None` where there are none.
///
/// Free where there is one component, and little where all are wound alike.
pub(super) fn find_inside_out<I: Index>(
    mesh: &View<'_, I>,
    sign: f64,
    watch: &mut Watch<'_>,
) -> Result<Option<InsideOut>, Halt<Infallible>> {
    let Some(parts) = VertexSets::of(mesh, watch)? else {
        return Ok(None);
    };
    let (mut components, of_faces) = components(mesh, &parts);
    if components.iter().all(|part| part.volume * sign >= 0.0) {
        return Ok(None);
    }
    let windings = windings(mesh, &components, &of_faces, watch)?;
    let mut are_there = false;
    for (part, windings) in components.iter_mut().zip(windings) {
        let around = |is_wrong: fn(f64) -> bool| windings.iter().all(|w| is_wrong(w * sign));
        part.is_inside_out = if part.volume * sign < 0.0 {
            around(|w| w < 1.0)
        } else {
            around(|w| w <= -1.0)
        };
        are_there |= part.is_inside_out;
    }
    Ok(are_there.then_some(InsideOut {
        components,
        of_faces,
    }))
}

/// The component of each face of a mesh, and how many there are; `None` where it is one.
pub(in crate::mass) fn find_components<I: Index>(
    mesh: &View<'_, I>,
    watch: &mut Watch<'_>,
) -> Result<Option<(Vec<usize>, usize)>, Halt<Infallible>> {
    let found = VertexSets::of(mesh, watch)?.map(|parts| components(mesh, &parts));
    Ok(found.map(|(components, of_faces)| (of_faces, components.len())))
}

/// Sets of vertices that faces join, each named by its lowest vertex: for any order, on any number of threads.
struct VertexSets(Vec<AtomicUsize>);

impl VertexSets {
    /// The parts of a mesh, where there are several.
    fn of<I: Index>(
        mesh: &View<'_, I>,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Self>, Halt<Infallible>> {
        let vertices = mesh.vertices.len();
        let parts = Self((0..vertices).map(AtomicUsize::new).collect());
        let count = mesh.faces.len();
        let faces = |block: usize| &mesh.faces[block * BLOCK..count.min((block + 1) * BLOCK)];
        let mut blocks = vec![false; count.div_ceil(BLOCK)];
        fill_blocks(&mut blocks, 1, watch, |block, _| {
            for face in faces(block) {
                let [a, b, c] = face.map(Index::position);
                parts.join(a, b);
                parts.join(a, c);
            }
            Ok(())
        })?;
        for welded in [false, true] {
            if welded {
                parts.weld(mesh.vertices);
            }
            let first = parts.root(mesh.faces[0][0].position());
            fill_blocks(&mut blocks, 1, watch, |block, other| {
                let mut faces = faces(block).iter();
                other[0] = faces.any(|face| parts.root(face[0].position()) != first);
                Ok(())
            })?;
            if !blocks.contains(&true) {
                return Ok(None);
            }
        }
        Ok(Some(parts))
    }

    #[inline]
    fn root(&self, mut at: usize) -> usize {
        loop {
            let parent = self.0[at].load(Ordering::Relaxed);
            if parent == at {
                return at;
            }
            // Halving the way for whoever comes next; what stands above a vertex stays above it.
            let above = self.0[parent].load(Ordering::Relaxed);
            if above != parent {
                self.0[at].store(above, Ordering::Relaxed);
            }
            at = above;
        }
    }

    #[inline]
    fn join(&self, a: usize, b: usize) {
        loop {
            let (a, b) = (self.root(a), self.root(b));
            let (low, high) = (a.min(b), a.max(b));
            let link =
                || self.0[high].compare_exchange(high, low, Ordering::Relaxed, Ordering::Relaxed);
            if low == high || link().is_ok() {
                return;
            }
        }
    }

    /// Joins vertices with the same coordinates.
    fn weld(&self, vertices: &[[f64; 3]]) {
        let mut marked: Vec<(u64, usize)> = (0..)
            .zip(vertices)
            .map(|(number, vertex)| (mark_of(vertex), number))
            .collect();
        marked.sort_unstable();
        for pair in marked.windows(2) {
            let [(p, a), (q, b)] = [pair[0], pair[1]];
            if p == q && vertices[a] == vertices[b] {
                self.join(a, b);
            }
        }
    }
}

/// The components in the order of their first faces, and that of each face.
fn components<I: Index>(mesh: &View<'_, I>, parts: &VertexSets) -> (Vec<Component>, Vec<usize>) {
    let mut numbers: HashMap<usize, usize> = HashMap::new();
    let mut components: Vec<Component> = Vec::new();
    let of_faces = mesh.faces.iter().enumerate().map(|(face, corners)| {
        let [a, b, c] = mesh.corners(face).map(Vector3::from);
        let next = components.len();
        let number = *numbers
            .entry(parts.root(corners[0].position()))
            .or_insert(next);
        if number == next {
            components.push(Component {
                face,
                faces: 0,
                corner: a,
                volume: 0.0,
                is_inside_out: false,
            });
        }
        let part = &mut components[number];
        part.faces += 1;
        part.volume += (a - part.corner).dot(&(b - a).cross(&(c - a))) / 6.0;
        number
    });
    let of_faces = of_faces.collect();
    (components, of_faces)
}

/// Points on each component from which rays start; that all of them lie on another surface too is not likely.
const RAYS: usize = 3;

/// Where a ray along x starts, and what it has passed.
struct Ray {
    from: Vector3<f64>,
    component: usize,
    passed: f64,
}

/// How often all other components wind around points of each.
fn windings<I: Index>(
    mesh: &View<'_, I>,
    components: &[Component],
    of_faces: &[usize],
    watch: &mut Watch<'_>,
) -> Result<Vec<Vec<f64>>, Halt<Infallible>> {
    let mut rays: Vec<Ray> = Vec::new();
    let mut seen = vec![0; components.len()];
    for (face, &component) in of_faces.iter().enumerate() {
        let faces = components[component].faces;
        if (0..RAYS).any(|k| k * faces / RAYS == seen[component]) {
            let [a, b, c] = mesh.corners(face).map(Vector3::from);
            rays.push(Ray {
                from: a + (b - a) / 3.0 + (c - a) / 3.0,
                component,
                passed: 0.0,
            });
        }
        seen[component] += 1;
    }
    rays.sort_by(|p, q| p.from.z.total_cmp(&q.from.z));
    each_watched(of_faces.iter().enumerate(), watch, |(face, &component)| {
        let corners = mesh.corners(face).map(Vector3::from);
        let [low, high] = [f64::min, f64::max]
            .map(|least: fn(f64, f64) -> f64| corners.map(|r| r.z).into_iter().reduce(least));
        let (Some(low), Some(high)) = (low, high) else {
            return Ok(());
        };
        let from = rays.partition_point(|ray| ray.from.z < low);
        for ray in rays[from..].iter_mut().take_while(|ray| ray.from.z <= high) {
            if ray.component != component {
                ray.passed += signed_crossing(&ray.from, &corners);
            }
        }
        Ok(())
    })?;
    let mut windings = vec![Vec::new(); components.len()];
    for ray in rays {
        windings[ray.component].push(ray.passed);
    }
    Ok(windings)
}

/// Whether the ray from q along x passes a triangle, 1 from behind and −1 from its front.
///
/// Along x the triangle winds around q as often as its edges do, and an edge decides the same for both its faces: so no
/// ray slips through between two triangles.
fn signed_crossing(q: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> f64 {
    let mut turns = 0.0;
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let (p, r) = (&corners[from], &corners[to]);
        let is_upward = p.z <= q.z && q.z < r.z;
        let is_downward = r.z <= q.z && q.z < p.z;
        if !(is_upward || is_downward) {
            continue;
        }
        let (low, high) = if is_upward { (p, r) } else { (r, p) };
        if (high.y - low.y) * (q.z - low.z) > (high.z - low.z) * (q.y - low.y) {
            turns += if is_upward { 1.0 } else { -1.0 };
        }
    }
    if turns == 0.0 {
        return 0.0;
    }
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    let is_ahead = (a - q).dot(&normal) * turns > 0.0;
    if is_ahead { turns } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    /// Cubes (centre, half the side, whether outward), one after the other.
    fn cubes(list: &[([f64; 3], f64, bool)]) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for &([x, y, z], half, is_outward) in list {
            let n = vertices.len();
            let side = |bit: usize| if bit == 1 { half } else { -half };
            vertices
                .extend((0..8).map(|k| [x + side(k & 1), y + side(k >> 1 & 1), z + side(k >> 2)]));
            for [a, b, c, d] in quads {
                for [a, b, c] in [[a, b, c], [a, c, d]] {
                    let turned = if is_outward { [a, b, c] } else { [a, c, b] };
                    faces.push(turned.map(|k| n + k));
                }
            }
        }
        (vertices, faces)
    }

    fn wrong(list: &[([f64; 3], f64, bool)], sign: f64) -> Vec<bool> {
        let (vertices, faces) = cubes(list);
        let mesh = View {
            vertices: &vertices,
            faces: &faces,
        };
        let go_on = &mut |_| ControlFlow::Continue(());
        match find_inside_out(&mesh, sign, go_on).expect("goes on") {
            None => vec![false; list.len()],
            Some(found) => {
                let flags = found.components.iter().map(|part| part.is_inside_out);
                let (flags, turned) = (flags.collect(), found.orient_faces(&faces));
                let mesh = View {
                    vertices: &vertices,
                    faces: &turned,
                };
                let again = find_inside_out(&mesh, sign, go_on).expect("goes on");
                assert!(again.is_none());
                flags
            }
        }
    }

    #[test]
    fn cavities_lie_in_something() {
        let o = [0.0; 3];
        let beside = [5.0, 0.1, 0.2];
        for sign in [1.0, -1.0] {
            let out = sign > 0.0;
            let wrong = |list: &[([f64; 3], f64, bool)]| wrong(list, sign);
            assert_eq!(wrong(&[(o, 1.0, out)]), [false]);
            assert_eq!(wrong(&[(o, 2.0, out), (o, 1.0, !out)]), [false, false]);
            assert_eq!(wrong(&[(o, 2.0, out), (beside, 1.0, !out)]), [false, true]);
            assert_eq!(wrong(&[(o, 2.0, out), (beside, 1.0, out)]), [false, false]);
            // A stone in a cavity, and a cavity in a cavity.
            let stone = [(o, 3.0, out), (o, 2.0, !out), (o, 1.0, out)];
            assert_eq!(wrong(&stone), [false, false, false]);
            let hole = [(o, 3.0, out), (o, 2.0, !out), (o, 1.0, !out)];
            assert_eq!(wrong(&hole), [false, false, true]);
            // A hollow cube, all of it turned over, beside a good one.
            let turned = [(o, 2.0, out), (beside, 2.0, !out), (beside, 1.0, out)];
            assert_eq!(wrong(&turned), [false, true, true]);
        }
    }
}
