//! The torque of a magnetic field.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::Vector3;

use super::slug::positive;
use crate::error::{Error, MotionFault, all_finite, finite};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::carried_momentum::LawContext;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::orbit_model::OrbitModel;
use crate::motion::loads::piecewise_signal::PiecewiseSignal;
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::spline::{Spline, within};
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::wrench::{Wrench, times};
use crate::motion::state::Phase;
use crate::numerics::quaternion::cross_matrix;
use crate::numerics::threads::Watch;

/// A magnetic field, components in N.
#[derive(Clone, Debug, PartialEq)]
pub struct MagneticField(FieldModel);

#[derive(Clone, Debug, PartialEq)]
enum FieldModel {
    /// The same everywhere and always.
    Uniform(Vector3<f64>),
    /// Known at some times, a cubic spline in between.
    Sampled(Arc<Spline>),
    /// That of a dipole at the attractor of an orbit.
    Dipole {
        orbit: OrbitModel,
        /// μ₀/4π times the dipole's moment.
        strength: Vector3<f64>,
    },
}

impl MagneticField {
    /// The same everywhere and always.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn uniform(field: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("field", field)?;
        Ok(Self(FieldModel::Uniform(*field)))
    }

    /// The spline through `fields` at the ascending `times`.
    ///
    /// # Errors
    /// Fewer than two times, times that do not ascend, numbers that are not finite.
    ///
    /// # Panics
    /// When `times` and `fields` differ in length.
    pub fn sampled(times: &[f64], fields: &[Vector3<f64>]) -> Result<Self, Error> {
        Self::sampled_watched(times, fields, &mut |_| ControlFlow::Continue(()))
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
        fields: &[Vector3<f64>],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let names = [
            "times",
            "the span of times",
            "field",
            "the spline through field",
        ];
        let spline = Spline::through(names, times, fields, watch)?;
        Ok(Self(FieldModel::Sampled(Arc::new(spline))))
    }

    /// `B = 3 (M·r) r/r⁵ − M/r³` on an orbit, with M the `strength`: μ₀/4π times the moment of a dipole at the attractor.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn of_dipole(strength: &Vector3<f64>, orbit: OrbitModel) -> Result<Self, Error> {
        all_finite("strength", strength)?;
        Ok(Self(FieldModel::Dipole {
            orbit,
            strength: *strength,
        }))
    }

    /// The field at time `t` of a motion that began at `start`, and its rate, both in N.
    #[must_use]
    pub fn at(&self, start: f64, t: f64) -> [Vector3<f64>; 2] {
        match &self.0 {
            FieldModel::Uniform(field) => [*field, Vector3::zeros()],
            FieldModel::Sampled(spline) => spline.at(t),
            FieldModel::Dipole { orbit, strength } => {
                let (r, v) = orbit.at(start, t);
                field_and_rate(strength, &r, &v)
            }
        }
    }
}

/// The field `B = 3 (M·r) r/r⁵ − M/r³` of a dipole at the position r from it, and its rate for one that moves with v.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::loads::magnetic::field_and_rate;
///
/// // On the axis of a dipole the field is twice that on its equator.
/// let (dipole, still) = (Vector3::z(), Vector3::zeros());
/// let [pole, _] = field_and_rate(&dipole, &(Vector3::z() * 2.0), &still);
/// let [equator, _] = field_and_rate(&dipole, &(Vector3::x() * 2.0), &still);
/// assert_eq!((pole.z, equator.z), (0.25, -0.125));
/// ```
#[must_use]
pub fn field_and_rate(
    strength: &Vector3<f64>,
    position: &Vector3<f64>,
    velocity: &Vector3<f64>,
) -> [Vector3<f64>; 2] {
    let distance = position.norm();
    let (n, rate) = (position / distance, velocity / distance);
    let m = strength / distance / distance / distance;
    let (along, outward) = (m.dot(&n), n.dot(&rate));
    [
        n * (3.0 * along) - m,
        rate * (3.0 * along)
            + n * (3.0 * m.dot(&rate) - 15.0 * along * outward)
            + m * (3.0 * outward),
    ]
}

