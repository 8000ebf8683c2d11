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
//! There are two ways through the sums in doubles: [`SingleMotionSeries`](super::single_series::SingleMotionSeries) puts the components of one motion in the
//! lanes, [`BatchSeries`](super::batch_series::BatchSeries) the same component of several. They add the same products in the same order,
//! so a motion has the same bits either way. In numbers of twice the precision there is [`DoubleDoubleSeries`](super::double_double_series::DoubleDoubleSeries), which
//! has all twelve.
//!
//! That order takes the newest coefficients, on which the processor may still be busy, last: from the middle outward, first
//! the product of order j < k/2 with k − j, then that of k − j with j. Directions are made of q: see
//! [`directions`](super::directions).

/// The highest order of a series in doubles, and the number of its coefficients. Even, since
/// [`SingleMotionSeries`](super::single_series::SingleMotionSeries) sums two orders at a time.
pub(super) const HIGHEST_ORDER: usize = 26;
pub(super) const COUNT: usize = HIGHEST_ORDER + 1;

/// 1/k.
pub(super) const RECIPROCALS: [f64; COUNT] = {
    let mut reciprocals = [0.0; COUNT];
    let mut k = 1;
    while k < COUNT {
        reciprocals[k] = 1.0 / k as f64;
        k += 1;
    }
    reciprocals
};

/// The coefficients of one order: ω in principal axes, (x, y, z, w) of the attitude, and `B` directions that are fixed in
/// space as seen from the principal axes: the vertical `e_3` of three, or all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficient<T, const B: usize> {
    pub(super) w: [T; 3],
    pub(super) q: [T; 4],
    pub(super) g: [[T; 3]; B],
}

/// The series of a motion, or of several.
pub(super) trait Series<T, const B: usize> {
    /// All zero.
    fn new() -> Self;
    /// Sets the coefficient of order zero.
    fn start(&mut self, state: &Coefficient<T, B>);
    /// Says which component of ω is constant in all motions, if it is the first or the third: its products of orders above
    /// zero, which are zero, may be left out.
    fn set_constant_component(&mut self, _component: Option<usize>) {}
    /// Keeps each step so short that derivatives too are as good as the series of the motion.
    fn limit(&mut self, _steps: &mut [f64]) {}
    /// Comes to another unit of rates: `ratio` of the old one to the new one.
    fn rescale(&mut self, _ratio: f64) {}
    /// The coefficient of order `k`; the directions are there once the sums of that order are.
    fn get(&self, k: usize) -> Coefficient<T, B>;
    /// What the polynomials of a step, of even order, add to the state within the time `h`: Horner's rule in h², for the even and
    /// the odd powers side by side, since each product waits for the one before.
    fn increment(&self, order: usize, h: T) -> [T; 7];
    /// The sums of products of order `k`.
    type Sums;
    /// Those of order `k`, when the coefficients up to k are set; asked for in order.
    fn sums(&mut self, k: usize) -> Self::Sums;
    /// Those of ω₂ω₃, ω₃ω₁ and ω₁ω₂.
    fn spins(sums: &Self::Sums) -> [T; 3];
    /// Sets the coefficients of order k + 1 from the sums and ω̇'s coefficient of order `k`.
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[T; 3]);
}
