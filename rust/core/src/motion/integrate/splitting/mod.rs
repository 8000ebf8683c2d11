//! Splitting: kicks by the load between exact free motions, at equal steps.
//!
//! The energy of the free motion and that of position are each followed exactly, one at a time; a composition that reads
//! the same backward keeps the total energy near its start for as long as the motion lasts, where other methods drift
//! (Hairer, Lubich & Wanner, Geometric Numerical Integration, §V.1, §IX; `McLachlan` and Quispel, Acta Numerica 11 (2002) 341).

pub mod scheme;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

pub use self::scheme::Scheme;
use crate::error::Error;
use crate::motion::attitude::from_axes;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::free::{FreeMotion, RefinedPrincipal};
use crate::motion::loads::Load;
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;

/// Steps that are tried to find out how long a step may be.
const TRIALS: usize = 6;
/// Rounds of that search.
const ROUNDS: usize = 5;
/// Of the length of step at which a trial just meets the tolerance.
const SAFETY: f64 = 0.9;

/// A vector with what rounding has left out of its sum.
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

/// A point of phase space by what a free motion keeps: L and the velocity change in kicks only.
#[derive(Clone, Copy, Debug)]
struct Point {
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
    /// `1/I_s − 1/I_t`; zero for a body without axial moment, whose spin is kept beside.
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

    fn turned(&self, point: &Point, time: f64) -> UnitQuaternion<f64> {
        let momentum = point.momentum.value;
        let along = point.attitude.inverse_transform_vector(&momentum)[self.axis];
        let mut spin = Vector3::zeros();
        spin[self.axis] = (self.slip * along + self.spin) * time;
        UnitQuaternion::from_scaled_axis(momentum * (time / self.transverse))
            * point.attitude
            * UnitQuaternion::from_scaled_axis(spin)
    }
}

/// The body as it drifts and is kicked.
#[derive(Clone, Copy, Debug)]
struct Body {
    /// Of a body that moves about.
    mass: Option<f64>,
    euler: EulerEquations,
    moments: [f64; 3],
    principal: RefinedPrincipal,
    q_bp: UnitQuaternion<f64>,
    /// ω along axes without a moment, in P: it stays as it is.
    massless: Vector3<f64>,
    symmetry: Option<Symmetry>,
}

impl Body {
    fn of(euler: &EulerEquations, mass: Option<f64>, phase: &Phase) -> Self {
        let moments = euler.moments();
        let along = euler.axes().tr_mul(&phase.omega);
        let massless = Vector3::from_fn(|i, _| if moments[i] == 0.0 { along[i] } else { 0.0 });
        Self {
            mass,
            euler: *euler,
            moments,
            principal: RefinedPrincipal::given(&moments, &Matrix3::identity()),
            q_bp: from_axes(euler.axes()),
            massless,
            symmetry: Symmetry::of(&moments, &massless),
        }
    }

