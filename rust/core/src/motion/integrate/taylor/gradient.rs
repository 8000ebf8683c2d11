//! The recurrence of the gravity gradient.

use nalgebra::Vector3;

use super::field::Field;
use super::pack::{Pack, cross_term, plus};
use super::series::Series;
use super::terms::Analytic;
use super::twin::COUNT;
use crate::motion::loads::OnOrbit;
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::number::{Number, Real};

type Vectors<T> = [[T; 3]; COUNT];

/// The gravity gradient on a Kepler orbit: position r and velocity v as seen from the body obey
///
/// ```text
/// ṙ = r×ω + v,   v̇ = v×ω − μ r/r³
/// ```
///
/// and with κ of the body, its wheels locked, `I⁻¹ (3μ/r⁵) r×I r = −(3μ/r⁵) κ (r₂r₃, r₃r₁, r₁r₂)`; what is off the diagonal of
/// that tensor is added by [`Field::tilt`]. Powers `p = u^a` of u = r·r follow from `u ṗ = a u̇ p`:
///
/// ```text
/// p_k = Σ_{0<j≤k} ((a + 1) j − k) u_j p_{k−j}/(k u₀)
/// ```
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
pub(super) struct Gradient<T> {
    position: Vectors<T>,
    velocity: Vectors<T>,
    /// ω.
    spin: Vectors<T>,
    /// `u_k` and `k u_k`.
    squares: [T; COUNT],
    slopes: [T; COUNT],
    /// r⁻³ and r⁻⁵, and (r₂r₃, r₃r₁, r₁r₂).
    cubes: [T; COUNT],
    fifths: [T; COUNT],
    products: Vectors<T>,
    /// What the elements off the diagonal of the tensor make of them.
    tilts: Vectors<T>,
    pull: T,
    strength: T,
    /// r₀, and `r·v` at the end of the last step.
    distance: T,
    progress: T,
}

impl<L: Number, const R: usize> Gradient<Pack<L, R>> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            position: [[zero; 3]; COUNT],
            velocity: [[zero; 3]; COUNT],
            spin: [[zero; 3]; COUNT],
            squares: [zero; COUNT],
            slopes: [zero; COUNT],
            cubes: [zero; COUNT],
            fifths: [zero; COUNT],
            products: [[zero; 3]; COUNT],
            tilts: [[zero; 3]; COUNT],
            pull: zero,
            strength: zero,
            distance: zero,
            progress: zero,
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
        self.distance.put(row, orbit.distance);
    }

    /// Goes on to the end of a step of length `h`, where the orbit has come by its own series; lengths again over the
    /// distance there.
    #[inline(always)]
    pub(super) fn advance(&mut self, order: usize, h: Pack<L, R>) {
        let [position, velocity] = self.after(order, h);
        for row in 0..R {
            let r = Vector3::from_fn(|i, _| position[i].real(row));
            let v = Vector3::from_fn(|i, _| velocity[i].real(row));
            let distance = r.dot(&r).root();
            let cube = distance * distance * distance;
            let orbit = OnOrbit {
                position: r,
                velocity: v,
                distance: self.distance.real(row) * distance,
                pull: self.pull.real(row) / cube,
                strength: self.strength.real(row) / cube,
            };
            self.set(row, &orbit, &(r / distance), &(v / distance));
        }
    }

    /// Foresees where the orbit will have come at the end of a step of length `h`.
    #[inline(always)]
    pub(super) fn foresee(&mut self, order: usize, h: Pack<L, R>) {
        let [r, v] = self.after(order, h);
        let progress = r[2].mul_add(v[2], r[1].mul_add(v[1], r[0] * v[0]));
        self.progress = progress * self.distance * self.distance;
    }

    /// What was foreseen of `r·v` in one row, over the unit of rates.
    pub(super) fn foretold(&self, row: usize) -> f64 {
        self.progress.get(row)
    }

    /// Position and velocity at a time after the start of the step, lengths over the distance at the start.
    #[inline(always)]
    fn after(&self, order: usize, h: Pack<L, R>) -> [[Pack<L, R>; 3]; 2] {
        let mut position = [Pack::new(0.0); 3];
        let mut velocity = [Pack::new(0.0); 3];
        for k in (0..=order).rev() {
            for i in 0..3 {
                position[i] = position[i].mul_add(h, self.position[k][i]);
                velocity[i] = velocity[i].mul_add(h, self.velocity[k][i]);
            }
        }
        [position, velocity]
    }

    /// Comes to another unit of rates in one row: `ratio` of the old one to the new one.
    pub(super) fn rescale(&mut self, row: usize, ratio: f64) {
        let (once, twice) = (L::Real::from(ratio), L::Real::from(ratio * ratio));
        for v in &mut self.velocity[0] {
            v.put(row, v.real(row) * once);
        }
        self.pull.put(row, self.pull.real(row) * twice);
        (self.strength).put(row, self.strength.real(row) * twice);
        (self.progress).put(row, self.progress.real(row) * once);
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
        self.tilts[k] = field.tilt(&field.pull.1, &self.products[k], &squares);
        let mut sum = [Pack::new(0.0); 3];
        for (fifth, tilt) in self.fifths[..=k].iter().rev().zip(&self.tilts) {
            sum = [0, 1, 2].map(|i| fifth.mul_add(tilt[i], sum[i]));
        }
        sum.map(|x| -(self.strength * x))
    }

    /// The next coefficients of r⁻³ and r⁻⁵, of which the first are one.
    #[inline(always)]
    fn powers(&self, k: usize) -> [Pack<L, R>; 2] {
        if k == 0 {
            return [Pack::new(1.0); 2];
        }
        let (mut straight, mut sloped) = ([Pack::new(0.0); 2], [Pack::new(0.0); 2]);
        let series = self.squares[1..=k].iter().zip(&self.slopes[1..=k]);
        let before = (self.cubes[..k].iter().rev()).zip(self.fifths[..k].iter().rev());
        for ((square, slope), (cube, fifth)) in series.zip(before) {
            straight[0] = square.mul_add(*cube, straight[0]);
            straight[1] = square.mul_add(*fifth, straight[1]);
            sloped[0] = slope.mul_add(*cube, sloped[0]);
            sloped[1] = slope.mul_add(*fifth, sloped[1]);
        }
        // a + 1 is −1/2 and −3/2.
        let over = Pack::over(k);
        [
            -(sloped[0] * Pack::new(0.5)).mul_add(over, straight[0]),
            -(sloped[1] * Pack::new(1.5)).mul_add(over, straight[1]),
        ]
    }
}

