//! Bodies made of tetrahedra, their density uniform, one for each cell, or linear between nodes: exact integrals.
//!
//! In barycentric coordinates λ the integrals of a linear density `ρ = Σ ρ_i λ_i` over a cell of volume V are, with
//! `P = Σ ρ_i`, `∫ρ = V P/4`, `∫ρ λ_i = V (P + ρ_i)/20`, and `∫ρ λ_i λ_j = V (P + ρ_i + ρ_j)/120`, twice that for `i = j`.

use nalgebra::{Matrix3, Vector3};
use thiserror::Error as ThisError;

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::provenance::{Checks, Provenance, Source};
use super::second_moment::SecondMoment;
use crate::error::{Error, finite};
use crate::numerics::reduce::sum_terms;
use crate::numerics::split_vector::{SplitVector, determinant};

/// Below this ratio of smallest to largest principal moment the sums are taken in the body's own axes.
const THIN: f64 = 0.05;

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

/// Why nodes and cells make no body.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum CellFault {
    /// No cells.
    #[error("cells must not be empty: there is nothing to sum over")]
    NoCells,
    /// A cell names a node that does not exist.
    #[error(
        "cells[{cell}] names node {index}, but there are {nodes} nodes, numbered from 0; \
         if the cells count from 1 subtract 1"
    )]
    IndexOutOfRange {
        /// The cell.
        cell: usize,
        /// The index it holds.
        index: i64,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("nodes[{node}] is not finite: {value:?}")]
    NonFiniteNode {
        /// The node.
        node: usize,
        /// The coordinate.
        value: f64,
    },
    /// A density is below zero.
    #[error("density must not be negative: density[{index}] is {value:?}")]
    NegativeDensity {
        /// Of which cell or node.
        index: usize,
        /// The number.
        value: f64,
    },
    /// Every cell is flat or without density.
    #[error(
        "the {count} cells have no mass: {mass:?}; check that they are not flat and their density not zero"
    )]
    NoMass {
        /// How many cells.
        count: usize,
        /// The sum of their masses.
        mass: f64,
    },
}

/// The body of these cells; four nodes each, in either order.
///
/// Cells are what they cover: their volumes are counted as positive, and cells that overlap count twice.
///
/// # Errors
/// [`CellFault`] names the cell, node or density that is at fault.
///
/// # Panics
/// When there are not as many densities as cells or nodes.
pub fn tetrahedra(
    nodes: &[[f64; 3]],
    cells: &[[usize; 4]],
    density: CellDensity<'_>,
) -> Result<RigidBody, Error> {
    check(nodes, cells, density)?;
    let used = || cells.iter().flatten().map(|&k| Vector3::from(nodes[k]));
    let low = used().fold(Vector3::repeat(f64::INFINITY), |low, v| low.inf(&v));
    let high = used().fold(Vector3::repeat(f64::NEG_INFINITY), |high, v| high.sup(&v));
    let sums = |reference: &Vector3<f64>, axes: &Matrix3<f64>| {
        Sums::over(nodes, cells, density, reference, axes)
    };
    let first = sums(&(low * 0.5 + high * 0.5), &Matrix3::identity());
    if !(first.mass > 0.0 && first.mass.is_finite()) {
        let (count, mass) = (cells.len(), first.mass);
        return Err(CellFault::NoMass { count, mass }.into());
    }
    // About the centre of mass, which the cells' bounding box may be far from when their densities differ much.
    let center = low * 0.5 + high * 0.5 + first.moment / first.mass;
    let matter = sums(&center, &Matrix3::identity()).matter(&center, cells.len(), density);
    let provenance = Provenance::of_matter(
        Source::Tetrahedra,
        cells.len(),
        Checks::INDICES.and(Checks::FINITE).and(Checks::MASSES),
    );
    let body = RigidBody::from_second_moment(&matter)?.with_provenance(provenance);
    let principal = body.principal();
    if principal.moments[0] >= THIN * principal.moments[2] {
        return Ok(body);
    }
    let mut thin = sums(&center, &principal.axes).matter(&center, cells.len(), density);
    thin.axes = principal.axes;
    thin.center_of_mass = matter.center_of_mass;
    Ok(RigidBody::from_second_moment(&thin)?.with_provenance(provenance.in_own_axes()))
}

/// `∫ dm`, `∫ d dm` and `∫ d dᵀ dm` with `d = axesᵀ (r − reference)`.
struct Sums {
    mass: f64,
    moment: Vector3<f64>,
    second: Matrix3<f64>,
}

impl Sums {
    fn over(
        nodes: &[[f64; 3]],
        cells: &[[usize; 4]],
        density: CellDensity<'_>,
        reference: &Vector3<f64>,
        axes: &Matrix3<f64>,
    ) -> Self {
        let columns: [[f64; 3]; 3] = axes.data.0;
        let origin: [f64; 3] = (*reference).into();
        let [m, x, y, z, xx, xy, xz, yy, yz, zz] = sum_terms(cells.len(), |cell| {
            let corners = cells[cell].map(|k| nodes[k]);
            let rho = match density {
                CellDensity::Uniform(rho) => [rho; 4],
                CellDensity::PerCell(rho) => [rho[cell]; 4],
                CellDensity::PerNode(rho) => cells[cell].map(|k| rho[k]),
            };
            let d = corners.map(|r| {
                let from = SplitVector::difference(&r, &origin);
                Vector3::from(columns.map(|axis| from.dot(&axis)))
            });
            let v = volume(&corners);
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
        });
        Self {
            mass: m,
            moment: Vector3::new(x, y, z),
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }

    /// The matter about its own centre, which `center` is but for rounding.
    fn matter(
        &self,
        center: &Vector3<f64>,
        count: usize,
        density: CellDensity<'_>,
    ) -> SecondMoment {
        let spread = self.second.trace();
        let mut bound = ErrorBound::of_sums(count, self.mass, center, 2.0 * spread);
        // The reference is rounded once more on its way here, and so are linear densities on theirs.
        bound.center_of_mass += 4.0 * UNIT * center.amax();
        if let CellDensity::PerNode(_) = density {
            bound.mass *= 2.0;
        }
        SecondMoment::about_reference(center, self.mass, &self.moment, &self.second, bound)
    }
}

/// `|det(b − a, c − a, d − a)|/6`.
fn volume([a, b, c, d]: &[[f64; 3]; 4]) -> f64 {
    let edge = |to: &[f64; 3]| SplitVector::difference(to, a);
    determinant(&edge(b), &edge(c), &edge(d)).abs() / 6.0
}

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
