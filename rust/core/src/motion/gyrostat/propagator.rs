//! The state at any time from a few constants: two theta functions for the attitude and ω alike.

use crate::motion::free::evaluate::{Formula, Motion, Use, combine};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::lane::Lane;
use crate::numerics::theta::circular;
use crate::numerics::turns::{exp_minus, reach, sin_cos_turns, turns, whole_off};

/// Θₑ and Θₒ but for a common factor, real and imaginary part of each, at the argument x.
pub(super) trait ThetaSeries {
    fn values<L: Lane>(&self, x: L) -> [(L, L); 2];
}

/// By sines and cosines of multiples of x turns: coefficients of `cos 2jx`, `sin 2jx`, and of `cos (2j+1)x`, `sin (2j+1)x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Circular {
    /// Real and imaginary part, before the cosine and before the sine.
    pub(super) even: [[f64; 4]; 3],
    pub(super) odd: [[f64; 4]; 4],
}

impl ThetaSeries for Circular {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L) -> [(L, L); 2] {
        let (sine, cosine) = sin_cos_turns(x);
        let z = circular::Argument::new(sine, cosine);
        let (mut even, mut odd) = ((L::new(0.0), L::new(0.0)), (L::new(0.0), L::new(0.0)));
        let mut k = 4;
        while k > 0 {
            k -= 1;
            let n = 2 * k + 1;
            odd = add(odd, &self.odd[k], z.cos[n], z.sin[n]);
            if k > 0 {
                even = add(even, &self.even[k - 1], z.cos[2 * k], z.sin[2 * k]);
            }
        }
        [(L::new(1.0) + even.0, even.1), odd]
    }
}

#[inline(always)]
fn add<L: Lane>((re, im): (L, L), coefficients: &[f64; 4], cosine: L, sine: L) -> (L, L) {
    let [a, b, c, d] = coefficients.map(L::new);
    (
        a.mul_add(cosine, c.mul_add(sine, re)),
        b.mul_add(cosine, d.mul_add(sine, im)),
    )
}

/// By exponentials: with `g = e^{−|θ|}` and `Y = e^{−(end − |θ|)}`, both series over `e^{|θ|}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hyperbolic {
    /// `sgn(Q)^j |Q|^{j²−j} (cos 2jφ, sin 2jφ)`, j from one.
    pub(super) even: [[f64; 2]; 3],
    /// `|Q|^{j²} (cos (2j+1)φ, sin (2j+1)φ)`, j from zero.
    pub(super) odd: [[f64; 2]; 4],
    /// θ for x = 1.
    pub(super) unit: f64,
    /// θ for x = ½.
    pub(super) end: f64,
}

impl ThetaSeries for Hyperbolic {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L) -> [(L, L); 2] {
        let (zero, one) = (L::new(0.0), L::new(1.0));
        let theta = x * L::new(self.unit);
        let size = theta.abs();
        let sign = one.copysign(theta);
        let g = exp_minus(size);
        let end = exp_minus((L::new(self.end) - size).max(zero));
        let (y2, g2) = (end * end, g * g);
        let mut even = (one, zero);
        let mut odd = (zero, zero);
        let (mut decay, mut power) = (one, g2);
        let mut j = 0;
        while j < 4 {
            let [c, s] = self.odd[j];
            odd.0 = (L::new(c) * decay).mul_add(one + power, odd.0);
            odd.1 = (L::new(s) * decay).mul_add(one - power, odd.1);
            decay = decay * y2;
            power = power * g2;
            if j < 3 {
                let [c, s] = self.even[j];
                even.0 = (L::new(c) * decay).mul_add(one + power, even.0);
                even.1 = (L::new(s) * decay).mul_add(one - power, even.1);
            }
            power = power * g2;
            j += 1;
        }
        [(g * even.0, g * sign * even.1), (odd.0, sign * odd.1)]
    }
}

/// One and `x + k x²`, both over 1 + x².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rational {
    /// Real and imaginary part of k.
    pub(super) curvature: [f64; 2],
}

impl ThetaSeries for Rational {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L) -> [(L, L); 2] {
        let [re, im] = self.curvature.map(L::new);
        let square = x * x;
        let over = L::new(1.0) / (L::new(1.0) + square);
        [
            (over, L::new(0.0)),
            (re.mul_add(square, x) * over, im * square * over),
        ]
    }
}

/// How x grows with time.
pub(super) trait ThetaArgument: Copy {
    /// Whether x never comes back.
    const ENDLESS: bool;

    /// x, and the sign of Θₒ.
    fn at<L: Lane>(self, t: L) -> (L, L);

    /// The same where a unit of the rates is `unit`.
    fn in_units_of(self, unit: f64) -> Self;
}

