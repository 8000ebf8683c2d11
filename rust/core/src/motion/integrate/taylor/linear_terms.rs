//! The terms of the equations that are linear in the coefficients of one order, between two breaks of the load.

use super::batch::Batch;
use super::series::Coefficient;
use crate::motion::loads::SeriesStructure;
use crate::numerics::number::Number;

type Square<T> = [[T; 3]; 3];

/// `ω̇ = κ (ω₂ω₃, ω₃ω₁, ω₁ω₂) + c + A ω + Q q + Σ_b G_b γ_b`, components in principal axes.
///
/// κ₁ = (I₂ − I₃)/I₁ and cyclic; c a torque constant in the body, A damping, Q feedback, `G_b` torques of what is fixed in
/// space, each divided by the moments.
#[derive(Clone, Debug)]
pub(super) struct LinearTerms<T, const B: usize> {
    pub(super) kappa: [T; 3],
    /// One over the moments, and the elements 23, 31, 12 of the tensor: zero without derivatives.
    pub(super) inverse_moments: [T; 3],
    pub(super) products: [T; 3],
    /// κ and the elements 23, 31, 12 of the tensor for the gravity gradient: of the body with its wheels locked.
    pub(super) pull: ([T; 3], [T; 3]),
    pub(super) constant: [T; 3],
    pub(super) on_omega: Square<T>,
    pub(super) on_attitude: [[T; 4]; 3],
    pub(super) on_space: [Square<T>; B],
    /// Force over mass: constant in N, and constant in the body.
    pub(super) force: [T; 3],
    pub(super) thrust: [T; 3],
}

impl<T: Copy, const B: usize> LinearTerms<T, B> {
    /// Return terms that are all zero.
    #[inline(always)]
    pub(super) fn none(zero: T) -> Self {
        Self {
            kappa: [zero; 3],
            inverse_moments: [zero; 3],
            products: [zero; 3],
            pull: ([zero; 3], [zero; 3]),
            constant: [zero; 3],
            on_omega: [[zero; 3]; 3],
            on_attitude: [[zero; 4]; 3],
            on_space: [[[zero; 3]; 3]; B],
            force: [zero; 3],
            thrust: [zero; 3],
        }
    }
}

impl<X: Copy + Default + PartialEq, const B: usize> LinearTerms<X, B> {
    /// Return whether each component of ω is constant: that along the axis of a symmetric body without a torque about it.
    pub(super) fn constant_components(&self) -> [bool; 3] {
        let zero = X::default();
        [0, 1, 2].map(|n| {
            let on_space = self.on_space.iter().flat_map(|matrix| &matrix[n]);
            let pulled = self.pull.1.iter().chain([&self.pull.0[n]]);
            [self.kappa[n], self.constant[n]]
                .iter()
                .chain(pulled)
                .chain(&self.on_omega[n])
                .chain(&self.on_attitude[n])
                .chain(on_space)
                .all(|x| *x == zero)
        })
    }
}

