//! The integrals of all cells, in units of the body's own size and mass.

use nalgebra::{Matrix3, Vector3};

use super::check::CellDensity;
use super::volume::{Volume, sixfold};
use crate::error::{CellFault, Error};
use crate::mass::error_bound::{ErrorBound, UNIT};
use crate::mass::second_moment::SecondMoment;
use crate::mass::simplex::LocalFrame;
use crate::mass::units::{QUANTUM, Units};
use crate::numerics::power_of_two::{exponent, halves, times_power_of_two};
use crate::numerics::reduce::{block_sum, depth, sum_blocks};
use crate::numerics::split_vector::SplitVector;
use crate::numerics::threads::{Watch, each_watched};

/// Coordinates of this size and more, 2⁹⁶⁰, are divided by it.
pub(super) const FAR: f64 = f64::from_bits((1023 + FAR_POWER as u64) << 52);
/// Which power of two that is.
pub(super) const FAR_POWER: i32 = 960;

/// The largest coordinate of the nodes that cells use.
pub(super) fn largest_coordinate(
    nodes: &[[f64; 3]],
    cells: &[[usize; 4]],
    watch: &mut Watch<'_>,
) -> Result<f64, Error> {
    let mut largest: f64 = 0.0;
    each_watched(cells.iter(), watch, |cell| {
        let used = cell.iter().flat_map(|&k| nodes[k]);
        largest = used.fold(largest, |largest, x| x.abs().max(largest));
        Ok::<(), Error>(())
    })?;
    Ok(largest)
}

/// Cells with their volumes and densities in units.
pub(super) struct Cells<'a> {
    nodes: &'a [[f64; 3]],
    corners: &'a [[usize; 4]],
    density: CellDensity<'a>,
    weights: Vec<Weight>,
    /// What underflow may have taken from the mass.
    lost: f64,
    pub(super) frame: LocalFrame,
    pub(super) units: Units,
}

/// The volume of a cell times the power of two that its densities are divided by.
#[derive(Clone, Copy)]
struct Weight {
    volume: f64,
    /// The densities are multiplied by both of these powers of two.
    density: [f64; 2],
}

impl<'a> Cells<'a> {
    /// The cells, each in its place: their volumes once and for all.
    pub(super) fn new(
        nodes: &'a [[f64; 3]],
        cells: &'a [[usize; 4]],
        density: CellDensity<'a>,
        place: i32,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        let mut volumes: Vec<Volume> = Vec::with_capacity(cells.len());
        each_watched(cells.iter(), watch, |cell| {
            let [i, j, k, l] = *cell;
            let corners = [nodes[i], nodes[j], nodes[k], nodes[l]];
            for &corner in &corners {
                let corner = Vector3::from(corner);
                (low, high) = (low.inf(&corner), high.sup(&corner));
            }
            volumes.push(sixfold(&corners));
            Ok::<(), Error>(())
        })?;
        let frame = LocalFrame::of_box(&low, &high);
        let densest = |cell: usize| {
            let densities = densities(cells, density, cell);
            densities.into_iter().fold(0.0, f64::max)
        };
        let power = |cell: usize| volumes[cell].exponent + exponent(densest(cell));
        let mut heaviest = None;
        each_watched(0..cells.len(), watch, |cell| {
            if volumes[cell].mantissa * densest(cell) > 0.0 {
                heaviest = heaviest.max(Some(power(cell)));
            }
            Ok::<(), Error>(())
        })?;
        let Some(heaviest) = heaviest else {
            let (count, mass) = (cells.len(), 0.0);
            return Err(CellFault::NoMass { count, mass }.into());
        };
        let mut lost = 0.0;
        let mut weights = Vec::with_capacity(cells.len());
        each_watched(0..cells.len(), watch, |cell| {
            let Volume {
                mantissa, error, ..
            } = volumes[cell];
            let shift = power(cell) - heaviest;
            lost += times_power_of_two(error, shift);
            weights.push(Weight {
                volume: times_power_of_two(mantissa, shift) / 6.0,
                density: halves(-exponent(densest(cell))),
            });
            Ok::<(), Error>(())
        })?;
        let length = exponent(frame.unit) + place;
        let mass = heaviest + 3 * place;
        Ok(Self {
            nodes,
            corners: cells,
            density,
            weights,
            lost,
            frame,
            units: Units {
                mass,
                length,
                place,
            },
        })
    }

    pub(super) fn count(&self) -> usize {
        self.corners.len()
    }

    /// The centre of mass of sums about a reference.
    pub(super) fn place(&self, reference: &Vector3<f64>, sums: &CellSums) -> Vector3<f64> {
        reference + sums.moment / sums.mass * self.frame.unit
    }

