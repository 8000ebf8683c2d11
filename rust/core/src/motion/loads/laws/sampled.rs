//! A torque known at some times, and a cubic spline in between.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::error::Error;
use crate::motion::kinematics::Frame;
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame, exact};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::series_terms::{CubicTorque, StepTime};
use crate::motion::loads::spline::{Spline, pieces, within};
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::variables::Variables;
use crate::motion::loads::wrench::{Wrench, in_body};
use crate::motion::state::Phase;
use crate::numerics::threads::Watch;

/// A torque about the reference point, given at times and interpolated by a cubic spline, smooth to the second derivative.
///
/// The first two pieces are one cubic, and the last two ("not a knot"); three samples make a parabola, two a straight line.
/// Beyond the first and last time it is not known. Source: de Boor, A Practical Guide to Splines, chapter IV.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::loads::{Frame, Sampled};
///
/// let times = [0.0, 1.0, 2.0, 3.0];
/// let values = times.map(|t| Vector3::z() * t);
/// let torque = Sampled::new(&times, &values, Frame::Body)?;
/// assert!((torque.at(1.5).z - 1.5).abs() < 1e-15);
/// assert!(torque.check_at(4.0).is_err());
/// assert_eq!((torque.frame(), torque.knots()), (Frame::Body, &times[..]));
/// // The same where there are very many, and somebody may want to end it.
/// let same = Sampled::new_watched(&times, &values, Frame::Body, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(same, torque);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    spline: Arc<Spline>,
    frame: Frame,
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
        Self::new_watched(times, values, frame, &mut |_| ControlFlow::Continue(()))
    }

    /// As [`Self::new`] of very many samples: now and then `watch` gets a fraction done, and may end it.
    ///
    /// # Errors
    /// As [`Self::new`], and [`Error::Stopped`].
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn new_watched(
        times: &[f64],
        values: &[Vector3<f64>],
        frame: Frame,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let names = ["t", "the span of t", "torque", "the spline through torque"];
        let spline = Spline::through(names, times, values, watch)?;
        Ok(Self {
            spline: Arc::new(spline),
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
        self.spline.knots()
    }

    /// The cubic around time `t`, `Σ c_k (t − t₀)^k`: its t₀ and coefficients.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::nalgebra::Vector3;
    /// use polhode::motion::loads::{Frame, Sampled};
    ///
    /// let times = [0.0, 1.0, 2.0, 3.0];
    /// let cubic = Sampled::new(&times, &times.map(|t: f64| Vector3::z() * t.powi(3)), Frame::Body)?;
    /// let (start, coefficients) = cubic.piece(1.5);
    /// assert_eq!(start, 1.0);
    /// assert!((coefficients[3].z - 1.0).abs() < 1e-14);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[inline]
    #[must_use]
    pub fn piece(&self, t: f64) -> (f64, &[Vector3<f64>; 4]) {
        self.spline.piece(t)
    }

    /// The torque at time `t`, components in its frame.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> Vector3<f64> {
        self.spline.at(t)[0]
    }

    /// Checks that `t` is within its times.
    ///
    /// # Errors
    /// [`OutsideSamples`](crate::error::MotionFault::OutsideSamples).
    pub fn check_at(&self, t: f64) -> Result<(), Error> {
        self.spline.check_at(t)
    }
}

impl Sampled {
    /// As [`Self::piece`], with the derivatives by the samples: those of the spline through them, which is linear in them. Samples
    /// farther than [`NEAR`] do not count.
    fn varied_piece<X: LawNumber>(
        &self,
        axes: &PrincipalFrame<'_, X>,
        t: f64,
    ) -> (f64, [Vector3<X>; 4]) {
        let (from, piece) = self.piece(t);
        let (knots, mut piece) = (self.knots(), piece.each_ref().map(exact::<X>));
        let index = self.spline.index(t);
        let near = index.saturating_sub(NEAR)..(index + 2 + NEAR).min(knots.len());
        let first = axes.parameters.of("torque").start;
        if (axes.variables).varies(first + 3 * near.start..first + 3 * near.end) {
            let zero = Vector3::zeros();
            let sample = |k: usize| axes.variables.vector(&zero, first + 3 * k);
            let samples: Vec<_> = near.clone().map(sample).collect();
            let go_on = &mut |_| ControlFlow::Continue(());
            if let Ok(own) = pieces(&knots[near.clone()], &samples, go_on) {
                for (c, more) in piece.iter_mut().zip(own[index - near.start]) {
                    *c += more;
                }
            }
        }
        (from, piece)
    }
}

