//! What the plane does to a body that rolls on it: force, friction needed, power.

use nalgebra::Vector3;

use super::contact::Contact;
use super::equations::Equations;
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
    /// Its part along the normal.
    pub normal_force: f64,
    /// The part across it over that part: the least coefficient of friction with which the body rolls.
    pub friction_needed: f64,
    /// The velocity of the body at the contact less that of the plane, in N.
    pub slip: Vector3<f64>,
    /// The power of the force, `F·u`: of a plane at rest none.
    pub power: f64,
    /// The height of the contact over the plane, relative to the size of the surface, and the slip relative to `ω a`.
    pub residual: [f64; 2],
}

/// Compute the contact of a body at a state of its motion.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::rolling::{Contact, LiftOff, Surface, force::{Instant, instant}};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// let body = solids::sphere(0.5, Amount::Mass(2.0))?;
/// let ball = Surface::sphere(0.5, Vector3::zeros())?;
/// let contact = Contact::rolling(ball, Vector3::z(), Vector3::zeros(), 0.0, LiftOff::Stop)?;
/// let start = contact.start(&body, Vector3::new(0.0, 3.0, 0.0), UnitQuaternion::identity(), None)?;
/// assert!((start.velocity - Vector3::new(1.5, 0.0, 0.0)).norm() < 1e-15);
///
/// let found: Instant = instant(&body, &contact, &Vector3::new(0.0, 0.0, -9.81), &start);
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
) -> Instant {
    instant_of(
        &Equations::new(body, contact, gravity),
        body,
        contact,
        phase,
    )
}

/// Compute the same with the equations of the body and its contact, which are made once for many states.
pub(crate) fn instant_of(
    equations: &Equations,
    body: &RigidBody,
    contact: &Contact,
    phase: &Phase,
) -> Instant {
    let state = equations.state(contact, phase);
    let motion = equations.motion(&state);
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
    let speed = size * phase.omega.norm().max(f64::MIN_POSITIVE);
    let height = contact.normal.dot(&(phase.position - contact.point)) + normal.dot(&arm);
    Instant {
        point,
        point_in_body: arm + body.center_of_mass(),
        force,
        normal_force,
        friction_needed: if tangential == 0.0 {
            0.0
        } else {
            tangential / normal_force
        },
        slip,
        power: force.dot(&plane),
        residual: [height / size, slip.norm() / speed],
    }
}
