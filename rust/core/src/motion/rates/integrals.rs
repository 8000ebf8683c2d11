//! Attitudes along an angular velocity, and impulses of torques along attitudes.
//!
//! Between two rows a vector is the polynomial through the rows around them. A step takes it at the three nodes of Gauss: an
//! integral then is exact to the fifth degree, and the rotation is the Magnus series of sixth order.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nalgebra::{Quaternion, Vector3};

use super::derivatives::{BLOCK, Rows, even, noise};
use super::rotations::{exponential, rotation_vector};
use crate::error::Error;
use crate::motion::kinematics::Frame;
use crate::numerics::threads::{Halt, Watch, fill_blocks};

/// Rows that a polynomial passes through at most.
const MOST: usize = 10;

/// Half the distance of the outer nodes of Gauss between 0 and 1: √(3/20).
const OUTER: f64 = 0.387_298_334_620_741_7;

/// Turns from row to row, in radians, whose Magnus series needs no check by half the step: it is exact to many more digits than
/// the polynomials.
const SMALL: f64 = 0.02;

/// A step from one row to the next, and the polynomial through the rows around it.
struct Step {
    /// The first of the rows that the polynomial passes through.
    first: usize,
    /// How many there are.
    count: usize,
    /// Their times since the beginning of the step.
    at: [f64; MOST],
    /// For each the product of `1 / (x − x_j)` over the others j.
    factors: [f64; MOST],
    /// The time to the next row.
    width: f64,
}

impl Step {
    /// From the row `here`, with so many rows on either side of its middle.
    #[inline]
    fn of(t: &[f64], here: usize, half: usize) -> Self {
        let count = (2 * half).min(t.len());
        let first = (here + 1).saturating_sub(half).min(t.len() - count);
        let (mut at, mut factors) = ([0.0; MOST], [0.0; MOST]);
        for (x, time) in at.iter_mut().zip(&t[first..first + count]) {
            *x = time - t[here];
        }
        for k in 0..count {
            let mut apart = 1.0;
            for j in 0..count {
                if j != k {
                    apart *= at[k] - at[j];
                }
            }
            factors[k] = 1.0 / apart;
        }
        Self {
            first,
            count,
            at,
            factors,
            width: t[here + 1] - t[here],
        }
    }

    /// What the rows count in the value of the polynomial at a fraction of the step between its ends.
    #[inline]
    fn weights(&self, fraction: f64) -> [f64; MOST] {
        let (mut off, mut all) = ([0.0; MOST], 1.0);
        for (off, at) in off.iter_mut().zip(&self.at).take(self.count) {
            *off = fraction * self.width - at;
            all *= *off;
        }
        let mut weights = [0.0; MOST];
        for (k, weight) in weights.iter_mut().enumerate().take(self.count) {
            *weight = self.factors[k] / off[k] * all;
        }
        weights
    }

    /// The sum of vectors of the rows of the polynomial with these weights.
    #[inline]
    fn sum(&self, weights: &[f64; MOST], rows: &[[f64; 3]]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (weight, row) in weights
            .iter()
            .zip(&rows[self.first..self.first + self.count])
        {
            sum += Vector3::from(*row) * *weight;
        }
        sum
    }

    /// The rotation vector of the step in turned axes, from so many parts of it.
    #[inline]
    fn turn(&self, omega: &[[f64; 3]], sign: f64, parts: usize) -> Vector3<f64> {
        let share = 1.0 / parts as f64;
        let mut turn = Vector3::zeros();
        for part in 0..parts {
            let at = |node: f64| {
                let fraction = (part as f64 + node) * share;
                self.sum(&self.weights(fraction), omega) * sign
            };
            let nodes = [at(0.5 - OUTER), at(0.5), at(0.5 + OUTER)];
            let next = magnus(&nodes, self.width * share);
            turn = if part == 0 {
                next
            } else {
                rotation_vector(&exponential(&-turn), &exponential(&next))
            };
        }
        turn
    }
}

