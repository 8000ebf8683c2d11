//! The contact of a surface with a plane: where the plane is, how it turns, the law of its force, and what follows when the body
//! lifts off.

use nalgebra::{Matrix3, Quaternion, Unit, UnitQuaternion, Vector3};

use super::surface::{Surface, axes_of};
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::mass::RigidBody;
use crate::motion::state::Phase;
use crate::numerics::power_series::dot;

/// How far from the plane a body may be at the start, relative to its size; and how much it may differ from one with a closed form,
/// relative to its size or moments.
pub(super) const TOUCHES: f64 = 1e-9;

/// How much slip a start may have, relative to the speeds there, and count as none; and how much a velocity may leave the plane.
pub(super) const STILL: f64 = 1e-14;

/// The force of the plane across its normal n, on a body that slips with the velocity s; N is the normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction {
    /// `−μ N s/|s|`.
    Coulomb(f64),
    /// `−k N s`.
    ViscousNormal(f64),
    /// `−c s`, whatever the normal force is.
    Viscous(f64),
}

impl Friction {
    /// Return the coefficient.
    #[must_use]
    pub fn coefficient(&self) -> f64 {
        match *self {
            Self::Coulomb(x) | Self::ViscousNormal(x) | Self::Viscous(x) => x,
        }
    }

    /// Return the coefficient of Coulomb's law, which has no force without slip; none where the force is smooth there.
    pub(crate) fn coulomb(&self) -> Option<f64> {
        match *self {
            Self::Coulomb(mu) if mu > 0.0 => Some(mu),
            _ => None,
        }
    }

    /// Return the same in other units: lengths, masses and rates are multiplied by these numbers.
    pub(crate) fn in_units(self, length: f64, mass: f64, rate: f64) -> Self {
        match self {
            Self::Coulomb(_) => self,
            Self::ViscousNormal(k) => Self::ViscousNormal(k / (length * rate)),
            Self::Viscous(c) => Self::Viscous(c * mass * rate),
        }
    }
}

/// The law of the force of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Law {
    /// The body rolls without slipping, whatever force that takes.
    #[default]
    Rolling,
    /// The body slips, and the normal force keeps it on the plane.
    Sliding(Friction),
    /// The body rolls while that takes no more than μ N across the normal, and slips with Coulomb's friction else.
    Dry(f64),
}

/// What a body on a plane does at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactPhase {
    /// Its point of contact has the velocity of the plane.
    #[default]
    Rolling,
    /// It slips.
    Sliding,
    /// It has lifted off.
    Flying,
}

/// The resistance to rolling and pivoting: the couple `−b ω_t − p (ω·n) n − e N ω_t/|ω_t|` on the body, with the part `ω_t` of ω across the
/// normal n.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resistance {
    /// b.
    pub viscous: f64,
    /// p.
    pub pivoting: f64,
    /// e, a length: the normal force acts so far ahead of the contact.
    pub arm: f64,
}

impl Resistance {
    /// Make a resistance of these coefficients.
    ///
    /// # Errors
    /// When one is negative or not finite.
    pub fn new(viscous: f64, pivoting: f64, arm: f64) -> Result<Self, Error> {
        for (what, value) in [("viscous", viscous), ("pivoting", pivoting), ("arm", arm)] {
            not_negative(what, value)?;
        }
        Ok(Self {
            viscous,
            pivoting,
            arm,
        })
    }

    /// Return whether there is any.
    #[must_use]
    pub fn acts(&self) -> bool {
        *self != Self::default()
    }

    /// Return the same in other units: lengths, masses and rates are multiplied by these numbers.
    pub(crate) fn in_units(self, length: f64, mass: f64, rate: f64) -> Self {
        let damping = mass * length * length * rate;
        Self {
            viscous: self.viscous * damping,
            pivoting: self.pivoting * damping,
            arm: self.arm * length,
        }
    }
}

/// Check that a coefficient takes energy.
fn not_negative(what: &'static str, value: f64) -> Result<(), Error> {
    finite(what, value)?;
    if value < 0.0 {
        return Err(Error::OutOfDomain {
            what,
            law: "a coefficient that is not negative: friction takes energy",
            value,
        });
    }
    Ok(())
}

/// What follows when the normal force falls through zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LiftOff {
    /// The run ends.
    #[default]
    Stop,
    /// The body flies freely until it touches again, where the run ends.
    Fly,
    /// The contact holds, and the plane pulls.
    Hold,
}

