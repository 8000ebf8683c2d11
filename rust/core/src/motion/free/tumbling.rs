//! The asymmetric body: from moments and ω at the start to the constants of the theta functions.
//!
//! x, y, z are the principal axes with z the one that L circles: axis 3 in short-axis mode, axis 1 in long-axis mode, and
//! y always axis 2. With `D_z = |2T I_z − L²|`, `D_x = |L² − 2T I_x|`, `D_y = |L² − 2T I_y|`, all sums of terms of one sign
//! but for the last, and s = +1 in short-axis, −1 in long-axis mode,
//!
//! - `ω = (a_x cn u, s a_y sn u, a_z dn u)`, `u = λt + u₀`,
//! - `a_x² = D_z/(I_x |I_z − I_x|)`, `a_y² = D_z/(I_y |I_z − I_y|)`, `a_z² = D_x/(I_z |I_z − I_x|)`,
//! - `λ² = |I_z − I_y| D_x/(I_x I_y I_z)`, `k² = |I_y − I_x| D_z/(|I_z − I_y| D_x)`,
//!   `k′² = |I_z − I_x| D_y/(|I_z − I_y| D_x)`.
//!
//! The directions of x and z are those in which `ω_x` and `ω_z` start positive. Derivation: the page on motion.

use nalgebra::{Matrix3, UnitQuaternion};

use super::mode::Mode;
use super::propagator::Secular;
use super::propagator::{AnySeries, Circular, EllipticArgument, Hyperbolic, Propagator};
use super::separation::{Separation, Unit};
use crate::mass::refined::Vector;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::{complete_first, complete_third, incomplete_first};
use crate::numerics::lane::{BASELINE, Double, Lane};
use crate::numerics::theta::{HalfPeriods, circular, hyperbolic};

/// Sines serve while K′ ≥ this times K: there both kinds of series converge alike.
const CIRCULAR: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The constants of the motion in its own axes x, y, z.
#[derive(Clone, Copy, Debug)]
pub(super) struct TumblingMotion {
    pub(super) mode: Mode,
    /// Which principal axes x, y, z are.
    axes: [usize; 3],
    /// Their directions.
    signs: [f64; 3],
    /// s.
    sense: f64,
    /// `a_x`, `a_y`, `a_z`.
    amplitudes: [f64; 3],
    /// `(L_x, L_y, L_z)/L` at their largest.
    directions: [f64; 3],
    /// λ.
    rate: DoubleDouble,
    /// k and k′.
    modulus: f64,
    complementary: DoubleDouble,
    /// `p − 1 = I_z |I_y − I_x|/(I_x |I_z − I_y|)`, of `1 − L_z²/L² ∝ 1 + (p − 1) sn² u`.
    excess: f64,
    /// K; infinite on the separatrix.
    quarter: DoubleDouble,
    /// The mean rate of precession about L.
    precession: DoubleDouble,
    /// Sine and cosine of am u₀, the cosine not negative.
    start: [f64; 2],
}

