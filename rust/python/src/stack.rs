//! Shape arithmetic: stacks of values and how they broadcast, as in NumPy.
//!
//! Every pass over many rows looks for Ctrl-C on the way, and asks for memory by [`memory`](crate::memory) before it begins.

use std::ops::{ControlFlow, Index};

use polhode::Error;
use polhode::parallel::{Halt, Watch, fill_blocks};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::{at_row, to_py};
use crate::interrupt::{Beat, Interrupt, watched};
use crate::memory::{self, Names};
use crate::shape::tuple;

/// Rows of a large map done at a time by one thread, or between two looks at Python's signals.
pub(crate) const BLOCK: usize = 1024;

/// Rows of a small map done between two looks at the clock.
const FEW: usize = 16;

/// Makes the first row.
type First<'a, R> = dyn Fn(&mut Watch<'_>) -> Result<R, Error> + Sync + 'a;

/// Makes the rows of a block, from the number of its first on; tells the first that fails.
type Block<'a, R> =
    dyn Fn(usize, &mut [R], &mut Watch<'_>) -> Result<(), (usize, Error)> + Sync + 'a;

/// Makes all rows, and tells the first that fails.
type Rows<'a> = dyn FnMut(&Interrupt) -> Result<(), Halt<(usize, Error)>> + Send + 'a;

/// Values in C order under a shape; one value has the empty shape.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stack<T> {
    pub(crate) shape: Vec<usize>,
    pub(crate) rows: Vec<T>,
}

impl<T> Stack<T> {
    pub(crate) fn one(value: T) -> Self {
        Self {
            shape: Vec::new(),
            rows: vec![value],
        }
    }

    pub(crate) fn is_one(&self) -> bool {
        self.shape.is_empty()
    }

    /// `f` of every row.
    pub(crate) fn map<R>(&self, py: Python<'_>, f: impl FnMut(&T) -> R) -> PyResult<Stack<R>> {
        let mut rows = memory::vector("result", &self.shape, 0)?;
        extend(py, &mut rows, &self.rows, f)?;
        Ok(Stack {
            shape: self.shape.clone(),
            rows,
        })
    }
}

/// `f` of all `rows`, put into `out`, which has room for them.
pub(crate) fn extend<T, R>(
    py: Python<'_>,
    out: &mut Vec<R>,
    rows: &[T],
    mut f: impl FnMut(&T) -> R,
) -> PyResult<()> {
    let mut beat = Beat::new(py);
    for block in rows.chunks(BLOCK) {
        beat.mark()?;
        out.extend(block.iter().map(&mut f));
    }
    Ok(())
}

