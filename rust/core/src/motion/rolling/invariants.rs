//! What stays constant while a body rolls: the integrals of Jellett, Routh and Chaplygin.

use nalgebra::Vector3;

use super::contact::Contact;
use crate::mass::RigidBody;
use crate::motion::state::Phase;
use crate::principal::SymmetricTop;

/// How much the principal moments of a body of revolution may differ, and C be off the axis, relative to the largest.
const ROUNDING: f64 = 1e-12;

/// The quantities that a motion keeps; none where the case does not have them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactInvariants {
    /// Jellett's integral `−(I ω)·r`: a sphere of revolution on a level plane at rest, with any friction.
    pub jellett: Option<f64>,
    /// Routh's integral `ω₃ √(I_t I_s + m r·I r)`: the same, rolling.
    pub routh: Option<f64>,
    /// Chaplygin's vector `R (I ω + m r×(ω×r))`, in N: a sphere about C on a level plane at rest.
    pub chaplygin: Option<Vector3<f64>>,
}

/// Compute what a motion keeps at one of its states.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::rolling::{Contact, LiftOff, Surface, invariants::{ContactInvariants, contact_invariants}};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// let body = solids::sphere(0.5, Amount::Mass(2.0))?;
/// let ball = Surface::sphere(0.5, Vector3::zeros())?;
/// let contact = Contact::rolling(ball, Vector3::z(), Vector3::zeros(), 0.0, LiftOff::Stop)?;
/// let start = contact.start(&body, Vector3::new(0.0, 3.0, 1.0), UnitQuaternion::identity(), None, None)?;
/// let found: ContactInvariants = contact_invariants(&body, &contact, &Vector3::new(0.0, 0.0, -9.81), &start);
/// // A ball keeps (I + m a²) ω across the normal, I ω along it: I = 0.2 and I + m a² = 0.7.
/// assert!((found.chaplygin.unwrap() - Vector3::new(0.0, 2.1, 0.2)).norm() < 1e-15);
/// // −I ω·r = I ω₃ a.
/// assert!((found.jellett.unwrap() - 0.1).abs() < 1e-16);
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn contact_invariants(
    body: &RigidBody,
    contact: &Contact,
    gravity: &Vector3<f64>,
    phase: &Phase,
) -> ContactInvariants {
    let is_level = contact.normal.cross(gravity).norm() <= ROUNDING * gravity.norm();
    let Some(radius) = contact.surface.sphere_radius() else {
        return ContactInvariants::default();
    };
    if !is_level || contact.turntable != 0.0 {
        return ContactInvariants::default();
    }
    let center = contact.surface.center() - body.center_of_mass();
    let arm = contact.point_in_body(&phase.attitude) - body.center_of_mass();
    let (inertia, mass) = (body.inertia(), body.mass());
    let spin = inertia * phase.omega;
    let is_centered = center.norm() <= ROUNDING * radius;
    let about_contact = spin + arm.cross(&phase.omega.cross(&arm)) * mass;
    let chaplygin = is_centered.then(|| phase.attitude * about_contact);
    // The symmetry axis: from the center of the sphere to C, or of the tensor where C is the center.
    let axis = if is_centered {
        SymmetricTop::of(&body.principal(), ROUNDING)
            .ok()
            .map(|top| top.axis)
    } else {
        Some(center.normalize())
    };
    let Some(axis) = axis else {
        return ContactInvariants {
            chaplygin,
            ..ContactInvariants::default()
        };
    };
    let along = axis.dot(&(inertia * axis));
    let across = 0.5 * (inertia.trace() - along);
    let tensor =
        nalgebra::Matrix3::identity() * across + axis * axis.transpose() * (along - across);
    if (tensor - inertia).abs().max() > ROUNDING * inertia.trace() {
        return ContactInvariants {
            chaplygin,
            ..ContactInvariants::default()
        };
    }
    let squared = across * along + mass * arm.dot(&(inertia * arm));
    ContactInvariants {
        jellett: Some(-spin.dot(&arm)),
        routh: Some(axis.dot(&phase.omega) * squared.sqrt()),
        chaplygin,
    }
}