/// The Magnus series of sixth order: the rotation vector, in turned axes, of an angular velocity at the three nodes of a step.
#[inline]
fn magnus(omega: &[Vector3<f64>; 3], width: f64) -> Vector3<f64> {
    let first = omega[1] * width;
    let second = (omega[2] - omega[0]) * (15.0_f64.sqrt() / 3.0 * width);
    let third = (omega[2] - omega[1] * 2.0 + omega[0]) * (10.0 / 3.0 * width);
    // R' = R [omega x] multiplies from the right: the commutators have the other sign than for Y' = A Y.
    let one = -first.cross(&second);
    let two = first.cross(&(third * 2.0 + one)) / 60.0;
    first + third / 12.0 - (one - first * 20.0 - third).cross(&(second + two)) / 240.0
}

/// Attitudes as (x, y, z, w), continuous in time, and estimated sizes of their errors in radians.
pub type Attitudes = (Vec<[f64; 4]>, Vec<f64>);

/// The attitudes `R_NB` of a body with the angular velocity `omega` at the times `t`, from the first one on.
///
/// `t`: at least two times, ascending; `omega`: of B relative to N, components in `frame`. Between two rows it is the polynomial
/// through `order` rows, 2, 4, 6 or 8 (of others the nearest below), and the rotation is the Magnus series of sixth order. The error of a row is the sum of the
/// changes by two more orders and half the steps, of the noise, and of rounding.
/// Source: S. Blanes, F. Casas, J. A. Oteo, J. Ros, Physics Reports 470 (2009) 151, section 5.4.
///
/// About every 20 ms `watch` gets a fraction done and may end the work.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::motion::kinematics::Frame;
/// use polhode::motion::rates::integrals::{Attitudes, attitudes};
///
/// let (t, omega) = ([0.0, 0.5, 1.0], [[0.0, 0.0, 2.0]; 3]); // two radians about z
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let (found, error): Attitudes = attitudes(&t, &omega, [0.0, 0.0, 0.0, 1.0], Frame::Body, 6, go_on)?;
/// assert!((found[2][2] - 1.0_f64.sin()).abs() < 1e-15 && error[2] < 1e-15);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`Error::Stopped`] if `watch` said so.
///
/// # Panics
/// If there are fewer than two times, or not an angular velocity for each.
pub fn attitudes(
    t: &[f64],
    omega: &[[f64; 3]],
    first: [f64; 4],
    frame: Frame,
    order: usize,
    watch: &mut Watch<'_>,
) -> Result<Attitudes, Error> {
    let count = t.len();
    assert!(count > 1, "at least two rows");
    assert_eq!(omega.len(), count, "an angular velocity for each time");
    let white = if count > 2 {
        noise(t, Rows::Vectors(omega), watch)?
    } else {
        0.0
    };
    // R_BN turns with -omega in its own axes, which are those of space.
    let (sign, mut start) = match frame {
        Frame::Body => (1.0, Quaternion::from(first)),
        Frame::Space => (-1.0, Quaternion::from(first).conjugate()),
    };
    let half = even(order).min(count - count % 2) / 2;
    let wider = (half + 1).min(count / 2);
    let parts = if largest_turn(t, omega) > SMALL { 2 } else { 1 };

    // Rotations from the first row of each block, and what the turn of each step lacks.
    let mut found = vec![[0.0, 0.0, 0.0, 1.0]; count];
    let mut lacks = vec![[0.0; 3]; count - 1];
    let block = (count - 1).isqrt() + 1; // the fewest products from the first row to any: rounding adds up
    let mut blocks = in_blocks(&mut found[1..], &mut lacks, block);
    let done: Result<(), Halt<Infallible>> = fill_blocks(&mut blocks, 1, watch, |index, states| {
        for (chained, lacks) in states {
            let mut here = Quaternion::identity();
            for (k, (chained, lack)) in chained.iter_mut().zip(lacks.iter_mut()).enumerate() {
                let row = index * block + k;
                let coarse = Step::of(t, row, half).turn(omega, sign, 1);
                let fine = Step::of(t, row, wider).turn(omega, sign, parts);
                let step = exponential(&coarse);
                here *= if step.w < 0.0 { -step } else { step }; // continuous in time
                *chained = here.coords.into();
                *lack = (fine - coarse).into();
            }
        }
        Ok(())
    });
    done?;
    let mut starts = Vec::with_capacity(blocks.len());
    for (chained, _) in &blocks {
        starts.push(start);
        if let Some(last) = chained.last() {
            start = (start * Quaternion::from(*last)).normalize();
        }
    }
    let done: Result<(), Halt<Infallible>> = fill_blocks(&mut blocks, 1, watch, |index, states| {
        for (chained, lacks) in states {
            for (chained, lack) in chained.iter_mut().zip(lacks.iter_mut()) {
                let turn = (starts[index] * Quaternion::from(*chained)).normalize();
                *lack = rotated(&turn, lack).into();
                let turn = if sign < 0.0 { turn.conjugate() } else { turn };
                *chained = turn.coords.into();
            }
        }
        Ok(())
    });
    done?;
    found[0] = first;
    Ok((found, errors(t, &lacks, white)))
}

