//! Angular velocities along attitudes, and rates along vectors, with their errors.
//!
//! Around each row the rotation vector from this row, or the difference of the vectors, is a polynomial through the neighbouring
//! rows. Its derivative at the row is the rate. Where the noise is known, the polynomial fits more rows than it passes through.

use std::convert::Infallible;
use std::ops::Range;

use nalgebra::{Quaternion, Vector3};

use super::rotations::rotation_vector;
use crate::error::Error;
use crate::numerics::threads::{Halt, Watch, fill_blocks};

/// What is known at each time of a record.
#[derive(Clone, Copy, Debug)]
pub enum Rows<'a> {
    /// Attitudes `R_NB` as unit quaternions (x, y, z, w); their rate is ω, components in B.
    Attitudes(&'a [[f64; 4]]),
    /// Vectors.
    Vectors(&'a [[f64; 3]]),
}

/// Rates at each row, and estimated sizes of their errors.
pub type Rates = (Vec<[f64; 3]>, Vec<f64>);

/// Rows that one thread does at a time.
pub(super) const BLOCK: usize = 1024;
/// Rows to either side of a row, at most, through which a polynomial passes.
const WIDEST: usize = 5;
/// Rows beside a row through which a polynomial passes, at most.
const MOST: usize = 2 * WIDEST;
/// Rows on which orders and windows are tried out.
const TRIED: usize = 4096;
/// Rows of a piece of them.
const PIECE: usize = 256;
/// The largest sum of turns, in radians, that a rotation vector across half a window may have.
const FAR: f64 = 5.0;
/// The sum of turns, in radians, from which on the shortest rotation vector may be that of another way round.
const UNSURE: f64 = 3.0;
/// Median of the square of three numbers of unit variance.
const MEDIAN: f64 = 2.366;
/// Degrees that smoothing tries.
const DEGREES: [usize; 3] = [2, 4, 6];
/// Terms of a fit, at most: of the degree 8 and two more.
const TERMS: usize = 11;

/// The rates along the rows at the times `t`: polynomials of the degree `order`, 2, 4, 6 or 8 (of others
/// the nearest below), or of the one with the least estimated error.
///
/// `t`: at least three times, ascending. `sigma`: standard deviation of white noise of each component of a row, in radians about
/// each axis of B for attitudes; with it the polynomials fit more rows than they pass through. The error of a row is the change by two more orders,
/// and the noise, which is estimated where it is not known.
/// Source: J. E. Bortz, IEEE Transactions on Aerospace and Electronic Systems AES-7 (1971) 61.
///
/// About every 20 ms `watch` gets the fraction done and may end the work.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::motion::rates::derivatives::{Rates, Rows, rates};
///
/// let t = [0.0, 0.1, 0.2, 0.3, 0.4];
/// let turning = t.map(|t: f64| [0.0, 0.0, t.sin(), t.cos()]); // two radians in a unit of time
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let (omega, error): Rates = rates(&t, Rows::Attitudes(&turning), None, None, go_on)?;
/// assert!((omega[1][2] - 2.0).abs() < 1e-13 && error[1] < 1e-13);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`Error::Stopped`] if `watch` said so.
///
/// # Panics
/// If there are fewer than three times, or not a row for each.
pub fn rates(
    t: &[f64],
    rows: Rows<'_>,
    order: Option<usize>,
    sigma: Option<f64>,
    watch: &mut Watch<'_>,
) -> Result<Rates, Error> {
    let curve = Curve::of(t, rows, watch)?;
    let order = order.map(even);
    let fit = sigma.and_then(|sigma| Fit::best(&curve, order, sigma));
    let mut found = (vec![[0.0; 3]; t.len()], vec![0.0; t.len()]);
    let done: Result<(), Halt<Infallible>> = if let Some(fit) = fit {
        let block = fit.hop * (BLOCK / fit.hop).max(1);
        let mut blocks = blocks_of(&mut found, block);
        fill_blocks(&mut blocks, 1, watch, |index, states| {
            for (rates, errors) in states {
                fit.fill(index * block, rates, errors);
            }
            Ok(())
        })
    } else {
        let window = Window::best(&curve, order);
        let mut blocks = blocks_of(&mut found, BLOCK);
        fill_blocks(&mut blocks, 1, watch, |index, states| {
            for (rates, errors) in states {
                window.fill(index * BLOCK, rates, errors);
            }
            Ok(())
        })
    };
    done?;
    Ok(found)
}

/// The order that is meant: 2, 4, 6 or 8.
pub(super) fn even(order: usize) -> usize {
    (order - order % 2).clamp(2, 8)
}

/// The rates and their errors in blocks of so many rows.
fn blocks_of(found: &mut Rates, block: usize) -> Vec<(&mut [[f64; 3]], &mut [f64])> {
    let (rates, errors) = found;
    (rates.chunks_mut(block).zip(errors.chunks_mut(block))).collect()
}

/// The standard deviation of white noise of each component of the rows, from what polynomials through the neighbours of a row
/// miss of this row.
///
/// `t`: at least three times, ascending. About every 20 ms `watch` gets the fraction done and may end the work.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::motion::rates::derivatives::{Rows, noise};
///
/// let t: Vec<f64> = (0..100).map(f64::from).collect();
/// let line: Vec<[f64; 3]> = t.iter().map(|&t| [t, 2.0 * t, 0.0]).collect();
/// assert!(noise(&t, Rows::Vectors(&line), &mut |_| ControlFlow::Continue(()))? < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`Error::Stopped`] if `watch` said so.
///
/// # Panics
/// If there are fewer than three times, or not a row for each.
pub fn noise(t: &[f64], rows: Rows<'_>, watch: &mut Watch<'_>) -> Result<f64, Error> {
    let curve = Curve::of(t, rows, watch)?;
    Ok(Trial::of(&curve, curve.widest(1)).noise)
}

/// A motion whose rows are known.
struct Curve<'a> {
    t: &'a [f64],
    rows: Rows<'a>,
    /// Sums of the turns from the first row to each; none of vectors.
    turned: Vec<f64>,
}

