//! What a feedback turns the body toward.

use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::orbit_model::OrbitModel;
use super::spline::Spline;
use crate::error::{Error, all_finite, finite};
use crate::motion::attitude::components;
use crate::numerics::threads::{Watch, each_watched};

/// From one sample of a target to the next it turns by less than a quarter of a turn: `cos(π/4)`.
const QUARTER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The attitude `q_target` (of N from the target's frame) that a feedback turns the body toward.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use std::sync::Arc;
/// use polhode::motion::loads::{AttitudeTarget, Feedback, OrbitModel, Switch, kepler::Orbit};
/// use polhode::motion::simulate::{Phase, State};
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
///
/// let about_z = |angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
/// // Toward an attitude that stays, with the stiffness 2 N m and the damping 1 N m s:
/// let (stiffness, damping) = (Matrix3::identity() * 2.0, Matrix3::identity());
/// let feedback = Feedback::new(&stiffness, &damping, &about_z(0.0))?;
/// assert_eq!(feedback.target.as_fixed(), Some(&about_z(0.0)));
/// // one that turns at 0.1 rad/s, from the start of the motion on or from a time that is said,
/// let turning = AttitudeTarget::turning(&about_z(0.0), &Vector3::new(0.0, 0.0, 0.1), None)?;
/// assert!(turning.needs_epoch() && !turning.clone().with_epoch(5.0).needs_epoch());
/// assert!(turning.at(5.0, 7.0).0.angle_to(&about_z(0.2)) < 1e-15);
/// // one through samples, which is known between them alone,
/// let sampled = AttitudeTarget::sampled(&[0.0, 1.0, 2.0], &[about_z(0.0), about_z(0.5), about_z(1.0)])?;
/// assert!(matches!(sampled, AttitudeTarget::Sampled(_)));
/// let (times, same) = ([0.0, 1.0], [about_z(0.5); 2]);
/// let watched = AttitudeTarget::sampled_watched(&times, &same, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(watched, AttitudeTarget::sampled(&times, &same)?);
/// assert_eq!(sampled.breaks(), [0.0, 1.0, 2.0]);
/// assert!(sampled.check(0.0, 0.0, 2.0).is_ok() && sampled.check(0.0, 0.0, 3.0).is_err());
/// // and down along an orbit.
/// let orbit = Orbit::new(1.0, &Vector3::x(), &Vector3::y())?;
/// let down = Feedback::toward(&stiffness, &damping, AttitudeTarget::Down(OrbitModel::kepler(&orbit, None)?))?;
/// assert!((down.target.at(0.0, 0.0).0 * Vector3::z() + Vector3::x()).amax() < 1e-15);
///
/// // The law takes the shorter way round, by a sign that changes half a turn away from the target.
/// let there = Phase::in_place(&State { attitude: about_z(3.0), omega: Vector3::new(0.0, 0.0, 1.0) });
/// let [value, rate] = Switch::toward(&feedback.target, 0.0, 0.0, &there).value_and_rate(0.0, &there);
/// assert!((value - 1.5_f64.cos()).abs() < 1e-15 && (rate + 0.5 * 1.5_f64.sin()).abs() < 1e-15);
/// # let _: &Arc<AttitudeTarget> = &down.target;
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum AttitudeTarget {
    /// One that stays.
    Fixed(UnitQuaternion<f64>),
    /// One that turns.
    Turning {
        /// That at the epoch.
        attitude: UnitQuaternion<f64>,
        /// Its angular velocity relative to N, in N.
        rate: Vector3<f64>,
        /// The start of the motion where there is none.
        epoch: Option<f64>,
    },
    /// The [frame](OrbitModel::frame) of an orbit that points down.
    Down(OrbitModel),
    /// One known at some times.
    Sampled(Sampling),
}

/// A smooth attitude through samples: a cubic spline through each component of the quaternions, at unit length.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::{AttitudeTarget, Sampling};
/// use polhode::nalgebra::UnitQuaternion;
///
/// let AttitudeTarget::Sampled(attitudes) = AttitudeTarget::sampled(&[0.0, 1.0], &[UnitQuaternion::identity(); 2])? else {
///     unreachable!("it was made of samples")
/// };
/// let attitudes: Sampling = attitudes;
/// assert_eq!(attitudes, attitudes.clone());
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    vector: Spline,
    scalar: Spline,
}

impl AttitudeTarget {
    /// A target that turns with a constant rate.
    ///
    /// # Errors
    /// For a rate or an epoch that is not finite.
    pub fn turning(
        attitude: &UnitQuaternion<f64>,
        rate: &Vector3<f64>,
        epoch: Option<f64>,
    ) -> Result<Self, Error> {
        all_finite("rate", rate)?;
        epoch.map_or(Ok(0.0), |epoch| finite("epoch", epoch))?;
        Ok(Self::Turning {
            attitude: *attitude,
            rate: *rate,
            epoch,
        })
    }