impl<L: Number, const R: usize, const B: usize> LinearTerms<Batch<L, R>, B> {
    /// Set the terms of one row.
    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, linear_terms: &LinearTerms<L::Real, B>) {
        for n in 0..3 {
            self.kappa[n].put(row, linear_terms.kappa[n]);
            (self.inverse_moments[n]).put(row, linear_terms.inverse_moments[n]);
            self.pull.0[n].put(row, linear_terms.pull.0[n]);
            self.pull.1[n].put(row, linear_terms.pull.1[n]);
            if L::VARIES {
                self.products[n].put(row, linear_terms.products[n]);
            }
            self.constant[n].put(row, linear_terms.constant[n]);
            self.force[n].put(row, linear_terms.force[n]);
            self.thrust[n].put(row, linear_terms.thrust[n]);
            for i in 0..3 {
                self.on_omega[n][i].put(row, linear_terms.on_omega[n][i]);
            }
            for i in 0..4 {
                self.on_attitude[n][i].put(row, linear_terms.on_attitude[n][i]);
            }
            for b in 0..B {
                for i in 0..3 {
                    self.on_space[b][n][i].put(row, linear_terms.on_space[b][n][i]);
                }
            }
        }
    }

    /// Compute the coefficient of order `k` of ω̇ from the products of the series of ω and the coefficients of that order.
    #[inline(always)]
    pub(super) fn acceleration(
        &self,
        parts: SeriesStructure,
        k: usize,
        products: [Batch<L, R>; 3],
        at: &Coefficient<Batch<L, R>, B>,
    ) -> [Batch<L, R>; 3] {
        // Written out: a loop would keep the sums in memory.
        let [mut x, mut y, mut z] = [Batch::new(0.0); 3];
        if k == 0 {
            let [a, b, c] = self.constant;
            [x, y, z] = [x + a, y + b, z + c];
        }
        for ([a, b, c], g) in self.on_space.iter().zip(&at.g) {
            x = plus_product(a, g, x);
            y = plus_product(b, g, y);
            z = plus_product(c, g, z);
        }
        if parts.on_omega {
            let [a, b, c] = &self.on_omega;
            x = plus_product(a, &at.w, x);
            y = plus_product(b, &at.w, y);
            z = plus_product(c, &at.w, z);
        }
        if parts.on_attitude {
            let [a, b, c] = &self.on_attitude;
            x = plus_product(a, &at.q, x);
            y = plus_product(b, &at.q, y);
            z = plus_product(c, &at.q, z);
        }
        let ([a, b, c], [s, t, u]) = (self.kappa, products);
        [a.mul_add(s, x), b.mul_add(t, y), c.mul_add(u, z)]
    }
}

impl<L: Number, const R: usize, const B: usize> LinearTerms<Batch<L, R>, B> {
    /// Return whether elements off the diagonal of the tensor have derivatives.
    pub(super) fn has_off_diagonal(&self) -> bool {
        !are_zero(&self.products)
    }

    /// Return whether the tensor for the gravity gradient has elements off the diagonal.
    pub(super) fn pull_has_off_diagonal(&self) -> bool {
        !are_zero(&self.pull.1)
    }

    /// Compute the part of `−x×I x`, over the moments, that the elements 23, 31, 12 of a tensor make, from the coefficients of
    /// (x₂x₃, x₃x₁, x₁x₂) and of (x₁², x₂², x₃²); cyclic in i, j, k:
    ///
    /// ```text
    /// −I_ki x_i x_j + I_ij x_k x_i + I_jk (x_k² − x_j²)
    /// ```
    #[inline(always)]
    pub(super) fn off_diagonal_torque(
        &self,
        p: &[Batch<L, R>; 3],
        mixed: &[Batch<L, R>; 3],
        squares: &[Batch<L, R>; 3],
    ) -> [Batch<L, R>; 3] {
        let mut sum = [Batch::new(0.0); 3];
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let torque = p[k] * mixed[j] - p[j] * mixed[k] + p[i] * (squares[k] - squares[j]);
            sum[i] = torque * self.inverse_moments[i];
        }
        sum
    }

    /// Compute `I⁻¹ N` to first order in these elements, from N over the moments.
    pub(super) fn divide_by_off_diagonal(&self, quotient: &[Batch<L, R>; 3]) -> [Batch<L, R>; 3] {
        let (p, a) = (&self.products, quotient);
        [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
            .map(|(i, j, k)| a[i] - (p[k] * a[j] + p[j] * a[k]) * self.inverse_moments[i])
    }
}

fn are_zero<L: Number, const R: usize>(numbers: &[Batch<L, R>; 3]) -> bool {
    let is_zero = |x: &Batch<L, R>| (0..R).all(|row| x.real(row) == L::Real::default());
    numbers.iter().all(is_zero)
}

/// Compute `sum + a·b`.
#[inline(always)]
fn plus_product<L: Number, const R: usize, const N: usize>(
    a: &[Batch<L, R>; N],
    b: &[Batch<L, R>; N],
    mut sum: Batch<L, R>,
) -> Batch<L, R> {
    for i in 0..N {
        sum = a[i].mul_add(b[i], sum);
    }
    sum
}
