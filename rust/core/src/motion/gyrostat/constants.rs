//! From the spinor at the start to the numbers that a state is computed from.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::products::Ratios;
use super::products::{GyrostatStart, omega, squares};
use super::propagator::{EndlessArgument, PeriodicArgument, Propagator, TimeArgument};
use super::spinor::{Regime, Spinor};
use super::start::Start;
use super::theta_series::{
    Circular, CircularProducts, Hyperbolic, HyperbolicProducts, Passing, Rational, WithProducts,
};
use crate::motion::attitude::from_axes;
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

type Number = Complex<DoubleDouble>;

/// What grows with time, in units of the rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Secular {
    /// Of ω in the body; infinite where it does not come back, NaN where it does not move.
    pub(super) period: DoubleDouble,
    /// Twice ν: the rate at which the body turns about L while ω comes back, but for whole turns.
    pub(super) precession: DoubleDouble,
}

fn turns_of(radians: DoubleDouble) -> DoubleDouble {
    radians * DoubleDouble::PER_TURN
}

/// ω constant in the body, and so in space: `q(t) = q(0) ∘ (n sin ½|ω|t, cos ½|ω|t)`, n along ω.
pub(super) fn steady_propagator(
    omega: &Vector3<f64>,
    attitude: &UnitQuaternion<f64>,
) -> (Propagator, Secular) {
    let parts = [omega.x, omega.y, omega.z].map(DoubleDouble::from);
    let rate = super::start::dot(&parts, &parts).sqrt();
    let n = if rate.high == 0.0 {
        Vector3::zeros()
    } else {
        omega / rate.high
    };
    let q = attitude.into_inner();
    let turned = q * Quaternion::from_imag(n);
    let propagator = Propagator {
        rate: turns_of(rate).scaled(0.5),
        slope: 0.0,
        clocked: TimeArgument::Circular(
            Circular {
                even: [[0.0; 4]; 3],
                odd: [[0.0; 4]; 4],
            },
            PeriodicArgument {
                rate: DoubleDouble::default(),
                start: DoubleDouble::default(),
            },
        ),
        attitude: [components(&q), components(&turned), [0.0; 4], [0.0; 4]],
        omega: [[omega.x, omega.y, omega.z], [0.0; 3], [0.0; 3], [0.0; 3]],
        reach: f64::INFINITY,
    };
    let secular = Secular {
        period: f64::NAN.into(),
        precession: rate,
    };
    (propagator, secular)
}

fn components(q: &Quaternion<f64>) -> [f64; 4] {
    [q.i, q.j, q.k, q.w]
}

/// Beyond this `Z₀` is infinite but for rounding: its reciprocal is the root of a difference, of twice the precision.
const INFINITE: f64 = 1e13;

/// How x goes with time, what the series of it are, and what turns the spinor beside them.
struct Pace {
    clocked: TimeArgument,
    /// ν in the mean, but for what all bodies have, in the units of the start.
    phase: DoubleDouble,
    /// Turns of the spinor for x = 1.
    slope: f64,
    /// Those that it has at the start, which are to be taken off.
    turned: f64,
    /// In units of the start; infinite where x never returns.
    period: DoubleDouble,
}

