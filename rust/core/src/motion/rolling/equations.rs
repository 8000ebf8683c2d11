//! Newton's and Euler's equations of a body that rolls on a plane, with the constraint solved.
//!
//! The velocity `v_C = u − ω×ρ` follows from the constraint, so the force of the plane is `F = m (v̇_C − g)`, and Euler's equations
//! with the torque `ρ×F` become
//!
//! ```text
//! [I + m (ρ² − ρ ρᵀ)] ω̇ = m ρ × (u̇ − ω×(ρ̇ + ω×ρ) − g) − ω × I ω
//! γ̇ = γ×ω,   q̇ = ½ q∘ω,   Ṗ = u + R ρ̇,   u = Ω n×P,   u̇ = Ω n×Ṗ
//! ```
//!
//! with the rate ρ̇ of the contact in the body, which follows from γ̇. Height and slip are zero by this choice of variables.
//! Source: Borisov & Mamaev, Regular and Chaotic Dynamics 7 (2002) 177, § 2.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::contact::{Contact, Resistance};
use super::surface::Surface;
use crate::mass::RigidBody;
use crate::motion::state::Phase;
use crate::numerics::power_series::{Arithmetic, cross, dot, minus, plus, scaled, transformed};

/// A body, its surface and the plane, in axes W of the plane: the third is its normal, the origin the point it turns about.
#[derive(Clone, Debug)]
pub(crate) struct Equations {
    /// m, and I about C.
    pub(super) mass: f64,
    pub(super) inertia: Matrix3<f64>,
    /// Relative to C.
    pub(super) surface: Surface,
    /// g in W.
    pub(super) gravity: Vector3<f64>,
    /// Ω.
    pub(super) turntable: f64,
    /// `I⁻¹`; zero where a body has no moment about an axis.
    pub(super) inverse: Matrix3<f64>,
    pub(super) resistance: Resistance,
}

/// How many variables a state has: all of them, of a body on a plane, and of one that rolls on a plane that does no work.
pub(crate) const VARIABLES: usize = 17;
pub(crate) const OF_CONTACT: usize = 15;
pub(crate) const OF_ROLLING: usize = 12;

/// The state of contact: (x, y, z, w) of the attitude in W, ω in B, γ, the point of contact in the plane, the slip there, and the work of
/// the plane so far. Of a body that flies, the place and the velocity of C along the plane stand for those of the contact, and its height
/// over the plane with the rate of that is known too.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactState<N> {
    pub(crate) attitude: [N; 4],
    pub(crate) omega: [N; 3],
    pub(crate) normal: [N; 3],
    pub(crate) place: [N; 2],
    pub(crate) slip: [N; 2],
    pub(crate) work: N,
    pub(crate) height: [N; 2],
}

impl<N: Copy> ContactState<N> {
    /// Return the state of these variables.
    pub(crate) fn of(variables: &[N; VARIABLES]) -> Self {
        let [x, y, z, w, p, q, r, a, b, c, u, v, s, t, work, h, rise] = *variables;
        Self {
            attitude: [x, y, z, w],
            omega: [p, q, r],
            normal: [a, b, c],
            place: [u, v],
            slip: [s, t],
            work,
            height: [h, rise],
        }
    }

    /// Return the variables of this state, or of its rates.
    pub(crate) fn variables(&self) -> [N; VARIABLES] {
        let ([x, y, z, w], [p, q, r]) = (self.attitude, self.omega);
        let ([a, b, c], [u, v], [s, t]) = (self.normal, self.place, self.slip);
        let [h, rise] = self.height;
        [x, y, z, w, p, q, r, a, b, c, u, v, s, t, self.work, h, rise]
    }
}

impl ContactState<f64> {
    /// Compute the size of the part of ω along the plane.
    pub(crate) fn omega_along_plane(&self) -> f64 {
        let (omega, normal) = (Vector3::from(self.omega), Vector3::from(self.normal));
        omega.cross(&normal).norm()
    }
}

/// The rates of a state, and the acceleration of C less that of gravity, in body axes: the force of the plane over the mass.
pub(crate) struct Motion<N> {
    pub(crate) rates: ContactState<N>,
    pub(crate) lift: [N; 3],
    /// The first two axes of W, and ρ with its rate, in body axes.
    pub(crate) level: [[N; 3]; 2],
    pub(crate) arm: [N; 3],
    /// What multiplies N/m in the equation for it: 1 of a body that rolls.
    pub(crate) bracket: N,
    /// The couple of the plane, in body axes.
    pub(crate) couple: [N; 3],
}

