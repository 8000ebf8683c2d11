//! Looking for jumps between the outermost nodes of a box and its faces.
//!
//! Along a few lines through the box the integrand is asked close to both faces and compared with the polynomial
//! through the nodes of the line. Where the integrand is smooth the two agree as well as the rule does; beyond a jump
//! they differ by its height, and what the rule has missed is no more than that on all of the margin.

use super::cells::{BATCH, Cell, Integrand, Leaf};
use super::rule::Rule;

/// Where to ask, in parts of the margin between the face and the outermost node. A jump closer than the last is missed,
/// with less than 1e-9 of the box behind it.
const NEAR: [f64; 5] = [0.5, 0.05, 2e-3, 2e-5, 2e-7];

/// A difference within the rounding of the integral over the box is none.
const ROUNDING: f64 = 1e-15;

/// Lines along each axis, their nodes, and what the polynomial through these is beside the faces.
pub(super) struct Probes<const D: usize> {
    /// Where the lines cross the box, in fractions; each is used along every axis.
    lines: Vec<[f64; D]>,
    nodes: Vec<f64>,
    /// Places beside the faces, with the weights of the nodes there.
    near: Vec<(f64, Vec<f64>)>,
    margin: f64,
}

impl<const D: usize> Probes<D> {
    pub(super) fn of(rule: &Rule) -> Self {
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
    pub(super) fn ask<const K: usize, F: Integrand<D, K>>(
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
    use std::convert::Infallible;

    use super::super::adaptive::integrate;
    use super::*;

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
