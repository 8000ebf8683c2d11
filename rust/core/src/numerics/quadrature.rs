//! Adaptive cubature: tensor products of Gauss-Kronrod rules over boxes that are halved where their errors are.
//!
//! Each rule is two in one: the Gauss rule uses every other node of the Kronrod rule. Along each axis the difference of
//! the two is the error of the *Gauss* rule, of less than two thirds of the degree, and is reported as that of the
//! Kronrod rule: a bound with room to spare wherever the integrand is smooth on the scale of the nodes. The nodes lie
//! inside the box, so that an integrand may be singular on its faces.

/// A pair of rules on the interval from 0 to 1.
#[derive(Clone, Debug)]
pub struct Rule {
    nodes: Vec<f64>,
    kronrod: Vec<f64>,
    /// The Gauss weights over the Kronrod ones, zero at nodes that are not Gauss's.
    ratio: Vec<f64>,
}

/// Nodes from the largest down to zero, Kronrod weights, Gauss weights of every second node.
type Table<const N: usize> = [(f64, f64, f64); N];

#[rustfmt::skip]
const SEVEN: Table<4> = [
    (0.960_491_268_708_020_3, 0.104_656_226_026_467_27, 0.0),
    (0.774_596_669_241_483_4, 0.268_488_089_868_333_45, 5.0 / 9.0),
    (0.434_243_749_346_802_55, 0.401_397_414_775_962_2, 0.0),
    (0.0, 0.450_916_538_658_474_15, 8.0 / 9.0),
];

#[rustfmt::skip]
const FIFTEEN: Table<8> = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
];

impl Rule {
    /// Gauss 3, Kronrod 7: exact to degree 5 and 11.
    #[must_use]
    pub fn seven() -> Self {
        Self::from_table(&SEVEN)
    }

    /// Gauss 7, Kronrod 15: exact to degree 13 and 23.
    #[must_use]
    pub fn fifteen() -> Self {
        Self::from_table(&FIFTEEN)
    }

    fn from_table<const N: usize>(table: &Table<N>) -> Self {
        let lower = table.iter().map(|&(x, k, g)| (-x, k, g));
        let upper = table.iter().rev().skip(1).copied();
        let (mut nodes, mut kronrod, mut ratio) = (Vec::new(), Vec::new(), Vec::new());
        for (x, k, g) in lower.chain(upper) {
            nodes.push(0.5 + 0.5 * x);
            kronrod.push(0.5 * k);
            ratio.push(g / k);
        }
        Self {
            nodes,
            kronrod,
            ratio,
        }
    }

    /// The number of points in a box of D dimensions.
    #[must_use]
    pub fn points<const D: usize>(&self) -> usize {
        (0..D).map(|_| self.nodes.len()).product()
    }

    /// The node along each axis of the point with this number; the last axis runs fastest.
    fn indices<const D: usize>(&self, point: usize) -> [usize; D] {
        let mut rest = point;
        let mut indices = [0; D];
        for index in indices.iter_mut().rev() {
            *index = rest % self.nodes.len();
            rest /= self.nodes.len();
        }
        indices
    }

    /// The points in a cell.
    fn place<const D: usize>(&self, cell: &Cell<D>, out: &mut Vec<[f64; D]>) {
        out.extend((0..self.points::<D>()).map(|point| {
            let indices = self.indices::<D>(point);
            std::array::from_fn(|axis| {
                let (low, high) = (cell.low[axis], cell.high[axis]);
                low + (high - low) * self.nodes[indices[axis]]
            })
        }));
    }