/// The moment of magnets and coils in a body, before the limit of coils.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::Moment;
/// use polhode::nalgebra::Vector3;
///
/// let switched = Moment::table(&[0.0, 10.0], &[Vector3::x(), Vector3::zeros()])?;
/// assert!(matches!(switched, Moment::Table(_)));
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Moment {
    /// Constant in the body.
    Fixed(Vector3<f64>),
    /// Components in B that are constant from each time on to the next.
    Table(Box<[PiecewiseSignal; 3]>),
    /// What exerts the part across the field of the torque N that a controller asks for: `m = B × N/|B|²`, times this number; without
    /// a field none. See [`Term::controlled_coils`](super::super::Term::controlled_coils).
    Commanded(f64),
}

impl Moment {
    /// `moments[k]` from `times[k]` on.
    ///
    /// # Errors
    /// Without times, for times that do not ascend, for numbers that are not finite.
    ///
    /// # Panics
    /// When `times` and `moments` differ in length.
    pub fn table(times: &[f64], moments: &[Vector3<f64>]) -> Result<Self, Error> {
        let of = |i: usize| {
            let values: Vec<f64> = moments.iter().map(|moment| moment[i]).collect();
            PiecewiseSignal::table("dipole", times, &values)
        };
        Ok(Self::Table(Box::new([of(0)?, of(1)?, of(2)?])))
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Ok(match self {
            Self::Fixed(moment) => Self::Fixed(times(moment, factor)?),
            Self::Table(parts) => {
                let scaled = |part: &PiecewiseSignal| part.scaled("dipole", factor);
                let [x, y, z] = &**parts;
                Self::Table(Box::new([scaled(x)?, scaled(y)?, scaled(z)?]))
            }
            Self::Commanded(share) => Self::Commanded(finite("dipole", share * factor)?),
        })
    }
}

/// `N = m × B` with the moment `m = d − k Ḃ`, all in B: d of magnets and coils, and Ḃ the rate of the field as the body sees it. Of coils
/// with a limit each component of m is clipped.
///
/// The second part is the law that slows a satellite down ("B-dot"): `Ḃ = R_NBᵀ Ḃ_N − ω × B`.
/// Source: Wertz, Spacecraft Attitude Determination and Control, §18.3; Stickler, Alfriend, J. Spacecraft 13 (1976) 282.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{Magnetic, MagneticField, OrbitModel, BodyAtPoint, Term, kepler::Orbit};
/// use polhode::motion::simulate::{Phase, State};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // A compass needle of 0.1 A m² across a field of 50 µT: m × B.
/// let field = MagneticField::uniform(&Vector3::new(0.0, 5e-5, 0.0))?;
/// let needle: Term = Magnetic::new(&Vector3::new(0.1, 0.0, 0.0), None, field.clone())?.into();
/// let body = solids::cuboid(&[0.05, 0.002, 0.001], Amount::Mass(0.001))?;
/// let rest = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() });
/// let torque = needle.wrench(&BodyAtPoint::free(&body, 0.0), 0.0, &rest).torque;
/// assert!((torque.z - 5e-6).abs() < 1e-20);
/// // Of coils with a limit each component of the moment is clipped.
/// let coils = Magnetic::new(&Vector3::new(0.1, 0.0, 0.0), None, field.clone())?.with_max_dipole(&Vector3::repeat(0.02))?;
/// assert!(coils.has_limit());
/// let torque = Term::from(coils).wrench(&BodyAtPoint::free(&body, 0.0), 0.0, &rest).torque;
/// assert!((torque.z - 1e-6).abs() < 1e-20);
///
/// // The field along an orbit about a dipole, twice as strong above its pole as above its equator, or through samples.
/// let orbit = OrbitModel::kepler(&Orbit::new(1.0, &Vector3::x(), &Vector3::z())?, None)?;
/// let dipole = MagneticField::of_dipole(&Vector3::z(), orbit)?;
/// let [above_equator, _] = dipole.at(0.0, 0.0);
/// let [above_pole, _] = dipole.at(0.0, std::f64::consts::FRAC_PI_2);
/// assert!((above_pole.norm() - 2.0 * above_equator.norm()).abs() < 1e-12);
/// let sampled = MagneticField::sampled(&[0.0, 1.0], &[Vector3::x(), Vector3::y()])?;
/// assert_eq!(sampled.at(0.0, 0.5)[1], Vector3::new(-1.0, 1.0, 0.0)); // its rate
/// let (times, still) = ([0.0, 1.0], [Vector3::x(); 2]);
/// let watched = MagneticField::sampled_watched(&times, &still, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(watched, MagneticField::sampled(&times, &still)?);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Magnetic {
    moment: Moment,
    gain: Option<f64>,
    field: MagneticField,
    /// The most that each component of m can be; infinite without a limit.
    max_dipole: Vector3<f64>,
}

