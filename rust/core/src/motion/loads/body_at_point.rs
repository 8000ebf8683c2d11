//! What a load acts on.

use nalgebra::{Matrix3, Vector3};

use crate::mass::RigidBody;

/// What a load acts on: a body, its reference point P, and when the motion starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyAtPoint {
    /// m.
    pub mass: f64,
    /// `I_C` in B.
    pub inertia: Matrix3<f64>,
    /// P from the origin of B.
    pub point: Vector3<f64>,
    /// `c_P = C − P`, in B; exactly zero when P is C.
    pub center: Vector3<f64>,
    /// Whether P is fixed in N; else P is C, and the body is free.
    pub pivoted: bool,
    /// The time at which the motion starts.
    pub start: f64,
}

impl BodyAtPoint {
    /// `body` free, about its centre of mass.
    #[must_use]
    pub fn free(body: &RigidBody, start: f64) -> Self {
        Self {
            mass: body.mass(),
            inertia: body.inertia(),
            point: body.center_of_mass(),
            center: Vector3::zeros(),
            pivoted: false,
            start,
        }
    }

    /// `body` with the origin of its frame fixed in N.
    #[must_use]
    pub fn pivoted(body: &RigidBody, start: f64) -> Self {
        Self {
            point: Vector3::zeros(),
            center: body.center_of_mass(),
            pivoted: true,
            ..Self::free(body, start)
        }
    }
}
