//! What depends on the time alone at the start of a step: series of sampled torques, states on orbits.

use nalgebra::Vector3;

use crate::numerics::number::Real;

/// The parts of a load that go with the time, around one time; times and rates in units of the unit of rates.
#[derive(Clone, Debug)]
pub(super) struct Forcing<X> {
    /// Torques in principal axes over the moments: coefficients of a cubic.
    pub(super) in_body: [Vector3<X>; 4],
    /// Torques in N: coefficients of a cubic.
    pub(super) in_space: [Vector3<X>; 4],
    /// One for each gravity gradient that acts.
    pub(super) orbits: Vec<Orbit<X>>,
}

/// A state on an orbit, lengths over the distance r₀ of this time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Orbit<X> {
    /// From the attractor, in N: a unit vector.
    pub(super) position: Vector3<X>,
    pub(super) velocity: Vector3<X>,
    /// μ/r₀³.
    pub(super) pull: X,
    /// 3μ/r₀³, times how often the torque acts.
    pub(super) strength: X,
}

impl<X: Real> Default for Forcing<X> {
    fn default() -> Self {
        Self {
            in_body: [Vector3::zeros(); 4],
            in_space: [Vector3::zeros(); 4],
            orbits: Vec::new(),
        }
    }
}

impl<X: Real> Orbit<X> {
    /// That of a term that does not act.
    pub(super) fn none() -> Self {
        Self {
            position: Vector3::new(X::zero(), X::zero(), X::one()),
            velocity: Vector3::zeros(),
            pull: X::zero(),
            strength: X::zero(),
        }
    }
}
