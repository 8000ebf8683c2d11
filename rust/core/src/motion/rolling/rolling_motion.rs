//! Motions in closed form of bodies that roll on the plane z = 0: a homogeneous ball, a cylinder or a cone that lies on it.

use nalgebra::{UnitQuaternion, Vector3};

use super::ball::RollingBall;
use super::contact::RollingState;
use super::lying::LyingBody;
use super::ruled::RuledSurface;
use super::surface::Surface;
use crate::error::{Error, MotionFault, all_finite};
use crate::mass::RigidBody;

/// What a body has that a motion in closed form is known of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outside {
    /// A surface that touches in a point: a sphere.
    Point(Surface),
    /// A surface that touches along a line.
    Line(RuledSurface),
}

/// The motion of a body that rolls on the plane z = 0, as a function of time.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::rolling::rolling_motion::{Outside, RollingMotion};
/// use polhode::motion::rolling::{RollingState, Surface};
/// use polhode::nalgebra::Vector3;
///
/// let body = solids::sphere(0.5, Amount::Mass(2.0))?;
/// let ball = Outside::Point(Surface::sphere(0.5, Vector3::zeros())?);
/// // Where the plane leans by sin α = 0.6 the ball rolls down with 5/7 of g sin α.
/// let gravity = Vector3::new(6.0, 0.0, -8.0);
/// let motion = RollingMotion::new(&body, &ball, &Vector3::zeros(), None, gravity, 0.0)?;
/// let RollingState { position, force, tips, .. } = motion.states(&[7.0])[0];
/// assert!((position.x - 0.5 * 5.0 / 7.0 * 6.0 * 49.0).abs() < 1e-12);
/// assert!((force - Vector3::new(-2.0 * 2.0 / 7.0 * 6.0, 0.0, 16.0)).norm() < 1e-13 && !tips);
/// assert!((motion.extremes(0.0, 7.0).unwrap()[0][0] - 1.5 / 7.0).abs() < 1e-15);
/// assert!(motion.reaches(1e3).is_err() && motion.reaches(100.0).is_ok());
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingMotion(Form);

#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "one a motion, which is copied as a value"
)]
enum Form {
    Ball(RollingBall),
    Lying(LyingBody),
}

impl RollingMotion {
    /// Make the motion of a body that touches the plane z = 0 at the origin: a ball and a cylinder below their centres of mass, a cone with
    /// its apex, which rests.
    ///
    /// `omega`: at t = 0, in B. `attitude`: `R_NB` at t = 0; by default the identity of a ball, and one in which a cylinder or a cone
    /// lies on the plane. `gravity`: g, in N; on a slope it leans. `turntable`: the rate of the plane about z.
    ///
    /// # Errors
    /// When the body has no closed form, does not lie on the plane, does not roll or is not pressed onto it, or a number is not finite.
    pub fn new(
        body: &RigidBody,
        outside: &Outside,
        omega: &Vector3<f64>,
        attitude: Option<UnitQuaternion<f64>>,
        gravity: Vector3<f64>,
        turntable: f64,
    ) -> Result<Self, Error> {
        all_finite("omega", omega)?;
        all_finite("gravity", &gravity)?;
        if let Some(attitude) = attitude {
            all_finite("attitude", attitude.coords.iter())?;
        }
        match outside {
            Outside::Point(surface) => {
                let attitude = attitude.unwrap_or_else(UnitQuaternion::identity);
                RollingBall::new(body, surface, omega, attitude, gravity, turntable)
                    .map(|ball| Self(Form::Ball(ball)))
            }
            Outside::Line(surface) => {
                if turntable != 0.0 {
                    return Err(Error::OutOfDomain {
                        what: "turntable",
                        law: "zero for a cylinder or a cone: of these on a plane at rest the motion is known in closed form",
                        value: turntable,
                    });
                }
                LyingBody::new(body, surface, omega, attitude, gravity)
                    .map(|lying| Self(Form::Lying(lying)))
            }
        }
    }

    /// Check that the state is known at a time, or that the time is not finite.
    ///
    /// # Errors
    /// When the body has turned so far that no digit of its attitude is known, or, of a ball on a slope, farther than is summed.
    pub fn reaches(&self, t: f64) -> Result<(), Error> {
        let reach = match &self.0 {
            Form::Ball(ball) => ball.reach(),
            Form::Lying(lying) => lying.reach(),
        };
        if t.is_finite() && t.abs() > reach {
            return Err(MotionFault::RollingBeyondReach { t, reach }.into());
        }
        Ok(())
    }

    /// Compute the largest friction needed by a ball between two times and the least normal force, each with its time; of a cylinder or a cone
    /// none, which touches the plane in no point.
    #[must_use]
    pub fn extremes(&self, from: f64, to: f64) -> Option<[[f64; 2]; 2]> {
        match &self.0 {
            Form::Ball(ball) => Some(ball.extremes([from, to])),
            Form::Lying(_) => None,
        }
    }

    /// Compute the states at many times, in any order. Each has the same bits whatever the others are; at a time that is not finite
    /// it is NaN.
    #[must_use]
    pub fn states(&self, times: &[f64]) -> Vec<RollingState> {
        match &self.0 {
            Form::Ball(ball) => ball.states(times),
            Form::Lying(lying) => lying.states(times),
        }
    }
}
