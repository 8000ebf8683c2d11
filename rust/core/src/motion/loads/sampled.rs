//! A torque known at some times, and a cubic spline in between.

use nalgebra::Vector3;
use std::sync::Arc;

use super::axes::{Axes, Exact, exact};
use super::forcing::{Forcing, Timed, When};
use super::law::{Character, Kept, Law, Parts};
use super::linear::Linear;
use super::parameter::Parameter;
use super::subject::Subject;
use super::variables::Variables;
use super::wrench::{Wrench, in_body};
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::motion::kinematics::Frame;
use crate::motion::state::Phase;
use crate::numerics::number::Real;

/// A torque about the reference point, given at times and interpolated by a cubic spline, smooth to the second derivative.
///
/// The first two pieces are one cubic, and the last two ("not a knot"); three samples make a parabola, two a straight line.
/// Beyond the first and last time it is not known. Source: de Boor, A Practical Guide to Splines, chapter IV.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    spline: Arc<Spline>,
    frame: Frame,
}

#[derive(Debug, PartialEq)]
struct Spline {
    knots: Vec<f64>,
    pieces: Vec<[Vector3<f64>; 4]>,
}

impl Sampled {
    /// The spline through `values` at the ascending `times`; its components refer to `frame`.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, numbers that are not finite.
    ///
    /// # Panics
    /// When `times` and `values` differ in length.
    pub fn new(times: &[f64], values: &[Vector3<f64>], frame: Frame) -> Result<Self, Error> {
        assert_eq!(times.len(), values.len(), "one torque for each time");
        if times.len() < 2 {
            return Err(Error::OutOfDomain {
                what: "the number of samples",
                law: "at least 2",
                value: times.len() as f64,
            });
        }
        all_finite("t", times)?;
        all_finite("torque", values.iter().flatten())?;
        finite("the span of t", times[times.len() - 1] - times[0])?;
        for (k, pair) in times.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                return Err(Error::Motion(MotionFault::NotMonotone {
                    what: "t",
                    order: "ascending",
                    index: k + 1,
                    previous: pair[0],
                    next: pair[1],
                }));
            }
        }
        let pieces = pieces(times, values);
        all_finite(
            "the spline through torque",
            pieces.iter().flatten().flatten(),
        )?;
        let knots = times.to_vec();
        Ok(Self {
            spline: Arc::new(Spline { knots, pieces }),
            frame,
        })
    }

    /// To which frame its components refer.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// The times it was given at.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.spline.knots
    }

    /// The cubic around time `t`, `Σ c_k (t − t₀)^k`: its t₀ and coefficients.
    #[must_use]
    pub fn piece(&self, t: f64) -> (f64, &[Vector3<f64>; 4]) {
        let index = self.index(t);
        (self.knots()[index], &self.spline.pieces[index])
    }

    /// The number of the piece around time `t`.
    fn index(&self, t: f64) -> usize {
        let knots = self.knots();
        knots[1..knots.len() - 1].partition_point(|&knot| knot <= t)
    }

    /// The torque at time `t`, components in its frame.
    #[must_use]
    pub fn at(&self, t: f64) -> Vector3<f64> {
        let (from, [c0, c1, c2, c3]) = self.piece(t);
        let x = t - from;
        c0 + (c1 + (c2 + c3 * x) * x) * x
    }

    /// Checks that `t` is within its times.
    ///
    /// # Errors
    /// [`MotionFault::OutsideSamples`].
    pub fn check_at(&self, t: f64) -> Result<(), Error> {
        let (first, last) = (self.knots()[0], self.knots()[self.knots().len() - 1]);
        if (first..=last).contains(&t) {
            Ok(())
        } else {
            Err(Error::Motion(MotionFault::OutsideSamples {
                t,
                first,
                last,
            }))
        }
    }
}

impl Sampled {
    /// As [`Self::piece`], with the derivatives by the samples: those of the spline through them, which is linear in them. Samples
    /// farther than [`NEAR`] do not count.
    fn varied_piece<X: Exact>(&self, axes: &Axes<'_, X>, t: f64) -> (f64, [Vector3<X>; 4]) {
        let (from, piece) = self.piece(t);
        let (knots, mut piece) = (self.knots(), piece.each_ref().map(exact::<X>));
        let index = self.index(t);
        let near = index.saturating_sub(NEAR)..(index + 2 + NEAR).min(knots.len());
        if (axes.variables).varies(axes.first + 3 * near.start..axes.first + 3 * near.end) {
            let zero = Vector3::zeros();
            let samples: Vec<_> = near.clone().map(|k| axes.vector(&zero, 3 * k)).collect();
            let own = pieces(&knots[near.clone()], &samples)[index - near.start];
            for (c, more) in piece.iter_mut().zip(own) {
                *c += more;
            }
        }
        (from, piece)
    }
}

