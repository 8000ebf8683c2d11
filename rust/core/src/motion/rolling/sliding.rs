//! The equations of a body that slips on a plane, with the normal force solved.
//!
//! The body has the slip s in the plane as variables besides those of rolling, `v_C = u + s − ω×ρ`, and the force `F = N (n + f) + h` with the
//! friction `f = −μ s/|s|` or `−k s`, or `h = −c s`. That the contact stays in the plane, `n·v̇_P = 0`, is a linear equation for N:
//!
//! ```text
//! I ω̇ = ρ×F − ω×Iω,   s˙ = F/m + g + ω̇×ρ + ω×(ρ̇ + ω×ρ) − u̇
//! N/m [1 + m (ρ×γ)·I⁻¹(ρ×(γ + f))] = −γ·g − γ·ω×(ρ̇ + ω×ρ) − (ρ×γ)·I⁻¹(ρ×h − ω×Iω)
//! ```
//!
//! A resistance to rolling adds its couple to the torque, and its arm a term to the bracket. Where the bracket is not positive there is no force, or more than one: Painlevé's paradox.
//! Source: Painlevé, Leçons sur le frottement (1895).

use super::contact::Friction;
use super::equations::{ContactState, Equations, Motion, against_turn, attitude_rate, level_axes};
use crate::numerics::power_series::{Arithmetic, cross, dot, minus, plus, scaled, transformed};

/// How often the direction of a slip that begins is turned at most, and the angle of its differences.
const MOST_TURNS: usize = 60;
const NEARBY: f64 = 1e-5;

/// The friction of a body that slips.
#[derive(Clone, Copy)]
pub(crate) struct Slipping<N> {
    pub(crate) friction: Friction,
    /// The direction of the slip; none: that of its velocity.
    pub(crate) direction: Option<[N; 2]>,
}

impl Equations {
    /// Compute the motion at a state of a body that slips, for any numbers.
    pub(crate) fn sliding<N: Arithmetic>(
        &self,
        state: &ContactState<N>,
        slipping: Slipping<N>,
    ) -> Motion<N> {
        let ContactState {
            attitude,
            omega,
            normal,
            place: [x, y],
            slip,
            ..
        } = *state;
        let normal_rate = cross(normal, omega);
        let [arm, arm_rate] = self.surface.contact_and_rate(normal, normal_rate);
        let level = level_axes(attitude);
        // f, and h over the mass.
        let zero = omega[0] * 0.0;
        let (friction, drag) = match slipping.friction {
            Friction::Coulomb(mu) if mu > 0.0 => {
                let direction = slipping.direction.unwrap_or_else(|| {
                    let speed = (slip[0] * slip[0] + slip[1] * slip[1]).root();
                    slip.map(|s| s / speed)
                });
                (direction.map(|d| d * -mu), [zero; 2])
            }
            Friction::Coulomb(_) => ([zero; 2], [zero; 2]),
            Friction::ViscousNormal(k) => (slip.map(|s| s * -k), [zero; 2]),
            Friction::Viscous(c) => ([zero; 2], slip.map(|s| s * (-c / self.mass))),
        };
        let in_body = |[a, b]: [N; 2]| plus(scaled(level[0], a), scaled(level[1], b));
        let push = plus(normal, in_body(friction));
        let drag = in_body(drag);
        let turned = |vector: [N; 3]| transformed(&self.inverse, vector);
        // ω̇ = α N/m + β
        let mut torque_of_push = cross(arm, push);
        let (mut by_pressure, mut smooth) = ([zero; 3], [zero; 3]);
        if self.resistance.acts() {
            smooth = self.smooth_couple(omega, normal);
            if self.resistance.arm > 0.0 {
                by_pressure = against_turn(omega, normal).map(|x| x * self.resistance.arm);
                torque_of_push = plus(torque_of_push, by_pressure);
            }
        }
        let by_push = turned(torque_of_push).map(|a| a * self.mass);
        let gyroscopic = cross(omega, transformed(&self.inertia, omega));
        let torque = plus(cross(arm, drag).map(|x| x * self.mass), smooth);
        let without = turned(minus(torque, gyroscopic));
        let inward = cross(omega, plus(arm_rate, cross(omega, arm)));
        let lever = cross(arm, normal);
        let bracket = dot(lever, by_push) + 1.0;
        let pressed = (dot(normal, inward) + dot(lever, without)) * -1.0 + -self.gravity.z;
        let pressure = pressed / bracket;
        let turn = plus(scaled(by_push, pressure), without);
        let lift = plus(scaled(push, pressure), drag);
        let speed = [0, 1].map(|i| dot(level[i], arm_rate) + slip[i]);
        let speed = [
            speed[0] + y * -self.turntable,
            speed[1] + x * self.turntable,
        ];
        let change = plus(plus(lift, cross(turn, arm)), inward);
        let slip_rate = [
            dot(level[0], change) + speed[1] * self.turntable + self.gravity.x,
            dot(level[1], change) + speed[0] * -self.turntable + self.gravity.y,
        ];
        let couple = plus(smooth, scaled(by_pressure, pressure * self.mass));
        let power = [
            dot(lift, level[0]) * (slip[0] + y * -self.turntable),
            dot(lift, level[1]) * (slip[1] + x * self.turntable),
        ];
        Motion {
            rates: ContactState {
                attitude: attitude_rate(attitude, omega),
                omega: turn,
                normal: normal_rate,
                place: speed,
                slip: slip_rate,
                work: (power[0] + power[1]) * self.mass + dot(couple, omega),
                height: [zero; 2],
            },
            lift,
            level,
            arm,
            bracket,
            couple,
        }
    }

    /// Compute the direction in which a slip begins: against the force that rolling would need, and so that friction against it leaves the
    /// slip in it.
    pub(crate) fn parting_direction(
        &self,
        state: &ContactState<f64>,
        friction: Friction,
    ) -> [f64; 2] {
        let state = ContactState {
            slip: [0.0; 2],
            ..*state
        };
        let motion = self.motion(&state);
        let needed = motion.level.map(|axis| -dot(motion.lift, axis));
        let length = needed[0].hypot(needed[1]);
        if length == 0.0 {
            return [1.0, 0.0];
        }
        let mut direction = needed.map(|x| x / length);
        let across = |[x, y]: [f64; 2]| {
            let direction = Some([x, y]);
            let motion = self.sliding(
                &state,
                Slipping {
                    friction,
                    direction,
                },
            );
            let [u, v] = motion.rates.slip;
            x * v - y * u
        };
        let turned = |[x, y]: [f64; 2], angle: f64| {
            let (sin, cos) = angle.sin_cos();
            [x * cos - y * sin, x * sin + y * cos]
        };
        for _ in 0..MOST_TURNS {
            let off = across(direction);
            let slope = (across(turned(direction, NEARBY)) - across(turned(direction, -NEARBY)))
                / (2.0 * NEARBY);
            let turn = -off / slope;
            if !turn.is_finite() || turn.abs() <= f64::EPSILON {
                break;
            }
            direction = turned(direction, turn.clamp(-0.5, 0.5));
        }
        direction
    }
}