    /// A smooth target through the `attitudes` at the ascending `times`.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, neighbours that are a quarter of a turn apart or more.
    ///
    /// # Panics
    /// When `times` and `attitudes` differ in length.
    pub fn sampled(times: &[f64], attitudes: &[UnitQuaternion<f64>]) -> Result<Self, Error> {
        Self::sampled_watched(times, attitudes, &mut |_| ControlFlow::Continue(()))
    }

    /// As [`Self::sampled`] of very many samples: now and then `watch` gets a fraction done, and may end it.
    ///
    /// # Errors
    /// As [`Self::sampled`], and [`Error::Stopped`].
    ///
    /// # Panics
    /// As [`Self::sampled`].
    pub fn sampled_watched(
        times: &[f64],
        attitudes: &[UnitQuaternion<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let (mut vectors, mut scalars) = (Vec::new(), Vec::new());
        let mut last: Option<[f64; 4]> = None;
        each_watched(attitudes.iter(), watch, |attitude| {
            let mut next = components(attitude);
            if let Some(last) = last {
                let dot: f64 = last.iter().zip(&next).map(|(a, b)| a * b).sum();
                if dot < 0.0 {
                    next = next.map(|x| -x);
                }
                if dot.abs() <= QUARTER {
                    return Err(Error::OutOfDomain {
                        what: "the angle between two samples of target",
                        law: "less than a quarter of a turn (give more of them)",
                        value: 2.0 * dot.abs().acos(),
                    });
                }
            }
            let [x, y, z, w] = next;
            vectors.push(Vector3::new(x, y, z));
            scalars.push(Vector3::new(w, 0.0, 0.0));
            last = Some(next);
            Ok(())
        })?;
        let names = [
            "times",
            "the span of times",
            "target",
            "the spline of target",
        ];
        Ok(Self::Sampled(Sampling {
            vector: Spline::through(names, times, &vectors, watch)?,
            scalar: Spline::through(names, times, &scalars, watch)?,
        }))
    }

    /// The attitude that stays, of a target that does.
    #[must_use]
    pub fn as_fixed(&self) -> Option<&UnitQuaternion<f64>> {
        match self {
            Self::Fixed(attitude) => Some(attitude),
            _ => None,
        }
    }

    /// Whether it begins with the motion, wherever in time that is.
    #[must_use]
    pub fn needs_epoch(&self) -> bool {
        match self {
            Self::Turning { epoch, .. } => epoch.is_none(),
            Self::Down(orbit) => orbit.needs_epoch(),
            Self::Fixed(_) | Self::Sampled(_) => false,
        }
    }

    /// That of a motion that began at `t`, for the rest of it.
    #[must_use]
    pub fn with_epoch(self, t: f64) -> Self {
        match self {
            Self::Turning {
                attitude,
                rate,
                epoch,
            } => Self::Turning {
                attitude,
                rate,
                epoch: epoch.or(Some(t)),
            },
            Self::Down(orbit) => Self::Down(orbit.with_epoch(t)),
            Self::Fixed(_) | Self::Sampled(_) => self,
        }
    }

    /// The times at which it is not smooth.
    #[must_use]
    pub fn breaks(&self) -> &[f64] {
        match self {
            Self::Sampled(sampling) => sampling.vector.knots(),
            Self::Down(orbit) => orbit.breaks(),
            Self::Fixed(_) | Self::Turning { .. } => &[],
        }
    }

    /// That it is known from one time to another of a motion that began at `start`.
    ///
    /// # Errors
    /// [`OutsideSamples`](crate::error::MotionFault::OutsideSamples).
    pub fn check(&self, start: f64, from: f64, to: f64) -> Result<(), Error> {
        match self {
            Self::Sampled(sampling) => {
                sampling.vector.check_at(from)?;
                sampling.vector.check_at(to)
            }
            Self::Down(orbit) => orbit.check(start, from, to),
            Self::Fixed(_) | Self::Turning { .. } => Ok(()),
        }
    }

    /// The attitude at time `t` of a motion that began at `start`, and its angular velocity relative to N, components in its own frame.
    #[must_use]
    pub fn at(&self, start: f64, t: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
        match self {
            Self::Fixed(attitude) => (*attitude, Vector3::zeros()),
            Self::Turning {
                attitude,
                rate,
                epoch,
            } => {
                let turn = UnitQuaternion::from_scaled_axis(rate * (t - epoch.unwrap_or(start)));
                // N from the target is turned by the rate, which is in N.
                let now = turn * attitude;
                (now, now.inverse_transform_vector(rate))
            }
            Self::Down(orbit) => orbit.frame(start, t),
            Self::Sampled(sampling) => {
                let [vector, slope] = sampling.vector.at(t);
                let [scalar, rise] = sampling.scalar.at(t);
                let q = Quaternion::new(scalar.x, vector.x, vector.y, vector.z);
                let rate = Quaternion::new(rise.x, slope.x, slope.y, slope.z);
                // q̇ = ½ q∘ω but for the change of its length, which is the scalar part.
                let spin = (q.conjugate() * rate).imag() * (2.0 / q.norm_squared());
                (UnitQuaternion::new_normalize(q), spin)
            }
        }
    }
}
