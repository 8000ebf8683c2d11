//! From the spinor at the start to the numbers that a state is computed from.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::propagator::{
    Circular, Clocked, Endless, Hyperbolic, Passing, Propagator, Rational, Round,
};
use super::spinor::{Regime, Spinor};
use super::start::Start;
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::motion::attitude::from_axes;
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

type Number = Complex<DoubleDouble>;

/// What a motion is made from, in the units of the start.
pub(super) struct Given<'a> {
    /// Principal moments.
    pub(super) moments: &'a Vector,
    /// h along the principal axes.
    pub(super) rotor: &'a Vector,
    pub(super) principal: &'a RefinedPrincipal,
    pub(super) attitude: &'a UnitQuaternion<f64>,
}

/// What grows with time, in units of the rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Secular {
    /// Of ω in the body; infinite where it does not come back or does not move.
    pub(super) period: DoubleDouble,
    /// Twice ν: the rate at which the body turns about L while ω comes back, but for whole turns.
    pub(super) precession: DoubleDouble,
}

fn turns_of(radians: DoubleDouble) -> DoubleDouble {
    radians * DoubleDouble::PER_TURN
}

/// ω constant in the body, and so in space: `q(t) = q(0) ∘ (n sin ½|ω|t, cos ½|ω|t)`, n along ω.
pub(super) fn steady(
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
        clocked: Clocked::Circular(
            Circular {
                even: [[0.0; 4]; 3],
                odd: [[0.0; 4]; 4],
            },
            Round {
                rate: DoubleDouble::default(),
                start: DoubleDouble::default(),
            },
        ),
        attitude: [components(&q), components(&turned), [0.0; 4], [0.0; 4]],
        omega: [[omega.x, omega.y, omega.z], [0.0; 3], [0.0; 3], [0.0; 3]],
        reach: f64::INFINITY,
    };
    let secular = Secular {
        period: f64::INFINITY.into(),
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
    clocked: Clocked,
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
pub(super) fn moving(given: &Given<'_>, start: &Start, spinor: &Spinor) -> (Propagator, Secular) {
    let unit = start.unit;
    let mut columns = spinor.columns;
    let pace = match spinor.regime {
        Regime::Circular => circling(spinor),
        Regime::Hyperbolic => {
            // Z in the middle of its regime has the size one.
            columns[1] = columns[1].map(|x| x.over(spinor.argument));
            if spinor.in_time.is_none() {
                // The first column goes with what the second function is there: see `Passing`.
                let z = spinor.argument;
                let there = z.re.scaled(2.0) / z.norm_squared().sqrt();
                columns[0] = [0, 1].map(|k| columns[0][k] + columns[1][k].times(there));
            }
            passing(spinor)
        }
        Regime::Rational => Pace {
            clocked: Clocked::Rational(
                Rational {
                    curvature: [spinor.argument.re.high, spinor.argument.im.high],
                },
                Endless {
                    rate: 1.0.into(),
                    start: DoubleDouble::default(),
                },
            ),
            phase: spinor.phase,
            slope: 0.0,
            turned: 0.0,
            period: f64::INFINITY.into(),
        },
    };
    let propagator = Propagator {
        rate: turns_of(pace.phase),
        slope: pace.slope,
        clocked: pace.clocked,
        attitude: attitude(given, start, &columns, pace.turned),
        omega: omega(given, start, &columns),
        reach: f64::INFINITY,
    };
    // ω is in units of the rates already.
    let omega = propagator.omega;
    let mut propagator = propagator.in_units_of(unit);
    propagator.omega = omega;
    let rate = start.transverse.scaled(0.5) + pace.phase.scaled(unit);
    propagator.rate = turns_of(rate);
    let secular = Secular {
        period: pace.period.scaled(1.0 / unit),
        precession: rate.scaled(2.0),
    };
    (propagator, secular)
}

fn circling(spinor: &Spinor) -> Pace {
    let rate = turns_of(spinor.rate);
    Pace {
        clocked: Clocked::Circular(
            circular(spinor),
            Round {
                rate: rate.scaled(spinor.sense),
                start: DoubleDouble::default(),
            },
        ),
        phase: spinor.phase,
        slope: 0.0,
        turned: 0.0,
        period: DoubleDouble::from(1.0) / rate,
    }
}

fn passing(spinor: &Spinor) -> Pace {
    let angle = spinor.argument.im.high.atan2(spinor.argument.re.high);
    let before = spinor.argument.size().ln();
    let Some((turn, in_time)) = spinor.in_time else {
        return Pace {
            clocked: Clocked::Endless(
                Passing {
                    wave: [angle.cos(), angle.sin()],
                    least: if spinor.argument.size() > INFINITE {
                        0.0
                    } else {
                        f64::NEG_INFINITY
                    },
                },
                Endless {
                    rate: spinor.rate.scaled(spinor.sense),
                    start: DoubleDouble::sum(
                        before,
                        (-before).exp() * spinor.argument.size() - 1.0,
                    ),
                },
            ),
            phase: spinor.phase,
            slope: 0.0,
            turned: 0.0,
            period: f64::INFINITY.into(),
        };
    };
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
    let (rate, start) = (
        DoubleDouble::from(spinor.sense) / step,
        DoubleDouble::from(from),
    );
    let series = hyperbolic(spinor, angle, 2.0 * end, end);
    Pace {
        clocked: if is_alternating {
            Clocked::Alternating(series, Round { rate, start })
        } else {
            Clocked::Hyperbolic(series, Round { rate, start })
        },
        phase,
        slope,
        turned: -slope * from,
        period: turn,
    }
}

fn hyperbolic(spinor: &Spinor, angle: f64, unit: f64, end: f64) -> Hyperbolic {
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
        unit,
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
    given: &Given<'_>,
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

/// From the products of the two theta functions to D ω: `ω_i = (|L| n_i − h_i)/I_i` along the principal axes, `D n = χ†σχ`.
fn omega(given: &Given<'_>, start: &Start, columns: &[[Number; 2]; 2]) -> [[f64; 3]; 4] {
    let [u, v] = columns;
    let two = |x: DoubleDouble| x.scaled(2.0);
    // u†σv and u†v.
    let product = |u: &[Number; 2], v: &[Number; 2]| {
        let [a, b] = u.map(Complex::conjugate);
        let (ab, ba) = (a * v[1], b * v[0]);
        let (aa, bb) = (a * v[0], b * v[1]);
        [ab + ba, (ba - ab).times_i(), aa - bb, aa + bb]
    };
    let (uu, vv, uv) = (product(u, u), product(v, v), product(u, v));
    // 2 Re (Θ̄ₑΘₒ u†σv).
    let rows = [
        uu.map(|x| x.re),
        vv.map(|x| x.re),
        uv.map(|x| two(x.re)),
        uv.map(|x| -two(x.im)),
    ];
    rows.map(|[x, y, z, square]| {
        let along: Vector = std::array::from_fn(|i| {
            let [e1, e2, n] = start.frame.map(|axis| axis[i]);
            let sum = start.momentum * (x * e1 + y * e2 + z * n) - given.rotor[i] * square;
            sum / given.moments[i]
        });
        given.principal.in_body(&along).map(DoubleDouble::rounded)
    })
}