/// `f` of each of the `items` of a stack, one after the other and without the interpreter lock; names the row that fails.
///
/// Ctrl-C is looked for between the items too: small ones are done before they ask.
pub(crate) fn try_watched<T, R: Send>(
    py: Python<'_>,
    shape: Vec<usize>,
    items: impl Iterator<Item = T> + Send,
    f: impl Fn(T, &mut Watch<'_>) -> Result<R, Error> + Sync,
) -> PyResult<Stack<R>> {
    let rows: Result<_, (usize, Error)> = watched(py, |watch| {
        let made = items.enumerate().map(|(row, item)| {
            let made = match watch(0.0) {
                ControlFlow::Continue(()) => f(item, watch),
                ControlFlow::Break(()) => Err(Error::Stopped),
            };
            made.map_err(|error| (row, error))
        });
        made.collect()
    })?;
    match rows {
        Ok(rows) => Ok(Stack { shape, rows }),
        Err((row, error)) => Err(at_row(&shape, row, &to_py(py, &error), py)),
    }
}

impl<T> Index<usize> for Stack<T> {
    type Output = T;

    fn index(&self, row: usize) -> &T {
        &self.rows[row]
    }
}

/// How K stacks line up row by row.
pub(crate) struct Broadcast<'a, const K: usize> {
    names: [&'a str; K],
    pub(crate) shape: Vec<usize>,
    /// For each stack the distance in rows that one step along each axis makes.
    strides: [Vec<usize>; K],
}

impl<'a, const K: usize> Broadcast<'a, K> {
    /// NumPy's rule: shapes are aligned at their ends, and a length of one stretches.
    ///
    /// What stretches beyond all memory is refused here, before anybody counts its rows.
    pub(crate) fn of(names: [&'a str; K], shapes: [&[usize]; K]) -> PyResult<Self> {
        let depth = shapes.iter().map(|shape| shape.len()).max().unwrap_or(0);
        let mut shape = vec![1; depth];
        for operand in shapes {
            for (length, &own) in shape.iter_mut().rev().zip(operand.iter().rev()) {
                if *length == 1 {
                    *length = own;
                } else if own != 1 && own != *length {
                    return Err(mismatch(names, shapes));
                }
            }
        }
        let strides = shapes.map(|operand| {
            let mut strides = vec![0; depth];
            let mut stride = 1;
            for (step, &own) in strides.iter_mut().rev().zip(operand.iter().rev()) {
                *step = if own == 1 { 0 } else { stride };
                stride *= own;
            }
            strides
        });
        memory::room(Names(&names), &shape, size_of::<f64>())?;
        Ok(Self {
            names,
            shape,
            strides,
        })
    }

    /// The row of each stack that the flat index `row` of the result takes.
    pub(crate) fn operands(&self, row: usize) -> [usize; K] {
        let mut operands = [0; K];
        let mut rest = row;
        for axis in (0..self.shape.len()).rev() {
            // What is left at the first axis is the step along it: most stacks have one axis, and divisions are slow.
            let step = if axis == 0 {
                rest
            } else {
                let step = rest % self.shape[axis];
                rest /= self.shape[axis];
                step
            };
            for (operand, strides) in operands.iter_mut().zip(&self.strides) {
                *operand += step * strides[axis];
            }
        }
        operands
    }

    /// How many rows the result has.
    pub(crate) fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// `f` of every row, on all cores when there are many; the error of the first failing row, which it names.
    pub(crate) fn try_map<R: Clone + Send>(
        &self,
        py: Python<'_>,
        f: impl Fn([usize; K]) -> Result<R, Error> + Sync,
    ) -> PyResult<Stack<R>> {
        if self.len() > BLOCK {
            return self.on_all_cores(py, BLOCK, None, |row, _| f(row));
        }
        self.one_by_one(py, f)
    }

    /// As [`try_map`](Self::try_map) of rows that are costly to copy: a blank one stands in each place until it is filled.
    pub(crate) fn try_map_into<R: Clone + Send>(
        &self,
        py: Python<'_>,
        blank: R,
        f: impl Fn([usize; K]) -> Result<R, Error> + Sync,
    ) -> PyResult<Stack<R>> {
        if self.len() > BLOCK {
            return self.on_all_cores(py, BLOCK, Some(blank), |row, _| f(row));
        }
        self.one_by_one(py, f)
    }

    fn one_by_one<R>(
        &self,
        py: Python<'_>,
        f: impl Fn([usize; K]) -> Result<R, Error>,
    ) -> PyResult<Stack<R>> {
        let mut rows = Vec::with_capacity(self.len());
        self.in_order(py, &mut |row| {
            rows.push(f(self.operands(row))?);
            Ok(())
        })?;
        Ok(Stack {
            shape: self.shape.clone(),
            rows,
        })
    }

    /// Does each row.
    fn in_order(
        &self,
        py: Python<'_>,
        row: &mut dyn FnMut(usize) -> Result<(), Error>,
    ) -> PyResult<()> {
        let mut beat = Beat::new(py);
        for index in 0..self.len() {
            if index % FEW == FEW - 1 {
                beat.mark()?;
            }
            row(index).map_err(|error| at_row(&self.shape, index, &to_py(py, &error), py))?;
        }
        Ok(())
    }

    /// As [`try_map`](Self::try_map) where a single row may take long: each asks now and then whether to go on.
    pub(crate) fn try_map_watched<R: Clone + Send>(
        &self,
        py: Python<'_>,
        f: impl Fn([usize; K], &mut Watch<'_>) -> Result<R, Error> + Sync,
    ) -> PyResult<Stack<R>> {
        self.on_all_cores(py, if self.len() > BLOCK { BLOCK } else { 1 }, None, f)
    }

    fn on_all_cores<R: Clone + Send>(
        &self,
        py: Python<'_>,
        size: usize,
        blank: Option<R>,
        f: impl Fn([usize; K], &mut Watch<'_>) -> Result<R, Error> + Sync,
    ) -> PyResult<Stack<R>> {
        let first = |watch: &mut Watch<'_>| f(self.operands(0), watch);
        let block = |start: usize, out: &mut [R], watch: &mut Watch<'_>| {
            for (row, value) in (start..).zip(out) {
                *value = f(self.operands(row), watch).map_err(|error| (row, error))?;
            }
            Ok(())
        };
        self.in_blocks(py, size, blank, &first, &block)
    }

    /// The first row, then the others in blocks of so many rows. Here, in [`in_order`](Self::in_order) and in
    /// [`detached`](Self::detached) is what does not depend on how rows are made, and is compiled once.
    fn in_blocks<R: Clone + Send>(
        &self,
        py: Python<'_>,
        size: usize,
        mut blank: Option<R>,
        first: &First<'_, R>,
        block: &Block<'_, R>,
    ) -> PyResult<Stack<R>> {
        let count = self.len();
        let mut rows = memory::vector(Names(&self.names), &self.shape, 0)?;
        self.run_detached(py, &mut |interrupt| {
            if count == 0 {
                return Ok(());
            }
            let watch = &mut |_| interrupt.poll(None);
            // The first row stands in each place until it is filled, unless there is a blank one: no row is written twice
            // over as many pages.
            let first = first(watch).map_err(|error| Halt::Failed((0, error)))?;
            let blank = blank.take().unwrap_or_else(|| first.clone());
            rows.push(first);
            while rows.len() < count {
                rows.resize(count.min(rows.len() + BLOCK), blank.clone());
                if watch(0.0).is_break() {
                    return Err(Halt::Stopped);
                }
            }
            fill_blocks(&mut rows[1..], size, watch, |start, out| {
                block(start + 1, out, &mut |_| interrupt.poll(None))
            })
        })?;
        Ok(Stack {
            shape: self.shape.clone(),
            rows,
        })
    }

    /// Does the rows while other threads of Python go on.
    fn run_detached(&self, py: Python<'_>, rows: &mut Rows<'_>) -> PyResult<()> {
        let interrupt = Interrupt::new(None);
        let outcome = py.detach(|| rows(&interrupt));
        interrupt.finish(py, outcome.is_ok())?;
        if let Err(Halt::Failed((row, error))) = outcome {
            return Err(at_row(&self.shape, row, &to_py(py, &error), py));
        }
        Ok(())
    }

    /// The rows of each stack, one after the other.
    pub(crate) fn rows(&self) -> impl Iterator<Item = [usize; K]> + '_ {
        (0..self.len()).map(|row| self.operands(row))
    }
}

fn mismatch<const K: usize>(names: [&str; K], shapes: [&[usize]; K]) -> PyErr {
    let told: Vec<String> = names
        .iter()
        .zip(shapes)
        .map(|(name, shape)| format!("{name} {}", tuple(shape)))
        .collect();
    PyValueError::new_err(format!(
        "stack shapes do not broadcast: {}",
        told.join(", ")
    ))
}