/// x goes round: whole turns of it mean nothing, but that Θₒ changes its sign with each where it `ALTERNATES`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Round<const ALTERNATES: bool> {
    /// x in turns for a unit of time, and at t = 0.
    pub(super) rate: DoubleDouble,
    pub(super) start: DoubleDouble,
}

impl<const ALTERNATES: bool> ThetaArgument for Round<ALTERNATES> {
    const ENDLESS: bool = false;

    #[inline(always)]
    fn at<L: Lane>(self, t: L) -> (L, L) {
        let (one, two) = (L::new(1.0), L::new(2.0));
        if !ALTERNATES {
            return (turns(t, self.rate, self.start), one);
        }
        let halves = two * turns(t, self.rate.scaled(0.5), self.start.scaled(0.5));
        let whole = halves.round();
        (halves - whole, one - two * whole.abs())
    }

    fn in_units_of(self, unit: f64) -> Self {
        let rate = self.rate.scaled(unit);
        Self { rate, ..self }
    }
}

/// x never comes back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Endless {
    pub(super) rate: f64,
    pub(super) start: f64,
}

impl ThetaArgument for Endless {
    const ENDLESS: bool = true;

    #[inline(always)]
    fn at<L: Lane>(self, t: L) -> (L, L) {
        let x = t.mul_add(L::new(self.rate), L::new(self.start));
        (x, L::new(1.0))
    }

    fn in_units_of(self, unit: f64) -> Self {
        let rate = self.rate * unit;
        Self { rate, ..self }
    }
}

/// One of the series with its clock: a loop over times has no branch on either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Clocked {
    Circular(Circular, Round<false>),
    Hyperbolic(Hyperbolic, Round<false>),
    Alternating(Hyperbolic, Round<true>),
    Endless(Hyperbolic, Endless),
    Rational(Rational, Endless),
}

impl Clocked {
    /// The same where a unit of the rates is `unit`.
    fn in_units_of(self, unit: f64) -> Self {
        match self {
            Self::Circular(series, clock) => Self::Circular(series, clock.in_units_of(unit)),
            Self::Hyperbolic(series, clock) => Self::Hyperbolic(series, clock.in_units_of(unit)),
            Self::Alternating(series, clock) => Self::Alternating(series, clock.in_units_of(unit)),
            Self::Endless(series, clock) => Self::Endless(series, clock.in_units_of(unit)),
            Self::Rational(series, clock) => Self::Rational(series, clock.in_units_of(unit)),
        }
    }

    /// Turns of x for a unit of time, where they are counted.
    fn rate(&self) -> Option<DoubleDouble> {
        match self {
            Self::Circular(_, clock) | Self::Hyperbolic(_, clock) => Some(clock.rate),
            Self::Alternating(_, clock) => Some(clock.rate),
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
    pub(super) clocked: Clocked,
    /// From (Re Θₑ, Im Θₑ, Re Θₒ, Im Θₒ), turned, to the components (x, y, z, w) of the attitude times √D.
    pub(super) attitude: [[f64; 4]; 4],
    /// From `|Θₑ|²`, `|Θₒ|²`, real and imaginary part of `Θ̄ₑΘₒ` to D ω in B.
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
        let (x, sign) = clock.at(t);
        let [even, (odd_re, odd_im)] = series.values(x);
        let odd = (sign * odd_re, sign * odd_im);
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
        let bilinear = [
            even.0 * even.0 + even.1 * even.1,
            odd.0 * odd.0 + odd.1 * odd.1,
            even.0 * odd.0 + even.1 * odd.1,
            even.0 * odd.1 - even.1 * odd.0,
        ];
        let [p, q, r] = combine(&self.omega, bilinear);
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

impl Motion for Propagator {
    #[inline(always)]
    fn choose<U: Use>(&self, then: U) -> U::Output {
        match self.clocked {
            Clocked::Circular(series, clock) => then.with(&Chosen(self, series, clock)),
            Clocked::Hyperbolic(series, clock) => then.with(&Chosen(self, series, clock)),
            Clocked::Alternating(series, clock) => then.with(&Chosen(self, series, clock)),
            Clocked::Endless(series, clock) => then.with(&Chosen(self, series, clock)),
            Clocked::Rational(series, clock) => then.with(&Chosen(self, series, clock)),
        }
    }
}

/// A propagator with its series and its clock.
struct Chosen<'a, S, C>(&'a Propagator, S, C);

impl<S: ThetaSeries, C: ThetaArgument> Formula for Chosen<'_, S, C> {
    #[inline(always)]
    fn state<L: Lane>(&self, t: L) -> [L; 7] {
        self.0.state(self.2, &self.1, t)
    }
}
