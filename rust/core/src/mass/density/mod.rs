//! Bodies of given density: `m = ∫ ρ dV`, `C = ∫ r ρ dV/m`, `S = ∫ (r − C)(r − C)ᵀ ρ dV`, by adaptive cubature.

mod effort;
mod radial;

use nalgebra::{Matrix3, Vector3};

pub use effort::{Effort, Estimate};
pub use radial::from_radial_density;

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::provenance::{Checks, Provenance, Source};
use super::regions::Region;
use super::second_moment::SecondMoment;
use super::units::Units;
use crate::error::{BodyFault, Error};
use crate::numerics::power_of_two::{exponent, halves};
use crate::numerics::quadrature::{Cell, Integrand, Leaf, integrate};
use crate::numerics::reduce::{depth, sum_terms};

/// What the bound is of the error told. Of one jump between two nodes of a box the Kronrod rule is off by no more than
/// 1.22 times its difference from the Gauss rule, where the volume element grows across the box by 2, and of two jumps in
/// one box, which may cancel in the difference, seldom by more than 5; of what is smooth by far less.
const JUMP: f64 = 8.0;

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
            inertia: 2.0 * (error * spread + rounding * sizes.spread + total.mass * reach * place),
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

/// A density in units of the first one found, a power of two.
struct Scaled<F> {
    density: F,
    power: i32,
    is_known: bool,
}

impl<F> Scaled<F> {
    fn of(density: F) -> Self {
        Self {
            density,
            power: 0,
            is_known: false,
        }
    }

    /// The densities at these points, possible ones.
    fn at<P, E>(&mut self, points: &[P], place: impl Fn(&P) -> [f64; 3]) -> Result<Vec<f64>, E>
    where
        E: From<Error>,
        F: FnMut(&[P], &mut [f64]) -> Result<(), E>,
    {
        let mut densities = vec![0.0; points.len()];
        (self.density)(points, &mut densities)?;
        for (point, &value) in points.iter().zip(&densities) {
            if !(value.is_finite() && value >= 0.0) {
                let point = place(point);
                return Err(Error::from(BodyFault::ImpossibleDensity { point, value }).into());
            }
        }
        let densest = densities.iter().fold(0.0, |most: f64, &rho| most.max(rho));
        if !self.is_known && densest > 0.0 {
            (self.power, self.is_known) = (exponent(densest), true);
        }
        let [a, b] = halves(-self.power);
        for density in &mut densities {
            *density = *density * a * b;
        }
        Ok(densities)
    }
}

/// The density over a region as mass, first and second moments about the middle of each cell.
struct Matter<'a, F> {
    /// In units of its size, `2^length`.
    region: &'a Region,
    density: Scaled<F>,
    length: i32,
}

/// m, x, y, z, xx, xy, xz, yy, yz, zz.
type Moments = [f64; 10];

impl<E, F> Integrand<3, 10> for Matter<'_, F>
where
    E: From<Error>,
    F: FnMut(&[[f64; 3]], &mut [f64]) -> Result<(), E>,
{
    type Error = E;

    fn values(
        &mut self,
        cells: &[Cell<3>],
        points: &[[f64; 3]],
        values: &mut [Moments],
    ) -> Result<(), E> {
        let each = points.len() / cells.len().max(1);
        let placed: Vec<(Vector3<f64>, f64)> = (points.iter().enumerate())
            .map(|(i, parameters)| self.region.point(cells[i / each].chart, parameters))
            .collect();
        let [a, b] = halves(self.length);
        let positions: Vec<[f64; 3]> = placed
            .iter()
            .map(|(at, _)| at.map(|x| x * a * b).into())
            .collect();
        let densities = self.density.at(&positions, |&point| point)?;
        for (i, ((at, element), rho)) in placed.iter().zip(densities).enumerate() {
            let d = at - middle(self.region, &cells[i / each]);
            let w = rho * element;
            let wd = d * w;
            values[i] = [
                w,
                wd.x,
                wd.y,
                wd.z,
                wd.x * d.x,
                wd.x * d.y,
                wd.x * d.z,
                wd.y * d.y,
                wd.y * d.z,
                wd.z * d.z,
            ];
        }
        Ok(())
    }

    fn errors(&self, leaves: &[Leaf<3, 10>]) -> Vec<[f64; 3]> {
        let total = Total::of(self.region, leaves);
        if total.mass <= 0.0 {
            return vec![[0.0; 3]; leaves.len()]; // nothing there to refine
        }
        let (width, spread) = (total.width(), total.second.trace());
        // A spread that is none yet, as of signed charts that cancel, says nothing.
        let relative = |value: f64, scale: f64| match value / scale {
            _ if value == 0.0 => 0.0,
            relative if relative >= 0.0 => relative,
            _ => f64::INFINITY,
        };
        leaves
            .iter()
            .map(|leaf| {
                let q = middle(self.region, &leaf.cell) - total.center;
                leaf.differences.map(|difference| {
                    let (mass, first, second) = about(&difference, &q);
                    relative(mass.abs(), total.mass)
                        .max(relative(first.amax(), total.mass * width))
                        .max(relative(second.amax(), spread))
                })
            })
            .collect()
    }
}

/// The whole about its own centre of mass.
struct Total {
    mass: f64,
    center: Vector3<f64>,
    second: Matrix3<f64>,
    sizes: Sizes,
}

/// Sums over the leaves without their signs.
struct Sizes {
    mass: f64,
    /// Of mass times the largest coordinate.
    first: f64,
    /// Of the traces of the second moments.
    spread: f64,
}

impl Total {
    fn of(region: &Region, leaves: &[Leaf<3, 10>]) -> Self {
        let middles: Vec<Vector3<f64>> = leaves
            .iter()
            .map(|leaf| middle(region, &leaf.cell))
            .collect();
        let heaviest = (0..leaves.len())
            .max_by(|&i, &j| leaves[i].sums[0].total_cmp(&leaves[j].sums[0]))
            .unwrap_or(0);
        let reference = middles[heaviest];
        let [mass, x, y, z] = sum_terms(leaves.len(), |i| {
            let (mass, first, _) = about(&leaves[i].sums, &(middles[i] - reference));
            [mass, first.x, first.y, first.z]
        });
        let center = reference + Vector3::new(x, y, z) / mass;
        let [xx, xy, xz, yy, yz, zz, masses, first, spread] = sum_terms(leaves.len(), |i| {
            let (m, _, s) = about(&leaves[i].sums, &(middles[i] - center));
            let (size, spread) = (m.abs(), s.trace().abs());
            let first = size * middles[i].amax();
            [
                s.m11, s.m12, s.m13, s.m22, s.m23, s.m33, size, first, spread,
            ]
        });
        Self {
            mass,
            center,
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            sizes: Sizes {
                mass: masses,
                first,
                spread,
            },
        }
    }

    /// √(tr S/m), the body's own length.
    fn width(&self) -> f64 {
        (self.second.trace() / self.mass).sqrt()
    }
}

/// Moments about a point that the cell's middle is `q` away from.
fn about(moments: &Moments, q: &Vector3<f64>) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let [m, x, y, z, xx, xy, xz, yy, yz, zz] = *moments;
    let f = Vector3::new(x, y, z);
    let mixed = f * q.transpose();
    let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    (
        m,
        f + q * m,
        second + mixed + mixed.transpose() + q * (q.transpose() * m),
    )
}

fn middle(region: &Region, cell: &Cell<3>) -> Vector3<f64> {
    region.point(cell.chart, &cell.middle()).0
}