/// A surface on a plane: it rolls where `v_C + ω×r = u(P)` with `r = P − C` and the velocity u of the plane, and slips else.
///
/// # Examples
///
/// ```
/// use polhode::motion::rolling::{Contact, LiftOff, Surface};
/// use polhode::nalgebra::Vector3;
///
/// let ball = Surface::sphere(0.5, Vector3::zeros())?;
/// let contact = Contact::rolling(ball, Vector3::z(), Vector3::zeros(), 2.0, LiftOff::Stop)?;
/// // A plane that turns moves with u = Ω n×(P − point).
/// assert_eq!(contact.plane_velocity(&Vector3::new(3.0, 0.0, 0.0)), Vector3::new(0.0, 6.0, 0.0));
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The surface of the body.
    pub surface: Surface,
    /// The unit normal of the plane in N, towards the body.
    pub normal: Unit<Vector3<f64>>,
    /// A point of the plane in N; a turntable turns about the normal through it.
    pub point: Vector3<f64>,
    /// The rate of the plane about its normal.
    pub turntable: f64,
    /// What follows when the body lifts off.
    pub lift: LiftOff,
    /// The law of the force of the plane.
    pub law: Law,
    /// The couple of the plane.
    pub resistance: Resistance,
}

impl Contact {
    /// Make the contact of a surface that rolls.
    ///
    /// # Errors
    /// When a number is not finite or the normal has no direction.
    pub fn rolling(
        surface: Surface,
        normal: Vector3<f64>,
        point: Vector3<f64>,
        turntable: f64,
        lift: LiftOff,
    ) -> Result<Self, Error> {
        all_finite("normal", &normal)?;
        all_finite("point", &point)?;
        finite("turntable", turntable)?;
        let Some(normal) = Unit::try_new(normal, 0.0) else {
            return Err(Error::OutOfDomain {
                what: "normal",
                law: "a vector that has a direction",
                value: normal.norm(),
            });
        };
        Ok(Self {
            surface,
            normal,
            point,
            turntable,
            lift,
            law: Law::Rolling,
            resistance: Resistance::default(),
        })
    }

    /// Return the same contact under another law.
    ///
    /// # Errors
    /// When the coefficient of friction is negative or not finite, or dry friction has to hold a body that the plane pulls.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::motion::rolling::{Contact, Friction, Law, LiftOff, Surface};
    /// use polhode::nalgebra::{UnitQuaternion, Vector3};
    ///
    /// let ball = Surface::sphere(0.5, Vector3::zeros())?;
    /// let contact = Contact::rolling(ball, Vector3::z(), Vector3::zeros(), 0.0, LiftOff::Stop)?;
    /// let ice = Law::Sliding(Friction::Coulomb(0.02));
    /// assert_eq!(contact.with_law(ice)?.law, ice);
    /// assert!(contact.with_law(Law::Dry(-0.3)).is_err());
    /// # Ok::<(), polhode::Error>(())
    /// ```
    pub fn with_law(self, law: Law) -> Result<Self, Error> {
        let (what, coefficient) = match law {
            Law::Rolling => return Ok(Self { law, ..self }),
            Law::Dry(mu) | Law::Sliding(Friction::Coulomb(mu)) => ("friction", mu),
            Law::Sliding(viscous) => ("viscous", viscous.coefficient()),
        };
        not_negative(what, coefficient)?;
        if matches!(law, Law::Dry(_)) && self.lift == LiftOff::Hold {
            return Err(Error::Motion(MotionFault::ContactCannotServe {
                needs: "lift \"stop\" under dry friction: a plane that pulls has no cone of friction",
            }));
        }
        Ok(Self { law, ..self })
    }

    /// Return the same contact with a resistance to rolling and pivoting.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::motion::rolling::{Contact, LiftOff, Resistance, Surface};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = Surface::sphere(0.5, Vector3::zeros())?;
    /// let contact = Contact::rolling(ball, Vector3::z(), Vector3::zeros(), 0.0, LiftOff::Stop)?;
    /// let grass = Resistance::new(0.0, 0.01, 0.02)?;
    /// assert!(grass.acts() && contact.with_resistance(grass).resistance == grass);
    /// assert!(Resistance::new(0.0, 0.0, -0.02).is_err());
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn with_resistance(self, resistance: Resistance) -> Self {
        Self { resistance, ..self }
    }

    /// Return the friction of a body that slips; none of one that only rolls.
    pub(crate) fn friction(&self) -> Friction {
        match self.law {
            Law::Rolling => Friction::Coulomb(0.0),
            Law::Sliding(friction) => friction,
            Law::Dry(mu) => Friction::Coulomb(mu),
        }
    }

    /// Compute the velocity u of the plane at a point.
    #[must_use]
    pub fn plane_velocity(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.normal.cross(&(point - self.point)) * self.turntable
    }

    /// Return the axes of the plane as columns in N: the third is the normal.
    #[must_use]
    pub fn plane_axes(&self) -> Matrix3<f64> {
        axes_of(&self.normal)
    }

    /// Compute the point of contact from the origin of the body frame, in body axes.
    #[must_use]
    pub fn point_in_body(&self, attitude: &UnitQuaternion<f64>) -> Vector3<f64> {
        self.surface.contact(&(attitude.inverse() * *self.normal))
    }

