//! The Kepler orbit through a state, at any time: Kepler's equation in Stumpff's functions, for an ellipse, a parabola and a hyperbola.
//!
//! Stumpff's functions, of which the motion on any Kepler orbit is made: `G_k(s) = s^k c_k(β s²)`, `c_k(x) = Σ (−x)^j/(2j+k)!`.

use nalgebra::Vector3;

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
        let t = self.without_revolutions(elapsed / self.time - self.home);
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
    pub(super) fn at_with_derivatives<const N: usize>(
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
        let t = self.without_revolutions(whole);
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
        let there = number(self.distance_at(&stumpff_functions(self.beta, s)));
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
    fn without_revolutions(&self, t: f64) -> f64 {
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

/// A step of the iteration so small that another one would change nothing: its cube is below rounding.
const NEAR: f64 = 1e-6;
/// A step so small that the functions after it follow from those before it.
const SMALL: f64 = 1e-4;

impl Orbit {
    /// s at the time `t` and its functions.
    fn solve(&self, t: f64) -> (f64, [f64; 4]) {
        if t == 0.0 || !t.is_finite() {
            return (t, stumpff_functions(self.beta, t));
        }
        self.search(t)
    }

    /// A step of Laguerre's iteration from `s`, and whether it is the last.
    fn change(&self, s: f64, t: f64, g: &[f64; 4]) -> (f64, bool) {
        let (excess, slope) = (self.time_at(g) - t, self.distance_at(g));
        let bend = self.sigma * g[0] + (self.scaled_mu - self.beta * self.distance) * g[1];
        let radical = (16.0 * slope * slope - 20.0 * excess * bend).abs().sqrt();
        let change = -5.0 * excess / (slope + radical);
        let size = change.abs();
        // What is left is the cube of that.
        let is_near = size <= NEAR * s.abs() && size * bend.abs() <= NEAR * slope;
        (change, is_near || size <= f64::EPSILON * s.abs())
    }

    /// s and its functions after the last step of the iteration.
    fn end_at(&self, s: f64, g: &[f64; 4], change: f64) -> (f64, [f64; 4]) {
        let next = s + change;
        if change * change * self.beta.abs() < SMALL * SMALL {
            (next, shift_functions(g, self.beta, change))
        } else {
            (next, stumpff_functions(self.beta, next))
        }
    }

    /// s at the time `t` and its functions, by Laguerre's iteration kept within a bracket.
    fn search(&self, t: f64) -> (f64, [f64; 4]) {
        let (mut low, mut high, mut s);
        if self.beta > 0.0 {
            // E − M is at most the eccentricity, less than one, at both ends.
            let root = self.beta.sqrt();
            s = t * self.beta / self.scaled_mu;
            (low, high) = (s - 2.0 / root, s + 2.0 / root);
        } else if self.beta < 0.0 {
            // From the periapsis: e sinh H − H = M, so that H is at least asinh(M/e), and at most √−β t/q.
            let root = (-self.beta).sqrt();
            let over_one = -self.beta * self.distance / self.scaled_mu;
            let mean = t.abs() / self.scaled_mu * root.powi(3);
            let least = (mean / (1.0 + over_one)).asinh();
            let most = root * t.abs() / self.distance;
            let start = ((mean + least) / (1.0 + over_one)).asinh().min(most);
            let (least, most) = (least / root, most / root * (1.0 + 4.0 * f64::EPSILON));
            s = start / root * t.signum();
            (low, high) = if t > 0.0 {
                (0.9 * least, most)
            } else {
                (-most, -0.9 * least)
            };
        } else {
            s = t / self.distance;
            (low, high) = (0.0_f64.min(s), 0.0_f64.max(s));
            while (self.time_at(&stumpff_functions(self.beta, s)) - t) * t.signum() < 0.0 {
                s *= 2.0;
                (low, high) = if t > 0.0 { (0.5 * s, s) } else { (s, 0.5 * s) };
            }
        }
        // Laguerre's iteration takes three or four rounds near the root; far out on a hyperbola, where the time grows like an
        // exponential, its steps do not shrink, and halving is faster.
        let mut before = high - low;
        for _ in 0..200 {
            let g = stumpff_functions(self.beta, s);
            let excess = self.time_at(&g) - t;
            // Not a number where the exponentials overflow: far too far.
            if excess > 0.0 || excess.is_nan() && t > 0.0 {
                high = s;
            } else {
                low = s;
            }
            let (change, is_last) = self.change(s, t, &g);
            let (next, size) = (s + change, change.abs());
            if size <= f64::EPSILON * s.abs() {
                return self.end_at(s, &g, change);
            }
            if size <= 0.5 * before && next > low && next < high {
                if is_last {
                    return self.end_at(s, &g, change);
                }
                before = size;
                s = next;
                continue;
            }
            let middle = 0.5 * (low + high);
            if middle == low || middle == high {
                return (middle, stumpff_functions(self.beta, middle));
            }
            before = (middle - s).abs();
            s = middle;
        }
        (s, stumpff_functions(self.beta, s))
    }

    fn time_at(&self, [_, g1, g2, g3]: &[f64; 4]) -> f64 {
        self.distance * g1 + self.sigma * g2 + self.scaled_mu * g3
    }

    fn distance_at(&self, [g0, g1, g2, _]: &[f64; 4]) -> f64 {
        self.distance * g0 + self.sigma * g1 + self.scaled_mu * g2
    }
}

/// Numbers in which the motion on an orbit is stated.
trait Anomaly: Real {
    /// `G_k(s)` for k = 0..3.
    fn stumpff(beta: Self, s: Self) -> [Self; 4];

    /// s of a hyperbola with `G_1(s) = y`: `asinh(√−β y)/√−β`.
    fn arc(y: Self, beta: Self) -> Self;
}

/// To the precision of doubles: of the time at the periapsis no more is kept.
impl Anomaly for DoubleDouble {
    fn stumpff(beta: Self, s: Self) -> [Self; 4] {
        stumpff_functions(beta.high, s.high).map(Self::from)
    }

    fn arc(y: Self, beta: Self) -> Self {
        let root = (-beta.high).sqrt();
        Self::from((root * y.high).asinh() / root)
    }
}

/// With `∂G_k/∂s = G_{k−1}` and `∂G_k/∂β = ½ (k G_{k+2} − s G_{k+1})`.
impl<const N: usize> Anomaly for Jet<N> {
    fn stumpff(beta: Self, s: Self) -> [Self; 4] {
        let g = stumpff_functions(beta.value, s.value);
        let [g4, g5] = higher_functions(beta.value, s.value);
        let after = [g[1], g[2], g[3], g4, g5];
        [0, 1, 2, 3].map(|k| {
            let by_beta = 0.5 * (k as f64 * after[k + 1] - s.value * after[k]);
            let by_s = if k == 0 { -beta.value * g[1] } else { g[k - 1] };
            Self::chain(g[k], [(by_s, &s), (by_beta, &beta)])
        })
    }

    fn arc(y: Self, beta: Self) -> Self {
        let s = DoubleDouble::arc(y.value.into(), beta.value.into()).high;
        let [g0, _, g2, g3] = stumpff_functions(beta.value, s);
        Self::chain(s, [(1.0 / g0, &y), (0.5 * (s * g2 - g3) / g0, &beta)])
    }
}

/// The periapsis of a hyperbola.
struct Apse<X> {
    position: Vector3<X>,
    velocity: Vector3<X>,
    distance: X,
    /// The time since then, negative before.
    since: X,
}

impl<X: Anomaly> Apse<X> {
    /// Of the orbit through (r, v), with `β = 2μ/r − v²`.
    ///
    /// `μ e⃗ = v × (r × v) − μ r/|r|`, `e = √(1 − β h²/μ²)`, `q = h²/μ(1 + e)`; from there `r·v = e μ sinh(√−β s)/√−β` and
    /// `t = q G₁ + μ G₃`.
    fn of(mu: X, beta: X, r: &Vector3<X>, v: &Vector3<X>) -> Self {
        let one = X::from(1.0);
        let swept = r.cross(v);
        let square = swept.dot(&swept);
        let eccentricity = (one - beta * square / (mu * mu)).root();
        let distance = square / (mu * (one + eccentricity));
        let toward = v.cross(&swept) / mu - r / r.dot(r).root();
        let toward = toward / toward.dot(&toward).root();
        let size = square.root();
        let speed = size / distance;
        let s = X::arc(r.dot(v) / (eccentricity * mu), beta);
        let [_, g1, _, g3] = X::stumpff(beta, s);
        Self {
            position: toward * distance,
            velocity: swept.cross(&toward) / size * speed,
            distance,
            since: distance * g1 + mu * g3,
        }
    }
}

/// Below this β s² the closed forms cancel, and eleven terms of the series are exact.
const SERIES: f64 = 2.5;

/// The coefficients of [`series`].
const fn coefficients(k: usize) -> [f64; 12] {
    let mut found = [0.0; 12];
    let (mut j, mut coefficient) = (0, 1.0);
    while j < 11 {
        let n = (2 * j + k) as f64;
        coefficient /= n * (n - 1.0);
        found[j] = coefficient;
        coefficient = -coefficient;
        j += 1;
    }
    found
}

/// `Σ_{0≤j<11} (−x)^j (k − 2)!/(2j + k)!`: `c_2`, `c_3`, `2 c_4` and `6 c_5`.
#[inline(always)]
fn series<const K: usize>(x: f64) -> f64 {
    let c = const { coefficients(K) };
    // Even and odd powers side by side: two short chains wait less than a long one.
    let y = x * x;
    let pairs = c.as_chunks::<2>().0.iter().rev();
    let [even, odd] = pairs.fold([0.0; 2], |sums, pair| {
        [sums[0] * y + pair[0], sums[1] * y + pair[1]]
    });
    even + x * odd
}

/// `G_4` and `G_5`, by `c_{k+2}(x) = (1/k! − c_k(x))/x`.
fn higher_functions(beta: f64, s: f64) -> [f64; 2] {
    let x = beta * s * s;
    let [c4, c5] = if x.abs() < SERIES {
        [series::<4>(x) / 2.0, series::<5>(x) / 6.0]
    } else {
        let [_, _, g2, g3] = stumpff_functions(beta, s);
        [(0.5 - g2 / (s * s)) / x, (1.0 / 6.0 - g3 / (s * s * s)) / x]
    };
    [c4 * s.powi(4), c5 * s.powi(5)]
}

/// `G_k(s) = s^k c_k(β s²)` for k = 0..3.
fn stumpff_functions(beta: f64, s: f64) -> [f64; 4] {
    let x = beta * s * s;
    let (c2, c3) = if x.abs() < SERIES {
        (series::<2>(x), series::<3>(x))
    } else if x > 0.0 {
        let root = x.sqrt();
        let (sine, cosine) = (0.5 * root).sin_cos();
        let double = 2.0 * sine * cosine;
        (2.0 * sine * sine / x, (root - double) / (x * root))
    } else {
        // The root is not small: neither difference cancels.
        let root = (-x).sqrt();
        let rising = (0.5 * root).exp();
        let falling = 1.0 / rising;
        let (sine, cosine) = (0.5 * (rising - falling), 0.5 * (rising + falling));
        let double = 2.0 * sine * cosine;
        (2.0 * sine * sine / -x, (double - root) / (-x * root))
    };
    [1.0 - x * c2, s * (1.0 - x * c3), s * s * c2, s * s * s * c3]
}

/// `G_k(s + h)` for k = 0..3 from those of s, for a β h² so small that its square is below rounding.
///
/// Those of sums: `G_0 = G_0(s) G_0(h) − β G_1(s) G_1(h)`, `G_1 = G_1(s) G_0(h) + G_0(s) G_1(h)`, and as `∂G_k/∂h = G_{k−1}`,
/// `G_2 = G_2(s) + G_1(s) G_1(h) + G_0(s) G_2(h)`, `G_3 = G_3(s) + G_2(s) h + G_1(s) G_2(h) + G_0(s) G_3(h)`.
fn shift_functions(g: &[f64; 4], beta: f64, h: f64) -> [f64; 4] {
    let square = h * h;
    let (less, h1) = (0.5 * beta * square, h * (1.0 - beta * square / 6.0));
    let (h2, h3) = (0.5 * square, square * h / 6.0);
    let [g0, g1, g2, g3] = *g;
    [
        g0 - (g0 * less + beta * g1 * h1),
        g1 + (g0 * h1 - g1 * less),
        g2 + (g1 * h1 + g0 * h2),
        g3 + (g2 * h + g1 * h2 + g0 * h3),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    type State = (Vector3<f64>, Vector3<f64>);

    /// The position at a time, relative to its size.
    fn close(orbit: &Orbit, t: f64, position: [f64; 3], allowed: f64) {
        let (r, _) = orbit.at(t);
        let expected = Vector3::from(position);
        assert!(
            (r - expected).norm() < allowed * expected.norm(),
            "{r} {expected}"
        );
    }

    #[test]
    fn circle_at_any_time() {
        let orbit = Orbit::new(1.0, &Vector3::x(), &Vector3::y()).expect("circle");
        for t in [0.1_f64, 1.0, 3.0, -2.0, 1e3, -1e6] {
            close(&orbit, t, [t.cos(), t.sin(), 0.0], 2e-15);
        }
    }

    #[test]
    fn parabola_by_barker_s_equation() {
        // From perihelion q = ½: t = (tan(ν/2) + tan³(ν/2)/3)/2.
        let orbit = Orbit::new(1.0, &(Vector3::x() * 0.5), &(Vector3::y() * 2.0)).expect("orbit");
        for tangent in [0.1_f64, 1.0, 5.0, -3.0, 1e3] {
            let t = 0.5 * (tangent + tangent.powi(3) / 3.0);
            let place = [0.5 * (1.0 - tangent * tangent), tangent, 0.0];
            close(&orbit, t, place, 1e-14);
        }
    }

    #[test]
    fn ellipse_and_hyperbola_from_perihelion() {
        for e in [0.1_f64, 0.7, 0.99, 0.999_999] {
            // a = 1; E − e sin E = t.
            let speed = ((1.0 + e) / (1.0 - e)).sqrt();
            let orbit = Orbit::new(1.0, &(Vector3::x() * (1.0 - e)), &(Vector3::y() * speed));
            let orbit = orbit.expect("ellipse");
            for anomaly in [0.3_f64, 1.5, 3.0, -2.0] {
                let t = anomaly - e * anomaly.sin();
                let place = [
                    anomaly.cos() - e,
                    ((1.0 - e) * (1.0 + e)).sqrt() * anomaly.sin(),
                    0.0,
                ];
                // The semi-axis is known to ε/(1 − e) from the rounded speed.
                close(&orbit, t, place, 4e-15 / (1.0 - e));
            }
        }
        for e in [1.01_f64, 2.0, 30.0] {
            let speed = ((e + 1.0) / (e - 1.0)).sqrt();
            let orbit = Orbit::new(1.0, &(Vector3::x() * (e - 1.0)), &(Vector3::y() * speed));
            let orbit = orbit.expect("hyperbola");
            for anomaly in [0.2_f64, 2.0, -5.0, 20.0] {
                let t = e * anomaly.sinh() - anomaly;
                let place = [
                    e - anomaly.cosh(),
                    ((e - 1.0) * (e + 1.0)).sqrt() * anomaly.sinh(),
                    0.0,
                ];
                close(&orbit, t, place, 3e-14);
            }
        }
    }

    #[test]
    fn there_and_back_at_all_scales() {
        for (length, mu) in [(7e6_f64, 3.986_004_418e14), (1e-10, 1e-40), (1e20, 1e31)] {
            let speed = (mu / length).sqrt();
            let r = Vector3::new(0.6, -0.3, 0.9) * length;
            let v = Vector3::new(0.3, 0.9, 0.2) * speed;
            let there = Orbit::new(mu, &r, &v).expect("orbit");
            for turns in [0.3, 17.4, -80.0] {
                let t = turns * length / speed;
                let (r_then, v_then) = there.at(t);
                let energy = |r: &Vector3<f64>, v: &Vector3<f64>| 0.5 * v.dot(v) - mu / r.norm();
                let (before, after) = (energy(&r, &v), energy(&r_then, &v_then));
                assert!((after - before).abs() < 1e-14 * speed * speed);
                let back = Orbit::new(mu, &r_then, &v_then).expect("orbit").at(-t).0;
                assert!((back - r).norm() < 1e-12 * length, "{turns} {back} {r}");
            }
        }
        assert!(Orbit::new(1.0, &Vector3::x(), &Vector3::x()).is_err());
        assert!(Orbit::new(0.0, &Vector3::x(), &Vector3::y()).is_err());
        assert!(Orbit::new(1.0, &Vector3::zeros(), &Vector3::y()).is_err());
    }

    #[test]
    fn functions_after_a_small_step_follow_from_those_before() {
        for beta in [1.7_f64, -1.7, 1e-9, 0.0] {
            for s in [0.3, -2.0, 7.0] {
                let before = stumpff_functions(beta, s);
                // To the largest step for which they are taken from there, in units of 1/√|β|.
                for part in [1e-9, -1e-6, 0.99e-4, -0.99e-4] {
                    let h = part / beta.abs().sqrt().max(0.1);
                    let (found, exact) = (
                        shift_functions(&before, beta, h),
                        stumpff_functions(beta, s + h),
                    );
                    let size = exact.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                    for k in 0..4 {
                        assert!(
                            (found[k] - exact[k]).abs() < 4e-15 * size,
                            "{beta} {s} {h} {k}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_neighbours() {
        let cases = [
            // An ellipse at either side of where the series of G₄ and G₅ end, and revolutions later; a hyperbola; a parabola.
            ([1.0, 0.2, -0.1], [0.1, 0.9, 0.3], [0.4, 2.5, -1.5, 60.0]),
            ([1.0, 0.2, -0.1], [0.5, 1.6, 0.3], [0.4, 2.5, -9.0, 60.0]),
            ([0.5, 0.0, 0.0], [0.0, 2.0, 0.0], [0.4, 2.5, -9.0, 60.0]),
        ];
        for (position, velocity, times) in cases {
            let numbers = |shift: f64, column: usize| {
                let mut x = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                x[1..4].copy_from_slice(&position);
                x[4..].copy_from_slice(&velocity);
                x[column] += shift;
                x
            };
            let orbit = |[mu, a, b, c, u, v, w]: [f64; 7]| {
                Orbit::new(mu, &Vector3::new(a, b, c), &Vector3::new(u, v, w)).expect("orbit")
            };
            for t in times {
                let (r, v) = orbit(numbers(0.0, 0)).at_with_derivatives::<7>(t, Jet::variable);
                let (r0, v0) = orbit(numbers(0.0, 0)).at(t);
                assert!((r.map(|x| x.value) - r0).norm() < 1e-13 * r0.norm());
                assert!((v.map(|x| x.value) - v0).norm() < 1e-13 * v0.norm());
                for column in 0..7 {
                    // Differences of fourth order.
                    let h = 2e-3 / (1.0 + t.abs());
                    let at = |shift| orbit(numbers(shift, column)).at(t);
                    let ends = [at(h), at(-h), at(2.0 * h), at(-2.0 * h)];
                    let slope = |pick: fn(&State) -> Vector3<f64>| {
                        let [a, b, c, d] = ends.each_ref().map(pick);
                        ((a - b) * 8.0 - (c - d)) / (12.0 * h)
                    };
                    for (own, slope) in [(r, slope(|state| state.0)), (v, slope(|state| state.1))] {
                        let error = (own.map(|x| x.slopes[column]) - slope).norm();
                        assert!(error < 1e-5 * (1.0 + slope.norm()), "{t} {column}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_state_is_known_up_to_the_reach_and_beyond_it_to_nobody() {
        let orbit =
            |speed: f64| Orbit::new(1.0, &Vector3::x(), &(Vector3::y() * speed)).expect("orbit");
        for speed in [1.0, 1.3, 1.41, 2.0_f64.sqrt(), 1.5] {
            let one = orbit(speed);
            let reach = one.reach * one.time;
            for sense in [1.0, -1.0] {
                assert!(one.check(sense * reach).is_ok());
                assert!(one.check(sense * reach.next_up()).is_err());
                let (r, v) = one.at(sense * reach);
                assert!(
                    r.iter().chain(&v).all(|x| x.is_finite()),
                    "{speed}: {r} {v}"
                );
                // The energy shows whether the state is one of the orbit, wherever on it.
                let energy = 0.5 * v.norm_squared() - 1.0 / r.norm();
                assert!(
                    (energy - 0.5 * speed * speed + 1.0).abs() < 1e-13,
                    "{speed} {energy}"
                );
            }
            assert!(one.check(f64::INFINITY).is_ok() && one.check(f64::NAN).is_ok());
        }
        // A circle: 2⁸⁸ revolutions.
        let turns = orbit(1.0).reach * orbit(1.0).time / orbit(1.0).period();
        assert!((turns / 2.0_f64.powi(88) - 1.0).abs() < 0.01, "{turns:e}");
    }
}
