//! Shells of finite thickness: what a surface sweeps when its faces are moved to both sides.
//!
//! The mid-surface has corners v and, at each, a direction d (`offset`): at the distance s it has the corners `v + s d`,
//! and s runs over ±t/2. With the barycentric coordinates λ of a triangle, edges e and f,
//!
//! `∫ g dV = ∫ ds ∫ g(x) Σ λ_i J_i dλ`, `x = Σ λ_i (v_i + s d_i)`, `J_i = d_i · (e(s) × f(s))`,
//!
//! which is the solid between the outer and the inner offset, walls along the open rim included, without their difference:
//! all J are positive, so a shell as thin as you like keeps its digits. Over λ the integrals are closed forms, over s
//! polynomials of the fourth degree, for which three points of Gauss are exact.

mod edges;
mod offset;

use nalgebra::{Matrix3, Vector3};

use super::amount::Amount;
use super::body::RigidBody;
use super::error_bound::UNIT;
use super::polyhedron::{Index, View, is_settled};
use super::provenance::{Checks, MomentsFrom, Provenance, Source};
use super::simplex::{Frame, Sums};
use super::surface::finish;
use crate::error::{Error, MeshFault};
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::reduce::{block_sum, sum_blocks};
use crate::numerics::threads::{Halt, Watch};
use crate::principal::principal_axes;
use offset::{Offset, offset};

/// A shell of uniform density around a mid-surface, `thickness` from face to face: each face is moved by half of it to
/// both sides.
///
/// `amount` is the total mass or the mass per volume. The surface may be open, then walls along its rim join the two sides;
/// faces must be consistently wound, outward or inward. Sharp edges and corners are mitred: exact where at most three
/// planes meet. That the shell does not fold over itself is checked face by face; sheets far apart along the surface that
/// come to overlap count twice. `watch` is asked about every 20 ms whether to go on.
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
    let (sums, error, moments) = in_good_axes(&offset, vertices, thickness, frame, watch)?;
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
                ..Provenance::of_matter(Source::Surface, faces.len(), checks)
            })
        })
        .map_err(Halt::Failed)
}

/// The sums, taken again in the body's own axes where it is thin, and what rounding can have done to the volume.
fn in_good_axes(
    offset: &Offset,
    vertices: &[[f64; 3]],
    thickness: f64,
    mut frame: Frame,
    watch: &mut Watch<'_>,
) -> Result<(Sums, f64, MomentsFrom), Halt<Error>> {
    let mut moments = MomentsFrom::SecondMoment;
    for _ in 0..4 {
        let shell = Placed::new(offset, vertices, thickness, &frame);
        let (sums, error) = shell.sums(frame, watch)?;
        let central = principal_axes(&sums.central());
        let [thinnest, middle, longest] = central.moments;
        if thinnest + middle > 0.05 * longest
            || !sums.content.is_finite()
            || (moments == MomentsFrom::OwnAxes && is_settled(&sums))
        {
            return Ok((sums, error, moments));
        }
        moments = MomentsFrom::OwnAxes;
        frame = sums.own_frame(&central.axes);
    }
    let shell = Placed::new(offset, vertices, thickness, &frame);
    let (sums, error) = shell.sums(frame, watch)?;
    Ok((sums, error, moments))
}

/// A shell in the coordinates and the unit of a frame.
struct Placed<'a> {
    offset: &'a Offset,
    corners: Vec<Vector3<f64>>,
    directions: Vec<Vector3<f64>>,
    /// Half the thickness, and the same in its own power of two.
    half: f64,
    weight: f64,
    extent: Vector3<f64>,
}

/// Volume, first moment (3), second moment (6), what rounding can have done to the volume.
const TERMS: usize = 11;

impl<'a> Placed<'a> {
    fn new(offset: &'a Offset, vertices: &[[f64; 3]], thickness: f64, frame: &Frame) -> Self {
        let corners: Vec<Vector3<f64>> = vertices.iter().map(|r| frame.place(r)).collect();
        let directions: Vec<Vector3<f64>> = match &frame.axes {
            None => offset.directions.clone(),
            Some(axes) => offset.directions.iter().map(|d| axes.tr_mul(d)).collect(),
        };
        let half = 0.5 * thickness / frame.unit;
        let mut extent = Vector3::zeros();
        for &k in offset.faces.iter().flatten() {
            extent = extent.sup(&(corners[k].abs() + directions[k].abs() * half));
        }
        Self {
            offset,
            corners,
            directions,
            half,
            weight: 0.5 * times_power_of_two(thickness, -exponent(thickness)),
            extent,
        }
    }

    /// The integrals over the shell, and what rounding can have done to the volume.
    fn sums(&self, frame: Frame, watch: &mut Watch<'_>) -> Result<(Sums, f64), Halt<Error>> {
        let count = self.offset.faces.len();
        let [w, x, y, z, xx, xy, xz, yy, yz, zz, slack] = sum_blocks(count, watch, |range| {
            block_sum(range.start, range.end, &|face| self.terms(face))
        })
        .map_err(|_| Halt::Stopped)?;
        let sums = Sums {
            frame,
            count,
            content: w,
            magnitude: w,
            first: Vector3::new(x, y, z),
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            scale: Vector3::zeros(),
            extent: self.extent,
        };
        let error = 2.0 * (slack + sums.roundings() * w);
        Ok((sums, error))
    }

    /// What one face sweeps.
    fn terms(&self, face: usize) -> [f64; TERMS] {
        /// √(3/5), with the weight 5/9; the middle has 8/9.
        const NODE: f64 = 0.774_596_669_241_483_4;
        let corners = self.offset.faces[face];
        let (v, d) = (
            corners.map(|k| self.corners[k]),
            corners.map(|k| self.directions[k]),
        );
        let longest = d.iter().fold(0.0_f64, |longest, d| longest.max(d.norm()));
        let worst = corners
            .iter()
            .fold(0.0_f64, |worst, &k| worst.max(self.offset.errors[k]));
        let mut terms = [0.0; TERMS];
        for (node, weight) in [(-NODE, 5.0), (0.0, 8.0), (NODE, 5.0)] {
            let (s, weight) = (node * self.half, weight * self.weight / 9.0);
            let r = [0, 1, 2].map(|i| v[i] + d[i] * s);
            let (e, f) = (r[1] - r[0], r[2] - r[0]);
            let area = e.cross(&f);
            let j = d.map(|d| d.dot(&area));
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

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

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
}