impl Law for Sampled {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: false,
            needs_body: false,
            needs_epoch: false,
            keeps: ConservedMomentum::Nothing,
            has_series: true,
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("torque", &[self.knots().len(), 3])]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Ok(Self {
            spline: Arc::new(self.spline.scaled(factor)?),
            frame: self.frame,
        })
    }

    fn with_epoch(self, _: f64) -> Self {
        self
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        within(self.knots(), from, to).to_vec()
    }

    fn check(&self, _: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        self.check_at(from).and_then(|()| self.check_at(to))
    }

    #[inline]
    fn wrench(&self, _: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        Wrench::couple(in_body(&self.at(t), self.frame, &phase.attitude))
    }

    fn potential(&self, _: &BodyAtPoint, _: &Phase) -> Option<f64> {
        None
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        series.timed.push((axes.term, self));
    }
}

impl<X: LawNumber> CubicTorque<X> for Sampled {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn cubic(&self, axes: &PrincipalFrame<'_, X>, when: &StepTime<X>) -> [Vector3<X>; 4] {
        let (from, [c0, c1, c2, c3]) = self.varied_piece(axes, when.middle);
        let x = when.elapsed + X::pair(when.start, -from);
        let (two, three) = (X::from(2.0), X::from(3.0));
        let centered = [
            c0 + (c1 + (c2 + c3 * x) * x) * x,
            c1 + (c2 * two + c3 * (three * x)) * x,
            c2 + c3 * (three * x),
            c3,
        ];
        let mut scale = 1.0 / when.unit;
        centered.map(|torque| {
            scale /= when.unit;
            torque * X::from(scale)
        })
    }

    /// From the largest that the torque may be between two samples. The rate of a torque that hardly moves the body is still not
    /// so low that powers of the time between samples over it overflow in a series.
    fn square_of_rate(&self, _: &BodyAtPoint, middle: f64, over_moment: f64) -> f64 {
        let (index, (_, piece)) = (self.spline.index(middle), self.piece(middle));
        let length = self.knots()[index + 1] - self.knots()[index];
        let largest = (piece.iter().rev()).fold(0.0, |sum, c| sum * length + c.amax());
        let slowest = SLOWEST / length;
        (largest * over_moment).max(slowest * slowest)
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

/// The lowest unit of rates, in radians from one sample to the next: the powers of its reciprocal, to the highest order of a series,
/// are numbers.
const SLOWEST: f64 = 1.0 / 65_536.0;

/// How many samples on either side a piece depends on: from one to the next what a sample does to the slopes halves at least,
/// whatever the knots, so that what is left out is below 1e-24 of it.
const NEAR: usize = 80;

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::motion::loads::ParameterColumns;
    use crate::motion::loads::variables::{Block, VariationJet};

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
        let (columns, q_bp) = (
            Matrix3::identity(),
            [0.0, 0.0, 0.0, 1.0].map(VariationJet::from),
        );
        let body = BodyAtPoint {
            mass: 1.0,
            inertia: Matrix3::identity(),
            point: Vector3::zeros(),
            center: Vector3::zeros(),
            pivoted: false,
            start: 0.0,
        };
        for sample in [0, 1, 57, 200, 398, 399] {
            let axes = PrincipalFrame {
                body: &body,
                columns: &columns,
                q_bp: &q_bp,
                variables: Block { first: 3 * sample },
                parameters: &ParameterColumns::new(0, alone(sample).parameters()),
                term: 0,
                middle: 0.0,
            };
            let alone = alone(sample);
            let largest =
                |piece: &[Vector3<f64>; 4]| piece.iter().map(|c| c.x.abs()).fold(0.0, f64::max);
            let most = (knots.iter().map(|&t| largest(alone.piece(t).1))).fold(0.0, f64::max);
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