// The components are written out, since a loop would keep the sums in memory.

/// `sum` and (a₁b₁, a₂b₂, a₃b₃).
#[inline(always)]
fn product_terms<L: Number, const R: usize>(
    a: &[Pack<L, R>; 3],
    b: &[Pack<L, R>; 3],
    sum: [Pack<L, R>; 3],
) -> [Pack<L, R>; 3] {
    [
        a[0].mul_add(b[0], sum[0]),
        a[1].mul_add(b[1], sum[1]),
        a[2].mul_add(b[2], sum[2]),
    ]
}

/// `sum` and (a₂b₃, a₃b₁, a₁b₂).
#[inline(always)]
fn crossed_terms<L: Number, const R: usize>(
    a: &[Pack<L, R>; 3],
    b: &[Pack<L, R>; 3],
    sum: [Pack<L, R>; 3],
) -> [Pack<L, R>; 3] {
    [
        a[1].mul_add(b[2], sum[0]),
        a[2].mul_add(b[0], sum[1]),
        a[0].mul_add(b[1], sum[2]),
    ]
}

impl<L: Number, const R: usize, const B: usize> Analytic<Pack<L, R>, B> for Gradient<Pack<L, R>> {
    #[inline(always)]
    fn coefficient(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        field: &Field<Pack<L, R>, B>,
    ) -> [Pack<L, R>; 3] {
        // A function of its own: within a larger one the sums are not kept in registers, and the caller of numbers with
        // derivatives is not compiled for the widest lanes.
        dispatch(Next {
            gradient: self,
            k,
            series,
            field,
        })
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
        it.spin[k] = series.get(k).w;
        let zero = [Pack::new(0.0); 3];
        let (positions, spins) = (&it.position[..=k], &it.spin[..=k]);
        // Sums that do not wait for each other go on side by side; those of numbers with derivatives, which fill the registers,
        // one after the other.
        let (mut squares, mut products) = (zero, zero);
        for (a, b) in positions.iter().zip(positions.iter().rev()) {
            squares = product_terms(a, b, squares);
            if !L::VARIES {
                products = crossed_terms(a, b, products);
            }
        }
        if L::VARIES {
            for (a, b) in positions.iter().zip(positions.iter().rev()) {
                products = crossed_terms(a, b, products);
            }
        }
        let (mut turned, mut moved) = (zero, zero);
        let velocities = &it.velocity[..=k];
        for ((r, v), w) in positions.iter().zip(velocities).zip(spins.iter().rev()) {
            turned = cross_term(r, w, turned);
            if !L::VARIES {
                moved = cross_term(v, w, moved);
            }
        }
        if L::VARIES {
            for (v, w) in velocities.iter().zip(spins.iter().rev()) {
                moved = cross_term(v, w, moved);
            }
        }
        // u₀ is one but for rounding: lengths are over the distance at the start of the step.
        it.squares[k] = squares[0] + squares[1] + squares[2];
        it.slopes[k] = it.squares[k] * Pack::new(k as f64);
        it.products[k] = products;
        [it.cubes[k], it.fifths[k]] = it.powers(k);
        let (mut pulled, mut torque) = (zero, zero);
        let vectors = it.position[..=k].iter().zip(&it.products[..=k]);
        let powers = (it.cubes[..=k].iter().rev()).zip(it.fifths[..=k].iter().rev());
        for ((r, p), (cube, fifth)) in vectors.zip(powers) {
            pulled = product_terms(&[*cube; 3], r, pulled);
            torque = product_terms(&[*fifth; 3], p, torque);
        }
        let reciprocal = Pack::over(k + 1);
        for i in 0..3 {
            it.position[k + 1][i] = (turned[i] + it.velocity[k][i]) * reciprocal;
            it.velocity[k + 1][i] = (-it.pull).mul_add(pulled[i], moved[i]) * reciprocal;
            torque[i] = -(field.pull.0[i] * it.strength * torque[i]);
        }
        if field.is_pulled_aside() {
            torque = plus(torque, it.tilt(k, field));
        }
        torque
    }
}