/// The motion of a start that is not steady.
pub(super) fn moving_propagator(
    given: &GyrostatStart<'_>,
    start: &Start,
    spinor: &Spinor,
) -> (Propagator, Secular) {
    let unit = start.unit;
    let mut columns = spinor.columns;
    let (pace, omega) = match spinor.regime {
        Regime::Circular => {
            let squares = squares(&columns);
            let plain = omega(given, start, &squares, None);
            let better = given.is_slender().then(|| {
                let ratios = Ratios::by_sines(spinor);
                (ratios, omega(given, start, &squares, Some(&ratios)))
            });
            match better.filter(|(ratios, apart)| ratios.are_better(apart, &plain)) {
                Some((ratios, apart)) => (pace_in_circle(spinor, Some(ratios.sines())), apart),
                None => (pace_in_circle(spinor, None), plain),
            }
        }
        Regime::Hyperbolic => {
            // Z in the middle of its regime has the size one.
            columns[1] = columns[1].map(|x| x.over(spinor.argument));
            if spinor.in_time.is_none() {
                // The first column goes with what the second function is there: see `Passing`.
                let z = spinor.argument;
                let there = z.re.scaled(2.0) / z.norm_squared().sqrt();
                columns[0] = [0, 1].map(|k| columns[0][k] + columns[1][k].times(there));
            }
            let squares = squares(&columns);
            let plain = omega(given, start, &squares, None);
            if let Some(in_time) = spinor.in_time {
                let better = given.is_slender().then(|| {
                    let ratios = Ratios::by_exponentials(spinor);
                    (ratios, omega(given, start, &squares, Some(&ratios)))
                });
                match better.filter(|(ratios, apart)| ratios.are_better(apart, &plain)) {
                    Some((ratios, apart)) => {
                        let products = ratios.exponentials(spinor.is_alternating);
                        (pace_of_returning(spinor, in_time, Some(products)), apart)
                    }
                    None => (pace_of_returning(spinor, in_time, None), plain),
                }
            } else {
                (pace_of_passing(spinor), plain)
            }
        }
        Regime::Rational => (
            pace_on_cusp(spinor),
            omega(given, start, &squares(&columns), None),
        ),
    };
    let propagator = Propagator {
        rate: turns_of(pace.phase),
        slope: pace.slope,
        clocked: pace.clocked,
        attitude: attitude(given, start, &columns, pace.turned),
        omega,
        reach: f64::INFINITY,
    };
    let mut propagator = propagator.in_units_of(unit);
    // In units of the rates already.
    propagator.omega = omega;
    let rate = start.transverse.scaled(0.5) + pace.phase.scaled(unit);
    propagator.rate = turns_of(rate);
    let secular = Secular {
        period: pace.period.scaled(1.0 / unit),
        precession: rate.scaled(2.0),
    };
    (propagator, secular)
}

fn pace_in_circle(spinor: &Spinor, products: Option<CircularProducts>) -> Pace {
    let rate = turns_of(spinor.rate);
    let functions = circular(spinor);
    let clock = PeriodicArgument {
        rate: rate.scaled(spinor.sense),
        start: DoubleDouble::default(),
    };
    Pace {
        clocked: match products {
            None => TimeArgument::Circular(functions, clock),
            Some(products) => {
                let series = WithProducts {
                    functions,
                    products,
                };
                TimeArgument::CircularApart(series, clock)
            }
        },
        phase: spinor.phase,
        slope: 0.0,
        turned: 0.0,
        period: DoubleDouble::from(1.0) / rate,
    }
}

/// On the curve with three equal roots.
fn pace_on_cusp(spinor: &Spinor) -> Pace {
    let curvature = [spinor.argument.re.high, spinor.argument.im.high];
    let clock = EndlessArgument {
        rate: 1.0.into(),
        start: DoubleDouble::default(),
    };
    Pace {
        clocked: TimeArgument::Rational(Rational { curvature }, clock),
        phase: spinor.phase,
        slope: 0.0,
        turned: 0.0,
        period: f64::INFINITY.into(),
    }
}

/// The angle of `Z₀`, and the logarithm of its size.
fn place(spinor: &Spinor) -> (f64, f64) {
    let [x, y] = [spinor.argument.re, spinor.argument.im].map(|part| part.high);
    (y.atan2(x), spinor.argument.size().ln())
}

/// From an equilibrium to the same or to another one.
fn pace_of_passing(spinor: &Spinor) -> Pace {
    let (angle, before) = place(spinor);
    let size = spinor.argument.size();
    let series = Passing {
        wave: [angle.cos(), angle.sin()],
        least: if size > INFINITE {
            0.0
        } else {
            f64::NEG_INFINITY
        },
    };
    let clock = EndlessArgument {
        rate: spinor.rate.scaled(spinor.sense),
        start: DoubleDouble::sum(before, (-before).exp() * size - 1.0),
    };
    Pace {
        clocked: TimeArgument::Endless(series, clock),
        phase: spinor.phase,
        slope: 0.0,
        turned: 0.0,
        period: f64::INFINITY.into(),
    }
}

