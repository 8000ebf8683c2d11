//! Shells of finite thickness: what a surface sweeps when its faces are moved to both sides.
//!
//! The mid-surface has corners v and, at each, a direction d: at the distance s it has the corners `v + s d`,
//! and s runs over ±t/2. With the barycentric coordinates λ of a triangle, edges e and f,
//!
//! `∫ g dV = ∫ ds ∫ g(x) Σ λ_i J_i dλ`, `x = Σ λ_i (v_i + s d_i)`, `J_i = d_i · (e(s) × f(s))`,
//!
//! which is the solid between the outer and the inner offset, walls along the open rim included, without their difference:
//! all J are positive, so a shell as thin as you like keeps its digits. Over λ the integrals are closed forms, over s
//! polynomials of the fourth degree, for which three points of Gauss are exact.

use std::collections::HashMap;

use nalgebra::{Matrix3, Vector3};

use super::amount::Amount;
use super::body::RigidBody;
use super::error_bound::UNIT;
use super::integrator::{Matter, integrate_sums};
use super::polyhedron::{Index, View};
use super::provenance::{BodySource, Checks, Provenance};
use super::simplex::{ELEMENT, LocalFrame, Sums};
use super::surface::finish;
use crate::error::{Corner, Count, Error, MeshFault};
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::split_vector::{SplitVector, cross};
use crate::numerics::threads::{Halt, Watch, each_watched};
use crate::principal::{PrincipalAxes, principal_axes};

// The body of a shell: what is asked of its mid-surface and its thickness, and the axes its integrals are taken in.

/// A shell of uniform density around a mid-surface, `thickness` from face to face: each face is moved by half of it to
/// both sides.
///
/// `amount` is the total mass or the mass per volume. The surface may be open, then walls along its rim join the two sides;
/// faces must be consistently wound, outward or inward. Sharp edges and corners are mitred: exact where at most three
/// planes meet. That the shell does not fold over itself is checked face by face; sheets far apart along the surface that
/// come to overlap count twice. `watch` is asked about every 20 ms whether to go on.
///
/// # Examples
///
/// ```
/// use polhode::mass::Amount;
/// use polhode::mass::thick_shell::thick_shell;
/// use std::ops::ControlFlow;
///
/// let square = [[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
/// let faces = [[0_usize, 1, 2], [0, 2, 3]];
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let plate = thick_shell(&square, &faces, 0.25, Amount::Density(8.0), go_on).unwrap();
/// assert!((plate.mass() - 8.0).abs() < 1e-13); // 8 · 2 · 2 · 1/4
/// ```
///
/// # Errors
/// [`Error::OutOfDomain`] for a thickness that is not positive; [`MeshFault`] when the surface is not one or the shell
/// folds over itself, naming the face; [`Halt::Stopped`] where `watch` said so.
pub fn thick_shell<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    thickness: f64,
    amount: Amount,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Halt<Error>> {
    if !(thickness > 0.0 && thickness.is_finite()) {
        return Err(Halt::Failed(Error::OutOfDomain {
            what: "thickness",
            law: "positive and finite",
            value: thickness,
        }));
    }
    let mesh = View { vertices, faces };
    let failed = |fault: MeshFault| Halt::Failed(fault.into());
    let halted = |halt: Halt<MeshFault>| match halt {
        Halt::Stopped => Halt::Stopped,
        Halt::Failed(fault) => failed(fault),
    };
    if faces.is_empty() {
        return Err(failed(MeshFault::NoFaces));
    }
    let frame = mesh.used_frame();
    let offset = offset(&mesh, frame.unit, watch).map_err(halted)?;
    if offset.faces.is_empty() {
        let faces = faces.len();
        return Err(failed(MeshFault::NoArea { area: 0.0, faces }));
    }
    let limit = offset.limit(vertices, frame.unit, watch).map_err(halted)?;
    if thickness > limit.thickness {
        return Err(failed(MeshFault::TooThick {
            face: offset.numbers[limit.face],
            thickness,
            limit: limit.thickness,
        }));
    }
    let shell = ShellIntegrand {
        offset: &offset,
        vertices,
        thickness,
    };
    let (sums, moments) = integrate_sums(&shell, &shell.moments(&frame, watch)?, 4, watch)?;
    let error = 2.0 * (sums.scale.x + sums.roundings() * sums.content);
    let checks = Checks::INDICES
        .and(Checks::FINITE)
        .and(Checks::WINDING)
        .and(Checks::VOLUME);
    // A surface counts in squares of the unit, and the thickness in a unit of its own, however thin it is.
    let content = 2 * exponent(sums.frame.unit) + exponent(thickness);
    finish(&sums, content, error, amount)
        .map(|body| {
            body.with_provenance(Provenance {
                moments,
                ..Provenance::of_matter(BodySource::Surface, faces.len(), checks)
            })
        })
        .map_err(Halt::Failed)
}

