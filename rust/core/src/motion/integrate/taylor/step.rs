//! One step: its length, the state at its end or within it, and the finished step as polynomials in time.

use std::ops::{ControlFlow, Index, IndexMut};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::batch::Batch;
use super::series::{Coefficient, Series};
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;
use crate::numerics::number::Number;

/// ω in principal axes and (x, y, z, w) of the attitude. The attitude is aligned separately: a register with numbers of both would
/// be loaded across two separate stores, and would have to wait until both are in the cache.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionState<T> {
    omega: [T; 3],
    attitude: Aligned<[T; 4]>,
}

/// Aligned such that four numbers are loaded as one register.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Aligned<T>(T);

impl<T: Copy> MotionState<T> {
    #[inline(always)]
    fn of(number: T) -> Self {
        Self {
            omega: [number; 3],
            attitude: Aligned([number; 4]),
        }
    }

    /// Return all seven numbers.
    #[inline(always)]
    pub(super) fn components(&self) -> [T; 7] {
        let ([w0, w1, w2], [x, y, z, w]) = (self.omega, self.attitude.0);
        [w0, w1, w2, x, y, z, w]
    }
}

impl<T> Index<usize> for MotionState<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, i: usize) -> &T {
        match i {
            0..3 => &self.omega[i],
            _ => &self.attitude.0[i - 3],
        }
    }
}

impl<T> IndexMut<usize> for MotionState<T> {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut T {
        match i {
            0..3 => &mut self.omega[i],
            _ => &mut self.attitude.0[i - 3],
        }
    }
}

/// The state, and the rounding error of each number so far.
#[derive(Clone, Debug)]
pub(super) struct Compensated<T> {
    pub(super) value: MotionState<T>,
    pub(super) rest: MotionState<T>,
}

impl<L: Number, const R: usize> Compensated<Batch<L, R>> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = MotionState::of(Batch::new(0.0));
        Self {
            value: zero,
            rest: zero,
        }
    }

    /// Add the increments of a step, then normalize the quaternion. It is normalized after every step: in a step of more than half
    /// a turn an error of the length would grow, by `1 − cos(ω h/2)`.
    #[inline(always)]
    pub(super) fn add(&mut self, increment: &[Batch<L, R>; 7]) {
        let (value, rest) = (&mut self.value, &mut self.rest);
        // Written out: a loop would be vectorised across the numbers instead of the rows.
        let ([v0, v1, v2], [r0, r1, r2]) = (&mut value.omega, &mut rest.omega);
        compensate(v0, r0, increment[0]);
        compensate(v1, r1, increment[1]);
        compensate(v2, r2, increment[2]);
        let (q, left_out) = (&mut value.attitude.0, &mut rest.attitude.0);
        let ([q0, q1, q2, q3], [r0, r1, r2, r3]) = (&mut *q, &mut *left_out);
        compensate(q0, r0, increment[3]);
        compensate(q1, r1, increment[4]);
        compensate(q2, r2, increment[5]);
        compensate(q3, r3, increment[6]);
        // The first-order correction ½ (1 − |q|²), with the rounding errors.
        let mut lack = Batch::new(1.0);
        for i in 0..4 {
            lack = (-q[i]).mul_add(q[i] + left_out[i] + left_out[i], lack);
        }
        lack = lack * Batch::new(0.5);
        for i in 0..4 {
            let change = q[i] * lack;
            compensate(&mut q[i], &mut left_out[i], change);
        }
    }

    /// Return the state of one row.
    pub(super) fn now(&self, row: usize) -> [L::Real; 7] {
        let mut state = [L::Real::default(); 7];
        for i in 0..7 {
            state[i] = self.value[i].real(row);
        }
        state
    }

    /// Compute the state of one row after `increment`, with the same bits as by [`Self::add`].
    #[inline(always)]
    pub(super) fn state_after(&self, increment: &[Batch<L, R>; 7], row: usize) -> [L::Real; 7] {
        let mut end = self.clone();
        end.add(increment);
        end.now(row)
    }
}

/// Add an increment to a value and its rounding error.
#[inline(always)]
pub(super) fn compensate<L: Number, const R: usize>(
    value: &mut Batch<L, R>,
    rest: &mut Batch<L, R>,
    increment: Batch<L, R>,
) {
    (*value, *rest) = two_sum(*value, increment + *rest);
}

/// Compute the longest step for which the last two terms of the series are at most `tolerance` (a logarithm to base 2): those of
/// ω relative to `scale`, those of the attitude relative to one, in the maximum norm.
///
/// The step is not finite if a coefficient is not.
/// Source: Jorba & Zou, Experimental Mathematics 14 (2005) 99.
#[inline(always)]
pub(super) fn longest_step<L: Number, const R: usize, const B: usize>(
    series: &impl Series<Batch<L, R>, B>,
    order: usize,
    tolerance: f64,
    scale: &[f64; R],
) -> [f64; R] {
    let (last, last_but_one) = (series.get(order), series.get(order - 1));
    let mut steps = [0.0; R];
    for row in 0..R {
        let a = log2_step_of(&last, row, order, tolerance, scale[row]);
        let b = log2_step_of(&last_but_one, row, order - 1, tolerance, scale[row]);
        steps[row] = exp2(if a < b { a } else { b }) + 0.0 * (a + b);
    }
    steps
}

