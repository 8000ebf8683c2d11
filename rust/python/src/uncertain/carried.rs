//! The doubts of a stack of bodies, and how they go along.

use std::sync::Arc;

use polhode::Error;
use polhode::mass::ten::Ten;
use polhode::uncertainty::{Change, Doubt, Follow, Scaled, follow};
use pyo3::prelude::*;

use super::quantity::{Number, Weight};
use crate::body::{Doubts, PyRigidBody};
use crate::errors::to_py;
use crate::stack::{Broadcast, Stack};

/// Those of the rows of a result, if any of what it is made of has some.
pub(crate) fn carried<const K: usize>(
    py: Python<'_>,
    grid: &Broadcast<'_, K>,
    is_uncertain: bool,
    doubt: impl Fn([usize; K]) -> Result<Doubt, Error> + Sync,
) -> PyResult<Doubts> {
    if !is_uncertain {
        return Ok(None);
    }
    Ok(Some(Arc::new(
        grid.try_map_into(py, Doubt::default(), doubt)?.rows,
    )))
}

/// The doubts of a body that is given by numbers.
pub(crate) fn of_numbers(change: &impl Change, numbers: &[Number<'_>]) -> Result<Doubt, Error> {
    follow(
        change,
        Follow {
            bodies: &[],
            numbers,
        },
    )
}

impl PyRigidBody {
    /// Bodies with their doubts.
    pub(crate) fn doubtful(bodies: Stack<polhode::RigidBody>, doubts: Doubts) -> Self {
        Self {
            doubts,
            ..bodies.into()
        }
    }

    /// The bodies, each with that relative doubt of its mass besides what it carries.
    pub(crate) fn weighed(self, weights: [Option<Weight>; 3]) -> PyResult<Self> {
        let Some(relative) = (weights.into_iter().flatten())
            .map(|weight| weight.relative)
            .find(|form| !form.is_empty())
        else {
            return Ok(self);
        };
        let numbers = &[(1.0, &[][..]), (1.0, &relative)];
        let doubts = (0..self.bodies.rows.len())
            .map(|row| {
                follow(
                    &Scaled,
                    Follow {
                        bodies: &[self.row(row)],
                        numbers,
                    },
                )
            })
            .collect::<Result<_, Error>>()
            .map_err(|error| Python::attach(|py| to_py(py, &error)))?;
        Ok(Self {
            doubts: Some(Arc::new(doubts)),
            ..self
        })
    }

    /// The doubts of a row after a change of it by some numbers.
    pub(crate) fn changed(
        &self,
        row: usize,
        change: &impl Change,
        numbers: &[Number<'_>],
    ) -> Result<Doubt, Error> {
        let bodies = &[self.row(row)];
        follow(change, Follow { bodies, numbers })
    }

    /// One row: its ten numbers and its doubts.
    pub(crate) fn row(&self, row: usize) -> (Ten<f64>, &Doubt) {
        static CERTAIN: std::sync::LazyLock<Doubt> = std::sync::LazyLock::new(Doubt::default);
        let doubt = match &self.doubts {
            Some(doubts) => &doubts[row],
            None => &CERTAIN,
        };
        (Ten::of(&self.bodies[row]), doubt)
    }

    /// The doubts of rows of it.
    pub(crate) fn doubts_of(&self, rows: impl Iterator<Item = usize>) -> Doubts {
        self.doubts
            .as_ref()
            .map(|doubts| Arc::new(rows.map(|row| doubts[row].clone()).collect()))
    }
}