// The integrals over a shell in the coordinates of a frame: what its faces sweep.

/// What the faces of a surface sweep.
struct ShellIntegrand<'a> {
    offset: &'a Offset,
    vertices: &'a [[f64; 3]],
    thickness: f64,
}

impl Matter for ShellIntegrand<'_> {
    type Moments = Sums;

    fn moments(&self, frame: &LocalFrame, watch: &mut Watch<'_>) -> Result<Sums, Error> {
        let corners: Vec<Vector3<f64>> = self.vertices.iter().map(|r| frame.place(r)).collect();
        let directions: Vec<Vector3<f64>> = match &frame.axes {
            None => self.offset.directions.clone(),
            Some(axes) => self
                .offset
                .directions
                .iter()
                .map(|d| axes.tr_mul(d))
                .collect(),
        };
        let half = 0.5 * self.thickness / frame.unit;
        let mut extent = Vector3::zeros();
        for &k in self.offset.faces.iter().flatten() {
            extent = extent.sup(&(corners[k].abs() + directions[k].abs() * half));
        }
        let placed = ShellInFrame {
            offset: self.offset,
            corners,
            directions,
            half,
            weight: 0.5 * times_power_of_two(self.thickness, -exponent(self.thickness)),
            extent,
        };
        let count = self.offset.faces.len();
        Sums::of_elements(count, frame, extent, watch, |face| placed.element(face))
    }
}

/// A shell in the coordinates and the unit of a frame.
struct ShellInFrame<'a> {
    offset: &'a Offset,
    corners: Vec<Vector3<f64>>,
    directions: Vec<Vector3<f64>>,
    /// Half the thickness, and the same in its own power of two.
    half: f64,
    weight: f64,
    extent: Vector3<f64>,
}

impl ShellInFrame<'_> {
    /// What one face sweeps.
    #[inline]
    fn element(&self, face: usize) -> [f64; ELEMENT] {
        /// √(3/5), with the weight 5/9; the middle has 8/9.
        const NODE: f64 = 0.774_596_669_241_483_4;
        let corners = self.offset.faces[face];
        let of_face = |of: &[Vector3<f64>]| [of[corners[0]], of[corners[1]], of[corners[2]]];
        let (v, d) = (of_face(&self.corners), of_face(&self.directions));
        let longest = d.iter().fold(0.0_f64, |longest, d| longest.max(d.norm()));
        let worst = corners
            .iter()
            .fold(0.0_f64, |worst, &k| worst.max(self.offset.errors[k]));
        let mut terms = [0.0; ELEMENT];
        for (node, weight) in [(-NODE, 5.0), (0.0, 8.0), (NODE, 5.0)] {
            let (s, weight) = (node * self.half, weight * self.weight / 9.0);
            let r = [v[0] + d[0] * s, v[1] + d[1] * s, v[2] + d[2] * s];
            let (e, f) = (r[1] - r[0], r[2] - r[0]);
            let area = e.cross(&f);
            let j = [d[0].dot(&area), d[1].dot(&area), d[2].dot(&area)];
            let (g, sum) = (j[0] + j[1] + j[2], r[0] + r[1] + r[2]);
            let weighted = r[0] * j[0] + r[1] * j[1] + r[2] * j[2];
            // ∫ λ_i x xᵀ dλ = (s sᵀ + Σ x_j x_jᵀ + x_i sᵀ + s x_iᵀ + 2 x_i x_iᵀ)/120, s = Σ x_j.
            let second = |k: usize, l: usize| {
                let (mut squares, mut own) = (sum[k] * sum[l], 0.0);
                for (r, j) in r.iter().zip(j) {
                    squares += r[k] * r[l];
                    own += j * r[k] * r[l];
                }
                (g * squares + weighted[k] * sum[l] + sum[k] * weighted[l] + 2.0 * own) / 120.0
            };
            let first = (sum * g + weighted) / 24.0;
            let (e, f) = (e.norm(), f.norm());
            let roundings = e * f + self.extent.norm() * (e + f) * (1.0 + f64::abs(node) * longest);
            let slack = area.norm() * worst + 16.0 * UNIT * longest * roundings;
            let parts = [
                g / 6.0,
                first.x,
                first.y,
                first.z,
                second(0, 0),
                second(0, 1),
                second(0, 2),
                second(1, 1),
                second(1, 2),
                second(2, 2),
                0.5 * slack,
            ];
            for (term, part) in terms.iter_mut().zip(parts) {
                *term += weight * part;
            }
        }
        terms
    }
}

