//! A cubic spline through vectors known at some times.

use nalgebra::Vector3;

use crate::error::{Error, MotionFault, all_finite, finite};
use crate::numerics::number::Real;
use crate::numerics::threads::{Watch, each_watched};

/// Cubics between samples, smooth to the second derivative.
///
/// The first two pieces are one cubic, and the last two ("not a knot"); three samples make a parabola, two a straight line.
/// Beyond the first and last time nothing is known. Source: de Boor, A Practical Guide to Splines, chapter IV.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spline {
    knots: Vec<f64>,
    pieces: Vec<[Vector3<f64>; 4]>,
}

impl Spline {
    /// Through `values` at the ascending `times`; `names`: of the times, their span, the values and the spline.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, numbers that are not finite; [`Error::Stopped`] where `watch` says so.
    ///
    /// # Panics
    /// When `times` and `values` differ in length.
    pub(super) fn through(
        names: [&'static str; 4],
        times: &[f64],
        values: &[Vector3<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        assert_eq!(times.len(), values.len(), "a value for each time");
        if times.len() < 2 {
            return Err(Error::OutOfDomain {
                what: "the number of samples",
                law: "at least 2",
                value: times.len() as f64,
            });
        }
        let [when, span, what, through] = names;
        check_ascending(when, times)?;
        all_finite(what, values.iter().flatten())?;
        finite(span, times[times.len() - 1] - times[0])?;
        let pieces = pieces(times, values, watch)?;
        all_finite(through, pieces.iter().flatten().flatten())?;
        Ok(Self {
            knots: times.to_vec(),
            pieces,
        })
    }

    /// The spline with all values times a factor.
    pub(super) fn scaled(&self, factor: f64) -> Result<Self, Error> {
        let pieces: Vec<_> = (self.pieces.iter().map(|piece| piece.map(|c| c * factor))).collect();
        all_finite(
            "the load times its factor",
            pieces.iter().flatten().flatten(),
        )?;
        Ok(Self {
            knots: self.knots.clone(),
            pieces,
        })
    }

    #[inline]
    pub(super) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The number of the piece around time `t`.
    #[inline]
    pub(super) fn index(&self, t: f64) -> usize {
        self.knots[1..self.knots.len() - 1].partition_point(|&knot| knot <= t)
    }

    /// The cubic around time `t`, `Σ c_k (t − t₀)^k`: its t₀ and coefficients.
    #[inline]
    pub(super) fn piece(&self, t: f64) -> (f64, &[Vector3<f64>; 4]) {
        let index = self.index(t);
        (self.knots[index], &self.pieces[index])
    }

    /// The value at time `t`, and its rate.
    #[inline]
    pub(super) fn at(&self, t: f64) -> [Vector3<f64>; 2] {
        let (from, [c0, c1, c2, c3]) = self.piece(t);
        let x = t - from;
        [
            c0 + (c1 + (c2 + c3 * x) * x) * x,
            c1 + (c2 * 2.0 + c3 * (3.0 * x)) * x,
        ]
    }

    /// Its second derivative at time `t`.
    pub(super) fn bend(&self, t: f64) -> Vector3<f64> {
        let (from, [_, _, c2, c3]) = self.piece(t);
        c2 * 2.0 + c3 * (6.0 * (t - from))
    }

    /// Checks that `t` is within its times.
    ///
    /// # Errors
    /// [`MotionFault::OutsideSamples`].
    pub(super) fn check_at(&self, t: f64) -> Result<(), Error> {
        check_within(&self.knots, t)
    }
}

/// Checks that `t` is within the times of samples.
///
/// # Errors
/// [`MotionFault::OutsideSamples`].
pub(super) fn check_within(knots: &[f64], t: f64) -> Result<(), Error> {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
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

/// Those of the ascending times that lie between one time and another.
pub(super) fn within(times: &[f64], from: f64, to: f64) -> &[f64] {
    let (low, high) = (from.min(to), from.max(to));
    let first = times.partition_point(|t| *t <= low);
    let count = times[first..].partition_point(|t| *t < high);
    &times[first..first + count]
}

/// The cubics between the samples, from the slopes at them.
pub(super) fn pieces<X: Real>(
    t: &[f64],
    y: &[Vector3<X>],
    watch: &mut Watch<'_>,
) -> Result<Vec<[Vector3<X>; 4]>, Error> {
    let step = |k: usize| t[k + 1] - t[k];
    let chord = |k: usize| (y[k + 1] - y[k]) / X::from(step(k));
    let count = t.len() - 1;
    let slopes = match count {
        1 => vec![chord(0); 2],
        2 => {
            let (first, second) = (chord(0), chord(1));
            let bend = (second - first) / X::from(step(0) + step(1));
            let middle = first + bend * X::from(step(0));
            let last = second + bend * X::from(step(1));
            vec![first - bend * X::from(step(0)), middle, last]
        }
        _ => slopes(count, &step, &chord, watch)?,
    };
    let mut pieces = Vec::with_capacity(count);
    each_watched(0..count, watch, |k| {
        let (h, chord, s0, s1) = (X::from(step(k)), chord(k), slopes[k], slopes[k + 1]);
        let bend = (s0 + s1 - chord * X::from(2.0)) / h;
        pieces.push([y[k], s0, (chord - s0) / h - bend, bend / h]);
        Ok::<_, Error>(())
    })?;
    Ok(pieces)
}

/// The slopes that make the second derivative continuous, and the third at the second and the last but one sample:
/// a tridiagonal system, whose pivots are positive.
fn slopes<X: Real>(
    n: usize,
    h: &impl Fn(usize) -> f64,
    chord: &impl Fn(usize) -> Vector3<X>,
    watch: &mut Watch<'_>,
) -> Result<Vec<Vector3<X>>, Error> {
    let (first, last) = (h(0) + h(1), h(n - 2) + h(n - 1));
    let sum = |a: usize, by_a: f64, b: usize, by_b: f64| {
        chord(a) * X::from(by_a) + chord(b) * X::from(by_b)
    };
    // Rows as below, diagonal, right-hand side; above the diagonal stands `above`.
    let above = |k: usize| if k == 0 { first } else { h(k - 1) };
    let row = |k: usize| {
        if k == 0 {
            let side = sum(0, (h(0) + 2.0 * first) * h(1), 1, h(0) * h(0));
            (0.0, h(1), side / X::from(first))
        } else if k < n {
            let side = sum(k - 1, h(k), k, h(k - 1));
            (h(k), 2.0 * (h(k - 1) + h(k)), side * X::from(3.0))
        } else {
            let (a, b) = (h(n - 1) * h(n - 1), (2.0 * last + h(n - 1)) * h(n - 2));
            let side = sum(n - 2, a, n - 1, b);
            (last, h(n - 2), side / X::from(last))
        }
    };
    let (_, pivot, side) = row(0);
    let (mut pivots, mut slopes) = (Vec::with_capacity(n + 1), Vec::with_capacity(n + 1));
    pivots.push(pivot);
    slopes.push(side);
    each_watched(0..n, watch, |k| {
        let (below, pivot, side) = row(k + 1);
        let ratio = below / pivots[k];
        pivots.push(pivot - ratio * above(k));
        slopes.push(side - slopes[k] * X::from(ratio));
        Ok::<_, Error>(())
    })?;
    slopes[n] /= X::from(pivots[n]);
    each_watched((0..n).rev(), watch, |k| {
        slopes[k] = (slopes[k] - slopes[k + 1] * X::from(above(k))) / X::from(pivots[k]);
        Ok::<_, Error>(())
    })?;
    Ok(slopes)
}

/// Check that times are finite and ascend.
pub(super) fn check_ascending(what: &'static str, times: &[f64]) -> Result<(), Error> {
    all_finite(what, times)?;
    for (k, pair) in times.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            return Err(Error::Motion(MotionFault::NotMonotone {
                what,
                order: "ascending",
                index: k + 1,
                previous: pair[0],
                next: pair[1],
            }));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::motion::loads::{AttitudeTarget, Frame, MagneticField, OrbitModel, Sampled};

    #[test]
    fn times_between_two_times() {
        let times = [0.0, 1.0, 2.0, 3.0];
        assert_eq!(within(&times, 0.0, 3.0), [1.0, 2.0]); // without the ends
        assert_eq!(within(&times, 2.5, 0.5), [1.0, 2.0]); // backward
        assert_eq!(within(&times, -1.0, 9.0), times);
        assert_eq!(within(&times, 0.0_f64.next_down(), 1.0), [0.0]);
        assert!(within(&times, 1.0, 2.0).is_empty() && within(&times, 1.0, 1.0).is_empty());
        assert!(within(&times, 3.0, 5.0).is_empty() && within(&[], 0.0, 1.0).is_empty());
    }

    /// Makes something of samples; tells what is wrong with it.
    type Make<'a> = dyn Fn(&mut Watch<'_>) -> Option<Error> + 'a;

    #[test]
    fn samples_are_watched_where_there_are_many() {
        // A look is taken after each 4,096 of them.
        for (count, is_asked) in [(4095, false), (40_000, true)] {
            let times: Vec<f64> = (0..count).map(f64::from).collect();
            let values: Vec<_> = (times.iter())
                .map(|t| Vector3::new(t.sin(), 1.0, *t))
                .collect();
            let attitudes = vec![UnitQuaternion::identity(); times.len()];
            let made: [&Make<'_>; 5] = [
                &|watch| Sampled::new_watched(&times, &values, Frame::Body, watch).err(),
                &|watch| MagneticField::sampled_watched(&times, &values, watch).err(),
                &|watch| OrbitModel::sampled_watched(&times, &values, None, watch).err(),
                &|watch| OrbitModel::sampled_watched(&times, &values, Some(&values), watch).err(),
                &|watch| AttitudeTarget::sampled_watched(&times, &attitudes, watch).err(),
            ];
            for (make, most) in made.iter().flat_map(|make| [(make, 1), (make, 9)]) {
                let mut looks = 0;
                let error = make(&mut |_| {
                    looks += 1;
                    if looks < most {
                        ControlFlow::Continue(())
                    } else {
                        ControlFlow::Break(())
                    }
                });
                let expected = if is_asked {
                    (Some(Error::Stopped), most)
                } else {
                    (None, 0)
                };
                assert_eq!((error, looks), expected);
            }
        }
    }
}
