//! The most likely tensor of a body that turns freely, from a log of its angular velocity.
//!
//! The log is that of the exact motion plus white noise, and perhaps a constant offset:
//!
//! ```text
//! y_i = ω(t_i; ω₀, I) + b + n_i ,        I ω̇ + ω × (I ω + h) = N .
//! ```
//!
//! Without a known h or N the log has only ratios of the tensor; its trace is 1 then. Further sensors may be beside the gyro: attitudes, the
//! specific force at an unknown place r in free flight, and the gyro may have errors s of its scales,
//!
//! ```text
//! M_i = R(t_i) exp([n]×) ,        f_i = ω̇ × r + ω × (ω × r) + n ,        y_i = (1 + s) ω(t_i) + b + n .
//! ```
//!
//! They are taken in after the gyro alone was fitted.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::momentum_balance::{Balanced, Question, estimates, is_tensor};
use super::series::{Follower, Place, Sample, Spinning};
use super::triangle::{Linear, Stop, Triangle, descend};
use crate::error::Error;
use crate::motion::rates::derivatives::{Rows, noise};
use crate::numerics::eigen3::eigen3;
use crate::numerics::threads::Watch;

/// Degrees of freedom of Student's distribution.
const NU: f64 = 4.0;
/// Places of the tensor's elements: xx, yy, zz, xy, xz, yz.
pub const ELEMENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Rows between two looks at `watch`.
const LOOK: usize = 1024;
/// Length of a piece of the log, in units of angle at the usual rate.
const PIECE: f64 = 1.0;
/// Rows so near are as good as at the same time, for a start.
const NEAR: f64 = 0.15;
/// Steps of a chain, at most.
const JOINS: usize = 15;
/// Those of a further start: what is not near a maximum by then is not near the best one.
const TRIES: usize = 6;
/// Rows on which further starts are tried out, or those of so large an angle at the usual rate if they are more; and how many of them.
const HEAD: usize = 2000;
const HEAD_ANGLE: f64 = 60.0;
const TRIED: usize = 300;
/// Of log L: maxima that are lower by more are left out.
const WITHIN: f64 = 3.0;

/// What is known of the offset of the gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bias {
    /// There is none.
    Zero,
    /// Nothing.
    Free,
    /// Its mean, and the rows that make errors of unit variance of its deviation.
    Prior([f64; 3], [[f64; 3]; 3]),
}

/// What a further sensor measured.
#[derive(Clone, Copy, Debug)]
pub struct Sensor<'a, const N: usize> {
    /// A row for each time of the log; not finite where there is none.
    pub rows: &'a [[f64; N]],
    /// Standard deviations of white noise along the axes of B; for attitudes, angles.
    pub sigma: [f64; 3],
}

/// A log of a tumble and what is known of the body.
#[derive(Clone, Copy, Debug)]
pub struct Tumble<'a> {
    /// Ascending times.
    pub t: &'a [f64],
    /// Measured angular velocity in B at these times; finite.
    pub omega: &'a [[f64; 3]],
    /// Standard deviations of its components; None where unknown, and one for the three.
    pub sigma: Option<[f64; 3]>,
    /// Constant offset of the gyro.
    pub bias: Bias,
    /// Constant momentum of rotors inside, in B.
    pub momentum: [f64; 3],
    /// Constant torque, in B.
    pub torque: [f64; 3],
    /// The elements of the tensor beforehand, and the rows that make errors of unit variance of their deviations.
    pub prior: Option<([f64; 6], [[f64; 6]; 6])>,
    /// Attitudes `R_NB`, as unit quaternions (x, y, z, w).
    pub attitude: Option<Sensor<'a, 4>>,
    /// What an accelerometer at an unknown place reads in free flight, in B.
    pub specific_force: Option<Sensor<'a, 3>>,
    /// Whether the gyro's scales are unknown; only attitudes tell them.
    pub gyro_scale: bool,
    /// Whether noise follows Student's distribution with 4 degrees of freedom, not the normal one.
    pub student: bool,
    /// Number of further starts, at most.
    pub starts: usize,
}

/// The most likely parameters.
#[derive(Clone, Debug)]
pub struct Fit {
    /// ω at the first time.
    pub omega: [f64; 3],
    /// Elements xx, yy, zz, xy, xz, yz of the tensor.
    pub inertia: [f64; 6],
    /// Offset of the gyro.
    pub bias: [f64; 3],
    /// Errors of its scales.
    pub gyro_scale: [f64; 3],
    /// Attitude `R_NB` at the first time (x, y, z, w); the identity where nothing tells it.
    pub attitude: [f64; 4],
    /// Place of the accelerometer from the centre of mass, in B.
    pub place: [f64; 3],
    /// Standard deviations of the noise of the gyro.
    pub sigma: [f64; 3],
    /// −2 log L, but for a constant.
    pub cost: f64,
    /// Sum of squares of the residuals of log and priors in units of sigma.
    pub chi2: f64,
    /// Measured minus predicted, in units of sigma: for each time those of the gyro and of each further sensor, NaN where it has no row.
    pub residuals: Vec<[f64; 3]>,
    /// The triangle of the derivatives of all predictions by ω₀ (3), tensor (6) and what else is unknown, three numbers each: bias, scales
    /// of the gyro, the first attitude as a small turn in B, the place of the accelerometer; in units of sigma; rows.
    pub triangle: Vec<Vec<f64>>,
    /// Whether the tensor is the best on the edge of those of bodies.
    pub at_edge: bool,
    /// Whether the iteration came to its end.
    pub converged: bool,
}

/// Parameters, in units of the fit.
#[derive(Clone, Copy, Debug)]
struct Point {
    omega: Vector3<f64>,
    inertia: Matrix3<f64>,
    bias: Vector3<f64>,
    scale: Vector3<f64>,
    /// `R_NB` at the first time.
    attitude: UnitQuaternion<f64>,
    place: Vector3<f64>,
}

/// The first columns of what is unknown beside ω₀ and the tensor.
#[derive(Clone, Copy, Debug)]
struct Layout {
    bias: Option<usize>,
    scale: Option<usize>,
    attitude: Option<usize>,
    place: Option<usize>,
    unknowns: usize,
}

/// Parameters with the angular velocity at the start of each piece of the log, not only of the first.
#[derive(Clone, Debug)]
struct Chain {
    point: Point,
    /// Of all pieces but the first.
    nodes: Vec<Vector3<f64>>,
}

