//! The state at any time from a few constants: two theta functions for the attitude, Jacobi's functions for ω.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

use crate::numerics::dispatch::Kernel;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::Lane;
use crate::numerics::planes::{Planes, ROWS};
use crate::numerics::theta::{circular, hyperbolic};
use crate::numerics::turns::{reach, sin_cos_turns, turns, whole_off};

/// The Cayley–Klein parameters but for phase and norm, and Jacobi's functions, of x = u/2K, |x| ≤ ½.
pub(super) trait Series {
    /// Phase in turns that both parameters still lack, `α′`, `β′` and (sn, cn, dn).
    fn values<L: Lane>(&self, x: L) -> Values<L>;
}

/// What [`Series`] gives.
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

impl Series for Circular {
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

impl Series for Hyperbolic {
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
pub(super) enum Clock {
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
    pub(super) clock: Clock,
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
    /// The propagator whose state at t = 0 has this attitude: `q_MP` as computed is turned on its left to agree.
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
        let [x, y, z, w, ..] = crate::numerics::dispatch::dispatch(At {
            propagator: &self,
            time: 0.0,
        });
        let q_PB = crate::motion::attitude::from_axes(&axes.transpose()).into_inner();
        let q_MP = Quaternion::new(w, x, y, z);
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
            Clock::Periodic { rate, start } => Clock::Periodic {
                rate: rate.scaled(rate_unit),
                start,
            },
            Clock::Endless { rate, start } => Clock::Endless {
                rate: rate * rate_unit,
                start,
            },
        };
        self.omega = self.omega.map(|column| column.map(|x| x * rate_unit));
        self.reach = match self.clock {
            Clock::Periodic { rate, .. } => reach(&[self.rate, rate]),
            Clock::Endless { .. } => reach(&[self.rate]),
        };
        self
    }

    /// (x, y, z, w) of the attitude and ω in B.
    #[inline(always)]
    fn state<L: Lane, const ENDLESS: bool>(&self, series: &impl Series, t: L) -> [L; 7] {
        let (one, two) = (L::new(1.0), L::new(2.0));
        let is_known = t.abs() <= L::new(self.reach);
        let t = if is_known { t } else { L::new(f64::NAN) };
        let (x, sign) = match self.clock {
            Clock::Periodic { rate, start } if !ENDLESS => {
                let halves = two * turns(t, rate, start);
                let whole = halves.round();
                (halves - whole, one - two * whole.abs())
            }
            Clock::Endless { rate, start } => (t.mul_add(L::new(rate), L::new(start)), one),
            Clock::Periodic { .. } => (t, one),
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

/// Σ `numbers[k]` `columns[k]`.
#[inline(always)]
fn combine<L: Lane, const N: usize>(columns: &[[f64; N]; N], numbers: [L; N]) -> [L; N] {
    let mut sums = [L::new(0.0); N];
    let mut i = 0;
    while i < N {
        let mut sum = L::new(columns[0][i]) * numbers[0];
        let mut k = 1;
        while k < N {
            sum = L::new(columns[k][i]).mul_add(numbers[k], sum);
            k += 1;
        }
        sums[i] = sum;
        i += 1;
    }
    sums
}

/// The state at one time.
pub(super) struct At<'a> {
    pub(super) propagator: &'a Propagator,
    pub(super) time: f64,
}

impl Kernel for At<'_> {
    type Output = [f64; 7];

    #[inline(always)]
    fn run<L: Lane>(self) -> [f64; 7] {
        let (propagator, t) = (self.propagator, L::new(self.time));
        let is_endless = matches!(propagator.clock, Clock::Endless { .. });
        match &propagator.series {
            AnySeries::Circular(series) => propagator.state::<L, false>(series, t),
            AnySeries::Hyperbolic(series) if is_endless => propagator.state::<L, true>(series, t),
            AnySeries::Hyperbolic(series) => propagator.state::<L, false>(series, t),
        }
        .map(L::get)
    }
}

/// The states at many times.
pub(super) struct Sample<'a> {
    pub(super) propagator: &'a Propagator,
    pub(super) times: &'a [f64],
    pub(super) attitudes: &'a mut [[f64; 4]],
    pub(super) omegas: &'a mut [[f64; 3]],
}

impl Kernel for Sample<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let propagator = *self.propagator;
        let is_endless = matches!(propagator.clock, Clock::Endless { .. });
        match propagator.series {
            AnySeries::Circular(series) => self.all::<L, false>(&propagator, &series),
            AnySeries::Hyperbolic(series) if is_endless => {
                self.all::<L, true>(&propagator, &series);
            }
            AnySeries::Hyperbolic(series) => self.all::<L, false>(&propagator, &series),
        }
    }
}

impl Sample<'_> {
    #[inline(always)]
    fn all<L: Lane, const ENDLESS: bool>(self, propagator: &Propagator, series: &impl Series) {
        let mut states = Planes::<7>::ZERO;
        let mut times = Planes::<1>::ZERO;
        let rows = (self.times.chunks(ROWS))
            .zip(self.attitudes.chunks_mut(ROWS))
            .zip(self.omegas.chunks_mut(ROWS));
        for ((batch, attitudes), omegas) in rows {
            for (row, &t) in batch.iter().enumerate() {
                times.set(row, [t]);
            }
            for row in 0..ROWS {
                let [t] = times.lanes::<L>(row);
                states.set_lanes(row, propagator.state::<L, ENDLESS>(series, t));
            }
            write(&states, attitudes, omegas);
        }
    }
}

/// From planes to rows; outside the kernel, where the compiler would scatter.
#[inline(never)]
fn write(states: &Planes<7>, attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
    for (row, (attitude, omega)) in attitudes.iter_mut().zip(omegas).enumerate().take(ROWS) {
        *attitude = states.get(row, 0);
        *omega = states.get(row, 4);
    }
}
