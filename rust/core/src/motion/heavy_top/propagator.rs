//! The motion of a heavy top from its state: the constants, and the states at any time.
//!
//! At a time t three quotients of theta functions at the reduced z(t), each turned by its steady phase, are α, β and W; one constant
//! matrix makes the attitude of α and β, another one ω of W.

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};

use super::nutation::Nutation;
use super::phases::{Phases, TURN};
use super::pivoted_top::PivotedTop;
use super::reduced::ReducedTop;
use super::top_data::times;
use super::turning_points::TurningPoints;
use crate::motion::closed_form::{ChooseFormula, StateFormula, UseFormula};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::{BASELINE, Double, Lane};
use crate::numerics::power_of_two::times_power_of_two;
use crate::numerics::theta::quotients::{Circular, Hyperbolic, Values};
use crate::numerics::theta::{circular, hyperbolic};
use crate::numerics::turns::{exp_minus, reach, sin_cos_turns, turns, whole_off};

/// A motion, ready to be evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TopConstants {
    series: TopSeries,
    /// Turns of z, and of the steady phases of α, β and W, for each unit of time.
    clock: DoubleDouble,
    start: DoubleDouble,
    steady: [DoubleDouble; 3],
    /// Beyond this |t| nothing is known of the phases.
    pub(super) reach: f64,
    /// (x, y, z, w) of the attitude from the real and imaginary parts of α and β.
    attitude: [[f64; 4]; 4],
    /// ω in B from the parts of W.
    across: [[f64; 2]; 3],
    /// What of ω lies along the axis.
    along: [f64; 3],
}