impl TumblingMotion {
    /// Of distinct moments and an ω that is along none of their axes.
    pub(super) fn of(moments: &Vector, w: &Vector, separation: &Separation) -> Self {
        // L² − 2T I₂ in units of the larger of ω₁ and ω₃, and its like below: tiny rates keep their digits.
        let (difference, middle) = (separation.size, separation.unit);
        let (mode, axes, sense) = if difference.high < 0.0 {
            (Mode::LongAxis, [2, 1, 0], -1.0)
        } else if difference.high == 0.0 {
            (Mode::Separatrix, [0, 1, 2], 1.0)
        } else {
            (Mode::ShortAxis, [0, 1, 2], 1.0)
        };
        let [x, y, z] = axes;
        let [jx, jy, jz] = axes.map(|k| moments[k]);
        let (zx, zy, yx) = ((jz - jx).abs(), (jz - jy).abs(), (jy - jx).abs());
        let (across, along) = (Unit::of(w[x], w[y]), Unit::of(w[y], w[z]));
        let dz = (jx * zx * across.square(w[x]) + jy * zy * across.square(w[y])).high;
        let dx = jy * yx * along.square(w[y]) + jz * zx * along.square(w[z]);
        let volume = jx * jy * jz;
        let rate = (zy * dx / volume).sqrt().scaled(along.size);
        let complementary = (zx * difference.abs() / (zy * dx))
            .sqrt()
            .scaled(middle / along.size);
        let modulus = (yx.high * dz / (zy.high * dx.high)).sqrt() * (across.size / along.size);
        let momentum = hypotenuse(&[jx * w[x], jy * w[y], jz * w[z]]);
        let amplitudes = [
            (dz / (jx * zx).high).sqrt() * across.size,
            (dz / (jy * zy).high).sqrt() * across.size,
            (dx.high / (jz * zx).high).sqrt() * along.size,
        ];
        let (quarter, precession) = if mode == Mode::Separatrix {
            (f64::INFINITY.into(), momentum / jy)
        } else {
            // (L/I_x) ∫ (cn² + (I_x p/I_y) sn²)/(cn² + p sn²) du over K, p = I_y |I_z − I_x|/(I_x |I_z − I_y|).
            let weight = zx / zy;
            let p = jy * zx / (jx * zy);
            let (first, third) = complete_third(complementary, p, 1.0.into(), weight);
            (first, momentum * third / (jx * first))
        };
        let sign = |k: usize| if w[k].high < 0.0 { -1.0 } else { 1.0 };
        // (3, 2, 1) is left-handed, so there y is the other way.
        let signs = [sign(x), sense * sign(x) * sign(z), sign(z)];
        let sine = sense * signs[1] * w[y].high / amplitudes[1];
        let cosine = w[x].high.abs() / amplitudes[0];
        let size = sine.hypot(cosine);
        Self {
            mode,
            axes,
            signs,
            sense,
            amplitudes,
            directions: [0, 1, 2].map(|k| [jx, jy, jz][k].high * amplitudes[k] / momentum.high),
            rate,
            modulus: modulus.min(1.0),
            complementary,
            excess: (jz * yx / (jx * zy)).high,
            quarter,
            precession,
            start: [sine / size, cosine / size],
        }
    }

