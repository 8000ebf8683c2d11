//! Quintics through vectors and their rates known at some times.

use std::cmp::Ordering;

use nalgebra::Vector3;

use super::spline::check_ascending;
use crate::error::{Error, all_finite, finite};
use crate::numerics::threads::{Watch, each_watched};

/// Quintics between samples, which have the values and the rates of the samples, and are smooth to the second derivative.
///
/// The second derivative at a sample is that of the one quintic through the values and rates of this sample and of both of its
/// neighbours; at the first and last sample that of their neighbour's quintic. So no law of motion enters, whatever acts. Where the
/// distance of the times is h, these derivatives are right to h⁴ and the values to h⁶. Two samples make a cubic.
/// Source: de Boor, A Practical Guide to Splines, chapter I (divided differences with repeated points).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Quintic {
    knots: Vec<f64>,
    /// A piece from each of the times on: from the last one too, which serves this time alone.
    pieces: Vec<[Vector3<f64>; 6]>,
}

impl Quintic {
    /// Through `values` with `rates` at the ascending `times`; `names`: of the times, their span, the values, the rates and the quintics.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, numbers that are not finite; [`Error::Stopped`] where `watch` says so.
    ///
    /// # Panics
    /// When `times`, `values` and `rates` differ in length.
    pub(super) fn through(
        names: [&'static str; 5],
        times: &[f64],
        [values, rates]: [&[Vector3<f64>]; 2],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        assert_eq!(times.len(), values.len(), "a value for each time");
        assert_eq!(times.len(), rates.len(), "a rate for each time");
        if times.len() < 2 {
            return Err(Error::OutOfDomain {
                what: "the number of samples",
                law: "at least 2",
                value: times.len() as f64,
            });
        }
        let [when, span, what, speed, through] = names;
        check_ascending(when, times)?;
        all_finite(what, values.iter().flatten())?;
        all_finite(speed, rates.iter().flatten())?;
        let last = times.len() - 1;
        finite(span, times[last] - times[0])?;
        let mut pieces = Vec::with_capacity(times.len());
        let interval = |k: usize| Interval::between(times, values, rates, k);
        each_watched(0..last, watch, |k| {
            let here = interval(k);
            let bends = match last {
                1 => here.bends_of_cubic(),
                _ => [k, k + 1].map(|sample| {
                    let middle = sample.clamp(1, last - 1);
                    let both = Neighbours::of(&interval(middle - 1), &interval(middle));
                    both.half_bend(sample.cmp(&middle))
                }),
            };
            pieces.push(here.piece(&values[k], &rates[k], &bends));
            if k + 1 == last {
                let mut end = [Vector3::zeros(); 6];
                (end[0], end[1], end[2]) = (values[last], rates[last], bends[1]);
                pieces.push(end);
            }
            Ok::<_, Error>(())
        })?;
        all_finite(through, pieces.iter().flatten().flatten())?;
        Ok(Self {
            knots: times.to_vec(),
            pieces,
        })
    }

    #[inline]
    pub(super) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The time from the start of the piece around `t`, and the piece.
    #[inline]
    fn piece(&self, t: f64) -> (f64, &[Vector3<f64>; 6]) {
        let index = self.knots[1..].partition_point(|&knot| knot <= t);
        (t - self.knots[index], &self.pieces[index])
    }

    /// The value at time `t`, and its rate.
    #[inline]
    pub(super) fn at(&self, t: f64) -> [Vector3<f64>; 2] {
        let (x, [c0, c1, c2, c3, c4, c5]) = self.piece(t);
        [
            c0 + (c1 + (c2 + (c3 + (c4 + c5 * x) * x) * x) * x) * x,
            c1 + (c2 * 2.0 + (c3 * 3.0 + (c4 * 4.0 + c5 * (5.0 * x)) * x) * x) * x,
        ]
    }

    /// The second derivative at time `t`.
    pub(super) fn bend(&self, t: f64) -> Vector3<f64> {
        let (x, [_, _, c2, c3, c4, c5]) = self.piece(t);
        c2 * 2.0 + (c3 * 6.0 + (c4 * 12.0 + c5 * (20.0 * x)) * x) * x
    }
}

/// Divided differences of the samples at both ends of an interval, each of which counts twice.
struct Interval {
    length: f64,
    /// Over two times the first end and the second, and over the first and two times the second.
    second: [Vector3<f64>; 2],
    /// Over two times each.
    third: Vector3<f64>,
}

impl Interval {
    fn between(times: &[f64], values: &[Vector3<f64>], rates: &[Vector3<f64>], k: usize) -> Self {
        let length = times[k + 1] - times[k];
        let chord = (values[k + 1] - values[k]) / length;
        let second = [(chord - rates[k]) / length, (rates[k + 1] - chord) / length];
        Self {
            length,
            second,
            third: (second[1] - second[0]) / length,
        }
    }

