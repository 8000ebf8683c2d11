//! A body that moves freely (drift) and gets changes of momentum by a load (kicks).

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::scheme::Scheme;
use crate::error::Error;
use crate::mass::refined::RefinedPrincipal;
use crate::motion::attitude::{from_axes, normalize};
use crate::motion::euler_equations::EulerEquations;
use crate::motion::free::FreeMotion;
use crate::motion::loads::Load;
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;

/// The angle up to which the series converges fast, in radians.
const REACH: f64 = 0.2;
/// Beyond this number of such angles the closed form takes less time.
const PARTS: f64 = 2.0;
/// Terms of the series: the next one is below 2⁻⁶⁰ for all bodies, because |κ| ≤ 1.
const TERMS: usize = 26;
/// The largest error of the series, relative to one.
const REST: f64 = 4e-19;

/// A sum of vectors with its rounding error.
#[derive(Clone, Copy, Debug)]
struct Sum {
    value: Vector3<f64>,
    rest: Vector3<f64>,
}

impl Sum {
    fn of(value: Vector3<f64>) -> Self {
        Self {
            value,
            rest: Vector3::zeros(),
        }
    }

    fn add(&mut self, increment: &Vector3<f64>) {
        for i in 0..3 {
            (self.value[i], self.rest[i]) = two_sum(self.value[i], increment[i] + self.rest[i]);
        }
    }
}

/// A point of phase space, in variables that a free motion conserves: L and the velocity change in kicks only.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// `q_NP`, P the principal axes.
    attitude: UnitQuaternion<f64>,
    /// L about the reference point, in N.
    momentum: Sum,
    position: Sum,
    velocity: Sum,
}

/// A body with two equal moments: it precesses about L at `L/I_t` and spins about its axis at `(1/I_s − 1/I_t) L_s`.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    axis: usize,
    transverse: f64,
    /// `1/I_s − 1/I_t`; zero for a body without axial moment, whose spin is `spin`.
    slip: f64,
    /// ω along an axis without a moment.
    spin: f64,
}

impl Symmetry {
    fn of(moments: &[f64; 3], massless: &Vector3<f64>) -> Option<Self> {
        let &[i1, i2, i3] = moments;
        let (axis, axial, transverse) = if i1 == i2 {
            (2, i3, i1)
        } else if i2 == i3 {
            (0, i1, i2)
        } else {
            return None;
        };
        let slip = if axial == 0.0 {
            0.0
        } else {
            (transverse - axial) / axial / transverse
        };
        (transverse > 0.0).then_some(Self {
            axis,
            transverse,
            slip,
            spin: massless[axis],
        })
    }

    fn attitude_of_top(&self, point: &Point, time: f64) -> UnitQuaternion<f64> {
        let momentum = point.momentum.value;
        let along = point.attitude.inverse_transform_vector(&momentum)[self.axis];
        let mut spin = Vector3::zeros();
        spin[self.axis] = (self.slip * along + self.spin) * time;
        UnitQuaternion::from_scaled_axis(momentum * (time / self.transverse))
            * point.attitude
            * UnitQuaternion::from_scaled_axis(spin)
    }
}

/// The body for drifts and kicks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    /// The mass of a body that can move; none for a body with a fixed point.
    mass: Option<f64>,
    euler: EulerEquations,
    pub(super) moments: [f64; 3],
    principal: RefinedPrincipal,
    pub(super) q_bp: UnitQuaternion<f64>,
    /// ω along axes without a moment, in P: it is constant.
    massless: Vector3<f64>,
    symmetry: Option<Symmetry>,
    /// `(I₂ − I₃)/I₁` and cyclic, for a body that is not symmetric.
    kappa: [f64; 3],
}

impl Body {
    pub(super) fn of(euler: &EulerEquations, mass: Option<f64>, phase: &Phase) -> Self {
        let moments = euler.moments();
        let along = euler.axes().tr_mul(&phase.omega);
        let massless = Vector3::from_fn(|i, _| if moments[i] == 0.0 { along[i] } else { 0.0 });
        Self {
            mass,
            euler: *euler,
            moments,
            principal: RefinedPrincipal::from_principal(&moments, &Matrix3::identity()),
            q_bp: from_axes(euler.axes()),
            massless,
            symmetry: Symmetry::of(&moments, &massless),
            kappa: [0, 1, 2].map(|i| {
                // ω of a point is constant.
                if moments[i] == 0.0 {
                    0.0
                } else {
                    euler.differences()[i] / moments[i]
                }
            }),
        }
    }

