//! The Kepler orbit through a state, at any time.

mod apse;
mod equation;

use nalgebra::Vector3;

use self::apse::{Anomaly, Apse};
use super::stumpff::functions;
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::numerics::double_double::{DoubleDouble, two_product};
use crate::numerics::jet::Jet;
use crate::numerics::number::Real;
use crate::numerics::turns::MOST_TURNS;

/// How many times its own size `2μ/r` and v² may be larger than β, of whose double-double the phases of
/// [`MOST_TURNS`] revolutions are then still made: nearer to a parabola the period is known to fewer digits.
const CANCELLED: f64 = 1024.0;
/// So far an orbit without end is followed: the squares of its distances stay within the range of float64.
const FARTHEST: f64 = 1e150;

/// 2π and what it leaves out.
const TURN: DoubleDouble = DoubleDouble {
    high: std::f64::consts::TAU,
    low: 2.449_293_598_294_706_4e-16,
};

/// The motion `r̈ = −μ r/r³` from a position and a velocity: an ellipse, a parabola or a hyperbola.
///
/// All numbers are kept in units of length and time that are powers of two near the orbit's own, so that neither
/// molecules nor galaxies leave the range of float64.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::loads::kepler::Orbit;
///
/// // Where the Earth's gravity turns a satellite once in a sidereal day.
/// let (mu, radius) = (3.986_004_418e14_f64, 42_164_172.0);
/// let speed = (mu / radius).sqrt();
/// let orbit = Orbit::new(mu, &(Vector3::x() * radius), &(Vector3::y() * speed))?;
/// assert!((orbit.period() - 86_164.1).abs() < 0.1);
/// let (place, _) = orbit.at(orbit.period() / 4.0);
/// assert!((place.y - radius).abs() < 1e-3);
/// assert_eq!(orbit.mu(), mu);
/// // The phase of 10²⁰ revolutions is known, that of 10³⁰ is not.
/// assert!(orbit.check(1e20 * orbit.period()).is_ok() && orbit.check(1e30 * orbit.period()).is_err());
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    mu: f64,
    /// The units of length and time.
    length: f64,
    time: f64,
    scaled_mu: f64,
    /// The state that it was given with.
    given: [Vector3<f64>; 2],
    /// The state that motion is reckoned from, and when it is there: that one, or the periapsis of a hyperbola.
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    home: f64,
    distance: f64,
    /// `r·v`.
    sigma: f64,
    /// `β = μ/a = 2μ/r − v²`, negative for a hyperbola.
    beta: f64,
    /// Revolutions in a unit of time; zero unless the orbit is an ellipse.
    frequency: DoubleDouble,
    /// In units of time, how far from its epoch its state is known.
    reach: f64,
}

impl Orbit {
    /// The orbit about an attractor at the origin with the gravitational parameter μ.
    ///
    /// # Errors
    /// Numbers that are not finite; μ that is not positive; a position at the attractor; a radial velocity, which leads into
    /// it.
    pub fn new(mu: f64, position: &Vector3<f64>, velocity: &Vector3<f64>) -> Result<Self, Error> {
        finite("mu", mu)?;
        all_finite("position", position)?;
        all_finite("velocity", velocity)?;
        let positive = |what, law, value| {
            if value > 0.0 {
                Ok(())
            } else {
                Err(Error::OutOfDomain { what, law, value })
            }
        };
        positive("mu", "more than zero", mu)?;
        let largest = position.amax();
        positive("the distance from the attractor", "more than zero", largest)?;
        // T² = L³/μ, by exponents so that nothing overflows on the way.
        let l = largest.log2().round();
        let t = (0.5 * (3.0 * l - mu.log2())).round();
        let (length, time) = (l.exp2(), t.exp2());
        let scaled_mu = mu * (2.0 * t - 3.0 * l).exp2();
        let (r, v) = (position / length, velocity * time / length);
        all_finite("position, velocity and mu, taken together,", &v)?;
        let swept = r.cross(&v).norm();
        let law = "more than zero: a radial orbit falls into the attractor";
        positive("the angular momentum of the orbit", law, swept)?;

        let square = |x: &Vector3<f64>| {
            x.iter().fold(DoubleDouble::default(), |sum, &x| {
                sum + DoubleDouble::from(x) * x.into()
            })
        };
        let (distance, exact_mu) = (root(square(&r)), DoubleDouble::from(scaled_mu));
        let beta = (exact_mu + exact_mu) / distance - square(&v);
        let frequency = if beta.high > 0.0 {
            root(beta * beta * beta) / exact_mu / TURN
        } else {
            DoubleDouble::default()
        };
        let reach = if frequency.high > 0.0 {
            let cancelled = 2.0 * scaled_mu / distance.high / beta.high;
            MOST_TURNS / frequency.high / (cancelled / CANCELLED).max(1.0)
        } else {
            FARTHEST / length.max(1.0) / v.norm().max(1.0)
        };
        let orbit = Self {
            mu,
            length,
            time,
            scaled_mu,
            given: [r, v],
            position: r,
            velocity: v,
            home: 0.0,
            distance: distance.high,
            sigma: r.dot(&v),
            beta: beta.high,
            frequency,
            reach,
        };
        Ok(if orbit.beta < 0.0 {
            orbit.at_periapsis()
        } else {
            orbit
        })
    }

