//! Boxes of parameters, what is integrated over them, and what was found.

/// A box of parameters, in one of the charts that cover the region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell<const D: usize> {
    /// Which chart.
    pub chart: usize,
    /// Where the box begins along each axis.
    pub low: [f64; D],
    /// Where it ends.
    pub high: [f64; D],
}

impl<const D: usize> Cell<D> {
    /// The middle of the box.
    #[must_use]
    pub(crate) fn middle(&self) -> [f64; D] {
        std::array::from_fn(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis])
    }

    /// The two halves along an axis.
    pub(super) fn halves(&self, axis: usize) -> [Self; 2] {
        let middle = self.middle()[axis];
        let (mut lower, mut upper) = (*self, *self);
        lower.high[axis] = middle;
        upper.low[axis] = middle;
        [lower, upper]
    }

    /// Boxes of equal size that fill this one, so many along each axis.
    #[must_use]
    pub(crate) fn divided(&self, counts: [u32; D]) -> Vec<Self> {
        let mut cells = vec![*self];
        for (axis, &count) in counts.iter().enumerate() {
            cells = cells
                .iter()
                .flat_map(|cell| {
                    (0..count).map(|i| {
                        let (low, high) = (cell.low[axis], cell.high[axis]);
                        let at = |i: u32| low + (high - low) * (f64::from(i) / f64::from(count));
                        let mut part = *cell;
                        (part.low[axis], part.high[axis]) = (at(i), at(i + 1));
                        part
                    })
                })
                .collect();
        }
        cells
    }
}

/// A box with the integrals over it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf<const D: usize, const K: usize> {
    /// The box.
    pub cell: Cell<D>,
    /// The K integrals by the Kronrod rule.
    pub sums: [f64; K],
    /// What they lose with the Gauss rule along each axis, or to a jump beside a face.
    pub differences: [[f64; K]; D],
    /// Whether it was asked close to its faces.
    pub(in crate::numerics) is_probed: bool,
}

/// K functions over boxes of D parameters.
pub(crate) trait Integrand<const D: usize, const K: usize> {
    /// What evaluating them may fail with.
    type Error;

    /// The functions, times the volume element, at points of which each cell has the same number, one cell after the other.
    ///
    /// # Errors
    /// Whatever the functions fail with.
    fn values(
        &mut self,
        cells: &[Cell<D>],
        points: &[[f64; D]],
        values: &mut [[f64; K]],
    ) -> Result<(), Self::Error>;

    /// The error of each leaf along each axis, relative to what the whole amounts to.
    fn errors(&self, leaves: &[Leaf<D, K>]) -> Vec<[f64; D]>;
}

/// Points that are evaluated in one call, about.
pub(super) const BATCH: usize = 1 << 18;
