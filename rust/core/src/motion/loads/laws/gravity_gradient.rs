//! The torque of an attractor's field on a body that is small beside its distance.

use nalgebra::{UnitQuaternion, Vector3};

use super::slug::positive;
use crate::error::{Error, MotionFault};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::kepler::Orbit;
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::orbit_model::OrbitModel;
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame};
use crate::motion::loads::series_terms::SeriesTerms;
use crate::motion::loads::series_terms::{OrbitState, OrbitTorque, StepTime};
use crate::motion::loads::spline::within;
use crate::motion::loads::variables::Parameter;
use crate::motion::loads::variables::Variables;
use crate::motion::loads::wrench::Wrench;
use crate::motion::state::Phase;

/// `N_C = 3μ/r⁵ r×(I_C r)`, r from the attractor to C, on an orbit that the body's attitude does not change.
///
/// All in B: `r_B = R_NBᵀ r_N`. The field is that of a point or sphere of gravitational parameter μ to first order in the
/// size of the body over r; of an oblate attractor with that of its J₂ too. With `n = r/r`, the pole p, `s = n·p` and `ε = J₂ R²/6r²`
/// its torque is
///
/// ```text
/// 3μ/r³ [(1 + ε (15 − 105 s²)) n×In + 30 ε s (n×Ip + p×In) − 6 ε p×Ip]
/// ```
///
/// Source: Hughes, Spacecraft Attitude Dynamics, §8.1; the second derivatives of Vallado's potential, §8.6.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{GravityGradient, BodyAtPoint};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // A rod of 6 m and 10 kg on a circle about the earth, at 45° from the vertical in the plane of the orbit.
/// let rod = solids::cuboid(&[6.0, 0.0, 0.0], Amount::Mass(10.0))?; // I = m l²/12 = 30 across
/// let (mu, r) = (3.986_004_418e14_f64, 7e6_f64);
/// let speed = (mu / r).sqrt();
/// let law = GravityGradient::new(mu, &(Vector3::x() * r), &(Vector3::y() * speed), None)?;
/// let body = BodyAtPoint::free(&rod, 0.0);
/// let tilted = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_4);
/// let torque = law.torque(&body, 0.0, &tilted);
/// assert!((torque.z / (-1.5 * mu / r.powi(3) * 30.0) - 1.0).abs() < 1e-12); // 3/2 n² ΔI sin 2α
/// assert_eq!((law.mu(), law.coefficient()), (mu, 3.0 * mu));
/// // A quarter of a revolution later.
/// let quarter = std::f64::consts::FRAC_PI_2 * r / speed;
/// assert!((law.orbit_at(&body, quarter).0 - Vector3::y() * r).norm() < 1e-6);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GravityGradient {
    mu: f64,
    orbit: OrbitModel,
    /// The factor of the load.
    strength: f64,
}

impl GravityGradient {
    /// On the orbit with C at `position` with `velocity` (from the attractor, in N) at `epoch`, or at the start.
    ///
    /// # Errors
    /// As [`Orbit::new`]; an `epoch` that is not finite.
    pub fn new(
        mu: f64,
        position: &Vector3<f64>,
        velocity: &Vector3<f64>,
        epoch: Option<f64>,
    ) -> Result<Self, Error> {
        let orbit = OrbitModel::kepler(&Orbit::new(mu, position, velocity)?, epoch)?;
        Self::along(mu, orbit)
    }

    /// With C on an orbit of any kind.
    ///
    /// # Errors
    /// For μ that is not positive.
    pub fn along(mu: f64, orbit: OrbitModel) -> Result<Self, Error> {
        positive("mu", mu)?;
        Ok(Self {
            mu,
            orbit,
            strength: 1.0,
        })
    }

    /// `3μ` times the factor of the load: `N = coefficient/r⁵ r×(I_C r)`.
    #[must_use]
    pub fn coefficient(&self) -> f64 {
        3.0 * self.mu * self.strength
    }

