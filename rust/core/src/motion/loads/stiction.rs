//! Wheels at rest in bearings with dry friction.
//!
//! At rest the torque of the bearing follows from all other torques and from the body. With the wheels of a set at rest relative to
//! the body
//!
//! ```text
//! (I' + Σ J a aᵀ) ω̇ = N' + Σ a τ − ω × I'ω,   f = J a·ω̇ − τ
//! ```
//!
//! where I' is the tensor without the wheels, N' the torque beside it, which counts `−a τ` of the motors and `−ω × h a` of the
//! wheels, and f the torque of the bearing on the wheel. A wheel rests as long as |f| is at most that of the friction.

use nalgebra::{Matrix3, Vector3};

use super::bearing::Bearing;
use super::load::Load;
use super::wrench::Wrench;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::state::Phase;

/// What moves a body with wheels at rest in their bearings.
#[derive(Clone, Debug)]
pub(crate) struct Stiction {
    euler: EulerEquations,
    wheels: Vec<Bearing>,
    /// (I' + Σ J a aᵀ)⁻¹, in B.
    inverse: Matrix3<f64>,
}

impl Stiction {
    /// Of those of the `bearings` that rest, in a body with these equations; nothing where all turn.
    pub(crate) fn of(euler: &EulerEquations, bearings: &[Bearing]) -> Option<Self> {
        let wheels: Vec<_> = bearings
            .iter()
            .filter(|bearing| bearing.turns == 0.0)
            .copied()
            .collect();
        if wheels.is_empty() {
            return None;
        }
        let moments = Matrix3::from_diagonal(&Vector3::from(euler.moments()));
        let mut tensor = euler.axes() * moments * euler.axes().transpose();
        for wheel in &wheels {
            tensor += wheel.axis * wheel.axis.transpose() * wheel.inertia;
        }
        Some(Self {
            euler: *euler,
            // Not a number where there is none: the run says so.
            inverse: tensor
                .cholesky()
                .map_or_else(|| Matrix3::repeat(f64::NAN), |factors| factors.inverse()),
            wheels,
        })
    }

    /// Brings the wheels, which turn by some roundings, to rest without a change of the momentum of all.
    pub(crate) fn stop(&self, phase: &mut Phase) {
        let axes = self.euler.axes();
        let moments = Vector3::from(self.euler.moments());
        let mut momentum = axes * moments.component_mul(&axes.tr_mul(&phase.omega));
        for wheel in &self.wheels {
            momentum += wheel.axis * phase.internal_state[wheel.index];
        }
        phase.omega = self.inverse * momentum;
        self.keep(phase);
    }

    /// Keeps the wheels at rest to the last digit.
    pub(crate) fn keep(&self, phase: &mut Phase) {
        for wheel in &self.wheels {
            wheel.keep(phase);
        }
    }

    /// The torque, beside the tensor without the wheels, with that of the bearings at rest in it; their rates ḣ into `rates`,
    /// where those of their motors are.
    pub(crate) fn hold(
        &self,
        omega: &Vector3<f64>,
        torque: &Vector3<f64>,
        rates: &mut [f64],
    ) -> Vector3<f64> {
        let mut all = torque - self.euler.torque(omega, &Vector3::zeros());
        for wheel in &self.wheels {
            all += wheel.axis * rates[wheel.index];
        }
        let acceleration = self.inverse * all;
        let mut torque = *torque;
        for wheel in &self.wheels {
            let rate = wheel.inertia * wheel.axis.dot(&acceleration);
            torque -= wheel.axis * (rate - rates[wheel.index]);
            rates[wheel.index] = rate;
        }
        torque
    }
}

/// What a load exerts at a state outside a run, on a body with these equations (without the wheels that turn freely): the bearings at
/// rest hold as far as they can.
///
/// # Errors
/// As [`Load::wrench`].
pub fn wrench_at<L: Load>(
    load: &mut L,
    euler: &EulerEquations,
    t: f64,
    phase: &Phase,
) -> Result<Wrench, L::Error> {
    load.settle(t, phase);
    let mut bearings = load.bearings().to_vec();
    let mut motors = vec![0.0; phase.internal_state.len()];
    let mut wrench = load.act(t, phase, &mut motors)?;
    // One after the other slips, first the one that is furthest beyond its most.
    while let Some(resting) = Stiction::of(euler, &bearings) {
        let mut rates = motors.clone();
        let torque = resting.hold(&phase.omega, &wrench.torque, &mut rates);
        let held = |bearing: &Bearing| rates[bearing.index] - motors[bearing.index];
        let slips =
            |bearing: &Bearing| bearing.turns == 0.0 && bearing.until_slip(held(bearing)) < 0.0;
        let share = |bearing: &Bearing| held(bearing).abs() / bearing.most;
        let worst = (bearings.iter_mut())
            .filter(|bearing| slips(bearing))
            .max_by(|a, b| share(a).total_cmp(&share(b)));
        let Some(worst) = worst else {
            return Ok(Wrench { torque, ..wrench });
        };
        *worst = worst.slipping(held(worst));
        wrench.torque -= worst.axis * worst.friction();
    }
    Ok(wrench)
}
