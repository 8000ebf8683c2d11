//! Why nodes and cells make no body.

use thiserror::Error as ThisError;

use super::CellDensity;
use crate::error::{Error, finite};

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
