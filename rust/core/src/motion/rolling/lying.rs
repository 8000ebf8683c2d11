//! A cylinder or a cone that lies on a plane and rolls: its motion, its force and its centre of pressure in closed form.
//!
//! All points of the line of contact rest, so that ω is along this line, whose direction is e; with `y = n×e`. The plane holds the body
//! along the whole line, with the resultant force F and, by friction, a couple about n. The centre of pressure is on the
//! line at the distance s, where `L̇·y = ((P − C)×F)·y`.
//!
//! *Cylinder* of radius a with C on its axis: `(I_e + m a²) φ̈ = m a g·(e×n)`, so that φ is a quadratic function of time;
//! `L̇ = I α + ω×I ω` and `s = −(L̇·y + a F_e)/F_n` from below C.
//!
//! *Cone* of half-angle α with C on its axis at the distance d from its apex, which rests. Its axis turns about n with θ̇, and
//! `ω = −θ̇ cot α e`; with the moment `I_e = I_s cos²α + (I_t + m d²) sin²α` about the line of contact
//!
//! ```text
//! I_e cot²α θ̈ = m d cos α g·y,   s = d cos α + (θ̇² cot α (I_s cos²α + I_t sin²α) − d sin α F_e)/F_n
//! ```
//!
//! from the apex. The first is a pendulum, which [`HeavyTop`](crate::motion::heavy_top::HeavyTop) solves by theta functions.
//! Source: Routh, Elementary Rigid Dynamics (1882); Landau & Lifshitz, Mechanics, § 32, problem 7.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::contact::{RollingState, TOUCHES, pressing};
use super::ruled::{Kind, RuledSurface};
use crate::error::{Error, MotionFault};
use crate::mass::RigidBody;
use crate::motion::attitude::shortest_turn;
use crate::motion::heavy_top::{HeavyTop, PivotedTop};

/// How far a body may roll, in radians: beyond, no digit of the angle is left.
const NO_DIGIT: f64 = 1e15;

/// The motion of a cylinder or a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LyingBody {
    mass: f64,
    inertia: Matrix3<f64>,
    gravity: Vector3<f64>,
    surface: RuledSurface,
    attitude: UnitQuaternion<f64>,
    /// The direction of the line, and the rate about it, at the start.
    line: Vector3<f64>,
    rate: f64,
    /// The place of C along the axis: from the middle of a cylinder, from the apex of a cone.
    along: f64,
    way: Way,
}

/// How the angle goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "one a motion, which is copied as a value"
)]
enum Way {
    /// φ̈ is constant.
    Even { acceleration: f64 },
    /// θ is that of a pendulum: at the start, its mean rate, and `g` of a pendulum of unit length.
    Pendulum {
        motion: HeavyTop,
        start: f64,
        mean: f64,
        pull: Vector3<f64>,
    },
}

impl LyingBody {
    /// Make the motion of a body on the plane z = 0.
    pub(super) fn new(
        body: &RigidBody,
        surface: &RuledSurface,
        omega: &Vector3<f64>,
        attitude: Option<UnitQuaternion<f64>>,
        gravity: Vector3<f64>,
    ) -> Result<Self, Error> {
        pressing(&gravity)?;
        let axis = *surface.axis;
        let from_center = body.center_of_mass() - surface.center;
        let along = axis.dot(&from_center);
        let off = (from_center - axis * along).norm() / surface.size();
        if off > TOUCHES {
            return Err(Error::Motion(MotionFault::RollsInNoClosedForm {
                law: "the centre of mass of a cylinder or a cone is on its axis; the number is its distance from it over the size",
                value: off,
            }));
        }
        let attitude = lie(surface, attitude)?;
        let [first, last] = surface.line_of_contact(&(attitude.inverse() * Vector3::z()));
        let in_body = match surface.kind {
            Kind::Cylinder => axis,
            Kind::Cone => (last - first).normalize(),
        };
        let rate = omega.dot(&in_body);
        let across = (omega - in_body * rate).norm();
        if across > TOUCHES * omega.norm() {
            return Err(Error::OutOfDomain {
                what: "omega",
                law: "along the line of contact, all of whose points rest; the number is the part of it across the line, over the whole: \
                      take a multiple of the difference of the two points of surface.line_of_contact",
                value: across / omega.norm(),
            });
        }
        // Exactly in the plane.
        let mut line = attitude * in_body;
        line.z = 0.0;
        let line = line.normalize();
        let inertia = body.inertia();
        let mut made = Self {
            mass: body.mass(),
            inertia,
            gravity,
            surface: *surface,
            attitude,
            line,
            rate,
            along,
            way: Way::Even { acceleration: 0.0 },
        };
        made.way = match surface.kind {
            Kind::Cylinder => {
                let moment = axis.dot(&(inertia * axis));
                let radius = surface.radius;
                let down = gravity.dot(&line.cross(&Vector3::z()));
                let acceleration =
                    made.mass * radius * down / (moment + made.mass * radius * radius);
                Way::Even { acceleration }
            }
            Kind::Cone => {
                let [top, _] = surface.ends();
                made.along = top - along;
                made.pendulum()?
            }
        };
        Ok(made)
    }

