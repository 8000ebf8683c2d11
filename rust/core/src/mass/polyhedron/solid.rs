//! The solid inside triangles, wherever they come from: sums, checks, and sums again where digits are lost.

use super::boundary::{Boundary, Marks, Replay, find_unbalanced};
use crate::error::{Corner, Error, MeshFault};
use crate::mass::amount::Amount;
use crate::mass::body::RigidBody;
use crate::mass::error_bound::{ErrorBound, UNIT};
use crate::mass::integrator::{is_settled, is_stout, sums_in_own_axes};
use crate::mass::provenance::{BodySource, Checks, MomentsFrom, Provenance};
use crate::mass::scaling::{QUANTUM, Units};
use crate::mass::second_moment::SecondMoment;
use crate::mass::simplex::{LocalFrame, Sums};
use crate::numerics::power_of_two::exponent;

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

/// What a solid is summed from, as often as its accuracy needs.
pub(super) trait Triangles: Replay<Error: From<Error>> {
    /// A frame that is mostly good enough, found without going through the triangles.
    fn first_frame(&mut self) -> Result<LocalFrame, Self::Error>;
    /// The frame of the corners that triangles use.
    fn box_frame(&mut self) -> Result<LocalFrame, Self::Error>;
    /// The tetrahedra from the reference to the triangles; with checks also what is known of the boundary.
    fn solid_sums(
        &mut self,
        frame: &LocalFrame,
        check: bool,
    ) -> Result<(Sums, Option<MarkedBoundary>), Self::Error>;
    /// The triangles as a shell.
    fn shell_sums(&mut self, frame: &LocalFrame) -> Result<Sums, Self::Error>;
    /// The first index that names no vertex, or the first coordinate that is not finite.
    fn find_unusable(&mut self) -> Result<Option<MeshFault>, Self::Error>;
    /// The component that is wound the wrong way, as far as can be told, and what has then been checked; with `sign` −1
    /// the whole is turned over.
    fn find_inside_out(&mut self, sign: f64) -> Result<(Option<MeshFault>, Checks), Self::Error>;
    /// A corner of a face as the user knows it.
    fn corner(&self, face: usize, position: &[f64; 3]) -> Corner;
}

/// The boundary of the triangles, and their marks.
pub(super) struct MarkedBoundary {
    pub(super) boundary: Boundary,
    pub(super) marks: Marks,
}

/// The solid inside some triangles, and its volume: negative where it was turned as a whole.
pub(super) fn solid<T: Triangles>(
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
        return Err(mesh_error(MeshFault::NoFaces));
    }
    if !sums.magnitude.is_finite()
        && let Some(fault) = triangles.find_unusable()?
    {
        return Err(mesh_error(fault));
    }
    match checked {
        None => checks = checks.and(Checks::UNCHECKED),
        Some(checked) => {
            checks = checks.and(check_boundary(triangles, checked)?);
            let sign = if sums.content < 0.0 { -1.0 } else { 1.0 };
            let (inside_out, nesting) = triangles.find_inside_out(sign)?;
            if let Some(fault) = inside_out {
                return Err(mesh_error(fault));
            }
            checks = checks.and(nesting);
        }
    }
    let mut moments = MomentsFrom::SecondMoment;
    if !is_ordinary(&sums) {
        moments = MomentsFrom::OwnAxes;
        sums = sums_from_shell(triangles)?;
    }
    let provenance = Provenance {
        moments,
        ..Provenance::of_matter(BodySource::Mesh, sums.count, checks)
    };
    let (body, volume) = body(&sums, amount, options.orient)?;
    if options.check {
        body.check_possible()?;
    }
    Ok((body.with_provenance(provenance), volume))
}

fn mesh_error<E: From<Error>>(fault: MeshFault) -> E {
    Error::from(fault).into()
}

/// Duplicates are told first: what stands twice is not balanced either.
fn check_boundary<T: Triangles>(
    triangles: &mut T,
    checked: MarkedBoundary,
) -> Result<Checks, T::Error> {
    let checks = Checks::CLOSED.and(Checks::WINDING).and(Checks::DUPLICATES);
    if let Some(fault) = checked.marks.find_duplicates(triangles)? {
        return Err(mesh_error(fault));
    }
    if checked.boundary.is_closed() {
        return Ok(checks);
    }
    let Some(fault) = find_unbalanced(triangles)? else {
        return Ok(checks);
    };
    let [from, to] = fault.ends.map(|end| triangles.corner(fault.face, &end));
    let (face, count) = (fault.face, fault.count);
    Err(mesh_error(match fault.second {
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
    sums.content.abs() > scale / 64.0 && scale.is_finite() && is_stout(sums)
}

/// The axes of the triangles as a shell, sums of positive numbers, are good even where the volume is lost to rounding.
fn sums_from_shell<T: Triangles>(triangles: &mut T) -> Result<Sums, T::Error> {
    let frame = triangles.box_frame()?;
    let shell = triangles.shell_sums(&frame)?;
    if !(shell.content > 0.0 && shell.content.is_finite()) {
        return Ok(triangles.solid_sums(&frame, false)?.0);
    }
    let again = |frame: &LocalFrame| Ok(triangles.solid_sums(frame, false)?.0);
    let is_good = |sums: &Sums| sums.content.abs() <= volume_error(sums) || is_settled(sums);
    sums_in_own_axes(shell.own_frame(), 4, again, is_good)
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

/// The body of uniform density with these sums, and its signed volume.
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
    Ok((matter(sums, mass, relative, bound, units)?, volume))
}

// The body of what was summed over simplices: solids, shells and wires.

/// The mass of what has these sums, whose content is counted in `2^content`, and its units.
pub(in crate::mass) fn in_units(
    sums: &Sums,
    content: i32,
    amount: Amount,
) -> Result<(f64, Units), Error> {
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
pub(in crate::mass) fn matter(
    sums: &Sums,
    mass: f64,
    relative: f64,
    bound: ErrorBound,
    units: Units,
) -> Result<RigidBody, Error> {
    let (unit, axes) = (sums.frame.unit, sums.frame.rotation());
    let center_of_mass = sums.frame.reference + axes * sums.center() * unit;
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
    units.in_user_units(&RigidBody::from_second_moment(&SecondMoment {
        mass,
        center_of_mass,
        central,
        axes,
        error_bound,
    })?)
}