impl<'a> Curve<'a> {
    fn of(t: &'a [f64], rows: Rows<'a>, watch: &mut Watch<'_>) -> Result<Self, Error> {
        assert!(t.len() > 2, "at least three rows");
        let count = match rows {
            Rows::Attitudes(rows) => rows.len(),
            Rows::Vectors(rows) => rows.len(),
        };
        assert_eq!(count, t.len(), "a row for each time");
        let mut curve = Self {
            t,
            rows,
            turned: Vec::new(),
        };
        if let Rows::Attitudes(_) = rows {
            let mut turned = vec![0.0; count];
            let done: Result<(), Halt<Infallible>> =
                fill_blocks(&mut turned[1..], BLOCK, watch, |start, turns| {
                    for (row, turn) in (start..).zip(turns) {
                        *turn = curve.between(row, row + 1).norm();
                    }
                    Ok(())
                });
            done?;
            let mut sum = 0.0;
            for turn in &mut turned {
                sum += *turn;
                *turn = sum;
            }
            curve.turned = turned;
        }
        Ok(curve)
    }

    fn len(&self) -> usize {
        self.t.len()
    }

    /// What leads from one row to another: the shortest rotation vector, or the difference.
    #[inline]
    fn between(&self, from: usize, to: usize) -> Vector3<f64> {
        match self.rows {
            Rows::Attitudes(rows) => {
                rotation_vector(&Quaternion::from(rows[from]), &Quaternion::from(rows[to]))
            }
            Rows::Vectors(rows) => Vector3::from(rows[to]) - Vector3::from(rows[from]),
        }
    }

    /// The rate in turned axes of a path whose value and rate are these.
    #[inline]
    fn rate(&self, path: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
        match self.rows {
            Rows::Attitudes(_) => in_turned_axes(path, rate),
            Rows::Vectors(_) => *rate,
        }
    }

    /// The largest sum of the turns across half a window.
    fn farthest(&self, half: usize) -> f64 {
        let half = half.min(self.len() - 1);
        let ahead = self.turned.iter().skip(half);
        (ahead.zip(&self.turned)).fold(0.0_f64, |most, (b, a)| most.max(b - a))
    }

    /// The widest half window in which rotation vectors are known, if it is not the `least`.
    fn widest(&self, least: usize) -> usize {
        let mut widest = ((self.len() - 1) / 2).min(WIDEST);
        while widest > least && self.farthest(widest) > FAR {
            widest -= 1;
        }
        widest
    }

    /// What leads from each of the rows to those 1, 2, … `half` ahead.
    fn steps(&self, rows: Range<usize>, half: usize, unsure: bool) -> Vec<Vec<Vector3<f64>>> {
        let mut found: Vec<Vec<Vector3<f64>>> = Vec::with_capacity(half);
        for ahead in 1..=half {
            let rows = rows.start..rows.end.min(self.len() - ahead);
            let steps = rows.clone().map(|row| {
                let step = self.between(row, row + ahead);
                match found.last() {
                    Some(before) if unsure => {
                        let scale = ahead as f64 / (ahead - 1) as f64;
                        nearest(&step, &(before[row - rows.start] * scale))
                    }
                    _ => step,
                }
            });
            let steps = steps.collect();
            found.push(steps);
        }
        found
    }

    /// Whether the shortest rotation vector of half a window may be that of another way round.
    fn is_unsure(&self, half: usize) -> bool {
        self.farthest(half) > UNSURE
    }

