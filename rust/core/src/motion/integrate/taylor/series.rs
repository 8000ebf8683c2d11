//! Taylor coefficients of ω, of the attitude and of directions fixed in space, and the products of series that their
//! equations are made of.
//!
//! With `a_k = a⁽ᵏ⁾/k!` the product of two series has the coefficients `(a b)_k = Σ_j a_j b_{k−j}`, and the equations
//!
//! ```text
//! ω̇ = κ ω ω + …,   q̇ = ½ q∘ω
//! ```
//!
//! give the coefficients of order k + 1 from those up to k. Nearly all work is in these sums. Of the twelve products of
//! numbers in q∘ω two are saved: with `α = w + i z`, `β = x + i y` and `p = ω₁ + i ω₂` the second equation is
//!
//! ```text
//! 2 β̇ = α p − i ω₃ β,   2 α̇ = −β p̄ + i ω₃ α
//! ```
//!
//! and a complex product takes three real ones. With `S = Re α + Im α` those of α p are `ω₁ S`, `(ω₁ + ω₂) z` and `(ω₂ − ω₁) w`:
//! its parts are the first less the second, and the first plus the third.
//! (Gauss's way; Knuth, The Art of Computer Programming 2, §4.6.4.)
//!
//! The recursion stands here once, for any numbers: [`Coefficients`] are stored, and their products added up, in the way of
//! each kind. In doubles the sums are computed in two ways. [`BatchSeries`](super::batch_series::BatchSeries) puts
//! the same component of several motions in the lanes. [`SingleMotionSeries`](super::single::SingleMotionSeries) puts the
//! components of one motion in the lanes, and has a recursion of its own.
//! Both add the same products in the same order, so a motion has the same bits in both.
//! [`DoubleDoubleSeries`](super::double_double::DoubleDoubleSeries) and
//! [`VariationalSeries`](super::variational::VariationalSeries) compute all twelve products.
//!
//! The newest coefficients come last in a sum, because the processor may still be computing them. So a sum goes from the
//! middle outward: first the product of order j < k/2 with k − j, then that of k − j with j.

use super::batch::Batch;
use crate::numerics::number::Number;

/// The highest order of a series in doubles, and the number of its coefficients. The order is even, because
/// [`SingleMotionSeries`](super::single::SingleMotionSeries) sums two orders at a time.
pub(super) const MAX_ORDER_DOUBLE: usize = 26;
pub(super) const COUNT: usize = MAX_ORDER_DOUBLE + 1;
/// The highest order of a series in double-double, and the largest number of coefficients of any series.
pub(super) const MAX_ORDER_DOUBLE_DOUBLE: usize = 40;
pub(super) const MAX_COUNT: usize = MAX_ORDER_DOUBLE_DOUBLE + 1;

/// The coefficients of one order: ω in principal axes, (x, y, z, w) of the attitude, and `B` directions that are fixed in
/// space as seen from the principal axes: the vertical `e_3` of three, or all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficient<T, const B: usize> {
    pub(super) w: [T; 3],
    pub(super) q: [T; 4],
    pub(super) g: [[T; 3]; B],
}

/// Return whether a coefficient of a direction is zero because no torque needs the direction: numbers with derivatives always have
/// room for three.
#[inline(always)]
pub(super) fn is_unused<L: Number, const R: usize>(direction: &[Batch<L, R>; 3]) -> bool {
    let is_zero = |x: &Batch<L, R>| x.0.iter().all(|x| x.real() == L::Real::default());
    L::VARIES && direction.iter().all(is_zero)
}

/// The coefficients of all orders, of one motion or of several, and the sums of their products.
pub(super) trait Coefficients<T, const B: usize> {
    /// Return coefficients that are all zero.
    fn new() -> Self;
    /// Set which component of ω is constant in all motions: the first, the third or none. Its coefficients of orders above zero
    /// are zero, so their products may be left out.
    fn set_constant_component(&mut self, _component: Option<usize>) {}
    /// Shorten each step until the series of the derivatives are as accurate as those of the motion.
    fn limit(&mut self, _steps: &mut [f64]) {}
    /// Change the unit of rates; `ratio` is the old unit over the new one.
    fn rescale(&mut self, _ratio: f64) {}
    /// Return the coefficient of order `k`. Its directions are known once the sums of that order are computed.
    fn get(&self, k: usize) -> Coefficient<T, B>;
    /// Sums of products of one order.
    type Sums;
    /// Compute the sums of order `k` from the coefficients up to k. Called for one order after the other. The bits depend on the
    /// order of the additions, which each kind of numbers has for itself.
    fn sums(&mut self, k: usize) -> Self::Sums;
    /// Return the sums of ω₂ω₃, ω₃ω₁ and ω₁ω₂.
    fn spins(sums: &Self::Sums) -> [T; 3];
}

