//! Solids bounded by a closed triangle mesh.
//!
//! The divergence theorem turns the volume integrals into sums over triangles: each triangle (a, b, c) spans a signed
//! tetrahedron with a reference point, of volume `a·((b − a)×(c − a))/6`. The sums are those of the solid only when the
//! mesh is closed and consistently wound; an open mesh would give numbers that depend on where it stands, so it is refused.
//!
//! | what | file |
//! |---|---|
//! | whether the mesh is closed, and the edge at which it is not | `boundary` |
//! | faces that stand twice | `duplicates` |
//! | which components lie in which | `nesting` |
//! | what is told of a mesh that bounds no solid | [`fault`] |
//! | meshes in memory | `triangles` |
//! | meshes larger than memory | [`streamed`] |
//! | open meshes closed on request | [`closure`] |

mod boundary;
pub mod closure;
mod duplicates;
pub mod fault;
mod nesting;
pub mod streamed;
mod triangles;

use std::ops::ControlFlow;

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::provenance::{Checks, MomentsFrom, Provenance, Source};
use super::second_moment::SecondMoment;
use super::simplex::{Frame, Sums};
use super::solids::Amount;
use super::units::{QUANTUM, Units};
use crate::error::Error;
use crate::numerics::power_of_two::exponent;
use crate::numerics::threads::{Halt, Watch};
use crate::principal::principal_axes;
use boundary::{Boundary, Replay, find_unbalanced};
use duplicates::Marks;
use fault::Corner;
pub use fault::MeshFault;
pub(super) use nesting::find_components;
use triangles::Faces;
pub use triangles::Index;
pub(super) use triangles::{View, widen};

/// What to make of a mesh that is not as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Turn a mesh whose normals all point inward; else it is an error.
    pub orient: bool,
    /// Check that the mesh is closed, consistently wound and without duplicate faces. Without it indices and coordinates
    /// are still checked, and a mesh that is not closed gives numbers that mean nothing.
    pub check: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            orient: false,
            check: true,
        }
    }
}

/// A solid of uniform density bounded by a closed, consistently wound triangle mesh.
///
/// `faces` count vertices from zero, counter-clockwise seen from outside. Vertices with the same coordinates are one
/// vertex. With `orient` an inverted mesh is turned, and so is a component that is wound like a cavity but lies in no other;
/// else it is an error. Several components and cavities (inner surfaces wound inward) are counted as they are.
///
/// # Errors
/// [`MeshFault`] names the face, edge or vertex that keeps the mesh from bounding a solid.
pub fn polyhedron<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    orient: bool,
) -> Result<RigidBody, Error> {
    let options = Options {
        orient,
        ..Options::default()
    };
    let go_on = &mut |_| ControlFlow::Continue(());
    Ok(polyhedron_watched(vertices, faces, amount, options, go_on)?)
}

/// The same on several threads when the mesh is large, with `watch` asked about every 20 ms whether to go on.
///
/// # Errors
/// As [`polyhedron`], and [`Halt::Stopped`] where `watch` said so.
pub fn polyhedron_watched<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    options: Options,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Halt<Error>> {
    solid_of_faces(vertices, faces, amount, options, watch).map(|(body, _)| body)
}

/// The solid inside triangles in memory, components turned where that is asked for, and its volume.
fn solid_of_faces<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    options: Options,
    watch: &mut Watch<'_>,
) -> Result<(RigidBody, f64), Halt<Error>> {
    let mut mesh = Faces::new(vertices, faces, watch);
    let outcome = solid(&mut mesh, amount, options);
    match mesh.inside_out {
        Some(found) if options.orient => {
            let faces = found.turned(faces);
            solid(&mut Faces::new(vertices, &faces, watch), amount, options)
        }
        _ => outcome,
    }
}

