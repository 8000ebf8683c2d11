//! The state at any time from a few constants: two theta functions for the attitude, Jacobi's functions for ω; and the constants that
//! multiply the time.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

use crate::motion::closed_form::{ChooseFormula, StateFormula, UseFormula, at, combine};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::Lane;
use crate::numerics::theta::{circular, hyperbolic};
use crate::numerics::turns::{reach, sin_cos_turns, turns, whole_off};

/// The Cayley–Klein parameters but for phase and norm, and Jacobi's functions, of x = u/2K, |x| ≤ ½.
pub(super) trait FreeSeries {
    /// Phase in turns that both parameters still lack, `α′`, `β′` and (sn, cn, dn).
    fn values<L: Lane>(&self, x: L) -> Values<L>;
}

/// What [`FreeSeries`] gives.
pub(super) struct Values<L> {
    phase: L,
    alpha: (L, L),
    beta: (L, L),
    jacobi: [L; 3],
}

/// By sines and cosines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Circular {
    pub(super) jacobi: circular::Jacobi,
    pub(super) alpha: circular::Shifted<3>,
    pub(super) beta: circular::Shifted<3>,
}

impl FreeSeries for Circular {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L) -> Values<L> {
        let (sine, cosine) = sin_cos_turns(x * L::new(0.5));
        let z = circular::Argument::new(sine, cosine);
        let beta = self.beta.value(&z);
        Values {
            phase: L::new(0.0),
            alpha: self.alpha.value(&z),
            beta: (
                beta.0 * cosine - beta.1 * sine,
                beta.0 * sine + beta.1 * cosine,
            ),
            jacobi: self.jacobi.values(&z),
        }
    }
}

/// By hyperbolic functions; on the separatrix x is u itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hyperbolic {
    pub(super) jacobi: hyperbolic::Jacobi,
    pub(super) alpha: hyperbolic::Shifted<5>,
    pub(super) beta: hyperbolic::Shifted<5>,
    /// πu/2K′ for x = 1.
    pub(super) unit: f64,
    /// πK/2K′.
    pub(super) end: f64,
    /// Turns of phase for x = 1.
    pub(super) slope: f64,
}

impl FreeSeries for Hyperbolic {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L) -> Values<L> {
        let u = hyperbolic::Argument::new(x * L::new(self.unit), L::new(self.end));
        let (g, y) = (u.from_middle, u.from_end);
        Values {
            phase: x * L::new(self.slope),
            alpha: self.alpha.value(g, y, u.sign),
            beta: self.beta.value(g, y, u.sign),
            jacobi: self.jacobi.values(&u),
        }
    }
}

/// Either series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AnySeries {
    Circular(Circular),
    Hyperbolic(Hyperbolic),
}

/// How u grows with time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum EllipticArgument {
    /// Full periods 4K of u for a unit of time, and the part of one at t = 0.
    Periodic {
        rate: DoubleDouble,
        start: DoubleDouble,
    },
    /// u itself, where the period is infinite: its rate, and its value at t = 0.
    Endless { rate: f64, start: f64 },
}

/// All that a state takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Propagator {
    /// Turns of α for a unit of time.
    pub(super) rate: DoubleDouble,
    pub(super) clock: EllipticArgument,
    pub(super) series: AnySeries,
    /// +1 where ω and the precession turn the same way about the axis circled, else −1.
    pub(super) sense: f64,
    /// |β|/|α| where |β′| = |α′|.
    pub(super) ratio: f64,
    /// From (Im β, Re β, Im α, Re α) to the components (x, y, z, w) of the attitude.
    pub(super) attitude: [[f64; 4]; 4],
    /// From (sn, cn, dn) to ω in B.
    pub(super) omega: [[f64; 3]; 3],
    /// Beyond this |t| nothing is known of the phases.
    pub(super) reach: f64,
}

