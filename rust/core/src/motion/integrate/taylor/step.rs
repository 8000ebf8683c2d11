//! One step: how long it may be, and the state at its end or anywhere within it.

use std::ops::{Index, IndexMut};

use super::batch::Batch;
use super::series::{Coefficient, Series};
use crate::numerics::double_double::two_sum;
use crate::numerics::number::Number;

/// ω in principal axes and (x, y, z, w) of the attitude. The attitude begins at a place of its own: a register that held numbers
/// of both would be loaded across two places that were stored apart, and would have to wait until both are in the cache.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionState<T> {
    omega: [T; 3],
    attitude: Aligned<[T; 4]>,
}

/// At a place where a register of four numbers is loaded at once.
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

    /// All seven.
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

/// The state, with what rounding has left out of each number so far.
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

    /// Adds the increments of a step, then puts the quaternion back to unit length: at once, since in a step of more than
    /// half a turn what is left of the length would grow, by `1 − cos(ω h/2)`.
    #[inline(always)]
    pub(super) fn add(&mut self, increment: &[Batch<L, R>; 7]) {
        let (value, rest) = (&mut self.value, &mut self.rest);
        // Written out, since a loop would be vectorised across the numbers instead of the rows.
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
        // ½ (1 − |q|²), with the rest: the first-order correction.
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

    /// The state of one row.
    pub(super) fn now(&self, row: usize) -> [L::Real; 7] {
        let mut state = [L::Real::default(); 7];
        for i in 0..7 {
            state[i] = self.value[i].real(row);
        }
        state
    }

    /// The state of one row moved by `increment`: to the bit what [`Self::add`] would make of it.
    #[inline(always)]
    pub(super) fn moved(&self, increment: &[Batch<L, R>; 7], row: usize) -> [L::Real; 7] {
        let mut end = self.clone();
        end.add(increment);
        end.now(row)
    }
}

/// Adds an increment to a value and to what rounding has left out of it.
#[inline(always)]
pub(super) fn compensate<L: Number, const R: usize>(
    value: &mut Batch<L, R>,
    rest: &mut Batch<L, R>,
    increment: Batch<L, R>,
) {
    (*value, *rest) = two_sum(*value, increment + *rest);
}

/// The longest step for which the last two terms of the series are `tolerance` (as a logarithm to base 2) at most:
/// those of ω relative to `scale`, those of the attitude to one, in the norm of the largest magnitude.
///
/// Not finite where a coefficient is not.
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

/// The logarithm of the step for which the term of this order is as large as allowed.
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
    // What is not a number is lost among the largest, but not in the sum.
    log2_step(largest, order, tolerance) + 0.0 * sum
}

/// The same for a term of this size at one unit of time.
#[inline(always)]
pub(super) fn log2_step(size: f64, order: usize, tolerance: f64) -> f64 {
    (tolerance - log2(size)) * (1.0 / order as f64)
}

/// Binary logarithm to a hundredth, ample for the length of a step; the same bits on every machine. That of zero is −1023.
#[inline(always)]
fn log2(x: f64) -> f64 {
    let bits = x.to_bits();
    let mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    let exponent = ((bits >> 52) & 0x7ff) as i32 - 1023;
    f64::from(exponent) + (mantissa - 1.0) * (1.693 - 0.3465 * mantissa)
}

/// Two to the power x to a hundredth, for |x| up to a thousand.
#[inline(always)]
pub(super) fn exp2(x: f64) -> f64 {
    let x = if x > 1000.0 { 1000.0 } else { x };
    let x = if x > -1000.0 { x } else { -1000.0 };
    let whole = x.floor();
    let part = x - whole;
    // Beside 3·2⁵¹ the last bits of a double are those of a whole number.
    let last_bits = (whole + 6_755_399_441_055_744.0).to_bits();
    let power = f64::from_bits(last_bits.wrapping_add(1023) << 52);
    power * (1.0 + part * (0.6565 + 0.3435 * part))
}

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
