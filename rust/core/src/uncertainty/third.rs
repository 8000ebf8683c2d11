//! Third-order terms of principal moments and axes, and what they do to variances.
//!
//! A tensor in its principal axes is `diag(I_k) + W`, W linear in normal variables. By perturbation theory, with
//! `g_kj = I_k − I_j`, the third-order term of a moment is
//! `Σ_jm w_kj w_jm w_mk/(g_kj g_km) − w_kk Σ_j w_kj²/g_kj²` over j, m ≠ k. Of the angle between two axes it is, for the two
//! alone, that of `½ atan(2 w/(g + Δ))`: `w (Δ² − ⁴⁄₃ w²)/g³` with `g = I_j − I_i` and `Δ = w_jj − w_ii`; what the third axis
//! adds is smaller where this matters, at a narrow gap. Means of four normal variables are sums of products of their covariances
//! (Isserlis, Biometrika 12, 1918).

use nalgebra::{Matrix3, SMatrix};

use crate::mass::ten::{ELEMENTS, place};
use crate::principal::derivative::DEGENERATE_RTOL;

/// The covariance of the elements of W.
#[derive(Clone, Copy, Debug)]
pub(super) struct Third {
    moments: [f64; 3],
    covariance: SMatrix<f64, 6, 6>,
    /// The variances of the gaps across each axis, with what turns the two moments into one another: by themselves, since as
    /// differences of covariances they would be rounding where moments stay equal.
    gaps: [f64; 3],
}

/// The two moments across an axis, in ascending order.
pub(super) const fn across(axis: usize) -> (usize, usize) {
    [(1, 2), (0, 2), (0, 1)][axis]
}

/// An element of W by its place.
type Element = (usize, usize);

impl Third {
    /// Of a body with these moments, without doubts yet.
    pub(super) fn new(moments: [f64; 3]) -> Self {
        Self {
            moments,
            covariance: SMatrix::zeros(),
            gaps: [0.0; 3],
        }
    }

    /// Adds what one variable does to the tensor.
    pub(super) fn add(&mut self, change: &Matrix3<f64>) {
        for (k, gap) in self.gaps.iter_mut().enumerate() {
            let (i, j) = across(k);
            let difference = change[(j, j)] - change[(i, i)];
            *gap += difference * difference + 4.0 * change[(i, j)] * change[(i, j)];
        }
        let elements = ELEMENTS.map(|place| change[place]);
        for (i, a) in elements.iter().enumerate() {
            for (j, b) in elements.iter().enumerate() {
                self.covariance[(i, j)] += a * b;
            }
        }
    }

    /// `E[a b]`.
    fn two(&self, a: Element, b: Element) -> f64 {
        self.covariance[(place(a.0, a.1), place(b.0, b.1))]
    }

    /// `E[a b c d]`.
    fn four(&self, [a, b, c, d]: [Element; 4]) -> f64 {
        self.two(a, b) * self.two(c, d)
            + self.two(a, c) * self.two(b, d)
            + self.two(a, d) * self.two(b, c)
    }

    /// The variance of the gap between the two moments across an axis, with what turns them into one another.
    pub(super) fn gap(&self, k: usize) -> f64 {
        self.gaps[k]
    }

    /// `1/(I_i − I_j)`; zero between equal moments, which are told by their gap.
    fn over(&self, i: usize, j: usize) -> f64 {
        let gap = self.moments[i] - self.moments[j];
        if gap.abs() > DEGENERATE_RTOL * self.moments[2] {
            1.0 / gap
        } else {
            0.0
        }
    }

    /// Twice the mean of the first- times the third-order term of moment k.
    pub(super) fn of_moment(&self, k: usize) -> f64 {
        let l = (k, k);
        let others = [(k + 1) % 3, (k + 2) % 3];
        let mut sum = 0.0;
        for j in others {
            sum -= self.over(k, j).powi(2) * self.four([l, l, (k, j), (k, j)]);
            for m in others {
                sum += self.over(k, j) * self.over(k, m) * self.four([l, (k, j), (j, m), (m, k)]);
            }
        }
        2.0 * sum
    }

    /// Of the angle about axis k.
    pub(super) fn of_angle(&self, k: usize) -> f64 {
        let (i, j) = across(k);
        let (a, b, w) = ((i, i), (j, j), (i, j));
        let squares =
            self.four([w, w, a, a]) + self.four([w, w, b, b]) - 2.0 * self.four([w, w, a, b]);
        let over = self.over(j, i);
        2.0 * over.powi(4) * (squares - 4.0 / 3.0 * self.four([w, w, w, w]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::principal::principal_axes;

    #[test]
    fn terms_of_moments_and_angles_are_those_of_a_line() {
        // One variable z: every element is a multiple of it, and E[z⁴] = 3.
        let moments = [2.0, 3.0, 4.5];
        let change = Matrix3::new(0.3, 0.2, 0.1, 0.2, -0.4, 0.25, 0.1, 0.25, 0.2);
        let mut third = Third::new(moments);
        third.add(&change);
        let h = 0.01;
        let at = |s: f64| {
            principal_axes(&(Matrix3::from_diagonal(&moments.into()) + change * s)).moments
        };
        let [far, near, back, beyond] = [2.0 * h, h, -h, -2.0 * h].map(at);
        for k in 0..3 {
            let cubic = (far[k] - 2.0 * near[k] + 2.0 * back[k] - beyond[k]) / (12.0 * h * h * h);
            let expected = 2.0 * 3.0 * change[(k, k)] * cubic;
            let found = third.of_moment(k);
            assert!(
                (found - expected).abs() < 2e-3 * expected.abs(),
                "{found} {expected}"
            );
        }
        // Two axes alone.
        let change = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.0, 0.2, 0.3);
        let mut third = Third::new(moments);
        third.add(&change);
        let (w, delta, g) = (0.2, 0.2, 1.5);
        let cubic = w * (delta * delta - 4.0 / 3.0 * w * w) / (g * g * g);
        assert!((third.of_angle(0) - 6.0 * w / g * cubic).abs() < 1e-15);
        assert!((third.gap(0) - (delta * delta + 4.0 * w * w)).abs() < 1e-15);
        assert_eq!([third.of_angle(1), third.of_angle(2)], [0.0; 2]);
    }

    #[test]
    fn equal_moments_have_none() {
        let mut third = Third::new([1.0, 2.0, 2.0]);
        third.add(&Matrix3::from_element(0.1));
        assert_eq!(third.of_angle(0), 0.0);
        assert!(third.of_moment(1).is_finite());
    }
}