// Where a vertex of a mid-surface goes when its faces are moved along their normals, and how far they may be moved.

/// Directions in which the normals at a vertex spread by less than the root of this leave it where it is: they are one
/// plane.
const FLAT: f64 = 1e-12;

/// How often the directions are made better.
const REFINED: usize = 2;

/// A surface whose vertices know their way.
struct Offset {
    /// Three different corners each; corners with equal coordinates have one number.
    faces: Vec<[usize; 3]>,
    /// Which face of the mesh each of them is.
    numbers: Vec<usize>,
    /// d of each vertex: it goes to `v + s d` when its faces are moved by s.
    directions: Vec<Vector3<f64>>,
    /// What rounding can have done to the length of each d.
    errors: Vec<f64>,
}

/// The directions of a surface that is consistently wound and has at most two faces at an edge; lengths are divided by
/// `unit`, a power of two.
///
/// With unit normals n of the faces at a vertex, weighted by their angles w there, d makes `Σ w (n·d − 1)²` least and is
/// the shortest that does: where at most three planes meet, or all of them touch one cone, each face moves by exactly s.
/// On a finer and finer mesh of a smooth surface they do so to the second order in the size of the triangles.
fn offset<I: Index>(
    mesh: &View<'_, I>,
    unit: f64,
    watch: &mut Watch<'_>,
) -> Result<Offset, Halt<MeshFault>> {
    if let Some(fault) = mesh.find_unusable() {
        return Err(Halt::Failed(fault));
    }
    let same = same_corners(mesh.vertices, watch)?;
    let mut faces = Vec::with_capacity(mesh.faces.len());
    let mut numbers = Vec::with_capacity(mesh.faces.len());
    each_watched(mesh.faces.iter().enumerate(), watch, |(number, face)| {
        let corners = face.map(|k| same[k.position()]);
        if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
            faces.push(corners);
            numbers.push(number);
        }
        Ok(())
    })?;
    check_edges(&faces, &numbers, mesh.vertices.len(), watch)?;

    let mut around = vec![VertexFaces::default(); mesh.vertices.len()];
    let mut normals = Vec::with_capacity(faces.len());
    each_watched(faces.iter().zip(&numbers), watch, |(corners, &face)| {
        let [i, j, k] = *corners;
        let [a, b, c] = [&mesh.vertices[i], &mesh.vertices[j], &mesh.vertices[k]];
        let edge = |to: &[f64; 3]| SplitVector::difference(to, a).scaled(1.0 / unit);
        let (to_b, to_c) = (edge(b), edge(c));
        let (e, f) = (Vector3::from(to_b.high), Vector3::from(to_c.high));
        let area = Vector3::from(cross(&to_b, &to_c));
        let size = area.norm();
        if size <= 4.0 * UNIT * e.norm() * f.norm() {
            return Err(MeshFault::NoNormal { face });
        }
        let normal = area / size;
        let mut angles = [0.0; 3];
        for (place, &corner) in corners.iter().enumerate() {
            let angle = match place {
                0 => size.atan2(e.dot(&f)),
                1 => size.atan2(e.dot(&(e - f))),
                _ => size.atan2(f.dot(&(f - e))),
            };
            around[corner].add(&normal, angle);
            angles[place] = angle;
        }
        normals.push((normal, angles));
        Ok(())
    })?;
    for at in &mut around {
        at.middle = at.sum.try_normalize(FLAT * at.weight).unwrap_or_default();
    }
    each_watched(
        faces.iter().zip(&normals),
        watch,
        |(corners, (normal, _))| {
            for &corner in corners {
                let at = &mut around[corner];
                at.cosine = at.cosine.min(at.middle.dot(normal));
            }
            Ok(())
        },
    )?;
    let mut ways = vec![VertexDirection::default(); around.len()];
    each_watched(ways.iter_mut().zip(&around), watch, |(way, at)| {
        at.set_way(way);
        Ok(())
    })?;
    for _ in 0..REFINED {
        each_watched(
            faces.iter().zip(&normals),
            watch,
            |(corners, (normal, angles))| {
                for (&corner, &angle) in corners.iter().zip(angles) {
                    ways[corner].miss(normal, angle);
                }
                Ok(())
            },
        )?;
        for (way, at) in ways.iter_mut().zip(&around) {
            way.refine(at.weight);
        }
    }
    let directions = ways.iter().map(|way| way.direction).collect();
    let errors = ways.iter().map(VertexDirection::error).collect();
    Ok(Offset {
        faces,
        numbers,
        directions,
        errors,
    })
}

