//! The recurrences of terms that are not linear in the coefficients of one order.

use nalgebra::Vector3;

use super::field::Field;
use super::frame::Precision;
use super::pack::Pack;
use super::series::Series;
use super::twin::COUNT;
use crate::motion::loads::Forcing;
use crate::numerics::number::{Number, Real};

/// A term of a load as a series: its coefficient of order k from those of the motion up to k, asked for in order.
pub(super) trait Analytic<T, const B: usize> {
    /// The coefficient of order `k` of the angular acceleration, components in principal axes.
    fn coefficient(&mut self, k: usize, series: &impl Series<T, B>, field: &Field<T, B>) -> [T; 3];
}

/// `E |ω| ω`: with `u = ω·ω` and `s = √u`, from s s = u
///
/// ```text
/// s_k = (u_k − Σ_{0<j<k} s_j s_{k−j})/2s₀
/// ```
///
/// Rounding in s grows as `1/s(t)` does, so a step does not go as far as ω would take to zero at its present rate. Where ω
/// passes through zero all the same the step ends, and at ω = 0 there is no series, and of |ω| ω no second derivative: below
/// [`STILL`](Precision::STILL) of the fastest ω the term counts as zero, in steps over which what it does stays below rounding.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
pub(super) struct Quadratic<T> {
    squares: [T; COUNT],
    speeds: [T; COUNT],
    /// What |ω| is small against, and `1/2s₀`.
    fastest: T,
    half_over_speed: T,
}

impl<L: Number<Real: Precision>, const R: usize> Quadratic<Pack<L, R>> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            squares: [zero; COUNT],
            speeds: [zero; COUNT],
            fastest: Pack::new(1.0),
            half_over_speed: zero,
        }
    }

    #[inline(always)]
    pub(super) fn start(&mut self, fastest: &[f64; R]) {
        for row in 0..R {
            self.fastest.set(row, fastest[row]);
        }
    }

    /// Whether one row's ω is not as good as zero, so that there is a series of |ω|.
    pub(super) fn is_under_way(&self, row: usize) -> bool {
        self.speeds[0].get(row) > 0.0
    }

    /// Whether one row's ω, `start` at the start of the step, has turned against it: where ω passes through zero along a line,
    /// the series goes on as −|ω|, which is not the law beyond.
    pub(super) fn is_reversed(&self, row: usize, start: &[f64; 3], omega: &[f64; 3]) -> bool {
        let along: f64 = (0..3).map(|i| start[i] * omega[i]).sum();
        self.is_under_way(row) && along < 0.0
    }
}

impl<L: Number<Real: Precision>, const R: usize, const B: usize> Analytic<Pack<L, R>, B>
    for Quadratic<Pack<L, R>>
{
    #[inline(always)]
    fn coefficient(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        field: &Field<Pack<L, R>, B>,
    ) -> [Pack<L, R>; 3] {
        let mut square = Pack::new(0.0);
        for j in 0..=k {
            let (a, b) = (series.get(j).w, series.get(k - j).w);
            for i in 0..3 {
                square = a[i].mul_add(b[i], square);
            }
        }
        self.squares[k] = square;
        self.speeds[k] = Pack::new(0.0);
        if k == 0 {
            for row in 0..R {
                let speed = square.real(row).root();
                let moves = speed.rounded() > L::Real::STILL * self.fastest.get(row);
                self.speeds[0].set(row, 0.0);
                self.half_over_speed.set(row, 0.0);
                if moves {
                    self.speeds[0].put(row, speed);
                    (self.half_over_speed).put(row, L::Real::from(0.5) / speed);
                }
            }
        } else {
            let mut rest = square;
            for j in 1..k {
                rest = (-self.speeds[j]).mul_add(self.speeds[k - j], rest);
            }
            self.speeds[k] = rest * self.half_over_speed;
        }
        let mut spin = [Pack::new(0.0); 3];
        for j in 0..=k {
            let w = series.get(k - j).w;
            for i in 0..3 {
                spin[i] = self.speeds[j].mul_add(w[i], spin[i]);
            }
        }
        let mut sum = [Pack::new(0.0); 3];
        for n in 0..3 {
            for i in 0..3 {
                sum[n] = field.quadratic[n][i].mul_add(spin[i], sum[n]);
            }
        }
        sum
    }
}

/// Torques that are cubics in time, in the body or in space: of the latter `Σ_j τ_j·γ_{k−j}` with the axes γ of space.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
pub(super) struct Forced<T> {
    in_body: [[T; 3]; 4],
    in_space: [[T; 3]; 4],
    inverse_moments: [T; 3],
}

impl<L: Number, const R: usize> Forced<Pack<L, R>> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            in_body: [[zero; 3]; 4],
            in_space: [[zero; 3]; 4],
            inverse_moments: [zero; 3],
        }
    }

    /// The cubics of one row at the start of a step.
    pub(super) fn set(
        &mut self,
        row: usize,
        forcing: &Forcing<L::Real>,
        inverse_moments: &Vector3<L::Real>,
    ) {
        for i in 0..3 {
            for k in 0..4 {
                self.in_body[k][i].put(row, forcing.in_body[k][i]);
                self.in_space[k][i].put(row, forcing.in_space[k][i]);
            }
            self.inverse_moments[i].put(row, inverse_moments[i]);
        }
    }
}

impl<L: Number, const R: usize, const B: usize> Analytic<Pack<L, R>, B> for Forced<Pack<L, R>> {
    #[inline(always)]
    fn coefficient(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        _: &Field<Pack<L, R>, B>,
    ) -> [Pack<L, R>; 3] {
        let mut sum = [Pack::new(0.0); 3];
        if B == 3 {
            for j in 0..=k.min(3) {
                let g = series.get(k - j).g;
                for (axis, direction) in g.iter().enumerate() {
                    for i in 0..3 {
                        sum[i] = self.in_space[j][axis].mul_add(direction[i], sum[i]);
                    }
                }
            }
        }
        for i in 0..3 {
            sum[i] = sum[i] * self.inverse_moments[i];
            if k < 4 {
                sum[i] = sum[i] + self.in_body[k][i];
            }
        }
        sum
    }
}
