//! The free motion that has two given periods, as light curves of tumbling asteroids give them.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::Mode;
use super::invariants::Invariants;
use crate::error::{Error, MotionFault, all_finite};
use crate::motion::attitude::{from_axes, shortest_turn};
use crate::numerics::elliptic::complete_first;
use crate::numerics::jacobi::jacobi;

/// The axis that ω circles in the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CircledAxis {
    /// Axis 1, of the least moment: long-axis mode.
    Long,
    /// Axis 3, of the greatest moment: short-axis mode.
    Short,
}

impl CircledAxis {
    fn mode(self) -> &'static str {
        match self {
            Self::Long => Mode::LongAxis,
            Self::Short => Mode::ShortAxis,
        }
        .as_str()
    }
}

/// What two periods say of a free motion.
///
/// # Examples
///
/// ```
/// use polhode::RigidBody;
/// use polhode::motion::free::{CircledAxis, FreeMotion, FromPeriods, attitude_about};
/// use polhode::nalgebra::{Matrix3, Vector3};
///
/// // The asteroid Toutatis (Hudson and Ostro 1995; moments of Ostro et al. 1999): it rotates about its long axis in 5.41 days, which precesses in 7.35.
/// let moments = [1.0, 3.09, 3.22];
/// let given = FromPeriods { rotation: 5.41, precession: 7.35, circled: CircledAxis::Long, sense: 1.0, phase: 0.0 };
/// let omega = given.omega(&moments)?;
/// let axes = Matrix3::identity();
/// let attitude = attitude_about(&moments, &axes, &omega, &Vector3::new(0.1, 0.0, -1.0))?; // L in space
/// let body = RigidBody::from_principal(1.0, &moments, &axes, &Vector3::zeros(), 0.0)?;
/// let motion = FreeMotion::of(&body, &omega, &attitude)?;
/// assert!((motion.periods().rotation - 5.41).abs() < 1e-9);
/// assert!((motion.periods().precession - 7.35).abs() < 1e-9);
/// assert!(motion.normal().z < -0.99);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FromPeriods {
    /// `P_ψ`: ω and L return in the body.
    pub rotation: f64,
    /// `P_φ`: mean period of axis 1 about L.
    pub precession: f64,
    /// Which axis is circled.
    pub circled: CircledAxis,
    /// The side of that axis on which ω is: +1 or −1.
    pub sense: f64,
    /// Time zero as a fraction of `P_ψ` after ω crossed the plane of axes 1 and 3, on the positive side of the
    /// axis that is not circled.
    pub phase: f64,
}

/// Closer to the separatrix than this complement of the modulus squared (2⁻²³), the last bit of ω changes the periods by more
/// than a part in 10⁹: `δP/P = δ(k′²)/(2 k′² ln(4/k′))`, with `δ(k′²)` of some roundings.
const NEAREST: f64 = 1.0 / 8_388_608.0;

/// The cosine of the steepest tilt of a symmetric body: ω across its axis is known as well as ω along it.
const STEEPEST: f64 = f64::EPSILON;

impl FromPeriods {
    /// ω at time zero, components in principal axes, for a body with these ascending moments.
    ///
    /// `P_ψ/P_φ` grows along each mode from a least value, in the limit of a steady spin about the circled axis
    /// (`1/√(α₁α₂)` about axis 3, `1/√(α₂α₃) − 1` about axis 1), to infinity at the separatrix: one motion at most has a
    /// given ratio.
    ///
    /// # Errors
    /// Periods that are not positive and finite, moments that have no such mode, a ratio out of reach, which is named with
    /// the range.
    pub fn omega(&self, moments: &[f64; 3]) -> Result<Vector3<f64>, Error> {
        let &Self {
            rotation,
            precession,
            ..
        } = self;
        for (what, value) in [
            ("rotation_period", rotation),
            ("precession_period", precession),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                let law = "positive and finite";
                return Err(Error::OutOfDomain { what, law, value });
            }
        }
        all_finite("phase", &[self.phase])?;
        if self.sense.abs() != 1.0 {
            return Err(Error::OutOfDomain {
                what: "sense",
                law: "+1 or -1",
                value: self.sense,
            });
        }
        let family = Family::of(moments, self.circled)?;
        let ratio = rotation / precession;
        let motion = family.with_ratio(ratio)?;
        let [own, _] = motion.long_axis_periods();
        let start = at_phase(&motion, self.phase, self.sense);
        Ok(start * (own / rotation))
    }
}