    /// The motion with this attitude at the start; `axes`: the principal axes as columns.
    pub(super) fn motion(
        &self,
        axes: &Matrix3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> (Propagator, Secular) {
        let columns = [0, 1, 2].map(|k| axes.column(self.axes[k]) * self.signs[k]);
        let [ax, ay, az] = self.amplitudes;
        let (series, ratio) = self.series();
        let full_period = self.quarter.scaled(4.0) / self.rate;
        let clock = if self.mode == Mode::Separatrix {
            let [sine, cosine] = self.start;
            EllipticArgument::Endless {
                rate: self.rate.high,
                start: (sine / cosine).asinh(),
            }
        } else {
            EllipticArgument::Periodic {
                rate: self.rate / self.quarter.scaled(4.0),
                start: (0.5 * self.start_of_clock()).into(),
            }
        };
        // Half of μ − χ; χ gains s π in half a period.
        let circling = match clock {
            EllipticArgument::Periodic { rate, .. } => rate,
            EllipticArgument::Endless { .. } => DoubleDouble::default(),
        };
        let circling = if self.sense < 0.0 {
            -circling
        } else {
            circling
        };
        let turns = self.precession * DoubleDouble::PER_TURN;
        let propagator = Propagator {
            rate: (turns - circling).scaled(0.5),
            clock,
            series,
            sense: self.sense,
            ratio,
            attitude: [[0.0; 4]; 4],
            omega: [
                (columns[1] * (self.sense * ay)).into(),
                (columns[0] * ax).into(),
                (columns[2] * az).into(),
            ],
            reach: f64::INFINITY,
        }
        .starting_at(attitude, &Matrix3::from_columns(&columns));
        let secular = Secular {
            half_period: if self.mode == Mode::Separatrix {
                f64::INFINITY.into()
            } else {
                full_period.scaled(0.5)
            },
            mean_precession: self.precession,
            modulus: self.modulus,
            complementary_modulus: self.complementary.high.min(1.0),
        };
        (propagator, secular)
    }

    /// u₀/2K, from the nearer end of the quarter period, so that its error is relative to the smaller distance.
    fn start_of_clock(&self) -> f64 {
        let [sine, cosine] = self.start;
        let (k_prime, quarter) = (self.complementary.high, self.quarter.high);
        // tan am u · tan am(K − u) = 1/k′.
        let (far, near) = (cosine, sine.abs() * k_prime);
        if far > near {
            return incomplete_first(sine, cosine, k_prime) / (2.0 * quarter);
        }
        let size = far.hypot(near);
        let rest = incomplete_first(far / size, near / size, k_prime) / (2.0 * quarter);
        (0.5 - rest).copysign(sine)
    }

    /// The theta functions, and |β|/|α| where they have the same magnitude.
    ///
    /// `α ∝ T(u − isη′)` and `β ∝ e^{isπu/2K} T(u + is(2K′ − η′))`, T the Θ with the half periods K and 2iK′, where
    /// η′ is the u of sc(u, k′) = 1/√(p − 1). At u = K, `|β|/|α| = (L_y/L)/(1 + k′ L_z/L)`.
    fn series(&self) -> (AnySeries, f64) {
        let p = 1.0 + self.excess;
        let (sine, cosine) = ((1.0 / p).sqrt(), (self.excess / p).sqrt());
        let d = incomplete_first(sine, cosine, self.modulus);
        let quarter = self.quarter.high;
        let imaginary = if self.modulus == 0.0 {
            f64::INFINITY
        } else {
            complete_first(self.modulus)
        };
        let half = HalfPeriods {
            real: quarter,
            imaginary: 2.0 * imaginary,
        };
        let size = |(re, im): (Double<BASELINE>, Double<BASELINE>)| re.get().hypot(im.get());
        let one = Double::<BASELINE>::new(1.0);
        let [_, b, c] = self.directions;
        let at_end = b / (1.0 + self.complementary.high * c);
        let pi = std::f64::consts::PI;
        if imaginary >= CIRCULAR * quarter {
            let series = Circular {
                jacobi: circular::Jacobi::new((-pi * imaginary / quarter).exp()),
                alpha: if imaginary.is_infinite() {
                    circular::Shifted::single(0.0)
                } else {
                    circular::Shifted::near_axis(half, -d)
                },
                beta: if imaginary.is_infinite() {
                    circular::Shifted::single((-pi * d / quarter).exp())
                } else {
                    circular::Shifted::near_zero(half, d)
                },
            };
            let end = circular::Argument::new(one, Double::new(0.0));
            let ratio = at_end * size(series.alpha.value(&end)) / size(series.beta.value(&end));
            return (AnySeries::Circular(series), ratio);
        }
        let end = pi * quarter / (2.0 * imaginary);
        let alpha = hyperbolic::Shifted::near_axis(half, -d);
        let beta = hyperbolic::Shifted::near_zero(half, d);
        let g = Double::new((-end).exp());
        let ratio = at_end * size(alpha.value(g, one, one)) / size(beta.value(g, one, one));
        let is_endless = self.mode == Mode::Separatrix;
        let series = Hyperbolic {
            jacobi: hyperbolic::Jacobi::new((-pi * quarter / imaginary).exp()),
            alpha,
            beta,
            unit: if is_endless {
                pi / (2.0 * imaginary)
            } else {
                2.0 * end
            },
            end,
            slope: if is_endless {
                0.0
            } else {
                2.0 * quarter * alpha.slope()
            },
        };
        (AnySeries::Hyperbolic(series), ratio)
    }
}

/// `√(a² + b² + c²)` without leaving the range of float64.
pub(super) fn hypotenuse(numbers: &Vector) -> DoubleDouble {
    let largest = (numbers.iter()).fold(0.0, |largest: f64, number| largest.max(number.high.abs()));
    if largest == 0.0 {
        return DoubleDouble::default();
    }
    let (scale, back) = Double::<BASELINE>::new(largest).power_of_two_scale();
    let [a, b, c] = numbers.map(|number| number.scaled(scale.get()));
    (a * a + b * b + c * c).sqrt().scaled(back.get())
}
