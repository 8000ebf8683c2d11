//! Free motion, exact at any time: Euler's problem by theta functions.
//!
//! With L along the third axis of the frame M at rest, and in the body the axes P = (x, y, z), z the principal axis that L
//! circles, the attitude is `q_MP = (Im β, −Re β, Im α, Re α)`, where the Cayley–Klein parameters
//! `α = √(½(1 + L_z/L)) e^{i(μ−χ)/2}` and `β = √(½(1 − L_z/L)) e^{i(μ+χ)/2}` (μ the angle of precession, χ that of L about
//! z, seen from P) are each one theta function of u = λt + u₀ times a steadily turning phase. A state costs the same at any
//! t. Only two constants multiply t, the rate of that phase and 1/4K of the period; they are known to twice the
//! precision, and whole turns are taken off exactly.
//!
//! | file | idea |
//! |---|---|
//! | `mode.rs` | the six ways to move |
//! | `refined.rs`, `finest.rs` | principal moments and ω to twice the precision, and to four times |
//! | `separation.rs` | the difference `L² − 2T I₂`, on which all depends near the separatrix |
//! | `tumbling.rs` | long- and short-axis mode and the separatrix: from a start to the constants of the theta functions |
//! | `circling.rs` | steady spin and the symmetric body: the limits in which they are sines |
//! | `propagator.rs` | from the constants to the states, in lanes |
//! | `invariants.rs` | what a motion keeps: energy, momentum, modulus, amplitudes |
//! | `periods.rs`, `from_periods.rs` | periods and mean precession; the motion that has two given periods |
//! | `polhode.rs`, `nutation.rs`, `poinsot.rs` | the curve of ω in the body, cones, the rolling ellipsoid |
//! | `sensitivity` on `clock.rs`, `conditioning.rs` | derivatives by initial state and moments; error bars |

mod circling;
mod clock;
mod conditioning;
pub mod finest;
mod from_periods;
mod invariants;
pub mod mode;
mod nutation;
mod periods;
mod poinsot;
mod polhode;
mod propagator;
pub mod refined;
mod sensitivity;
mod separation;
mod tumbling;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::error::{Error, all_finite};
use crate::mass::RigidBody;
use crate::motion::state::{ClosedForm, State};
use crate::numerics::dispatch::dispatch;
use crate::numerics::double_double::DoubleDouble;
pub use conditioning::ErrorBar;
pub use from_periods::{Circled, FromPeriods, attitude_about};
pub use invariants::Invariants;
pub use mode::Mode;
pub use nutation::Cones;
pub use periods::Periods;
pub use poinsot::Poinsot;
use propagator::{At, Propagator, Sample};
pub use refined::{RefinedPrincipal, Vector};
pub use sensitivity::Sensitivity;
use separation::Separation;
use tumbling::Tumbling;

/// The motion of a body on which no torque acts about its centre of mass, from its state at t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "Euler top")]
pub struct FreeMotion {
    /// How the body moves.
    pub mode: Mode,
    /// The state at t = 0.
    pub initial: State,
    /// Principal moments, ascending, to twice the precision.
    pub moments: [DoubleDouble; 3],
    /// The principal axes as columns, components in B.
    pub axes: Matrix3<f64>,
    /// ω at t = 0 along the principal axes.
    pub principal_omega: [DoubleDouble; 3],
    /// The constants of the theta functions.
    pub secular: Secular,
    separation: Separation,
    propagator: Propagator,
}

/// What grows with time, and the modulus; in units of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Secular {
    /// The time after which ω has the opposite signs across the axis circled: half of the period 4K/λ of ω in the body.
    /// Infinite where ω circles nothing.
    pub half_period: DoubleDouble,
    /// Mean rate in radians at which the body precesses about L, `μ̇` over a period; of a spin |ω|.
    pub mean_precession: DoubleDouble,
    /// The modulus k of Jacobi's functions.
    pub modulus: f64,
    /// `k′ = √(1 − k²)`, with all its digits near the separatrix.
    pub complementary_modulus: f64,
}

