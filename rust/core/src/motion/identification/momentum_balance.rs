//! First estimates of tensor and bias: momentum in balance over windows, so that nothing is differentiated.
//!
//! With a φ that vanishes at both ends of a window, and ω = y − b,
//!
//! ```text
//! −∫ φ̇ ω dt = I⁻¹ ∫ φ (N − ω × (I ω + h)) dt .
//! ```
//!
//! The right side is made of ∫φ y yᵀ, ∫φ y and ∫φ, whatever tensor and bias are.

use nalgebra::{Matrix3, Vector3};

use super::triangle::{Linear, Stop, Triangle, descend};
use crate::numerics::eigen3::eigen3;

/// Windows in use, at most: more tell little more of a start.
const MOST: usize = 150;
/// Samples of a window, at least.
const LEAST: usize = 7;
/// A step of time that is longer than so many usual ones is a gap.
const GAP: f64 = 4.0;

/// Integrals over a window, in units of the sigma of the left side.
struct Window {
    left: Vector3<f64>,
    products: Matrix3<f64>,
    first: Vector3<f64>,
    zeroth: f64,
}

/// A tensor and a bias that balance the momentum, and how sure they are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balanced {
    pub(super) inertia: Matrix3<f64>,
    pub(super) bias: Vector3<f64>,
}

/// What is sought and what is known.
pub(super) struct Question<'a> {
    pub(super) t: &'a [f64],
    pub(super) omega: &'a [[f64; 3]],
    pub(super) sigma: f64,
    /// Changes of the tensor that are allowed.
    pub(super) directions: &'a [Matrix3<f64>],
    pub(super) has_bias: bool,
    pub(super) momentum: Vector3<f64>,
    pub(super) torque: Vector3<f64>,
    /// |ω|.
    pub(super) rate: f64,
}

/// The windows of a duration, half over one another.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a count of windows, fewer than there are rows"
)]
fn windows(question: &Question<'_>, duration: f64) -> Vec<Window> {
    let (t, y) = (question.t, question.omega);
    let span = t[t.len() - 1] - t[0];
    let usual = span / (t.len() - 1) as f64;
    let duration = duration.max(LEAST as f64 * usual).min(span);
    let count = ((2.0 * span / duration).floor() as usize)
        .saturating_sub(1)
        .max(1);
    let stride = count.div_ceil(MOST);
    let mut found = Vec::new();
    for k in (0..count).step_by(stride) {
        let begin = t[0] + 0.5 * duration * k as f64;
        let (from, to) = (
            t.partition_point(|&x| x < begin),
            t.partition_point(|&x| x <= begin + duration),
        );
        if to - from < LEAST {
            continue;
        }
        let (mut left, mut products) = (Vector3::zeros(), Matrix3::zeros());
        let (mut first, mut zeroth, mut square) = (Vector3::zeros(), 0.0, 0.0);
        let mut whole = true;
        for i in from..to {
            // Trapezoids; φ vanishes at both ends, with three derivatives.
            let (lower, upper) = (t[i.saturating_sub(1).max(from)], t[(i + 1).min(to - 1)]);
            whole &= upper - lower < GAP * 2.0 * usual.max(duration / 30.0);
            let step = 0.5 * (upper - lower);
            let x = 2.0 * (t[i] - begin) / duration - 1.0;
            let hump = (1.0 - x * x).max(0.0);
            let (phi, slope) = (
                hump.powi(4) * step,
                -16.0 * x * hump.powi(3) / duration * step,
            );
            let y = Vector3::from(y[i]);
            left -= y * slope;
            products += y * y.transpose() * phi;
            first += y * phi;
            zeroth += phi;
            square += slope * slope + (question.rate * phi).powi(2);
        }
        let share = 1.0 / (question.sigma * square.sqrt());
        if whole && share.is_finite() {
            found.push(Window {
                left: left * share,
                products: products * share,
                first: first * share,
                zeroth: zeroth * share,
            });
        }
    }
    found
}

/// The vector of the antisymmetric part: ω × I ω of Q I with Q = ω ωᵀ.
fn turned(m: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(
        m[(1, 2)] - m[(2, 1)],
        m[(2, 0)] - m[(0, 2)],
        m[(0, 1)] - m[(1, 0)],
    )
}