/// What is known of a chain.
struct Linked {
    triangle: Triangle,
    /// What the log costs.
    cost: f64,
    /// The sum of squares of the gaps, in units of sigma.
    gaps: f64,
    /// How each node follows the parameters, if the gaps are closed.
    follows: Vec<Place<10>>,
}

/// The log in units of the fit: times of 1/rate from the first one on, a tensor of about 1.
struct Scaled<'a> {
    tumble: &'a Tumble<'a>,
    t: Vec<f64>,
    omega: Vec<[f64; 3]>,
    sigma: Cell<[f64; 3]>,
    momentum: Vector3<f64>,
    torque: Vector3<f64>,
    rate: f64,
    unit: f64,
    /// Whether h, N or a prior has the scale of the tensor.
    has_scale: bool,
    /// The noise that the log seems to have.
    level: f64,
    /// Whether further sensors are taken in.
    all: Cell<bool>,
    watch: &'a dyn Fn(f64) -> ControlFlow<()>,
    stopped: Cell<bool>,
    /// The fraction done.
    done: Cell<f64>,
}

/// Find the maxima of the likelihood of a log: the best first, then others within 3 of its logarithm.
///
/// The first start balances momentum over windows. Pieces of the log are fitted then, and their gaps close as the fit goes on. Further
/// starts have other tensors. `watch` gets the fraction done and may end the work.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::RigidBody;
/// use polhode::motion::free::FreeMotion;
/// use polhode::motion::identification::{Bias, Fit, Sensor, Tumble, fit_tumble, information};
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
///
/// let tensor = Matrix3::from_diagonal(&Vector3::new(0.2, 0.35, 0.45));
/// let body = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0)?;
/// let motion = FreeMotion::of(&body, &Vector3::new(1.0, 2.0, 0.5), &UnitQuaternion::identity())?;
/// let t: Vec<f64> = (0..300).map(|i| 0.02 * f64::from(i)).collect();
/// let omega: Vec<[f64; 3]> = t.iter().map(|&t| motion.at(t).omega.into()).collect();
/// let seen: Vec<[f64; 4]> = t
///     .iter()
///     .map(|&t| motion.at(t).attitude.into_inner().coords.into())
///     .collect();
/// let tumble = Tumble {
///     t: &t,
///     omega: &omega,
///     sigma: Some([1e-3; 3]),
///     bias: Bias::Zero,
///     momentum: [0.0; 3],
///     torque: [0.0; 3],
///     prior: None,
///     attitude: Some(Sensor { rows: &seen, sigma: [1e-2; 3] }),
///     specific_force: None,
///     gyro_scale: false,
///     student: false,
///     starts: 4,
/// };
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let found: Vec<Fit> = fit_tumble(&tumble, go_on)?;
/// assert!((found[0].inertia[0] - 0.2).abs() < 1e-9);
///
/// // What the same throw tells could be known before.
/// let throw = ([1.0, 2.0, 0.5], [0.2, 0.35, 0.45, 0.0, 0.0, 0.0], [0.0; 3]);
/// let before = information(&tumble, throw, go_on)?;
/// let before = before.expect("a motion that can be followed");
/// assert!((before.triangle[0][0] / found[0].triangle[0][0] - 1.0).abs() < 1e-6);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`Error::Stopped`] if `watch` said so.
///
/// # Panics
/// If there are fewer than three times, or not a row for each.
pub fn fit_tumble(tumble: &Tumble<'_>, watch: &mut Watch<'_>) -> Result<Vec<Fit>, Error> {
    assert!(tumble.t.len() >= 3, "at least three times");
    assert_eq!(tumble.t.len(), tumble.omega.len(), "a row for each time");
    let level = noise(tumble.t, Rows::Vectors(tumble.omega), watch)?;
    let watch = RefCell::new(watch);
    let watch = |done: f64| (watch.borrow_mut())(done);
    let scaled = Scaled::new(tumble, usual_rate(tumble.omega), level, &watch);
    let found = scaled.maxima();
    if scaled.stopped.get() {
        return Err(Error::Stopped);
    }
    Ok(found)
}

/// Compute what a log of the motion from `omega` would tell of the tensor `inertia`, with an accelerometer at `place`: the derivatives of
/// its predictions by ω₀, tensor and what else is unknown, in units of their sigmas. The measured values do not matter. None where the
/// motion turns by so much from row to row that it is not followed.
///
/// # Errors
/// [`Error::Stopped`] if `watch` said so.
///
/// # Panics
/// If there are no times.
pub fn information(
    tumble: &Tumble<'_>,
    (omega, inertia, place): ([f64; 3], [f64; 6], [f64; 3]),
    watch: &mut Watch<'_>,
) -> Result<Option<Fit>, Error> {
    assert!(!tumble.t.is_empty(), "times");
    let watch = RefCell::new(watch);
    let watch = |done: f64| (watch.borrow_mut())(done);
    let scaled = Scaled::new(tumble, Vector3::from(omega).norm(), 0.0, &watch);
    scaled.all.set(true);
    let point = Point {
        place: place.into(),
        ..Point::new(
            Vector3::from(omega) / scaled.rate,
            tensor(&inertia) / scaled.unit,
            Vector3::zeros(),
        )
    };
    let fit = scaled.fit_at(&point, false, true);
    if scaled.stopped.get() {
        return Err(Error::Stopped);
    }
    Ok(fit)
}

impl Point {
    fn new(omega: Vector3<f64>, inertia: Matrix3<f64>, bias: Vector3<f64>) -> Self {
        Self {
            omega,
            inertia,
            bias,
            scale: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            place: Vector3::zeros(),
        }
    }
}

fn tensor(elements: &[f64; 6]) -> Matrix3<f64> {
    let mut found = Matrix3::zeros();
    for (x, (i, j)) in elements.iter().zip(ELEMENTS) {
        found[(i, j)] = *x;
        found[(j, i)] = *x;
    }
    found
}

/// The change of the tensor with each of its elements.
fn element_directions() -> Vec<Matrix3<f64>> {
    (0..6)
        .map(|k| {
            let mut one = [0.0; 6];
            one[k] = 1.0;
            tensor(&one)
        })
        .collect()
}

/// Orthonormal directions of tensors across the given ones.
fn directions_across(without: &[Matrix3<f64>]) -> Vec<Matrix3<f64>> {
    let mut basis: Vec<Matrix3<f64>> = Vec::new();
    let mut found = Vec::new();
    for (k, one) in without
        .iter()
        .copied()
        .chain(element_directions())
        .enumerate()
    {
        let mut rest = one / one.norm();
        for _ in 0..2 {
            for other in &basis {
                rest -= other * other.dot(&rest);
            }
        }
        if rest.norm() > 1e-6 {
            let own = rest / rest.norm();
            basis.push(own);
            if k >= without.len() {
                found.push(own);
            }
        }
        if basis.len() == 6 {
            break;
        }
    }
    found
}

