//! Where densities are given; what nodes, cells and densities must be.

use crate::error::{CellFault, Error, finite};

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
pub(super) fn check(
    nodes: &[[f64; 3]],
    cells: &[[usize; 4]],
    density: CellDensity<'_>,
) -> Result<(), Error> {
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