    /// The same hyperbola, reckoned from its periapsis.
    ///
    /// From far away the terms of the motion past the attractor cancel: they are as large as the square of the distance over that of
    /// the periapsis. From the periapsis all of them have one sign.
    fn at_periapsis(self) -> Self {
        let [r, v] = self.given.map(|it| it.map(DoubleDouble::from));
        let mu = DoubleDouble::from(self.scaled_mu);
        let beta = (mu + mu) / r.dot(&r).sqrt() - v.dot(&v);
        let Apse {
            position,
            velocity,
            distance,
            since,
        } = Apse::of(mu, beta, &r, &v);
        Self {
            position: position.map(DoubleDouble::rounded),
            velocity: velocity.map(DoubleDouble::rounded),
            distance: distance.rounded(),
            sigma: 0.0,
            home: -since.rounded(),
            ..self
        }
    }

    /// μ.
    #[must_use]
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// The units of length and time of its own numbers.
    pub(super) fn units(&self) -> (f64, f64) {
        (self.length, self.time)
    }

    /// μ in those units.
    pub(super) fn scaled_mu(&self) -> f64 {
        self.scaled_mu
    }

    /// Time of a revolution; infinite but for an ellipse.
    #[must_use]
    pub fn period(&self) -> f64 {
        if self.frequency.high == 0.0 {
            return f64::INFINITY;
        }
        (DoubleDouble::from(1.0) / self.frequency).high * self.time
    }

    /// That the state is known a time after the one that it was given with.
    ///
    /// # Errors
    /// [`MotionFault::OrbitBeyondReach`]: after 2⁸⁸ revolutions nothing is left of the phase, nearer to a parabola after fewer; the
    /// squares of the distances of an orbit without end leave the range of float64.
    pub fn check(&self, elapsed: f64) -> Result<(), Error> {
        // A time that is not finite has no state, and is no error, as in closed forms.
        if !elapsed.is_finite() || (elapsed / self.time).abs() <= self.reach {
            return Ok(());
        }
        let reach = self.reach * self.time;
        Err(Error::Motion(MotionFault::OrbitBeyondReach {
            elapsed,
            reach,
        }))
    }

    /// Position and velocity at a time after the state the orbit was given with, within its [reach](Self::check).
    ///
    /// With s from `dt = r ds` and `G_k = s^k c_k(β s²)`, `c_k(x) = Σ (−x)^j/(2j+k)!`: Kepler's equation is
    /// `t = r₀ G₁ + σ₀ G₂ + μ G₃`, the distance `r = r₀ G₀ + σ₀ G₁ + μ G₂`. Whole revolutions are taken off in double-double
    /// first. Source: Stumpff, Himmelsmechanik I, §41; Danby, Fundamentals of Celestial Mechanics, §6.9.
    #[must_use]
    pub fn at(&self, elapsed: f64) -> (Vector3<f64>, Vector3<f64>) {
        if elapsed == 0.0 {
            let [position, velocity] = self.given;
            return (position * self.length, velocity * (self.length / self.time));
        }
        let t = self.reduced(elapsed / self.time - self.home);
        let (r0, mu) = (self.distance, self.scaled_mu);
        let functions = self.solve(t).1;
        let ([_, g1, g2, _], r) = (functions, self.distance_at(&functions));
        let (f, g) = (1.0 - mu * g2 / r0, r0 * g1 + self.sigma * g2);
        let (f_rate, g_rate) = (-mu * g1 / (r * r0), 1.0 - mu * g2 / r);
        (
            (self.position * f + self.velocity * g) * self.length,
            (self.position * f_rate + self.velocity * g_rate) * (self.length / self.time),
        )
    }