/// What a solid is summed from, as often as its accuracy needs.
trait Triangles: Replay<Error: From<Error>> {
    /// A frame that is mostly good enough, found without going through the triangles.
    fn first_frame(&mut self) -> Result<Frame, Self::Error>;
    /// The frame of the corners that triangles use.
    fn box_frame(&mut self) -> Result<Frame, Self::Error>;
    /// The tetrahedra from the reference to the triangles; with checks also what is known of the boundary.
    fn solid_sums(
        &mut self,
        frame: &Frame,
        check: bool,
    ) -> Result<(Sums, Option<Checked>), Self::Error>;
    /// The triangles as a shell.
    fn shell_sums(&mut self, frame: &Frame) -> Result<Sums, Self::Error>;
    /// The first index or coordinate that is none.
    fn find_unusable(&mut self) -> Result<Option<MeshFault>, Self::Error>;
    /// The component that is wound the wrong way, as far as can be told, and what has then been checked; with `sign` −1
    /// the whole is turned over.
    fn find_inside_out(&mut self, sign: f64) -> Result<(Option<MeshFault>, Checks), Self::Error>;
    /// A corner of a face as the user knows it.
    fn corner(&self, face: usize, position: &[f64; 3]) -> Corner;
}

/// The boundary of the triangles, and their marks.
struct Checked {
    boundary: Boundary,
    marks: Marks,
}

/// The sums again in the body's own axes are repeated at most this often; each time multiplies the accuracy of the axes.
const AGAIN: usize = 4;

/// The solid inside some triangles, and its volume.
fn solid<T: Triangles>(
    triangles: &mut T,
    amount: Amount,
    options: Options,
) -> Result<(RigidBody, f64), T::Error> {
    let frame = triangles.first_frame()?;
    let (mut sums, checked) = triangles.solid_sums(&frame, options.check)?;
    let mut checks = Checks::INDICES
        .and(Checks::FINITE)
        .and(Checks::ORIENTATION)
        .and(Checks::VOLUME);
    if sums.count == 0 {
        return Err(failed(MeshFault::NoFaces));
    }
    if !sums.magnitude.is_finite()
        && let Some(fault) = triangles.find_unusable()?
    {
        return Err(failed(fault));
    }
    match checked {
        None => checks = checks.and(Checks::UNCHECKED),
        Some(checked) => {
            checks = checks.and(check_boundary(triangles, checked)?);
            let sign = if sums.content < 0.0 { -1.0 } else { 1.0 };
            let (inside_out, nesting) = triangles.find_inside_out(sign)?;
            if let Some(fault) = inside_out {
                return Err(failed(fault));
            }
            checks = checks.and(nesting);
        }
    }
    let mut moments = MomentsFrom::SecondMoment;
    if !is_ordinary(&sums) {
        moments = MomentsFrom::OwnAxes;
        sums = sums_in_own_axes(triangles)?;
    }
    let provenance = Provenance {
        moments,
        ..Provenance::of_matter(Source::Mesh, sums.count, checks)
    };
    let (body, volume) = body(&sums, amount, options.orient)?;
    if options.check {
        body.check_possible()?;
    }
    Ok((body.with_provenance(provenance), volume))
}

fn failed<E: From<Error>>(fault: MeshFault) -> E {
    Error::from(fault).into()
}

/// Duplicates are told first: what stands twice is not balanced either.
fn check_boundary<T: Triangles>(triangles: &mut T, checked: Checked) -> Result<Checks, T::Error> {
    let checks = Checks::CLOSED.and(Checks::WINDING).and(Checks::DUPLICATES);
    if let Some(fault) = checked.marks.find_duplicates(triangles)? {
        return Err(failed(fault));
    }
    if checked.boundary.is_closed() {
        return Ok(checks);
    }
    let Some(fault) = find_unbalanced(triangles)? else {
        return Ok(checks);
    };
    let [from, to] = fault.ends.map(|end| triangles.corner(fault.face, &end));
    let (face, count) = (fault.face, fault.count);
    Err(failed(match fault.second {
        Some(second) => MeshFault::InconsistentWinding {
            from,
            to,
            first: face,
            second,
            count,
        },
        None => MeshFault::Open {
            from,
            to,
            face,
            count,
        },
    }))
}

