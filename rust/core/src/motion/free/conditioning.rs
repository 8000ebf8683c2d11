//! How well a state of a free motion is determined by numbers that are known to so many digits.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::FreeMotion;
use super::invariants::Invariants;
use super::sensitivity::Sensitivity;
use crate::motion::state::ClosedForm;
use crate::numerics::turns::{MOST_TURNS, PHASE_ERROR};

/// Bounds, to first order, on the change of a state at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBar {
    /// Of the attitude, an angle in radians.
    pub attitude: f64,
    /// Of ω, its length.
    pub omega: f64,
}

impl FreeMotion {
    /// The bounds at the time t: see [`Sensitivity::error_bar`], and what the phases are known to. Infinite where nothing is
    /// known, beyond float64 or beyond [`ClosedForm::reach`]; NaN for a t that is.
    #[must_use]
    pub fn error_bar(&self, t: f64, rtol: f64) -> ErrorBar {
        if t.abs() > self.reach() {
            return ErrorBar {
                attitude: f64::INFINITY,
                omega: f64::INFINITY,
            };
        }
        // In units of the motion, where nothing leaves the range of float64 that is within it.
        let motion = Invariants::of_motion(self);
        let unit = motion.rate_unit;
        let omega = self.initial.omega / unit;
        let bar = self
            .scaled_sensitivity(&motion, t)
            .error_bar(&omega, &motion.moments, rtol);
        let turns = t.abs() / self.reach() * MOST_TURNS;
        let phase = TAU * turns * PHASE_ERROR;
        let known = |bound: f64| {
            if bound.is_nan() && !t.is_nan() {
                f64::INFINITY
            } else {
                bound
            }
        };
        ErrorBar {
            attitude: known(bar.attitude + phase),
            omega: known(bar.omega + phase * omega.norm()) * unit,
        }
    }
}

impl Sensitivity {
    /// What relative errors `rtol` of ω and of each moment, and a turn of the attitude by `rtol` radians, can do together,
    /// in the worst directions: `rtol (‖∂/∂δ‖ + |ω|‖∂/∂ω‖ + Σ I_k‖∂/∂I_k‖)` in the spectral norm.
    ///
    /// A body with a zero moment has no derivatives by its moments; they are then left out.
    #[must_use]
    pub fn error_bar(&self, omega: &Vector3<f64>, moments: &[f64; 3], rtol: f64) -> ErrorBar {
        let of = |row: usize| {
            let block = |column| self.state.fixed_view::<3, 3>(row, column).into_owned();
            let norm = |column| block(column).singular_values().max();
            let by_moments: f64 = if moments[0] > 0.0 {
                let by = |k: usize| self.moments.fixed_view::<3, 1>(row, k).norm();
                (0..3).map(|k| moments[k] * by(k)).sum()
            } else {
                0.0
            };
            rtol * (norm(0) + omega.norm() * norm(3) + by_moments)
        };
        ErrorBar {
            attitude: of(0),
            omega: of(3),
        }
    }
}
