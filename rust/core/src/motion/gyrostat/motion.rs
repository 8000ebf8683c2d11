//! A gyrostat's motion from its start, and the states at any time.

use nalgebra::{UnitQuaternion, Vector3};

use super::constants::{Secular, moving_propagator, steady_propagator};
use super::curve::{Curve, apart};
use super::mode::Mode;
use super::pencil::Pencil;
use super::pencil::value_near_separatrix;
use super::products::GyrostatStart;
use super::propagator::Propagator;
use super::spinor::Spinor;
use super::start::{Start, dot};
use crate::error::{Error, MotionFault, all_finite};
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::motion::closed_form;
use crate::motion::closed_form::ClosedForm;
use crate::motion::free::{self, FreeMotion};
use crate::motion::state::State;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// The motion of a body with constant angular momentum h inside, on which no torque acts about its centre of mass, from its
/// state at t = 0: `I ω̇ + ω × (I ω + h) = 0`.
///
/// I is the tensor of the body with its wheels locked where their rates relative to it are held; with free wheels it is
/// `I − Σ J a aᵀ`, and h what they have in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyrostatMotion {
    /// How it moves.
    pub mode: Mode,
    /// The state at t = 0.
    pub initial: State,
    /// h in B, to twice the precision.
    pub rotor: Vector,
    /// `I ω + h`, components in space: constant.
    pub angular_momentum: Vector3<f64>,
    /// `½ ω·I ω`: constant. The energy but for that of the wheels in their own rotation.
    pub kinetic_energy: f64,
    /// The time after which ω and L are again where they were in the body; infinite where they never are, NaN where they are
    /// constant.
    pub period: DoubleDouble,
    /// The rate in radians at which the body turns about L in the mean, seen each time when ω has come back. Known but for
    /// whole turns in a period: which of them are made is a matter of what axis of the body is looked at.
    pub mean_precession: DoubleDouble,
    way: MotionKind,
}

/// By which formulas.
#[derive(Clone, Copy, Debug, PartialEq)]
enum MotionKind {
    /// Without momentum inside.
    Free(FreeMotion),
    Within(Propagator),
}

/// A discriminant this small beside its terms is computed again with four times the precision. What is larger has an error of
/// 1e-16 at most, relative to itself: twice the precision is 1e-32 of the terms.
const LOST: f64 = 1e-16;
/// Of a motion whose ω at the start is off by more than this part of it too many digits are lost.
const TOO_FAR_OFF: f64 = 1e-9;

impl GyrostatMotion {
    /// From the principal moments and axes of the tensor I, h and ω at the start, components in B, and the attitude.
    ///
    /// # Errors
    /// [`Error::NonFinite`] when `rotor` or `omega` is not finite; [`MotionFault::MasslessGyrostat`] for a tensor with a
    /// moment that is zero; [`MotionFault::LostInClosedForm`] where I ω is far below h, or the moments are orders apart.
    pub fn of(
        principal: &RefinedPrincipal,
        rotor: &Vector,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Self, Error> {
        let rounded = Vector3::from(rotor.map(DoubleDouble::rounded));
        all_finite("momentum", &rounded)?;
        all_finite("omega", omega)?;
        let initial = State {
            attitude: *attitude,
            omega: *omega,
        };
        let (angular_momentum, kinetic_energy) = conserved_quantities(principal, rotor, &initial);
        if rounded == Vector3::zeros() {
            let motion = FreeMotion::from_refined(principal, omega, attitude)?;
            return Ok(Self::free(&motion, angular_momentum, kinetic_energy));
        }
        if principal.moments[0].high <= 0.0 {
            return Err(MotionFault::MasslessGyrostat {
                moment: principal.moments[0].high,
            }
            .into());
        }
        // Powers of two bring moments and rates near one.
        let inertia = exponent(principal.moments[2].high);
        let of_rotor = exponent(rounded.amax()) - inertia;
        let rate = if *omega == Vector3::zeros() {
            of_rotor
        } else {
            exponent(omega.amax()).max(of_rotor)
        };
        let moments = (principal.moments).map(|moment| moment.times_power_of_two(-inertia));
        let scaled_omega = omega.map(|x| times_power_of_two(x, -rate));
        let scaled_rotor = rotor.map(|x| x.times_power_of_two(-inertia - rate));
        let rotor_along = principal.along(&scaled_rotor);
        let rate_unit = times_power_of_two(1.0, rate);
        let found = CurveOfStart::of(
            principal,
            &moments,
            &scaled_omega,
            &scaled_rotor,
            &rotor_along,
        );
        let (mode, (propagator, secular)) = match found {
            None => (Mode::Steady, steady_propagator(&scaled_omega, attitude)),
            Some(solved) => {
                let given = GyrostatStart {
                    moments: &moments,
                    rotor: &rotor_along,
                    principal,
                    attitude,
                };
                let curve = solved.curve;
                let mode = if curve.gap.high > 0.0 {
                    Mode::Paired
                } else if curve.gap.high < 0.0 {
                    Mode::Single
                } else if curve.is_turned {
                    Mode::Separatrix
                } else {
                    Mode::Circular
                };
                (
                    mode,
                    moving_propagator(&given, &solved.start, &solved.spinor),
                )
            }
        };
        let Secular { period, precession } = secular;
        let motion = Self {
            mode,
            initial,
            rotor: *rotor,
            angular_momentum,
            kinetic_energy,
            period: period.times_power_of_two(-rate),
            mean_precession: precession.times_power_of_two(rate),
            way: MotionKind::Within(propagator.in_units_of(rate_unit)),
        };
        let off = (motion.at(0.0).omega - omega).amax() / omega.amax();
        if *omega != Vector3::zeros() && (off > TOO_FAR_OFF || off.is_nan()) {
            return Err(MotionFault::LostInClosedForm { off }.into());
        }
        Ok(motion)
    }

    fn free(motion: &FreeMotion, angular_momentum: Vector3<f64>, kinetic_energy: f64) -> Self {
        let mode = match motion.mode {
            free::Mode::Spherical | free::Mode::Steady => Mode::Steady,
            free::Mode::Symmetric if motion.invariants().is_steady() => Mode::Steady,
            free::Mode::Symmetric => Mode::Circular,
            free::Mode::Separatrix => Mode::Separatrix,
            free::Mode::LongAxis | free::Mode::ShortAxis => Mode::Paired,
        };
        Self {
            mode,
            initial: motion.initial,
            rotor: [DoubleDouble::default(); 3],
            angular_momentum,
            kinetic_energy,
            period: if mode == Mode::Steady {
                f64::NAN.into()
            } else {
                motion.secular.half_period.scaled(2.0)
            },
            mean_precession: motion.secular.mean_precession,
            way: MotionKind::Free(*motion),
        }
    }

    /// The motion by the formulas of free motion, where there is no momentum inside.
    #[must_use]
    pub fn as_free(&self) -> Option<&FreeMotion> {
        match &self.way {
            MotionKind::Free(motion) => Some(motion),
            MotionKind::Within(_) => None,
        }
    }

    /// The angular momentum at t = 0, components in B.
    #[must_use]
    pub fn angular_momentum_in_body(&self) -> Vector3<f64> {
        (self.initial.attitude).inverse_transform_vector(&self.angular_momentum)
    }

    /// Attitude and ω at the time t; NaN for a t that is not finite, or beyond [`ClosedForm::reach`].
    ///
    /// The attitude is continuous in t as a quaternion, not only as a rotation.
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        let propagator = match &self.way {
            MotionKind::Free(motion) => return motion.at(t),
            MotionKind::Within(propagator) => propagator,
        };
        closed_form::at(propagator, t)
    }