/// Whether the sums in body axes are as good as any: a body that is thin, small beside the box of all vertices or full of
/// folds loses digits in them.
fn is_ordinary(sums: &Sums) -> bool {
    let scale = sums.extent.dot(&sums.scale);
    if !(sums.content.abs() > scale / 64.0 && scale.is_finite()) {
        return false;
    }
    let moments = principal_axes(&sums.central()).moments; // of S: from the thinnest direction to the longest
    moments[0] + moments[1] > 0.05 * moments[2]
}

/// The axes of the triangles as a shell, sums of positive numbers, are good even where the volume is lost to rounding.
fn sums_in_own_axes<T: Triangles>(triangles: &mut T) -> Result<Sums, T::Error> {
    let frame = triangles.box_frame()?;
    let shell = triangles.shell_sums(&frame)?;
    if !(shell.content > 0.0 && shell.content.is_finite()) {
        return Ok(triangles.solid_sums(&frame, false)?.0);
    }
    let mut frame = shell.own_frame(&principal_axes(&shell.central()).axes);
    for _ in 1..AGAIN {
        let sums = triangles.solid_sums(&frame, false)?.0;
        if sums.content.abs() <= volume_error(&sums) || is_settled(&sums) {
            return Ok(sums);
        }
        frame = sums.own_frame(&principal_axes(&sums.central()).axes);
    }
    Ok(triangles.solid_sums(&frame, false)?.0)
}

/// Whether the frame is the body's own to a tenth: another turn would save no digits.
pub(super) fn is_settled(sums: &Sums) -> bool {
    let (s, c) = (sums.central(), sums.center());
    [(0, 1), (0, 2), (1, 2)]
        .iter()
        .all(|&(i, j)| s[(i, j)].powi(2) <= 0.01 * s[(i, i)] * s[(j, j)])
        && (0..3).all(|k| c[k].powi(2) <= s[(k, k)])
}

/// What rounding can have done to the volume, in units of the frame.
///
/// Each corner is off by a unit of rounding of its coordinates, which moves the faces; each tetrahedron is off by a few
/// units of the products in it, which are below the extent times `scale`; and each is rounded on its way to the total. What
/// underflows in a unit of the body's size is some least steps of each tetrahedron.
fn volume_error(sums: &Sums) -> f64 {
    let extent = sums.extent.add_scalar(32.0 * UNIT * sums.extent.sum());
    2.0 * (sums.roundings() * sums.magnitude + 24.0 * UNIT * extent.dot(&sums.scale))
        + 64.0 * QUANTUM * sums.count as f64
}

/// The body of uniform density with these sums, and its volume.
fn body(sums: &Sums, amount: Amount, orient: bool) -> Result<(RigidBody, f64), Error> {
    let unit = sums.frame.unit;
    let volume = sums.content * unit * unit * unit;
    let size = 2.0 * sums.extent.max() * unit;
    let error = volume_error(sums);
    if sums.content.abs() <= error || sums.content.is_nan() {
        return Err(MeshFault::NoVolume { volume, size }.into());
    }
    if sums.content < 0.0 && !orient {
        return Err(MeshFault::Inverted { volume }.into());
    }
    let (mass, units) = in_units(sums, 3 * exponent(sums.frame.unit), amount)?;
    let relative = error / sums.content.abs();
    let bound = ErrorBound {
        mass: match amount {
            Amount::Mass(_) => 0.0,
            Amount::Density(_) => mass * (relative + 16.0 * UNIT),
        },
        ..ErrorBound::default()
    };
    Ok((matter(sums, mass, relative, bound, units)?, volume.abs()))
}

/// The mass of what has these sums, whose content is counted in `2^content`, and its units.
pub(super) fn in_units(sums: &Sums, content: i32, amount: Amount) -> Result<(f64, Units), Error> {
    let length = exponent(sums.frame.unit);
    let (mass, power) = amount.mass_in_units(sums.content.abs())?;
    let of_content = match amount {
        Amount::Mass(_) => 0,
        Amount::Density(_) => content,
    };
    let units = Units {
        mass: power + of_content,
        length,
        place: 0,
    };
    Ok((mass, units))
}