impl FreeMotion {
    /// From ω (of B relative to N, components in B) and attitude at t = 0, about the centre of mass.
    ///
    /// # Errors
    /// [`Error::NonFinite`] when `omega` is not finite.
    pub fn of(
        body: &RigidBody,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Self, Error> {
        Self::refined(&RefinedPrincipal::of(body), omega, attitude)
    }

    /// As [`Self::of`], for principal moments and axes already refined: many states of one body.
    ///
    /// # Errors
    /// [`Error::NonFinite`] when `omega` is not finite.
    pub fn refined(
        principal: &RefinedPrincipal,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Self, Error> {
        all_finite("omega", omega)?;
        let initial = State {
            attitude: *attitude,
            omega: *omega,
        };
        let axes = principal.rounded_axes();
        // Products of ratios alone: powers of two bring the largest moment and rate near one.
        let inertia_unit = power_of_two(principal.moments[2].high);
        let rate_unit = power_of_two(omega.amax());
        let moments = (principal.moments).map(|moment| moment.scaled(1.0 / inertia_unit));
        let scaled_omega = omega / rate_unit;
        let mut w = principal.components(&scaled_omega);
        let mut separation = Separation::of(&moments, &w);

        let [i1, i2, i3] = moments;
        let is_steady = |w: &Vector| w.iter().filter(|rate| rate.high == 0.0).count() >= 2;
        let (mode, (propagator, secular)) = if i1 == i3 {
            (Mode::Spherical, circling::spin(&scaled_omega, attitude))
        } else if i1 == i2 || i2 == i3 || i1.high == 0.0 {
            let motion = circling::symmetric(&moments, &w, &axes, attitude);
            (Mode::Symmetric, motion)
        } else {
            (separation, w) = separation.kept(principal, &scaled_omega, &moments, &w);
            if is_steady(&w) {
                (Mode::Steady, circling::spin(&scaled_omega, attitude))
            } else {
                let tumbling = Tumbling::of(&moments, &w, &separation);
                (tumbling.mode, tumbling.motion(&axes, attitude))
            }
        };
        Ok(Self {
            mode,
            initial,
            moments: principal.moments,
            axes,
            principal_omega: w.map(|rate| rate.scaled(rate_unit)),
            secular: secular.in_units_of(rate_unit),
            separation: separation.in_units_of(rate_unit),
            propagator: propagator.in_units_of(rate_unit),
        })
    }

    /// Attitude and ω at the time t; NaN for a t that is not finite, or beyond [`Self::reach`].
    ///
    /// The attitude is continuous in t as a quaternion, not only as a rotation.
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        let [x, y, z, w, p, q, r] = dispatch(At {
            propagator: &self.propagator,
            time: t,
        });
        State {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
            omega: Vector3::new(p, q, r),
        }
    }

    /// The states at many times on the calling thread, quaternions as (x, y, z, w): the bits of [`Self::at`].
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        assert_eq!(times.len(), attitudes.len(), "an attitude for each time");
        assert_eq!(
            times.len(),
            omegas.len(),
            "an angular velocity for each time"
        );
        if times.len() < FEW {
            for ((&time, attitude), omega) in times.iter().zip(attitudes).zip(omegas) {
                let propagator = &self.propagator;
                let [x, y, z, w, p, q, r] = dispatch(At { propagator, time });
                *attitude = [x, y, z, w];
                *omega = [p, q, r];
            }
            return;
        }
        dispatch(Sample {
            propagator: &self.propagator,
            times,
            attitudes,
            omegas,
        });
    }
}

impl ClosedForm for FreeMotion {
    fn reach(&self) -> f64 {
        self.propagator.reach
    }

    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        Self::sample(self, times, attitudes, omegas);
    }
}

/// Fewer times than this are done one by one.
const FEW: usize = 8;

impl Secular {
    fn in_units_of(self, rate_unit: f64) -> Self {
        Self {
            half_period: self.half_period.scaled(1.0 / rate_unit),
            mean_precession: self.mean_precession.scaled(rate_unit),
            ..self
        }
    }
}

/// The power of two at or below a positive number; one for zero.
fn power_of_two(x: f64) -> f64 {
    use crate::numerics::lane::{Double, Lane};
    if x == 0.0 {
        return 1.0;
    }
    Double::<false>::new(x).power_of_two_scale().1.get()
}

#[cfg(test)]
mod tests;