    /// The states at many times on the calling thread, quaternions as (x, y, z, w): the bits of [`Self::at`].
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        let propagator = match &self.way {
            MotionKind::Free(motion) => return motion.sample(times, attitudes, omegas),
            MotionKind::Within(propagator) => propagator,
        };
        closed_form::sample(propagator, times, attitudes, omegas);
    }
}

impl ClosedForm for GyrostatMotion {
    fn reach(&self) -> f64 {
        match &self.way {
            MotionKind::Free(motion) => motion.reach(),
            MotionKind::Within(propagator) => propagator.reach,
        }
    }

    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        Self::sample(self, times, attitudes, omegas);
    }
}

/// `I ω + h` in space, and `½ ω·I ω`.
fn conserved_quantities(
    principal: &RefinedPrincipal,
    rotor: &Vector,
    start: &State,
) -> (Vector3<f64>, f64) {
    let along = principal.components(&start.omega);
    let parts: Vector = std::array::from_fn(|k| principal.moments[k] * along[k]);
    let of_body = principal.in_body(&parts);
    let momentum = Vector3::from_fn(|i, _| (rotor[i] + of_body[i]).rounded());
    (start.attitude * momentum, 0.5 * dot(&parts, &along).high)
}

/// A start with its curve and its spinor.
struct CurveOfStart {
    start: Start,
    curve: Curve,
    spinor: Spinor,
}

impl CurveOfStart {
    /// Of moments, ω (in B) and h (in B and along the principal axes) near one; `None` for a steady spin.
    fn of(
        principal: &RefinedPrincipal,
        moments: &Vector,
        omega: &Vector3<f64>,
        rotor: &Vector,
        rotor_along: &Vector,
    ) -> Option<Self> {
        let start = Start::of(moments, &principal.components(omega), rotor_along)?;
        let (quartic, pencil) = (start.quartic(), Pencil::of(&start));
        let mut invariants = pencil.invariants();
        let apart = apart(&invariants);
        let is_degenerate = is_degenerate(moments, rotor_along);
        if is_degenerate {
            invariants.discriminant = DoubleDouble::default();
        } else if !invariants.is_cusp
            && invariants.discriminant.high.abs() < LOST * invariants.terms
        {
            let unit = moments[2].high / principal.moments[2].high;
            let y = pencil.meeting_point(apart.high);
            let left = value_near_separatrix(principal, unit, omega, rotor, &start, y);
            invariants.discriminant = pencil.discriminant_of(y, left);
        }
        let (curve, spinor) = if invariants.is_cusp && !is_degenerate {
            (Curve::cusp(), Spinor::cusp(&quartic, start.across))
        } else {
            let curve = Curve::of(&invariants, apart);
            (curve, Spinor::of(&quartic, &curve, start.across))
        };
        Some(Self {
            start,
            curve,
            spinor,
        })
    }
}

/// Whether two roots are equal whatever the start: equal moments, or a symmetric body with h along its axis.
fn is_degenerate(moments: &Vector, rotor: &Vector) -> bool {
    let [i1, i2, i3] = *moments;
    let [h1, h2, h3] = rotor.map(DoubleDouble::rounded);
    i1 == i3 || (i1 == i2 && h1 == 0.0 && h2 == 0.0) || (i2 == i3 && h2 == 0.0 && h3 == 0.0)
}
