//! A cubic spline through vectors known at some times.

use nalgebra::Vector3;

use super::held::ascending;
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::numerics::number::Real;

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
    /// Fewer than two times, times that do not ascend, numbers that are not finite.
    ///
    /// # Panics
    /// When `times` and `values` differ in length.
    pub(super) fn through(
        names: [&'static str; 4],
        times: &[f64],
        values: &[Vector3<f64>],
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
        ascending(when, times)?;
        all_finite(what, values.iter().flatten())?;
        finite(span, times[times.len() - 1] - times[0])?;
        let pieces = pieces(times, values);
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
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
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

/// The cubics between the samples, from the slopes at them.
pub(super) fn pieces<X: Real>(t: &[f64], y: &[Vector3<X>]) -> Vec<[Vector3<X>; 4]> {
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