impl Law for Sampled {
    fn character(&self, _: bool) -> Character {
        Character {
            exerts_force: false,
            depends_on_rates: false,
            needs_body: false,
            needs_epoch: false,
            keeps: Kept::Nothing,
            parts: Parts {
                directions: match self.frame {
                    Frame::Body => 0,
                    Frame::Space => 3,
                },
                is_timed: true,
                ..Parts::default()
            },
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("torque", &[self.knots().len(), 3])]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        let Spline { knots, pieces } = &*self.spline;
        let pieces: Vec<_> = (pieces.iter().map(|piece| piece.map(|c| c * factor))).collect();
        all_finite(
            "the load times its factor",
            pieces.iter().flatten().flatten(),
        )?;
        let knots = knots.clone();
        Ok(Self {
            spline: Arc::new(Spline { knots, pieces }),
            frame: self.frame,
        })
    }

    fn anchored(self, _: f64) -> Self {
        self
    }

    fn breaks(&self) -> Vec<f64> {
        self.knots().to_vec()
    }

    fn check(&self, _: &Subject, from: f64, to: f64) -> Result<(), Error> {
        self.check_at(from).and_then(|()| self.check_at(to))
    }

    fn wrench(&self, _: &Subject, t: f64, phase: &Phase) -> Wrench {
        Wrench::couple(in_body(&self.at(t), self.frame, &phase.attitude))
    }

    fn potential(&self, _: &Subject, _: &Phase) -> Option<f64> {
        None
    }

    fn add_to<'a, X: Exact>(&'a self, linear: &mut Linear<'a, X>, axes: &Axes<'_, X>, _: f64) {
        linear.timed.push((axes.first, self));
    }
}

impl<X: Exact> Timed<X> for Sampled {
    fn force(&self, forcing: &mut Forcing<X>, axes: &Axes<'_, X>, when: &When<X>) {
        let (from, [c0, c1, c2, c3]) = self.varied_piece(axes, when.middle);
        let x = when.elapsed + X::pair(when.start, -from);
        let (two, three) = (X::from(2.0), X::from(3.0));
        let centered = [
            c0 + (c1 + (c2 + c3 * x) * x) * x,
            c1 + (c2 * two + c3 * (three * x)) * x,
            c2 + c3 * (three * x),
            c3,
        ];
        let mut scale = 1.0 / when.unit / when.unit;
        for (k, torque) in centered.iter().enumerate() {
            let torque = torque * X::from(scale);
            match self.frame {
                Frame::Body => forcing.in_body[k] += axes.principal(&torque),
                Frame::Space => forcing.in_space[k] += torque,
            }
            scale /= when.unit;
        }
    }

    fn square_of_rate(&self, _: &Subject, end: f64, over_moment: f64) -> f64 {
        self.at(end).amax() * over_moment
    }

    fn torques_along(&self, axis: &Vector3<f64>, middle: f64) -> Vec<(f64, f64)> {
        let (_, piece) = self.piece(middle);
        let along = |torque: &Vector3<f64>| match self.frame {
            Frame::Body => axis.dot(torque).abs(),
            Frame::Space => torque.norm(),
        };
        let both = |torque| (along(torque), torque.norm());
        piece.iter().map(both).collect()
    }
}

/// How many samples on either side a piece depends on: from one to the next what a sample does to the slopes halves at least,
/// whatever the knots, so that what is left out is below 1e-24 of it.
const NEAR: usize = 80;

/// The cubics between the samples, from the slopes at them.
fn pieces<X: Real>(t: &[f64], y: &[Vector3<X>]) -> Vec<[Vector3<X>; 4]> {
    let steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let chords: Vec<_> = (y.windows(2).zip(&steps))
        .map(|(pair, step)| (pair[1] - pair[0]) / X::from(*step))
        .collect();
    let slopes = match chords[..] {
        [chord] => vec![chord; 2],
        [first, second] => {
            let bend = (second - first) / X::from(steps[0] + steps[1]);
            let middle = first + bend * X::from(steps[0]);
            let last = second + bend * X::from(steps[1]);
            vec![first - bend * X::from(steps[0]), middle, last]
        }
        _ => slopes(&steps, &chords),
    };
    let cubic = |k: usize| {
        let (h, chord, s0, s1) = (X::from(steps[k]), chords[k], slopes[k], slopes[k + 1]);
        let bend = (s0 + s1 - chord * X::from(2.0)) / h;
        [y[k], s0, (chord - s0) / h - bend, bend / h]
    };
    (0..steps.len()).map(cubic).collect()
}