    /// What leads from a row to each of a window, continued beyond half a turn.
    fn window(&self, center: usize, rows: Range<usize>) -> Vec<Vector3<f64>> {
        let turning = matches!(self.rows, Rows::Attitudes(_));
        let mut found = vec![Vector3::zeros(); rows.len()];
        let ahead: Vec<usize> = (center + 1..rows.end).collect();
        let back: Vec<usize> = (rows.start..center).rev().collect();
        for way in [ahead, back] {
            let mut before: Option<Vector3<f64>> = None;
            for (k, row) in (0_u32..).zip(way) {
                let mut step = self.between(center, row);
                if let Some(before) = before.filter(|_| turning) {
                    step = nearest(&step, &(before * (1.0 + 1.0 / f64::from(k))));
                }
                found[row - rows.start] = step;
                before = Some(step);
            }
        }
        found
    }
}

/// A rotation vector, or that of the same rotation the other way round, if it is nearer to a guess.
#[inline]
fn nearest(step: &Vector3<f64>, guess: &Vector3<f64>) -> Vector3<f64> {
    let size = step.norm();
    if size == 0.0 {
        return *step;
    }
    let other = step * (1.0 - std::f64::consts::TAU / size);
    if (other - guess).norm_squared() < (step - guess).norm_squared() {
        other
    } else {
        *step
    }
}

/// The angular velocity in turned axes from a rotation vector and its rate.
#[inline]
fn in_turned_axes(phi: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    let square = phi.norm_squared();
    let (first, second) = if square < 1e-4 {
        (0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0)
    } else {
        let angle = square.sqrt();
        (
            (1.0 - angle.cos()) / square,
            (angle - angle.sin()) / (square * angle),
        )
    };
    let once = phi.cross(rate);
    rate - once * first + phi.cross(&once) * second
}

/// The size of an error: the square of the change by the next order, less what noise makes of it, and what noise makes of the
/// rate.
#[inline]
fn size(off: f64, noise: f64, gain: f64, change: f64) -> f64 {
    let white = 3.0 * noise * noise;
    ((off - white * change).max(0.0) + white * gain).sqrt()
}

/// Weights of the neighbours of a row.
struct Weights {
    /// Their times since the row, in the order −1, 1, −2, 2, …
    offsets: [f64; MOST],
    /// For each neighbour j the product of `x_k / (x_k − x_j)` over the other neighbours k: the sum of the steps to the
    /// neighbours with them is the row itself, as the polynomial of its neighbours has it.
    ratios: [f64; MOST],
    count: usize,
}

impl Weights {
    const NONE: Self = Self {
        offsets: [0.0; MOST],
        ratios: [0.0; MOST],
        count: 0,
    };

    /// One more neighbour.
    #[inline]
    fn add(&mut self, x: f64) {
        let mut ratio = 1.0;
        for k in 0..self.count {
            let other = self.offsets[k];
            self.ratios[k] *= x / (x - other);
            ratio *= other / (other - x);
        }
        self.offsets[self.count] = x;
        self.ratios[self.count] = ratio;
        self.count += 1;
    }

    /// One more neighbour on either side.
    #[inline]
    fn widen(&mut self, t: &[f64], row: usize, ahead: usize) {
        let pair = [t[row - ahead] - t[row], t[row + ahead] - t[row]];
        let (mut before, mut after) =
            (pair[1] / (pair[1] - pair[0]), pair[0] / (pair[0] - pair[1]));
        for k in 0..self.count {
            let x = self.offsets[k];
            self.ratios[k] *= pair[0] * pair[1] / ((pair[0] - x) * (pair[1] - x));
            before *= x / (x - pair[0]);
            after *= x / (x - pair[1]);
        }
        for (x, ratio) in [(pair[0], before), (pair[1], after)] {
            self.offsets[self.count] = x;
            self.ratios[self.count] = ratio;
            self.count += 1;
        }
    }

    /// The derivative is the sum of the steps to the neighbours with these weights.
    #[inline]
    fn of_derivative(&self) -> [f64; MOST] {
        let mut weights = [0.0; MOST];
        for (k, weight) in weights.iter_mut().enumerate().take(self.count) {
            *weight = self.ratios[k] / self.offsets[k];
        }
        weights
    }
}

#[inline]
fn squares(weights: &[f64]) -> f64 {
    weights.iter().map(|x| x * x).sum()
}

/// The steps from a row to its neighbours, in the order of the weights.
#[inline]
fn neighbours(steps: &[Vec<Vector3<f64>>], at: usize) -> [Vector3<f64>; MOST] {
    let mut near = [Vector3::zeros(); MOST];
    for (k, steps) in steps.iter().enumerate() {
        near[2 * k] = -steps[at - k - 1];
        near[2 * k + 1] = steps[at];
    }
    near
}

#[inline]
fn sum(weights: &[f64], near: &[Vector3<f64>]) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for (weight, step) in weights.iter().zip(near) {
        sum += step * *weight;
    }
    sum
}