    pub(super) fn point(&self, phase: &Phase) -> Point {
        let attitude = phase.attitude * self.q_bp;
        let along = self.q_bp.inverse_transform_vector(&phase.omega);
        let momentum = along.component_mul(&Vector3::from(self.moments));
        Point {
            attitude,
            momentum: Sum::of(attitude * momentum),
            position: Sum::of(phase.position),
            velocity: Sum::of(phase.velocity),
        }
    }

    /// Compute ω in P.
    pub(super) fn omega(&self, point: &Point) -> Vector3<f64> {
        let along = point
            .attitude
            .inverse_transform_vector(&point.momentum.value);
        Vector3::from_fn(|i, _| {
            if self.moments[i] == 0.0 {
                self.massless[i]
            } else {
                along[i] / self.moments[i]
            }
        })
    }

    /// Compute |ω|.
    pub(super) fn speed(&self, point: &Point) -> f64 {
        self.omega(point).norm()
    }

    pub(super) fn phase(&self, point: &Point) -> Phase {
        Phase {
            attitude: point.attitude * self.q_bp.conjugate(),
            omega: self.q_bp * self.omega(point),
            position: point.position.value,
            velocity: point.velocity.value,
            internal_state: Box::default(),
        }
    }

    fn drift(&self, point: &mut Point, time: f64) -> Result<(), Error> {
        let attitude = if let Some(top) = self.symmetry {
            top.attitude_of_top(point, time)
        } else {
            let omega = self.omega(point);
            let q = point.attitude.into_inner();
            if let Some([x, y, z, w]) = short_turn(&self.kappa, &(omega * time)) {
                UnitQuaternion::new_unchecked(q + q * Quaternion::new(w, x, y, z))
            } else {
                let motion = FreeMotion::from_refined(&self.principal, &omega, &point.attitude)?;
                motion.at(time).attitude
            }
        };
        point.attitude = normalize(&attitude);
        point.position.add(&(point.velocity.value * time));
        Ok(())
    }

    fn kick<L: Load>(
        &self,
        point: &mut Point,
        load: &mut L,
        at: f64,
        time: f64,
    ) -> Result<(), L::Error> {
        let phase = self.phase(point);
        let wrench = load.wrench(at, &phase)?;
        let along = self.q_bp.inverse_transform_vector(&wrench.torque);
        if self.moments[0] == 0.0 {
            // An error if the torque acts along an axis without a moment.
            (self.euler).principal_acceleration(&Vector3::zeros(), &along)?;
        }
        point.momentum.add(&(phase.attitude * wrench.torque * time));
        if let Some(mass) = self.mass {
            point.velocity.add(&(wrench.force * (time / mass)));
        }
        Ok(())
    }

    pub(super) fn step<L: Load>(
        &self,
        scheme: Scheme,
        point: &mut Point,
        load: &mut L,
        start: f64,
        h: f64,
    ) -> Result<(), L::Error> {
        let mut elapsed = 0.0;
        for i in 0..scheme.kicks() {
            let drift = scheme.drift(i) * h;
            self.drift(point, drift)?;
            elapsed += drift;
            self.kick(point, load, start + elapsed, scheme.kick(i) * h)?;
        }
        Ok(self.drift(point, scheme.drift(scheme.kicks()) * h)?)
    }

    /// Compute the distance of two points: half the angle between the attitudes, or the relative difference of ω, whichever is larger.
    pub(super) fn difference(&self, a: &Point, b: &Point) -> f64 {
        let (one, other) = (self.omega(a), self.omega(b));
        let most = one.norm().max(other.norm());
        let spin = if most == 0.0 {
            0.0
        } else {
            (one - other).norm() / most
        };
        let apart = a.attitude.conjugate() * b.attitude;
        spin.max(apart.imag().norm())
    }
}

