//! The evaluation of a heavy top's motion, at one time or at many side by side.
//!
//! At a time t three quotients of theta functions at the reduced z(t), each turned by its steady phase, are α, β and W; one constant
//! matrix makes the attitude of α and β, another one ω of W.

use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::Lane;
use crate::numerics::structure_of_arrays::{ROWS, StructureOfArrays};
use crate::numerics::theta::quotients::{Circular, Hyperbolic, Values};
use crate::numerics::theta::{circular, hyperbolic};
use crate::numerics::turns::{exp_minus, sin_cos_turns, turns, whole_off};

/// A motion, ready to be evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TopConstants {
    pub(super) series: TopSeries,
    /// Turns of z, and of the steady phases of α, β and W, for each unit of time.
    pub(super) clock: DoubleDouble,
    pub(super) start: DoubleDouble,
    pub(super) steady: [DoubleDouble; 3],
    /// Beyond this |t| nothing is known of the phases.
    pub(super) reach: f64,
    /// (x, y, z, w) of the attitude from the real and imaginary parts of α and β.
    pub(super) attitude: [[f64; 4]; 4],
    /// ω in B from the parts of W.
    pub(super) across: [[f64; 2]; 3],
    /// What of ω lies along the axis.
    pub(super) along: [f64; 3],
}

/// How the three functions are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TopSeries {
    /// The axis rests: the sizes of α and β.
    Steady(Steady),
    Circular(Circular),
    Hyperbolic(Periodic),
    /// The top is reached or left in infinite time.
    Endless(Endless),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steady(pub(super) [f64; 2]);

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Periodic {
    pub(super) quotients: Hyperbolic,
    /// πK/2K′.
    pub(super) end: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Endless {
    pub(super) quotients: Hyperbolic,
}

/// Three functions of time, but for their steady phases.
pub(super) trait Functions: Copy {
    /// Their values, and turns that are to be added to the steady ones.
    fn at<L: Lane>(&self, course: &TopConstants, t: L) -> (Values<L>, [L; 3]);
}

impl Functions for Steady {
    #[inline(always)]
    fn at<L: Lane>(&self, _: &TopConstants, _: L) -> (Values<L>, [L; 3]) {
        let zero = L::new(0.0);
        let [alpha, beta] = self.0;
        let values = [[L::new(alpha), zero], [L::new(beta), zero], [zero; 2]];
        (values, [zero; 3])
    }
}

impl Functions for Circular {
    #[inline(always)]
    fn at<L: Lane>(&self, course: &TopConstants, t: L) -> (Values<L>, [L; 3]) {
        let (s, c) = sin_cos_turns(turns(t, course.clock, course.start));
        let values = self.values(&circular::Argument::new(s, c));
        (values, [L::new(0.0); 3])
    }
}

impl Functions for Periodic {
    #[inline(always)]
    fn at<L: Lane>(&self, course: &TopConstants, t: L) -> (Values<L>, [L; 3]) {
        // Half a turn of z is a period of u, after which all three change sign.
        let twice = L::new(2.0) * turns(t, course.clock, course.start);
        let periods = twice.round();
        let x = twice - periods;
        let argument = hyperbolic::Argument::new(x * L::new(2.0 * self.end), L::new(self.end));
        let half = L::new(0.5);
        let (sign_change, from_end) = (half * periods.abs(), x - half * argument.sign);
        let [first, second, third] = self.quotients.slopes();
        let extra = [
            L::new(first).mul_add(x, sign_change),
            L::new(second).mul_add(from_end, sign_change),
            L::new(third).mul_add(from_end, sign_change),
        ];
        (self.quotients.values(&argument), extra)
    }
}

impl Functions for Endless {
    #[inline(always)]
    fn at<L: Lane>(&self, course: &TopConstants, t: L) -> (Values<L>, [L; 3]) {
        let (p, e) = t.two_product(L::new(course.clock.high));
        let w = (p + L::new(course.start.high)) + (e + t * L::new(course.clock.low));
        let argument = hyperbolic::Argument {
            from_middle: exp_minus(w.abs()),
            from_end: L::new(0.0),
            sign: L::new(1.0).copysign(w),
        };
        (self.quotients.values(&argument), [L::new(0.0); 3])
    }
}
impl TopConstants {
    /// Attitudes (x, y, z, w) and ω at `times`.
    pub(super) fn sample(
        &self,
        times: &[f64],
        attitudes: &mut [[f64; 4]],
        omegas: &mut [[f64; 3]],
    ) {
        match &self.series {
            TopSeries::Steady(functions) => self.sample_by(functions, times, attitudes, omegas),
            TopSeries::Circular(functions) => self.sample_by(functions, times, attitudes, omegas),
            TopSeries::Hyperbolic(functions) => self.sample_by(functions, times, attitudes, omegas),
            TopSeries::Endless(functions) => self.sample_by(functions, times, attitudes, omegas),
        }
    }

    fn sample_by<F: Functions>(
        &self,
        functions: &F,
        times: &[f64],
        attitudes: &mut [[f64; 4]],
        omegas: &mut [[f64; 3]],
    ) {
        if times.len() < FEW {
            for ((&t, attitude), omega) in times.iter().zip(attitudes).zip(omegas) {
                let course = (self, functions);
                let [x, y, z, w, w1, w2, w3] = dispatch(One { course, t });
                (*attitude, *omega) = ([x, y, z, w], [w1, w2, w3]);
            }
            return;
        }
        dispatch(Many {
            course: (self, functions),
            times,
            attitudes,
            omegas,
        });
    }

    /// (x, y, z, w) of the attitude and ω in B at the time `t`.
    #[inline(always)]
    fn state<L: Lane, F: Functions>(&self, functions: &F, t: L) -> [L; 7] {
        let is_known = t.abs() <= L::new(self.reach);
        let t = if is_known { t } else { L::new(f64::NAN) };
        let (values, extra) = functions.at(self, t);
        let alpha = self.turned(0, t, &values, &extra);
        let beta = self.turned(1, t, &values, &extra);
        let w = self.turned(2, t, &values, &extra);
        let q = [
            self.component(0, alpha, beta),
            self.component(1, alpha, beta),
            self.component(2, alpha, beta),
            self.component(3, alpha, beta),
        ];
        // One step of Newton's method toward length one, which it has but for rounding.
        let square = q[0] * q[0] + q[1] * q[1] + (q[2] * q[2] + q[3] * q[3]);
        let factor = L::new(1.5) - L::new(0.5) * square;
        [
            q[0] * factor,
            q[1] * factor,
            q[2] * factor,
            q[3] * factor,
            self.rate(0, w),
            self.rate(1, w),
            self.rate(2, w),
        ]
    }

    // Functions rather than closures, which `map` would leave to be called, compiled for the baseline.

    /// A function of time with all of its phase.
    #[inline(always)]
    fn turned<L: Lane>(&self, k: usize, t: L, values: &Values<L>, extra: &[L; 3]) -> [L; 2] {
        let phase = turns(t, self.steady[k], DoubleDouble::default());
        let (s, c) = sin_cos_turns(whole_off(phase + extra[k]));
        let [re, im] = values[k];
        [re * c - im * s, re * s + im * c]
    }

    #[inline(always)]
    fn component<L: Lane>(&self, row: usize, alpha: [L; 2], beta: [L; 2]) -> L {
        let [a, b, c, d] = self.attitude[row];
        (L::new(a) * alpha[0] + L::new(b) * alpha[1]) + (L::new(c) * beta[0] + L::new(d) * beta[1])
    }

    #[inline(always)]
    fn rate<L: Lane>(&self, row: usize, w: [L; 2]) -> L {
        let [a, b] = self.across[row];
        L::new(a) * w[0] + L::new(b) * w[1] + L::new(self.along[row])
    }
}

/// Fewer times than this are done one by one.
const FEW: usize = 8;

struct One<'a, F> {
    course: (&'a TopConstants, &'a F),
    t: f64,
}