/// Compute the logarithm of the step for which the term of this order has the size allowed.
#[inline(always)]
fn log2_step_of<L: Number, const R: usize, const B: usize>(
    at: &Coefficient<Batch<L, R>, B>,
    row: usize,
    order: usize,
    tolerance: f64,
    scale: f64,
) -> f64 {
    let mut largest = 0.0;
    let mut sum = 0.0;
    for w in &at.w {
        let w = w.get(row).abs() * (1.0 / scale);
        largest = if w > largest { w } else { largest };
        sum += w;
    }
    for q in &at.q {
        let q = q.get(row).abs();
        largest = if q > largest { q } else { largest };
        sum += q;
    }
    // A NaN is lost in the maximum, but not in the sum.
    log2_step(largest, order, tolerance) + 0.0 * sum
}

/// Compute the logarithm of the step for which a term, of this size after one unit of time, has the size allowed.
#[inline(always)]
pub(in crate::motion::integrate) fn log2_step(size: f64, order: usize, tolerance: f64) -> f64 {
    (tolerance - log2(size)) * (1.0 / order as f64)
}

/// Compute the binary logarithm to a hundredth, enough for the length of a step; the same bits on every machine. For zero: −1023.
#[inline(always)]
fn log2(x: f64) -> f64 {
    let bits = x.to_bits();
    let mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    let exponent = ((bits >> 52) & 0x7ff) as i32 - 1023;
    f64::from(exponent) + (mantissa - 1.0) * (1.693 - 0.3465 * mantissa)
}

/// Compute two to the power x to a hundredth, for |x| up to a thousand.
#[inline(always)]
pub(in crate::motion::integrate) fn exp2(x: f64) -> f64 {
    let x = if x > 1000.0 { 1000.0 } else { x };
    let x = if x > -1000.0 { x } else { -1000.0 };
    let whole = x.floor();
    let part = x - whole;
    // Beside 3·2⁵¹ the last bits of a double are those of a whole number.
    let last_bits = (whole + 6_755_399_441_055_744.0).to_bits();
    let power = f64::from_bits(last_bits.wrapping_add(1023) << 52);
    power * (1.0 + part * (0.6565 + 0.3435 * part))
}

/// A finished step: polynomials in the time since its start, in body axes and real units.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// Its start and its end, since the start of the motion.
    pub(crate) ends: [f64; 2],
    /// The rounding error of its start.
    pub(super) rest: f64,
    /// The unit of rates: the polynomials are in time times this unit.
    pub(super) unit: f64,
    /// ω and (x, y, z, w): the state at the start, its rounding error, and the coefficients from order 1 on.
    pub(super) state: [f64; 7],
    pub(super) change: [f64; 7],
    pub(super) series: Vec<[f64; 7]>,
    /// Coefficients of position and velocity; none if the velocity is constant.
    pub(super) path: Vec<[f64; 6]>,
    /// Coefficients of the states of the load from order 0 on, and the rounding errors at the start.
    pub(super) own: Vec<Vec<f64>>,
    pub(super) own_change: Vec<f64>,
    /// Position and velocity at the start of the motion.
    pub(super) initial: [Vector3<f64>; 2],
}

impl Step {
    /// Compute the state at a time since the start of the motion.
    pub(crate) fn at(&self, elapsed: f64) -> Phase {
        let within = ((elapsed - self.ends[0]) - self.rest) * self.unit;
        let mut sum = [0.0; 7];
        for order in self.series.iter().rev() {
            for (sum, coefficient) in sum.iter_mut().zip(order) {
                *sum = *sum * within + coefficient;
            }
        }
        for ((sum, state), change) in sum.iter_mut().zip(&self.state).zip(&self.change) {
            *sum = state + (*sum * within + change);
        }
        let [x, y, z, i, j, k, w] = sum;
        let [position, velocity] = self.path_at(elapsed, within);
        Phase {
            attitude: UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)),
            omega: Vector3::new(x, y, z),
            position,
            velocity,
            internal_state: self.own_at(within),
        }
    }

    fn own_at(&self, within: f64) -> Box<[f64]> {
        let states = self.own_change.iter().enumerate().map(|(i, change)| {
            let higher = self.own[1..].iter().rev();
            let sum = higher.fold(0.0, |sum, order| (sum + order[i]) * within);
            self.own[0][i] + (sum + change)
        });
        states.collect()
    }

    fn path_at(&self, elapsed: f64, within: f64) -> [Vector3<f64>; 2] {
        if self.path.is_empty() {
            let [position, velocity] = self.initial;
            return [position + velocity * elapsed, velocity];
        }
        let mut sum = [0.0; 6];
        for order in self.path.iter().rev() {
            for (sum, coefficient) in sum.iter_mut().zip(order) {
                *sum = *sum * within + coefficient;
            }
        }
        let [x, y, z, u, v, w] = sum;
        [Vector3::new(x, y, z), Vector3::new(u, v, w) * self.unit]
    }

    /// Estimate the angle by which the body turns in the step, in radians.
    pub(crate) fn turn(&self) -> f64 {
        let speed = |phase: &Phase| phase.omega.norm();
        let fastest = speed(&self.at(self.ends[0])).max(speed(&self.at(self.ends[1])));
        (self.ends[1] - self.ends[0]).abs() * fastest
    }
}

/// A function that gets each step of a motion as it is made, and whether the motion ended with it. It may stop the run.
pub(super) type Observer<'a> = &'a mut dyn FnMut(Step, bool) -> ControlFlow<()>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_and_logarithms_to_a_hundredth() {
        for k in -4000..=4000 {
            let x = 0.01 * f64::from(k);
            assert!((exp2(x) / x.exp2() - 1.0).abs() < 0.01, "{x}");
            assert!((log2(x.exp2()) - x).abs() < 0.01, "{x}");
        }
        assert_eq!(log2(0.0), -1023.0);
    }
}