impl Propagator {
    /// The propagator whose state at t = 0 has this attitude. The propagator is multiplied from the left by the constant rotation that
    /// gives this attitude at t = 0.
    ///
    /// `axes`: those of P as columns, components in B, a rotation.
    #[must_use]
    pub(super) fn starting_at(
        mut self,
        attitude: &UnitQuaternion<f64>,
        axes: &Matrix3<f64>,
    ) -> Self {
        self.attitude = [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        let q_MP = at(&self, 0.0).attitude.into_inner();
        let q_PB = crate::motion::attitude::from_axes(&axes.transpose()).into_inner();
        let q_NM = attitude.into_inner() * (q_MP * q_PB).conjugate();
        for (row, unit) in [
            Quaternion::new(0.0, 1.0, 0.0, 0.0),
            Quaternion::new(0.0, 0.0, -1.0, 0.0),
            Quaternion::new(0.0, 0.0, 0.0, 1.0),
            Quaternion::new(1.0, 0.0, 0.0, 0.0),
        ]
        .into_iter()
        .enumerate()
        {
            let image = q_NM * unit * q_PB;
            self.attitude[row] = [image.i, image.j, image.k, image.w];
        }
        self
    }

    /// The same motion where a unit of the rates is `rate_unit`, a power of two.
    pub(super) fn in_units_of(mut self, rate_unit: f64) -> Self {
        self.rate = self.rate.scaled(rate_unit);
        self.clock = match self.clock {
            EllipticArgument::Periodic { rate, start } => EllipticArgument::Periodic {
                rate: rate.scaled(rate_unit),
                start,
            },
            EllipticArgument::Endless { rate, start } => EllipticArgument::Endless {
                rate: rate * rate_unit,
                start,
            },
        };
        self.omega = self.omega.map(|column| column.map(|x| x * rate_unit));
        self.reach = match self.clock {
            EllipticArgument::Periodic { rate, .. } => reach(&[self.rate, rate]),
            EllipticArgument::Endless { .. } => reach(&[self.rate]),
        };
        self
    }

    /// (x, y, z, w) of the attitude and ω in B.
    #[inline(always)]
    fn state<L: Lane, const ENDLESS: bool>(&self, series: &impl FreeSeries, t: L) -> [L; 7] {
        let (one, two) = (L::new(1.0), L::new(2.0));
        let is_known = t.abs() <= L::new(self.reach);
        let t = if is_known { t } else { L::new(f64::NAN) };
        let (x, sign) = match self.clock {
            EllipticArgument::Periodic { rate, start } if !ENDLESS => {
                let halves = two * turns(t, rate, start);
                let whole = halves.round();
                (halves - whole, one - two * whole.abs())
            }
            EllipticArgument::Endless { rate, start } => {
                (t.mul_add(L::new(rate), L::new(start)), one)
            }
            EllipticArgument::Periodic { .. } => (t, one),
        };
        let Values {
            phase,
            alpha,
            beta,
            jacobi: [sn, cn, dn],
        } = series.values(x);
        let sense = L::new(self.sense);
        let phase = whole_off(sense.mul_add(phase, turns(t, self.rate, DoubleDouble::default())));
        let (sine, cosine) = sin_cos_turns(phase);
        let (alpha_re, alpha_im) = (alpha.0, sense * alpha.1);
        let ratio = sign * L::new(self.ratio);
        let (beta_re, beta_im) = (ratio * beta.0, ratio * sense * beta.1);
        let size =
            alpha_re * alpha_re + alpha_im * alpha_im + beta_re * beta_re + beta_im * beta_im;
        let norm = one / size.sqrt();
        let (c, s) = (cosine * norm, sine * norm);
        let numbers = [
            beta_re * s + beta_im * c,
            beta_re * c - beta_im * s,
            alpha_re * s + alpha_im * c,
            alpha_re * c - alpha_im * s,
        ];
        let [x, y, z, w] = combine(&self.attitude, numbers);
        let [p, q, r] = combine(&self.omega, [sign * sn, sign * cn, dn]);
        [x, y, z, w, p, q, r]
    }
}

impl ChooseFormula for Propagator {
    #[inline(always)]
    fn choose<U: UseFormula>(&self, then: U) -> U::Output {
        let is_endless = matches!(self.clock, EllipticArgument::Endless { .. });
        match self.series {
            AnySeries::Circular(series) => then.with(&ChosenSeries::<_, false>(self, series)),
            AnySeries::Hyperbolic(series) if is_endless => {
                then.with(&ChosenSeries::<_, true>(self, series))
            }
            AnySeries::Hyperbolic(series) => then.with(&ChosenSeries::<_, false>(self, series)),
        }
    }
}

/// A propagator with its series, and whether its clock is endless.
struct ChosenSeries<'a, S, const ENDLESS: bool>(&'a Propagator, S);

impl<S: FreeSeries, const ENDLESS: bool> StateFormula for ChosenSeries<'_, S, ENDLESS> {
    #[inline(always)]
    fn state<L: Lane>(&self, t: L) -> [L; 7] {
        self.0.state::<L, ENDLESS>(&self.1, t)
    }
}

/// What grows with time, and the modulus; in units of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Secular {
    /// The time after which ω has the opposite signs across the axis circled: half of the period 4K/λ of ω in the body.
    /// Infinite where ω circles nothing.
    pub half_period: DoubleDouble,
    /// Mean rate in radians at which the body precesses about L, `μ̇` over a period; of a spin |ω|.
    pub mean_precession: DoubleDouble,
    /// The modulus k of Jacobi's functions.
    pub modulus: f64,
    /// `k′ = √(1 − k²)`, with all its digits near the separatrix.
    pub complementary_modulus: f64,
}

impl Secular {
    pub(super) fn in_units_of(self, rate_unit: f64) -> Self {
        Self {
            half_period: self.half_period.scaled(1.0 / rate_unit),
            mean_precession: self.mean_precession.scaled(rate_unit),
            ..self
        }
    }
}
