//! Gauss-Kronrod rules, each two in one.

use super::cells::{Cell, Leaf};

/// A pair of rules on the interval from 0 to 1.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    pub(super) nodes: Vec<f64>,
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
    pub(super) fn place<const D: usize>(&self, cell: &Cell<D>, out: &mut Vec<[f64; D]>) {
        out.extend((0..self.points::<D>()).map(|point| {
            let indices = self.indices::<D>(point);
            std::array::from_fn(|axis| {
                let (low, high) = (cell.low[axis], cell.high[axis]);
                low + (high - low) * self.nodes[indices[axis]]
            })
        }));
    }

    /// The Kronrod sums over a cell, and how much the Gauss rule along each axis differs from them.
    pub(super) fn sums<const D: usize, const K: usize>(
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