/// The recursion, one order after the other.
pub(super) trait Series<T, const B: usize>: Coefficients<T, B> {
    /// Set the coefficient of order zero.
    fn start(&mut self, state: &Coefficient<T, B>);
    /// Compute the coefficients of order k + 1 from the sums and the coefficient of ω̇, both of order `k`.
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[T; 3]);
    /// Compute the change of the state within the time `h`. The order is even. Horner's rule in h² runs for even and odd powers
    /// side by side, because each product waits for the one before.
    fn increment(&self, order: usize, h: T) -> [T; 7];
}

/// The coefficients that the recursion needs of each kind of numbers.
pub(super) trait AnyNumber<T, const B: usize>: Coefficients<T, B> {
    /// Set component `i` of ω, of the attitude or of direction `b` in the coefficient of order `k`.
    fn put_omega(&mut self, k: usize, i: usize, x: T);
    fn put_attitude(&mut self, k: usize, i: usize, x: T);
    fn put_direction(&mut self, k: usize, b: usize, i: usize, x: T);
    /// Prepare the products with the coefficient of order `k`, of which all numbers are set.
    fn complete(&mut self, _k: usize) {}
    /// Return component `i` of the sums of q∘ω.
    fn attitude_sum(sums: &Self::Sums, i: usize) -> T;
    /// Return component `i` of the sums of γ×ω for direction `b`; none where [`Coefficients::sums`] computes the directions.
    fn direction_sum(sums: &Self::Sums, b: usize, i: usize) -> Option<T>;
}

impl<L: Number, S: AnyNumber<Batch<L, R>, B>, const R: usize, const B: usize> Series<Batch<L, R>, B>
    for S
{
    #[inline(always)]
    fn start(&mut self, state: &Coefficient<Batch<L, R>, B>) {
        for i in 0..3 {
            self.put_omega(0, i, state.w[i]);
        }
        for i in 0..4 {
            self.put_attitude(0, i, state.q[i]);
        }
        for b in 0..B {
            for i in 0..3 {
                self.put_direction(0, b, i, state.g[b][i]);
            }
        }
        self.complete(0);
    }

    #[inline(always)]
    fn increment(&self, order: usize, h: Batch<L, R>) -> [Batch<L, R>; 7] {
        let square = h * h;
        let mut odd = [Batch::new(0.0); 7];
        let mut even = [Batch::new(0.0); 7];
        for half in (1..=order / 2).rev() {
            let (one, two) = (self.get(2 * half - 1), self.get(2 * half));
            for i in 0..3 {
                odd[i] = odd[i].mul_add(square, one.w[i]);
                even[i] = even[i].mul_add(square, two.w[i]);
            }
            for i in 0..4 {
                odd[3 + i] = odd[3 + i].mul_add(square, one.q[i]);
                even[3 + i] = even[3 + i].mul_add(square, two.q[i]);
            }
        }
        let mut sum = [Batch::new(0.0); 7];
        for i in 0..7 {
            sum[i] = even[i].mul_add(h, odd[i]) * h;
        }
        sum
    }

    #[inline(always)]
    fn extend(&mut self, k: usize, sums: &S::Sums, acceleration: &[Batch<L, R>; 3]) {
        // Number by number: a whole coefficient with derivatives would be copied.
        for i in 0..3 {
            self.put_omega(k + 1, i, acceleration[i].quotient(k + 1));
        }
        for i in 0..4 {
            let sum = S::attitude_sum(sums, i);
            self.put_attitude(k + 1, i, sum.quotient(2 * (k + 1)));
        }
        for b in 0..B {
            for i in 0..3 {
                if let Some(sum) = S::direction_sum(sums, b, i) {
                    self.put_direction(k + 1, b, i, sum.quotient(k + 1));
                }
            }
        }
        self.complete(k + 1);
    }
}
