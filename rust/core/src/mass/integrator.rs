//! Matter is summed once in body axes and, where it is thin, again in its own axes.
//!
//! Across a thin direction the sums in body axes are differences of larger numbers, and lose digits. About the centre and
//! along the axes that the first pass found, nothing is lost but what those are off.
//!
//! Each kind of matter says how it is summed in a frame; whether it is summed again is decided here. Three kinds take only
//! a part: the solid inside triangles is read from files by a source that keeps its own errors, and begins with the axes of
//! its surface, so it takes [`sums_in_own_axes`]; a stack of particles has its tensors decomposed side by side, so it takes
//! [`is_thin`] and [`own_frame`]; the accumulator sees its particles once.

use super::body::RigidBody;
use super::provenance::{MomentsFrom, Provenance};
use super::second_moment::SecondMoment;
use super::simplex::{LocalFrame, Sums};
use crate::error::Error;
use crate::numerics::threads::Watch;
use crate::principal::{PrincipalAxes, principal_axes};

/// Matter that can be summed as often as its accuracy needs.
pub(super) trait Matter {
    /// [`SecondMoment`] or [`Sums`].
    type Moments;

    /// Compute the moments in a frame.
    ///
    /// # Errors
    /// When the matter is not what it must be, or `watch` stops the work.
    fn moments(&self, frame: &LocalFrame, watch: &mut Watch<'_>) -> Result<Self::Moments, Error>;
}

/// Below this ratio of smallest to largest principal moment a body is thin: the error of a pass in body axes is relative to
/// the largest one.
const THIN: f64 = 0.05;

/// Whether sums in body axes cost the smallest principal moment digits.
pub(super) fn is_thin(principal: &PrincipalAxes) -> bool {
    principal.moments[0] < THIN * principal.moments[2]
}

/// Whether sums in body axes are as good as any; the longest second moment stands for the largest principal moment.
pub(super) fn is_stout(sums: &Sums) -> bool {
    let [thinnest, middle, longest] = principal_axes(&sums.central()).moments; // of S
    thinnest + middle > THIN * longest
}

// Matter whose sums are a second moment: particles, voxels, tetrahedra.

/// The frame of a body's own axes and centre.
pub(super) fn own_frame(body: &RigidBody) -> LocalFrame {
    LocalFrame {
        axes: Some(body.principal().axes),
        ..LocalFrame::about(body.center_of_mass())
    }
}

/// The body of matter whose second moment in body axes is `first`.
#[inline]
pub(super) fn integrate<M: Matter<Moments = SecondMoment>>(
    matter: &M,
    first: &SecondMoment,
    provenance: Provenance,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    let body = RigidBody::from_second_moment(first)?;
    if !is_thin(&body.principal()) {
        return Ok(body.with_provenance(provenance));
    }
    let again = matter.moments(&own_frame(&body), watch)?;
    Ok(RigidBody::from_second_moment(&again)?.with_provenance(provenance.in_own_axes()))
}

// Matter whose sums keep their frame: wires, thin and thick shells, solids inside triangles.

/// The sums of matter that sums to `first` in body axes; with at most so many `passes` in own axes.
pub(super) fn integrate_sums<M: Matter<Moments = Sums>>(
    matter: &M,
    first: &Sums,
    passes: usize,
    watch: &mut Watch<'_>,
) -> Result<(Sums, MomentsFrom), Error> {
    if !first.content.is_finite() || is_stout(first) {
        return Ok((*first, MomentsFrom::SecondMoment));
    }
    let again = |frame: &LocalFrame| matter.moments(frame, watch);
    let sums = sums_in_own_axes(first.own_frame(), passes, again, is_settled)?;
    Ok((sums, MomentsFrom::OwnAxes))
}

/// The sums in own axes, of which `frame` has the first: each pass multiplies their accuracy, until one `is_good`.
pub(super) fn sums_in_own_axes<E>(
    mut frame: LocalFrame,
    passes: usize,
    mut moments: impl FnMut(&LocalFrame) -> Result<Sums, E>,
    is_good: impl Fn(&Sums) -> bool,
) -> Result<Sums, E> {
    for _ in 1..passes {
        let sums = moments(&frame)?;
        if is_good(&sums) {
            return Ok(sums);
        }
        frame = sums.own_frame();
    }
    moments(&frame)
}

/// Whether the frame is the body's own to a tenth: another turn would save no digits.
pub(super) fn is_settled(sums: &Sums) -> bool {
    let (s, c) = (sums.central(), sums.center());
    [(0, 1), (0, 2), (1, 2)]
        .iter()
        .all(|&(i, j)| s[(i, j)].powi(2) <= 0.01 * s[(i, i)] * s[(j, j)])
        && (0..3).all(|k| c[k].powi(2) <= s[(k, k)])
}
