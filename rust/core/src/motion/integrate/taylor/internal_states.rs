//! The internal states of a load: those of wheels and dampers.

use super::batch::{Batch, CacheAligned, cross_term, plus};
use super::equations::Precision;
use super::series::{MAX_COUNT, Series};
use super::step::{compensate, exp2, log2_step};
use super::variational::ConvergenceRadius;
use crate::motion::loads::InternalState;
use crate::motion::loads::variables::WIDTH;
use crate::numerics::dispatch::{Kernel, dispatch_within};
use crate::numerics::lane::Lane;
use crate::numerics::number::Number;

/// The states z of a load, and their series in a step:
///
/// ```text
/// ż = c + r z + b·ω + a·q,   N = Σ z p − ω × Σ z g
/// ```
///
/// A vector s among them has the rate `−ω × s` in addition.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
pub(super) struct InternalStates<T> {
    states: Vec<StateSeries<T>>,
    /// Σ z g.
    momentum: [[T; 3]; MAX_COUNT],
    inverse_moments: [T; 3],
}

/// One state.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
struct StateSeries<T> {
    value: T,
    rest: T,
    series: [T; MAX_COUNT],
    torque: [T; 3],
    momentum: [T; 3],
    constant: T,
    on_itself: T,
    on_omega: [T; 3],
    on_attitude: [T; 4],
    turned: Option<(usize, usize)>,
    /// Its natural size over the largest ω, and its largest size so far.
    size: T,
    largest: T,
    /// The same with derivatives; for a vector in its first component.
    radius: ConvergenceRadius,
}

impl<L: Number, const R: usize> StateSeries<Batch<L, R>> {
    const ZERO: Self = Self {
        value: Batch::ZERO,
        rest: Batch::ZERO,
        series: [Batch::ZERO; MAX_COUNT],
        torque: [Batch::ZERO; 3],
        momentum: [Batch::ZERO; 3],
        constant: Batch::ZERO,
        on_itself: Batch::ZERO,
        on_omega: [Batch::ZERO; 3],
        on_attitude: [Batch::ZERO; 4],
        turned: None,
        size: Batch::ZERO,
        largest: Batch::ZERO,
        radius: ConvergenceRadius::ZERO,
    };
}

impl<L: Number<Real: Precision>, const R: usize> InternalStates<Batch<L, R>> {
    const NO_MOMENTUM: [[Batch<L, R>; 3]; MAX_COUNT] = [[Batch::ZERO; 3]; MAX_COUNT];

    /// Return `count` states, all zero. Not inlined: it is the same for all series.
    #[inline(never)]
    pub(super) fn new(count: usize) -> Self {
        let mut none = StateSeries::ZERO;
        none.size = Batch::new(1.0);
        Self {
            states: vec![none; count],
            momentum: Self::NO_MOMENTUM,
            inverse_moments: [Batch::ZERO; 3],
        }
    }

    /// Set the states of one row at the start of a motion.
    pub(super) fn set(&mut self, row: usize, values: &[L::Real]) {
        for (state, &value) in self.states.iter_mut().zip(values) {
            state.value.put(row, value);
            state.rest.set(row, 0.0);
            state.largest.set(row, 0.0);
        }
    }

    /// Change the values of the states of one row within a motion.
    pub(super) fn put(&mut self, row: usize, values: &[L::Real]) {
        for (state, &value) in self.states.iter_mut().zip(values) {
            state.value.put(row, value);
        }
    }

    /// Set the equations of the states of one row, in the unit of rates.
    pub(super) fn set_rates(
        &mut self,
        row: usize,
        own: &[InternalState<L::Real>],
        inverse_moments: [L::Real; 3],
        unit: f64,
    ) {
        let rate = L::Real::from(1.0 / unit);
        for i in 0..3 {
            self.inverse_moments[i].put(row, inverse_moments[i]);
        }
        for (state, own) in self.states.iter_mut().zip(own) {
            for i in 0..3 {
                state.torque[i].put(row, own.torque[i] * rate * rate);
                state.momentum[i].put(row, own.momentum[i] * rate);
                state.on_omega[i].put(row, own.on_omega[i]);
            }
            for i in 0..4 {
                state.on_attitude[i].put(row, own.on_attitude[i] * rate);
            }
            state.constant.put(row, own.constant * rate);
            state.on_itself.put(row, own.on_itself * rate);
            // The same in all rows.
            state.turned = state.turned.or(own.turned);
            state.size.set(row, own.size * unit);
        }
    }