/// What a trial on some rows tells: the noise of a component of a row, and the size of the error of each order.
struct Trial {
    noise: f64,
    errors: Vec<f64>,
}

impl Trial {
    fn of(curve: &Curve<'_>, widest: usize) -> Self {
        let mut lacks = vec![Vec::new(); widest];
        let mut sums = vec![[0.0; 3]; widest];
        let unsure = curve.is_unsure(widest);
        for rows in pieces(widest..curve.len() - widest) {
            let first = rows.start - widest;
            let steps = curve.steps(first..rows.end, widest, unsure);
            for row in rows {
                let near = neighbours(&steps, row - first);
                let mut weights = Weights::NONE;
                let mut before: Option<(Vector3<f64>, [f64; MOST])> = None;
                for k in 0..widest {
                    weights.widen(curve.t, row, k + 1);
                    let missing = sum(&weights.ratios, &near[..2 * k + 2]).norm_squared();
                    lacks[k].push(missing / (1.0 + squares(&weights.ratios)));
                    let own = weights.of_derivative();
                    let rate = sum(&own, &near[..2 * k + 2]);
                    sums[k][0] += squares(&own);
                    if let Some((fewer_rate, fewer)) = before {
                        let change = own.iter().zip(&fewer).map(|(a, b)| (a - b) * (a - b));
                        sums[k - 1][1] += (rate - fewer_rate).norm_squared();
                        sums[k - 1][2] += change.sum::<f64>();
                    }
                    before = Some((rate, own));
                }
            }
        }
        let least = lacks.into_iter().map(median).fold(f64::INFINITY, f64::min);
        let noise = (least / MEDIAN).sqrt();
        let white = 3.0 * noise * noise;
        let errors = sums.iter().enumerate().map(|(k, [gain, off, change])| {
            let bias = (off - white * change).max(0.0);
            // Of the widest window it is not known.
            let bias = if k + 1 == widest && widest > 1 {
                f64::INFINITY
            } else {
                bias
            };
            (bias + white * gain).sqrt()
        });
        Self {
            noise,
            errors: errors.collect(),
        }
    }
}

/// Pieces of the rows on which something is tried out: all, or some of them.
fn pieces(rows: Range<usize>) -> Vec<Range<usize>> {
    if rows.len() <= TRIED {
        return vec![rows];
    }
    let count = TRIED / PIECE;
    (0..count)
        .map(|k| {
            let start = rows.start + spread(rows.len() - PIECE, count, k);
            start..start + PIECE
        })
        .collect()
}

/// The k-th of `count` integers that are spread from 0 to `last`.
fn spread(last: usize, count: usize, k: usize) -> usize {
    k * last / (count - 1)
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    let is_even = values.len().is_multiple_of(2);
    let (below, upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let upper = *upper;
    if is_even {
        let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        return 0.5 * (lower + upper);
    }
    upper
}

/// Polynomials through the neighbours of each row.
struct Window<'a> {
    curve: &'a Curve<'a>,
    /// Neighbours on either side.
    half: usize,
    /// Those of two more orders.
    outer: usize,
    noise: f64,
    unsure: bool,
}

impl<'a> Window<'a> {
    /// Of the order, or of the one with the least error.
    fn best(curve: &'a Curve<'a>, order: Option<usize>) -> Self {
        let widest = curve.widest(2);
        let trial = Trial::of(curve, widest);
        let most = (widest - 1).max(1);
        let half = order.map_or_else(
            || {
                let mut best = 0;
                for k in 1..most {
                    if trial.errors[k] < trial.errors[best] {
                        best = k;
                    }
                }
                best + 1
            },
            |order| (order / 2).min(most),
        );
        let outer = (half + 1).min(widest);
        Self {
            curve,
            half,
            outer,
            noise: trial.noise,
            unsure: curve.is_unsure(outer),
        }
    }

    /// The rates and errors of the rows from `start` on.
    fn fill(&self, start: usize, rates: &mut [[f64; 3]], errors: &mut [f64]) {
        let count = self.curve.len();
        let inner = self.outer..(count - self.outer).max(self.outer);
        let rows = start..start + rates.len();
        let whole = rows.start.max(inner.start)..rows.end.min(inner.end);
        let first = whole.start - self.outer;
        let steps = if whole.is_empty() {
            Vec::new()
        } else {
            (self.curve).steps(first..whole.end, self.outer, self.unsure)
        };
        for ((row, rate), error) in rows.zip(rates).zip(errors) {
            let (found, size) = if whole.contains(&row) {
                self.inside(row, &neighbours(&steps, row - first))
            } else {
                self.at_the_end(row)
            };
            (*rate, *error) = (found.into(), size);
        }
    }

