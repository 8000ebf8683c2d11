//! Sums and determinants without any rounding: numbers as sums of doubles that do not overlap (Shewchuk 1997).

use super::double_double::{fast_two_sum, two_product, two_sum};
use super::split_vector::SplitVector;

/// A number as a sum of doubles, exact while no product underflows; ascending, none overlapping another.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    parts: Vec<f64>,
}

impl Expansion {
    /// Adds a double.
    pub(crate) fn add(&mut self, x: f64) {
        let mut sum = x;
        let mut kept = 0;
        for k in 0..self.parts.len() {
            let (total, rest) = two_sum(sum, self.parts[k]);
            if rest != 0.0 {
                self.parts[kept] = rest;
                kept += 1;
            }
            sum = total;
        }
        self.parts.truncate(kept);
        self.parts.push(sum);
    }

    /// The double that is nearest, or its neighbour.
    #[must_use]
    pub(crate) fn rounded(&self) -> f64 {
        // From the smallest part on, each sum carries what the next may need.
        let (mut sum, mut rest) = (0.0, 0.0);
        for &part in self.parts.iter().rev() {
            let (total, lost) = fast_two_sum(sum, part);
            sum = total;
            rest += lost;
        }
        sum + rest
    }
}

/// `det(a, b, c)`, rounded once however much of it cancels; exact while products stay above 2⁻⁹⁶⁸.
#[must_use]
pub(crate) fn determinant(a: &SplitVector<3>, b: &SplitVector<3>, c: &SplitVector<3>) -> f64 {
    let mut sum = Expansion::default();
    let part = |v: &SplitVector<3>, k: usize| [v.high[k], v.low[k]];
    for (sign, [i, j, k]) in [
        (1.0, [0, 1, 2]),
        (1.0, [1, 2, 0]),
        (1.0, [2, 0, 1]),
        (-1.0, [0, 2, 1]),
        (-1.0, [1, 0, 2]),
        (-1.0, [2, 1, 0]),
    ] {
        for x in part(a, i) {
            for y in part(b, j) {
                let (p, p_rest) = two_product(sign * x, y);
                for z in part(c, k) {
                    for factor in [p, p_rest] {
                        if factor != 0.0 && z != 0.0 {
                            let (q, q_rest) = two_product(factor, z);
                            sum.add(q);
                            sum.add(q_rest);
                        }
                    }
                }
            }
        }
    }
    sum.rounded()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_in_any_order() {
        let terms = [
            1e300,
            1.0,
            -1e300,
            1e-300,
            3e-17,
            -1.0,
            2.0_f64.powi(80),
            -3e-17,
        ];
        let mut sum = Expansion::default();
        for x in terms {
            sum.add(x);
        }
        assert_eq!(sum.rounded(), 2.0_f64.powi(80));
        sum.add(-(2.0_f64.powi(80)));
        assert_eq!(sum.rounded(), 1e-300);
        sum.add(-1e-300);
        assert_eq!(sum.rounded(), 0.0);
    }

    #[test]
    fn determinants_of_nearly_flat_edges() {
        // c = a + b but for one unit in the last place: the determinant is that unit times a cofactor.
        let (a, b) = ([0.1, 0.7, 0.3], [0.9, 0.2, 0.4]);
        let zero = [0.0; 3];
        let exact = |v: [f64; 3]| SplitVector::difference(&v, &zero);
        let sum = SplitVector::<3> {
            high: [0, 1, 2].map(|k| a[k] + b[k]),
            low: [0, 1, 2].map(|k| two_sum(a[k], b[k]).1),
        };
        assert_eq!(determinant(&exact(a), &exact(b), &sum), 0.0);
        let tiny = 2.0_f64.powi(-200);
        let raised = SplitVector {
            low: [0.0, 0.0, tiny],
            high: [2.0, 4.0, 8.0],
        };
        let (a, b) = ([2.0, 0.0, 4.0], [0.0, 4.0, 4.0]);
        assert_eq!(determinant(&exact(a), &exact(b), &raised), 8.0 * tiny);
    }
}
