//! The body that fills a region with a density.

use nalgebra::Matrix3;

use super::effort::{Effort, Estimate, JUMP};
use super::matter::Matter;
use super::scaled::Scaled;
use super::total::Total;
use crate::error::{BodyFault, Error};
use crate::mass::body::RigidBody;
use crate::mass::error_bound::{ErrorBound, UNIT};
use crate::mass::provenance::{Checks, Provenance, Source};
use crate::mass::regions::Region;
use crate::mass::second_moment::SecondMoment;
use crate::mass::units::Units;
use crate::numerics::quadrature::integrate;
use crate::numerics::reduce::depth;

/// The body that fills a region with the density `ρ(r)`, given at many points at once.
///
/// The density should be smooth within the region, on the scale of some tenth of it to be noticed at all; a jump belongs
/// on the boundary, which may mean several regions whose bodies are added. A jump inside is noticed and counted in the error:
/// one along the faces of the charts (a plane across a box, a sphere about the centre of a ball) is found to any tolerance,
/// one across them to a few digits. In a mesh whose parts are not star-shaped about their
/// middles the density is also asked for outside, where the signed parts cancel.
///
/// # Errors
/// When a value is negative or not finite; where the evaluations do not suffice, [`Estimate::converged`] says so;
/// [`BodyFault::TriangleInequality`] where surfaces of a mesh cross so that no masses have its moments; whatever the density itself fails with.
pub fn from_density<E: From<Error>>(
    region: &Region,
    density: impl FnMut(&[[f64; 3]], &mut [f64]) -> Result<(), E>,
    effort: Effort,
) -> Result<Estimate, E> {
    let (region, length) = region.in_units();
    let region = &region;
    let (cells, rule) = (region.cells(), region.rule());
    let effort = effort.check(cells.len() * rule.points::<3>())?;
    let mut matter = Matter {
        region,
        density: Scaled::of(density),
        length,
    };
    let found = integrate(
        &mut matter,
        &cells,
        &rule,
        effort.rtol,
        effort.max_evaluations,
    )?;
    let total = Total::of(region, &found.leaves);
    if total.mass <= 0.0 {
        let (count, mass) = (found.evaluations, total.mass);
        return Err(Error::from(BodyFault::NoMassFound { count, mass }).into());
    }
    // An error without limit is told by the estimate's own bounds, which are numbers.
    let error = (JUMP * found.error).min(f64::MAX);
    let rounding = 2.0 * UNIT * (depth(found.evaluations) + 32.0);
    let (width, spread) = (total.width(), total.second.trace().max(0.0));
    let sizes = &total.sizes;
    let reach = (sizes.mass / total.mass * (sizes.spread / total.mass)).sqrt();
    // Points are rounded to the last place of their coordinates.
    let place = 8.0 * UNIT * (sizes.first / total.mass + reach);
    let center_of_mass = error * width + rounding * reach + place;
    let body = RigidBody::from_second_moment(&SecondMoment {
        mass: total.mass,
        center_of_mass: total.center,
        central: total.second,
        axes: Matrix3::identity(),
        error_bound: ErrorBound {
            mass: error * total.mass + rounding * sizes.mass,
            center_of_mass,
            inertia: 2.0
                * (error * spread + rounding * sizes.spread + total.mass * place * (reach + place)),
        },
    })?;
    let provenance = Provenance::of_matter(Source::Density, found.evaluations, Checks::FINITE);
    let units = Units {
        mass: 3 * length + matter.density.power,
        length,
        place: length,
    };
    body.check_possible()?;
    let body = units.told(&body.with_provenance(provenance))?;
    // Signed charts that cancel one another leave less than they have.
    let cancelled = rounding * (sizes.mass / total.mass).max(sizes.spread / spread) - rounding;
    let error = if cancelled.is_nan() {
        found.error
    } else {
        found.error + cancelled
    };
    Ok(Estimate {
        body,
        error,
        rtol: effort.rtol,
        evaluations: found.evaluations,
    })
}