    /// Remove the states of one row.
    pub(super) fn clear(&mut self, row: usize) {
        let none = InternalState::default();
        let count = self.states.len();
        self.set(row, &vec![L::Real::default(); count]);
        self.set_rates(row, &vec![none; count], [L::Real::default(); 3], 1.0);
    }

    #[inline(always)]
    pub(super) fn start(&mut self) {
        for state in &mut self.states {
            state.series[0] = state.value;
        }
    }

    /// Add the coefficient of order `k` of the angular acceleration by the states to `sum`, and compute the coefficients of order
    /// k + 1 of the states.
    #[inline(always)]
    pub(super) fn plus_coefficients<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
        sum: [Batch<L, R>; 3],
    ) -> [Batch<L, R>; 3] {
        let by_states = if R == 1 {
            self.coefficient(k, series)
        } else {
            let states = self;
            dispatch_within::<L, _>(Next { states, k, series }).0
        };
        plus(sum, by_states)
    }

    #[inline(always)]
    fn coefficient<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
    ) -> [Batch<L, R>; 3] {
        let zero = Batch::new(0.0);
        let (mut momentum, mut torque) = ([zero; 3], [zero; 3]);
        for state in &self.states {
            let value = state.series[k];
            for i in 0..3 {
                momentum[i] = state.momentum[i].mul_add(value, momentum[i]);
                torque[i] = state.torque[i].mul_add(value, torque[i]);
            }
        }
        self.momentum[k] = momentum;
        // −ω × m = m × ω.
        for j in 0..=k {
            torque = cross_term(&self.momentum[j], &series.get(k - j).w, torque);
        }
        self.extend(k, series);
        let ([x, y, z], [a, b, c]) = (torque, self.inverse_moments);
        [x * a, y * b, z * c]
    }

    /// Compute the coefficients of order k + 1 of the states.
    #[inline(always)]
    fn extend<const B: usize>(&mut self, k: usize, series: &impl Series<Batch<L, R>, B>) {
        let at = series.get(k);
        let reciprocal = Batch::over(k + 1);
        for number in 0..self.states.len() {
            let state = &self.states[number];
            let mut rate = state.on_itself * state.series[k];
            if k == 0 {
                rate = rate + state.constant;
            }
            for i in 0..3 {
                rate = state.on_omega[i].mul_add(at.w[i], rate);
            }
            for i in 0..4 {
                rate = state.on_attitude[i].mul_add(at.q[i], rate);
            }
            if let Some((first, component)) = state.turned {
                // s × ω.
                let (one, two) = ((component + 1) % 3, (component + 2) % 3);
                let (s, t) = (&self.states[first + one], &self.states[first + two]);
                for j in 0..=k {
                    let w = series.get(k - j).w;
                    rate = s.series[j].mul_add(w[two], rate);
                    rate = (-t.series[j]).mul_add(w[one], rate);
                }
            }
            self.states[number].series[k + 1] = rate * reciprocal;
        }
    }

    /// Shorten each step until the last two terms of the states are at most `tolerance`, relative to the largest size.
    #[inline(always)]
    pub(super) fn limit(
        &mut self,
        order: usize,
        tolerance: f64,
        fastest: &[f64; R],
        steps: &mut [f64; R],
    ) {
        if L::VARIES {
            return self.limit_with_derivatives(steps);
        }
        for row in 0..R {
            let (mut last, mut last_but_one) = (0.0, 0.0);
            // A NaN is lost in the maximum, but not in the sum.
            let mut sum = 0.0;
            for state in &self.states {
                let natural = state.size.get(row) * fastest[row];
                let largest = state.largest.get(row);
                let scale = if natural > largest { natural } else { largest };
                let (one, other) = (state.series[order], state.series[order - 1]);
                let (one, other) = (one.get(row).abs() / scale, other.get(row).abs() / scale);
                last = if one > last { one } else { last };
                last_but_one = if other > last_but_one {
                    other
                } else {
                    last_but_one
                };
                sum += one + other;
            }
            let (a, b) = (
                log2_step(last, order, tolerance),
                log2_step(last_but_one, order - 1, tolerance),
            );
            let most = exp2(if a < b { a } else { b });
            let h = steps[row];
            steps[row] = (if h > most { most } else { h }) + 0.0 * sum;
        }
    }

    /// Shorten each step in the same way for numbers with derivatives.
    #[inline(never)]
    fn limit_with_derivatives(&mut self, steps: &mut [f64; R]) {
        let mut first = 0;
        while first < self.states.len() {
            let count = if self.states[first].turned.is_some() {
                3
            } else {
                1
            };
            let mut radius = self.states[first].radius;
            for (row, h) in steps.iter_mut().enumerate() {
                let sizes = |k: usize| {
                    let mut sum = [0.0; WIDTH + 1];
                    for state in &self.states[first..first + count] {
                        let magnitudes = state.series[k].real(row).magnitudes();
                        for (sum, magnitude) in sum.iter_mut().zip(magnitudes) {
                            *sum += magnitude;
                        }
                    }
                    sum
                };
                let most = radius.longest_step_of(&sizes);
                // NaN if one of the two is NaN.
                *h = if most >= *h { *h } else { most };
            }
            self.states[first].radius = radius;
            first += count;
        }
    }

    /// Compute the states of one row after the time `h`.
    #[inline(always)]
    pub(super) fn within(&self, row: usize, order: usize, h: Batch<L, R>) -> Vec<L::Real> {
        let mut moved = Vec::with_capacity(self.states.len());
        // No `map`: its closure would be compiled without the instructions of the level.
        for state in &self.states {
            let change = state.increment(order, h) + state.rest;
            moved.push(state.value.real(row) + change.real(row));
        }
        moved
    }

    /// Advance the states by the time `h`.
    #[inline(always)]
    pub(super) fn advance(&mut self, order: usize, h: Batch<L, R>) {
        for state in &mut self.states {
            let change = state.increment(order, h);
            compensate(&mut state.value, &mut state.rest, change);
            for row in 0..R {
                let size = state.value.get(row).abs();
                if size > state.largest.get(row) {
                    state.largest.set(row, size);
                }
            }
        }
    }

    /// Return the states of one row.
    pub(super) fn now(&self, row: usize) -> Vec<L::Real> {
        let values = self.states.iter();
        values.map(|state| state.value.real(row)).collect()
    }

    /// Return the coefficients of order `k` of the states of one row.
    pub(super) fn coefficients(&self, row: usize, k: usize) -> Vec<L::Real> {
        let coefficients = self.states.iter().map(|state| state.series[k].real(row));
        coefficients.collect()
    }
}

/// Computes the coefficients of one order of several rows. A separate function, as in [`formulas`](super::nonlinear).
struct Next<'a, L, S, const R: usize, const B: usize> {
    states: &'a mut InternalStates<Batch<L, R>>,
    k: usize,
    series: &'a S,
}

impl<N: Number<Real: Precision>, S: Series<Batch<N, R>, B>, const R: usize, const B: usize> Kernel
    for Next<'_, N, S, R, B>
{
    type Output = CacheAligned<[Batch<N, R>; 3]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        CacheAligned(self.states.coefficient(self.k, self.series))
    }
}

impl<L: Number, const R: usize> StateSeries<Batch<L, R>> {
    /// Compute the change within the time `h`, as [`increment`](super::series::increment) does.
    #[inline(always)]
    fn increment(&self, order: usize, h: Batch<L, R>) -> Batch<L, R> {
        let square = h * h;
        let [mut odd, mut even] = [Batch::new(0.0); 2];
        for half in (1..=order / 2).rev() {
            odd = odd.mul_add(square, self.series[2 * half - 1]);
            even = even.mul_add(square, self.series[2 * half]);
        }
        even.mul_add(h, odd) * h
    }
}