    fn point(&self, phase: &Phase) -> Point {
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

    /// ω in P.
    fn omega(&self, point: &Point) -> Vector3<f64> {
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

    fn phase(&self, point: &Point) -> Phase {
        Phase {
            attitude: point.attitude * self.q_bp.conjugate(),
            omega: self.q_bp * self.omega(point),
            position: point.position.value,
            velocity: point.velocity.value,
        }
    }

    fn drift(&self, point: &mut Point, time: f64) -> Result<(), Error> {
        let mut attitude = if let Some(top) = self.symmetry {
            top.turned(point, time)
        } else {
            let omega = self.omega(point);
            let motion = FreeMotion::refined(&self.principal, &omega, &point.attitude)?;
            motion.at(time).attitude
        };
        attitude.renormalize();
        point.attitude = attitude;
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
            // Euler's equations say whether what has no moment can take the torque.
            (self.euler).principal_acceleration(&Vector3::zeros(), &along)?;
        }
        point.momentum.add(&(phase.attitude * wrench.torque * time));
        if let Some(mass) = self.mass {
            point.velocity.add(&(wrench.force * (time / mass)));
        }
        Ok(())
    }

    fn step<L: Load>(
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
}

/// An integration under way.
#[derive(Clone, Debug)]
pub struct Splitting {
    body: Body,
    scheme: Scheme,
    start: f64,
    span: f64,
    point: Point,
    /// Before the last step.
    before: Point,
    taken: u32,
    total: u32,
    /// Evaluations of the load.
    pub evaluations: u64,
}

impl Splitting {
    /// At `phase` at time `start`, on the way to `end` by equal steps of about `step`, or of the length that meets
    /// `tolerance` (of the attitude in radians, half, and of ω relative to the largest on the trial) with the scheme that
    /// takes fewest kicks.
    ///
    /// `euler`: of the body, about the reference point. `mass`: of a body that moves about; of none fixed at that point.
    ///
    /// # Errors
    /// What the load refuses; a torque along an axis without a moment; more than 2³² steps.
    pub fn new<L: Load>(
        euler: &EulerEquations,
        mass: Option<f64>,
        [start, end]: [f64; 2],
        phase: &Phase,
        load: &mut L,
        tolerance: f64,
        step: Option<(Scheme, f64)>,
    ) -> Result<Self, L::Error> {
        let body = Body::of(euler, mass, phase);
        let point = body.point(phase);
        let span = end - start;
        let mut evaluations = 0;
        let (scheme, step) = match step {
            Some(chosen) => chosen,
            None => cheapest(
                &body,
                &point,
                load,
                start,
                span,
                tolerance,
                &mut evaluations,
            )?,
        };
        let count = (span / step).abs().ceil().max(1.0);
        if count.is_nan() || count > f64::from(u32::MAX) {
            return Err(Error::StepTooSmall { time: start, step }.into());
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number in the range"
        )]
        let total = count as u32;
        Ok(Self {
            body,
            scheme,
            start,
            span,
            point,
            before: point,
            taken: 0,
            total,
            evaluations,
        })
    }

    /// The scheme and the length of a step.
    #[must_use]
    pub fn step(&self) -> (Scheme, f64) {
        (self.scheme, self.span / f64::from(self.total))
    }

    /// Accepted steps.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.taken.into()
    }

    /// Time since the start.
    #[must_use]
    pub fn elapsed(&self) -> f64 {
        self.time(self.taken)
    }

    fn time(&self, steps: u32) -> f64 {
        if steps == self.total {
            return self.span;
        }
        self.span * (f64::from(steps) / f64::from(self.total))
    }

    /// The state now.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.body.phase(&self.point)
    }

    /// One step toward the end.
    ///
    /// # Errors
    /// What the load refuses; a state that is not finite.
    pub fn advance<L: Load>(&mut self, load: &mut L) -> Result<(), L::Error> {
        let from = self.elapsed();
        let h = self.time(self.taken + 1) - from;
        self.before = self.point;
        let mut point = self.point;
        (self.body).step(self.scheme, &mut point, load, self.start + from, h)?;
        self.evaluations += self.scheme.kicks() as u64;
        if !(self.body.phase(&point).numbers().iter()).all(|x| x.is_finite()) {
            let time = self.start + from;
            return Err(Error::NotFiniteMotion { time }.into());
        }
        self.point = point;
        self.taken += 1;
        Ok(())
    }

    /// The state at a time since the start that is within the last step: by a shorter step from where it began.
    ///
    /// # Errors
    /// What the load refuses.
    pub fn within<L: Load>(&mut self, elapsed: f64, load: &mut L) -> Result<Phase, L::Error> {
        let from = self.time(self.taken.saturating_sub(1));
        let mut point = self.before;
        let at = self.start + from;
        (self.body).step(self.scheme, &mut point, load, at, elapsed - from)?;
        self.evaluations += self.scheme.kicks() as u64;
        Ok(self.body.phase(&point))
    }
}