/// How the three functions are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TopSeries {
    /// The axis rests: the sizes of α and β.
    Steady(Steady),
    Circular(Circular),
    Hyperbolic(Periodic),
    /// The top is reached or left in infinite time.
    Endless(Endless),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Steady([f64; 2]);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Periodic {
    quotients: Hyperbolic,
    /// πK/2K′.
    end: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Endless {
    quotients: Hyperbolic,
}

/// Three functions of time, but for their steady phases.
trait Functions: Copy {
    /// Their values, and turns that are to be added to the steady ones.
    fn at<L: Lane>(&self, constants: &TopConstants, t: L) -> (Values<L>, [L; 3]);
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
    fn at<L: Lane>(&self, constants: &TopConstants, t: L) -> (Values<L>, [L; 3]) {
        let (s, c) = sin_cos_turns(turns(t, constants.clock, constants.start));
        let values = self.values(&circular::Argument::new(s, c));
        (values, [L::new(0.0); 3])
    }
}

impl Functions for Periodic {
    #[inline(always)]
    fn at<L: Lane>(&self, constants: &TopConstants, t: L) -> (Values<L>, [L; 3]) {
        // Half a turn of z is a period of u, after which all three change sign.
        let twice = L::new(2.0) * turns(t, constants.clock, constants.start);
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
    fn at<L: Lane>(&self, constants: &TopConstants, t: L) -> (Values<L>, [L; 3]) {
        let (p, e) = t.two_product(L::new(constants.clock.high));
        let w = (p + L::new(constants.start.high)) + (e + t * L::new(constants.clock.low));
        let argument = hyperbolic::Argument {
            from_middle: exp_minus(w.abs()),
            from_end: L::new(0.0),
            sign: L::new(1.0).copysign(w),
        };
        (self.quotients.values(&argument), [L::new(0.0); 3])
    }
}
impl TopConstants {
    /// (x, y, z, w) of the attitude and ω in B at the time `t`.
    #[inline(always)]
    fn state<L: Lane, F: Functions>(&self, functions: &F, t: L) -> [L; 7] {
        let is_known = t.abs() <= L::new(self.reach);
        let t = if is_known { t } else { L::new(f64::NAN) };
        let (values, extra) = functions.at(self, t);
        let alpha = self.turn_by_phase(0, t, &values, &extra);
        let beta = self.turn_by_phase(1, t, &values, &extra);
        let w = self.turn_by_phase(2, t, &values, &extra);
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
    fn turn_by_phase<L: Lane>(&self, k: usize, t: L, values: &Values<L>, extra: &[L; 3]) -> [L; 2] {
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

impl ChooseFormula for TopConstants {
    #[inline(always)]
    fn choose<U: UseFormula>(&self, then: U) -> U::Output {
        match self.series {
            TopSeries::Steady(functions) => then.with(&TopFormula(self, functions)),
            TopSeries::Circular(functions) => then.with(&TopFormula(self, functions)),
            TopSeries::Hyperbolic(functions) => then.with(&TopFormula(self, functions)),
            TopSeries::Endless(functions) => then.with(&TopFormula(self, functions)),
        }
    }
}

/// The constants with their functions of time.
struct TopFormula<'a, F>(&'a TopConstants, F);

impl<F: Functions> StateFormula for TopFormula<'_, F> {
    #[inline(always)]
    fn state<L: Lane>(&self, t: L) -> [L; 7] {
        self.0.state(&self.1, t)
    }
}

/// A complex number.
type Complex = [f64; 2];

impl TopConstants {
    /// The motion from this state on, and what there is to tell about it. All arguments are finite.
    pub(super) fn of(
        top: &PivotedTop,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
        gravity: &Vector3<f64>,
    ) -> (Self, Nutation) {
        let mut motion = ReducedTop::of(top.source(), omega, attitude, gravity);
        let half_spin = (motion.axial * TURN).scaled(0.5);
        if !motion.is_steady() {
            let points = TurningPoints::of(&motion);
            if points.height.high > 0.0 && points.are_good(&motion) {
                let phases = Phases::of(&motion, &points);
                return Self::with_moving_axis(&motion, &points, &phases, half_spin);
            }
            if points.height.high > 0.0 {
                let finest =
                    ReducedTop::of(&top.finest(), omega, attitude, gravity).without_rounding();
                motion = finest.twofold();
                if !finest.is_steady() {
                    let points = TurningPoints::of(&finest).without_rounding(&finest);
                    let phases = Phases::of(&finest, &points);
                    return Self::with_moving_axis(&motion, &points.twofold(), &phases, half_spin);
                }
            }
        }
        let [alpha, beta, _] = motion.start;
        let sizes = [alpha, beta].map(|[re, im]| re.hypot(im));
        let directions = [alpha, beta].map(|z| direction(z).unwrap_or([1.0, 0.0]));
        let mut constants = Self::with(&motion, &TopSeries::Steady(Steady(sizes)));
        constants.steady = [half_spin, -half_spin, DoubleDouble::default()];
        constants.unit(motion.exponent);
        constants.frame(&motion, [directions[0], directions[1], [1.0, 0.0]]);
        (constants, Nutation::steady(&motion))
    }

    fn with_moving_axis(
        motion: &ReducedTop,
        points: &TurningPoints,
        phases: &Phases,
        half_spin: DoubleDouble,
    ) -> (Self, Nutation) {
        let half = phases.half;
        let is_endless = half.real.is_infinite();
        let sizes = [
            (motion.bottom + points.rise).rounded().sqrt() / SQRT_2,
            points.depth.rounded().sqrt() / SQRT_2,
            points.fastest.rounded().sqrt(),
        ];
        let series = if half.real <= half.imaginary {
            let quotients = Circular::new(half, phases.shifts);
            let at = |s: f64, c: f64| {
                let z = circular::Argument::new(Single::new(s), Single::new(c));
                quotients.values(&z)
            };
            TopSeries::Circular(quotients.scaled(factors(&sizes, &at(1.0, 0.0), &at(0.0, 1.0))))
        } else {
            let quotients = Hyperbolic::new(half, phases.shifts);
            let end = FRAC_PI_2 * half.real / half.imaginary;
            let least = (-end).exp();
            let at = |from_middle: f64, from_end: f64| {
                quotients.values(&hyperbolic::Argument {
                    from_middle: Single::new(from_middle),
                    from_end: Single::new(from_end),
                    sign: Single::new(1.0),
                })
            };
            let upper = at(least, if is_endless { 0.0 } else { 1.0 });
            let quotients = quotients.scaled(factors(&sizes, &upper, &at(1.0, least)));
            if is_endless {
                TopSeries::Endless(Endless { quotients })
            } else {
                TopSeries::Hyperbolic(Periodic { quotients, end })
            }
        };
        let mut constants = Self::with(motion, &series);
        constants.clock = if is_endless {
            phases.lambda
        } else {
            phases.clock
        };
        constants.start = phases.start;
        constants.steady = phases.steady;
        let phase_constants = constants.phase_constants(motion, points, phases);
        // The body turns against the frame of the equal spherical top.
        let drift = half_spin - (motion.spin * TURN).scaled(0.5);
        let [alpha, beta, w] = phases.steady;
        constants.steady = [alpha + drift, beta - drift, w - drift.scaled(2.0)];
        constants.unit(motion.exponent);
        constants.frame(motion, phase_constants);
        (constants, Nutation::of(motion, points, phases, drift))
    }

    fn with(motion: &ReducedTop, series: &TopSeries) -> Self {
        let [x, y, z] = turned_basis(&motion.aligning, 2);
        let spin = times_power_of_two(motion.axial.rounded(), motion.exponent);
        Self {
            series: *series,
            clock: DoubleDouble::default(),
            start: DoubleDouble::default(),
            steady: [DoubleDouble::default(); 3],
            reach: f64::INFINITY,
            attitude: [[0.0; 4]; 4],
            across: [[0.0; 2]; 3],
            along: [x * spin, y * spin, z * spin],
        }
    }

    /// From the units of the reduced motion to those of the arguments.
    fn unit(&mut self, exponent: i32) {
        self.clock = times(self.clock, exponent);
        self.steady = self.steady.map(|rate| times(rate, exponent));
        let [alpha, beta, w] = self.steady;
        self.reach = reach(&match self.series {
            TopSeries::Endless(_) => [alpha, beta, w, DoubleDouble::default()],
            _ => [alpha, beta, w, self.clock],
        });
    }

    /// The constant phases of α, β and W, of which two are independent: those of the two functions that are larger at the start,
    /// relative to the largest each becomes. At u₁ the three have `W α β* = ½ i (a − b u₁)`.
    fn phase_constants(
        &self,
        motion: &ReducedTop,
        points: &TurningPoints,
        phases: &Phases,
    ) -> [Complex; 3] {
        let (values, extra) = match &self.series {
            TopSeries::Steady(functions) => functions.at(self, Single::new(0.0)),
            TopSeries::Circular(functions) => functions.at(self, Single::new(0.0)),
            TopSeries::Hyperbolic(functions) => functions.at(self, Single::new(0.0)),
            TopSeries::Endless(functions) => functions.at(self, Single::new(0.0)),
        };
        let found = [0, 1, 2].map(|k| {
            let (s, c) = sin_cos_turns(whole_off(extra[k]));
            let turned = times_complex(values[k].map(Single::get), [c.get(), s.get()]);
            direction(times_complex(motion.start[k], [turned[0], -turned[1]]))
        });
        let parts = [
            motion.bottom / (motion.bottom + points.rise),
            motion.top / points.depth,
            motion.square / points.fastest,
        ]
        .map(|part| if part.high.is_nan() { 0.0 } else { part.high });
        let winding = if phases.half.real.is_infinite() {
            0.0
        } else {
            phases.carry * phases.start.high
        };
        let (s, c) = sin_cos_turns(Single::new(winding));
        let (there, back) = ([c.get(), s.get()], [c.get(), -s.get()]);
        let one = [1.0, 0.0];
        let [alpha, beta, w] = found.map(|direction| direction.unwrap_or(one));
        let least_is = |k: usize| parts[k] <= parts[(k + 1) % 3] && parts[k] <= parts[(k + 2) % 3];
        let minus = |[re, im]: Complex| [-re, -im];
        let (alpha, beta) = if least_is(2) {
            (alpha, beta)
        } else if least_is(1) {
            (alpha, minus(times_complex(times_complex(w, alpha), back)))
        } else {
            let product = times_complex([w[0], -w[1]], beta);
            (minus(times_complex(product, there)), beta)
        };
        let w = minus(times_complex(
            times_complex(beta, [alpha[0], -alpha[1]]),
            there,
        ));
        [alpha, beta, w]
    }

    /// The matrices from the three functions to attitude and ω.
    fn frame(&mut self, motion: &ReducedTop, phase_constants: [Complex; 3]) {
        let [alpha, beta, w] = phase_constants;
        // (x, y, z, w) of the unit values of Re α, Im α, Re β, Im β.
        let columns = [
            [0.0, 0.0, alpha[1], alpha[0]],
            [0.0, 0.0, alpha[0], -alpha[1]],
            [beta[0], beta[1], 0.0, 0.0],
            [-beta[1], beta[0], 0.0, 0.0],
        ]
        .map(|column| {
            let column = Quaternion::from(Vector4::from(column));
            (motion.upward * column * motion.aligning).coords
        });
        let first = turned_basis(&motion.aligning, 0);
        let second = turned_basis(&motion.aligning, 1);
        for row in 0..4 {
            self.attitude[row] = columns.map(|column| column[row]);
        }
        for row in 0..3 {
            let mix = |x: f64, y: f64| {
                times_power_of_two(first[row] * x + second[row] * y, motion.exponent)
            };
            self.across[row] = [mix(w[0], w[1]), mix(-w[1], w[0])];
        }
    }
}

/// One lane for what is done once.
type Single = Double<BASELINE>;

/// What gives the functions their sizes: of α at the highest point, of β and W at the lowest.
fn factors(sizes: &[f64; 3], upper: &Values<Single>, lower: &Values<Single>) -> [f64; 3] {
    let size = |[re, im]: [Single; 2]| re.get().hypot(im.get());
    [
        sizes[0] / size(upper[0]),
        sizes[1] / size(lower[1]),
        sizes[2] / size(lower[2]),
    ]
}

fn times_complex(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// z over its size; `None` of zero.
fn direction([re, im]: Complex) -> Option<Complex> {
    let size = re.hypot(im);
    (size > 0.0).then(|| [re / size, im / size])
}

/// The axis of the body that `aligning` takes to the axis `k`.
fn turned_basis(aligning: &Quaternion<f64>, k: usize) -> [f64; 3] {
    let mut axis = Vector4::zeros();
    axis[k] = 1.0;
    let turned = aligning.conjugate() * Quaternion::from(axis) * aligning;
    turned.imag().into()
}
