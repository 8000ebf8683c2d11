//! Bodies of given density: `m = ∫ ρ dV`, `C = ∫ r ρ dV/m`, `S = ∫ (r − C)(r − C)ᵀ ρ dV`, by adaptive cubature.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use super::amount;
use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::provenance::{BodySource, Checks, Provenance};
use super::regions::Region;
use super::scaling::Units;
use super::second_moment::SecondMoment;
use crate::error::{BodyFault, Error, finite};
use crate::numerics::power_of_two::{exponent, halves, times_power_of_two};
use crate::numerics::quadrature::{Cell, Integrand, Leaf, Rule, integrate};
use crate::numerics::tree_sum::{depth, sum_terms};

// How far a cubature may go, and how far it came.

/// What the bound is of the error told. Of one jump between two nodes of a box the Kronrod rule is off by no more than
/// 1.22 times its difference from the Gauss rule, where the volume element grows across the box by 2, and of two jumps in
/// one box, which may cancel in the difference, seldom by more than 5; of what is smooth by far less.
const JUMP: f64 = 8.0;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Bound on the errors of the mass relative to itself, of C relative to the radius of gyration, and of the second
    /// moments relative to their trace.
    pub rtol: f64,
    /// How often the density may be evaluated at most by the rules of the cubature; to look for jumps beside the faces of
    /// its cells takes up to a sixth more.
    pub max_evaluations: usize,
}

impl Effort {
    /// Enough for the first look at every cell, with a tolerance that is one.
    fn check(self, needed: usize) -> Result<Self, Error> {
        finite("rtol", self.rtol)?;
        if !(self.rtol > 0.0 && self.rtol < 1.0) {
            return Err(Error::OutOfDomain {
                what: "rtol",
                law: "more than 0 and less than 1",
                value: self.rtol,
            });
        }
        if self.max_evaluations < needed {
            return Err(BodyFault::TooFewEvaluations {
                needed,
                given: self.max_evaluations,
            }
            .into());
        }
        Ok(self)
    }
}

/// What a cubature found: the body as far as it is known, and how well.
///
/// # Examples
///
/// ```
/// use polhode::Error;
/// use polhode::mass::density::{Effort, Estimate, from_density};
/// use polhode::mass::regions::Region;
/// use polhode::nalgebra::Vector3;
///
/// // A cube whose density grows from 0 to 2 along x: m = 1, C_x = 2/3.
/// let cube = Region::cuboid(&Vector3::zeros(), &Vector3::repeat(1.0))?;
/// let density = |points: &[[f64; 3]], out: &mut [f64]| {
///     for (out, point) in out.iter_mut().zip(points) {
///         *out = 2.0 * point[0];
///     }
///     Ok::<_, Error>(())
/// };
/// let found: Estimate = from_density(&cube, density, Effort { rtol: 1e-10, max_evaluations: 100_000 })?;
/// assert!(found.error < found.rtol);
/// assert!((found.require_converged()?.center_of_mass().x - 2.0 / 3.0).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "an estimate is a body where the cubature has converged"]
pub struct Estimate {
    /// The body as far as it is known.
    pub body: RigidBody,
    /// The estimated relative error.
    pub error: f64,
    /// What was asked for.
    pub rtol: f64,
    /// How many evaluations it took.
    pub evaluations: usize,
}

impl Estimate {
    /// The body, where the cubature has converged.
    ///
    /// # Errors
    /// [`BodyFault::Quadrature`].
    pub fn require_converged(&self) -> Result<RigidBody, Error> {
        if self.error <= self.rtol {
            return Ok(self.body);
        }
        Err(BodyFault::Quadrature {
            error: self.error,
            rtol: self.rtol,
            evaluations: self.evaluations,
        }
        .into())
    }
}

// The body that fills a region with a density.

/// The body that fills a region with the density `ρ(r)`, given at many points at once.
///
/// The density should be smooth within the region, on the scale of some tenth of it to be noticed at all; a jump belongs
/// on the boundary, which may mean several regions whose bodies are added. A jump inside is noticed and counted in the error:
/// one along the faces of the charts (a plane across a box, a sphere about the centre of a ball) is found to any tolerance,
/// one across them to a few digits. In a mesh whose parts are not star-shaped about their
/// middles the density is also asked for outside, where the signed parts cancel.
///
/// # Errors
/// When a value is negative or not finite; where the evaluations do not suffice, [`Estimate::require_converged`] says so;
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
        density: ScaledDensity::of(density),
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
    let provenance = Provenance::of_matter(BodySource::Density, found.evaluations, Checks::FINITE);
    let units = Units {
        mass: 3 * length + matter.density.power,
        length,
        place: length,
    };
    body.check_possible()?;
    let body = units.in_user_units(&body.with_provenance(provenance))?;
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

// The density over a region as an integrand: what is asked of it at points, and what errors count for.

/// The density over a region as mass, first and second moments about the middle of each cell.
struct Matter<'a, F> {
    /// In units of its size, `2^length`.
    region: &'a Region,
    density: ScaledDensity<F>,
    length: i32,
}

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

// The whole of many cells, about its own centre of mass.

/// m, x, y, z, xx, xy, xz, yy, yz, zz.
type Moments = [f64; 10];

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

// A density in a unit of its own, its values possible ones.

/// A density in units of the first one found, a power of two.
struct ScaledDensity<F> {
    density: F,
    power: i32,
    is_known: bool,
}

impl<F> ScaledDensity<F> {
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

// Balls whose density depends on the distance from their centre alone.

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
/// let ball = from_radial_density(&[0.0, 2.0], density, effort)?.require_converged()?;
/// assert!((ball.mass() - 16.0 * std::f64::consts::PI).abs() < 1e-8);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// As of [`from_density`]; when the boundaries do not ascend from zero or more.
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
        density: ScaledDensity::of(density),
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
    let provenance = Provenance::of_matter(BodySource::Density, found.evaluations, Checks::FINITE);
    let units = Units {
        mass: 3 * length + matter.density.power,
        length,
        place: length,
    };
    let body = units.in_user_units(&body.with_provenance(provenance))?;
    Ok(Estimate {
        body,
        error: found.error,
        rtol: effort.rtol,
        evaluations: found.evaluations,
    })
}

/// ρ r² and ρ r⁴, lengths in units of `2^length`.
struct Radial<F> {
    density: ScaledDensity<F>,
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
