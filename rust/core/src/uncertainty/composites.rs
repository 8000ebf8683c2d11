//! Doubts of bodies put together, where parts may be many: each part's doubts go into the whole by themselves.
//!
//! With `d_k = C_k − C`, to first order
//!
//! - `δm = Σ δm_k`,
//! - `δC = Σ (δm_k d_k + m_k δC_k)/m`,
//! - `δI = Σ δI_k + δm_k (d_k² 1 − d_k d_kᵀ) + m_k (2 d_k·δC_k 1 − δC_k d_kᵀ − d_k δC_kᵀ)`,
//!
//! where δC itself drops out of δI, since `Σ m_k d_k = 0`.

use super::doubt::{Doubt, Tangent};
use super::variable::PROBES;
use crate::mass::ten::Ten;
use crate::numerics::parabola::Parabola;

/// The doubts of bodies put together, each with the sign +1, or −1 where it is taken out.
#[must_use]
pub fn together(parts: &[(f64, Ten<f64>, &Doubt)]) -> Doubt {
    let whole = Ten::together(parts.iter().map(|(sign, part, _)| (*sign, part)));
    let count = parts.iter().map(|(_, _, doubt)| doubt.tangents.len()).sum();
    let mut tangents = Vec::with_capacity(count);
    for (sign, part, doubt) in parts {
        let share = Share::of(*sign, part, &whole);
        tangents.extend(
            (doubt.tangents.iter()).map(|(variable, tangent)| (*variable, share.take(tangent))),
        );
    }
    Doubt::of(tangents, bends(parts))
}

/// What a part does to the whole.
struct Share {
    sign: f64,
    mass: f64,
    d: [f64; 3],
    over: f64,
}

impl Share {
    fn of(sign: f64, part: &Ten<f64>, whole: &Ten<f64>) -> Self {
        Self {
            sign,
            mass: part.mass,
            d: std::array::from_fn(|k| part.center[k] - whole.center[k]),
            over: sign / whole.mass,
        }
    }

    /// The whole's change by a change of the part.
    fn take(&self, change: &Tangent) -> Tangent {
        let ([x, y, z], [a, b, c]) = (self.d, change.center);
        let (dm, m) = (change.mass, self.mass);
        let (xx, yy, zz) = (
            dm * x * x + 2.0 * m * x * a,
            dm * y * y + 2.0 * m * y * b,
            dm * z * z + 2.0 * m * z * c,
        );
        let cross = |x: f64, y: f64, a: f64, b: f64| -(dm * x * y + m * (x * b + y * a));
        let arm = [
            yy + zz,
            xx + zz,
            xx + yy,
            cross(x, y, a, b),
            cross(x, z, a, c),
            cross(y, z, b, c),
        ];
        Tangent {
            mass: self.sign * dm,
            center: std::array::from_fn(|k| self.over * (dm * self.d[k] + m * change.center[k])),
            inertia: std::array::from_fn(|k| self.sign * (change.inertia[k] + arm[k])),
        }
    }
}

/// The second-order terms of the whole along the probes.
fn bends(parts: &[(f64, Ten<f64>, &Doubt)]) -> [Tangent; PROBES] {
    let along: Vec<(f64, [Ten<Parabola>; PROBES])> = parts
        .iter()
        .map(|(sign, part, doubt)| (*sign, doubt.probes(part)))
        .collect();
    std::array::from_fn(|probe| {
        Ten::together(along.iter().map(|(sign, part)| (*sign, &part[probe])))
            .map(|number| number.bend)
    })
}
