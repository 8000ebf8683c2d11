//! The rate of a slender gyrostat about its long axis, from the energy.
//!
//! `ω₁ = (|L| n₁ − h₁)/I₁` has the rounding of n₁ over I₁, which for `I₁ ≪ I₂` is far above that of the attitude. The energy
//! knows ω₁ better where the body turns fast about that axis: `I₁ ω₁² = 2T − I₂ ω₂² − I₃ ω₃²`, of which the rounding is
//! divided by `I₁ ω₁`. So the momentum is moved along the sphere |L| = const. by one step of Newton's method, up or down the
//! slope `2ω` of 2T there, to the ellipsoid of the energy:
//!
//! ```text
//! δL = ω_⊥ (2T − I₁ω₁² − I₂ω₂² − I₃ω₃²)/2ω_⊥²,   δω₁ = δL₁/I₁,   ω_⊥ = ω − n (n·ω)
//! ```

use nalgebra::Vector3;

use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::motion::state::State;
use crate::numerics::double_double::DoubleDouble;

/// I₁ over I₂ below which the rate is taken from the energy.
const SLENDER: f64 = 1e-3;

/// What that takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slender {
    axes: [Vector3<f64>; 3],
    moments: [f64; 3],
    /// h along the axes.
    rotor: [f64; 3],
    /// L in space, and its length.
    momentum: Vector3<f64>,
    length: f64,
    twice_energy: f64,
}

impl Slender {
    /// Of a body with one moment far below the others; `None` of any other, and where energy or momentum are beyond the numbers.
    pub(super) fn of(
        principal: &RefinedPrincipal,
        rotor: &Vector,
        momentum: Vector3<f64>,
        energy: f64,
    ) -> Option<Self> {
        let moments = principal.moments.map(DoubleDouble::rounded);
        let axes = principal.axes();
        let length = momentum.norm();
        let twice_energy = 2.0 * energy;
        let is_known = twice_energy.is_normal() && length.is_normal();
        (moments[0] < SLENDER * moments[1] && is_known).then(|| Self {
            axes: [0, 1, 2].map(|k| Vector3::from_fn(|i, _| axes[(i, k)].high)),
            moments,
            rotor: principal.along(rotor).map(DoubleDouble::rounded),
            momentum,
            length,
            twice_energy,
        })
    }

    /// ω of a state with its component along the long axis as the energy says, where that is the better of the two.
    pub(super) fn settled(&self, state: &State) -> Vector3<f64> {
        let omega = state.omega;
        let there = state.attitude.inverse() * self.momentum;
        let [i1, i2, i3] = self.moments;
        let along = |k: usize| (self.axes[k].dot(&there) - self.rotor[k]) / self.moments[k];
        let rates = [self.axes[0].dot(&omega), along(1), along(2)];
        let n = [0, 1, 2].map(|k| self.axes[k].dot(&there) / self.length);
        let spin: f64 = (0..3).map(|k| rates[k] * n[k]).sum();
        let across = [0, 1, 2].map(|k| rates[k] - spin * n[k]);
        let square: f64 = across.iter().map(|x| x * x).sum();
        // Rounding of 2T over |ω_⊥| beside that of L.
        if self.twice_energy >= square.sqrt() * self.length {
            return omega;
        }
        let [a, b, c] = rates;
        let lack = self.twice_energy - i1 * a * a - i2 * b * b - i3 * c * c;
        let change = across[0] * lack / (2.0 * i1 * square);
        if change.is_finite() {
            omega + self.axes[0] * change
        } else {
            omega
        }
    }
}
