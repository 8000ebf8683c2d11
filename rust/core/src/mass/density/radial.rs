//! Balls whose density depends on the distance from their centre alone.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

use super::effort::{Effort, Estimate, JUMP};
use super::scaled::Scaled;
use crate::error::{BodyFault, Error, finite};
use crate::mass::amount;
use crate::mass::body::RigidBody;
use crate::mass::error_bound::{ErrorBound, UNIT};
use crate::mass::provenance::{Checks, Provenance, Source};
use crate::mass::second_moment::SecondMoment;
use crate::mass::units::Units;
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::quadrature::{Cell, Integrand, Leaf, Rule, integrate};
use crate::numerics::reduce::{depth, sum_terms};

/// The ball whose density `ρ(r)` depends on the distance from its centre alone, between the radii in `boundaries`:
/// `m = 4π ∫ ρ r² dr`, `I = (8π/3) ∫ ρ r⁴ dr`. The density may jump at each of them.
///
/// # Examples
///
/// ```
/// use polhode::Error;
/// use polhode::mass::density::{Effort, from_radial_density};
///
/// // A ball of radius 2 and density r: m = ∫ 4π r² r dr = 16 π.
/// let density = |r: &[f64], out: &mut [f64]| {
///     out.copy_from_slice(r);
///     Ok::<_, Error>(())
/// };
/// let effort = Effort { rtol: 1e-10, max_evaluations: 10_000 };
/// let ball = from_radial_density(&[0.0, 2.0], density, effort)?.converged()?;
/// assert!((ball.mass() - 16.0 * std::f64::consts::PI).abs() < 1e-8);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// As of [`super::from_density`]; when the boundaries do not ascend from zero or more.
pub fn from_radial_density<E: From<Error>>(
    boundaries: &[f64],
    density: impl FnMut(&[f64], &mut [f64]) -> Result<(), E>,
    effort: Effort,
) -> Result<Estimate, E> {
    for (&r, next) in boundaries.iter().zip(boundaries.iter().skip(1)) {
        amount::length("radius", r)?;
        finite("radius", *next)?;
        if r >= *next {
            let (smaller, a) = ("each radius", r);
            let (larger, b) = ("the next", *next);
            return Err(Error::NotBelow {
                smaller,
                a,
                larger,
                b,
            }
            .into());
        }
    }
    let length = exponent(boundaries.last().copied().unwrap_or_default());
    let own: Vec<f64> = boundaries
        .iter()
        .map(|&r| times_power_of_two(r, -length))
        .collect();
    let cells: Vec<Cell<1>> = own
        .windows(2)
        .map(|ends| Cell {
            chart: 0,
            low: [ends[0]],
            high: [ends[1]],
        })
        .collect();
    let rule = Rule::fifteen();
    let effort = effort.check(cells.len() * rule.points::<1>())?;
    let mut matter = Radial {
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
    let [m, s] = radial_totals(&found.leaves);
    let (mass, along) = (4.0 * PI * m, 4.0 / 3.0 * PI * s);
    if mass <= 0.0 {
        let count = found.evaluations;
        return Err(Error::from(BodyFault::NoMassFound { count, mass }).into());
    }
    let relative = JUMP * found.error + 2.0 * UNIT * (depth(found.evaluations) + 32.0);
    let body = RigidBody::from_second_moment(&SecondMoment {
        mass,
        center_of_mass: Vector3::zeros(),
        central: Matrix3::from_diagonal_element(along),
        axes: Matrix3::identity(),
        error_bound: ErrorBound {
            mass: relative * mass,
            center_of_mass: 0.0,
            inertia: relative * 2.0 * along,
        },
    })?;
    let provenance = Provenance::of_matter(Source::Density, found.evaluations, Checks::FINITE);
    let units = Units {
        mass: 3 * length + matter.density.power,
        length,
        place: length,
    };
    let body = units.told(&body.with_provenance(provenance))?;
    Ok(Estimate {
        body,
        error: found.error,
        rtol: effort.rtol,
        evaluations: found.evaluations,
    })
}

/// ρ r² and ρ r⁴, lengths in units of `2^length`.
struct Radial<F> {
    density: Scaled<F>,
    length: i32,
}

impl<E, F> Integrand<1, 2> for Radial<F>
where
    E: From<Error>,
    F: FnMut(&[f64], &mut [f64]) -> Result<(), E>,
{
    type Error = E;

    fn values(
        &mut self,
        _: &[Cell<1>],
        points: &[[f64; 1]],
        values: &mut [[f64; 2]],
    ) -> Result<(), E> {
        let radii: Vec<f64> = points
            .iter()
            .map(|&[r]| times_power_of_two(r, self.length))
            .collect();
        let densities = self.density.at(&radii, |&r| [r, 0.0, 0.0])?;
        for ((value, rho), &[r]) in values.iter_mut().zip(densities).zip(points) {
            let mass = rho * r * r;
            *value = [mass, mass * r * r];
        }
        Ok(())
    }

    fn errors(&self, leaves: &[Leaf<1, 2>]) -> Vec<[f64; 1]> {
        let totals = radial_totals(leaves);
        let relative = |value: f64, scale: f64| {
            if value == 0.0 {
                0.0
            } else {
                value.abs() / scale
            }
        };
        leaves
            .iter()
            .map(|leaf| {
                let [m, s] = leaf.differences[0];
                [relative(m, totals[0]).max(relative(s, totals[1]))]
            })
            .collect()
    }
}

fn radial_totals(leaves: &[Leaf<1, 2>]) -> [f64; 2] {
    sum_terms(leaves.len(), |i| leaves[i].sums)
}
