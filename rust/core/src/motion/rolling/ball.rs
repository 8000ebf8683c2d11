//! A homogeneous ball that rolls on a plane, level or leaning, at rest or turning: its motion in closed form.
//!
//! C is the centre of the ball, its three moments are `I`, and `k = I/(I + m a²)`. The plane is z = 0, as complex numbers
//! `z = x + i y`. From `m v̇ = m g + F`, `I ω̇ = r×F` and the constraint `v = iΩ z − i a w`, with the velocity v of C and
//! `w = ω_x + i ω_y`,
//!
//! ```text
//! v̇ = i k Ω v + (1 − k) g,   v = v_0 e^{ikΩt} + (1 − k) g t φ_1(ikΩt),   z = v_0 t φ_1 + (1 − k) g t² φ_2,   ω_z constant
//! φ_1(x) = (eˣ − 1)/x,   φ_2(x) = (eˣ − 1 − x)/x²
//! ```
//!
//! so that the ball goes in circles on a turntable, and drifts across the slope where this leans. The attitude solves `q̇ = ½ ω q` with this
//! ω: a rotation where ω is constant, else by power series on steps that do not depend on the times asked for.
//! Source: Earnshaw, Dynamics (1844); Routh, Advanced Rigid Dynamics (1884), § 221; Weltner, American Journal of Physics 47 (1979) 984.

use nalgebra::{Complex, Quaternion, UnitQuaternion, Vector3};

use super::contact::{RollingState, TOUCHES, pressing};
use super::surface::Surface;
use crate::error::{Error, MotionFault, finite};
use crate::mass::RigidBody;

/// How far the ball may turn, in radians, where the attitude is summed from the start.
const FARTHEST: f64 = 1e5;
/// How far a motion in closed form may turn: beyond, no digit of the angle is left.
const NO_DIGIT: f64 = 1e15;
/// The terms of the power series of an attitude, on steps in which the ball turns by a radian or less.
const TERMS: usize = 20;

/// The imaginary unit.
const I: Complex<f64> = Complex::new(0.0, 1.0);

/// The motion of a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RollingBall {
    mass: f64,
    radius: f64,
    /// k.
    share: f64,
    turntable: f64,
    gravity: Vector3<f64>,
    /// w and `ω_z` at the start.
    level: Complex<f64>,
    axial: f64,
    attitude: UnitQuaternion<f64>,
}

/// An attitude on its way, from which the next ones are summed.
#[derive(Clone, Copy)]
struct Node {
    time: f64,
    attitude: Quaternion<f64>,
}

impl RollingBall {
    /// Make the motion of a ball on the plane z = 0.
    pub(super) fn new(
        body: &RigidBody,
        surface: &Surface,
        omega: &Vector3<f64>,
        attitude: UnitQuaternion<f64>,
        gravity: Vector3<f64>,
        turntable: f64,
    ) -> Result<Self, Error> {
        let Some(radius) = surface.sphere_radius() else {
            return Err(Error::Motion(MotionFault::ContactCannotServe {
                needs: "a motion in closed form is known of a sphere, a cylinder and a cone; the simulation of a contact serves \
                        other surfaces",
            }));
        };
        finite("turntable", turntable)?;
        pressing(&gravity)?;
        let off = (surface.center() - body.center_of_mass()).norm() / radius;
        if off > TOUCHES {
            return Err(Error::Motion(MotionFault::RollsInNoClosedForm {
                law: "the centre of mass of a ball is at its centre; the number is its distance over the radius",
                value: off,
            }));
        }
        let inertia = body.inertia();
        let moment = inertia.trace() / 3.0;
        let uneven = (inertia - nalgebra::Matrix3::identity() * moment)
            .abs()
            .max();
        if uneven > TOUCHES * moment {
            return Err(Error::Motion(MotionFault::RollsInNoClosedForm {
                law: "the three moments of a ball are equal; the number is their largest difference from the mean, over it",
                value: uneven / moment,
            }));
        }
        let in_space = attitude * omega;
        Ok(Self {
            mass: body.mass(),
            radius,
            share: moment / (moment + body.mass() * radius * radius),
            turntable,
            gravity,
            level: Complex::new(in_space.x, in_space.y),
            axial: in_space.z,
            attitude,
        })
    }

    /// kΩ.
    fn rate(&self) -> f64 {
        self.share * self.turntable
    }

    /// (1 − k) g in the plane.
    fn pull(&self) -> Complex<f64> {
        Complex::new(self.gravity.x, self.gravity.y) * (1.0 - self.share)
    }

    /// `v_0`: the ball begins where the turntable rests.
    fn start(&self) -> Complex<f64> {
        Complex::new(self.level.im, -self.level.re) * self.radius
    }

    /// z, v and w at a time.
    fn place(&self, t: f64) -> [Complex<f64>; 3] {
        let (start, pull) = (self.start(), self.pull());
        let [once, twice] = phi(self.rate() * t).map(|phi| phi * t);
        let twice = twice * t;
        let place = start * once + pull * twice;
        let change = (start * I * self.rate() + pull) * once;
        // w from the change of v − iΩ z, without the parts that cancel.
        let slower = self.turntable - self.rate();
        let level = start * once * slower + pull * (twice * self.turntable + I * once);
        [place, start + change, self.level + level / self.radius]
    }