    /// The sums about a point in the given axes.
    pub(super) fn sums(
        &self,
        reference: &Vector3<f64>,
        axes: &Matrix3<f64>,
        watch: &mut Watch<'_>,
    ) -> Result<CellSums, Error> {
        let [x, y, z] = &axes.data.0;
        let origin: [f64; 3] = (*reference).into();
        let inverse = 1.0 / self.frame.unit;
        let of_cell = |cell: usize| {
            let [i, j, k, l] = self.corners[cell];
            let Weight {
                volume: v,
                density: [a, b],
            } = self.weights[cell];
            let mut rho = densities(self.corners, self.density, cell);
            for rho in &mut rho {
                *rho = *rho * a * b;
            }
            let corners = [self.nodes[i], self.nodes[j], self.nodes[k], self.nodes[l]];
            let d = corners.map(|r| {
                let from = SplitVector::difference(&r, &origin).scaled(inverse);
                Vector3::new(from.dot(x), from.dot(y), from.dot(z))
            });
            let p: f64 = rho.iter().sum();
            let s = d[0] + d[1] + d[2] + d[3];
            let t = d[0] * rho[0] + d[1] * rho[1] + d[2] * rho[2] + d[3] * rho[3];
            let first = (s * p + t) * (v / 20.0);
            let second = |i: usize, j: usize| {
                let own: f64 = (0..4)
                    .map(|k| (p + 2.0 * rho[k]) * (d[k][i] * d[k][j]))
                    .sum();
                (p * s[i] * s[j] + (t[i] * s[j] + s[i] * t[j]) + own) * (v / 120.0)
            };
            [
                v * p / 4.0,
                first.x,
                first.y,
                first.z,
                second(0, 0),
                second(0, 1),
                second(0, 2),
                second(1, 1),
                second(1, 2),
                second(2, 2),
            ]
        };
        let [m, x, y, z, xx, xy, xz, yy, yz, zz] = sum_blocks(self.count(), watch, |range| {
            block_sum(range.start, range.end, &of_cell)
        })?;
        Ok(CellSums {
            mass: m,
            moment: Vector3::new(x, y, z),
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        })
    }

    /// The matter about its own centre, which `center` is but for rounding.
    ///
    /// With corners d about the centre a cell of mass m has `Σ d² ≤ 30 ∫ d² dm/m` along each axis, whatever its densities
    /// are, and so its own terms are no more than 5 of its first and 11 of its second moments: the roundings in a cell
    /// count so often, those of the sum once.
    pub(super) fn matter(&self, sums: &CellSums, center: &Vector3<f64>) -> SecondMoment {
        let (mass, spread) = (sums.mass, sums.second.trace());
        let (additions, unit) = (depth(self.count()), self.frame.unit);
        // What underflow took stands nowhere farther than the far end of the box.
        let (lost, size) = (2.0 * self.lost / mass, 8.0);
        let width = (spread / mass).sqrt();
        let faint = QUANTUM * self.count() as f64;
        let bound = ErrorBound {
            mass: (2.0 * UNIT * (additions + 20.0) + lost) * mass + faint,
            center_of_mass: (2.0 * UNIT * (2.0 * additions + 90.0) * width + lost * size + faint)
                * unit
                + 6.0 * UNIT * center.amax()
                + QUANTUM,
            inertia: 2.0 * UNIT * (2.0 * additions + 200.0) * spread
                + lost * size * size * mass
                + faint,
        };
        let about = SecondMoment::about_reference(
            &Vector3::zeros(),
            mass,
            &sums.moment,
            &sums.second,
            bound,
        );
        SecondMoment {
            center_of_mass: center + about.center_of_mass * unit,
            ..about
        }
    }
}

/// At the four corners of a cell.
#[inline]
fn densities(cells: &[[usize; 4]], density: CellDensity<'_>, cell: usize) -> [f64; 4] {
    match density {
        CellDensity::Uniform(rho) => [rho; 4],
        CellDensity::PerCell(rho) => [rho[cell]; 4],
        CellDensity::PerNode(rho) => {
            let [i, j, k, l] = cells[cell];
            [rho[i], rho[j], rho[k], rho[l]]
        }
    }
}

/// `∫ dm`, `∫ d dm` and `∫ d dᵀ dm` with `d = axesᵀ (r − reference)`.
pub(super) struct CellSums {
    mass: f64,
    moment: Vector3<f64>,
    second: Matrix3<f64>,
}

impl CellSums {
    /// Whether the reference was within the body: what its distance adds to the moments is no more than they are.
    pub(super) fn is_central(&self) -> bool {
        let offset = self.moment.norm_squared() / self.mass;
        2.0 * offset <= self.second.trace()
    }
}
