//! Where the body is, from an attractor: an orbit that its attitude does not change.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::kepler::Orbit;
use super::oblate::{Bulge, Oblate};
use super::quintic::Quintic;
use super::spline::{Spline, check_within};
use crate::error::{Error, finite};
use crate::motion::attitude::from_axes;
use crate::numerics::threads::Watch;

/// Position and velocity of C from an attractor, in N, at any time of a motion.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::motion::loads::{Oblate, OrbitModel, kepler::Orbit};
/// use polhode::nalgebra::Vector3;
///
/// let orbit = Orbit::new(1.0, &Vector3::x(), &Vector3::y())?;
/// let model = OrbitModel::kepler(&orbit, None)?; // which begins with the motion
/// assert!(model.needs_epoch() && model.as_kepler().is_some() && model.as_oblate().is_none());
/// let begun = model.with_epoch(10.0);
/// assert!((begun.at(0.0, 10.0 + std::f64::consts::PI).0 + Vector3::x()).norm() < 1e-14);
/// let flattened = OrbitModel::oblate(Oblate::new(&orbit, 1e-3, 0.9, &Vector3::z())?, Some(0.0))?;
/// assert!(flattened.as_oblate().is_some());
/// // Through positions that are known at some times, and at no others.
/// let sampled = OrbitModel::sampled(&[0.0, 1.0, 2.0], &[Vector3::x(), Vector3::y(), -Vector3::x()])?;
/// assert_eq!(sampled.breaks(), [0.0, 1.0, 2.0]);
/// // Where there are very many, somebody may want to end it.
/// let (times, still) = ([0.0, 1.0], [Vector3::x(); 2]);
/// let watched = OrbitModel::sampled_watched(&times, &still, None, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(watched, OrbitModel::sampled(&times, &still)?);
/// // With velocities, and about an oblate attractor: the path is the same, the torque is not.
/// let moving = [Vector3::y(), Vector3::new(0.0, 1.0, -1.0)];
/// let quick = OrbitModel::sampled_watched(&times, &still, Some(&moving), &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(quick.at(0.0, 1.0), (still[1], moving[1]));
/// let flattened = quick.clone().about_oblate(1e-3, 0.9, &Vector3::z())?;
/// assert_eq!(flattened.at(0.0, 0.3), quick.at(0.0, 0.3));
/// // Other orbits are not changed by a bulge that they do not feel.
/// assert!(begun.about_oblate(1e-3, 0.9, &Vector3::z()).is_err());
/// assert!(sampled.check(0.0, 0.0, 2.0).is_ok() && sampled.check(0.0, 0.0, 2.5).is_err());
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitModel(OrbitKind);

#[derive(Clone, Debug, PartialEq)]
enum OrbitKind {
    /// With the time at which it has the state it was given with; the start of the motion where there is none.
    Kepler(Orbit, Option<f64>),
    /// As above.
    Oblate(Arc<Oblate>, Option<f64>),
    /// A curve through positions at some times, with the bulge of the attractor where it has one.
    Sampled(Arc<Curve>, Option<Bulge>),
}

#[derive(Clone, Debug, PartialEq)]
enum Curve {
    /// Through positions.
    Cubic(Spline),
    /// Through positions with velocities.
    Quintic(Quintic),
}

impl Curve {
    fn at(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        match self {
            Self::Cubic(spline) => spline.at(t),
            Self::Quintic(quintic) => quintic.at(t),
        }
        .into()
    }

    fn bend(&self, t: f64) -> Vector3<f64> {
        match self {
            Self::Cubic(spline) => spline.bend(t),
            Self::Quintic(quintic) => quintic.bend(t),
        }
    }

    fn knots(&self) -> &[f64] {
        match self {
            Self::Cubic(spline) => spline.knots(),
            Self::Quintic(quintic) => quintic.knots(),
        }
    }
}

impl OrbitModel {
    /// A Kepler orbit that has its state at `epoch`, or at the start of the motion.
    ///
    /// # Errors
    /// An `epoch` that is not finite.
    pub fn kepler(orbit: &Orbit, epoch: Option<f64>) -> Result<Self, Error> {
        epoch.map_or(Ok(0.0), |epoch| finite("epoch", epoch))?;
        Ok(Self(OrbitKind::Kepler(*orbit, epoch)))
    }

    /// An orbit about an oblate attractor, likewise.
    ///
    /// # Errors
    /// An `epoch` that is not finite.
    pub fn oblate(orbit: Oblate, epoch: Option<f64>) -> Result<Self, Error> {
        epoch.map_or(Ok(0.0), |epoch| finite("epoch", epoch))?;
        Ok(Self(OrbitKind::Oblate(Arc::new(orbit), epoch)))
    }

    /// The cubic spline through `positions` at the ascending `times`.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, numbers that are not finite.
    ///
    /// # Panics
    /// When `times` and `positions` differ in length.
    pub fn sampled(times: &[f64], positions: &[Vector3<f64>]) -> Result<Self, Error> {
        Self::sampled_watched(times, positions, None, &mut |_| ControlFlow::Continue(()))
    }

    /// As [`Self::sampled`], or with `velocities` the quintics through both, of very many samples: now and then `watch` gets a
    /// fraction done, and may end it.
    ///
    /// The quintics have the accelerations at the samples that neighbouring positions and velocities show, whatever acts.
    ///
    /// # Errors
    /// As [`Self::sampled`], and [`Error::Stopped`].
    ///
    /// # Panics
    /// As [`Self::sampled`]; when `times` and `velocities` differ in length.
    pub fn sampled_watched(
        times: &[f64],
        positions: &[Vector3<f64>],
        velocities: Option<&[Vector3<f64>]>,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let [when, span, what] = ["t", "the span of t", "position"];
        let curve = if let Some(velocities) = velocities {
            let through = "the quintics through position and velocity";
            let names = [when, span, what, "velocity", through];
            Curve::Quintic(Quintic::through(
                names,
                times,
                [positions, velocities],
                watch,
            )?)
        } else {
            let names = [when, span, what, "the spline through position"];
            Curve::Cubic(Spline::through(names, times, positions, watch)?)
        };
        Ok(Self(OrbitKind::Sampled(Arc::new(curve), None)))
    }