/// The median of |ω|.
fn usual_rate(omega: &[[f64; 3]]) -> f64 {
    let mut rates: Vec<f64> = omega.iter().map(|one| Vector3::from(*one).norm()).collect();
    let middle = rates.len() / 2;
    *rates.select_nth_unstable_by(middle, f64::total_cmp).1
}

impl<'a> Scaled<'a> {
    fn new(
        tumble: &'a Tumble<'a>,
        rate: f64,
        level: f64,
        watch: &'a dyn Fn(f64) -> ControlFlow<()>,
    ) -> Self {
        let rate = if rate > 0.0 { rate } else { 1.0 };
        let (h, n) = (Vector3::from(tumble.momentum), Vector3::from(tumble.torque));
        let prior = tumble.prior.map(|(mean, _)| mean[0] + mean[1] + mean[2]);
        let moment = (h.norm() / rate).max(n.norm() / rate.powi(2));
        let unit = prior.unwrap_or(if moment > 0.0 { 3.0 * moment } else { 1.0 });
        // Noise below rounding is none.
        let level = (level / rate).max(1e-13);
        Self {
            t: tumble.t.iter().map(|t| (t - tumble.t[0]) * rate).collect(),
            omega: tumble.omega.iter().map(|y| y.map(|x| x / rate)).collect(),
            sigma: Cell::new(
                tumble
                    .sigma
                    .map_or([level; 3], |sigma| sigma.map(|x| x / rate)),
            ),
            momentum: h / (rate * unit),
            torque: n / (rate * rate * unit),
            has_scale: prior.is_some() || moment > 0.0,
            tumble,
            rate,
            unit,
            level,
            all: Cell::new(false),
            watch,
            stopped: Cell::new(false),
            done: Cell::new(0.0),
        }
    }

    /// Some of the rows, on which starts are tried out.
    fn thin_out(&self) -> Self {
        let turned = self.t.partition_point(|t| *t <= HEAD_ANGLE);
        let head = turned.max(HEAD).min(self.rows());
        let stride = head.div_ceil(TRIED);
        Self {
            t: self.t[..head].iter().step_by(stride).copied().collect(),
            omega: self.omega[..head].iter().step_by(stride).copied().collect(),
            sigma: self.sigma.clone(),
            all: Cell::new(false),
            stopped: Cell::new(false),
            done: self.done.clone(),
            ..*self
        }
    }

    fn rows(&self) -> usize {
        self.t.len()
    }

    fn has_bias(&self) -> bool {
        self.tumble.bias != Bias::Zero
    }

    fn has_more(&self) -> bool {
        let tumble = self.tumble;
        tumble.gyro_scale || tumble.attitude.is_some() || tumble.specific_force.is_some()
    }

    /// The columns beside ω₀ and so many directions of the tensor.
    fn layout(&self, directions: usize) -> Layout {
        let (all, mut unknowns) = (self.all.get(), 3 + directions);
        let mut three = |there: bool| {
            there.then(|| {
                unknowns += 3;
                unknowns - 3
            })
        };
        let bias = three(self.has_bias());
        let scale = three(all && self.tumble.gyro_scale);
        let attitude = three(all && self.tumble.attitude.is_some());
        let place = three(all && self.tumble.specific_force.is_some());
        Layout {
            bias,
            scale,
            attitude,
            place,
            unknowns,
        }
    }

    /// Return the point after a step.
    fn step_from(&self, at: &Point, step: &[f64], directions: &[Matrix3<f64>]) -> Point {
        let layout = self.layout(directions.len());
        let three = |first: usize| Vector3::new(step[first], step[first + 1], step[first + 2]);
        let mut next = *at;
        next.omega += three(0);
        for (x, direction) in step[3..].iter().zip(directions) {
            next.inertia += direction * *x;
        }
        next.bias += layout.bias.map_or(Vector3::zeros(), three);
        next.scale += layout.scale.map_or(Vector3::zeros(), three);
        next.place += layout.place.map_or(Vector3::zeros(), three);
        if let Some(first) = layout.attitude {
            next.attitude *= UnitQuaternion::from_scaled_axis(three(first));
        }
        next
    }

    /// Changes of the tensor that keep its scale, if nothing tells it.
    fn directions(&self) -> Vec<Matrix3<f64>> {
        if self.has_scale {
            directions_across(&[])
        } else {
            directions_across(&[Matrix3::identity()])
        }
    }

    fn spinning(&self, at: &Point) -> Spinning {
        Spinning {
            inertia: at.inertia,
            momentum: self.momentum,
            torque: self.torque,
        }
    }

    /// Return whether to go on.
    fn look(&self) -> ControlFlow<()> {
        let answer = (self.watch)(self.done.get());
        if answer.is_break() {
            self.stopped.set(true);
        }
        answer
    }

    /// What residuals of three components cost, and the root of the weight of their rows.
    ///
    /// `expected` asks for the weight that is expected, not that of these residuals.
    fn loss(&self, square: f64, expected: bool) -> (f64, f64) {
        if self.tumble.student {
            let root = ((NU + 3.0) / if expected { NU + 5.0 } else { NU + square }).sqrt();
            ((NU + 3.0) * (square / NU).ln_1p(), root)
        } else {
            (square, 1.0)
        }
    }