    /// Half of the second derivative at both ends, of the cubic.
    fn bends_of_cubic(&self) -> [Vector3<f64>; 2] {
        let turn = self.third * self.length;
        [self.second[0] - turn, self.second[1] + turn]
    }

    /// The quintic with the halves of the second derivatives `bends` at the ends, in powers of the time from the first.
    fn piece(
        &self,
        value: &Vector3<f64>,
        rate: &Vector3<f64>,
        bends: &[Vector3<f64>; 2],
    ) -> [Vector3<f64>; 6] {
        let h = self.length;
        let third = [
            (self.second[0] - bends[0]) / h,
            (bends[1] - self.second[1]) / h,
        ];
        let fourth = [(self.third - third[0]) / h, (third[1] - self.third) / h];
        let fifth = (fourth[1] - fourth[0]) / h;
        [
            *value,
            *rate,
            bends[0],
            third[0] - (fourth[0] - fifth * h) * h,
            fourth[0] - fifth * (2.0 * h),
            fifth,
        ]
    }
}

/// Divided differences over three samples, each of which counts twice.
struct Neighbours {
    lengths: [f64; 2],
    second: [Vector3<f64>; 4],
    third: [Vector3<f64>; 3],
    fourth: [Vector3<f64>; 2],
    fifth: Vector3<f64>,
}

impl Neighbours {
    fn of(left: &Interval, right: &Interval) -> Self {
        let whole = left.length + right.length;
        let across = (right.second[0] - left.second[1]) / whole;
        let third = [left.third, across, right.third];
        let fourth = [
            (across - left.third) / whole,
            (right.third - across) / whole,
        ];
        Self {
            lengths: [left.length, right.length],
            second: [
                left.second[0],
                left.second[1],
                right.second[0],
                right.second[1],
            ],
            third,
            fourth,
            fifth: (fourth[1] - fourth[0]) / whole,
        }
    }

    /// Half of the second derivative of the quintic through all three, at the first (less), the middle one (equal) or the last (greater).
    ///
    /// By Newton's form, with the nodes in an order that begins with two times the one asked for.
    fn half_bend(&self, place: Ordering) -> Vector3<f64> {
        let [a, b] = self.lengths;
        let whole = a + b;
        match place {
            Ordering::Equal => {
                self.second[1] + (self.third[1] - (self.fourth[0] + self.fifth * a) * b) * a
            }
            Ordering::Greater => {
                self.second[3] + (self.third[2] + (self.fourth[1] + self.fifth * whole) * b) * b
            }
            Ordering::Less => {
                self.second[0] - (self.third[0] - (self.fourth[0] - self.fifth * whole) * a) * a
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    const NAMES: [&str; 5] = ["t", "span", "value", "rate", "quintics"];

    fn through(times: &[f64], f: impl Fn(f64) -> [f64; 2]) -> Quintic {
        let vector = |x: f64| Vector3::new(x, -2.0 * x, 0.0);
        let values: Vec<_> = times.iter().map(|&t| vector(f(t)[0])).collect();
        let rates: Vec<_> = times.iter().map(|&t| vector(f(t)[1])).collect();
        let watch = &mut |_| ControlFlow::Continue(());
        Quintic::through(NAMES, times, [&values, &rates], watch).expect("ascending")
    }

    #[test]
    fn a_quintic_is_met_everywhere_and_a_cubic_by_two_samples() {
        let f = |t: f64| {
            [
                1.0 - t + t * t * (0.5 - t * (0.25 - t * (0.125 + t))),
                -1.0 + t * (1.0 - t * (0.75 - t * (0.5 + 5.0 * t))),
            ]
        };
        let bend = |t: f64| 1.0 - t * (1.5 - t * (1.5 + 20.0 * t));
        let found = through(&[-0.5, 0.0, 0.75, 1.0, 2.0], f);
        for t in [-0.5, -0.25, 0.0, 0.5, 0.875, 1.0, 1.5, 2.0] {
            let [value, rate] = found.at(t);
            assert!((value.x - f(t)[0]).abs() < 1e-13, "{t}");
            assert!((rate.x - f(t)[1]).abs() < 1e-12, "{t}");
            assert!((found.bend(t).x - bend(t)).abs() < 1e-11, "{t}");
        }
        let cubic = |t: f64| [t * t * (1.0 - 2.0 * t), t * (2.0 - 6.0 * t)];
        let found = through(&[0.0, 2.0], cubic);
        for t in [0.0, 0.3, 1.7, 2.0] {
            assert!((found.at(t)[0].x - cubic(t)[0]).abs() < 1e-14, "{t}");
            assert!((found.bend(t).x - (2.0 - 12.0 * t)).abs() < 1e-13, "{t}");
        }
    }

    #[test]
    fn the_samples_are_met_to_the_bit() {
        let times = [0.0, 0.1, 0.35, 0.4, 1.3];
        let f = |t: f64| [t.sin(), t.cos()];
        let found = through(&times, f);
        for t in times {
            let [value, rate] = found.at(t);
            assert_eq!([value.x, rate.x], f(t));
        }
    }
}