/// The body of this mass with these sums, whose content is known to `relative`.
pub(super) fn matter(
    sums: &Sums,
    mass: f64,
    relative: f64,
    bound: ErrorBound,
    units: Units,
) -> Result<RigidBody, Error> {
    let Frame {
        reference,
        unit,
        axes,
    } = sums.frame;
    let axes_or = axes.unwrap_or_else(nalgebra::Matrix3::identity);
    let center_of_mass = reference + axes_or * sums.center() * unit;
    let central = sums.central() * mass;
    // First and second moments are off by as much as the content, times the extent once and twice.
    let extent = sums.extent.norm();
    let error_bound = ErrorBound {
        center_of_mass: 2.0 * (relative + 16.0 * UNIT) * extent * unit
            + 4.0 * UNIT * center_of_mass.amax()
            + QUANTUM,
        inertia: 10.0 * (relative + 16.0 * UNIT) * mass * extent.powi(2),
        ..bound
    };
    units.told(&RigidBody::from_second_moment(&SecondMoment {
        mass,
        center_of_mass,
        central,
        axes: axes_or,
        error_bound,
    })?)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::mass::polyhedron::fault::Count;

    const TETRAHEDRON: ([[f64; 3]; 4], [[usize; 3]; 4]) = (
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ],
        [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    );

    #[test]
    fn unit_tetrahedron() {
        let (vertices, faces) = TETRAHEDRON;
        let body = polyhedron(&vertices, &faces, Amount::Density(6.0), false).expect("closed");
        assert!((body.mass() - 1.0).abs() < 1e-15);
        assert!((body.center_of_mass() - Vector3::repeat(0.25)).norm() < 1e-15);
        // ∫x² = 1/10 and ∫xy = 1/20 of the mass about the corner.
        let corner = body.inertia_about(&Vector3::zeros());
        assert!((corner[(0, 0)] - 0.2).abs() < 1e-15);
        assert!((corner[(0, 1)] + 0.05).abs() < 1e-15);
    }

    #[test]
    fn faults_are_told_apart() {
        let (vertices, faces) = TETRAHEDRON;
        let fault =
            |faces: &[[usize; 3]]| match polyhedron(&vertices, faces, Amount::Mass(1.0), false) {
                Err(Error::Mesh(fault)) => fault,
                other => panic!("expected a mesh fault, got {other:?}"),
            };
        assert!(matches!(
            fault(&faces[..3]),
            MeshFault::Open {
                count: Count { seen: 3, .. },
                ..
            }
        ));
        let mut flipped = faces;
        flipped[3].swap(0, 1);
        assert!(matches!(
            fault(&flipped),
            MeshFault::InconsistentWinding {
                count: Count { seen: 3, .. },
                ..
            }
        ));
        let inverted = faces.map(|[a, b, c]| [b, a, c]);
        assert!(matches!(fault(&inverted), MeshFault::Inverted { .. }));
        assert!(polyhedron(&vertices, &inverted, Amount::Mass(1.0), true).is_ok());
        assert!(matches!(
            fault(&[[0, 1, 4]]),
            MeshFault::IndexOutOfRange {
                face: 0,
                index: 4,
                ..
            }
        ));
        assert!(matches!(
            fault(&[[0, 1, 2], [0, 2, 1]]),
            MeshFault::NoVolume { .. }
        ));
    }

    #[test]
    fn triangle_soup_is_welded_by_equal_coordinates() {
        let (vertices, faces) = TETRAHEDRON;
        let soup: Vec<[f64; 3]> = faces.iter().flatten().map(|&k| vertices[k]).collect();
        let corners: Vec<[usize; 3]> = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let body = polyhedron(&soup, &corners, Amount::Density(6.0), false).expect("closed");
        assert!((body.mass() - 1.0).abs() < 1e-15);
    }
}
