//! The shapes that bodies were made of, and how they go along.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::body::PyRigidBody;
use crate::figure::{Figure, Figures, MOST_ROWS, Outline, Part, Placement, figures, together};
use crate::stack::Broadcast;

impl PyRigidBody {
    /// The same bodies, of these shapes.
    pub(crate) fn with_shapes(self, figures: Figures) -> Self {
        Self { figures, ..self }
    }

    /// The shape of a row, or what its inertia tells.
    fn figure(&self, row: usize) -> Figure {
        match &self.figures {
            Some(figures) => Arc::clone(&figures[row]),
            None => Outline::of_inertia(&self.bodies[row]).place(),
        }
    }

    /// The shapes of rows of it.
    pub(crate) fn figures_of(&self, rows: impl ExactSizeIterator<Item = usize>) -> Figures {
        if self.figures.is_none() || rows.len() > MOST_ROWS {
            return None;
        }
        Some(Arc::new(rows.map(|row| self.figure(row)).collect()))
    }

    /// The shapes in other places; this body is the first operand of the grid.
    pub(crate) fn place_figures<const K: usize>(
        &self,
        grid: &Broadcast<'_, K>,
        place: impl Fn([usize; K]) -> Placement,
    ) -> Figures {
        let own = self.figures.as_ref()?;
        figures(grid.len(), |row| {
            let operands = grid.operands(row);
            let place = place(operands);
            let moved = |part: &Part| Part {
                place: place.after(&part.place),
                ..part.clone()
            };
            own[operands[0]].iter().map(moved).collect()
        })
    }

    /// The shapes with another body put to it or taken out of it.
    pub(crate) fn join_figures(
        &self,
        grid: &Broadcast<'_, 2>,
        other: &Self,
        is_taken_out: bool,
    ) -> Figures {
        if self.figures.is_none() && other.figures.is_none() {
            return None;
        }
        figures(grid.len(), |row| {
            let [a, b] = grid.operands(row);
            together([(self.figure(a), false), (other.figure(b), is_taken_out)])
        })
    }

    /// The shapes of so many rows, each of as many rows of this one after the other.
    pub(crate) fn gather(&self, count: usize, order: &[usize]) -> Figures {
        if self.figures.is_none() || count == 0 {
            return None;
        }
        figures(order.len() / count, |row| {
            let own = &order[row * count..(row + 1) * count];
            together(own.iter().map(|&k| (self.figure(k), false)))
        })
    }

    /// The shapes of one stack after the other.
    pub(crate) fn stack_figures<'a>(bodies: impl Iterator<Item = &'a Self> + Clone) -> Figures {
        let rows: usize = bodies.clone().map(|body| body.bodies.rows.len()).sum();
        if !bodies.clone().any(|body| body.figures.is_some()) {
            return None;
        }
        let all =
            bodies.flat_map(|body| (0..body.bodies.rows.len()).map(move |row| body.figure(row)));
        (rows <= MOST_ROWS).then(|| Arc::new(all.collect()))
    }
}

/// A part as Python has it: kind, numbers, faces, the twelve numbers of its place, whether it is taken out.
type Stored<'py> = (
    String,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<u32>>,
    Vec<f64>,
    bool,
);

#[pymethods]
impl PyRigidBody {
    /// The parts of each body, for pictures and pickles; nothing where no shape is known.
    #[pyo3(name = "_figures")]
    pub(crate) fn stored_figures<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyList>>> {
        let Some(figures) = &self.figures else {
            return Ok(None);
        };
        let part = |part: &Part| -> Stored<'py> {
            let Placement { turn, shift } = &part.place;
            (
                part.outline.kind.to_string(),
                PyArray1::from_slice(py, &part.outline.numbers),
                part.outline.faces.as_flattened().to_vec().into_pyarray(py),
                turn.transpose().iter().chain(shift).copied().collect(),
                part.is_taken_out,
            )
        };
        let rows = figures
            .iter()
            .map(|figure| PyList::new(py, figure.iter().map(part)))
            .collect::<PyResult<Vec<_>>>()?;
        PyList::new(py, rows).map(Some)
    }
}

impl PyRigidBody {
    /// The same bodies with the shapes that [`Self::stored_figures`] gave.
    pub(crate) fn with_figures(self, stored: &Bound<'_, PyAny>) -> PyResult<Self> {
        let rows: Vec<Vec<Stored<'_>>> = stored.extract()?;
        let figures = rows
            .into_iter()
            .map(|parts| parts.into_iter().map(restore_part).collect())
            .collect::<PyResult<Vec<Figure>>>()?;
        if figures.len() != self.bodies.rows.len() {
            return Err(damage_error());
        }
        Ok(self.with_shapes(Some(Arc::new(figures))))
    }
}

fn restore_part((kind, numbers, faces, place, is_taken_out): Stored<'_>) -> PyResult<Part> {
    let faces = faces.to_vec()?;
    let (faces, rest) = faces.as_chunks::<3>();
    let place: [f64; 12] = place.try_into().map_err(|_| damage_error())?;
    if !rest.is_empty() {
        return Err(damage_error());
    }
    Ok(Part {
        outline: Arc::new(Outline {
            kind: Cow::Owned(kind),
            numbers: numbers.to_vec()?,
            faces: faces.to_vec(),
        }),
        place: Placement {
            turn: Matrix3::from_row_slice(&place[..9]),
            shift: Vector3::from_column_slice(&place[9..]),
        },
        is_taken_out,
    })
}

fn damage_error() -> PyErr {
    PyValueError::new_err("figures: not what was stored")
}
