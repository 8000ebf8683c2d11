//! The state at any time from a few constants: two theta functions for the attitude and ω alike.

use super::theta_series::{
    Circular, CircularProducts, Hyperbolic, HyperbolicProducts, Passing, Rational, ThetaSeries,
    Values, WithProducts,
};
use crate::motion::closed_form::{ChooseFormula, StateFormula, UseFormula, combine};
use crate::numerics::double_double::{DoubleDouble, two_sum};
use crate::numerics::lane::Lane;
use crate::numerics::turns::{reach, sin_cos_turns, turns, whole_off};

/// How x grows with time.
pub(super) trait ThetaArgument: Copy {
    /// Whether x never comes back.
    const ENDLESS: bool;

    /// x with what rounding has left out of it, and the sign of Θₒ.
    fn at<L: Lane>(self, t: L) -> ([L; 2], L);

    /// The same where a unit of the rates is `unit`.
    fn in_units_of(self, unit: f64) -> Self;
}

/// x is periodic with period one turn. If `ALTERNATES`, Θₒ changes sign after each turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PeriodicArgument<const ALTERNATES: bool> {
    /// x in turns for a unit of time, and at t = 0.
    pub(super) rate: DoubleDouble,
    pub(super) start: DoubleDouble,
}

impl<const ALTERNATES: bool> ThetaArgument for PeriodicArgument<ALTERNATES> {
    const ENDLESS: bool = false;

    #[inline(always)]
    fn at<L: Lane>(self, t: L) -> ([L; 2], L) {
        let (zero, one, two) = (L::new(0.0), L::new(1.0), L::new(2.0));
        if !ALTERNATES {
            return ([turns(t, self.rate, self.start), zero], one);
        }
        let halves = two * turns(t, self.rate.scaled(0.5), self.start.scaled(0.5));
        let whole = halves.round();
        ([halves - whole, zero], one - two * whole.abs())
    }

    fn in_units_of(self, unit: f64) -> Self {
        let rate = self.rate.scaled(unit);
        Self { rate, ..self }
    }
}

/// x never comes back. Where a motion leads from one equilibrium to another `start` is as large as the logarithm of rounding, and the
/// last digits of x are those that count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EndlessArgument {
    pub(super) rate: DoubleDouble,
    pub(super) start: DoubleDouble,
}

impl ThetaArgument for EndlessArgument {
    const ENDLESS: bool = true;

    #[inline(always)]
    fn at<L: Lane>(self, t: L) -> ([L; 2], L) {
        let (p, e) = t.two_product(L::new(self.rate.high));
        let (x, rest) = two_sum(p, L::new(self.start.high));
        let e = t.mul_add(L::new(self.rate.low), e + L::new(self.start.low));
        ([x, rest + e], L::new(1.0))
    }

    fn in_units_of(self, unit: f64) -> Self {
        let rate = self.rate.scaled(unit);
        Self { rate, ..self }
    }
}

/// One of the series with its clock: a loop over times has no branch on either. `Apart`: with products that are series of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TimeArgument {
    Circular(Circular, PeriodicArgument<false>),
    Hyperbolic(Hyperbolic, PeriodicArgument<false>),
    Alternating(Hyperbolic, PeriodicArgument<true>),
    CircularApart(
        WithProducts<Circular, CircularProducts>,
        PeriodicArgument<false>,
    ),
    HyperbolicApart(
        WithProducts<Hyperbolic, HyperbolicProducts>,
        PeriodicArgument<false>,
    ),
    AlternatingApart(
        WithProducts<Hyperbolic, HyperbolicProducts>,
        PeriodicArgument<true>,
    ),
    Endless(Passing, EndlessArgument),
    Rational(Rational, EndlessArgument),
}

impl TimeArgument {
    /// The same where a unit of the rates is `unit`.
    fn in_units_of(self, unit: f64) -> Self {
        match self {
            Self::Circular(series, clock) => Self::Circular(series, clock.in_units_of(unit)),
            Self::Hyperbolic(series, clock) => Self::Hyperbolic(series, clock.in_units_of(unit)),
            Self::Alternating(series, clock) => Self::Alternating(series, clock.in_units_of(unit)),
            Self::CircularApart(series, clock) => {
                Self::CircularApart(series, clock.in_units_of(unit))
            }
            Self::HyperbolicApart(series, clock) => {
                Self::HyperbolicApart(series, clock.in_units_of(unit))
            }
            Self::AlternatingApart(series, clock) => {
                Self::AlternatingApart(series, clock.in_units_of(unit))
            }
            Self::Endless(series, clock) => Self::Endless(series, clock.in_units_of(unit)),
            Self::Rational(series, clock) => Self::Rational(series, clock.in_units_of(unit)),
        }
    }