fn evaluate(question: &Question<'_>, windows: &[Window], at: &Balanced) -> Option<Linear> {
    let inverse = at.inertia.try_inverse()?;
    let unknowns = question.directions.len() + if question.has_bias { 3 } else { 0 };
    let mut triangle = Triangle::new(unknowns);
    let mut cost = 0.0;
    let b = at.bias;
    let mut columns: Vec<Vector3<f64>> = vec![Vector3::zeros(); unknowns];
    for window in windows {
        let w = window.first - b * window.zeroth;
        let q = window.products - b * window.first.transpose() - window.first * b.transpose()
            + b * b.transpose() * window.zeroth;
        let moment = question.torque * window.zeroth
            - turned(&(q * at.inertia))
            - w.cross(&question.momentum);
        let rest = window.left - inverse * moment;
        for (column, direction) in columns.iter_mut().zip(question.directions) {
            *column = -inverse * (direction * (inverse * moment) + turned(&(q * direction)));
        }
        if question.has_bias {
            for i in 0..3 {
                let one = Vector3::ith(i, 1.0);
                let products = -(one * w.transpose() + w * one.transpose());
                columns[question.directions.len() + i] = inverse
                    * (one.cross(&question.momentum) * window.zeroth
                        - turned(&(products * at.inertia)));
            }
        }
        for i in 0..3 {
            triangle.push(columns.iter().map(|column| column[i]), rest[i]);
        }
        cost += rest.norm_squared();
    }
    // A weak prior keeps what windows say nothing of: tensors within their size, biases within the rates.
    let size = at.inertia.trace();
    for (k, direction) in question.directions.iter().enumerate() {
        let off = direction.dot(&(at.inertia - Matrix3::identity() * (size / 3.0)));
        let row = (0..unknowns).map(|c| if c == k { 1.0 / size } else { 0.0 });
        triangle.push(row, -off / size);
        cost += (off / size).powi(2);
    }
    if question.has_bias {
        for i in 0..3 {
            let row = (0..unknowns).map(|c| {
                if c == question.directions.len() + i {
                    1.0 / question.rate
                } else {
                    0.0
                }
            });
            triangle.push(row, -b[i] / question.rate);
            cost += (b[i] / question.rate).powi(2);
        }
    }
    triangle.fold();
    cost.is_finite().then_some(Linear { triangle, cost })
}

/// The tensors that balance the momentum best over windows of several lengths, from several first ones; the surest first.
pub(super) fn estimates(question: &Question<'_>, firsts: &[Balanced]) -> Vec<Balanced> {
    let span = question.t[question.t.len() - 1] - question.t[0];
    let mut found: Vec<(f64, Balanced)> = Vec::new();
    for angle in [1.5, 4.0, 12.0, 40.0] {
        let duration = angle / question.rate;
        if angle > 1.5 && duration > 0.4 * span {
            break;
        }
        let own = windows(question, duration);
        if own.is_empty() {
            continue;
        }
        let stop = Stop {
            gain: 1e-3,
            passes: 25,
        };
        for first in firsts {
            let moved = |at: &Balanced, step: &[f64]| {
                let mut next = *at;
                for (x, direction) in step.iter().zip(question.directions) {
                    next.inertia += direction * *x;
                }
                for (i, x) in step.iter().skip(question.directions.len()).enumerate() {
                    next.bias[i] += x;
                }
                is_tensor(&next.inertia).then_some(next)
            };
            let Some((at, linear, _)) =
                descend(*first, &stop, |at, _| evaluate(question, &own, at), moved)
            else {
                continue;
            };
            let freedom = (3 * own.len()) as f64;
            let doubt = doubt(&linear.triangle, question.directions.len()) / at.inertia.trace();
            found.push((doubt * (linear.cost / freedom).max(1.0), at));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut apart: Vec<Balanced> = Vec::new();
    for (doubt, one) in found {
        let near = 0.02_f64.max(doubt.min(0.2)) * one.inertia.trace();
        if !apart
            .iter()
            .any(|other| (other.inertia - one.inertia).norm() < near)
        {
            apart.push(one);
        }
    }
    apart
}

/// Whether Euler's equations can be solved.
pub(super) fn is_tensor(inertia: &Matrix3<f64>) -> bool {
    let [least, _, most] = eigen3(inertia).values;
    least > 1e-5 * most && most.is_finite()
}

/// The largest of the sigmas of the first unknowns.
fn doubt(triangle: &Triangle, unknowns: usize) -> f64 {
    let n = triangle.unknowns();
    let mut most = 0.0_f64;
    for k in 0..unknowns {
        // |R⁻ᵀ e_k|.
        let mut solved = vec![0.0; n];
        for i in 0..n {
            let mut left = if i == k { 1.0 } else { 0.0 };
            for (l, x) in solved.iter().enumerate().take(i) {
                left -= triangle.at(l, i) * x;
            }
            solved[i] = left / triangle.at(i, i);
        }
        most = most.max(solved.iter().map(|x| x * x).sum::<f64>().sqrt());
    }
    most
}
