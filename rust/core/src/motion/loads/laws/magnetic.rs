//! The torque of a magnetic field.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::error::{Error, MotionFault, all_finite, finite};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::orbit_model::OrbitModel;
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::spline::Spline;
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

/// `N = m × B` with the moment `m = d − k Ḃ`, all in B: d fixed in the body, and Ḃ the rate of the field as the body sees it.
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
/// let needle: Term = Magnetic::new(&Vector3::new(0.1, 0.0, 0.0), None, field)?.into();
/// let body = solids::cuboid(&[0.05, 0.002, 0.001], Amount::Mass(0.001))?;
/// let rest = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() });
/// let torque = needle.wrench(&BodyAtPoint::free(&body, 0.0), 0.0, &rest).torque;
/// assert!((torque.z - 5e-6).abs() < 1e-20);
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
    dipole: Vector3<f64>,
    gain: Option<f64>,
    field: MagneticField,
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
        all_finite("dipole", dipole)?;
        gain.map_or(Ok(0.0), |gain| finite("gain", gain))?;
        Ok(Self {
            dipole: *dipole,
            gain,
            field,
        })
    }

    /// The field, where it is uniform and the moment is fixed in the body.
    fn constant(&self) -> Option<&Vector3<f64>> {
        match &self.field.0 {
            FieldModel::Uniform(field) if self.gain.is_none() => Some(field),
            _ => None,
        }
    }
}

impl Law for Magnetic {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: self.gain.is_some(),
            needs_body: false,
            needs_epoch: match &self.field.0 {
                FieldModel::Dipole { orbit, .. } => orbit.needs_epoch(),
                FieldModel::Uniform(_) | FieldModel::Sampled(_) => false,
            },
            keeps: match &self.field.0 {
                FieldModel::Uniform(field) => ConservedMomentum::along(field),
                FieldModel::Sampled(_) | FieldModel::Dipole { .. } => ConservedMomentum::Nothing,
            },
            has_series: self.constant().is_some(),
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
        Self::new(
            &times(&self.dipole, factor)?,
            self.gain.map(|gain| gain * factor),
            self.field.clone(),
        )
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

    fn breaks(&self) -> Vec<f64> {
        match &self.field.0 {
            FieldModel::Sampled(spline) => spline.knots().to_vec(),
            FieldModel::Dipole { orbit, .. } => orbit.breaks().to_vec(),
            FieldModel::Uniform(_) => Vec::new(),
        }
    }

    fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
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
        let in_body = |vector| phase.attitude.inverse_transform_vector(vector);
        if let Some(field) = self.constant() {
            return Wrench::couple(self.dipole.cross(&in_body(field)));
        }
        let [field, rate] = self.field.at(body.start, t);
        let (field, rate) = (in_body(&field), in_body(&rate));
        let seen = rate - phase.omega.cross(&field);
        let moment = self
            .gain
            .map_or(self.dipole, |gain| self.dipole - seen * gain);
        Wrench::couple(moment.cross(&field))
    }

    /// `−d·B` in a uniform field.
    fn potential(&self, _: &BodyAtPoint, phase: &Phase) -> Option<f64> {
        let in_body = |field| phase.attitude.inverse_transform_vector(field);
        (self.constant()).map(|field| -self.dipole.dot(&in_body(field)))
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        if let Some(field) = self.constant() {
            let lever = cross_matrix(&axes.principal(&axes.vector(&self.dipole, "dipole")));
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