/// Compute the gain of the quaternion (x, y, z, w) of the attitude in a free motion of an asymmetric body over a short time, by power
/// series: `q → q + q∘gain`. In the closed form most time goes into the constants of the motion, which change with every kick.
///
/// `w`: ω times the time, components in principal axes; `kappa`: `(I₂ − I₃)/I₁` and cyclic. With coefficients that carry the
/// time,
///
/// ```text
/// (k+1) w₁,ₖ₊₁ = κ₁ Σ w₂,ⱼ w₃,ₖ₋ⱼ,   (k+1) qₖ₊₁ = ½ Σ qⱼ∘wₖ₋ⱼ
/// ```
///
/// `None` if the body turns too far.
fn short_turn(kappa: &[f64; 3], w: &Vector3<f64>) -> Option<[f64; 4]> {
    let parts = (w.norm() / REACH).ceil().max(1.0);
    if parts.is_nan() || parts > PARTS {
        return None;
    }
    let (gain, later) = part(kappa, &(w / parts));
    if parts == 1.0 {
        return Some(gain);
    }
    // (1 + a)∘(1 + b) = 1 + a + b + a∘b.
    let (next, _) = part(kappa, &later);
    let both = product(&gain, &next);
    Some([0, 1, 2, 3].map(|i| gain[i] + (next[i] + both[i])))
}

/// Compute the gain, and w at the end.
fn part(kappa: &[f64; 3], w: &Vector3<f64>) -> ([f64; 4], Vector3<f64>) {
    let mut ws = [[0.0; 4]; TERMS];
    let mut qs = [[0.0; 4]; TERMS];
    ws[0] = [w.x, w.y, w.z, 0.0];
    qs[0] = [0.0, 0.0, 0.0, 1.0];
    let mut count = 1;
    let mut last = f64::INFINITY;
    while count < TERMS {
        let (mut bent, mut turned) = ([0.0; 3], [0.0; 4]);
        for j in 0..count {
            let (a, b) = (&ws[j], &ws[count - 1 - j]);
            for (i, sum) in bent.iter_mut().enumerate() {
                *sum += a[(i + 1) % 3] * b[(i + 2) % 3];
            }
            let more = product(&qs[j], b);
            for (sum, more) in turned.iter_mut().zip(more) {
                *sum += more;
            }
        }
        let over = 1.0 / count as f64;
        for i in 0..3 {
            ws[count][i] = kappa[i] * bent[i] * over;
        }
        qs[count] = turned.map(|x| 0.5 * x * over);
        let size: f64 = (ws[count].iter().chain(&qs[count])).map(|x| x.abs()).sum();
        count += 1;
        if size + last < REST {
            break;
        }
        last = size;
    }
    // Small terms first.
    let (mut gain, mut later) = ([0.0; 4], [0.0; 4]);
    for k in (0..count).rev() {
        for i in 0..4 {
            later[i] += ws[k][i];
            gain[i] += if k == 0 { 0.0 } else { qs[k][i] };
        }
    }
    (gain, Vector3::new(later[0], later[1], later[2]))
}

/// Compute the product of two quaternions (x, y, z, w).
fn product(p: &[f64; 4], q: &[f64; 4]) -> [f64; 4] {
    let [a, b, c, d] = *p;
    let [x, y, z, w] = *q;
    [
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

    use super::*;
    use crate::mass::refined::RefinedPrincipal;
    use crate::motion::free::FreeMotion;

    #[test]
    fn as_the_closed_form() {
        let direction = |n: u32| {
            let x = f64::from(n);
            Vector3::new(x.sin(), (1.7 * x).cos(), (2.3 * x + 1.0).sin()).normalize()
        };
        for moments in [
            [1.0, 2.0, 2.5],
            [1e-6, 1.0, 1.000_000_9],
            [1.0, 2.0, 3.0],
            [1.0, 1.001, 1.002],
        ] {
            let [i1, i2, i3] = moments;
            let kappa = [(i2 - i3) / i1, (i3 - i1) / i2, (i1 - i2) / i3];
            let principal = RefinedPrincipal::from_principal(&moments, &Matrix3::identity());
            for n in 1..200 {
                let w = direction(n) * (f64::from(n) * 0.002);
                let [x, y, z, u] = short_turn(&kappa, &w).expect("near");
                let motion = FreeMotion::from_refined(&principal, &w, &UnitQuaternion::identity());
                let exact = motion.expect("finite").at(1.0).attitude;
                let found = Quaternion::new(1.0 + u, x, y, z);
                let error = (found - exact.into_inner()).norm();
                assert!(error < 6e-16, "{moments:?} {n} {error:e}");
            }
            assert_eq!(short_turn(&kappa, &direction(1)), None);
        }
    }
}
