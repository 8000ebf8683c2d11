//! Differences of coordinates without rounding, and what is made of them with one rounding.

use super::double_double::{two_product, two_sum};
use super::lane::Lane;

/// A vector as rounded components and what rounding left of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SplitVector<const N: usize> {
    /// The components, rounded.
    pub high: [f64; N],
    /// What rounding left.
    pub low: [f64; N],
}

impl<const N: usize> SplitVector<N> {
    /// `a − b` exactly.
    #[must_use]
    #[inline]
    pub(crate) fn difference(a: &[f64; N], b: &[f64; N]) -> Self {
        let parts: [(f64, f64); N] = std::array::from_fn(|i| two_sum(a[i], -b[i]));
        Self {
            high: parts.map(|part| part.0),
            low: parts.map(|part| part.1),
        }
    }

    /// The vector times a power of two, exactly while nothing leaves the range of float64.
    #[must_use]
    #[inline]
    pub(crate) fn scaled(&self, power_of_two: f64) -> Self {
        Self {
            high: self.high.map(|x| x * power_of_two),
            low: self.low.map(|x| x * power_of_two),
        }
    }

    /// `v·n`, rounded about once even where large terms cancel.
    #[must_use]
    #[inline]
    pub(crate) fn dot(&self, n: &[f64; N]) -> f64 {
        let (mut sum, mut rest) = (0.0, 0.0);
        for ((&high, &low), &n) in self.high.iter().zip(&self.low).zip(n) {
            let (product, product_rest) = two_product(high, n);
            let (total, total_rest) = two_sum(sum, product);
            sum = total;
            rest += product_rest + total_rest + low * n;
        }
        sum + rest
    }
}

/// The scalar products of a vector, rounded components and what rounding left of each, with three axes: the errors of the
/// products are carried along, so that what is left where large terms cancel is that of the vector.
#[inline(always)]
pub(crate) fn along_axes<L: Lane>(vector: [(L, L); 3], axes: &[[f64; 3]; 3]) -> [L; 3] {
    let [(x, x_low), (y, y_low), (z, z_low)] = vector;
    // No `map`: its closure would be compiled without the instructions of the level.
    let mut along = [x; 3];
    for (along, [a, b, c]) in along.iter_mut().zip(*axes) {
        let (a, b, c) = (L::new(a), L::new(b), L::new(c));
        let ((p, e), (q, f), (r, g)) = (x.two_product(a), y.two_product(b), z.two_product(c));
        let (partial, h) = two_sum(p, q);
        let (sum, i) = two_sum(partial, r);
        let low = x_low.mul_add(a, y_low.mul_add(b, z_low * c));
        *along = sum + (low + (e + f + g) + (h + i));
    }
    along
}

/// `a × b` of two vectors of the plane, rounded about once.
#[must_use]
#[inline]
pub(crate) fn cross2(a: &SplitVector<2>, b: &SplitVector<2>) -> f64 {
    let (value, rest) = difference_of_products(a.high[0], b.high[1], a.high[1], b.high[0]);
    let low = (a.high[0] * b.low[1] - a.high[1] * b.low[0])
        + (a.low[0] * b.high[1] - a.low[1] * b.high[0]);
    value + (rest + low)
}

/// `a × b`, each component rounded about once.
#[must_use]
#[inline]
pub(crate) fn cross(a: &SplitVector<3>, b: &SplitVector<3>) -> [f64; 3] {
    let plane = |v: &SplitVector<3>, j: usize, k: usize| SplitVector {
        high: [v.high[j], v.high[k]],
        low: [v.low[j], v.low[k]],
    };
    let along = |j: usize, k: usize| cross2(&plane(a, j, k), &plane(b, j, k));
    [along(1, 2), along(2, 0), along(0, 1)]
}

/// `det(a, b, c)`, rounded about once.
#[must_use]
#[inline]
pub(crate) fn determinant(a: &SplitVector<3>, b: &SplitVector<3>, c: &SplitVector<3>) -> f64 {
    let (mut sum, mut rest) = (0.0, 0.0);
    for [i, j, k] in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
        let (cross, cross_rest) =
            difference_of_products(b.high[j], c.high[k], b.high[k], c.high[j]);
        let (product, product_rest) = two_product(a.high[i], cross);
        let (total, total_rest) = two_sum(sum, product);
        sum = total;
        // To first order in what rounding left of the components.
        let low = (b.low[j] * c.high[k] - b.low[k] * c.high[j])
            + (b.high[j] * c.low[k] - b.high[k] * c.low[j]);
        rest += product_rest + total_rest + a.high[i] * (cross_rest + low) + a.low[i] * cross;
    }
    sum + rest
}

/// `p q − r s` as a rounded value and its rest.
#[inline]
fn difference_of_products(p: f64, q: f64, r: f64, s: f64) -> (f64, f64) {
    let ((first, first_rest), (second, second_rest)) = (two_product(p, q), two_product(r, s));
    let (sum, rest) = two_sum(first, -second);
    (sum, rest + (first_rest - second_rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slivers_far_away_keep_their_measure() {
        // Corners on a lattice far from the origin: differences are exact, products cancel to the last bits.
        let far = 2.0_f64.powi(40);
        let at = |x: f64, y: f64, z: f64| [far + x, far + y, far + z];
        let n = 2.0_f64.powi(27) + 1.0;
        let split = |p: [f64; 3]| SplitVector::difference(&p, &at(0.0, 0.0, 0.0));
        let (a, b, c) = (
            split(at(n, n - 1.0, 0.0)),
            split(at(n + 1.0, n, 0.0)),
            split(at(0.0, 0.0, 1.0)),
        );
        assert_eq!(determinant(&a, &b, &c), 1.0);
        let plane = |v: SplitVector<3>| SplitVector {
            high: [v.high[0], v.high[1]],
            low: [v.low[0], v.low[1]],
        };
        assert_eq!(cross2(&plane(a), &plane(b)), 1.0);
        assert_eq!(cross(&a, &b), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn dot_keeps_what_cancels() {
        let v = SplitVector::difference(&[1.0, 1.0], &[2.0_f64.powi(-60), 0.0]);
        assert_eq!(v.dot(&[1.0, -1.0]), -(2.0_f64.powi(-60)));
    }
}
