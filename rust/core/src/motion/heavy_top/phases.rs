//! The steady rates of the three phases of a heavy top, and the shifts of their theta functions.
//!
//! `|α|² = (1 + u)/2`, `|β|² = (1 − u)/2` and `|W|² = 2κ (u_e − u)` are linear in u, that is in sn²; the phases turn at
//! `½ (a + b)/(1 + u)`, `½ (a − b)/(1 − u)` and `−½ b − ½ (a − b u_e)/(u_e − u)`. So each of the three is a quotient of theta functions of
//! `z = πλt/2K`, shifted to its zero, turning besides at a steady rate Ω that is a complete integral of the third kind:
//!
//! ```text
//! α ∝ ϑ₁(z + i s y)/ϑ₄(z) e^{iΩt}    β, W ∝ ϑ₂(z + i s y)/ϑ₄(z) e^{iΩt}
//! ```
//!
//! with `s_α = −sgn(a + b)`, `s_β = −sgn(a − b)`, `s_W = sgn(a − b u_e)`.

use super::reduced::ReducedTop;
use super::turning_points::TurningPoints;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::{MultiPrecision, complete_first, complete_third, incomplete_first};
use crate::numerics::theta::HalfPeriods;

/// 1/2π.
pub(super) const TURN: DoubleDouble = DoubleDouble {
    high: 0.159_154_943_091_895_35,
    low: -9.839_338_337_591_243e-18,
};

/// What a motion that is not steady is made of. Rates are in turns per unit of time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Phases {
    /// K and K′ of the motion of u; K is infinite on the separatrix.
    pub(super) half: HalfPeriods,
    /// λ: the argument of the elliptic functions is λt and a constant.
    pub(super) lambda: DoubleDouble,
    /// `λ/4K`: z in turns; a period of u is half a turn. Zero on the separatrix.
    pub(super) clock: DoubleDouble,
    /// z at time zero in turns, within a quarter either way; on the separatrix the argument itself.
    pub(super) start: DoubleDouble,
    /// Ω of α, β and W.
    pub(super) steady: [DoubleDouble; 3],
    /// The shifts `s·2Ky/π`, within K′.
    pub(super) shifts: [f64; 3],
    /// `s_α`, `s_β`, `s_W`.
    pub(super) signs: [f64; 3],
    /// `Ω_W = Ω_β − Ω_α` and this many times the clock: one up or down.
    pub(super) carry: f64,
}

impl Phases {
    pub(super) fn of<T: MultiPrecision>(motion: &ReducedTop<T>, points: &TurningPoints<T>) -> Self {
        let (zero, one) = (T::from(0.0), T::from(1.0));
        let two_kappa = motion.kappa.scaled(2.0);
        let (sum, difference, rest) = (motion.sum(), motion.difference(), motion.rest());
        let signs = [-sign(sum), -sign(difference), sign(rest)];
        let carry = if motion.excess().rounded() <= 0.0 {
            -signs[1]
        } else {
            signs[2]
        };
        let lambda = points.height.sqrt().scaled(0.5);
        let k_prime = (points.gap / points.height).sqrt();
        let k = (two_kappa * points.range / points.height).sqrt().rounded();
        let imaginary = if k == 0.0 {
            f64::INFINITY
        } else {
            complete_first(k)
        };

        // Ω_α = ½ (a + b)/(u₃ − u₁) ⟨sn²/(1 + (1 + u₁)/(u₃ − u₁) sn²)⟩, on the separatrix with sn² = 1.
        let p = one + two_kappa * points.above_bottom / points.height;
        let scale = (two_kappa * sum / points.height).scaled(0.5);
        if k_prime.rounded() == 0.0 {
            let (alpha, zero) = ((scale / p).twofold() * TURN, DoubleDouble::default());
            return Self {
                half: HalfPeriods {
                    real: f64::INFINITY,
                    imaginary,
                },
                lambda: lambda.twofold(),
                clock: zero,
                start: start(motion, points, 0.0, f64::INFINITY),
                steady: [alpha, zero, -alpha],
                shifts: [signs[0] * bottom_shift(points, 1.0), 0.0, 0.0],
                signs,
                carry,
            };
        }
        let (first, third) = complete_third(k_prime, p, zero, one);
        let clock = (lambda.scaled(0.25) / first).twofold();
        let alpha = (scale * third / first).twofold() * TURN;
        let beta = beta_rate(
            two_kappa,
            difference,
            points,
            k_prime,
            clock.scaled(signs[1]),
        );
        Self {
            half: HalfPeriods {
                real: first.rounded(),
                imaginary,
            },
            lambda: lambda.twofold(),
            clock,
            start: start(motion, points, k_prime.rounded(), first.rounded()),
            steady: [alpha, beta, beta - alpha + clock.scaled(carry)],
            shifts: shifts(two_kappa.rounded(), points, k, &signs),
            signs,
            carry,
        }
    }