    /// Return the start of a motion: the body touches the plane at `point`, or where `position`, of C, puts it. It has the velocity of
    /// rolling, or slips where `velocity`, of C, is another.
    ///
    /// # Errors
    /// When the body hovers over the plane or sinks into it, at once or with its velocity, or the surface has no point of contact at
    /// this attitude.
    pub fn start(
        &self,
        body: &RigidBody,
        omega: Vector3<f64>,
        attitude: UnitQuaternion<f64>,
        position: Option<Vector3<f64>>,
        velocity: Option<Vector3<f64>>,
    ) -> Result<Phase, Error> {
        let normal = attitude.inverse() * *self.normal;
        if self.surface.margin(&normal) <= 0.0 {
            return Err(Error::Motion(MotionFault::NoPointOfContact {
                time: None,
                law: self.surface.beyond_margin(),
            }));
        }
        let arm = self.surface.contact(&normal) - body.center_of_mass();
        let position = match position {
            None => self.point - attitude * arm,
            Some(position) => {
                // Along the normal in body axes: a rotated arm would add its rounding.
                let height = self.normal.dot(&(position - self.point));
                let gap = height + dot(normal.into(), arm.into());
                let size = self.surface.size();
                // A NaN does not touch.
                if gap.abs().partial_cmp(&(TOUCHES * size)) != Some(std::cmp::Ordering::Less) {
                    return Err(Error::Motion(MotionFault::NoContact { gap, size }));
                }
                position
            }
        };
        let contact = position + attitude * arm;
        let rolling = self.plane_velocity(&contact) - attitude * omega.cross(&arm);
        let velocity = match velocity {
            None => rolling,
            Some(given) => {
                let slip = given - rolling;
                let (away, speed) = (self.normal.dot(&slip), given.norm() + rolling.norm());
                // A NaN does not touch.
                if away.abs().partial_cmp(&(TOUCHES * speed)) == Some(std::cmp::Ordering::Greater)
                    || away.is_nan()
                {
                    return Err(Error::Motion(MotionFault::LeavesContact { away, speed }));
                }
                if slip.norm() <= STILL * speed {
                    rolling
                } else {
                    given - *self.normal * away
                }
            }
        };
        Ok(Phase {
            attitude,
            omega,
            position,
            velocity,
            internal_state: Box::default(),
        })
    }
}

/// A state of a body that rolls, and what the plane does to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingState {
    /// `R_NB`.
    pub attitude: UnitQuaternion<f64>,
    /// Of B relative to N, in B.
    pub omega: Vector3<f64>,
    /// Of C, in N.
    pub position: Vector3<f64>,
    /// Of C, in N.
    pub velocity: Vector3<f64>,
    /// The resultant force of the plane on the body, in N.
    pub force: Vector3<f64>,
    /// The centre of pressure: where the normal force acts, in N.
    pub pressure: Vector3<f64>,
    /// Whether the centre of pressure would have to be beyond the ends of the line of contact, so that the body tips over one.
    pub tips: bool,
}

impl RollingState {
    /// A state at a time that is not finite.
    pub(super) fn unknown() -> Self {
        let nan = Vector3::repeat(f64::NAN);
        Self {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(
                f64::NAN,
                f64::NAN,
                f64::NAN,
                f64::NAN,
            )),
            omega: nan,
            position: nan,
            velocity: nan,
            force: nan,
            pressure: nan,
            tips: false,
        }
    }
}

/// Check that gravity presses a body onto the plane.
pub(super) fn pressing(gravity: &Vector3<f64>) -> Result<(), Error> {
    if gravity.z < 0.0 {
        return Ok(());
    }
    Err(Error::OutOfDomain {
        what: "gravity",
        law: "one that presses the body onto the plane z = 0: its third component is negative; a plane that leans is a gravity that leans",
        value: gravity.z,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids};

    #[test]
    fn a_body_must_touch() {
        let body = solids::sphere(0.5, Amount::Mass(1.0)).expect("a ball");
        let surface = Surface::sphere(0.5, Vector3::zeros()).expect("a sphere");
        let tilted = Vector3::new(0.3, 0.0, 1.0);
        let contact = Contact::rolling(surface, tilted, Vector3::x(), 0.0, LiftOff::Stop);
        let contact = contact.expect("a contact");
        let start = |height: f64| {
            let position = contact.point + *contact.normal * height;
            let omega = Vector3::new(0.0, 2.0, 0.0);
            contact.start(
                &body,
                omega,
                UnitQuaternion::identity(),
                Some(position),
                None,
            )
        };
        let velocity = start(0.5 + 1e-11).expect("a start").velocity;
        assert!(
            (velocity - Vector3::new(0.0, 2.0, 0.0).cross(&*contact.normal) * 0.5).norm() < 1e-15
        );
        for off in [1e-8, -1e-8, f64::NAN] {
            let refused = start(0.5 + off);
            assert!(matches!(
                refused,
                Err(Error::Motion(MotionFault::NoContact { .. }))
            ));
        }
    }

    #[test]
    fn a_plane_needs_a_normal() {
        let surface = Surface::sphere(0.5, Vector3::zeros()).expect("a sphere");
        let zero = Vector3::zeros();
        assert!(Contact::rolling(surface, zero, zero, 0.0, LiftOff::Hold).is_err());
        assert!(Contact::rolling(surface, Vector3::x(), zero, f64::NAN, LiftOff::Hold).is_err());
    }
}