    /// The Kronrod sums over a cell, and how much the Gauss rule along each axis differs from them.
    fn sums<const D: usize, const K: usize>(
        &self,
        cell: Cell<D>,
        values: &[[f64; K]],
    ) -> Leaf<D, K> {
        let volume: f64 = (0..D)
            .map(|axis| cell.high[axis] - cell.low[axis])
            .product();
        let mut leaf = Leaf {
            cell,
            sums: [0.0; K],
            differences: [[0.0; K]; D],
        };
        for (point, value) in values.iter().enumerate() {
            let indices = self.indices::<D>(point);
            let weight: f64 = indices.iter().map(|&i| self.kronrod[i]).product::<f64>() * volume;
            let missed = indices.map(|i| 1.0 - self.ratio[i]);
            for (k, &value) in value.iter().enumerate() {
                let term = weight * value;
                leaf.sums[k] += term;
                for (difference, missed) in leaf.differences.iter_mut().zip(missed) {
                    difference[k] += term * missed;
                }
            }
        }
        leaf
    }
}

/// A box of parameters, in one of the charts that cover the region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<const D: usize> {
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
    pub fn middle(&self) -> [f64; D] {
        std::array::from_fn(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis])
    }

    /// The two halves along an axis.
    fn halves(&self, axis: usize) -> [Self; 2] {
        let middle = self.middle()[axis];
        let (mut lower, mut upper) = (*self, *self);
        lower.high[axis] = middle;
        upper.low[axis] = middle;
        [lower, upper]
    }

    /// Boxes of equal size that fill this one, so many along each axis.
    #[must_use]
    pub fn divided(&self, counts: [u32; D]) -> Vec<Self> {
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
pub struct Leaf<const D: usize, const K: usize> {
    /// The box.
    pub cell: Cell<D>,
    /// The K integrals by the Kronrod rule.
    pub sums: [f64; K],
    /// What they lose with the Gauss rule along each axis.
    pub differences: [[f64; K]; D],
}

/// K functions over boxes of D parameters.
pub trait Integrand<const D: usize, const K: usize> {
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

/// Integrals over the whole.
#[derive(Clone, Debug)]
pub struct Cubature<const D: usize, const K: usize> {
    /// The boxes, with the integrals over each.
    pub leaves: Vec<Leaf<D, K>>,
    /// The sum of the leaves' relative errors.
    pub error: f64,
    /// How many points were evaluated.
    pub evaluations: usize,
}

/// Points that are evaluated in one call, about.
const BATCH: usize = 1 << 18;

/// Integrates over `cells`, halving those with the largest errors until all errors sum to `rtol` or below, or the next
/// round would take more than `max_evaluations` points: whether it converged is for the caller to see.
///
/// # Errors
/// Whatever the integrand fails with.
pub fn integrate<const D: usize, const K: usize, F: Integrand<D, K>>(
    integrand: &mut F,
    cells: &[Cell<D>],
    rule: &Rule,
    rtol: f64,
    max_evaluations: usize,
) -> Result<Cubature<D, K>, F::Error> {
    let each = rule.points::<D>();
    let mut leaves = evaluated(integrand, cells, rule)?;
    let mut evaluations = each * cells.len();
    loop {
        let errors = integrand.errors(&leaves);
        let totals: Vec<f64> = errors.iter().map(|axes| axes.iter().sum()).collect();
        let error: f64 = totals.iter().sum();
        let room = max_evaluations.saturating_sub(evaluations) / (2 * each);
        if error <= rtol || room == 0 {
            return Ok(Cubature {
                leaves,
                error,
                evaluations,
            });
        }
        let halved = worst(&totals, 0.25 * rtol, room.min((BATCH / (2 * each)).max(1)));
        let mut parts = Vec::with_capacity(2 * halved.len());
        for &leaf in &halved {
            let axes = &errors[leaf];
            let longest = (0..D)
                .max_by(|&i, &j| axes[i].total_cmp(&axes[j]))
                .unwrap_or(0);
            parts.extend(leaves[leaf].cell.halves(longest));
        }
        let mut fresh = evaluated(integrand, &parts, rule)?.into_iter();
        // The first half takes its parent's place, the second goes to the end: the order depends on nothing but the errors.
        for &leaf in &halved {
            if let Some(first) = fresh.next() {
                leaves[leaf] = first;
            }
            leaves.extend(fresh.next());
        }
        evaluations += each * parts.len();
    }
}

/// The leaves with the largest errors, as few as leave no more than `rest`, and no more than `most`.
fn worst(errors: &[f64], rest: f64, most: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..errors.len()).collect();
    order.sort_by(|&i, &j| errors[j].total_cmp(&errors[i]));
    let mut left: f64 = errors.iter().sum();
    let mut count = 0;
    while count < most.min(order.len()) && !(left <= rest && count > 0) {
        left -= errors[order[count]];
        count += 1;
    }
    order.truncate(count);
    order
}

fn evaluated<const D: usize, const K: usize, F: Integrand<D, K>>(
    integrand: &mut F,
    cells: &[Cell<D>],
    rule: &Rule,
) -> Result<Vec<Leaf<D, K>>, F::Error> {
    let each = rule.points::<D>();
    let mut leaves = Vec::with_capacity(cells.len());
    for batch in cells.chunks((BATCH / each).max(1)) {
        let mut points = Vec::with_capacity(batch.len() * each);
        for cell in batch {
            rule.place(cell, &mut points);
        }
        let mut values = vec![[0.0; K]; points.len()];
        integrand.values(batch, &points, &mut values)?;
        let rows = batch.iter().zip(values.chunks_exact(each));
        leaves.extend(rows.map(|(cell, values)| rule.sums(*cell, values)));
    }
    Ok(leaves)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    struct Power(i32);

    impl Integrand<1, 1> for Power {
        type Error = Infallible;

        fn values(
            &mut self,
            _: &[Cell<1>],
            points: &[[f64; 1]],
            values: &mut [[f64; 1]],
        ) -> Result<(), Infallible> {
            for (value, [x]) in values.iter_mut().zip(points) {
                value[0] = x.powi(self.0);
            }
            Ok(())
        }

        fn errors(&self, leaves: &[Leaf<1, 1>]) -> Vec<[f64; 1]> {
            leaves
                .iter()
                .map(|leaf| [leaf.differences[0][0].abs()])
                .collect()
        }
    }

    const UNIT_INTERVAL: Cell<1> = Cell {
        chart: 0,
        low: [0.0],
        high: [1.0],
    };

    #[test]
    fn rules_are_exact_to_their_degrees() {
        for (rule, gauss, kronrod) in [(Rule::seven(), 5, 11), (Rule::fifteen(), 13, 23)] {
            for power in 0..=kronrod {
                let Ok(found) = integrate(&mut Power(power), &[UNIT_INTERVAL], &rule, 1.0, 0);
                let exact = 1.0 / f64::from(power + 1);
                assert!((found.leaves[0].sums[0] - exact).abs() < 2e-16, "{power}");
                assert_eq!(found.error < 1e-15, power <= gauss, "{power}");
            }
        }
    }

    #[test]
    fn cells_are_halved_where_the_error_is() {
        let Ok(found) = integrate(
            &mut Power(400),
            &[UNIT_INTERVAL],
            &Rule::fifteen(),
            1e-12,
            10_000,
        );
        let sum: f64 = found.leaves.iter().map(|leaf| leaf.sums[0]).sum();
        assert!((sum - 1.0 / 401.0).abs() <= found.error.max(1e-17));
        assert!(found.error <= 1e-12);
        let leaves = &found.leaves;
        assert_eq!(
            leaves.iter().filter(|leaf| leaf.cell.low[0] < 0.5).count(),
            1
        );
        assert!(leaves.iter().filter(|leaf| leaf.cell.low[0] > 0.8).count() >= 2);
    }

    #[test]
    fn budget_is_kept() {
        let Ok(found) = integrate(
            &mut Power(400),
            &[UNIT_INTERVAL],
            &Rule::fifteen(),
            0.0,
            100,
        );
        assert_eq!(found.evaluations, 75);
    }
}