/// The faces around a vertex.
#[derive(Clone, Copy)]
struct VertexFaces {
    /// `Σ w`.
    weight: f64,
    /// `Σ w n`.
    sum: Vector3<f64>,
    /// `Σ w n nᵀ`.
    square: Matrix3<f64>,
    /// The direction of the sum.
    middle: Vector3<f64>,
    /// Of the angle between it and the normal that is farthest from it.
    cosine: f64,
}

impl Default for VertexFaces {
    fn default() -> Self {
        Self {
            weight: 0.0,
            sum: Vector3::zeros(),
            square: Matrix3::zeros(),
            middle: Vector3::zeros(),
            cosine: 1.0,
        }
    }
}

impl VertexFaces {
    #[inline]
    fn add(&mut self, normal: &Vector3<f64>, angle: f64) {
        self.weight += angle;
        self.sum += normal * angle;
        self.square += normal * normal.transpose() * angle;
    }

    /// Sets the way of the vertex, as well as the square of the normals knows it; that of a vertex without faces is zero.
    ///
    /// Planes that nearly are one, or nearly share a line, may meet far away: a vertex that would go aside by more than
    /// twice the angle over which the normals spread goes the way of the fewer planes that they nearly are.
    #[inline]
    fn set_way(&self, way: &mut VertexDirection) {
        if self.weight <= 0.0 {
            return;
        }
        let PrincipalAxes {
            moments: values,
            axes,
        } = principal_axes(&(self.square / self.weight));
        let mean = self.sum / self.weight;
        let within = if self.cosine > 0.0 {
            2.0 * self.cosine * self.cosine - 1.0
        } else {
            -1.0
        };
        for unused in 0..2 {
            if values[unused] <= FLAT {
                continue;
            }
            way.inverse = Matrix3::zeros();
            for (k, &value) in values.iter().enumerate().skip(unused) {
                way.inverse += axes.column(k) * axes.column(k).transpose() / value;
            }
            way.direction = way.inverse * mean;
            if way.direction.dot(&self.middle) >= within * way.direction.norm() {
                way.least = values[unused];
                return;
            }
        }
        // One plane: Σ w (n·m α − 1)² is least at this α.
        let m = self.middle;
        let square = (m.dot(&(self.square * m)) / self.weight).max(f64::MIN_POSITIVE);
        way.direction = m * (m.dot(&mean) / square);
        way.inverse = m * m.transpose() / square;
        way.least = 1.0;
    }
}

