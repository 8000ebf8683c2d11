//! The body of a shell: what is asked of its mid-surface and its thickness, and the axes its integrals are taken in.

use super::offset::{Offset, offset};
use super::placed::Placed;
use crate::error::{Error, MeshFault};
use crate::mass::amount::Amount;
use crate::mass::body::RigidBody;
use crate::mass::polyhedron::{Index, View, is_settled};
use crate::mass::provenance::{Checks, MomentsFrom, Provenance, Source};
use crate::mass::simplex::{LocalFrame, Sums};
use crate::mass::surface::finish;
use crate::numerics::power_of_two::exponent;
use crate::numerics::threads::{Halt, Watch};
use crate::principal::principal_axes;

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
    mut frame: LocalFrame,
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