/// By exponentials and back, with the period and the phase of a motion that returns.
fn pace_of_returning(
    spinor: &Spinor,
    (turn, in_time): (DoubleDouble, DoubleDouble),
    products: Option<HyperbolicProducts>,
) -> Pace {
    let (angle, before) = place(spinor);
    let is_alternating = spinor.is_alternating;
    let step = if is_alternating {
        turn.scaled(0.5)
    } else {
        turn
    };
    let end = 0.5 * (spinor.rate * step).high;
    let from = before / (2.0 * end);
    // What a step turns the spinor by, which is what it does in the mean, but for half turns.
    let square = 2.0 * spinor.sense * angle + if is_alternating { PI } else { 0.0 };
    let by_step = (spinor.phase * step).high + square;
    let halves = ((by_step - (in_time * step).high) / PI).round();
    let phase = if halves % 2.0 == 0.0 {
        in_time
    } else {
        in_time + DoubleDouble::PI / step
    };
    let slope = ((spinor.phase - phase) * step).high / TAU * spinor.sense;
    let rate = DoubleDouble::from(spinor.sense) / step;
    let start = DoubleDouble::from(from);
    let functions = hyperbolic(spinor, angle, end);
    let with = |products| WithProducts {
        functions,
        products,
    };
    Pace {
        clocked: match (products.map(with), is_alternating) {
            (None, false) => TimeArgument::Hyperbolic(functions, PeriodicArgument { rate, start }),
            (None, true) => TimeArgument::Alternating(functions, PeriodicArgument { rate, start }),
            (Some(series), false) => {
                TimeArgument::HyperbolicApart(series, PeriodicArgument { rate, start })
            }
            (Some(series), true) => {
                TimeArgument::AlternatingApart(series, PeriodicArgument { rate, start })
            }
        },
        phase,
        slope,
        turned: -slope * from,
        period: turn,
    }
}

fn hyperbolic(spinor: &Spinor, angle: f64, end: f64) -> Hyperbolic {
    let nome = spinor.nome.high;
    let size = nome.abs();
    let sign = if spinor.is_alternating { -1.0_f64 } else { 1.0 };
    let wave = |n: i32| {
        let phase = f64::from(n) * angle;
        [phase.cos(), phase.sin()]
    };
    Hyperbolic {
        even: [1, 2, 3].map(|j| {
            let weight = sign.powi(j) * size.powi(j * j - j);
            wave(2 * j).map(|x| weight * x)
        }),
        odd: [0, 1, 2, 3].map(|j| {
            let weight = size.powi(j * j);
            wave(2 * j + 1).map(|x| weight * x)
        }),
        unit: 2.0 * end,
        end,
    }
}

fn circular(spinor: &Spinor) -> Circular {
    let nome = spinor.nome;
    let y = spinor.start;
    let y_next = if nome.high == 0.0 {
        Complex::zero()
    } else {
        Complex::new(nome, DoubleDouble::default()).over(y)
    };
    let [down, up] = [y, y_next].map(|x| Complex::new(x.re.high, x.im.high));
    let q = nome.high;
    let power = |x: Complex<f64>, n: i32| (0..n).fold(Complex::one(), |p, _| p * x);
    let pair = |a: Complex<f64>, b: Complex<f64>| {
        let (sum, difference) = (a + b, (a - b).times_i());
        [sum.re, sum.im, difference.re, difference.im]
    };
    Circular {
        even: [1, 2, 3].map(|j| {
            pair(
                power(up, j).times(q.powi(j * j - j)),
                power(down, j).times(q.powi(j * j)),
            )
        }),
        odd: [0, 1, 2, 3].map(|j| {
            pair(
                power(up, j).times(q.powi(j * j)),
                power(down, j + 1).times(q.powi(j * (j + 1))),
            )
        }),
    }
}

/// From the two theta functions to the attitude: `q_NM ∘ (Im χ₂, −Re χ₂, Im χ₁, Re χ₁) ∘ q_FB`, the spinor turned by so many
/// turns.
fn attitude(
    given: &GyrostatStart<'_>,
    start: &Start,
    columns: &[[Number; 2]; 2],
    turned: f64,
) -> [[f64; 4]; 4] {
    let rows = (start.frame).map(|axis| given.principal.in_body(&axis).map(DoubleDouble::rounded));
    let q_FB = from_axes(&Matrix3::from(rows).transpose()).into_inner();
    let q_NM = given.attitude.into_inner() * q_FB.conjugate();
    let (sine, cosine) = (TAU * turned).sin_cos();
    let mut images = [[0.0; 4]; 4];
    for (k, column) in columns.iter().enumerate() {
        let [first, second] =
            column.map(|x| Complex::new(x.re.high, x.im.high) * Complex::new(cosine, sine));
        for (part, [a, b]) in [[first, second], [first.times_i(), second.times_i()]]
            .into_iter()
            .enumerate()
        {
            let q = Quaternion::new(a.re, b.im, -b.re, a.im);
            images[2 * k + part] = components(&(q_NM * q * q_FB));
        }
    }
    images
}