    /// Turns of x for a unit of time, where they are counted.
    fn rate(&self) -> Option<DoubleDouble> {
        match self {
            Self::Circular(_, clock)
            | Self::Hyperbolic(_, clock)
            | Self::CircularApart(_, clock)
            | Self::HyperbolicApart(_, clock) => Some(clock.rate),
            Self::Alternating(_, clock) | Self::AlternatingApart(_, clock) => Some(clock.rate),
            Self::Endless(..) | Self::Rational(..) => None,
        }
    }
}

/// All that a state takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Propagator {
    /// Turns of the spinor for a unit of time.
    pub(super) rate: DoubleDouble,
    /// Turns of the spinor for x = 1.
    pub(super) slope: f64,
    pub(super) clocked: TimeArgument,
    /// From (Re Θₑ, Im Θₑ, Re Θₒ, Im Θₒ), turned, to the components (x, y, z, w) of the attitude times √D.
    pub(super) attitude: [[f64; 4]; 4],
    /// From the products of both to D ω in B.
    pub(super) omega: [[f64; 3]; 4],
    /// Beyond this |t| nothing is known of the phases.
    pub(super) reach: f64,
}

impl Propagator {
    /// The same motion where a unit of the rates is `unit`, a power of two.
    pub(super) fn in_units_of(mut self, unit: f64) -> Self {
        self.rate = self.rate.scaled(unit);
        self.clocked = self.clocked.in_units_of(unit);
        self.omega = self.omega.map(|column| column.map(|x| x * unit));
        self.reach = match self.clocked.rate() {
            Some(rate) => reach(&[self.rate, rate]),
            None => reach(&[self.rate]),
        };
        self
    }

    /// (x, y, z, w) of the attitude and ω in B.
    #[inline(always)]
    fn state<L: Lane, C: ThetaArgument>(
        &self,
        clock: C,
        series: &impl ThetaSeries,
        t: L,
    ) -> [L; 7] {
        let one = L::new(1.0);
        let is_known = t.abs() <= L::new(self.reach);
        let t = if is_known { t } else { L::new(f64::NAN) };
        let ([x, rest], sign) = clock.at(t);
        let Values {
            functions: [even, odd],
            products,
        } = series.values(x, rest, sign);
        let phase = turns(t, self.rate, DoubleDouble::default());
        let phase = if C::ENDLESS {
            phase
        } else {
            whole_off(L::new(self.slope).mul_add(x, phase))
        };
        let (sine, cosine) = sin_cos_turns(phase);
        let turned = |(re, im): (L, L)| [re * cosine - im * sine, re * sine + im * cosine];
        let ([a, b], [c, d]) = (turned(even), turned(odd));
        let [x, y, z, w] = combine(&self.attitude, [a, b, c, d]);
        let inverse = one / (x * x + y * y + z * z + w * w);
        let norm = inverse.sqrt();
        let [p, q, r] = combine(&self.omega, products);
        [
            x * norm,
            y * norm,
            z * norm,
            w * norm,
            p * inverse,
            q * inverse,
            r * inverse,
        ]
    }
}

impl ChooseFormula for Propagator {
    #[inline(always)]
    fn choose<U: UseFormula>(&self, then: U) -> U::Output {
        match self.clocked {
            TimeArgument::Circular(series, clock) => then.with(&ChosenSeries(self, series, clock)),
            TimeArgument::Hyperbolic(series, clock) => {
                then.with(&ChosenSeries(self, series, clock))
            }
            TimeArgument::Alternating(series, clock) => {
                then.with(&ChosenSeries(self, series, clock))
            }
            TimeArgument::CircularApart(series, clock) => {
                then.with(&ChosenSeries(self, series, clock))
            }
            TimeArgument::HyperbolicApart(series, clock) => {
                then.with(&ChosenSeries(self, series, clock))
            }
            TimeArgument::AlternatingApart(series, clock) => {
                then.with(&ChosenSeries(self, series, clock))
            }
            TimeArgument::Endless(series, clock) => then.with(&ChosenSeries(self, series, clock)),
            TimeArgument::Rational(series, clock) => then.with(&ChosenSeries(self, series, clock)),
        }
    }
}

/// A propagator with its series and its clock.
struct ChosenSeries<'a, S, C>(&'a Propagator, S, C);

impl<S: ThetaSeries, C: ThetaArgument> StateFormula for ChosenSeries<'_, S, C> {
    #[inline(always)]
    fn state<L: Lane>(&self, t: L) -> [L; 7] {
        self.0.state(self.2, &self.1, t)
    }
}