    /// `I_s` and `I_t`.
    fn moments(&self) -> [f64; 2] {
        let axis = *self.surface.axis;
        let axial = axis.dot(&(self.inertia * axis));
        [axial, 0.5 * (self.inertia.trace() - axial)]
    }

    /// θ̇ for a rate about the line of contact.
    fn turn(&self, rate: f64) -> f64 {
        let [sin, cos] = self.surface.half_angle();
        -rate * sin / cos
    }

    /// The pendulum that a cone on a plane is.
    fn pendulum(&self) -> Result<Way, Error> {
        let axis = *self.surface.axis;
        let [axial, across] = self.moments();
        let symmetric = Matrix3::identity() * across + axis * axis.transpose() * (axial - across);
        let uneven = (self.inertia - symmetric).abs().max() / axial.max(across);
        if uneven > TOUCHES {
            return Err(Error::Motion(MotionFault::RollsInNoClosedForm {
                law: "the moments of a cone across its axis are equal; the number is by how much the tensor differs from such a one, \
                      over the larger moment",
                value: uneven,
            }));
        }
        let [sin, cos] = self.surface.half_angle();
        let moment = axial * cos * cos + (across + self.mass * self.along * self.along) * sin * sin;
        let ratio = self.mass * self.along * sin * sin / (cos * moment);
        let pull = Vector3::new(self.gravity.x, self.gravity.y, 0.0) * ratio;
        let turn = self.turn(self.rate);
        if pull.norm() == 0.0 {
            return Ok(Way::Even { acceleration: 0.0 });
        }
        let bob = RigidBody::new(1.0, &Matrix3::zeros(), &Vector3::x(), 0.0)?;
        let start = self.line.y.atan2(self.line.x);
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), start);
        let spin = Vector3::z() * turn;
        let motion = HeavyTop::of(&PivotedTop::of(&bob, TOUCHES)?, &spin, &attitude, &pull)?;
        // It turns over where its energy is more than that of rest at the top.
        let nutation = motion.nutation();
        let energy = 0.5 * turn * turn - pull.dot(&self.line);
        let turns_over = nutation.period.is_finite() && energy > pull.norm();
        let mean = if turns_over {
            (std::f64::consts::TAU / nutation.period).copysign(turn)
        } else {
            0.0
        };
        Ok(Way::Pendulum {
            motion,
            start,
            mean,
            pull,
        })
    }

    /// Return the largest |t| at which the state is known.
    pub(super) fn reach(&self) -> f64 {
        match &self.way {
            Way::Even { acceleration } => {
                let growth = acceleration.abs();
                let root = (self.rate * self.rate + 2.0 * growth * NO_DIGIT).sqrt();
                2.0 * NO_DIGIT / (self.rate.abs() + root)
            }
            Way::Pendulum { mean, pull, .. } => NO_DIGIT / (mean.abs() + pull.norm().sqrt()),
        }
    }

    /// Compute the states at many times.
    pub(super) fn states(&self, times: &[f64]) -> Vec<RollingState> {
        let (mut attitudes, mut omegas) = (
            vec![[f64::NAN; 4]; times.len()],
            vec![[f64::NAN; 3]; times.len()],
        );
        if let Way::Pendulum { motion, .. } = &self.way {
            motion.sample(times, &mut attitudes, &mut omegas);
        }
        let rows = times.iter().zip(attitudes.iter().zip(&omegas));
        rows.map(|(&time, (&[_, _, z, w], &[_, _, turn]))| {
            if !time.is_finite() {
                return RollingState::unknown();
            }
            match (self.surface.kind, &self.way) {
                (Kind::Cylinder, Way::Even { acceleration }) => self.cylinder(time, *acceleration),
                (
                    _,
                    Way::Pendulum {
                        start, mean, pull, ..
                    },
                ) => {
                    // The quaternion tells θ but for multiples of 4π, and it is within 2π of the mean.
                    let angle = 2.0 * z.atan2(w);
                    let expected = start + mean * time;
                    let rounds = ((expected - angle) / (4.0 * std::f64::consts::PI)).round();
                    let angle = angle + 4.0 * std::f64::consts::PI * rounds;
                    let (sin, cos) = angle.sin_cos();
                    let speeding = pull.y * cos - pull.x * sin;
                    self.cone(angle - start, turn, speeding)
                }
                (Kind::Cone, Way::Even { .. }) => {
                    let turn = self.turn(self.rate);
                    self.cone(turn * time, turn, 0.0)
                }
            }
        })
        .collect()
    }

    fn cylinder(&self, time: f64, acceleration: f64) -> RollingState {
        let (line, normal, axis) = (self.line, Vector3::z(), self.surface.axis);
        let ahead = line.cross(&normal);
        let radius = self.surface.radius;
        let angle = (self.rate + 0.5 * acceleration * time) * time;
        let rate = self.rate + acceleration * time;
        let attitude = self.attitude * UnitQuaternion::from_axis_angle(&axis, angle);
        let omega = *axis * rate;
        let force = self.mass * (ahead * (radius * acceleration) - self.gravity);
        let torque =
            attitude * (self.inertia * *axis * acceleration + omega.cross(&(self.inertia * omega)));
        let from_center = -(torque.dot(&normal.cross(&line)) + radius * force.dot(&line)) / force.z;
        let position = normal * radius + ahead * (radius * angle);
        RollingState {
            attitude,
            omega,
            position,
            velocity: ahead * (radius * rate),
            force,
            pressure: position - normal * radius + line * from_center,
            tips: (from_center + self.along).abs() > 0.5 * self.surface.height,
        }
    }

    /// A cone that has turned about its apex by an angle.
    fn cone(&self, angle: f64, turn: f64, speeding: f64) -> RollingState {
        let normal = Vector3::z();
        let round = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let line = round * self.line;
        let ahead = normal.cross(&line);
        let [sin, cos] = self.surface.half_angle();
        // Its own axis is from the base to the apex.
        let roll = UnitQuaternion::from_axis_angle(&self.surface.axis, angle / sin);
        let attitude = round * self.attitude * roll;
        let rate = -turn * cos / sin;
        let along = self.along;
        let acceleration = (ahead * speeding - line * (turn * turn)) * (along * cos);
        let force = self.mass * (acceleration - self.gravity);
        let [axial, across] = self.moments();
        let torque = turn * rate * (axial * cos * cos + across * sin * sin);
        let from_apex = along * cos - (torque + along * sin * force.dot(&line)) / force.z;
        let position = (line * cos + normal * sin) * along;
        RollingState {
            attitude,
            omega: attitude.inverse() * line * rate,
            position,
            velocity: ahead * (along * cos * turn),
            force,
            pressure: line * from_apex,
            tips: !(0.0..=self.surface.radius.hypot(self.surface.height)).contains(&from_apex),
        }
    }
}