/// Where a vertex goes, made better by what its faces miss: the inverse of the square of the normals is wrong by the
/// square of what the normals themselves make uncertain.
#[derive(Clone, Copy, Default)]
struct VertexDirection {
    /// d.
    direction: Vector3<f64>,
    /// The inverse of `Σ w n nᵀ/Σ w`, on the directions in which the normals spread.
    inverse: Matrix3<f64>,
    /// The least value that it is the inverse of.
    least: f64,
    /// `Σ w n (1 − n·d)`.
    missed: Vector3<f64>,
    /// `Σ w (1 − n·d)²`, and the same over `Σ w` in the last round.
    squares: f64,
    residual: f64,
}

impl VertexDirection {
    /// Counts what the face with this normal misses.
    #[inline]
    fn miss(&mut self, normal: &Vector3<f64>, angle: f64) {
        let normal_split = SplitVector {
            high: (*normal).into(),
            low: [0.0; 3],
        };
        let missed = 1.0 - normal_split.dot(&self.direction.into());
        self.missed += normal * (angle * missed);
        self.squares += angle * missed * missed;
    }

    /// Goes where less is missed, and counts anew.
    #[inline]
    fn refine(&mut self, weight: f64) {
        if weight > 0.0 {
            self.direction += self.inverse * (self.missed / weight);
            self.residual = self.squares / weight;
        }
        (self.missed, self.squares) = (Vector3::zeros(), 0.0);
    }

    /// What rounding can have done to the length of d: the normals are off by a few units, their planes meet a part as the
    /// root of the least value farther off, and what they miss at the meeting weighs twice as much (Wedin 1973).
    #[inline]
    fn error(&self) -> f64 {
        if self.least <= 0.0 {
            return 0.0;
        }
        let sensitivity = 1.0 / self.least.sqrt() + self.residual.sqrt() / self.least;
        128.0 * UNIT * (1.0 + self.direction.norm()) * sensitivity
    }
}

/// The first thickness at which a face turns over, and the face.
struct Limit {
    face: usize,
    thickness: f64,
}