/// Pairs of blocks of two series.
fn in_blocks<'a, A, B>(
    a: &'a mut [A],
    b: &'a mut [B],
    block: usize,
) -> Vec<(&'a mut [A], &'a mut [B])> {
    a.chunks_mut(block).zip(b.chunks_mut(block)).collect()
}

/// A bound of the turns from row to row: the largest component of ω times the largest step.
fn largest_turn(t: &[f64], omega: &[[f64; 3]]) -> f64 {
    let speed = (omega.as_flattened().iter()).fold(0.0_f64, |most, x| most.max(x.abs()));
    t.windows(2)
        .fold(0.0_f64, |most, pair| most.max(pair[1] - pair[0]))
        * speed
}

/// The errors of attitudes: sums of what the steps lack, in space, and of noise and rounding that walk at random.
fn errors(t: &[f64], lacks: &[[f64; 3]], noise: f64) -> Vec<f64> {
    let (mut off, mut walk) = (Vector3::zeros(), 0.0);
    let mut errors = vec![0.0; t.len()];
    for ((error, lack), pair) in errors[1..].iter_mut().zip(lacks).zip(t.windows(2)) {
        off += Vector3::from(*lack);
        walk += 3.0 * (noise * (pair[1] - pair[0])).powi(2) + (0.25 * f64::EPSILON).powi(2);
        *error = (off.norm_squared() + walk).sqrt();
    }
    errors
}

/// A vector turned by a unit quaternion.
#[inline]
fn rotated(turn: &Quaternion<f64>, vector: &[f64; 3]) -> Vector3<f64> {
    let (axis, vector) = (turn.imag(), Vector3::from(*vector));
    let twice = axis.cross(&vector) * 2.0;
    vector + twice * turn.w + axis.cross(&twice)
}