impl Magnetic {
    /// With the moment `dipole` fixed in the body, and the gain k if the moment has a second part: with one it has no series,
    /// whatever its size.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn new(
        dipole: &Vector3<f64>,
        gain: Option<f64>,
        field: MagneticField,
    ) -> Result<Self, Error> {
        Self::of(Moment::Fixed(*dipole), gain, field)
    }

    /// With any moment.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn of(moment: Moment, gain: Option<f64>, field: MagneticField) -> Result<Self, Error> {
        if let Moment::Fixed(dipole) = &moment {
            all_finite("dipole", dipole)?;
        }
        gain.map_or(Ok(0.0), |gain| finite("gain", gain))?;
        Ok(Self {
            moment,
            gain,
            field,
            max_dipole: Vector3::repeat(f64::INFINITY),
        })
    }

    /// With coils along the axes of B, the moment of each of which can be so much at most: each component of m is clipped.
    ///
    /// # Errors
    /// For a number that is not positive or not finite.
    pub fn with_max_dipole(self, most: &Vector3<f64>) -> Result<Self, Error> {
        for &most in most {
            positive("max_dipole", most)?;
        }
        Ok(Self {
            max_dipole: *most,
            ..self
        })
    }

    /// Whether its coils have a limit.
    #[must_use]
    pub fn has_limit(&self) -> bool {
        self.max_dipole.iter().any(|most| most.is_finite())
    }

    /// The field and the moment, where it is uniform and the moment fixed in the body.
    fn constant(&self) -> Option<(&Vector3<f64>, Vector3<f64>)> {
        match (&self.field.0, &self.moment) {
            (FieldModel::Uniform(field), Moment::Fixed(moment)) if self.gain.is_none() => {
                Some((field, self.clipped(moment)))
            }
            _ => None,
        }
    }

    fn clipped(&self, moment: &Vector3<f64>) -> Vector3<f64> {
        moment.zip_map(&self.max_dipole, |m, most| m.clamp(-most, most))
    }

    /// The field in B, and the moment that is asked of the coils, where a controller asks for the torque `command` on the body.
    fn demanded(&self, now: &LawContext<'_>) -> [Vector3<f64>; 2] {
        let in_body = |vector| now.phase.attitude.inverse_transform_vector(vector);
        let [field, rate] = self.field.at(now.body.start, now.t);
        let field = in_body(&field);
        let moment = match &self.moment {
            Moment::Fixed(moment) => *moment,
            Moment::Table(parts) => {
                let [x, y, z] = &**parts;
                Vector3::new(
                    x.value(now.middle),
                    y.value(now.middle),
                    z.value(now.middle),
                )
            }
            Moment::Commanded(share) => across(&field, &now.command) * *share,
        };
        let Some(gain) = self.gain else {
            return [field, moment];
        };
        let seen = in_body(&rate) - now.phase.omega.cross(&field);
        [field, moment - seen * gain]
    }

    /// The torque about the reference point where a controller asks for the torque `command` on the body.
    pub(in crate::motion::loads) fn torque(&self, now: &LawContext<'_>) -> Vector3<f64> {
        let [field, moment] = self.demanded(now);
        self.clipped(&moment).cross(&field)
    }

    /// By how much more than its limit the coil is asked for that is asked for most: `(m/limit)² − 1`.
    pub(in crate::motion::loads) fn over_limit(&self, now: &LawContext<'_>) -> f64 {
        let [_, moment] = self.demanded(now);
        let share = moment.component_div(&self.max_dipole).amax();
        (share - 1.0) * (share + 1.0)
    }
}

/// The moment m across the field B with `m × B = N`, for the part of N across B: `B × N/|B|²`; zero without a field.
fn across(field: &Vector3<f64>, torque: &Vector3<f64>) -> Vector3<f64> {
    let largest = field.amax();
    if largest == 0.0 {
        return Vector3::zeros();
    }
    let scaled = field / largest;
    scaled.cross(torque) / (scaled.norm_squared() * largest)
}