impl Offset {
    /// How thick the shell may be: up to there `J_i(s) = d_i · ((e + s e′) × (f + s f′))` is positive at each corner i of
    /// each face, for |s| up to half the thickness, with e, f the edges and e′, f′ those between the d.
    ///
    /// J is the volume that the surface sweeps for each ds, and linear between the corners.
    fn limit(
        &self,
        vertices: &[[f64; 3]],
        unit: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Limit, Halt<MeshFault>> {
        let mut limit = Limit {
            face: 0,
            thickness: f64::INFINITY,
        };
        each_watched(self.faces.iter().enumerate(), watch, |(face, corners)| {
            let [i, j, k] = *corners;
            let [a, b, c] = [vertices[i], vertices[j], vertices[k]].map(Vector3::from);
            let d = [self.directions[i], self.directions[j], self.directions[k]];
            let ((e, f), (de, df)) = (((b - a) / unit, (c - a) / unit), (d[1] - d[0], d[2] - d[0]));
            let (still, linear, square) = (e.cross(&f), de.cross(&f) + e.cross(&df), de.cross(&df));
            for d in d {
                let root = first_root(d.dot(&still), d.dot(&linear), d.dot(&square));
                if 2.0 * root * unit < limit.thickness {
                    limit = Limit {
                        face,
                        thickness: 2.0 * root * unit,
                    };
                }
            }
            Ok(())
        })?;
        Ok(limit)
    }
}

/// The least |s| with `a + b s + c s² = 0`; zero where a is not positive.
#[inline]
fn first_root(a: f64, b: f64, c: f64) -> f64 {
    if a <= 0.0 {
        return 0.0;
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    // 2a/(b + √…): the smaller root, where nothing cancels.
    2.0 * a / (b.abs() + discriminant.sqrt())
}

// Whether faces are a surface: which corners are one, and how faces meet at their edges.

/// The number of the first vertex with the same coordinates (−0 is +0), for each vertex.
fn same_corners(
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
fn check_edges(
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    /// The surface of a cube of side 2 about the origin.
    fn cube() -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
        let vertices = (0..8)
            .map(|k| [k & 1, k >> 1 & 1, k >> 2].map(|bit| f64::from(2 * bit - 1)))
            .collect();
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let faces = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        (vertices, faces)
    }

    fn shell(faces: &[[usize; 3]], thickness: f64) -> Result<RigidBody, Halt<Error>> {
        let go_on = &mut |_| ControlFlow::Continue(());
        let (vertices, _) = cube();
        thick_shell(&vertices, faces, thickness, Amount::Density(1.0), go_on)
    }

    #[test]
    fn a_cubic_box_is_outer_minus_inner() {
        let (_, faces) = cube();
        for thickness in [1.0, 0.25, 2.0] {
            let (outer, inner) = (2.0 + thickness, 2.0 - thickness);
            let body = shell(&faces, thickness).expect("box");
            let (volume, moment) = (
                outer.powi(3) - inner.powi(3),
                (outer.powi(5) - inner.powi(5)) / 6.0,
            );
            assert!((body.mass() / volume - 1.0).abs() < 1e-15);
            for k in 0..3 {
                assert!((body.inertia()[(k, k)] / moment - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn too_thick_is_told() {
        let (_, faces) = cube();
        match shell(&faces, 2.1) {
            Err(Halt::Failed(Error::Mesh(MeshFault::TooThick { limit, .. }))) => {
                assert!((limit - 2.0).abs() < 1e-15, "{limit}");
            }
            other => panic!("expected a fold, got {other:?}"),
        }
    }

    #[test]
    fn one_sheet_is_a_plate() {
        let (_, faces) = cube();
        let body = shell(&faces[..2], 1e-9).expect("plate");
        assert!((body.mass() - 4e-9).abs() < 1e-23);
        let want = [4.0, 4.0, 8.0].map(|x| x / 3.0 * 1e-9);
        for (got, want) in body.principal().moments.iter().zip(want) {
            assert!((got / want - 1.0).abs() < 1e-14, "{got} {want}");
        }
    }

    #[test]
    fn roots() {
        assert_eq!(first_root(2.0, -3.0, 1.0), 1.0);
        assert_eq!(first_root(2.0, 3.0, 1.0), 1.0);
        assert_eq!(first_root(1.0, 0.0, 1.0), f64::INFINITY);
        assert_eq!(first_root(1.0, 0.0, -4.0), 0.5);
        assert_eq!(first_root(1.0, 0.0, 0.0), f64::INFINITY);
        assert_eq!(first_root(-1.0, 0.0, 0.0), 0.0);
    }

    fn direction(normals: &[[f64; 3]]) -> Vector3<f64> {
        let mut around = VertexFaces::default();
        let normals = normals.iter().map(|&n| Vector3::from(n).normalize());
        for normal in normals.clone() {
            around.add(&normal, 1.0);
        }
        around.middle = around.sum.normalize();
        for normal in normals {
            around.cosine = around.cosine.min(around.middle.dot(&normal));
        }
        let mut way = VertexDirection::default();
        around.set_way(&mut way);
        way.direction
    }

    #[test]
    fn up_to_three_planes_are_met_exactly() {
        let n = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.2, 1.0]];
        let d = direction(&n);
        for n in n {
            assert!((d.dot(&Vector3::from(n).normalize()) - 1.0).abs() < 1e-15);
        }
        let edge = direction(&[n[0], n[1], n[1]]);
        assert!((edge - Vector3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
        assert_eq!(direction(&[n[0]; 4]), Vector3::new(1.0, 0.0, 0.0));
    }

    #[test]
    fn planes_that_nearly_share_a_line_do_not_send_the_vertex_away() {
        // Three faces of a cylinder about z; rounding has tilted one of them.
        let n = [[0.1, 1.0, 0.0], [0.0, 1.0, 1e-5], [-0.1, 1.0, 0.0]];
        let d = direction(&n);
        assert!(d.z.abs() < 1e-4, "{d}");
        assert!((d.y - 1.0).abs() < 1e-2, "{d}");
    }
}
