//! The recurrences of terms that are not linear in the coefficients of one order.

use nalgebra::Vector3;

use super::field::Field;
use super::frame::Precision;
use super::pack::{Pack, cross_term, plus};
use super::series::Series;
use super::twin::COUNT;
use crate::motion::loads::{Forcing, OnOrbit};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::number::{Number, Real};

/// A term of a load as a series: its coefficient of order k from those of the motion up to k, asked for in order.
pub(super) trait Analytic<T, const B: usize> {
    /// The coefficient of order `k` of the angular acceleration, components in principal axes.
    fn coefficient(&mut self, k: usize, series: &impl Series<T, B>, field: &Field<T, B>) -> [T; 3];
}

type Vectors<T> = [[T; 3]; COUNT];

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

/// The gravity gradient on a Kepler orbit: position r and velocity v as seen from the body obey
///
/// ```text
/// ṙ = r×ω + v,   v̇ = v×ω − μ r/r³
/// ```
///
/// and with κ of the body, `I⁻¹ (3μ/r⁵) r×I r = −(3μ/r⁵) κ (r₂r₃, r₃r₁, r₁r₂)`. Powers `p = u^a` of u = r·r follow from
/// `u ṗ = a u̇ p`:
///
/// ```text
/// p_k = Σ_{0<j≤k} (a j − k + j) u_j p_{k−j}/(k u₀)
/// ```
#[derive(Clone, Debug)]
pub(super) struct Gradient<T> {
    position: Vectors<T>,
    velocity: Vectors<T>,
    squares: [T; COUNT],
    /// r⁻³ and r⁻⁵, and (r₂r₃, r₃r₁, r₁r₂).
    cubes: [T; COUNT],
    fifths: [T; COUNT],
    products: Vectors<T>,
    /// What the elements off the diagonal of the tensor make of them.
    tilts: Vectors<T>,
    pull: T,
    strength: T,
}

impl<L: Number, const R: usize> Gradient<Pack<L, R>> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            position: [[zero; 3]; COUNT],
            velocity: [[zero; 3]; COUNT],
            squares: [zero; COUNT],
            cubes: [zero; COUNT],
            fifths: [zero; COUNT],
            products: [[zero; 3]; COUNT],
            tilts: [[zero; 3]; COUNT],
            pull: zero,
            strength: zero,
        }
    }

    /// The orbit's state of one row at the start of a step: components in principal axes.
    pub(super) fn set(
        &mut self,
        row: usize,
        orbit: &OnOrbit<L::Real>,
        position: &Vector3<L::Real>,
        velocity: &Vector3<L::Real>,
    ) {
        for i in 0..3 {
            self.position[0][i].put(row, position[i]);
            self.velocity[0][i].put(row, velocity[i]);
        }
        self.pull.put(row, orbit.pull);
        self.strength.put(row, orbit.strength);
    }

    /// Goes on to the end of a step of length `h`, where the orbit has come by its own series; lengths again over the
    /// distance there.
    #[inline(always)]
    pub(super) fn advance(&mut self, order: usize, h: Pack<L, R>) {
        let mut position = [Pack::new(0.0); 3];
        let mut velocity = [Pack::new(0.0); 3];
        for k in (0..=order).rev() {
            for i in 0..3 {
                position[i] = position[i].mul_add(h, self.position[k][i]);
                velocity[i] = velocity[i].mul_add(h, self.velocity[k][i]);
            }
        }
        for row in 0..R {
            let r = Vector3::from_fn(|i, _| position[i].real(row));
            let v = Vector3::from_fn(|i, _| velocity[i].real(row));
            let distance = r.dot(&r).root();
            let cube = distance * distance * distance;
            let orbit = OnOrbit {
                position: r,
                velocity: v,
                pull: self.pull.real(row) / cube,
                strength: self.strength.real(row) / cube,
            };
            self.set(row, &orbit, &(r / distance), &(v / distance));
        }
    }

    /// Comes to another unit of rates in one row: `ratio` of the old one to the new one.
    pub(super) fn rescale(&mut self, row: usize, ratio: f64) {
        let (once, twice) = (L::Real::from(ratio), L::Real::from(ratio * ratio));
        for v in &mut self.velocity[0] {
            v.put(row, v.real(row) * once);
        }
        self.pull.put(row, self.pull.real(row) * twice);
        (self.strength).put(row, self.strength.real(row) * twice);
    }

    /// What the elements off the diagonal of the tensor add to the coefficient of order `k`.
    #[inline(never)]
    fn tilt<const B: usize>(&mut self, k: usize, field: &Field<Pack<L, R>, B>) -> [Pack<L, R>; 3] {
        let mut squares = [Pack::new(0.0); 3];
        for (a, b) in self.position[..=k]
            .iter()
            .zip(self.position[..=k].iter().rev())
        {
            squares = [0, 1, 2].map(|i| a[i].mul_add(b[i], squares[i]));
        }
        self.tilts[k] = field.tilt(&self.products[k], &squares);
        let mut sum = [Pack::new(0.0); 3];
        for (fifth, tilt) in self.fifths[..=k].iter().rev().zip(&self.tilts) {
            sum = [0, 1, 2].map(|i| fifth.mul_add(tilt[i], sum[i]));
        }
        sum.map(|x| -(self.strength * x))
    }

    /// The next coefficient of the power `a` of the squares, of which the first is one.
    #[inline(always)]
    fn power(&self, a: f64, powers: &[Pack<L, R>; COUNT], k: usize) -> Pack<L, R> {
        if k == 0 {
            return Pack::new(1.0);
        }
        let mut sum = Pack::new(0.0);
        for j in 1..=k {
            let factor = Pack::new(a * j as f64 - (k - j) as f64);
            sum = (self.squares[j] * factor).mul_add(powers[k - j], sum);
        }
        sum * Pack::over(k)
    }
}

