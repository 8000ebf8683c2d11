//! The doubts of a stack of bodies, and how they go along.

use std::sync::Arc;

use polhode::Error;
use polhode::mass::ten::Ten;
use polhode::uncertainty::Doubt;
use pyo3::prelude::*;

use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

/// The doubts of each body of a stack, or none where all is taken as known.
pub(crate) type Doubts = Option<Arc<Vec<Doubt>>>;

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
    Ok(Some(Arc::new(grid.try_map(py, doubt)?.rows)))
}

impl PyRigidBody {
    /// Bodies with their doubts.
    pub(crate) fn doubtful(bodies: Stack<polhode::RigidBody>, doubts: Doubts) -> Self {
        Self { bodies, doubts }
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