impl Equations {
    /// Make the equations of a body under uniform gravity.
    pub(crate) fn new(body: &RigidBody, contact: &Contact, gravity: &Vector3<f64>) -> Self {
        Self {
            mass: body.mass(),
            inertia: body.inertia(),
            surface: contact.surface.relative_to(&body.center_of_mass(), 1.0),
            gravity: contact.plane_axes().transpose() * gravity,
            turntable: contact.turntable,
            inverse: body.inertia().try_inverse().unwrap_or_default(),
            resistance: contact.resistance,
        }
    }

    /// Return the equations in other units: lengths, masses and rates are multiplied by these numbers, powers of two.
    pub(crate) fn in_units(&self, length: f64, mass: f64, rate: f64) -> Self {
        Self {
            mass: self.mass * mass,
            inertia: self.inertia * mass * length * length,
            surface: self.surface.relative_to(&Vector3::zeros(), length),
            gravity: self.gravity * length * rate * rate,
            turntable: self.turntable * rate,
            inverse: self.inverse / (mass * length * length),
            resistance: self.resistance.in_units(length, mass, rate),
        }
    }

    /// Return m, |g|, Ω and the size of the surface, which units are chosen by.
    pub(crate) fn scales(&self) -> [f64; 4] {
        let size = self.surface.size();
        [self.mass, self.gravity.norm(), self.turntable.abs(), size]
    }

    /// Return the surface relative to C.
    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Return m.
    pub(crate) fn mass(&self) -> f64 {
        self.mass
    }

    /// Compute the motion at a state of rolling, for any numbers.
    pub(crate) fn motion<N: Arithmetic>(&self, state: &ContactState<N>) -> Motion<N> {
        let ContactState {
            attitude,
            omega,
            normal,
            place: [x, y],
            ..
        } = *state;
        let normal_rate = cross(normal, omega);
        let [arm, arm_rate] = self.surface.contact_and_rate(normal, normal_rate);
        let level = level_axes(attitude);
        // Ṗ, and u̇ from it.
        let [speed_x, speed_y] = [
            dot(level[0], arm_rate) + y * -self.turntable,
            dot(level[1], arm_rate) + x * self.turntable,
        ];
        let [push_x, push_y] = [
            speed_y * -self.turntable + -self.gravity.x,
            speed_x * self.turntable + -self.gravity.y,
        ];
        let push = plus(scaled(level[0], push_x), scaled(level[1], push_y));
        // u̇ − g − ω×(ρ̇ + ω×ρ)
        let swept = cross(omega, arm);
        let inward = cross(omega, plus(arm_rate, swept));
        let without_turn = minus(plus(push, normal.map(|x| x * -self.gravity.z)), inward);
        let torque = cross(arm, without_turn.map(|x| x * self.mass));
        let gyroscopic = cross(omega, transformed(&self.inertia, omega));
        let zero = omega[0] * 0.0;
        let (mut turning, mut couple) = (minus(torque, gyroscopic), [zero; 3]);
        if self.resistance.acts() {
            couple = self.smooth_couple(omega, normal);
            turning = plus(turning, couple);
        }
        let about = self.about_contact(arm);
        let (mut turn, mut bracket) = (solve(about, turning), zero + 1.0);
        if self.resistance.arm > 0.0 {
            // The couple is proportional to N, which depends on ω̇.
            let by_pressure = scaled(
                against_turn(omega, normal),
                zero + self.resistance.arm * self.mass,
            );
            let by_arm = solve(about, by_pressure);
            let lever = cross(arm, normal);
            bracket = dot(by_arm, lever) + 1.0;
            let pressure = (dot(normal, without_turn) - dot(turn, lever)) / bracket;
            turn = plus(turn, scaled(by_arm, pressure));
            couple = plus(couple, scaled(by_pressure, pressure));
        }
        let lift = minus(without_turn, cross(turn, arm));
        let mut work = if self.turntable == 0.0 {
            zero
        } else {
            (x * dot(lift, level[1]) - y * dot(lift, level[0])) * (self.turntable * self.mass)
        };
        if self.resistance.acts() {
            work = work + dot(couple, omega);
        }
        Motion {
            rates: ContactState {
                attitude: attitude_rate(attitude, omega),
                omega: turn,
                normal: normal_rate,
                place: [speed_x, speed_y],
                slip: [zero; 2],
                work,
                height: [zero; 2],
            },
            lift,
            level,
            arm,
            bracket,
            couple,
        }
    }

    /// Compute the motion of a body that flies, for any numbers.
    pub(crate) fn flying<N: Arithmetic>(&self, state: &ContactState<N>) -> Motion<N> {
        let (omega, normal) = (state.omega, state.normal);
        let normal_rate = cross(normal, omega);
        let arm = self.surface.contact_and_rate(normal, normal_rate)[0];
        let zero = omega[0] * 0.0;
        let gyroscopic = cross(omega, transformed(&self.inertia, omega));
        Motion {
            rates: ContactState {
                attitude: attitude_rate(state.attitude, omega),
                omega: transformed(&self.inverse, gyroscopic).map(|x| x * -1.0),
                normal: normal_rate,
                place: state.slip,
                slip: [zero + self.gravity.x, zero + self.gravity.y],
                work: zero,
                height: [state.height[1], zero + self.gravity.z],
            },
            lift: [zero; 3],
            level: level_axes(state.attitude),
            arm,
            bracket: zero + 1.0,
            couple: [zero; 3],
        }
    }