/// The scheme that takes fewest kicks at the length of step at which it meets the tolerance.
fn cheapest<L: Load>(
    body: &Body,
    point: &Point,
    load: &mut L,
    start: f64,
    span: f64,
    tolerance: f64,
    evaluations: &mut u64,
) -> Result<(Scheme, f64), L::Error> {
    let mut best: Option<(f64, Scheme, f64)> = None;
    for scheme in Scheme::ALL {
        let step = longest(
            body,
            point,
            load,
            start,
            span,
            tolerance,
            scheme,
            evaluations,
        )?;
        let cost = scheme.kicks() as f64 / step.abs();
        if best.is_none_or(|(least, ..)| cost < least) {
            best = Some((cost, scheme, step));
        }
    }
    Ok(best.map_or((Scheme::Strang, span), |(_, scheme, step)| (scheme, step)))
}

/// The length of step at which one step differs from two halves by no more than the tolerance, over the first few steps.
#[expect(clippy::too_many_arguments, reason = "one search, said in full")]
fn longest<L: Load>(
    body: &Body,
    point: &Point,
    load: &mut L,
    start: f64,
    span: f64,
    tolerance: f64,
    scheme: Scheme,
    evaluations: &mut u64,
) -> Result<f64, L::Error> {
    let mut step = first_trial(body, point, load, start, span)?;
    for _ in 0..ROUNDS {
        let mut worst: f64 = 0.0;
        let mut fine = *point;
        let mut reached = 0.0;
        for _ in 0..TRIALS {
            if (reached + step).abs() > span.abs() {
                break;
            }
            let mut coarse = fine;
            let at = start + reached;
            body.step(scheme, &mut coarse, load, at, step)?;
            body.step(scheme, &mut fine, load, at, 0.5 * step)?;
            body.step(scheme, &mut fine, load, at + 0.5 * step, 0.5 * step)?;
            *evaluations += 3 * scheme.kicks() as u64;
            worst = worst.max(difference(body, &coarse, &fine) / tolerance);
            reached += step;
        }
        if worst == 0.0 && reached != 0.0 {
            return Ok(span); // the load does nothing
        }
        let factor = if reached == 0.0 {
            0.25 // longer than the span
        } else {
            SAFETY * worst.powf(-1.0 / f64::from(scheme.order() + 1))
        };
        let next = step * factor.clamp(0.02, 50.0);
        if (0.8..1.1).contains(&factor) {
            return Ok(next);
        }
        step = next.abs().min(span.abs() / TRIALS as f64).copysign(span);
    }
    Ok(step)
}

/// A twentieth of the faster of a turn and a swing.
fn first_trial<L: Load>(
    body: &Body,
    point: &Point,
    load: &mut L,
    start: f64,
    span: f64,
) -> Result<f64, L::Error> {
    let phase = body.phase(point);
    let torque = load.wrench(start, &phase)?.torque;
    let along = body.q_bp.inverse_transform_vector(&torque);
    let swing: f64 = (along.iter().zip(body.moments))
        .filter(|&(_, moment)| moment > 0.0)
        .map(|(torque, moment)| (torque / moment).abs())
        .fold(0.0, f64::max);
    let rate = phase.omega.norm().max(swing.sqrt());
    let step = std::f64::consts::TAU / 20.0 / rate;
    let most = span.abs() / TRIALS as f64;
    Ok(if step < most { step } else { most }.copysign(span))
}

