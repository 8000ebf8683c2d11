//! Where a vertex of a mid-surface goes when its faces are moved along their normals, and how far they may be moved.

use nalgebra::{Matrix3, Vector3};

use super::edges::{check_edges, same_corners};
use crate::error::MeshFault;
use crate::mass::error_bound::UNIT;
use crate::mass::polyhedron::{Index, View};
use crate::numerics::split_vector::{SplitVector, cross};
use crate::numerics::threads::{Halt, Watch, each_watched};
use crate::principal::{PrincipalAxes, principal_axes};

/// Directions in which the normals at a vertex spread by less than the root of this leave it where it is: they are one
/// plane.
const FLAT: f64 = 1e-12;

/// How often the directions are made better.
const REFINED: usize = 2;

/// A surface whose vertices know their way.
pub(super) struct Offset {
    /// Three different corners each; corners with equal coordinates have one number.
    pub(super) faces: Vec<[usize; 3]>,
    /// Which face of the mesh each of them is.
    pub(super) numbers: Vec<usize>,
    /// d of each vertex: it goes to `v + s d` when its faces are moved by s.
    pub(super) directions: Vec<Vector3<f64>>,
    /// What rounding can have done to the length of each d.
    pub(super) errors: Vec<f64>,
}

/// The directions of a surface that is consistently wound and has at most two faces at an edge; lengths are divided by
/// `unit`, a power of two.
///
/// With unit normals n of the faces at a vertex, weighted by their angles w there, d makes `Σ w (n·d − 1)²` least and is
/// the shortest that does: where at most three planes meet, or all of them touch one cone, each face moves by exactly s.
/// On a finer and finer mesh of a smooth surface they do so to the second order in the size of the triangles.
pub(super) fn offset<I: Index>(
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

    let mut around = vec![Around::default(); mesh.vertices.len()];
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
    let mut ways = vec![Way::default(); around.len()];
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
    let errors = ways.iter().map(Way::error).collect();
    Ok(Offset {
        faces,
        numbers,
        directions,
        errors,
    })
}

/// The faces around a vertex.
#[derive(Clone, Copy)]
struct Around {
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

impl Default for Around {
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

impl Around {
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
    fn set_way(&self, way: &mut Way) {
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
struct Way {
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

impl Way {
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
pub(super) struct Limit {
    pub(super) face: usize,
    pub(super) thickness: f64,
}

impl Offset {
    /// How thick the shell may be: up to there `J_i(s) = d_i · ((e + s e′) × (f + s f′))` is positive at each corner i of
    /// each face, for |s| up to half the thickness, with e, f the edges and e′, f′ those between the d.
    ///
    /// J is the volume that the surface sweeps for each ds, and linear between the corners.
    pub(super) fn limit(
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

#[cfg(test)]
mod tests {
    use super::*;

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
        let mut around = Around::default();
        let normals = normals.iter().map(|&n| Vector3::from(n).normalize());
        for normal in normals.clone() {
            around.add(&normal, 1.0);
        }
        around.middle = around.sum.normalize();
        for normal in normals {
            around.cosine = around.cosine.min(around.middle.dot(&normal));
        }
        let mut way = Way::default();
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