    /// The cost of the first rows at a place, and its derivatives by ω₀, the tensor along the directions, and what else is unknown.
    ///
    /// With a place to keep the residuals the derivatives have the weights that are expected, not those of these residuals.
    fn evaluate<const C: usize>(
        &self,
        at: &Point,
        rows: usize,
        limit: f64,
        directions: &[Matrix3<f64>],
        mut rests: Option<&mut Vec<[f64; 3]>>,
    ) -> Option<Linear> {
        if self.look().is_break() {
            return None;
        }
        let (inner, layout) = (3 + directions.len(), self.layout(directions.len()));
        let unknowns = layout.unknowns;
        let (bias, scale) = (
            layout.bias.unwrap_or(unknowns),
            layout.scale.unwrap_or(unknowns),
        );
        let mut triangle = Triangle::new(unknowns);
        let mut cost = self.prior_rows(at, directions, &mut triangle);
        let weights = Vector3::from(self.sigma.get().map(f64::recip));
        let spinning = self.spinning(at);
        let mut follower = Follower::<C>::of(&spinning, directions)?;
        if layout.attitude.is_some() {
            follower = follower.with_attitude();
        }
        let axes = follower.axes;
        let others = Others::<C> {
            log: self,
            at,
            layout,
            axes,
            turned: UnitQuaternion::from_matrix(&axes),
            inverse: spinning.inertia.try_inverse()?,
            spinning,
            directions,
        };
        let whole = follower.run(
            &Place::start(at.omega),
            (0.0, self.t[rows - 1]),
            &self.t[..rows],
            |sample: &Sample<'_, C>| {
                if sample.row % LOOK == LOOK - 1 {
                    self.look()?;
                }
                let own = axes * Vector3::from(*sample.omega);
                let predicted = own + at.scale.component_mul(&own) + at.bias;
                let rest =
                    (Vector3::from(self.omega[sample.row]) - predicted).component_mul(&weights);
                let (loss, root) = self.loss(rest.norm_squared(), rests.is_some());
                cost += loss;
                if let Some(rests) = rests.as_deref_mut() {
                    rests.push(rest.into());
                }
                if !(cost <= limit) {
                    return ControlFlow::Break(());
                }
                for i in 0..3 {
                    let share = weights[i] * root;
                    let by_motion = share * (1.0 + at.scale[i]);
                    let a = [0, 1, 2].map(|k| axes[(i, k)] * by_motion);
                    let [x, y, z] = sample.columns;
                    let motion = (0..inner).map(|c| a[0] * x[c] + a[1] * y[c] + a[2] * z[c]);
                    let beside = (inner..unknowns).map(|c| {
                        if c == bias + i {
                            share
                        } else if c == scale + i {
                            share * own[i]
                        } else {
                            0.0
                        }
                    });
                    triangle.push(motion.chain(beside), rest[i] * root);
                }
                if layout.attitude.is_some() || layout.place.is_some() {
                    cost += others.take(sample, &mut triangle, rests.as_deref_mut());
                }
                ControlFlow::Continue(())
            },
        );
        triangle.fold();
        (whole.is_some() && cost.is_finite()).then_some(Linear { triangle, cost })
    }

    /// Adds the rows of what is known beforehand, and returns their cost.
    fn prior_rows(&self, at: &Point, directions: &[Matrix3<f64>], triangle: &mut Triangle) -> f64 {
        let (inner, unknowns) = (3 + directions.len(), triangle.unknowns());
        let mut cost = 0.0;
        let mut push = |first: usize, row: &[f64], target: f64| {
            let row = (0..unknowns).map(|c| {
                c.checked_sub(first)
                    .and_then(|k| row.get(k))
                    .copied()
                    .unwrap_or(0.0)
            });
            triangle.push(row, target);
            cost += target * target;
        };
        if let Bias::Prior(mean, white) = self.tumble.bias {
            let off = Vector3::from(mean) - at.bias * self.rate;
            for row in white {
                let target = Vector3::from(row).dot(&off);
                push(inner, &row.map(|x| x * self.rate), target);
            }
        }
        if let Some((mean, white)) = self.tumble.prior {
            let own = ELEMENTS.map(|place| at.inertia[place] * self.unit);
            for row in white {
                let target = (0..6).map(|k| row[k] * (mean[k] - own[k])).sum();
                let slopes: Vec<f64> = directions
                    .iter()
                    .map(|one| (0..6).map(|k| row[k] * one[ELEMENTS[k]]).sum::<f64>() * self.unit)
                    .collect();
                push(3, &slopes, target);
            }
        }
        cost
    }

    /// Goes down to the nearest maximum of the likelihood of the first rows.
    fn refine(&self, start: &Point, rows: usize, stop: &Stop) -> Option<(Point, Linear, bool)> {
        let directions = self.directions();
        let evaluate = |at: &Point, limit: f64| {
            if self.has_scale {
                self.evaluate::<9>(at, rows, limit, &directions, None)
            } else {
                self.evaluate::<8>(at, rows, limit, &directions, None)
            }
        };
        descend(*start, stop, evaluate, |at, step| {
            let next = self.step_from(at, step, &directions);
            is_tensor(&next.inertia).then_some(next)
        })
    }

    /// Rows at which pieces begin, the first left out.
    fn cuts(&self, rows: usize) -> Vec<usize> {
        let mut found = Vec::new();
        let (mut from, mut row) = (0.0, 0);
        for (i, &t) in self.t[..rows].iter().enumerate() {
            if t - from >= PIECE && i - row >= 4 {
                found.push(i);
                (from, row) = (t, i);
            }
        }
        found
    }

    /// The angular velocity about a row, from the rows beside it.
    fn smoothed(&self, row: usize, rows: usize) -> Vector3<f64> {
        let near = |i: &usize| (self.t[*i] - self.t[row]).abs() < NEAR;
        let from = (0..row).rev().take_while(near).last().unwrap_or(row);
        let to = (row..rows).take_while(near).last().unwrap_or(row);
        // As many on either side, so that slopes do not matter; at an end of the log they do.
        let side = (row - from).min(to - row);
        let mut own: Vec<Vector3<f64>> = (self.omega[row - side..=row + side].iter())
            .map(|y| Vector3::from(*y))
            .collect();
        let middle = own.len() / 2;
        Vector3::from_fn(|i, _| {
            if self.tumble.student {
                own.sort_unstable_by(|a, b| a[i].total_cmp(&b[i]));
                own[middle][i]
            } else {
                own.iter().map(|y| y[i]).sum::<f64>() / own.len() as f64
            }
        })
    }

    /// The chain of a start: its nodes are those of the log.
    fn chain(&self, start: &Balanced, rows: usize) -> Chain {
        let omega = |row| self.smoothed(row, rows) - start.bias;
        Chain {
            point: Point::new(omega(0), start.inertia, start.bias),
            nodes: self.cuts(rows).into_iter().map(omega).collect(),
        }
    }

    /// What a chain costs, and the triangle of the steps that close its gaps.
    ///
    /// The last column carries the gaps on: how far the motion would be from the nodes if they were closed.
    fn link(&self, at: &Chain, rows: usize, directions: &[Matrix3<f64>]) -> Option<Linked> {
        if self.look().is_break() {
            return None;
        }
        let inner = 3 + directions.len();
        let unknowns = inner + if self.has_bias() { 3 } else { 0 };
        let mut triangle = Triangle::new(unknowns);
        let mut cost = self.prior_rows(&at.point, directions, &mut triangle);
        let weights = Vector3::from(self.sigma.get().map(f64::recip));
        let mut follower = Follower::<10>::of(&self.spinning(&at.point), directions)?;
        let axes = follower.axes;
        let mut place = Place::start(at.point.omega);
        let mut follows = Vec::with_capacity(at.nodes.len());
        let (mut first, mut gaps) = (0, 0.0);
        let cuts = self.cuts(rows);
        for piece in 0..=cuts.len() {
            let next = cuts.get(piece).copied();
            let last = next.unwrap_or(rows);
            let end = self.t[next.unwrap_or(rows - 1)];
            let reached = follower.run(
                &place,
                (self.t[first], end),
                &self.t[first..last],
                |sample| {
                    let row = first + sample.row;
                    if row % LOOK == LOOK - 1 {
                        self.look()?;
                    }
                    let [x, y, z] = sample.columns;
                    let predicted = axes * Vector3::from(*sample.omega) + at.point.bias;
                    let off = axes * Vector3::new(x[9], y[9], z[9]);
                    let rest = (Vector3::from(self.omega[row]) - predicted).component_mul(&weights);
                    let square = rest.norm_squared();
                    let mut root = 1.0;
                    if self.tumble.student {
                        cost += (NU + 3.0) * (square / NU).ln_1p();
                        root = ((NU + 3.0) / (NU + square)).sqrt();
                    } else {
                        cost += square;
                    }
                    for i in 0..3 {
                        let share = weights[i] * root;
                        let a = [0, 1, 2].map(|k| axes[(i, k)] * share);
                        let motion = (0..inner).map(|c| a[0] * x[c] + a[1] * y[c] + a[2] * z[c]);
                        let offset =
                            (inner..unknowns).map(|c| if c == inner + i { share } else { 0.0 });
                        triangle.push(motion.chain(offset), rest[i] * root - off[i] * share);
                    }
                    ControlFlow::Continue(())
                },
            )?;
            if let Some(next) = next {
                let gap = reached.omega - at.nodes[piece];
                gaps += gap.component_mul(&weights).norm_squared();
                place = Place {
                    omega: at.nodes[piece],
                    ..reached
                };
                for i in 0..3 {
                    place.columns[i][9] += gap[i];
                }
                follows.push(place);
                first = next;
            }
        }
        triangle.fold();
        (cost + gaps).is_finite().then_some(Linked {
            triangle,
            cost,
            gaps,
            follows,
        })
    }

    /// Fit the first rows by pieces whose gaps close as the fit goes on (H. G. Bock, Springer Series in Chemical Physics 18,
    /// 1981, 102). Neither a separatrix nor the length of the log makes its way crooked, as that of ω₀ alone would be.
    fn join(&self, start: &Balanced, rows: usize, passes: usize) -> Option<(Point, Linked)> {
        let directions = self.directions();
        let mut here = self.chain(start, rows);
        let mut linked = self.link(&here, rows, &directions)?;
        for _ in 0..passes {
            // What nothing tells stays within half of its size.
            let sizes = vec![2.0; linked.triangle.unknowns()];
            let (step, gain) = linked.triangle.step(1.0, &sizes)?;
            if linked.gaps < 1e-9 && gain < 1e-2 {
                break;
            }
            let mut share = 1.0;
            let mut taken = false;
            while share > 0.05 && !taken {
                let scaled: Vec<f64> = step.iter().map(|x| x * share).collect();
                let mut next = Chain {
                    point: self.step_from(&here.point, &scaled, &directions),
                    nodes: here.nodes.clone(),
                };
                for (node, place) in next.nodes.iter_mut().zip(&linked.follows) {
                    for i in 0..3 {
                        let own = &place.columns[i];
                        node[i] += share * own[9];
                        node[i] += (0..3 + directions.len())
                            .map(|c| own[c] * scaled[c])
                            .sum::<f64>();
                    }
                }
                if is_tensor(&next.point.inertia)
                    && let Some(found) = self.link(&next, rows, &directions)
                {
                    let merit = |one: &Linked| one.cost + 10.0 * one.gaps;
                    taken = merit(&found) <= merit(&linked)
                        || found.gaps < 0.3 * linked.gaps
                            && found.cost < linked.cost * 1.1 + 30.0 + linked.gaps;
                    if taken {
                        (here, linked) = (next, found);
                    }
                }
                if self.stopped.get() {
                    return None;
                }
                share *= 0.4;
            }
            if !taken {
                break;
            }
        }
        Some((here.point, linked))
    }

    /// Go down among the tensors of flat bodies: those where the triangle inequality of the moments is an equality.
    fn refine_on_edge(&self, start: &Point, stop: &Stop) -> Option<(Point, Linear, bool)> {
        let directions = |at: &Point| {
            let axis = eigen3(&at.inertia).vectors.column(2).into_owned();
            let normal = Matrix3::identity() * 0.5 - axis * axis.transpose();
            if self.has_scale {
                directions_across(&[normal])
            } else {
                directions_across(&[Matrix3::identity(), normal])
            }
        };
        let evaluate = |at: &Point, limit: f64| {
            self.evaluate::<8>(at, self.rows(), limit, &directions(at), None)
        };
        descend(self.flatten(start), stop, evaluate, |at, step| {
            let next = self.flatten(&self.step_from(at, step, &directions(at)));
            is_tensor(&next.inertia).then_some(next)
        })
    }

    /// Return the point with the nearest tensor of a flat body.
    fn flatten(&self, at: &Point) -> Point {
        let eigen = eigen3(&at.inertia);
        let [a, b, c] = eigen.values;
        // Second moments in the plane; a motion needs some moment about a rod.
        let long = 0.5 * (c + b - a);
        let short = (0.5 * (c + a - b)).max(1e-4 * long);
        let moments = Vector3::new(short, long, short + long);
        let mut inertia =
            eigen.vectors * Matrix3::from_diagonal(&moments) * eigen.vectors.transpose();
        if !self.has_scale {
            inertia /= inertia.trace();
        }
        Point { inertia, ..*at }
    }

    /// By how much the largest moment exceeds the sum of the others, relative to it.
    fn excess(at: &Point) -> f64 {
        let [a, b, c] = eigen3(&at.inertia).values;
        (c - a - b) / c
    }

    /// Measured minus predicted, in units of sigma.
    fn residuals(&self, at: &Point) -> Vec<[f64; 3]> {
        let weights = Vector3::from(self.sigma.get().map(f64::recip));
        let mut found = Vec::with_capacity(self.rows());
        let Some(mut follower) = Follower::<0>::of(&self.spinning(at), &[]) else {
            return found;
        };
        let axes = follower.axes;
        follower.run(
            &Place::start(at.omega),
            (0.0, self.t[self.rows() - 1]),
            &self.t,
            |sample: &Sample<'_, 0>| {
                let own = axes * Vector3::from(*sample.omega);
                let predicted = own + at.scale.component_mul(&own) + at.bias;
                let rest = Vector3::from(self.omega[sample.row]) - predicted;
                found.push(rest.component_mul(&weights).into());
                ControlFlow::Continue(())
            },
        );
        found
    }

    /// Set the sigma, where it is not known, to that of the residuals at a point; return by how much it changed.
    fn set_sigma(&self, at: &Point) -> f64 {
        if self.tumble.sigma.is_some() {
            return 0.0;
        }
        let rest = self.residuals(at);
        let squares: Vec<f64> = rest
            .iter()
            .map(|r| Vector3::from(*r).norm_squared())
            .collect();
        let count = 3.0 * squares.len() as f64;
        let old = self.sigma.get()[0];
        let mut square: f64;
        if self.tumble.student {
            square = 1.0;
            for _ in 0..200 {
                let sum: f64 = (squares.iter())
                    .map(|r| (NU + 3.0) / (NU + r / square) * r)
                    .sum();
                let new = sum / count;
                let settled = (new / square - 1.0).abs() < 1e-12;
                square = new;
                if settled || !(square > 0.0) {
                    break;
                }
            }
        } else {
            let unknowns = self.layout(self.directions().len()).unknowns;
            square = squares.iter().sum::<f64>() / (count - unknowns as f64).max(1.0);
        }
        let new = (old * square.sqrt()).max(1e-15);
        self.sigma.set([new; 3]);
        (new / old - 1.0).abs()
    }

    /// The tensors and offsets that a fit begins with: those that balance the momentum, and what is known beforehand.
    fn starts(&self) -> Vec<Balanced> {
        let directions = self.directions();
        let prior = self.tumble.prior.map(|(mean, _)| tensor(&mean) / self.unit);
        let bias = match self.tumble.bias {
            Bias::Prior(mean, _) => Vector3::from(mean) / self.rate,
            Bias::Zero | Bias::Free => Vector3::zeros(),
        };
        let scales: &[f64] = if self.has_scale {
            &[1.0, 0.1, 10.0, 100.0]
        } else {
            &[1.0]
        };
        let firsts: Vec<Balanced> = match prior {
            Some(inertia) => vec![Balanced { inertia, bias }],
            None => scales
                .iter()
                .map(|scale| Balanced {
                    inertia: Matrix3::identity() * (scale / 3.0),
                    bias,
                })
                .collect(),
        };
        let question = Question {
            t: &self.t,
            omega: &self.omega,
            sigma: self.level.max(1e-9),
            directions: &directions,
            has_bias: self.has_bias(),
            momentum: self.momentum,
            torque: self.torque,
            rate: 1.0,
        };
        let mut starts = estimates(&question, &firsts);
        starts.extend(&firsts);
        starts
    }

    /// Find the maximum to which the first start leads whose cost is that of noise, or the best one of all starts, and how many were used.
    fn first_maximum(
        &self,
        starts: &[Balanced],
        some: &Self,
        usual: f64,
        stop: &Stop,
    ) -> Option<((Point, Linear, bool), usize)> {
        let (n, count) = (self.rows(), some.rows());
        let mut best: Option<(Point, Linear, bool)> = None;
        let mut used = 0;
        for start in starts.iter().take(self.tumble.starts + 1) {
            used += 1;
            // Of a log that is not long, some rows mostly lead near enough to the maximum.
            let mut found = None;
            if count < n && n <= HEAD {
                found = some
                    .join(start, count, JOINS)
                    .and_then(|(point, _)| self.refine(&point, n, stop))
                    .filter(|(_, linear, converged)| *converged && linear.cost < 2.0 * usual);
            }
            if found.is_none() && !some.stopped.get() {
                let joined = self.join(start, n, JOINS);
                found = joined.and_then(|(point, _)| self.refine(&point, n, stop));
            }
            if some.stopped.get() {
                self.stopped.set(true);
            }
            if self.stopped.get() {
                return None;
            }
            if let Some(found) = found
                && best
                    .as_ref()
                    .is_none_or(|(_, best, _)| found.1.cost < best.cost)
            {
                best = Some(found);
            }
            if best
                .as_ref()
                .is_some_and(|(_, best, _)| best.cost < 2.0 * usual)
            {
                break;
            }
        }
        best.map(|best| (best, used))
    }

    /// Find the maxima of the likelihood, the best first.
    fn maxima(&self) -> Vec<Fit> {
        let starts = self.starts();
        // What noise alone costs: a fit with much more is not the best one.
        let sigma = self.sigma.get()[0];
        let usual = 3.0 * self.rows() as f64 * (self.level / sigma).powi(2).max(1.0);
        let stop = Stop {
            gain: 1e-9,
            passes: 60,
        };
        let n = self.rows();
        let some = self.thin_out();
        let count = some.rows();
        let Some((best, used)) = self.first_maximum(&starts, &some, usual, &stop) else {
            return Vec::new();
        };
        let (mut point, mut linear, mut converged) = best;
        for _ in 0..50 {
            if self.set_sigma(&point) < 1e-9 {
                break;
            }
            let Some(found) = self.refine(&point, n, &stop) else {
                break;
            };
            (point, linear, converged) = found;
        }
        let mut all = vec![(point, linear.cost, converged)];
        some.sigma.set(self.sigma.get());
        let Some((here, headed, _)) = some.refine(&point, count, &stop) else {
            return Vec::new();
        };
        for start in self
            .others(&point, &starts[used..])
            .into_iter()
            .take(self.tumble.starts)
        {
            self.done.set(0.5 + 0.5 * self.done.get());
            let found = some.join(&start, count, TRIES);
            if some.stopped.get() {
                self.stopped.set(true);
                return Vec::new();
            }
            let Some((other, linked)) = found else {
                continue;
            };
            // The same maximum once more, or none that could be the best.
            if linked.triangle.square(&self.between(&other, &here)) < 0.1
                || linked.cost > headed.cost + 2.0 * WITHIN + 30.0
            {
                continue;
            }
            let again = Balanced {
                inertia: other.inertia,
                bias: other.bias,
            };
            let other = self.join(&again, n, JOINS).map(|(other, _)| other);
            let Some((other, own, converged)) =
                other.and_then(|other| self.refine(&other, n, &stop))
            else {
                continue;
            };
            if converged
                && all
                    .iter()
                    .all(|(one, ..)| own.triangle.square(&self.between(&other, one)) > 0.1)
            {
                all.push((other, own.cost, converged));
            }
        }
        if self.has_more() {
            self.all.set(true);
            all = self.take_all_in(&all, &stop);
        }
        if all.is_empty() {
            return Vec::new();
        }
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        let least = all[0].1;
        all.retain(|(_, cost, _)| cost - least < 2.0 * WITHIN);
        all.iter()
            .filter_map(|(point, _, converged)| self.fit_of_body(point, *converged))
            .collect()
    }

    /// The maxima of the likelihood of all sensors that are near those of the gyro alone.
    fn take_all_in(&self, found: &[(Point, f64, bool)], stop: &Stop) -> Vec<(Point, f64, bool)> {
        let n = self.rows();
        let short = Stop {
            passes: 10,
            ..*stop
        };
        let mut all: Vec<(Point, f64, bool)> = Vec::new();
        let mut triangles: Vec<Triangle> = Vec::new();
        for (at, ..) in found {
            let mut point = Point {
                attitude: self.first_attitude(at),
                ..*at
            };
            // A small error of the rate makes a large one of an attitude that is far.
            let mut end = PIECE;
            loop {
                let rows = self.t.partition_point(|t| *t <= end);
                if rows >= n {
                    break;
                }
                if let Some((next, ..)) = self.refine(&point, rows.max(4), &short) {
                    point = next;
                }
                end *= 2.0;
            }
            let mut next = self.refine(&point, n, stop);
            // The sigma is that of the best maximum.
            for _ in 0..if all.is_empty() { 50 } else { 0 } {
                let Some((point, ..)) = &next else {
                    break;
                };
                if self.set_sigma(point) < 1e-9 {
                    break;
                }
                next = self.refine(&point.clone(), n, stop);
            }
            if self.stopped.get() {
                return Vec::new();
            }
            let Some((point, linear, converged)) = next else {
                continue;
            };
            let is_new = (all.iter().zip(&triangles))
                .all(|((one, ..), triangle)| triangle.square(&self.between(one, &point)) > 0.1);
            if is_new {
                all.push((point, linear.cost, converged));
                triangles.push(linear.triangle);
            }
        }
        all
    }

    /// The attitude at the first time that a motion has beside the first one that was measured.
    fn first_attitude(&self, at: &Point) -> UnitQuaternion<f64> {
        let mut found = UnitQuaternion::identity();
        let Some(attitude) = self.tumble.attitude else {
            return found;
        };
        let first = attitude
            .rows
            .iter()
            .position(|row| quaternion(row).is_some());
        let Some((first, follower)) = first.zip(Follower::<0>::of(&self.spinning(at), &[])) else {
            return found;
        };
        let mut follower = follower.with_attitude();
        let axes = UnitQuaternion::from_matrix(&follower.axes);
        let start = Place::start(at.omega);
        follower.run(
            &start,
            (0.0, self.t[first]),
            &self.t[first..=first],
            |sample| {
                if let Some((measured, turn)) = quaternion(&attitude.rows[first]).zip(sample.turn) {
                    found =
                        measured * (axes * relative(&turn.quaternion) * axes.inverse()).inverse();
                }
                ControlFlow::Continue(())
            },
        );
        found
    }

    /// Starts with other tensors than a fit has: the estimates that are left, and pairs of moments exchanged, where the motion is on the
    /// other side of the separatrix, or of a symmetry.
    fn others(&self, best: &Point, left: &[Balanced]) -> Vec<Balanced> {
        let eigen = eigen3(&best.inertia);
        let [a, b, c] = eigen.values;
        let axes = eigen.vectors;
        let momentum = axes.transpose() * (best.inertia * best.omega);
        let energy = best.omega.dot(&(best.inertia * best.omega));
        // The moment of the middle axis of a motion on the separatrix.
        let middle = momentum.norm_squared() / energy;
        let mut moments = vec![[b, a, c], [a, c, b], [c, b, a]];
        let mirrored = 2.0 * middle - b;
        if mirrored > a && mirrored < c {
            moments.insert(0, [a, mirrored, c]);
        }
        let mut found: Vec<Balanced> = moments
            .into_iter()
            .map(|moments| {
                let mut moments = Vector3::from(moments);
                if !self.has_scale {
                    moments /= moments.sum();
                }
                Balanced {
                    inertia: axes * Matrix3::from_diagonal(&moments) * axes.transpose(),
                    bias: best.bias,
                }
            })
            .collect();
        found.extend_from_slice(left);
        found
    }

    /// The fit at a maximum, or the best one on the edge where it is that of no body.
    fn fit_of_body(&self, at: &Point, converged: bool) -> Option<Fit> {
        if Self::excess(at) <= 1e-14 {
            return self.fit_at(at, false, converged);
        }
        let stop = Stop {
            gain: 1e-9,
            passes: 60,
        };
        let (mut point, _, mut converged) = self.refine_on_edge(at, &stop)?;
        for _ in 0..50 {
            if self.set_sigma(&point) < 1e-9 {
                break;
            }
            (point, _, converged) = self.refine_on_edge(&point, &stop)?;
        }
        self.fit_at(&point, true, converged)
    }

    /// Compute the fit at a point, in the units of the log.
    fn fit_at(&self, at: &Point, at_edge: bool, converged: bool) -> Option<Fit> {
        let mut residuals = Vec::with_capacity(self.rows());
        let elements = element_directions();
        let linear = self.evaluate::<9>(
            at,
            self.rows(),
            f64::INFINITY,
            &elements,
            Some(&mut residuals),
        )?;
        let (unknowns, layout) = (linear.triangle.unknowns(), self.layout(elements.len()));
        let by = |column: usize| {
            // Of turns, scales and places, 1.
            let of_rate = column < 3 || layout.bias.is_some_and(|b| (b..b + 3).contains(&column));
            if (3..9).contains(&column) {
                self.unit
            } else if of_rate {
                self.rate
            } else {
                1.0
            }
        };
        let triangle = (0..unknowns)
            .map(|row| {
                (0..unknowns)
                    .map(|column| linear.triangle.at(row, column) / by(column))
                    .collect()
            })
            .collect();
        let mut beside = Triangle::new(unknowns);
        let chi2 = self.prior_rows(at, &elements, &mut beside)
            + residuals
                .iter()
                .map(|r| Vector3::from(*r).norm_squared())
                .filter(|square| !square.is_nan())
                .sum::<f64>();
        Some(Fit {
            omega: (at.omega * self.rate).into(),
            inertia: ELEMENTS.map(|place| at.inertia[place] * self.unit),
            bias: (at.bias * self.rate).into(),
            gyro_scale: at.scale.into(),
            attitude: at.attitude.into_inner().coords.into(),
            place: at.place.into(),
            sigma: self.sigma.get().map(|x| x * self.rate),
            cost: linear.cost,
            chi2,
            residuals,
            triangle,
            at_edge,
            converged,
        })
    }

    /// The step that leads from one point to another.
    fn between(&self, from: &Point, to: &Point) -> Vec<f64> {
        let directions = self.directions();
        let (change, layout) = (to.inertia - from.inertia, self.layout(directions.len()));
        let mut step: Vec<f64> = (to.omega - from.omega).iter().copied().collect();
        step.extend(directions.iter().map(|one| one.dot(&change)));
        let turn = (from.attitude.inverse() * to.attitude).scaled_axis();
        for (first, change) in [
            (layout.bias, to.bias - from.bias),
            (layout.scale, to.scale - from.scale),
            (layout.attitude, turn),
            (layout.place, to.place - from.place),
        ] {
            if first.is_some() {
                step.extend(change.iter());
            }
        }
        step
    }
}