    /// As [`Self::at`], with the derivatives by μ and the state at its epoch, which `variable` makes numbers of: μ, then the
    /// components of position and velocity.
    ///
    /// Kepler's equation gives those of s; with `∂G_k/∂s = G_{k−1}` and `∂G_k/∂β = ½ (k G_{k+2} − s G_{k+1})` follow the others.
    /// Source: Goodyear, Astronomical Journal 70 (1965) 189.
    pub(super) fn varied<const N: usize>(
        &self,
        elapsed: f64,
        variable: impl Fn(f64, usize) -> Jet<N>,
    ) -> (Vector3<Jet<N>>, Vector3<Jet<N>>) {
        let number = |x: f64| Jet::<N>::constant(x);
        let with = |value: f64, jet: Jet<N>| Jet { value, ..jet };
        let (length, speed) = (self.length, self.length / self.time);
        let of = |own: &Vector3<f64>, unit: f64, first: usize| {
            Vector3::from_fn(|i, _| {
                let jet = variable(own[i] * unit, first + i) / number(unit);
                with(own[i], jet)
            })
        };
        let [r0, v0] = [of(&self.given[0], length, 1), of(&self.given[1], speed, 4)];
        let mu = variable(self.mu, 0) * number(self.scaled_mu / self.mu);
        let mu = with(self.scaled_mu, mu);
        let beta = (mu + mu) / r0.dot(&r0).root() - v0.dot(&v0);
        let beta = with(self.beta, beta);
        let whole = elapsed / self.time - self.home;
        let t = self.reduced(whole);
        let (mut r0, mut v0, mut time) = (r0, v0, number(t));
        if self.beta < 0.0 {
            let apse = Apse::of(mu, beta, &r0, &v0);
            r0 = Vector3::from_fn(|i, _| with(self.position[i], apse.position[i]));
            v0 = Vector3::from_fn(|i, _| with(self.velocity[i], apse.velocity[i]));
            time = with(t, apse.since);
        }
        let s = self.solve(t).0;
        let distance = with(self.distance, r0.dot(&r0).root());
        let sigma = with(self.sigma, r0.dot(&v0));
        if self.frequency.high > 0.0 {
            let revolutions = ((whole - t) * self.frequency.high).round();
            let period = mu * number(TURN.high) / (beta * beta.root());
            time = with(t, -(period * number(revolutions)));
        }
        let there = number(self.distance_at(&functions(self.beta, s)));
        let at = |s: Jet<N>| Jet::stumpff(beta, s);
        let [_, g1, g2, g3] = at(number(s));
        let excess = distance * g1 + sigma * g2 + mu * g3 - time;
        let [g0, g1, g2, _] = at(with(s, -(excess / there)));
        let r = distance * g0 + sigma * g1 + mu * g2;
        let one = number(1.0);
        let (f, f_rate) = (one - mu * g2 / distance, -(mu * g1 / (r * distance)));
        let (g, g_rate) = (distance * g1 + sigma * g2, one - mu * g2 / r);
        (
            (r0 * f + v0 * g) * number(length),
            (r0 * f_rate + v0 * g_rate) * number(speed),
        )
    }

    /// The time without whole revolutions.
    fn reduced(&self, t: f64) -> f64 {
        let DoubleDouble { high, low } = self.frequency;
        if high == 0.0 {
            return t;
        }
        let (product, rest) = two_product(high, t);
        let revolutions = product.round();
        if revolutions == 0.0 {
            return t;
        }
        // Past 2⁵³ the rest of the product has whole revolutions of its own.
        let rest = rest + low * t;
        ((product - revolutions) + (rest - rest.round())) / high
    }
}

/// √x, by one correction of the rounded root.
fn root(x: DoubleDouble) -> DoubleDouble {
    let s = x.high.sqrt();
    if s == 0.0 {
        return DoubleDouble::default();
    }
    let rest = x - DoubleDouble::from(s) * s.into();
    DoubleDouble::sum(s, 0.5 * rest.high / s)
}

#[cfg(test)]
mod tests;