    /// ẇ.
    fn turning(&self, velocity: Complex<f64>) -> Complex<f64> {
        let slower = self.turntable - self.rate();
        (velocity * slower + I * self.pull()) / self.radius
    }

    /// Whether ω is constant, so that the attitude is a rotation about it.
    fn is_steady(&self) -> bool {
        let zero = Complex::new(0.0, 0.0);
        self.pull() == zero && (self.turntable == 0.0 || self.level == zero)
    }

    /// The period of ω on a level turntable, if the ball does not turn too far in it.
    fn period(&self) -> Option<f64> {
        let period = std::f64::consts::TAU / self.rate().abs();
        let is_level = self.pull() == Complex::new(0.0, 0.0);
        (is_level && period * self.fastest() <= FARTHEST).then_some(period)
    }

    /// The largest |ω| of a motion on a level plane, about; on a slope that at the start.
    fn fastest(&self) -> f64 {
        let swing = if self.turntable == 0.0 {
            0.0
        } else {
            2.0 * (1.0 - self.share) / self.share
        };
        self.level.norm() * (1.0 + swing) + self.axial.abs()
    }

    /// Return the largest |t| at which the state is known.
    pub(super) fn reach(&self) -> f64 {
        let fastest = self.fastest() + self.rate().abs();
        if self.is_steady() || self.period().is_some() {
            return NO_DIGIT / fastest;
        }
        // |ẇ| ≤ c, so that the ball turns by no more than |ω| t + ½ c t².
        let pull = self.pull().norm();
        let drift = if self.turntable == 0.0 {
            0.0
        } else {
            2.0 * pull * (1.0 - self.share) / self.share
        };
        let slower = (self.turntable - self.rate()).abs();
        let growth = (slower * self.start().norm() + drift + pull) / self.radius;
        let root = (fastest * fastest + 2.0 * growth * FARTHEST).sqrt();
        2.0 * FARTHEST / (fastest + root)
    }

    /// Compute the states at many times. Each has the same bits whatever the others are.
    pub(super) fn states(&self, times: &[f64]) -> Vec<RollingState> {
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by(|a, b| times[*a].abs().total_cmp(&times[*b].abs()));
        let unknown = RollingState::unknown();
        let mut states = vec![unknown; times.len()];
        let begin = Node {
            time: 0.0,
            attitude: self.attitude.into_inner(),
        };
        // Forward and backward in time, each on a way of its own.
        let (mut ahead, mut behind) = (begin, begin);
        let round = (!self.is_steady())
            .then(|| self.period())
            .flatten()
            .map(|period| (period, self.round(period)));
        for index in order {
            let time = times[index];
            if !time.is_finite() {
                continue;
            }
            let node = if time < 0.0 { &mut behind } else { &mut ahead };
            let attitude = if self.is_steady() {
                let omega = Vector3::new(self.level.re, self.level.im, self.axial);
                UnitQuaternion::from_scaled_axis(omega * time) * self.attitude
            } else if let Some((period, turn)) = round {
                // ω comes back after a period: the rotation of one, so many times, and the rest from the start.
                let times = (time / period).floor();
                let rest = time - times * period;
                let part = self.sum(begin, rest) * self.attitude.into_inner().conjugate();
                let before = UnitQuaternion::from_scaled_axis(turn * times) * self.attitude;
                UnitQuaternion::new_normalize(part * before.into_inner())
            } else {
                *node = self.advance(*node, time);
                UnitQuaternion::new_normalize(self.sum(*node, time))
            };
            states[index] = self.state(time, attitude);
        }
        states
    }

    /// The rotation of a period, as a vector of rotation.
    fn round(&self, period: f64) -> Vector3<f64> {
        let identity = Node {
            time: 0.0,
            attitude: Quaternion::identity(),
        };
        let turn = self.sum(identity, period);
        // With the sign of the quaternion, which is continuous: of a full turn in it the axis does not matter.
        let axis = turn.vector().try_normalize(0.0).unwrap_or(Vector3::z());
        axis * (2.0 * turn.vector().norm().atan2(turn.w))
    }

    /// The last node before a time.
    fn advance(&self, mut node: Node, time: f64) -> Node {
        loop {
            let step = self.step(node.time).copysign(time);
            if (node.time + step).abs() >= time.abs() || node.time + step == node.time {
                return node;
            }
            node = Node {
                time: node.time + step,
                attitude: self.series(node, step),
            };
        }
    }

    /// The attitude at a time from a node before it.
    fn sum(&self, node: Node, time: f64) -> Quaternion<f64> {
        let node = self.advance(node, time);
        self.series(node, time - node.time)
    }

    /// A step in which the ball, and the direction in which ω turns, go on by a radian or less.
    fn step(&self, time: f64) -> f64 {
        let [_, velocity, level] = self.place(time);
        let fastest = level.norm() + self.axial.abs() + self.rate().abs();
        1.0 / (fastest + self.turning(velocity).norm().sqrt())
    }