    #[inline]
    fn inside(&self, row: usize, near: &[Vector3<f64>; MOST]) -> (Vector3<f64>, f64) {
        let mut weights = Weights::NONE;
        for ahead in 1..=self.half {
            weights.widen(self.curve.t, row, ahead);
        }
        let own = weights.of_derivative();
        let ours = sum(&own[..weights.count], near);
        let (mut off, mut change) = (0.0, 0.0);
        if self.outer > self.half {
            weights.widen(self.curve.t, row, self.outer);
            let wider = weights.of_derivative();
            off = (sum(&wider[..weights.count], near) - ours).norm_squared();
            change = (wider.iter().zip(&own))
                .map(|(a, b)| (a - b) * (a - b))
                .sum();
        }
        (ours, size(off, self.noise, squares(&own), change))
    }

    /// The rate at a row whose window is not whole, from the nearest whole ones.
    fn at_the_end(&self, row: usize) -> (Vector3<f64>, f64) {
        let (ours, weights, start) = self.one_sided(row, self.half);
        let (other, mut wide, wide_start) = self.one_sided(row, self.half + 1);
        let off = if wide.len() == weights.len() {
            ours.norm_squared() // there are no more rows to compare with
        } else {
            (other - ours).norm_squared()
        };
        for (wide, own) in wide[start - wide_start..].iter_mut().zip(&weights) {
            *wide -= own;
        }
        (
            ours,
            size(off, self.noise, squares(&weights), squares(&wide)),
        )
    }

    /// The rate at a row, the weights of all rows of the window, and the first of these.
    fn one_sided(&self, row: usize, half: usize) -> (Vector3<f64>, Vec<f64>, usize) {
        let (curve, count) = (self.curve, self.curve.len());
        let size = (2 * half + 1).min(count);
        let first = row.saturating_sub(size / 2).min(count - size);
        let path = curve.window(first + size / 2, first..first + size);
        let mut weights = Weights::NONE;
        for other in (first..first + size).filter(|&other| other != row) {
            weights.add(curve.t[other] - curve.t[row]);
        }
        let mut own = weights.of_derivative()[..weights.count].to_vec();
        own.insert(row - first, -own.iter().sum::<f64>());
        let rate = sum(&own, &path);
        (curve.rate(&path[row - first], &rate), own, first)
    }
}

/// Polynomials that fit windows of rows, one for some rows each.
struct Fit<'a> {
    curve: &'a Curve<'a>,
    /// Rows on either side of the middle of a window.
    half: usize,
    degree: usize,
    /// Rows from the middle of one window to that of the next: a window serves those after its middle.
    hop: usize,
    bias: f64,
    noise: f64,
    sigma: f64,
}

/// What a fit gives at a row: the rate, the sum of the squares of its weights; how the rate changes by two more degrees, squared, and
/// by how much that sum grows.
struct Fitted {
    rate: Vector3<f64>,
    gain: f64,
    off: f64,
    change: f64,
}

impl<'a> Fit<'a> {
    /// Of the degree and width with the least error, if there are enough rows.
    fn best(curve: &'a Curve<'a>, order: Option<usize>, sigma: f64) -> Option<Self> {
        let degrees = order.map_or(DEGREES.to_vec(), |order| vec![order]);
        let mut best: Option<Self> = None;
        for degree in degrees {
            let mut half = degree / 2 + 1;
            while 2 * half < curve.len() && (half <= degree || curve.farthest(half) < FAR / 2.0) {
                let fit = Self::tried(curve, half, degree, sigma);
                let (bias, noise) = (fit.bias, fit.noise);
                let is_better = |best: &Self| bias.hypot(noise) < best.bias.hypot(best.noise);
                if best.as_ref().is_none_or(is_better) {
                    best = Some(fit);
                }
                if bias > 4.0 * noise {
                    break;
                }
                half = (half + 1).max(half * 3 / 2);
            }
        }
        best
    }

    /// With the sizes of bias and noise that a trial on some rows tells.
    fn tried(curve: &'a Curve<'a>, half: usize, degree: usize, sigma: f64) -> Self {
        let (hop, size) = ((half / 2).max(1), 2 * half + 1);
        let mut fit = Self {
            curve,
            half,
            degree,
            hop,
            bias: 0.0,
            noise: 0.0,
            sigma,
        };
        let windows = curve.len().div_ceil(hop);
        let tried = if windows * size > 8 * TRIED {
            (8 * TRIED / size).max(4)
        } else {
            windows
        };
        let (mut off, mut gain, mut change) = (0.0, 0.0, 0.0);
        for k in 0..tried {
            let middle = if tried < windows {
                spread(windows - 1, tried, k)
            } else {
                k
            };
            fit.each(middle * hop, hop, |_, found| {
                off += found.off;
                gain += found.gain;
                change += found.change;
            });
        }
        let (rows, white) = ((tried * hop) as f64, 3.0 * sigma * sigma);
        fit.bias = ((off - white * change).max(0.0) / rows).sqrt();
        fit.noise = (white * gain / rows).sqrt();
        fit
    }

