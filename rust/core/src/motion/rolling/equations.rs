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

use super::contact::Contact;
use super::surface::Surface;
use crate::mass::RigidBody;
use crate::motion::state::Phase;
use crate::numerics::power_series::{Arithmetic, cross, dot, minus, plus, scaled, transformed};

/// A body, its surface and the plane, in axes W of the plane: the third is its normal, the origin the point it turns about.
#[derive(Clone, Debug)]
pub(crate) struct Equations {
    /// m, and I about C.
    mass: f64,
    inertia: Matrix3<f64>,
    /// Relative to C.
    surface: Surface,
    /// g in W.
    gravity: Vector3<f64>,
    /// Ω.
    turntable: f64,
}

/// How many variables a state of contact has.
pub(crate) const VARIABLES: usize = 12;

/// The state of contact: (x, y, z, w) of the attitude in W, ω in B, γ, and the point of contact in the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactState<N> {
    pub(crate) attitude: [N; 4],
    pub(crate) omega: [N; 3],
    pub(crate) normal: [N; 3],
    pub(crate) place: [N; 2],
}

impl<N: Copy> ContactState<N> {
    /// Return the state of these variables.
    pub(crate) fn of(variables: &[N; VARIABLES]) -> Self {
        let [x, y, z, w, p, q, r, a, b, c, u, v] = *variables;
        Self {
            attitude: [x, y, z, w],
            omega: [p, q, r],
            normal: [a, b, c],
            place: [u, v],
        }
    }

    /// Return the variables of this state, or of its rates.
    pub(crate) fn variables(&self) -> [N; VARIABLES] {
        let ([x, y, z, w], [p, q, r]) = (self.attitude, self.omega);
        let ([a, b, c], [u, v]) = (self.normal, self.place);
        [x, y, z, w, p, q, r, a, b, c, u, v]
    }
}

/// The rates of a state, and the acceleration of C less that of gravity, in body axes: the force of the plane over the mass.
pub(crate) struct Motion<N> {
    pub(crate) rates: ContactState<N>,
    pub(crate) lift: [N; 3],
    /// The first two axes of W, and ρ with its rate, in body axes.
    pub(crate) level: [[N; 3]; 2],
    pub(crate) arm: [N; 3],
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

    /// Compute the motion at a state, for any numbers.
    pub(crate) fn motion<N: Arithmetic>(&self, state: &ContactState<N>) -> Motion<N> {
        let ContactState {
            attitude,
            omega,
            normal,
            place: [x, y],
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
        let turn = solve(self.about_contact(arm), minus(torque, gyroscopic));
        let [qx, qy, qz, qw] = attitude;
        let q = [qx, qy, qz];
        let vector = plus(cross(q, omega), scaled(omega, qw));
        Motion {
            rates: ContactState {
                attitude: [
                    vector[0] * 0.5,
                    vector[1] * 0.5,
                    vector[2] * 0.5,
                    dot(q, omega) * -0.5,
                ],
                omega: turn,
                normal: normal_rate,
                place: [speed_x, speed_y],
            },
            lift: minus(without_turn, cross(turn, arm)),
            level,
            arm,
        }
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
        ContactState {
            attitude: attitude.coords.into(),
            omega: phase.omega.into(),
            normal,
            place: [place.x, place.y],
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
        let (offset, sweep) = (across(arm), across(swept));
        let position = Vector3::new(x - offset[0], y - offset[1], -offset[2]);
        let velocity = Vector3::new(
            -self.turntable * y - sweep[0],
            self.turntable * x - sweep[1],
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

/// Return the attitude of W in N; of a level plane the identity to the bit.
fn plane_attitude(axes: &Matrix3<f64>) -> UnitQuaternion<f64> {
    if *axes == Matrix3::identity() {
        return UnitQuaternion::identity();
    }
    UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(*axes))
}

/// Compute the first two axes of W in body axes.
fn level_axes<N: Arithmetic>([x, y, z, w]: [N; 4]) -> [[N; 3]; 2] {
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