    /// Compute the part of the couple that does not depend on the normal force.
    pub(super) fn smooth_couple<N: Arithmetic>(&self, omega: [N; 3], normal: [N; 3]) -> [N; 3] {
        let Resistance {
            viscous, pivoting, ..
        } = self.resistance;
        let along = dot(omega, normal) * (viscous - pivoting);
        plus(scaled(normal, along), omega.map(|x| x * -viscous))
    }

    /// Compute `I + m (ρ² − ρ ρᵀ)`: the inertia about the point of contact.
    fn about_contact<N: Arithmetic>(&self, arm: [N; 3]) -> [[N; 3]; 3] {
        let [x, y, z] = arm.map(|x| x * self.mass);
        let squares = [x * arm[0], y * arm[1], z * arm[2]];
        let of = |i: usize, j: usize| self.inertia[(i, j)];
        let xy = x * -arm[1] + of(0, 1);
        let xz = x * -arm[2] + of(0, 2);
        let yz = y * -arm[2] + of(1, 2);
        [
            [squares[1] + squares[2] + of(0, 0), xy, xz],
            [xy, squares[2] + squares[0] + of(1, 1), yz],
            [xz, yz, squares[0] + squares[1] + of(2, 2)],
        ]
    }

    /// Return the state of contact of a phase of motion.
    pub(crate) fn state(&self, contact: &Contact, phase: &Phase) -> ContactState<f64> {
        let axes = contact.plane_axes();
        let attitude = plane_attitude(&axes).inverse() * phase.attitude;
        let normal = normal_of(attitude.coords.into());
        let arm = Vector3::from(self.surface.contact_and_rate(normal, [0.0; 3])[0]);
        let place = axes.transpose() * (phase.position - contact.point + phase.attitude * arm);
        let point = phase.velocity + phase.attitude * phase.omega.cross(&arm);
        let point = axes.transpose() * point;
        let height = contact.normal.dot(&(phase.position - contact.point));
        ContactState {
            attitude: attitude.coords.into(),
            omega: phase.omega.into(),
            normal,
            place: [place.x, place.y],
            slip: [
                point.x + self.turntable * place.y,
                point.y - self.turntable * place.x,
            ],
            work: phase.internal_state.first().copied().unwrap_or(0.0),
            height: [height, contact.normal.dot(&phase.velocity)],
        }
    }

    /// Return the state of a body that flies, of a phase of motion.
    pub(crate) fn flying_state(&self, contact: &Contact, phase: &Phase) -> ContactState<f64> {
        let across = contact.plane_axes().transpose();
        let place = across * (phase.position - contact.point);
        let velocity = across * phase.velocity;
        ContactState {
            place: [place.x, place.y],
            slip: [velocity.x, velocity.y],
            ..self.state(contact, phase)
        }
    }

    /// Return the phase of motion of a body that flies, in N.
    pub(crate) fn flying_phase(&self, contact: &Contact, state: &ContactState<f64>) -> Phase {
        let axes = contact.plane_axes();
        let ([x, y], [u, v], [z, w]) = (state.place, state.slip, state.height);
        Phase {
            position: contact.point + axes * Vector3::new(x, y, z),
            velocity: axes * Vector3::new(u, v, w),
            ..self.phase(contact, state)
        }
    }

    /// Return the phase of motion of a state of contact, in N.
    pub(crate) fn phase(&self, contact: &Contact, state: &ContactState<f64>) -> Phase {
        let axes = contact.plane_axes();
        let [x, y, z, w] = state.attitude;
        let attitude = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
        let arm = self.surface.contact_and_rate(state.normal, [0.0; 3])[0];
        let level = level_axes(state.attitude);
        let swept = cross(state.omega, arm);
        let [x, y] = state.place;
        // From the contact to C: −R ρ; with the velocity u − R (ω×ρ).
        let across = |vector: [f64; 3]| {
            [
                dot(level[0], vector),
                dot(level[1], vector),
                dot(state.normal, vector),
            ]
        };
        let (offset, sweep, slip) = (across(arm), across(swept), state.slip);
        let position = Vector3::new(x - offset[0], y - offset[1], -offset[2]);
        let velocity = Vector3::new(
            -self.turntable * y - sweep[0] + slip[0],
            self.turntable * x - sweep[1] + slip[1],
            -sweep[2],
        );
        Phase {
            attitude: plane_attitude(&axes) * attitude,
            omega: state.omega.into(),
            position: contact.point + axes * position,
            velocity: axes * velocity,
            internal_state: Box::default(),
        }
    }
}

