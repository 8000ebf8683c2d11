//! A motion as series, and the units of torques.

use super::numbers::Rows;

/// ω and the attitude (x, y, z, w) of the principal axes as series.
#[derive(Clone, Debug, Default)]
pub(super) struct Motion {
    pub(super) omega: Rows<3>,
    pub(super) attitude: Rows<4>,
}

/// The units of torques: of moments, and of rates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Units {
    pub(super) inertia: f64,
    pub(super) rate: f64,
}

impl Units {
    /// One over the unit of torques.
    pub(super) fn over_torque(self) -> f64 {
        1.0 / self.inertia / self.rate / self.rate
    }
}