    /// The rates and errors of the rows from `start` on.
    fn fill(&self, start: usize, rates: &mut [[f64; 3]], errors: &mut [f64]) {
        let white = 3.0 * self.sigma * self.sigma;
        for (k, (rates, errors)) in
            (rates.chunks_mut(self.hop).zip(errors.chunks_mut(self.hop))).enumerate()
        {
            self.each(start + k * self.hop, rates.len(), |row, found| {
                rates[row] = found.rate.into();
                errors[row] = (self.bias * self.bias + white * found.gain).sqrt();
            });
        }
    }

    /// What the window about a row gives at so many rows from this one on; beyond the last row it is that of the last one.
    fn each(&self, nearest: usize, rows: usize, mut then: impl FnMut(usize, Fitted)) {
        let (curve, size) = (self.curve, 2 * self.half + 1);
        let first = nearest.saturating_sub(self.half).min(curve.len() - size);
        let middle = first + self.half;
        let since = |row: usize| curve.t[row] - curve.t[middle];
        let scale = since(first).abs().max(since(first + size - 1).abs());
        let terms = self.degree + 3;
        // Times may stand in clumps: a little more on the diagonal.
        let mut gram = [[0.0; TERMS]; TERMS];
        let mut right = [Vector3::zeros(); TERMS];
        for row in first..first + size {
            let (basis, _) = legendre(since(row) / scale, terms);
            let step = curve.between(middle, row);
            for i in 0..terms {
                right[i] += step * basis[i];
                for j in 0..=i {
                    gram[i][j] += basis[i] * basis[j];
                }
            }
        }
        for (i, row) in gram.iter_mut().enumerate() {
            row[i] += 1e-13 * size as f64;
        }
        factor(&mut gram, terms);
        // The leading terms of what is solved forward are those of the lower degree.
        let solved = forward(&gram, terms, &right);
        for k in 0..rows {
            let row = (nearest + k).min(curve.len() - 1);
            let (basis, slopes) = legendre(since(row) / scale, terms);
            let basis = forward(&gram, terms, &basis);
            let slopes = forward(&gram, terms, &slopes.map(|slope| slope / scale));
            let at = |terms: Range<usize>, factors: &[f64; TERMS]| {
                sum(&factors[terms.clone()], &solved[terms])
            };
            let fewer = 0..self.degree + 1;
            let more = self.degree + 1..terms;
            let (phi, rate) = (at(fewer.clone(), &basis), at(fewer.clone(), &slopes));
            let ours = curve.rate(&phi, &rate);
            let other = curve.rate(
                &(phi + at(more.clone(), &basis)),
                &(rate + at(more.clone(), &slopes)),
            );
            let found = Fitted {
                rate: ours,
                gain: squares(&slopes[fewer]),
                off: (other - ours).norm_squared(),
                change: squares(&slopes[more]),
            };
            then(k, found);
        }
    }
}

/// Legendre polynomials and their derivatives.
#[inline]
fn legendre(x: f64, terms: usize) -> ([f64; TERMS], [f64; TERMS]) {
    let (mut values, mut slopes) = ([0.0; TERMS], [0.0; TERMS]);
    (values[0], values[1], slopes[1]) = (1.0, x, 1.0);
    let mut n = 1.0;
    for k in 1..terms - 1 {
        values[k + 1] = ((2.0 * n + 1.0) * x * values[k] - n * values[k - 1]) / (n + 1.0);
        slopes[k + 1] = slopes[k - 1] + (2.0 * n + 1.0) * values[k];
        n += 1.0;
    }
    (values, slopes)
}

/// Cholesky's factor of a positive definite matrix, in the place of its lower half.
fn factor(matrix: &mut [[f64; TERMS]; TERMS], terms: usize) {
    for i in 0..terms {
        for j in 0..=i {
            let mut rest = matrix[i][j];
            for (a, b) in matrix[i].iter().zip(&matrix[j]).take(j) {
                rest -= a * b;
            }
            matrix[i][j] = if i == j {
                rest.sqrt()
            } else {
                rest / matrix[j][j]
            };
        }
    }
}

/// The solution y of L y = b.
#[inline]
fn forward<T>(factor: &[[f64; TERMS]; TERMS], terms: usize, right: &[T; TERMS]) -> [T; TERMS]
where
    T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Div<f64, Output = T> + std::ops::SubAssign,
{
    let mut solved = *right;
    for i in 0..terms {
        for k in 0..i {
            let known = solved[k];
            solved[i] -= known * factor[i][k];
        }
        solved[i] = solved[i] / factor[i][i];
    }
    solved
}

#[cfg(test)]
mod tests {
    use super::super::rotations::exponential;
    use super::*;
    use std::f64::consts::TAU;
    use std::ops::ControlFlow;

