//! What depends on the time alone at the start of a step: series of sampled torques, states on orbits.

use nalgebra::Vector3;

/// The parts of a load that go with the time, around one time; times and rates in units of the unit of rates.
#[derive(Clone, Debug, Default)]
pub(super) struct Moment {
    /// Torques in principal axes over the moments: coefficients of a cubic.
    pub(super) in_body: [Vector3<f64>; 4],
    /// Torques in N: coefficients of a cubic.
    pub(super) in_space: [Vector3<f64>; 4],
    /// One for each gravity gradient that acts.
    pub(super) orbits: Vec<Orbit>,
}

/// A state on an orbit, lengths over the distance r₀ of this time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Orbit {
    /// From the attractor, in N: a unit vector.
    pub(super) position: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
    /// μ/r₀³.
    pub(super) pull: f64,
    /// 3μ/r₀³, times how often the torque acts.
    pub(super) strength: f64,
}

impl Orbit {
    /// That of a term that does not act.
    pub(super) const NONE: Self = Self {
        position: Vector3::new(0.0, 0.0, 1.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        pull: 0.0,
        strength: 0.0,
    };
}