impl Law for Magnetic {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: self.gain.is_some() || matches!(self.moment, Moment::Commanded(_)),
            needs_body: false,
            needs_epoch: match &self.field.0 {
                FieldModel::Dipole { orbit, .. } => orbit.needs_epoch(),
                FieldModel::Uniform(_) | FieldModel::Sampled(_) => false,
            },
            keeps: match &self.field.0 {
                FieldModel::Uniform(field) => ConservedMomentum::along(field),
                FieldModel::Sampled(_) | FieldModel::Dipole { .. } => ConservedMomentum::Nothing,
            },
            has_series: self.constant().is_some() && !self.has_limit(),
        }
    }

    /// Of a law with a series.
    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::new("dipole", &[3]),
            Parameter::new("field", &[3]),
        ]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        let gain = self.gain.map(|gain| gain * factor);
        let scaled = Self::of(self.moment.scaled(factor)?, gain, self.field.clone())?;
        if factor == 0.0 || !self.has_limit() {
            return Ok(scaled); // exerts nothing, whatever its limit
        }
        scaled.with_max_dipole(&times(&self.max_dipole, factor.abs())?)
    }

    fn with_epoch(self, t: f64) -> Self {
        let field = match self.field.0 {
            FieldModel::Dipole { orbit, strength } => FieldModel::Dipole {
                orbit: orbit.with_epoch(t),
                strength,
            },
            other => other,
        };
        Self {
            field: MagneticField(field),
            ..self
        }
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let of_field = match &self.field.0 {
            FieldModel::Sampled(spline) => spline.knots(),
            FieldModel::Dipole { orbit, .. } => orbit.breaks(),
            FieldModel::Uniform(_) => &[],
        };
        let mut breaks = within(of_field, from, to).to_vec();
        if let Moment::Table(parts) = &self.moment {
            breaks.extend(within(parts[0].times(), from, to));
        }
        breaks
    }

    fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        if let Moment::Table(parts) = &self.moment {
            parts[0].covers("dipole", from, to, false)?;
        }
        match &self.field.0 {
            FieldModel::Sampled(spline) => spline.check_at(from).and_then(|()| spline.check_at(to)),
            FieldModel::Dipole { .. } if body.pivoted => {
                Err(Error::Motion(MotionFault::PivotedInOrbit))
            }
            FieldModel::Dipole { orbit, .. } => orbit.check(body.start, from, to),
            FieldModel::Uniform(_) => Ok(()),
        }
    }

    fn wrench(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        if let Some((field, moment)) = self.constant() {
            return Wrench::couple(moment.cross(&phase.attitude.inverse_transform_vector(field)));
        }
        Wrench::couple(self.torque(&LawContext::without_command(body, t, t, phase)))
    }

    /// `−d·B` in a uniform field.
    fn potential(&self, _: &BodyAtPoint, phase: &Phase) -> Option<f64> {
        let in_body = |field| phase.attitude.inverse_transform_vector(field);
        (self.constant()).map(|(field, moment)| -moment.dot(&in_body(field)))
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        if let Some((field, moment)) = self.constant() {
            let lever = cross_matrix(&axes.principal(&axes.vector(&moment, "dipole")));
            series.on_space.push((axes.vector(field, "field"), lever));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::loads::kepler::Orbit;

    #[test]
    fn the_rate_of_the_field_is_its_derivative() {
        let position = Vector3::new(1.0, 0.2, -0.1);
        let orbit = Orbit::new(1.0, &position, &Vector3::new(0.1, 0.9, 0.3)).expect("an ellipse");
        let times: Vec<f64> = (0..9).map(f64::from).collect();
        let samples: Vec<_> = times.iter().map(|&t| orbit.at(t).0).collect();
        let strength = Vector3::new(0.2, -0.3, 0.9);
        let orbit = |epoch| OrbitModel::kepler(&orbit, epoch).expect("finite");
        for field in [
            MagneticField::of_dipole(&strength, orbit(Some(0.5))).expect("finite"),
            MagneticField::sampled(&times, &samples).expect("ascending"),
        ] {
            for t in [0.3, 2.2, 6.9] {
                let h = 1e-4;
                let [_, rate] = field.at(0.0, t);
                let slope = (field.at(0.0, t + h)[0] - field.at(0.0, t - h)[0]) / (2.0 * h);
                assert!((rate - slope).norm() < 1e-6 * (1.0 + rate.norm()), "{t}");
            }
        }
        // On the axis of the dipole 2M/r³, across it −M/r³.
        let field = MagneticField::of_dipole(&position, orbit(None)).expect("finite");
        let [along, _] = field.at(3.0, 3.0);
        assert!((along - position * (2.0 / position.norm().powi(3))).norm() < 1e-15);
    }
}