impl<L: Number, const R: usize, const B: usize> Analytic<Pack<L, R>, B> for Gradient<Pack<L, R>> {
    #[inline(always)]
    fn coefficient(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        field: &Field<Pack<L, R>, B>,
    ) -> [Pack<L, R>; 3] {
        let next = Next {
            gradient: self,
            k,
            series,
            field,
        };
        if L::VARIES {
            dispatch(next) // whose caller is not compiled for the widest lanes
        } else {
            next.coefficient()
        }
    }
}

/// The next coefficient of a gradient.
struct Next<'a, S, L, const R: usize, const B: usize> {
    gradient: &'a mut Gradient<Pack<L, R>>,
    k: usize,
    series: &'a S,
    field: &'a Field<Pack<L, R>, B>,
}

impl<S: Series<Pack<N, R>, B>, N: Number, const R: usize, const B: usize> Kernel
    for Next<'_, S, N, R, B>
{
    type Output = [Pack<N, R>; 3];

    #[inline(always)]
    fn run<L: Lane>(self) -> [Pack<N, R>; 3] {
        self.coefficient()
    }
}

impl<S: Series<Pack<L, R>, B>, L: Number, const R: usize, const B: usize> Next<'_, S, L, R, B> {
    #[inline(always)]
    fn coefficient(self) -> [Pack<L, R>; 3] {
        let Self {
            gradient: it,
            k,
            series,
            field,
        } = self;
        let zero = Pack::new(0.0);
        let (mut square, mut products) = (zero, [zero; 3]);
        for j in 0..=k {
            let (a, b) = (&it.position[j], &it.position[k - j]);
            for i in 0..3 {
                square = a[i].mul_add(b[i], square);
            }
        }
        for i in 0..3 {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            for j in 0..=k {
                let (a, b) = (&it.position[j], &it.position[k - j]);
                products[i] = a[next].mul_add(b[last], products[i]);
            }
        }
        // u₀ is one but for rounding: lengths are over the distance at the start of the step.
        it.squares[k] = square;
        it.products[k] = products;
        it.cubes[k] = it.power(-1.5, &it.cubes, k);
        it.fifths[k] = it.power(-2.5, &it.fifths, k);
        let (mut turned, mut moved, mut pulled) = ([zero; 3], [zero; 3], [zero; 3]);
        let mut torque = [zero; 3];
        // Loops of their own, since numbers with derivatives fill the registers.
        for j in 0..=k {
            turned = cross_term(&it.position[j], &series.get(k - j).w, turned);
        }
        for j in 0..=k {
            moved = cross_term(&it.velocity[j], &series.get(k - j).w, moved);
        }
        for i in 0..3 {
            for j in 0..=k {
                pulled[i] = it.cubes[k - j].mul_add(it.position[j][i], pulled[i]);
            }
            for j in 0..=k {
                torque[i] = it.fifths[k - j].mul_add(it.products[j][i], torque[i]);
            }
        }
        let reciprocal = Pack::over(k + 1);
        for i in 0..3 {
            it.position[k + 1][i] = (turned[i] + it.velocity[k][i]) * reciprocal;
            it.velocity[k + 1][i] = (-it.pull).mul_add(pulled[i], moved[i]) * reciprocal;
            torque[i] = -(field.kappa[i] * it.strength * torque[i]);
        }
        if L::VARIES && field.is_tilted() {
            torque = plus(torque, it.tilt(k, field));
        }
        torque
    }
}

/// Torques that are cubics in time, in the body or in space: of the latter `Σ_j τ_j·γ_{k−j}` with the axes γ of space.
#[derive(Clone, Debug)]
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