impl<F: Functions> Kernel for One<'_, F> {
    type Output = [f64; 7];

    #[inline(always)]
    fn run<L: Lane>(self) -> [f64; 7] {
        let (course, functions) = self.course;
        let [x, y, z, w, w1, w2, w3] = course.state(functions, L::new(self.t));
        [
            x.get(),
            y.get(),
            z.get(),
            w.get(),
            w1.get(),
            w2.get(),
            w3.get(),
        ]
    }
}

struct Many<'a, F> {
    course: (&'a TopConstants, &'a F),
    times: &'a [f64],
    attitudes: &'a mut [[f64; 4]],
    omegas: &'a mut [[f64; 3]],
}

impl<F: Functions> Kernel for Many<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        // Copies, which no output can overlap.
        let (course, functions) = (*self.course.0, *self.course.1);
        let (mut before, mut after) = (StructureOfArrays::<1>::ZERO, StructureOfArrays::<7>::ZERO);
        let blocks = (self.times.chunks(ROWS))
            .zip(self.attitudes.chunks_mut(ROWS))
            .zip(self.omegas.chunks_mut(ROWS));
        for ((times, attitudes), omegas) in blocks {
            for (row, &t) in times.iter().enumerate().take(ROWS) {
                before.set(row, [t]);
            }
            for row in 0..ROWS {
                let [t] = before.lanes::<L>(row);
                after.set_lanes(row, course.state(&functions, t));
            }
            for (row, attitude) in attitudes.iter_mut().enumerate().take(ROWS) {
                *attitude = after.get(row, 0);
            }
            for (row, omega) in omegas.iter_mut().enumerate().take(ROWS) {
                *omega = after.get(row, 4);
            }
        }
    }
}