/// Compute `−ω_t/|ω_t|` with the part `ω_t` of ω across the normal.
pub(super) fn against_turn<N: Arithmetic>(omega: [N; 3], normal: [N; 3]) -> [N; 3] {
    let across = minus(omega, scaled(normal, dot(omega, normal)));
    let rate = dot(across, across).root();
    across.map(|x| -x / rate)
}

/// Compute `½ q∘ω`.
pub(super) fn attitude_rate<N: Arithmetic>([x, y, z, w]: [N; 4], omega: [N; 3]) -> [N; 4] {
    let q = [x, y, z];
    let vector = plus(cross(q, omega), scaled(omega, w));
    let [x, y, z] = vector.map(|x| x * 0.5);
    [x, y, z, dot(q, omega) * -0.5]
}

/// Return the attitude of W in N; of a level plane the identity to the bit.
fn plane_attitude(axes: &Matrix3<f64>) -> UnitQuaternion<f64> {
    if *axes == Matrix3::identity() {
        return UnitQuaternion::identity();
    }
    UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(*axes))
}

/// Compute the first two axes of W in body axes.
pub(crate) fn level_axes<N: Arithmetic>([x, y, z, w]: [N; 4]) -> [[N; 3]; 2] {
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [
        [
            (yy + zz) * -2.0 + 1.0,
            (x * y - w * z) * 2.0,
            (x * z + w * y) * 2.0,
        ],
        [
            (x * y + w * z) * 2.0,
            (xx + zz) * -2.0 + 1.0,
            (y * z - w * x) * 2.0,
        ],
    ]
}

/// Compute γ, the third axis of W in body axes.
pub(crate) fn normal_of([x, y, z, w]: [f64; 4]) -> [f64; 3] {
    [
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    ]
}

/// Solve `A x = b` with a symmetric positive matrix, by `A = L D Lᵀ`.
pub(crate) fn solve<N: Arithmetic>(a: [[N; 3]; 3], b: [N; 3]) -> [N; 3] {
    let first = a[0][0];
    let (l1, l2) = (a[0][1] / first, a[0][2] / first);
    let second = a[1][1] - l1 * a[0][1];
    let below = a[1][2] - l2 * a[0][1];
    let l3 = below / second;
    let third = a[2][2] - l2 * a[0][2] - l3 * below;
    let y1 = b[1] - l1 * b[0];
    let y2 = b[2] - l2 * b[0] - l3 * y1;
    let z = y2 / third;
    let y = y1 / second - l3 * z;
    let x = b[0] / first - l1 * y - l2 * z;
    [x, y, z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids};
    use crate::motion::rolling::LiftOff;

    #[test]
    fn symmetric_systems() {
        let a = [[4.0, 1.0, -0.5], [1.0, 3.0, 0.25], [-0.5, 0.25, 2.0]];
        let x = [1.0, -2.0, 3.0];
        let b = a.map(|row| dot(row, x));
        let found = solve(a, b);
        assert!((0..3).all(|i| (found[i] - x[i]).abs() < 1e-15));
    }

    /// A ball down an incline: a = (5/7) g sin α, and the friction is (2/7) m g sin α.
    #[test]
    fn a_ball_down_an_incline() {
        let body = solids::sphere(0.5, Amount::Mass(2.0)).expect("a ball");
        let surface = Surface::sphere(0.5, Vector3::zeros()).expect("a sphere");
        let angle = 0.3_f64;
        let normal = Vector3::new(angle.sin(), 0.0, angle.cos());
        let contact = Contact::rolling(surface, normal, Vector3::zeros(), 0.0, LiftOff::Stop);
        let contact = contact.expect("a contact");
        let equations = Equations::new(&body, &contact, &Vector3::new(0.0, 0.0, -9.81));
        let start = contact.start(
            &body,
            Vector3::zeros(),
            UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1),
            None,
            None,
        );
        let start = start.expect("a start");
        let state = equations.state(&contact, &start);
        let motion = equations.motion(&state);
        let force = Vector3::from(motion.lift) * 2.0;
        let along = Vector3::from(motion.level[0]);
        // Down is along +x of W, where the normal leans.
        assert!((force.dot(&along) + 2.0 / 7.0 * 2.0 * 9.81 * angle.sin()).abs() < 1e-14);
        assert!((force.dot(&Vector3::from(state.normal)) - 2.0 * 9.81 * angle.cos()).abs() < 1e-14);
        let phase = equations.phase(&contact, &state);
        assert!((phase.position - start.position).norm() < 1e-15);
        assert!(phase.attitude.angle_to(&start.attitude) < 1e-15);
    }
}