    /// The same samples about an attractor with J₂, the radius that it refers to, and its pole: for the torque alone.
    ///
    /// # Errors
    /// As [`Oblate::new`]; [`Error::OutOfDomain`] of an orbit that is none of samples: [`Self::oblate`] is one about such an attractor.
    pub fn about_oblate(self, j2: f64, radius: f64, pole: &Vector3<f64>) -> Result<Self, Error> {
        let OrbitKind::Sampled(curve, _) = self.0 else {
            return Err(Error::OutOfDomain {
                what: "j2 of an orbit by a law",
                law: "given with the orbit",
                value: j2,
            });
        };
        let bulge = Bulge::new(j2, radius, pole)?;
        Ok(Self(OrbitKind::Sampled(curve, Some(bulge))))
    }

    /// The bulge of the attractor, where it has one.
    pub(super) fn bulge(&self) -> Option<Bulge> {
        match &self.0 {
            OrbitKind::Kepler(..) => None,
            OrbitKind::Oblate(orbit, _) => Some(Bulge {
                size: orbit.bulge(),
                pole: *orbit.pole(),
            }),
            OrbitKind::Sampled(_, bulge) => *bulge,
        }
    }

    /// The Kepler orbit and its epoch, where it is one.
    #[must_use]
    pub fn as_kepler(&self) -> Option<(&Orbit, Option<f64>)> {
        match &self.0 {
            OrbitKind::Kepler(orbit, epoch) => Some((orbit, *epoch)),
            OrbitKind::Oblate(..) | OrbitKind::Sampled(..) => None,
        }
    }

    /// The orbit about an oblate attractor, where it is one.
    #[must_use]
    pub fn as_oblate(&self) -> Option<&Oblate> {
        match &self.0 {
            OrbitKind::Oblate(orbit, _) => Some(orbit),
            OrbitKind::Kepler(..) | OrbitKind::Sampled(..) => None,
        }
    }

    /// Position and velocity at time `t` of a motion that began at `start`.
    #[must_use]
    pub fn at(&self, start: f64, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        match &self.0 {
            OrbitKind::Kepler(orbit, epoch) => orbit.at(t - epoch.unwrap_or(start)),
            OrbitKind::Oblate(orbit, epoch) => orbit.at(t - epoch.unwrap_or(start)),
            OrbitKind::Sampled(curve, _) => curve.at(t),
        }
    }

    /// The frame that points down, and its angular velocity relative to N in its own components: z to the attractor, y along minus the
    /// normal n of the orbit.
    ///
    /// With the angular momentum h it is `h/r² n + r (r̈·n)/h r̂`: the second part is that of a plane that turns.
    #[must_use]
    pub fn frame(&self, start: f64, t: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let (r, v) = self.at(start, t);
        let swept = r.cross(&v);
        let (distance, size) = (r.norm(), swept.norm());
        let (normal, outward) = (swept / size, r / distance);
        let across = match &self.0 {
            OrbitKind::Kepler(..) => 0.0,
            OrbitKind::Oblate(orbit, _) => orbit.acceleration(&r).dot(&normal),
            OrbitKind::Sampled(curve, _) => curve.bend(t).dot(&normal),
        };
        let (y, z) = (-normal, -outward);
        let axes = Matrix3::from_columns(&[y.cross(&z), y, z]);
        let rate = Vector3::new(
            0.0,
            -size / distance / distance,
            0.0 - distance * (across / size),
        );
        (from_axes(&axes), rate)
    }

    /// Whether it begins with the motion, wherever in time that is.
    #[must_use]
    pub fn needs_epoch(&self) -> bool {
        matches!(
            self.0,
            OrbitKind::Kepler(_, None) | OrbitKind::Oblate(_, None)
        )
    }

    /// That of a motion that began at `t`, for the rest of it.
    #[must_use]
    pub fn with_epoch(mut self, t: f64) -> Self {
        if let OrbitKind::Kepler(_, epoch) | OrbitKind::Oblate(_, epoch) = &mut self.0 {
            *epoch = epoch.or(Some(t));
        }
        self
    }

    /// The times at which it is not smooth.
    #[must_use]
    pub fn breaks(&self) -> &[f64] {
        match &self.0 {
            OrbitKind::Sampled(curve, _) => curve.knots(),
            OrbitKind::Kepler(..) | OrbitKind::Oblate(..) => &[],
        }
    }

    /// That it is known from one time to another of a motion that began at `start`.
    ///
    /// # Errors
    /// [`OutsideSamples`](crate::error::MotionFault::OutsideSamples);
    /// [`OrbitBeyondReach`](crate::error::MotionFault::OrbitBeyondReach); too many revolutions about an oblate attractor.
    pub fn check(&self, start: f64, from: f64, to: f64) -> Result<(), Error> {
        match &self.0 {
            OrbitKind::Kepler(orbit, epoch) => [from, to]
                .iter()
                .try_for_each(|t| orbit.check(t - epoch.unwrap_or(start))),
            OrbitKind::Oblate(orbit, epoch) => [from, to]
                .iter()
                .try_for_each(|t| orbit.check(t - epoch.unwrap_or(start))),
            OrbitKind::Sampled(curve, _) => {
                let knots = curve.knots();
                check_within(knots, from).and_then(|()| check_within(knots, to))
            }
        }
    }
}
