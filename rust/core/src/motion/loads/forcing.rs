//! What of a load depends on the time alone.

use nalgebra::Vector3;

use std::fmt::Debug;

use super::body_at_point::BodyAtPoint;
use super::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::kinematics::Frame;
use crate::numerics::number::Real;

/// The parts of a load that go with the time, around one time; times and rates in units of the unit of rates.
#[derive(Clone, Debug)]
pub(crate) struct Forcing<X> {
    /// Torques in principal axes over the moments: coefficients of a cubic.
    pub in_body: [Vector3<X>; 4],
    /// Torques in N: coefficients of a cubic.
    pub in_space: [Vector3<X>; 4],
    /// One for each gravity gradient that acts.
    pub orbits: Vec<OnOrbit<X>>,
    /// Whether these are known already and not asked for.
    pub has_orbits: bool,
}

/// A state on an orbit, lengths over the distance r₀ of this time, times in the unit of rates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnOrbit<X> {
    /// From the attractor, in N: a unit vector.
    pub position: Vector3<X>,
    /// In N.
    pub velocity: Vector3<X>,
    /// μ/r₀³.
    pub pull: X,
    /// 3μ/r₀³ times the factor of the load.
    pub strength: X,
}

impl<X: Real> Default for Forcing<X> {
    fn default() -> Self {
        Self {
            in_body: [Vector3::zeros(); 4],
            in_space: [Vector3::zeros(); 4],
            orbits: Vec::new(),
            has_orbits: false,
        }
    }
}

impl<X: Real> Forcing<X> {
    /// Nothing acts, and nothing is known.
    pub(crate) fn clear(&mut self) {
        self.in_body = [Vector3::zeros(); 4];
        self.in_space = [Vector3::zeros(); 4];
        self.orbits.clear();
        self.has_orbits = false;
    }
}

impl<X: Real> OnOrbit<X> {
    /// That of a term that does not act.
    #[must_use]
    pub(crate) fn none() -> Self {
        Self {
            position: Vector3::new(X::zero(), X::zero(), X::one()),
            velocity: Vector3::zeros(),
            pull: X::zero(),
            strength: X::zero(),
        }
    }
}

/// A time at which a step begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct When<X> {
    /// Since the start of the motion, and when that was.
    pub elapsed: X,
    /// The start of the motion.
    pub start: f64,
    /// The time as a double.
    pub time: f64,
    /// A time within the segment, which has no breaks.
    pub middle: f64,
    /// The unit of rates.
    pub unit: f64,
}

/// A torque that depends on the time: a cubic between two breaks.
pub(crate) trait Timed<X: LawNumber>: Debug {
    /// The frame that its components are in.
    fn frame(&self) -> Frame;

    /// The coefficients of the cubic around a time, in the body's axes or in N, in units of the unit of rates.
    fn cubic(&self, axes: &PrincipalFrame<'_, X>, when: &When<X>) -> [Vector3<X>; 4];

    /// About the square of the fastest rate that it makes in a segment with the time `middle` in it; `over_moment` is one over the
    /// least moment of inertia.
    fn square_of_rate(&self, body: &BodyAtPoint, middle: f64, over_moment: f64) -> f64;

    /// The sizes of its torques around a time along a unit vector of B, and in all.
    fn torques_along(&self, axis: &Vector3<f64>, middle: f64) -> Vec<(f64, f64)>;
}

/// A gravity gradient, whose torque `r×I r` has no component along an axis without a moment.
pub(crate) trait Orbiting<X: LawNumber>: Debug {
    /// Where the body is at a time.
    fn on_orbit(&self, axes: &PrincipalFrame<'_, X>, when: &When<X>) -> OnOrbit<X>;

    /// About the square of the fastest rate that it makes.
    fn square_of_rate(&self, body: &BodyAtPoint) -> f64;
}
