//! Thin shells: triangles, open or closed, with a mass per area.

use std::marker::PhantomData;

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::integrator::{Matter, integrate_sums};
use super::polyhedron::{Index, View, in_units, matter};
use super::provenance::{BodySource, Checks, MomentsFrom, Provenance};
use super::scaling::QUANTUM;
use super::simplex::{Corners, FaintShell, Kind, LocalFrame, Shell, Sums, sums};
use super::solids::Amount;
use crate::error::{Error, MeshFault};
use crate::numerics::power_of_two::exponent;
use crate::numerics::threads::{Halt, Watch};

/// A thin shell of uniform mass per area: `∫ r rᵀ dm = σ A (a aᵀ + b bᵀ + c cᵀ + s sᵀ)/12` for a triangle (a, b, c) of
/// area A, `s = a + b + c`.
///
/// `amount` is the total mass or the mass per area σ. Open or closed, the winding does not matter. `watch` is asked about
/// every 20 ms whether to go on.
///
/// # Examples
///
/// ```
/// use polhode::mass::Amount;
/// use polhode::mass::surface::surface;
/// use std::ops::ControlFlow;
///
/// let square = [[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
/// let faces = [[0_usize, 1, 2], [0, 2, 3]];
/// let sheet = surface(&square, &faces, Amount::Mass(3.0), &mut |_| ControlFlow::Continue(())).unwrap();
/// assert!((sheet.principal().moments[2] - 2.0).abs() < 1e-14); // m (a² + b²)/12
/// ```
///
/// # Errors
/// [`MeshFault`] when a face names no vertex, a coordinate is not finite or there is no area; [`Halt::Stopped`] where
/// `watch` said so.
pub fn surface<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Halt<Error>> {
    let mesh = View { vertices, faces };
    let failed = |fault: MeshFault| Halt::Failed(fault.into());
    if faces.is_empty() {
        return Err(failed(MeshFault::NoFaces));
    }
    let (mut sums, mut moments) =
        thin::<_, Shell, 3>(&mesh, &mesh.frame(), || mesh.used_frame(), watch)?;
    // A normal below 2⁻⁵³⁷ vanishes in its square: then most of this area may have.
    if sums.content < faces.len() as f64 * 2.0_f64.powi(-470) {
        (sums, moments) =
            thin::<_, FaintShell, 3>(&mesh, &mesh.frame(), || mesh.used_frame(), watch)?;
    }
    if !sums.magnitude.is_finite()
        && let Some(fault) = mesh.find_unusable()
    {
        return Err(failed(fault));
    }
    let unit = sums.frame.unit;
    let area = sums.content * unit * unit;
    if sums.content <= 0.0 || sums.content.is_nan() {
        let faces = faces.len();
        return Err(failed(MeshFault::NoArea { area, faces }));
    }
    // The normal of a triangle is off by a few units of rounding of its products; its corners by one of the extent.
    let error = sums.roundings() * sums.content
        + UNIT * (8.0 * sums.scale.x + 8.0 * sums.extent.max() * sums.scale.y)
        + 8.0 * QUANTUM * faces.len() as f64;
    let checks = Checks::INDICES.and(Checks::FINITE).and(Checks::VOLUME);
    let area = 2 * exponent(sums.frame.unit);
    finish(&sums, area, 2.0 * error, amount)
        .map(|body| {
            body.with_provenance(Provenance {
                moments,
                ..Provenance::of_matter(BodySource::Surface, faces.len(), checks)
            })
        })
        .map_err(Halt::Failed)
}

/// Area of a triangle mesh, open or closed.
///
/// # Examples
///
/// ```
/// use polhode::mass::surface::area;
/// use std::ops::ControlFlow;
///
/// let triangle = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// assert_eq!(area(&triangle, &[[0_usize, 1, 2]], &mut |_| ControlFlow::Continue(()))?, 6.0);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a face names no vertex or a coordinate is not finite; [`Error::Stopped`] where `watch` said so.
pub fn area<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    watch: &mut Watch<'_>,
) -> Result<f64, Error> {
    let mesh = View { vertices, faces };
    if faces.is_empty() {
        return Err(MeshFault::NoFaces.into());
    }
    let frame = mesh.frame();
    let area = sums::<_, Shell, 3>(&mesh, &frame, watch)?.content;
    if !area.is_finite()
        && let Some(fault) = mesh.find_unusable()
    {
        return Err(fault.into());
    }
    Ok(area * frame.unit * frame.unit)
}

/// Sums of positive terms, taken again in the body's own axes where it is thin: shells and wires.
pub(super) fn thin<C: Corners<N>, K: Kind<N>, const N: usize>(
    corners: &C,
    first: &LocalFrame,
    used: impl FnOnce() -> LocalFrame,
    watch: &mut Watch<'_>,
) -> Result<(Sums, MomentsFrom), Error> {
    let simplices = Simplices::<C, K, N>(corners, PhantomData);
    let mut found = simplices.moments(first, watch)?;
    let is_near = |sums: &Sums| {
        let size = sums.central().trace();
        size.is_finite() && sums.center().norm_squared() <= 16.0 * size && size > 1e-6
    };
    if !is_near(&found) {
        found = simplices.moments(&used(), watch)?;
    }
    integrate_sums(&simplices, &found, 3, watch)
}

/// Simplices of one kind.
struct Simplices<'a, C, K, const N: usize>(&'a C, PhantomData<K>);

impl<C: Corners<N>, K: Kind<N>, const N: usize> Matter for Simplices<'_, C, K, N> {
    type Moments = Sums;

    fn moments(&self, frame: &LocalFrame, watch: &mut Watch<'_>) -> Result<Sums, Error> {
        sums::<C, K, N>(self.0, frame, watch)
    }
}

/// The body of these sums, whose content, a length, area or volume by its `dimension`, is off by `error` in the unit of the
/// frame.
pub(super) fn finish(
    sums: &Sums,
    content: i32,
    error: f64,
    amount: Amount,
) -> Result<RigidBody, Error> {
    let (mass, units) = in_units(sums, content, amount)?;
    let relative = error / sums.content;
    let bound = ErrorBound {
        mass: match amount {
            Amount::Mass(_) => 0.0,
            Amount::Density(_) => mass * (relative + 16.0 * UNIT),
        },
        ..ErrorBound::default()
    };
    matter(sums, mass, relative, bound, units)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use std::ops::ControlFlow;

    use super::*;

    #[test]
    fn hollow_cube() {
        // Six plates m/6 each: I = 5/18 m a².
        let vertices: Vec<[f64; 3]> = (0..8)
            .map(|k| [k & 1, k >> 1 & 1, k >> 2].map(f64::from))
            .collect();
        let quads = [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ];
        let faces: Vec<[usize; 3]> = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        let go_on = &mut |_| ControlFlow::Continue(());
        let body = surface(&vertices, &faces, Amount::Density(3.0), go_on).expect("shell");
        assert!((body.mass() - 18.0).abs() < 1e-14);
        assert!((body.center_of_mass() - Vector3::repeat(0.5)).norm() < 1e-15);
        assert!((body.principal().moments[0] - 5.0).abs() < 1e-14);
        let go_on = &mut |_| ControlFlow::Continue(());
        assert!((area(&vertices, &faces, go_on).expect("area") - 6.0).abs() < 1e-15);
    }
}