    fn found(t: &[f64], rows: Rows<'_>, order: Option<usize>, sigma: Option<f64>) -> Rates {
        rates(t, rows, order, sigma, &mut |_| ControlFlow::Continue(())).expect("rates")
    }

    /// Times in uneven steps of one on the average.
    fn uneven(count: u32) -> Vec<f64> {
        let jitter = |k: u32| 0.4 * (1.7 * f64::from(k)).sin();
        (0..count).map(|k| f64::from(k) + jitter(k)).collect()
    }

    /// White noise of unit variance, nearly: sums of twelve uniform numbers.
    fn noisy(count: usize, sigma: f64) -> Vec<[f64; 3]> {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        (0..count)
            .map(|_| [(); 3].map(|()| sigma * normal()))
            .collect()
    }

    fn steady(t: &[f64], omega: &Vector3<f64>) -> Vec<[f64; 4]> {
        t.iter()
            .map(|t| exponential(&(omega * *t)).coords.into())
            .collect()
    }

    fn off(found: &[[f64; 3]], exact: impl Fn(usize) -> Vector3<f64>) -> f64 {
        (found.iter().enumerate()).fold(0.0, |most, (k, found)| {
            most.max((Vector3::from(*found) - exact(k)).norm())
        })
    }

    #[test]
    fn polynomials_up_to_the_order_have_their_derivatives_at_all_rows() {
        let t = uneven(40);
        for order in [2, 4, 6, 8] {
            for degree in [order, order + 1] {
                let power = i32::try_from(degree).expect("few");
                let scale = 1.0 / 40.0_f64.powi(power);
                let rows: Vec<_> = t
                    .iter()
                    .map(|t| [t.powi(power) * scale, 0.01 * t, 0.0])
                    .collect();
                let (rates, errors) = found(&t, Rows::Vectors(&rows), Some(order), None);
                let exact = |k: usize| {
                    Vector3::new(f64::from(power) * t[k].powi(power - 1) * scale, 0.01, 0.0)
                };
                let off = off(&rates, exact);
                assert_eq!(off < 1e-12, degree == order, "{order} {degree} {off:e}");
                if degree > order {
                    for (k, error) in errors.iter().enumerate() {
                        let off = (Vector3::from(rates[k]) - exact(k)).norm();
                        assert!(off < 1.01 * error + 1e-13, "{order} {k} {off:e} {error:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_steady_turn_has_its_angular_velocity_however_far_it_turns() {
        // From a turn of 3 in half a window on, the shortest rotation vector is not the one of the motion; from 5 on
        // windows are narrower; the last steps are nearly half a turn each.
        let t = uneven(30);
        for speed in [1e-9, 0.29, 0.59, 0.61, 0.99, 1.01, 1.24, 1.9] {
            let omega = Vector3::new(2.0, -3.0, 6.0) * (speed / 7.0);
            let rows = steady(&t, &omega);
            for order in [None, Some(2), Some(8)] {
                let (rates, _) = found(&t, Rows::Attitudes(&rows), order, None);
                let off = off(&rates, |_| omega);
                assert!(off < 1e-12 * (1.0 + speed), "{speed} {order:?} {off:e}");
            }
        }
    }

    #[test]
    fn coning_motion_has_its_angular_velocity() {
        // The rotation vector θ (cos νt, sin νt, 0) turns with ν (−sin θ sin νt, sin θ cos νt, cos θ − 1) in the body.
        let (cone, rate) = (0.7_f64, 0.05);
        let t = uneven(200);
        let rows: Vec<[f64; 4]> = (t.iter())
            .map(|t| {
                let (sine, cosine) = (rate * t).sin_cos();
                exponential(&(Vector3::new(cosine, sine, 0.0) * cone))
                    .coords
                    .into()
            })
            .collect();
        let exact = |k: usize| {
            let (sine, cosine) = (rate * t[k]).sin_cos();
            Vector3::new(-cone.sin() * sine, cone.sin() * cosine, cone.cos() - 1.0) * rate
        };
        let (rates, errors) = found(&t, Rows::Attitudes(&rows), None, None);
        let worst = errors.iter().fold(0.0_f64, |a, b| a.max(*b));
        let off = off(&rates, exact);
        assert!(off < 2.0 * worst && worst < 1e-9, "{off:e} {worst:e}");
    }

    #[test]
    fn a_rate_in_turned_axes_is_the_same_on_both_sides_of_its_series() {
        let (axis, rate) = (Vector3::new(0.6, 0.0, 0.8), Vector3::new(1.0, 2.0, -3.0));
        let [below, above] = [0.01 * (1.0 - 1e-12), 0.01 * (1.0 + 1e-12)]
            .map(|x| in_turned_axes(&(axis * x), &rate));
        assert!((below - above).norm() < 1e-11);
        let still = in_turned_axes(&Vector3::zeros(), &rate);
        assert_eq!(still, rate);
        // About an axis across, by a quarter of a turn: φ̇ is seen as (sin φ)/φ and (cos φ − 1)/φ of it.
        let quarter = TAU / 4.0;
        let seen = in_turned_axes(&(Vector3::z() * quarter), &Vector3::x());
        assert!((seen - Vector3::new(1.0, -1.0, 0.0) / quarter).norm() < 1e-15);
    }

    #[test]
    fn the_noise_of_rows_is_found() {
        let t = uneven(3000);
        let rows = noisy(3000, 0.01);
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        let of_vectors = noise(&t, Rows::Vectors(&rows), go_on).expect("noise");
        assert!((of_vectors / 0.01 - 1.0).abs() < 0.05, "{of_vectors}");
        let turns: Vec<[f64; 4]> = (t.iter().zip(&rows))
            .map(|(t, noise)| {
                let turn = exponential(&(Vector3::new(0.0, 0.1, 0.2) * *t));
                (turn * exponential(&Vector3::from(*noise))).coords.into()
            })
            .collect();
        let of_attitudes = noise(&t, Rows::Attitudes(&turns), go_on).expect("noise");
        assert!((of_attitudes / 0.01 - 1.0).abs() < 0.05, "{of_attitudes}");
    }

    #[test]
    fn a_fit_smooths_noise_and_keeps_polynomials() {
        let t = uneven(2000);
        let sigma = 1e-3;
        let noise = noisy(2000, sigma);
        let wave = |t: f64| Vector3::new((0.01 * t).sin(), (0.02 * t).cos(), 0.0);
        let slope = |t: f64| Vector3::new(0.01 * (0.01 * t).cos(), -0.02 * (0.02 * t).sin(), 0.0);
        let rows: Vec<[f64; 3]> = (t.iter().zip(&noise))
            .map(|(t, noise)| (wave(*t) + Vector3::from(*noise)).into())
            .collect();
        let (rates, errors) = found(&t, Rows::Vectors(&rows), None, Some(sigma));
        let mean = |of: &dyn Fn(usize) -> f64| {
            ((0..t.len()).map(|k| of(k).powi(2)).sum::<f64>() / t.len() as f64).sqrt()
        };
        let size = mean(&|k| (Vector3::from(rates[k]) - slope(t[k])).norm());
        let claimed = mean(&|k| errors[k]);
        assert!(
            size < 1.5 * claimed && claimed < 2.0 * size,
            "{size:e} {claimed:e}"
        );
        assert!(claimed < 0.05 * sigma);
        let line: Vec<[f64; 3]> = t.iter().map(|t| [0.01 * t, 1.0, 0.0]).collect();
        let (rates, _) = found(&t, Rows::Vectors(&line), Some(2), Some(sigma));
        assert!(off(&rates, |_| Vector3::new(0.01, 0.0, 0.0)) < 1e-13);
    }

    #[test]
    fn the_noise_of_a_slope_is_that_of_least_squares() {
        // A parabola through 2 h + 1 even rows: the slope in the middle has the variance σ² / Σ k².
        let t: Vec<f64> = (0..41).map(f64::from).collect();
        let rows = vec![[0.0; 3]; 41];
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        let curve = Curve::of(&t, Rows::Vectors(&rows), go_on).expect("a curve");
        let fit = Fit::tried(&curve, 6, 2, 1.0);
        fit.each(20, 1, |_, found| {
            assert!((found.gain * 182.0 - 1.0).abs() < 1e-9, "{}", found.gain);
        });
    }

    #[test]
    fn few_rows_and_orders_that_are_none() {
        let t = [0.0, 1.0, 2.5];
        let rows = t.map(|t: f64| [t * t, t, 0.0]);
        for order in [None, Some(0), Some(3), Some(2), Some(100)] {
            let (rates, errors) = found(&t, Rows::Vectors(&rows), order, None);
            assert!(off(&rates, |k| Vector3::new(2.0 * t[k], 1.0, 0.0)) < 1e-14);
            assert!(errors.iter().all(|error| error.is_finite()));
            let (rates, _) = found(&t, Rows::Vectors(&rows), order, Some(1e-3));
            assert!(off(&rates, |k| Vector3::new(2.0 * t[k], 1.0, 0.0)) < 1e-14);
        }
        assert_eq!(
            [0, 1, 2, 3, 5, 8, 9, 100].map(even),
            [2, 2, 2, 2, 4, 8, 8, 8]
        );
    }

    #[test]
    fn a_watch_ends_the_work() {
        let t: Vec<f64> = (0..200_000).map(f64::from).collect();
        let rows = steady(&t, &Vector3::new(0.0, 0.0, 0.1));
        let stop = &mut |_: f64| ControlFlow::Break(());
        assert_eq!(
            rates(&t, Rows::Attitudes(&rows), None, None, stop),
            Err(Error::Stopped)
        );
    }
}