/// The attitude at which L, for a body with this ω, has the given direction in space, and axis 1 the Euler angle φ = 0 about
/// it.
///
/// φ is counted from the direction into which the shortest turn from z to that of L takes x (x itself where L points along
/// −z). With axis 1 along L, axis 2 has φ = 0 in place of it.
///
/// # Errors
/// For a direction that is none.
pub fn attitude_about(
    moments: &[f64; 3],
    axes: &Matrix3<f64>,
    omega: &Vector3<f64>,
    direction: &Vector3<f64>,
) -> Result<UnitQuaternion<f64>, Error> {
    all_finite("angular_momentum_direction", direction)?;
    let what = "the length of angular_momentum_direction";
    let size = direction.amax();
    if size == 0.0 {
        let law = "positive";
        return Err(Error::OutOfDomain {
            what,
            law,
            value: size,
        });
    }
    let up = (direction / size).normalize();
    let turn = shortest_turn(&Vector3::z(), &up).unwrap_or_else(|| {
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0))
    });
    let node = turn * Vector3::x();
    let scale = moments[2] * omega.amax();
    let momentum = omega.component_mul(&Vector3::from(*moments)) / scale;
    let along = momentum.normalize();
    let across = along.cross(&Vector3::x());
    let line = if across == Vector3::zeros() {
        along.cross(&Vector3::y())
    } else {
        across
    };
    let line = line.normalize();
    let space = Matrix3::from_columns(&[node, up.cross(&node), up]);
    let body = Matrix3::from_columns(&[line, along.cross(&line), along]);
    Ok(from_axes(&(space * body.transpose() * axes.transpose())))
}

/// All motions of a body in one mode, up to their rate.
struct Family {
    moments: [f64; 3],
    circled: CircledAxis,
    /// `(I₂ − I₁)/(I₃ − I₂)`, or its inverse where axis 1 is circled: zero for a body that is symmetric about the axis.
    flatness: f64,
}

impl Family {
    fn of(moments: &[f64; 3], circled: CircledAxis) -> Result<Self, Error> {
        let &[i1, i2, i3] = moments;
        let (lower, upper) = (i2 - i1, i3 - i2);
        let (own, other) = match circled {
            CircledAxis::Long => (lower, upper),
            CircledAxis::Short => (upper, lower),
        };
        if own <= 0.0 || i1 == 0.0 {
            return Err(MotionFault::NoSuchMode {
                mode: circled.mode(),
                moments: *moments,
            }
            .into());
        }
        Ok(Self {
            moments: *moments,
            circled,
            flatness: other / own,
        })
    }

    /// The motion with `(2T I₃ − L²)/(L² − 2T I₁) = 1/(flatness + 1/s)`, or its inverse where axis 1 is circled: `s` from 0,
    /// the steady spin, to infinity, the separatrix. It starts where ω crosses the plane of axes 1 and 3; its scale is of
    /// no matter.
    fn motion(&self, s: f64) -> Invariants {
        let [i1, _, i3] = self.moments.map(|moment| moment / self.moments[2]);
        let (own, other) = match self.circled {
            CircledAxis::Long => (i1, i3),
            CircledAxis::Short => (i3, i1),
        };
        let share = s / (1.0 + self.flatness * s);
        let (circled, crossed) = ((1.0 / own).sqrt(), (share / other).sqrt());
        let omega = match self.circled {
            CircledAxis::Long => Vector3::new(circled, 0.0, crossed),
            CircledAxis::Short => Vector3::new(crossed, 0.0, circled),
        };
        Invariants::of(&self.moments, &omega)
    }

    fn ratio(&self, s: f64) -> f64 {
        let [rotation, precession] = self.motion(s).long_axis_periods();
        rotation / precession
    }

    /// The motion whose ratio of periods is given, by bisection of ln s: all digits that the ratio determines.
    fn with_ratio(&self, ratio: f64) -> Result<Invariants, Error> {
        // k² = flatness·s/(1 + flatness·s); symmetric about the axis, all tilts up to a right angle.
        let farthest = if self.flatness > 0.0 {
            1.0 / (self.flatness * NEAREST)
        } else {
            1.0 / (STEEPEST * STEEPEST)
        };
        let (least, most) = (self.ratio(0.0), self.ratio(farthest));
        if !(ratio >= least && ratio <= most) {
            return Err(MotionFault::UnreachablePeriods {
                mode: self.circled.mode(),
                ratio,
                least,
                most,
                moments: self.moments,
            }
            .into());
        }
        let (mut low, mut high) = (f64::MIN_POSITIVE.ln(), farthest.ln());
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return Ok(self.motion(middle.exp()));
            }
            if self.ratio(middle.exp()) < ratio {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
}

/// ω of a motion at a fraction of its period.
fn at_phase(motion: &Invariants, phase: f64, sense: f64) -> Vector3<f64> {
    let k_prime = motion.complementary_modulus();
    // The nearest half period, and what is left of it.
    let halves = (2.0 * phase).round();
    let rest = 4.0 * (phase - 0.5 * halves) * complete_first(k_prime);
    let (sn, cn, _) = jacobi(rest, k_prime);
    let sign = if halves % 2.0 == 0.0 { 1.0 } else { -1.0 };
    let mut omega = motion.on_polhode((sign * sn, sign * cn), sense);
    omega.y *= sense;
    omega * motion.rate_unit
}