/// The slopes that make the second derivative continuous, and the third at the second and the last but one sample:
/// a tridiagonal system, whose pivots are positive.
fn slopes<X: Real>(h: &[f64], chords: &[Vector3<X>]) -> Vec<Vector3<X>> {
    let n = h.len();
    let (first, last) = (h[0] + h[1], h[n - 2] + h[n - 1]);
    let sum = |a: usize, by_a: f64, b: usize, by_b: f64| {
        chords[a] * X::from(by_a) + chords[b] * X::from(by_b)
    };
    // Rows as (below, diagonal, above, right-hand side).
    let mut rows = vec![(
        0.0,
        h[1],
        first,
        sum(0, (h[0] + 2.0 * first) * h[1], 1, h[0] * h[0]) / X::from(first),
    )];
    rows.extend((1..n).map(|k| {
        let side = sum(k - 1, h[k], k, h[k - 1]);
        (h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1], side * X::from(3.0))
    }));
    rows.push((
        last,
        h[n - 2],
        0.0,
        sum(
            n - 2,
            h[n - 1] * h[n - 1],
            n - 1,
            (2.0 * last + h[n - 1]) * h[n - 2],
        ) / X::from(last),
    ));
    for k in 1..=n {
        let (_, pivot, above, side) = rows[k - 1];
        let ratio = rows[k].0 / pivot;
        rows[k].1 -= ratio * above;
        rows[k].3 -= side * X::from(ratio);
    }
    let mut next = Vector3::zeros();
    let mut slopes: Vec<_> = (rows.iter().rev())
        .map(|&(_, pivot, above, side)| {
            next = (side - next * X::from(above)) / X::from(pivot);
            next
        })
        .collect();
    slopes.reverse();
    slopes
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::motion::loads::variables::{Block, Varied};

    #[test]
    fn cubics_come_back_as_they_are() {
        let cubic = |t: f64| {
            Vector3::new(
                t * t * t - 2.0 * t,
                3.0 - t * t,
                0.5 * t * t * t + t * t - t,
            )
        };
        let times = [-1.0, 0.0, 0.7, 1.0, 2.5, 4.0];
        let sampled = Sampled::new(&times, &times.map(cubic), Frame::Body).expect("ascending");
        for t in [-1.0, -0.3, 0.5, 0.99, 1.7, 3.9, 4.0] {
            assert!((sampled.at(t) - cubic(t)).norm() < 1e-13, "{t}");
        }
        assert!(sampled.check_at(4.0).is_ok() && sampled.check_at(4.1).is_err());
        let short = |times: &[f64], value: fn(f64) -> f64| {
            let values: Vec<_> = times.iter().map(|&t| Vector3::repeat(value(t))).collect();
            Sampled::new(times, &values, Frame::Body).expect("ascending")
        };
        assert!((short(&[0.0, 1.0, 3.0], |t| t * t).at(2.0).x - 4.0).abs() < 1e-15);
        assert!((short(&[0.0, 2.0], |t| 3.0 * t).at(0.5).x - 1.5).abs() < 1e-15);
        assert!(Sampled::new(&[0.0], &[Vector3::zeros()], Frame::Body).is_err());
        assert!(Sampled::new(&[1.0, 1.0], &[Vector3::zeros(); 2], Frame::Body).is_err());
    }

    #[test]
    fn a_piece_depends_on_the_samples_near_it() {
        // Steps from one hundredth to one.
        let mut t = 0.0;
        let knots: Vec<f64> = (0..400)
            .map(|k: u32| {
                t += f64::from(1 + (k * 7919) % 100) / 100.0;
                t
            })
            .collect();
        let alone = |k: usize| {
            let mut values = vec![Vector3::zeros(); knots.len()];
            values[k] = Vector3::new(1.0, 0.0, 0.0);
            Sampled::new(&knots, &values, Frame::Body).expect("ascending")
        };
        let (columns, q_bp) = (Matrix3::identity(), [0.0, 0.0, 0.0, 1.0].map(Varied::from));
        let subject = Subject {
            mass: 1.0,
            inertia: Matrix3::identity(),
            point: Vector3::zeros(),
            center: Vector3::zeros(),
            pivoted: false,
            start: 0.0,
        };
        for sample in [0, 1, 57, 200, 398, 399] {
            let axes = Axes {
                subject: &subject,
                columns: &columns,
                q_bp: &q_bp,
                variables: Block { first: 3 * sample },
                first: 0,
                middle: 0.0,
            };
            let alone = alone(sample);
            let largest =
                |piece: &[Vector3<f64>; 4]| piece.iter().map(|c| c.x.abs()).fold(0.0, f64::max);
            let most = alone.spline.pieces.iter().map(largest).fold(0.0, f64::max);
            for k in 0..knots.len() - 1 {
                let middle = 0.5 * (knots[k] + knots[k + 1]);
                let (_, found) = alone.varied_piece(&axes, middle);
                let (_, exact) = alone.piece(middle);
                for (found, exact) in found.iter().zip(exact) {
                    let error = (found.x.slopes[0] - exact.x).abs();
                    assert!(error < 1e-14 * largest(alone.piece(middle).1) + 1e-19 * most);
                }
            }
        }
    }
}
