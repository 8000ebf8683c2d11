//! Terms of higher order of principal moments and axes, and what they do to variances.
//!
//! A tensor in its principal axes is `diag(I_k) + W`, W linear in normal variables. By perturbation theory, with
//! `g_kj = I_k − I_j`, a moment has the terms
//!
//! - `e_k = Σ_j w_kj²/g_kj`,
//! - `c_k = Σ_jm w_kj w_jm w_mk/(g_kj g_km) − w_kk Σ_j w_kj²/g_kj²`, over j, m ≠ k,
//!
//! and the angle between two axes i, j, beside the third axis k,
//!
//! - `e_ij = [(w_ii − w_jj) w_ij/g_ji + ½ w_ik w_kj (1/g_jk − 1/g_ki)]/g_ji`,
//! - `c_ij = w_ij (Δ² − ⁴⁄₃ w_ij²)/g_ji³` with `Δ = w_jj − w_ii`: that of `½ atan(2 w/(g + Δ))`, of the two alone. What the
//!   third axis adds is smaller where this matters, at a narrow gap.
//!
//! Means of four normal variables are sums of products of their covariances (Isserlis, Biometrika 12, 1918).

use nalgebra::{Matrix3, SMatrix};

use crate::mass::ten::{ELEMENTS, place};
use crate::principal::derivative::DEGENERATE_RTOL;

/// An element of W by its place among the six; from six on, what radii of gyration depend on.
type Row = usize;

/// A product of two elements of W, with a factor.
type Product = (f64, Row, Row);

/// A sum of products of two elements of W: a term of second order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Second([Product; 3]);

impl Second {
    /// Its value for one W.
    pub(super) fn of(&self, change: &Matrix3<f64>) -> f64 {
        self.0
            .iter()
            .map(|&(factor, a, b)| factor * change[ELEMENTS[a]] * change[ELEMENTS[b]])
            .sum()
    }
}

/// The covariance of the elements of W, and of `m (k²)′ = W_kk − k² δm` for the three radii of gyration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Higher {
    moments: [f64; 3],
    radii: [f64; 3],
    covariance: SMatrix<f64, 9, 9>,
    /// The variances of the gaps across each axis, with what turns the two moments into one another: by themselves, since as
    /// differences of covariances they would be rounding where moments stay equal.
    gaps: [f64; 3],
}

/// The two moments across an axis, in ascending order.
pub(super) const fn across(axis: usize) -> (usize, usize) {
    [(1, 2), (0, 2), (0, 1)][axis]
}

impl Higher {
    /// Of a body with these moments and radii of gyration, without doubts yet.
    pub(super) fn new(moments: [f64; 3], radii: [f64; 3]) -> Self {
        Self {
            moments,
            radii,
            covariance: SMatrix::zeros(),
            gaps: [0.0; 3],
        }
    }

    /// Adds what one variable does to the tensor and to the mass.
    pub(super) fn add(&mut self, change: &Matrix3<f64>, mass: f64) {
        for (k, gap) in self.gaps.iter_mut().enumerate() {
            let (i, j) = across(k);
            let difference = change[(j, j)] - change[(i, i)];
            *gap += difference * difference + 4.0 * change[(i, j)] * change[(i, j)];
        }
        let rows: [f64; 9] = std::array::from_fn(|row| match row {
            0..6 => change[ELEMENTS[row]],
            _ => change[(row - 6, row - 6)] - self.radii[row - 6].powi(2) * mass,
        });
        for (i, a) in rows.iter().enumerate() {
            for (j, b) in rows.iter().enumerate() {
                self.covariance[(i, j)] += a * b;
            }
        }
    }

    /// `E[a b]`.
    fn two(&self, a: Row, b: Row) -> f64 {
        self.covariance[(a, b)]
    }

