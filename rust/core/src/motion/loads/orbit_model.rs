//! Where the body is, from an attractor: an orbit that its attitude does not change.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::kepler::Orbit;
use super::oblate::Oblate;
use super::spline::Spline;
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
/// let watched = OrbitModel::sampled_watched(&times, &still, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(watched, OrbitModel::sampled(&times, &still)?);
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
    /// A cubic spline through positions at some times.
    Sampled(Arc<Spline>),
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

    /// The spline through `positions` at the ascending `times`.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, numbers that are not finite.
    ///
    /// # Panics
    /// When `times` and `positions` differ in length.
    pub fn sampled(times: &[f64], positions: &[Vector3<f64>]) -> Result<Self, Error> {
        Self::sampled_watched(times, positions, &mut |_| ControlFlow::Continue(()))
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
        positions: &[Vector3<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let names = [
            "t",
            "the span of t",
            "position",
            "the spline through position",
        ];
        let spline = Spline::through(names, times, positions, watch)?;
        Ok(Self(OrbitKind::Sampled(Arc::new(spline))))
    }

    /// The Kepler orbit and its epoch, where it is one.
    #[must_use]
    pub fn as_kepler(&self) -> Option<(&Orbit, Option<f64>)> {
        match &self.0 {
            OrbitKind::Kepler(orbit, epoch) => Some((orbit, *epoch)),
            OrbitKind::Oblate(..) | OrbitKind::Sampled(_) => None,
        }
    }

    /// The orbit about an oblate attractor, where it is one.
    #[must_use]
    pub fn as_oblate(&self) -> Option<&Oblate> {
        match &self.0 {
            OrbitKind::Oblate(orbit, _) => Some(orbit),
            OrbitKind::Kepler(..) | OrbitKind::Sampled(_) => None,
        }
    }

    /// Position and velocity at time `t` of a motion that began at `start`.
    #[must_use]
    pub fn at(&self, start: f64, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        match &self.0 {
            OrbitKind::Kepler(orbit, epoch) => orbit.at(t - epoch.unwrap_or(start)),
            OrbitKind::Oblate(orbit, epoch) => orbit.at(t - epoch.unwrap_or(start)),
            OrbitKind::Sampled(spline) => spline.at(t).into(),
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
            OrbitKind::Sampled(spline) => spline.bend(t).dot(&normal),
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
            OrbitKind::Sampled(spline) => spline.knots(),
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
            OrbitKind::Sampled(spline) => spline.check_at(from).and_then(|()| spline.check_at(to)),
        }
    }
}
