//! What the plane does to a body that rolls or slips on it: force, friction needed, power.

use nalgebra::Vector3;

use super::contact::{Contact, ContactPhase, STILL};
use super::equations::{ContactState, Equations};
use super::sliding::Slipping;
use crate::mass::RigidBody;
use crate::motion::state::Phase;

/// A contact at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// The point of contact, in N.
    pub point: Vector3<f64>,
    /// The same from the origin of the body frame, in body axes.
    pub point_in_body: Vector3<f64>,
    /// The force of the plane on the body, in N.
    pub force: Vector3<f64>,
    /// The couple of the plane on the body, in N: a resistance to rolling and pivoting.
    pub couple: Vector3<f64>,
    /// The part of the force along the normal.
    pub normal_force: f64,
    /// The part across it over that part: of a body that rolls the least coefficient of friction with which it does.
    pub friction_needed: f64,
    /// The velocity of the body at the contact less that of the plane, in N.
    pub slip: Vector3<f64>,
    /// The power of the force and the couple, `F·(u + s) + M·ω`: of a body that rolls on a plane at rest without resistance none.
    pub power: f64,
    /// The height of the contact over the plane, relative to the size of the surface, and the slip relative to `ω a`; of a body that
    /// slips its part along the normal, relative to the slip where that is larger.
    pub residual: [f64; 2],
    /// What multiplies the normal force in its equation, which has one solution where this is positive: 1 of a body that rolls.
    pub bracket: f64,
}

/// Compute the contact of a body at a state of its motion, in which it rolls or slips.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::rolling::{Contact, ContactPhase, LiftOff, Surface, force::{Instant, instant}};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// let body = solids::sphere(0.5, Amount::Mass(2.0))?;
/// let ball = Surface::sphere(0.5, Vector3::zeros())?;
/// let contact = Contact::rolling(ball, Vector3::z(), Vector3::zeros(), 0.0, LiftOff::Stop)?;
/// let start = contact.start(&body, Vector3::new(0.0, 3.0, 0.0), UnitQuaternion::identity(), None, None)?;
/// assert!((start.velocity - Vector3::new(1.5, 0.0, 0.0)).norm() < 1e-15);
///
/// let gravity = Vector3::new(0.0, 0.0, -9.81);
/// let found: Instant = instant(&body, &contact, &gravity, &start, ContactPhase::Rolling);
/// assert!((found.force - Vector3::new(0.0, 0.0, 2.0 * 9.81)).norm() < 1e-14);
/// assert_eq!(found.friction_needed, 0.0);
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn instant(
    body: &RigidBody,
    contact: &Contact,
    gravity: &Vector3<f64>,
    phase: &Phase,
    contact_phase: ContactPhase,
) -> Instant {
    instant_of(
        &Equations::new(body, contact, gravity),
        body,
        contact,
        phase,
        contact_phase,
    )
}

/// Compute the same with the equations of the body and its contact, which are made once for many states.
pub(crate) fn instant_of(
    equations: &Equations,
    body: &RigidBody,
    contact: &Contact,
    phase: &Phase,
    contact_phase: ContactPhase,
) -> Instant {
    let state = equations.state(contact, phase);
    let slips = contact_phase == ContactPhase::Sliding;
    let flies = contact_phase == ContactPhase::Flying;
    let motion = if flies {
        equations.flying(&state)
    } else if slips {
        let friction = contact.friction();
        // A slip that is rounding alone has the direction in which it begins.
        let is_still =
            state.slip[0].hypot(state.slip[1]) <= STILL * speed_of_contact(contact, &state, phase);
        let direction = (friction.coulomb().filter(|_| is_still))
            .map(|_| equations.parting_direction(&state, friction));
        equations.sliding(
            &state,
            Slipping {
                friction,
                direction,
            },
        )
    } else {
        equations.motion(&state)
    };
    let lift = Vector3::from(motion.lift) * equations.mass();
    let (normal, arm) = (Vector3::from(state.normal), Vector3::from(motion.arm));
    let level = motion.level.map(Vector3::from);
    let normal_force = lift.dot(&normal);
    let tangential = lift.dot(&level[0]).hypot(lift.dot(&level[1]));
    let force =
        contact.plane_axes() * Vector3::new(lift.dot(&level[0]), lift.dot(&level[1]), normal_force);
    let point = phase.position + phase.attitude * arm;
    let plane = contact.plane_velocity(&point);
    let slip = phase.velocity + phase.attitude * phase.omega.cross(&arm) - plane;
    let size = contact.surface.size();
    let mut speed = size * phase.omega.norm().max(f64::MIN_POSITIVE);
    let (mut moving, mut off) = (plane, slip.norm());
    if flies {
        off = 0.0;
    }
    if slips {
        (speed, moving) = (speed.max(off), plane + slip);
        off = contact.normal.dot(&slip).abs();
    }
    let couple = phase.attitude * Vector3::from(motion.couple);
    let height = contact.normal.dot(&(phase.position - contact.point)) + normal.dot(&arm);
    Instant {
        point,
        point_in_body: arm + body.center_of_mass(),
        force,
        couple,
        normal_force,
        friction_needed: if tangential == 0.0 {
            0.0
        } else {
            tangential / normal_force
        },
        slip,
        power: force.dot(&moving) + couple.dot(&(phase.attitude * phase.omega)),
        residual: [height / size, off / speed],
        bracket: motion.bracket,
    }
}

/// Return the sum of the speeds of C and of the contact about it: the slip is their difference.
pub(crate) fn speed_of_contact(contact: &Contact, state: &ContactState<f64>, phase: &Phase) -> f64 {
    let [x, y] = state.place;
    contact.surface.size() * phase.omega.norm()
        + phase.velocity.norm()
        + contact.turntable.abs() * x.hypot(y)
}
