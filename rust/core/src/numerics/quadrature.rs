//! Adaptive cubature: tensor products of Gauss-Kronrod rules over boxes that are halved where their errors are.
//!
//! Each rule is two in one: the Gauss rule uses every other node of the Kronrod rule. Along each axis the difference of
//! the two is the error of the *Gauss* rule, of less than two thirds of the degree, and is reported as that of the
//! Kronrod rule: a bound with room to spare wherever the integrand is smooth on the scale of the nodes. The nodes lie
//! inside the box, so that an integrand may be singular on its faces.
//!
//! The nodes beside a face are some thousandths of the box away from it: a jump of the integrand between them and the
//! face is seen by neither rule. So before the integral is called converged, every box is asked closer to its faces.

// Boxes of parameters, what is integrated over them, and what was found.

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
    fn halves(&self, axis: usize) -> [Self; 2] {
        let middle = self.middle()[axis];
        let (mut lower, mut upper) = (*self, *self);
        lower.high[axis] = middle;
        upper.low[axis] = middle;
        [lower, upper]
    }

    /// Boxes of equal size that fill this one, so many along each axis.
    #[must_use]
    pub(crate) fn divide(&self, counts: [u32; D]) -> Vec<Self> {
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
const BATCH: usize = 1 << 18;

// Gauss-Kronrod rules, each two in one.

/// A pair of rules on the interval from 0 to 1.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
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
    pub(crate) fn seven() -> Self {
        Self::from_table(&SEVEN)
    }

    /// Gauss 7, Kronrod 15: exact to degree 13 and 23.
    #[must_use]
    pub(crate) fn fifteen() -> Self {
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
    pub(crate) fn points<const D: usize>(&self) -> usize {
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
            is_probed: false,
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

// The boxes with the largest errors are halved until what is left is small enough.

/// Integrals over the whole.
#[derive(Clone, Debug)]
pub(crate) struct Cubature<const D: usize, const K: usize> {
    /// The boxes, with the integrals over each.
    pub leaves: Vec<Leaf<D, K>>,
    /// The sum of the leaves' relative errors.
    pub error: f64,
    /// At how many points of the rules the integrand was evaluated.
    pub evaluations: usize,
}

/// Integrates over `cells`, halving those with the largest errors until all errors sum to `rtol` or below, or the next
/// round would take more than `max_evaluations` points: whether it converged is for the caller to see. Looking beside the
/// faces of the boxes is not counted: it takes a ninth as many points as the rule of fifteen in three dimensions, and less
/// than a sixth as many as that of seven.
///
/// # Errors
/// Whatever the integrand fails with.
pub(crate) fn integrate<const D: usize, const K: usize, F: Integrand<D, K>>(
    integrand: &mut F,
    cells: &[Cell<D>],
    rule: &Rule,
    rtol: f64,
    max_evaluations: usize,
) -> Result<Cubature<D, K>, F::Error> {
    let each = rule.points::<D>();
    let probes = Probes::<D>::of(rule);
    let mut leaves = evaluate(integrand, cells, rule)?;
    let mut evaluations = each * cells.len();
    loop {
        let errors = integrand.errors(&leaves);
        let totals: Vec<f64> = errors.iter().map(|axes| axes.iter().sum()).collect();
        let error: f64 = totals.iter().sum();
        let room = max_evaluations.saturating_sub(evaluations) / (2 * each);
        if error <= rtol || room == 0 {
            if leaves.iter().all(|leaf| leaf.is_probed) {
                return Ok(Cubature {
                    leaves,
                    error,
                    evaluations,
                });
            }
            probes.ask(integrand, &mut leaves)?;
            continue;
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
        let mut fresh = evaluate(integrand, &parts, rule)?.into_iter();
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
    while count < most.min(order.len()) && (left > rest || left.is_nan()) {
        left -= errors[order[count]];
        count += 1;
    }
    order.truncate(count);
    order
}

fn evaluate<const D: usize, const K: usize, F: Integrand<D, K>>(
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

// Looking for jumps between the outermost nodes of a box and its faces.
//
// Along a few lines through the box the integrand is asked close to both faces and compared with the polynomial
// through the nodes of the line. Where the integrand is smooth the two agree as well as the rule does; beyond a jump
// they differ by its height, and what the rule has missed is no more than that on all of the margin.

/// Where to ask, in parts of the margin between the face and the outermost node. A jump closer than the last is missed,
/// with less than 1e-9 of the box behind it.
const NEAR: [f64; 5] = [0.5, 0.05, 2e-3, 2e-5, 2e-7];

/// A difference within the rounding of the integral over the box is none.
const ROUNDING: f64 = 1e-15;

/// Lines along each axis, their nodes, and what the polynomial through these is beside the faces.
struct Probes<const D: usize> {
    /// Where the lines cross the box, in fractions; each is used along every axis.
    lines: Vec<[f64; D]>,
    nodes: Vec<f64>,
    /// Places beside the faces, with the weights of the nodes there.
    near: Vec<(f64, Vec<f64>)>,
    margin: f64,
}

impl<const D: usize> Probes<D> {
    fn of(rule: &Rule) -> Self {
        let nodes = rule.nodes.clone();
        let (margin, count) = (nodes[0], nodes.len());
        let mut lines = vec![[0.5; D]];
        if D == 3 && count > 7 {
            // Pairs of coordinates in all four corners of each face.
            let (low, high) = (nodes[3], nodes[count - 4]);
            lines.extend((0..4).map(|corner: usize| {
                std::array::from_fn(|axis| {
                    let is_high = match axis {
                        0 => corner & 1,
                        1 => corner >> 1,
                        _ => (corner & 1) ^ (corner >> 1),
                    };
                    if is_high == 1 { high } else { low }
                })
            }));
        }
        let places = NEAR.map(|part| part * margin);
        let near = (places.into_iter().chain(places.map(|place| 1.0 - place)))
            .map(|place| (place, lagrange(&nodes, place)))
            .collect();
        Self {
            lines,
            nodes,
            near,
            margin,
        }
    }

    /// How many points each box takes.
    fn points(&self) -> usize {
        D * self.lines.len() * self.along()
    }

    /// How many points each line takes.
    fn along(&self) -> usize {
        self.nodes.len() + self.near.len()
    }

    /// Asks the boxes that have not been asked yet; what they may have missed becomes the difference along the axis
    /// across it, where that was smaller.
    fn ask<const K: usize, F: Integrand<D, K>>(
        &self,
        integrand: &mut F,
        leaves: &mut [Leaf<D, K>],
    ) -> Result<(), F::Error> {
        let mut fresh: Vec<&mut Leaf<D, K>> =
            (leaves.iter_mut()).filter(|leaf| !leaf.is_probed).collect();
        for batch in fresh.chunks_mut((BATCH / self.points()).max(1)) {
            let cells: Vec<Cell<D>> = batch.iter().map(|leaf| leaf.cell).collect();
            let points: Vec<[f64; D]> = cells.iter().flat_map(|cell| self.place(cell)).collect();
            let mut values = vec![[0.0; K]; points.len()];
            integrand.values(&cells, &points, &mut values)?;
            for (leaf, values) in batch.iter_mut().zip(values.chunks_exact(self.points())) {
                self.compare(leaf, values);
            }
        }
        Ok(())
    }

    fn place(&self, cell: &Cell<D>) -> Vec<[f64; D]> {
        let mut points = Vec::with_capacity(self.points());
        for axis in 0..D {
            for line in &self.lines {
                let places = self
                    .nodes
                    .iter()
                    .chain(self.near.iter().map(|(place, _)| place));
                points.extend(places.map(|&place| {
                    let mut at = *line;
                    at[axis] = place;
                    std::array::from_fn(|k| cell.low[k] + (cell.high[k] - cell.low[k]) * at[k])
                }));
            }
        }
        points
    }

    fn compare<const K: usize>(&self, leaf: &mut Leaf<D, K>, values: &[[f64; K]]) {
        let volume: f64 = (0..D)
            .map(|axis| leaf.cell.high[axis] - leaf.cell.low[axis])
            .product();
        let lines = self.lines.len() * self.along();
        for (axis, values) in values.chunks_exact(lines).enumerate() {
            let mut missed: [f64; K] = [0.0; K];
            for line in values.chunks_exact(self.along()) {
                let (nodes, near) = line.split_at(self.nodes.len());
                for (value, (_, weights)) in near.iter().zip(&self.near) {
                    let mut jump = *value;
                    for (node, weight) in nodes.iter().zip(weights) {
                        for k in 0..K {
                            jump[k] -= weight * node[k];
                        }
                    }
                    let jump = jump.map(|jump| jump * self.margin * volume);
                    if jump[0].abs() > missed[0].abs() {
                        missed = jump;
                    }
                }
            }
            // One may stand beside each of the two faces.
            let missed = missed.map(|missed| 2.0 * missed);
            let is_noise = missed[0].abs() <= ROUNDING * leaf.sums[0].abs();
            if !is_noise && missed[0].abs() > leaf.differences[axis][0].abs() {
                leaf.differences[axis] = missed;
            }
        }
        leaf.is_probed = true;
    }
}

/// The weights of the values at the nodes in the polynomial through them, elsewhere.
fn lagrange(nodes: &[f64], x: f64) -> Vec<f64> {
    (0..nodes.len())
        .map(|i| {
            (0..nodes.len())
                .filter(|&j| j != i)
                .map(|j| (x - nodes[j]) / (nodes[i] - nodes[j]))
                .product()
        })
        .collect()
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

    /// One up to some place, two beyond.
    struct Step(f64);

    impl Integrand<1, 1> for Step {
        type Error = Infallible;

        fn values(
            &mut self,
            _: &[Cell<1>],
            points: &[[f64; 1]],
            values: &mut [[f64; 1]],
        ) -> Result<(), Infallible> {
            for (value, [x]) in values.iter_mut().zip(points) {
                value[0] = if *x < self.0 { 1.0 } else { 2.0 };
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

    #[test]
    fn weights_reproduce_polynomials_outside_of_the_nodes() {
        let nodes = Rule::fifteen().nodes;
        let value: f64 = lagrange(&nodes, 1e-6)
            .iter()
            .zip(&nodes)
            .map(|(weight, x)| weight * (1.0 + x * (2.0 + x.powi(9))))
            .sum();
        assert!((value - 1.000_002).abs() < 1e-13);
    }

    #[test]
    fn a_step_is_found_wherever_it_is() {
        let whole = Cell {
            chart: 0,
            low: [0.0],
            high: [1.0],
        };
        for rule in [Rule::seven(), Rule::fifteen()] {
            let margin = rule.nodes[0];
            for place in [
                0.9,
                0.5,
                0.3 * margin,
                1.0 - 1e-3 * margin,
                0.5 + 1e-5,
                0.123_456_789,
            ] {
                let Ok(found) = integrate(&mut Step(place), &[whole], &rule, 1e-9, 100_000);
                let sum: f64 = found.leaves.iter().map(|leaf| leaf.sums[0]).sum();
                let error = (sum - (2.0 - place)).abs();
                assert!(found.error <= 1e-9, "{place}");
                assert!(error <= 1.25 * found.error + 1e-15, "{place}: {error:e}");
            }
        }
    }
}
