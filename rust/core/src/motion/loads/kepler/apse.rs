//! The periapsis of a hyperbola, and the functions that lead there.

use nalgebra::Vector3;

use crate::motion::loads::stumpff::{functions, further};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::jet::Jet;
use crate::numerics::number::Real;

/// Numbers in which the motion on an orbit is stated.
pub(super) trait Anomaly: Real {
    /// `G_k(s)` for k = 0..3.
    fn stumpff(beta: Self, s: Self) -> [Self; 4];

    /// s of a hyperbola with `G_1(s) = y`: `asinh(√−β y)/√−β`.
    fn arc(y: Self, beta: Self) -> Self;
}

/// To the precision of doubles: of the time at the periapsis no more is kept.
impl Anomaly for DoubleDouble {
    fn stumpff(beta: Self, s: Self) -> [Self; 4] {
        functions(beta.high, s.high).map(Self::from)
    }

    fn arc(y: Self, beta: Self) -> Self {
        let root = (-beta.high).sqrt();
        Self::from((root * y.high).asinh() / root)
    }
}

/// With `∂G_k/∂s = G_{k−1}` and `∂G_k/∂β = ½ (k G_{k+2} − s G_{k+1})`.
impl<const N: usize> Anomaly for Jet<N> {
    fn stumpff(beta: Self, s: Self) -> [Self; 4] {
        let g = functions(beta.value, s.value);
        let [g4, g5] = further(beta.value, s.value);
        let after = [g[1], g[2], g[3], g4, g5];
        [0, 1, 2, 3].map(|k| {
            let by_beta = 0.5 * (k as f64 * after[k + 1] - s.value * after[k]);
            let by_s = if k == 0 { -beta.value * g[1] } else { g[k - 1] };
            Self::chain(g[k], [(by_s, &s), (by_beta, &beta)])
        })
    }

    fn arc(y: Self, beta: Self) -> Self {
        let s = DoubleDouble::arc(y.value.into(), beta.value.into()).high;
        let [g0, _, g2, g3] = functions(beta.value, s);
        Self::chain(s, [(1.0 / g0, &y), (0.5 * (s * g2 - g3) / g0, &beta)])
    }
}

/// The periapsis of a hyperbola.
pub(super) struct Apse<X> {
    pub(super) position: Vector3<X>,
    pub(super) velocity: Vector3<X>,
    pub(super) distance: X,
    /// The time since then, negative before.
    pub(super) since: X,
}

impl<X: Anomaly> Apse<X> {
    /// Of the orbit through (r, v), with `β = 2μ/r − v²`.
    ///
    /// `μ e⃗ = v × (r × v) − μ r/|r|`, `e = √(1 − β h²/μ²)`, `q = h²/μ(1 + e)`; from there `r·v = e μ sinh(√−β s)/√−β` and
    /// `t = q G₁ + μ G₃`.
    pub(super) fn of(mu: X, beta: X, r: &Vector3<X>, v: &Vector3<X>) -> Self {
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