    /// The attitude a step after a node: `q_{n+1} = Σ ½ ω_j q_{n−j}/(n + 1)`.
    fn series(&self, node: Node, step: f64) -> Quaternion<f64> {
        let [_, velocity, level] = self.place(node.time);
        let zero = Complex::new(0.0, 0.0);
        let (mut levels, mut velocities) = ([zero; TERMS], [zero; TERMS]);
        (levels[0], velocities[0]) = (level, velocity);
        for n in 0..TERMS - 1 {
            let pull = if n == 0 { self.pull() } else { zero };
            let slower = self.turntable - self.rate();
            let turning = (velocities[n] * slower + I * pull) * (step / self.radius);
            let speeding = (I * velocities[n] * self.rate() + pull) * step;
            levels[n + 1] = turning / (n + 1) as f64;
            velocities[n + 1] = speeding / (n + 1) as f64;
        }
        let mut terms = [Quaternion::new(0.0, 0.0, 0.0, 0.0); TERMS + 1];
        terms[0] = node.attitude;
        for n in 0..TERMS {
            let mut sum = Quaternion::new(0.0, 0.0, 0.0, 0.0);
            for j in 0..=n {
                let axial = if j == 0 { self.axial } else { 0.0 };
                let omega = Quaternion::new(0.0, levels[j].re, levels[j].im, axial);
                sum += omega * terms[n - j];
            }
            terms[n + 1] = sum * (0.5 * step / (n + 1) as f64);
        }
        let (first, rest) = (terms[0], &terms[1..]);
        let sum = rest
            .iter()
            .rfold(Quaternion::new(0.0, 0.0, 0.0, 0.0), |sum, term| sum + term);
        // The quaternion is one of unit length: rounding does not grow.
        let found = first + sum;
        found * (1.5 - 0.5 * found.norm_squared())
    }

    /// The force of the plane across the normal over the mass.
    fn friction(&self, time: f64) -> Complex<f64> {
        let [_, velocity, _] = self.place(time);
        let flat = Complex::new(self.gravity.x, self.gravity.y);
        I * velocity * self.rate() + self.pull() - flat
    }

    /// Return the largest friction needed between two times and the normal force, and when: the first where the acceleration, which turns with kΩ, is along −g in the
    /// plane, or at an end.
    pub(super) fn extremes(&self, [from, to]: [f64; 2]) -> [[f64; 2]; 2] {
        let needed = |time: f64| self.friction(time).norm() / -self.gravity.z;
        let mut found = [needed(from), from];
        let rate = self.rate();
        if rate != 0.0 {
            let start = I * self.start() * rate + self.pull();
            let flat = Complex::new(self.gravity.x, self.gravity.y);
            let (first, period) = (
                (-flat / start).arg() / rate,
                std::f64::consts::TAU / rate.abs(),
            );
            let time = first + ((from - first) / period).ceil() * period;
            if time <= to && needed(time) > found[0] {
                found = [needed(time), time];
            }
        }
        if needed(to) > found[0] {
            found = [needed(to), to];
        }
        [found, [-self.mass * self.gravity.z, from]]
    }

    fn state(&self, time: f64, attitude: UnitQuaternion<f64>) -> RollingState {
        let [place, velocity, level] = self.place(time);
        let friction = self.friction(time) * self.mass;
        RollingState {
            attitude,
            omega: attitude.inverse() * Vector3::new(level.re, level.im, self.axial),
            position: Vector3::new(place.re, place.im, self.radius),
            velocity: Vector3::new(velocity.re, velocity.im, 0.0),
            force: Vector3::new(friction.re, friction.im, -self.mass * self.gravity.z),
            pressure: Vector3::new(place.re, place.im, 0.0),
            tips: false,
        }
    }
}

/// `φ_1` and `φ_2` of i x.
fn phi(x: f64) -> [Complex<f64>; 2] {
    let half = 0.5 * x;
    let sinc = if half == 0.0 { 1.0 } else { half.sin() / half };
    let first = Complex::from_polar(sinc, half);
    // (x − sin x)/x² cancels where x is small.
    let odd = if x.abs() < 1.0 {
        let mut term = x / 6.0;
        let mut sum = term;
        for n in 2..12 {
            let even = f64::from(2 * n);
            term *= -x * x / (even * (even + 1.0));
            sum += term;
        }
        sum
    } else {
        (x - x.sin()) / (x * x)
    };
    [first, Complex::new(0.5 * sinc * sinc, odd)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_quotients_of_the_exponential_function() {
        for x in [-3.0, -0.7, 0.3, 0.999_999, 1.0, 5.0_f64] {
            let i = Complex::new(0.0, x);
            let [first, second] = phi(x);
            let exact = (i.exp() - 1.0) / i;
            assert!((first - exact).norm() < 1e-15, "{x}");
            assert!((second - (exact - 1.0) / i).norm() < 2e-15 / x.abs(), "{x}");
        }
        let [first, second] = phi(0.0);
        assert_eq!(first, Complex::new(1.0, 0.0));
        assert_eq!(second, Complex::new(0.5, 0.0));
    }
}