/// Half the angle between two attitudes, or how far ω differ in parts of the larger one, whichever is more.
fn difference(body: &Body, a: &Point, b: &Point) -> f64 {
    let (one, other) = (body.omega(a), body.omega(b));
    let most = one.norm().max(other.norm());
    let spin = if most == 0.0 {
        0.0
    } else {
        (one - other).norm() / most
    };
    let apart = a.attitude.conjugate() * b.attitude;
    spin.max(apart.imag().norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::RigidBody;
    use crate::motion::loads::{Analytic, Subject, Term};
    use crate::motion::state::State;

    fn top(moments: [f64; 3]) -> RigidBody {
        let center = Vector3::new(0.0, 0.0, 0.6);
        RigidBody::from_principal(1.3, &moments, &Matrix3::identity(), &center, 0.0).expect("body")
    }

    fn energy(body: &RigidBody, phase: &Phase) -> f64 {
        let tensor = body.inertia_about(&Vector3::zeros());
        let height = (phase.attitude * body.center_of_mass()).z;
        0.5 * phase.omega.dot(&(tensor * phase.omega)) + body.mass() * 9.81 * height
    }

    #[test]
    fn energy_and_vertical_momentum_of_a_heavy_body_do_not_drift() {
        for moments in [[0.9, 0.9, 0.5], [0.7, 0.9, 0.5]] {
            let body = top(moments);
            let euler = EulerEquations::about(&body, &Vector3::zeros());
            let phase = Phase::in_place(&State {
                attitude: UnitQuaternion::from_euler_angles(0.8, 0.2, 0.1),
                omega: Vector3::new(0.3, 0.1, 12.0),
            });
            let gravity = [Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81)).expect("finite")];
            let mut load = Analytic::new(&gravity, Subject::pivoted(&body, 0.0));
            let times = [0.0, 200.0];
            let mut run =
                Splitting::new(&euler, None, times, &phase, &mut load, 1e-8, None).expect("smooth");
            let vertical = |phase: &Phase| {
                let tensor = body.inertia_about(&Vector3::zeros());
                (phase.attitude * (tensor * phase.omega)).z
            };
            let (e, l) = (energy(&body, &phase), vertical(&phase));
            let (mut first, mut second): (f64, f64) = (0.0, 0.0);
            while run.elapsed() < 200.0 {
                run.advance(&mut load).expect("smooth");
                let change = (energy(&body, &run.phase()) / e - 1.0).abs();
                if run.elapsed() <= 100.0 {
                    first = first.max(change);
                } else {
                    second = second.max(change);
                }
                assert!((vertical(&run.phase()) / l - 1.0).abs() < 1e-13);
            }
            assert!(second <= 1.5 * first + 1e-13, "{first:e} {second:e}");
            assert!(first < 1e-6, "{first:e}");
        }
    }

    #[test]
    fn between_steps_and_backward() {
        let body = top([0.7, 0.9, 0.5]);
        let euler = EulerEquations::about(&body, &Vector3::zeros());
        let phase = Phase::in_place(&State {
            attitude: UnitQuaternion::from_euler_angles(0.8, 0.2, 0.1),
            omega: Vector3::new(0.3, 0.1, 3.0),
        });
        let gravity = [Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81)).expect("finite")];
        let mut load = Analytic::new(&gravity, Subject::pivoted(&body, 0.0));
        let mut go = |times: [f64; 2], phase: &Phase| {
            let mut run =
                Splitting::new(&euler, None, times, phase, &mut load, 1e-12, None).expect("smooth");
            let mut between = *phase;
            while run.elapsed() != times[1] - times[0] {
                let from = run.elapsed();
                run.advance(&mut load).expect("smooth");
                let middle = 0.5 * (times[1] - times[0]);
                if (from - middle) * (run.elapsed() - middle) <= 0.0 {
                    between = run.within(middle, &mut load).expect("smooth");
                }
            }
            (between, run.phase())
        };
        let (middle, end) = go([1.0, 3.0], &phase);
        let (_, again) = go([2.0, 3.0], &middle);
        let (_, back) = go([3.0, 1.0], &end);
        assert!(end.attitude.angle_to(&again.attitude) < 1e-10);
        assert!(back.attitude.angle_to(&phase.attitude) < 1e-10);
        assert!((back.omega - phase.omega).norm() < 1e-9);
    }
}
