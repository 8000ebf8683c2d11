//! Bodies made of tetrahedra, their density uniform, one for each cell, or linear between nodes: exact integrals.
//!
//! In barycentric coordinates λ the integrals of a linear density `ρ = Σ ρ_i λ_i` over a cell of volume V are, with
//! `P = Σ ρ_i`, `∫ρ = V P/4`, `∫ρ λ_i = V (P + ρ_i)/20`, and `∫ρ λ_i λ_j = V (P + ρ_i + ρ_j)/120`, twice that for `i = j`.

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::integrator::{Matter, integrate};
use super::provenance::{BodySource, Checks, Provenance};
use super::scaling::{QUANTUM, Units};
use super::second_moment::SecondMoment;
use super::simplex::LocalFrame;
use crate::error::{CellFault, Error, finite};
use crate::numerics::expansion;
use crate::numerics::power_of_two::{exponent, halves, times_power_of_two};
use crate::numerics::split_vector::{SplitVector, determinant};
use crate::numerics::threads::{Watch, each_watched};
use crate::numerics::tree_sum::{block_sum, depth, sum_blocks};

// Where densities are given; what nodes, cells and densities must be.

/// Where the densities are given.
#[derive(Clone, Copy, Debug)]
pub enum CellDensity<'a> {
    /// One for all.
    Uniform(f64),
    /// One for each cell.
    PerCell(&'a [f64]),
    /// One for each node, linear between them.
    PerNode(&'a [f64]),
}

/// Indices name nodes, numbers are finite, densities not negative.
fn check(nodes: &[[f64; 3]], cells: &[[usize; 4]], density: CellDensity<'_>) -> Result<(), Error> {
    if cells.is_empty() {
        return Err(CellFault::NoCells.into());
    }
    for (cell, corners) in cells.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&k| k >= nodes.len()) {
            let index = i64::try_from(index).unwrap_or(i64::MAX);
            let nodes = nodes.len();
            return Err(CellFault::IndexOutOfRange { cell, index, nodes }.into());
        }
    }
    for (node, coordinates) in nodes.iter().enumerate() {
        if let Some(&value) = coordinates.iter().find(|x| !x.is_finite()) {
            return Err(CellFault::NonFiniteNode { node, value }.into());
        }
    }
    let densities = match &density {
        CellDensity::Uniform(rho) => {
            finite("density", *rho)?;
            if *rho <= 0.0 {
                let (what, law, value) = ("density", "positive", *rho);
                return Err(Error::OutOfDomain { what, law, value });
            }
            return Ok(());
        }
        CellDensity::PerCell(rho) => {
            assert_eq!(rho.len(), cells.len(), "one density for each cell");
            rho
        }
        CellDensity::PerNode(rho) => {
            assert_eq!(rho.len(), nodes.len(), "one density for each node");
            rho
        }
    };
    for (index, &value) in densities.iter().enumerate() {
        finite("density", value)?;
        if value < 0.0 {
            return Err(CellFault::NegativeDensity { index, value }.into());
        }
    }
    Ok(())
}

// The body of cells: their integrals, again about the centre of mass and, of a thin body, in its own axes.

/// Sums about the centre of mass are repeated at most this often, where the first centre was a body's width off.
const AGAIN: usize = 4;

/// The body of these cells; four nodes each, in either order.
///
/// Cells are what they cover: their volumes are counted as positive, and cells that overlap count twice. `watch` is asked about
/// every 20 ms whether to go on.
///
/// # Examples
///
/// ```
/// use polhode::mass::tetrahedra::{CellDensity, tetrahedra};
/// use std::ops::ControlFlow;
///
/// let nodes = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let density = CellDensity::PerNode(&[0.0, 0.0, 0.0, 24.0]); // linear between the nodes
/// let body = tetrahedra(&nodes, &[[0, 1, 2, 3]], density, &mut |_| ControlFlow::Continue(()))?;
/// assert!((body.mass() - 1.0).abs() < 1e-15); // the mean of the densities times 1/6
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`CellFault`] names the cell, node or density that is at fault;
/// [`BodyFault::OutOfRange`](crate::error::BodyFault::OutOfRange) a mass or moment that is too large or too small for float64;
/// [`Error::Stopped`] where `watch` said so.
///
/// # Panics
/// When there are not as many densities as cells or nodes.
pub fn tetrahedra(
    nodes: &[[f64; 3]],
    cells: &[[usize; 4]],
    density: CellDensity<'_>,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    check(nodes, cells, density)?;
    // Differences of coordinates this large could overflow.
    let (nearer, place) = if largest_coordinate(nodes, cells, watch)? >= FAR {
        let nearer: Vec<_> = nodes.iter().map(|r| r.map(|x| x / FAR)).collect();
        (Some(nearer), FAR_POWER)
    } else {
        (None, 0)
    };
    let mut cells = Cells::new(
        nearer.as_deref().unwrap_or(nodes),
        cells,
        density,
        place,
        watch,
    )?;
    let body_axes = Matrix3::identity();
    let mut sums = cells.sums(&body_axes, watch)?;
    // About the centre of mass, which the cells' bounding box may be far from when their densities differ much.
    for _ in 0..AGAIN {
        cells.frame.reference += sums.moment / sums.mass * cells.frame.unit;
        sums = cells.sums(&body_axes, watch)?;
        if sums.is_central() {
            break;
        }
    }
    let provenance = Provenance::of_matter(
        BodySource::Tetrahedra,
        cells.count(),
        Checks::INDICES.and(Checks::FINITE).and(Checks::MASSES),
    );
    let body = integrate(&cells, &cells.matter(&sums), provenance, watch)?;
    cells.units.in_user_units(&body)
}