    /// `E[a b c d]`.
    fn four(&self, [a, b, c, d]: [Row; 4]) -> f64 {
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

    /// The second-order term of moment k.
    pub(super) fn second_of_moment(&self, k: usize) -> Second {
        let product = |j: usize| (self.over(k, j), place(k, j), place(k, j));
        Second([product((k + 1) % 3), product((k + 2) % 3), (0.0, 0, 0)])
    }

    /// Of the angle about axis k.
    pub(super) fn second_of_angle(&self, k: usize) -> Second {
        let (i, j) = across(k);
        let over = self.over(j, i);
        let beside = 0.5 * over * (self.over(j, k) - self.over(k, i));
        Second([
            (over * over, place(i, i), place(i, j)),
            (-over * over, place(j, j), place(i, j)),
            (beside, place(i, k), place(k, j)),
        ])
    }

    /// The variance of a second-order term.
    pub(super) fn variance(&self, term: &Second) -> f64 {
        let mut variance = 0.0;
        for &(f, a, b) in &term.0 {
            for &(g, c, d) in &term.0 {
                variance +=
                    f * g * (self.two(a, c) * self.two(b, d) + self.two(a, d) * self.two(b, c));
            }
        }
        variance
    }

    /// Twice the mean of the first- times the third-order term of moment k.
    pub(super) fn of_moment(&self, k: usize) -> f64 {
        self.of_moment_with(k, place(k, k))
    }

    /// Of radius of gyration k, times `4 m² k²`.
    pub(super) fn of_radius(&self, k: usize) -> f64 {
        self.of_moment_with(k, 6 + k)
    }

    fn of_moment_with(&self, k: usize, first: Row) -> f64 {
        let others = [(k + 1) % 3, (k + 2) % 3];
        let mut sum = 0.0;
        for j in others {
            let w = place(k, j);
            sum -= self.over(k, j).powi(2) * self.four([first, place(k, k), w, w]);
            for m in others {
                let over = self.over(k, j) * self.over(k, m);
                sum += over * self.four([first, w, place(j, m), place(m, k)]);
            }
        }
        2.0 * sum
    }

    /// Of the angle about axis k, in the sense of [`Self::second_of_angle`].
    pub(super) fn of_angle(&self, k: usize) -> f64 {
        let (i, j) = across(k);
        let (a, b, w) = (place(i, i), place(j, j), place(i, j));
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

    const MOMENTS: [f64; 3] = [2.0, 3.0, 4.5];

    /// One variable z: every element is a multiple of it, and E[z⁴] = 3.
    fn one() -> (Matrix3<f64>, Higher) {
        let change = Matrix3::new(0.3, 0.2, 0.1, 0.2, -0.4, 0.25, 0.1, 0.25, 0.2);
        let mut higher = Higher::new(MOMENTS, [1.0; 3]);
        higher.add(&change, 0.1);
        (change, higher)
    }

    #[test]
    fn terms_of_moments_and_angles_are_those_of_a_line() {
        let (change, higher) = one();
        let h = 0.01;
        let at = |s: f64| {
            principal_axes(&(Matrix3::from_diagonal(&MOMENTS.into()) + change * s)).moments
        };
        let [far, near, back, beyond] = [2.0 * h, h, -h, -2.0 * h].map(at);
        for k in 0..3 {
            let cubic = (far[k] - 2.0 * near[k] + 2.0 * back[k] - beyond[k]) / (12.0 * h * h * h);
            let expected = 2.0 * 3.0 * change[(k, k)] * cubic;
            let found = higher.of_moment(k);
            assert!(
                (found - expected).abs() < 2e-3 * expected.abs(),
                "{found} {expected}"
            );
            let of_radius = expected * (change[(k, k)] - 0.1) / change[(k, k)];
            assert!((higher.of_radius(k) - of_radius).abs() < 2e-3 * of_radius.abs());
        }
        // Two axes alone.
        let change = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.0, 0.2, 0.3);
        let mut higher = Higher::new(MOMENTS, [1.0; 3]);
        higher.add(&change, 0.1);
        let (w, delta, g) = (0.2, 0.2, 1.5);
        let cubic = w * (delta * delta - 4.0 / 3.0 * w * w) / (g * g * g);
        assert!((higher.of_angle(0) - 6.0 * w / g * cubic).abs() < 1e-15);
        assert!((higher.gap(0) - (delta * delta + 4.0 * w * w)).abs() < 1e-15);
        assert_eq!([higher.of_angle(1), higher.of_angle(2)], [0.0; 2]);
    }

    #[test]
    fn second_order_terms_are_those_of_differences() {
        let (change, higher) = one();
        let h = 1e-3;
        let at = |s: f64| principal_axes(&(Matrix3::from_diagonal(&MOMENTS.into()) + change * s));
        let [above, here, below] = [h, 0.0, -h].map(at);
        let turn = |end: &crate::PrincipalAxes| {
            let turn = here.axes.tr_mul(&end.axes);
            nalgebra::Rotation3::from_matrix_unchecked(turn).scaled_axis()
        };
        let (forth, back) = (turn(&above), turn(&below));
        for k in 0..3 {
            let moment =
                (above.moments[k] - 2.0 * here.moments[k] + below.moments[k]) / (2.0 * h * h);
            let second = higher.second_of_moment(k);
            assert!((second.of(&change) - moment).abs() < 1e-5);
            // One variable: var(z²) = 2.
            let variance = higher.variance(&second);
            assert!((variance - 2.0 * second.of(&change).powi(2)).abs() < 1e-15);
            // An angle about axis 2 turns axis 1 into axis 3 backwards.
            let sign = if k == 1 { 1.0 } else { -1.0 };
            let angle = sign * (forth[k] + back[k]) / (2.0 * h * h);
            let found = higher.second_of_angle(k).of(&change);
            assert!((found - angle).abs() < 1e-4, "{k} {found} {angle}");
        }
    }

    #[test]
    fn equal_moments_have_none() {
        let mut higher = Higher::new([1.0, 2.0, 2.0], [1.0; 3]);
        higher.add(&Matrix3::from_element(0.1), 0.0);
        assert_eq!(higher.of_angle(0), 0.0);
        assert!(higher.of_moment(1).is_finite());
    }
}
