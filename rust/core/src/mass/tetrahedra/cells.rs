//! The body of cells: their integrals, again about the centre of mass and, of a thin body, in its own axes.

use nalgebra::Matrix3;

use super::check::{CellDensity, check};
use super::sums::{Cells, FAR, FAR_POWER, largest_coordinate};
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::provenance::{Checks, Provenance, Source};
use crate::numerics::threads::Watch;

/// Below this ratio of smallest to largest principal moment the sums are taken in the body's own axes.
const THIN: f64 = 0.05;

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
/// [`CellFault`](crate::error::CellFault) names the cell, node or density that is at fault;
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
    let cells = Cells::new(
        nearer.as_deref().unwrap_or(nodes),
        cells,
        density,
        place,
        watch,
    )?;
    let middle = cells.frame.reference;
    let first = cells.sums(&middle, &Matrix3::identity(), watch)?;
    // About the centre of mass, which the cells' bounding box may be far from when their densities differ much.
    let mut center = cells.place(&middle, &first);
    let mut sums = cells.sums(&center, &Matrix3::identity(), watch)?;
    for _ in 1..AGAIN {
        if sums.is_central() {
            break;
        }
        center = cells.place(&center, &sums);
        sums = cells.sums(&center, &Matrix3::identity(), watch)?;
    }
    let matter = cells.matter(&sums, &center);
    let provenance = Provenance::of_matter(
        Source::Tetrahedra,
        cells.count(),
        Checks::INDICES.and(Checks::FINITE).and(Checks::MASSES),
    );
    let body = RigidBody::from_second_moment(&matter)?.with_provenance(provenance);
    let principal = body.principal();
    if principal.moments[0] >= THIN * principal.moments[2] {
        return cells.units.told(&body);
    }
    let mut thin = cells.matter(&cells.sums(&center, &principal.axes, watch)?, &center);
    thin.axes = principal.axes;
    thin.center_of_mass = matter.center_of_mass;
    let body = RigidBody::from_second_moment(&thin)?;
    cells
        .units
        .told(&body.with_provenance(provenance.in_own_axes()))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use std::ops::ControlFlow;

    use super::*;
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
}