/// The attitude of a row that has one.
fn quaternion(row: &[f64; 4]) -> Option<UnitQuaternion<f64>> {
    let [x, y, z, w] = *row;
    let found = Quaternion::new(w, x, y, z);
    (found.norm().is_finite() && found.norm() > 0.0).then(|| UnitQuaternion::from_quaternion(found))
}

fn relative(turn: &[f64; 4]) -> UnitQuaternion<f64> {
    let [x, y, z, w] = *turn;
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// The rows of the sensors beside the gyro, at a place.
struct Others<'a, const C: usize> {
    log: &'a Scaled<'a>,
    at: &'a Point,
    layout: Layout,
    axes: Matrix3<f64>,
    /// The same rotation.
    turned: UnitQuaternion<f64>,
    /// I⁻¹.
    inverse: Matrix3<f64>,
    spinning: Spinning,
    directions: &'a [Matrix3<f64>],
}

impl<const C: usize> Others<'_, C> {
    /// Add the rows at a time, and return what they cost.
    fn take(
        &self,
        sample: &Sample<'_, C>,
        triangle: &mut Triangle,
        mut rests: Option<&mut Vec<[f64; 3]>>,
    ) -> f64 {
        let mut cost = 0.0;
        let tumble = self.log.tumble;
        if let Some(sensor) = tumble.attitude {
            let found = self.of_attitude(sample, &sensor.rows[sample.row]);
            cost += self.add(found, &sensor.sigma, triangle, rests.as_deref_mut());
        }
        if let Some(sensor) = tumble.specific_force {
            let found = self.of_force(sample, &sensor.rows[sample.row]);
            let square = self.log.rate.powi(2);
            let sigma = sensor.sigma.map(|x| x / square);
            cost += self.add(found, &sigma, triangle, rests);
        }
        cost
    }

    /// Measured minus predicted, and its derivatives, from a row of attitudes.
    fn of_attitude(&self, sample: &Sample<'_, C>, row: &[f64; 4]) -> Option<Rests> {
        let (measured, turn) = (quaternion(row)?, sample.turn?);
        let turned = self.turned * relative(&turn.quaternion) * self.turned.inverse();
        let rest = ((self.at.attitude * turned).inverse() * measured).scaled_axis();
        let inner = 3 + self.directions.len();
        let mut columns = vec![Vector3::zeros(); self.layout.unknowns];
        for (c, column) in columns[..inner].iter_mut().enumerate() {
            *column = self.axes * Vector3::from_fn(|i, _| turn.columns[i][c]);
        }
        let by_first = turned.inverse().to_rotation_matrix();
        for i in 0..3 {
            columns[self.layout.attitude? + i] = by_first.matrix().column(i).into_owned();
        }
        Some(Rests { rest, columns })
    }

    /// The same of the specific force: f = ω̇ × r + ω × (ω × r).
    fn of_force(&self, sample: &Sample<'_, C>, row: &[f64; 3]) -> Option<Rests> {
        if !row.iter().all(|x| x.is_finite()) {
            return None;
        }
        let measured = Vector3::from(*row) / self.log.rate.powi(2);
        let (body, r) = (&self.spinning, self.at.place);
        let omega = self.axes * Vector3::from(*sample.omega);
        let inverse = &self.inverse;
        let momentum = body.inertia * omega + body.momentum;
        let alpha = inverse * (body.torque - omega.cross(&momentum));
        let rest = measured - alpha.cross(&r) - omega.cross(&omega.cross(&r));
        let mut columns = vec![Vector3::zeros(); self.layout.unknowns];
        for c in 0..3 + self.directions.len() {
            let change = self.axes * Vector3::from_fn(|i, _| sample.columns[i][c]);
            let mut torque = -change.cross(&momentum) - omega.cross(&(body.inertia * change));
            if c >= 3 {
                let by = self.directions[c - 3];
                torque -= by * alpha + omega.cross(&(by * omega));
            }
            columns[c] = (inverse * torque).cross(&r)
                + change.cross(&omega.cross(&r))
                + omega.cross(&change.cross(&r));
        }
        for i in 0..3 {
            let axis = Vector3::ith(i, 1.0);
            columns[self.layout.place? + i] = alpha.cross(&axis) + omega.cross(&omega.cross(&axis));
        }
        Some(Rests { rest, columns })
    }

    fn add(
        &self,
        found: Option<Rests>,
        sigma: &[f64; 3],
        triangle: &mut Triangle,
        rests: Option<&mut Vec<[f64; 3]>>,
    ) -> f64 {
        let weights = Vector3::from(sigma.map(f64::recip));
        let expected = rests.is_some();
        let own = found.as_ref().map(|one| one.rest.component_mul(&weights));
        if let Some(rests) = rests {
            rests.push(own.map_or([f64::NAN; 3], Into::into));
        }
        let Some((Rests { columns, .. }, rest)) = found.zip(own) else {
            return 0.0;
        };
        let (cost, root) = self.log.loss(rest.norm_squared(), expected);
        for i in 0..3 {
            let row = columns.iter().map(|column| column[i] * weights[i] * root);
            triangle.push(row, rest[i] * root);
        }
        cost
    }
}

/// Measured minus predicted, and the derivatives of what is predicted.
struct Rests {
    rest: Vector3<f64>,
    columns: Vec<Vector3<f64>>,
}