    /// μ.
    #[must_use]
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// Position and velocity of C from the attractor at time `t`, in N.
    #[must_use]
    pub fn orbit_at(&self, body: &BodyAtPoint, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        self.orbit.at(body.start, t)
    }

    /// The torque in B.
    #[must_use]
    pub fn torque(
        &self,
        body: &BodyAtPoint,
        t: f64,
        attitude: &UnitQuaternion<f64>,
    ) -> Vector3<f64> {
        let (r, _) = self.orbit_at(body, t);
        let distance = r.norm();
        let strength = self.coefficient() / distance / distance / distance;
        let n = attitude.inverse_transform_vector(&(r / distance));
        let along = n.cross(&(body.inertia * n));
        let Some(bulge) = self.orbit.bulge() else {
            return along * strength;
        };
        let p = attitude.inverse_transform_vector(&bulge.pole);
        let (s, part) = (n.dot(&p), bulge.size / distance / distance / 6.0);
        let mixed = n.cross(&(body.inertia * p)) + p.cross(&(body.inertia * n));
        let polar = p.cross(&(body.inertia * p));
        (along * (1.0 + part * (15.0 - 105.0 * s * s)) + mixed * (30.0 * part * s)
            - polar * (6.0 * part))
            * strength
    }
}

impl Law for GravityGradient {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: false,
            needs_body: true,
            needs_epoch: self.orbit.needs_epoch(),
            keeps: ConservedMomentum::Nothing,
            has_series: self.orbit.as_kepler().is_some(),
        }
    }

    /// A factor is none of them: it stays as it is.
    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::new("mu", &[]),
            Parameter::new("position", &[3]),
            Parameter::new("velocity", &[3]),
        ]
    }

    fn scaled(&self, factor: f64) -> Result<Self, Error> {
        Ok(Self {
            strength: self.strength * factor,
            ..self.clone()
        })
    }

    /// The epoch is `t` where it has none.
    fn with_epoch(self, t: f64) -> Self {
        Self {
            orbit: self.orbit.with_epoch(t),
            ..self
        }
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        within(self.orbit.breaks(), from, to).to_vec()
    }

    fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        if body.pivoted {
            return Err(Error::Motion(MotionFault::PivotedInOrbit));
        }
        self.orbit.check(body.start, from, to)
    }

    fn wrench(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        Wrench::couple(self.torque(body, t, &phase.attitude))
    }

    fn potential(&self, _: &BodyAtPoint, _: &Phase) -> Option<f64> {
        None
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        _: f64,
    ) {
        series.gradients.push((axes.term, self));
    }
}

impl<X: LawNumber> OrbitTorque<X> for GravityGradient {
    fn on_orbit(&self, axes: &PrincipalFrame<'_, X>, when: &StepTime<X>) -> OrbitState<X> {
        // Others have no series.
        let Some((orbit, epoch)) = self.orbit.as_kepler() else {
            return OrbitState::none();
        };
        let elapsed = when.time - epoch.unwrap_or(axes.body.start);
        let columns = ["mu", "position", "velocity"].map(|name| axes.parameters.of(name).start);
        let (r, v) = (axes.variables).on_orbit(orbit, elapsed, columns);
        let (distance, unit) = (r.dot(&r).root(), X::from(when.unit));
        let cube = distance * distance * distance * unit * unit;
        let mu = axes.number(self.mu(), "mu");
        let more = (mu - X::from(self.mu())) * X::from(3.0 * self.strength); // zero, but its derivatives are not
        OrbitState {
            position: r / distance,
            velocity: v / (distance * unit),
            pull: mu / cube,
            strength: (X::from(self.coefficient()) + more) / cube,
        }
    }

    fn square_of_rate(&self, body: &BodyAtPoint) -> f64 {
        let (r, v) = self.orbit_at(body, body.start);
        let distance = r.norm();
        let pull = self.coefficient().abs().max(self.mu()) / distance.powi(3);
        pull.max((v.norm() / distance).powi(2))
    }
}