impl Matter for Cells<'_> {
    type Moments = SecondMoment;

    /// About the point of the first pass: its centre of mass is good to all digits.
    fn moments(&self, frame: &LocalFrame, watch: &mut Watch<'_>) -> Result<SecondMoment, Error> {
        let axes = frame.rotation();
        Ok(SecondMoment {
            axes,
            center_of_mass: frame.reference,
            ..self.matter(&self.sums(&axes, watch)?)
        })
    }
}

// The integrals of all cells, in units of the body's own size and mass.

/// Coordinates of this size and more, 2⁹⁶⁰, are divided by it.
const FAR: f64 = f64::from_bits((1023 + FAR_POWER as u64) << 52);

/// Which power of two that is.
const FAR_POWER: i32 = 960;

/// The largest coordinate of the nodes that cells use.
fn largest_coordinate(
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
struct Cells<'a> {
    nodes: &'a [[f64; 3]],
    corners: &'a [[usize; 4]],
    density: CellDensity<'a>,
    weights: Vec<Weight>,
    /// What underflow may have taken from the mass.
    lost: f64,
    /// The middle of the box, then the centre of mass; in units of the box.
    frame: LocalFrame,
    units: Units,
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
    fn new(
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

    fn count(&self) -> usize {
        self.corners.len()
    }

    /// The sums about the reference in the given axes.
    fn sums(&self, axes: &Matrix3<f64>, watch: &mut Watch<'_>) -> Result<CellSums, Error> {
        let [x, y, z] = &axes.data.0;
        let origin: [f64; 3] = self.frame.reference.into();
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
            // No `map`: a caller's compiler may leave its closure a function, and split the axes for each corner anew.
            let mut d = [Vector3::zeros(); 4];
            for (d, k) in d.iter_mut().zip([i, j, k, l]) {
                let from = SplitVector::difference(&self.nodes[k], &origin).scaled(inverse);
                *d = Vector3::new(from.dot(x), from.dot(y), from.dot(z));
            }
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

    /// The matter about its own centre, which the reference is but for rounding.
    ///
    /// With corners d about the centre a cell of mass m has `Σ d² ≤ 30 ∫ d² dm/m` along each axis, whatever its densities
    /// are, and so its own terms are no more than 5 of its first and 11 of its second moments: the roundings in a cell
    /// count so often, those of the sum once.
    fn matter(&self, sums: &CellSums) -> SecondMoment {
        let center = self.frame.reference;
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
struct CellSums {
    mass: f64,
    moment: Vector3<f64>,
    second: Matrix3<f64>,
}

impl CellSums {
    /// Whether the reference was within the body: what its distance adds to the moments is no more than they are.
    fn is_central(&self) -> bool {
        let offset = self.moment.norm_squared() / self.mass;
        2.0 * offset <= self.second.trace()
    }
}

// The volume of a cell, however flat, small or large it is.

/// Six times a volume: `mantissa·2^exponent`, to a unit or two of rounding and to `error·2^exponent`.
#[derive(Clone, Copy, Debug)]
struct Volume {
    mantissa: f64,
    exponent: i32,
    error: f64,
}

/// A determinant of numbers below two is as good as exact in doubled precision, unless it is less than this.
const FLAT: f64 = 1.0 / (1_u64 << 40) as f64;

/// A smaller one has lost digits to underflow, no more than `LOST`.
const FAINT: f64 = f64::MIN_POSITIVE * (1_u128 << 120) as f64;

const LOST: f64 = f64::MIN_POSITIVE;

/// `|det(b − a, c − a, d − a)|`.
fn sixfold([a, b, c, d]: &[[f64; 3]; 4]) -> Volume {
    let edge = |to| SplitVector::difference(to, a);
    let mut edges = [edge(b), edge(c), edge(d)];
    let mut power = 0;
    // Each coordinate in its own unit: a cell that is thin along an axis is none.
    for k in 0..3 {
        let largest = edges.iter().fold(0.0_f64, |m, e| m.max(e.high[k].abs()));
        let own = exponent(largest);
        power += own;
        let [p, q] = halves(-own);
        for edge in &mut edges {
            edge.high[k] = edge.high[k] * p * q;
            edge.low[k] = edge.low[k] * p * q;
        }
    }
    let [u, v, w] = &edges;
    let mut det = determinant(u, v, w).abs();
    if det < FLAT {
        det = expansion::determinant(u, v, w).abs();
    }
    let own = exponent(det);
    Volume {
        mantissa: times_power_of_two(det, -own),
        exponent: own + power,
        error: if det < FAINT {
            times_power_of_two(LOST, -own)
        } else {
            0.0
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    use nalgebra::Vector3;

    use crate::error::CellFault;

    fn tetrahedra(
        nodes: &[[f64; 3]],
        cells: &[[usize; 4]],
        density: CellDensity<'_>,
    ) -> Result<RigidBody, Error> {
        super::tetrahedra(nodes, cells, density, &mut |_| ControlFlow::Continue(()))
    }

    const CORNER: [[f64; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];

    #[test]
    fn density_that_is_a_coordinate() {
        // ρ = x over the corner tetrahedron: ∫x = 1/24, ∫x² = 1/60, ∫xy = 1/120, ∫x³ = 1/120, ∫xy² = 1/360, ∫xyz = 1/720.
        let rho = [0.0, 1.0, 0.0, 0.0];
        let body = tetrahedra(&CORNER, &[[0, 1, 2, 3]], CellDensity::PerNode(&rho)).expect("body");
        assert!((body.mass() - 1.0 / 24.0).abs() < 1e-17);
        let center = Vector3::new(0.4, 0.2, 0.2);
        assert!((body.center_of_mass() - center).norm() < 1e-16);
        let corner = body.inertia_about(&Vector3::zeros());
        assert!((corner[(0, 0)] - 2.0 / 360.0).abs() < 1e-17);
        assert!((corner[(1, 1)] - (1.0 / 120.0 + 1.0 / 360.0)).abs() < 1e-17);
        assert!((corner[(1, 2)] + 1.0 / 720.0).abs() < 1e-17);
    }

    #[test]
    fn faults_are_told_apart() {
        let fault = |cells: &[[usize; 4]], density| {
            let Err(Error::Cells(fault)) = tetrahedra(&CORNER, cells, density) else {
                panic!("expected a fault of the cells")
            };
            fault
        };
        let uniform = CellDensity::Uniform(1.0);
        assert_eq!(fault(&[], uniform), CellFault::NoCells);
        let out = CellFault::IndexOutOfRange {
            cell: 0,
            index: 4,
            nodes: 4,
        };
        assert_eq!(fault(&[[0, 1, 2, 4]], uniform), out);
        assert!(matches!(
            fault(&[[0, 1, 2, 2]], uniform),
            CellFault::NoMass { .. }
        ));
        let negative = fault(&[[0, 1, 2, 3]], CellDensity::PerCell(&[-1.0]));
        assert_eq!(
            negative,
            CellFault::NegativeDensity {
                index: 0,
                value: -1.0
            }
        );
    }

    #[test]
    fn thin_along_an_axis_in_the_air_and_beyond_all_doubles() {
        let cell = |x: f64, y: f64, z: f64| [[0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        for (size, power) in [
            (1.0, 0),
            (2.0_f64.powi(-300), -300),
            (2.0_f64.powi(340), 340),
        ] {
            let found = sixfold(&cell(size, size, size));
            assert_eq!((found.mantissa, found.exponent), (1.0, 3 * power));
        }
        let plate = sixfold(&cell(1.0, 1.0, 2.0_f64.powi(-1000)));
        assert_eq!(
            (plate.mantissa, plate.exponent, plate.error),
            (1.0, -1000, 0.0)
        );
    }

    #[test]
    fn a_corner_one_unit_above_its_plane() {
        // d = (b + c)/2 lifted by 2⁻⁵³ off the plane x = y: twice the area of the base times the lift, over √2.
        let up = 2.0_f64.powi(-53);
        let found = sixfold(&[
            [0.25, 0.25, 0.0],
            [0.75, 0.75, 0.0],
            [0.25, 0.25, 1.0],
            [0.5, 0.5 + up, 0.5],
        ]);
        assert_eq!((found.mantissa, found.exponent), (1.0, -54));
    }

    #[test]
    fn what_underflow_has_taken_is_told() {
        let tiny = 2.0_f64.powi(-900);
        let found = sixfold(&[
            [0.0; 3],
            [1.0, 1.0, 1.0],
            [1.0, 1.0 + f64::EPSILON, 1.0],
            [
                tiny,
                tiny * (1.0 + f64::EPSILON),
                tiny * (1.0 - f64::EPSILON),
            ],
        ]);
        assert!(found.error > 0.0);
    }
}