/// The impulses of torques along attitudes: `∫ R N dt` from the first row to each row, in space, of each of the torques.
///
/// `t`: times, ascending. `attitudes`: unit quaternions (x, y, z, w) of `R_NB`. `torques`: series of N, components in B. Between
/// two rows `R N` is the polynomial through six rows, and its integral is exact.
///
/// About every 20 ms `watch` gets a fraction done and may end the work.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::motion::rates::integrals::impulses;
///
/// let (t, at_rest) = ([0.0, 1.0, 3.0], [[0.0, 0.0, 0.0, 1.0]; 3]);
/// let pull = [[1.0, 0.0, 0.0]; 3];
/// let found = impulses(&t, &at_rest, &[&pull], &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(found[0][2], [3.0, 0.0, 0.0]);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`Error::Stopped`] if `watch` said so.
///
/// # Panics
/// If there are fewer than two times, or not an attitude and a torque for each.
pub fn impulses(
    t: &[f64],
    attitudes: &[[f64; 4]],
    torques: &[&[[f64; 3]]],
    watch: &mut Watch<'_>,
) -> Result<Vec<Vec<[f64; 3]>>, Error> {
    let count = t.len();
    assert!(count > 1, "at least two rows");
    assert_eq!(attitudes.len(), count, "an attitude for each time");
    for torque in torques {
        assert_eq!(torque.len(), count, "a torque for each time");
    }
    let half = (count - count % 2).min(6) / 2;
    let mut found = vec![vec![[0.0; 3]; count]; torques.len()];
    let mut blocks: Vec<Vec<&mut [[f64; 3]]>> = Vec::new();
    blocks.resize_with((count - 1).div_ceil(BLOCK), Vec::new);
    for series in &mut found {
        for (block, rows) in blocks.iter_mut().zip(series[1..].chunks_mut(BLOCK)) {
            block.push(rows);
        }
    }
    let done: Result<(), Halt<Infallible>> = fill_blocks(&mut blocks, 1, watch, |block, states| {
        let begin = block * BLOCK;
        for series in states {
            let Some(steps) = series.first().map(|rows| rows.len()) else {
                continue;
            };
            let near = begin.saturating_sub(2 * half)..(begin + steps + 2 * half).min(count);
            let in_space: Vec<Vec<[f64; 3]>> = (torques.iter())
                .map(|torque| {
                    (near.clone())
                        .map(|row| rotated(&attitudes[row].into(), &torque[row]).into())
                        .collect()
                })
                .collect();
            for k in 0..steps {
                let mut step = Step::of(t, begin + k, half);
                let nodes = [0.5 - OUTER, 0.5, 0.5 + OUTER].map(|node| step.weights(node));
                let mut weights = [0.0; MOST];
                for (j, weight) in weights.iter_mut().enumerate() {
                    *weight = (5.0 * nodes[0][j] + 8.0 * nodes[1][j] + 5.0 * nodes[2][j]) / 18.0
                        * step.width;
                }
                step.first -= near.start;
                for (rows, torque) in series.iter_mut().zip(&in_space) {
                    rows[k] = step.sum(&weights, torque).into();
                }
            }
        }
        Ok(())
    });
    done?;
    for series in &mut found {
        if watch(1.0) == ControlFlow::Break(()) {
            return Err(Error::Stopped);
        }
        let mut sum = Vector3::zeros();
        for row in series {
            sum += Vector3::from(*row);
            *row = sum.into();
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::threads::set_thread_limit;
    use std::num::NonZeroUsize;

    const START: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

    fn found(t: &[f64], omega: &[[f64; 3]], frame: Frame, order: usize) -> Attitudes {
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        attitudes(t, omega, START, frame, order, go_on).expect("attitudes")
    }

    /// Times in uneven steps of `step` on the average.
    fn uneven(count: u32, step: f64) -> Vec<f64> {
        let jitter = |k: u32| 0.4 * (1.7 * f64::from(k)).sin();
        (0..count)
            .map(|k| (f64::from(k) + jitter(k)) * step)
            .collect()
    }

    /// The angle between two attitudes.
    fn apart(a: &[f64; 4], b: &Quaternion<f64>) -> f64 {
        rotation_vector(&Quaternion::from(*a), b).norm()
    }

    #[test]
    fn a_steady_turn_goes_on_in_one_sense_beyond_half_a_turn_a_step() {
        let t = uneven(50, 1.0);
        for speed in [0.0, 1e-12, 0.009, 0.02, 1.5, 3.0, 4.0, 50.0] {
            let omega = Vector3::new(2.0, -3.0, 6.0) * (speed / 7.0);
            for frame in [Frame::Body, Frame::Space] {
                let (turns, errors) = found(&t, &vec![omega.into(); 50], frame, 6);
                for (k, turn) in turns.iter().enumerate() {
                    let exact = exponential(&(omega * (t[k] - t[0])));
                    assert!(
                        apart(turn, &exact) < 1e-14 + 5e-15 * speed * t[k].max(1.0),
                        "{speed} {k}"
                    );
                    assert!(
                        speed > 1.9 || errors[k] < 1e-14 + 1e-13 * speed,
                        "{speed} {k} {:e}",
                        errors[k]
                    );
                }
                for pair in turns.windows(2) {
                    let dot: f64 = pair[0].iter().zip(&pair[1]).map(|(a, b)| a * b).sum();
                    assert!(dot >= 0.0);
                }
            }
        }
    }

    #[test]
    fn about_a_fixed_axis_polynomials_below_the_order_are_integrated_exactly() {
        let t = uneven(30, 1.0 / 30.0);
        for order in [2, 4, 6] {
            for degree in [order - 1, order] {
                let power = i32::try_from(degree).expect("few");
                let omega: Vec<_> = t
                    .iter()
                    .map(|t| [0.0, 0.0, f64::from(power + 1) * t.powi(power)])
                    .collect();
                let (turns, errors) = found(&t, &omega, Frame::Body, order);
                let worst = (turns.iter().zip(&t)).fold(0.0_f64, |most, (turn, time)| {
                    let angle = time.powi(power + 1) - t[0].powi(power + 1);
                    most.max(apart(turn, &exponential(&Vector3::new(0.0, 0.0, angle))))
                });
                assert_eq!(worst < 1e-13, degree < order, "{order} {degree} {worst:e}");
                let claimed = errors.iter().fold(0.0_f64, |a, b| a.max(*b));
                assert!(
                    degree < order || worst < 1.01 * claimed,
                    "{worst:e} {claimed:e}"
                );
            }
        }
    }

    /// The coning motion of θ (cos νt, sin νt, 0): its attitudes, and ω in the body and in space.
    fn coning(t: &[f64], cone: f64, rate: f64) -> (Vec<Quaternion<f64>>, [Vec<[f64; 3]>; 2]) {
        let mut found = (Vec::new(), [Vec::new(), Vec::new()]);
        for t in t {
            let (sine, cosine) = (rate * t).sin_cos();
            let (across, along) = (cone.sin() * rate, (1.0 - cone.cos()) * rate);
            found
                .0
                .push(exponential(&(Vector3::new(cosine, sine, 0.0) * cone)));
            found.1[0].push([-across * sine, across * cosine, -along]);
            found.1[1].push([-across * sine, across * cosine, along]);
        }
        found
    }

    #[test]
    fn coning_motion_is_followed_in_the_order_that_is_asked_for() {
        for (order, steps) in [(2, 400), (4, 200), (6, 100)] {
            let mut sizes = Vec::new();
            for count in [steps, 2 * steps] {
                let step = 6.0 / f64::from(count);
                let t: Vec<f64> = (0..=count).map(|k| f64::from(k) * step).collect();
                let (exact, omega) = coning(&t, 0.7, 1.0);
                for (omega, frame) in omega.iter().zip([Frame::Body, Frame::Space]) {
                    let go_on = &mut |_: f64| ControlFlow::Continue(());
                    let start = exact[0].coords.into();
                    let (turns, errors) =
                        attitudes(&t, omega, start, frame, order, go_on).expect("attitudes");
                    let worst = (turns.iter().zip(&exact))
                        .fold(0.0_f64, |most, (turn, exact)| most.max(apart(turn, exact)));
                    let claimed = errors.iter().fold(0.0_f64, |a, b| a.max(*b));
                    assert!(
                        worst < 1.5 * claimed && claimed < 5.0 * worst,
                        "{worst:e} {claimed:e}"
                    );
                    sizes.push(worst);
                }
            }
            for frame in 0..2 {
                let shown = (sizes[frame] / sizes[frame + 2]).log2();
                assert!((shown - order as f64).abs() < 0.6, "{order}: {shown}");
            }
        }
    }

    #[test]
    fn the_series_is_checked_by_half_steps_where_turns_are_not_small() {
        for (step, parts) in [(0.0199, 1), (0.0201, 2)] {
            let t: Vec<f64> = (0..100_u32).map(|k| f64::from(k) * step).collect();
            let mut omega = vec![[0.3, 0.4, 0.5]; 100];
            omega[50] = [0.0, 1.0, 0.0];
            assert_eq!(largest_turn(&t, &omega) > SMALL, parts == 2);
            let (turns, errors) = found(&t, &omega, Frame::Body, 8);
            assert!(turns.iter().flatten().chain(&errors).all(|x| x.is_finite()));
        }
        // In one part or in two, the rotation of a step is the same to the sixth order.
        let t = uneven(20, 0.1);
        let (_, [omega, _]) = coning(&t, 0.7, 1.0);
        let step = Step::of(&t, 9, 4);
        let apart = (step.turn(&omega, 1.0, 1) - step.turn(&omega, 1.0, 2)).norm();
        assert!(apart < 1e-11, "{apart:e}");
    }

    #[test]
    fn impulses_of_polynomials_are_exact_to_the_fifth_degree() {
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        for count in [2, 3, 5, 6, 7, 1025, 1026, 2500] {
            let t = uneven(count, 1.0 / f64::from(count));
            let degree = i32::try_from(count - count % 2).expect("few").min(6) - 1;
            let torque: Vec<_> = t
                .iter()
                .map(|t| [1.0, t.powi(degree) * f64::from(degree + 1), 0.0])
                .collect();
            let still = vec![START; t.len()];
            let half = vec![[0.0, 0.0, 1.0, 0.0]; t.len()];
            for (turns, sign) in [(&still, 1.0), (&half, -1.0)] {
                let found = impulses(&t, turns, &[&torque, &torque], go_on).expect("impulses");
                assert_eq!(found[0], found[1]);
                for (time, impulse) in t.iter().zip(&found[0]) {
                    let exact = Vector3::new(
                        time - t[0],
                        time.powi(degree + 1) - t[0].powi(degree + 1),
                        0.0,
                    );
                    assert!((Vector3::from(*impulse) * sign - exact).norm() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn a_torque_that_turns_with_the_body_goes_round() {
        let t = uneven(3000, 0.01);
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        let turns: Vec<[f64; 4]> = (t.iter())
            .map(|t| exponential(&Vector3::new(0.0, 0.0, 2.0 * t)).coords.into())
            .collect();
        let found = impulses(&t, &turns, &[&vec![[1.0, 0.0, 0.5]; 3000]], go_on).expect("impulses");
        for (t1, impulse) in t.iter().zip(&found[0]) {
            let (sine, cosine) = (2.0 * t1).sin_cos();
            let (sine0, cosine0) = (2.0 * t[0]).sin_cos();
            let exact = Vector3::new(sine - sine0, cosine0 - cosine, t1 - t[0]) / 2.0;
            assert!((Vector3::from(*impulse) - exact).norm() < 1e-12);
        }
    }

    #[test]
    fn bits_do_not_depend_on_threads() {
        let t = uneven(20_000, 0.02);
        let (_, [omega, _]) = coning(&t, 0.7, 1.0);
        let run = || {
            let (turns, errors) = found(&t, &omega, Frame::Body, 6);
            let go_on = &mut |_: f64| ControlFlow::Continue(());
            (
                impulses(&t, &turns, &[&omega], go_on).expect("impulses"),
                turns,
                errors,
            )
        };
        set_thread_limit(NonZeroUsize::new(1));
        let alone = run();
        set_thread_limit(NonZeroUsize::new(3));
        assert!(run() == alone);
        set_thread_limit(None);
    }
}