    /// Ω of α, β and W without the winding of the theta functions: the mean rates of the phases of α and β, in turns.
    pub(super) fn mean(&self) -> [DoubleDouble; 2] {
        [0, 1].map(|i| self.steady[i] - self.clock.scaled(self.signs[i]))
    }
}

/// Ω of β in turns, of the two forms the one whose integral is the tamer:
/// `−½ (a − b)/(u₃ − u₁) ⟨sn²/(1 − (1 − u₁)/(u₃ − u₁) sn²)⟩`, or `½ (a − b)/(1 − u₁) ⟨1/(1 − (u₂ − u₁)/(1 − u₁) sn²)⟩ + s_β π/T`.
fn beta_rate<T: MultiPrecision>(
    two_kappa: T,
    difference: T,
    points: &TurningPoints<T>,
    k_prime: T,
    turn: DoubleDouble,
) -> DoubleDouble {
    let (zero, one) = (T::from(0.0), T::from(1.0));
    let mean = |p, a| {
        let (first, third) = complete_third(k_prime, p, a, one);
        third / first
    };
    let (beyond, below) = (
        points.beyond_top / points.height,
        points.below_top / points.depth,
    );
    if difference.rounded() == 0.0 && beyond.rounded() > 0.0 {
        DoubleDouble::default()
    } else if beyond.rounded() >= below.rounded() {
        let rate = two_kappa * difference / points.height * mean(beyond, zero);
        -(rate.twofold() * TURN).scaled(0.5)
    } else {
        let rate = difference / points.depth * mean(below, one);
        (rate.twofold() * TURN).scaled(0.5) + turn
    }
}

/// z at time zero: in turns, or on the separatrix the argument itself. From the nearer of the two turning points.
fn start<T: MultiPrecision>(
    motion: &ReducedTop<T>,
    points: &TurningPoints<T>,
    k_prime: f64,
    k: f64,
) -> DoubleDouble {
    let way = sign(motion.rate);
    let [fall, rise, range] = [points.fall, points.rise, points.range].map(T::rounded);
    if range <= 0.0 {
        return DoubleDouble::default();
    }
    let (sine, cosine) = ((fall / range).sqrt(), (rise / range).sqrt());
    if k.is_infinite() {
        return (way * incomplete_first(sine, cosine, 0.0)).into();
    }
    if k_prime * sine * sine <= cosine * cosine {
        return (way * incomplete_first(sine, cosine, k_prime) / (4.0 * k)).into();
    }
    // K − u has the tangent of its amplitude inverted, over k′.
    let (s, c) = (cosine, k_prime * sine);
    let size = s.hypot(c);
    let from_end = incomplete_first(s / size, c / size, k_prime) / (4.0 * k);
    DoubleDouble::sum(way * 0.25, -way * from_end)
}

/// The shifts, with their signs: `tan²` of each amplitude is `|c − u₁|/(u₂ − u₁)` for α, `(c − u₂)(u₃ − u₁)/((u₂ − u₁)(u₃ − c))`
/// for β and W, with c = −1, 1 and `u_e`.
fn shifts<T: MultiPrecision>(
    two_kappa: f64,
    points: &TurningPoints<T>,
    k: f64,
    signs: &[f64; 3],
) -> [f64; 3] {
    let [height, range] = [points.height, points.range].map(T::rounded);
    let top = amplitude(
        points.below_top.rounded() * height,
        range * points.beyond_top.rounded(),
        k,
    );
    let rest = amplitude(
        points.slowest.rounded() * height,
        two_kappa * range * points.beyond_rest.rounded(),
        k,
    );
    [
        signs[0] * bottom_shift(points, k),
        signs[1] * top,
        signs[2] * rest,
    ]
}

fn bottom_shift<T: MultiPrecision>(points: &TurningPoints<T>, k: f64) -> f64 {
    amplitude(points.above_bottom.rounded(), points.range.rounded(), k)
}

/// `∫₀^φ dφ/√(cos²φ + k² sin²φ)` for tan²φ = a/b; zero where both are.
fn amplitude(a: f64, b: f64, k: f64) -> f64 {
    if a <= 0.0 {
        return 0.0;
    }
    let (sine, cosine) = ((a / (a + b)).sqrt(), (b / (a + b)).sqrt());
    if cosine == 0.0 && k == 0.0 {
        return f64::INFINITY;
    }
    incomplete_first(sine, cosine, k)
}

fn sign<T: MultiPrecision>(x: T) -> f64 {
    if x.rounded() < 0.0 { -1.0 } else { 1.0 }
}