/// The attitude given, in which the body must lie, or one: of a cylinder the axis is along x then, of a cone the line from the
/// apex to the rim.
fn lie(
    surface: &RuledSurface,
    attitude: Option<UnitQuaternion<f64>>,
) -> Result<UnitQuaternion<f64>, Error> {
    let axis = surface.axis;
    let [sin, cos] = surface.half_angle();
    let Some(attitude) = attitude else {
        let aim = match surface.kind {
            Kind::Cylinder => Vector3::x(),
            Kind::Cone => -Vector3::new(cos, 0.0, sin),
        };
        let about_y = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -aim.z.atan2(aim.x));
        // From the axis to x, and on to where it is to be.
        let to_x = shortest_turn(&axis, &Vector3::x()).unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI)
        });
        return Ok(about_y * to_x);
    };
    let slope = (attitude * *axis).z;
    let lean = match surface.kind {
        Kind::Cylinder => slope,
        Kind::Cone => slope + sin,
    };
    if lean.abs() > TOUCHES {
        return Err(Error::OutOfDomain {
            what: "attitude",
            law: "one in which the body lies on the plane z = 0: the axis of a cylinder is level, that of a cone points downward to the \
                  apex by its half-angle; the number is the error of the sine of its slope: leave attitude out to lay it down",
            value: lean,
        });
    }
    Ok(attitude)
}
