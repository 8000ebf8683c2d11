//! The terms of a load as series in time: torques about the reference point, components in principal axes, over the unit of
//! moments and the square of the unit of rates.

use nalgebra::{Matrix3, Quaternion, Vector3};

use super::inertia::Inertia;
use super::motion::{Motion, Units};
use super::numbers::{
    Block, Matrix, Number, Quadruple, Row, Rows, Vector, WIDTH, ZERO, apply, at, begin, between,
    cross, cross_product, dot, extend, product, quaternion_product, seen, times,
};
use super::spline::Spline;
use crate::error::Error;
use crate::motion::attitude::from_axes;
use crate::motion::loads::{
    ConstantForce, ConstantTorque, Feedback, Frame, Subject, Term, UniformGravity,
};

/// The part of the fastest ω below which quadratic damping is left out: the error of the derivatives is its square, that of ω its
/// cube.
const STILL: f64 = 1e-8;

/// A term at work.
#[derive(Clone, Debug)]
pub(super) enum Act {
    /// Constant in the body.
    Constant(Vector),
    /// A vector v constant in N, `Rᵀ v`, or `a×Rᵀ v` with an arm a.
    Space {
        vector: Vector,
        arm: Option<Box<Vector>>,
        seen: Rows<3>,
    },
    /// `−D ω`.
    Linear(Box<Matrix>),
    /// `−E |ω| ω`, with series of ω·ω and |ω|.
    Quadratic {
        matrix: Box<Matrix>,
        squares: Row,
        speeds: Row,
    },
    /// `−K s vec(e)` of `e = q_target⁻¹∘q`, which is linear in q, s the sign that its scalar part has.
    Feedback {
        stiffness: Box<Matrix>,
        target: Quadruple,
        sign: f64,
    },
    Sampled(Box<Spline>),
}

/// Where a term stands among the variables, and what it acts on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub(super) block: Block,
    /// The column of its first number.
    pub(super) first: usize,
    /// A time within the span, which has no breaks.
    pub(super) middle: f64,
    pub(super) inertia: &'a Inertia,
    pub(super) subject: &'a Subject,
    pub(super) units: Units,
}

impl Place<'_> {
    /// What `term`, which is not a scheduled one, does; the gravity gradient goes by itself.
    ///
    /// # Errors
    /// As [`Spline::new`].
    pub(super) fn acts(&self, term: &Term) -> Result<Vec<Act>, Error> {
        let Self {
            block,
            first,
            inertia,
            subject,
            units,
            ..
        } = *self;
        let over_torque = units.over_torque();
        let in_space = |vector: &Vector, arm: Option<Vector>| Act::Space {
            vector: times(vector, over_torque),
            arm: Option::map(arm, Box::new),
            seen: Rows::default(),
        };
        Ok(match term {
            Term::ConstantTorque(ConstantTorque { vector, frame }) => {
                let vector = block.vector(vector, first);
                vec![match frame {
                    Frame::Body => Act::Constant(inertia.principal(&vector, over_torque)),
                    Frame::Space => in_space(&vector, None),
                }]
            }
            Term::ConstantForce(ConstantForce { point: None, .. }) | Term::UniformGravity(_)
                if !subject.pivoted =>
            {
                Vec::new()
            }
            Term::ConstantForce(ConstantForce {
                vector,
                frame,
                point,
            }) => {
                let vector = block.vector(vector, first);
                let arm = match point {
                    None => inertia.arm,
                    Some(point) => {
                        let point = inertia.principal(&block.vector(point, first + 3), 1.0);
                        if subject.pivoted {
                            point
                        } else {
                            [0, 1, 2].map(|i| point[i] - inertia.center[i])
                        }
                    }
                };
                vec![match frame {
                    Frame::Body => {
                        Act::Constant(cross(&arm, &inertia.principal(&vector, over_torque)))
                    }
                    Frame::Space => in_space(&vector, Some(arm)),
                }]
            }
            Term::UniformGravity(UniformGravity { gravity }) => {
                let lever = inertia.arm.map(|x| x * inertia.mass);
                vec![in_space(&block.vector(gravity, first), Some(lever))]
            }
            Term::Damping(damping) => {
                let linear = self.matrix(&damping.linear, first, over_torque * units.rate);
                let quadratic = over_torque * units.rate * units.rate;
                let quadratic = self.matrix(&damping.quadratic, first + 9, quadratic);
                let mut acts = vec![Act::Linear(linear)];
                // E varies also where it is zero.
                let varies = |x: &Number| *x != ZERO;
                if quadratic.as_flattened().iter().any(varies) {
                    acts.push(Act::Quadratic {
                        matrix: quadratic,
                        squares: Row::new(),
                        speeds: Row::new(),
                    });
                }
                acts
            }
            Term::Feedback(feedback) => {
                let damping = self.matrix(&feedback.damping, first + 9, over_torque * units.rate);
                vec![
                    Act::Linear(damping),
                    Act::Feedback {
                        stiffness: self.matrix(&feedback.stiffness, first, over_torque),
                        target: self.target(feedback),
                        sign: 1.0,
                    },
                ]
            }
            Term::Sampled(sampled) => {
                let spline = Spline::new(sampled, self.middle, block, first, units)?;
                vec![Act::Sampled(Box::new(spline))]
            }
            Term::GravityGradient(_) | Term::Scheduled { .. } => Vec::new(),
        })
    }

    /// A matrix of variables, in principal axes.
    fn matrix(&self, matrix: &Matrix3<f64>, first: usize, factor: f64) -> Box<Matrix> {
        let varied = self.block.matrix(matrix, first);
        Box::new(between(&self.inertia.axes, &varied).map(|row| times(&row, factor)))
    }

    /// `(q_target exp(δ))⁻¹`, then to principal axes: δ the variable.
    fn target(&self, feedback: &Feedback) -> Quadruple {
        let q_pb = from_axes(&self.inertia.axes).conjugate().into_inner();
        let aim = feedback.target.conjugate().into_inner();
        let fixed = |q: Quaternion<f64>| [q.i, q.j, q.k, q.w].map(Number::constant);
        let [x, y, z] = self.block.vector(&Vector3::zeros(), self.first + 18);
        let half = [x * -0.5, y * -0.5, z * -0.5, Number::constant(1.0)];
        quaternion_product(&quaternion_product(&fixed(q_pb), &half), &fixed(aim))
    }
}

impl Act {
    /// Begins the series of a step at the time `t` with ω and q.
    pub(super) fn start(&mut self, t: f64, inertia: &Inertia, q: &Quadruple) {
        match self {
            Self::Space {
                vector, seen: rows, ..
            } => begin(rows, &seen(q, vector)),
            Self::Quadratic {
                squares, speeds, ..
            } => {
                squares.clear();
                speeds.clear();
            }
            Self::Sampled(spline) => spline.start(t, inertia, q),
            _ => {}
        }
    }

    /// The coefficient of order `k` of the torque, from those of the motion up to k; asked for in order. `fastest` is what |ω|
    /// is small against.
    pub(super) fn coefficient(&mut self, k: usize, motion: &Motion, fastest: f64) -> Vector {
        match self {
            Self::Constant(vector) if k == 0 => *vector,
            Self::Constant(_) => [ZERO; 3],
            Self::Space {
                arm, seen: rows, ..
            } => {
                let now = at(rows, k);
                let turns = cross_product(rows, &motion.omega, k);
                extend(rows, &turns);
                arm.as_ref().map_or(now, |arm| cross(arm, &now))
            }
            Self::Linear(matrix) => apply(matrix, &at(&motion.omega, k)).map(|x| -x),
            Self::Quadratic {
                matrix,
                squares,
                speeds,
            } => {
                let w = &motion.omega;
                squares.push(w.iter().fold(ZERO, |sum, x| sum + product(x, x, k)));
                speeds.push(speed(k, squares, speeds, fastest));
                let spin = [0, 1, 2].map(|i| product(speeds, &w[i], k));
                apply(matrix, &spin).map(|x| -x)
            }
            Self::Feedback {
                stiffness,
                target,
                sign,
            } => {
                let [x, y, z, _] = quaternion_product(target, &at(&motion.attitude, k));
                times(&apply(stiffness, &[x, y, z]), -*sign)
            }
            Self::Sampled(spline) => spline.coefficient(k, motion),
        }
    }

    /// The series of what changes the law by its sign, and the sign before the step: the scalar part of a feedback's error, or under quadratic
    /// damping `ω(0)·ω(t)`, since the series of |ω| goes on as −|ω| beyond a zero of ω.
    pub(super) fn switch(&self, motion: &Motion) -> Option<(Vec<f64>, f64)> {
        let orders = motion.omega[0].len();
        match self {
            Self::Feedback { target, sign, .. } => {
                let scalar = |k| {
                    let q = at(&motion.attitude, k).map(|x| Number::constant(x.value));
                    quaternion_product(target, &q)[3].value
                };
                Some(((0..orders).map(scalar).collect(), *sign))
            }
            Self::Quadratic { speeds, .. } if speeds[0].value > 0.0 => {
                let w = &motion.omega;
                let along = |k: usize| w.iter().map(|x| x[0].value * x[k].value).sum();
                Some(((0..orders).map(along).collect(), 1.0))
            }
            _ => None,
        }
    }

    /// Takes the sign of a feedback in the attitude q.
    pub(super) fn take_sign(&mut self, q: &Quadruple) {
        if let Self::Feedback { target, sign, .. } = self {
            let scalar = quaternion_product(target, q)[3].value;
            *sign = if scalar < 0.0 { -1.0 } else { 1.0 };
        }
    }

    /// Past a change of the law, if it has one there: by how much the torque was more before it, and by how much later, for each
    /// variable, neighbours come to it.
    pub(super) fn flip(&mut self, omega: &Vector, q: &Quadruple) -> Option<(Vector, [f64; WIDTH])> {
        let Self::Feedback {
            stiffness,
            target,
            sign,
        } = self
        else {
            return None;
        };
        let [x, y, z, scalar] = quaternion_product(target, q);
        // ẇ = −½ vec(e)·ω.
        let rate = -0.5 * dot(&[x, y, z], omega).value;
        let more = times(&apply(stiffness, &[x, y, z]), -2.0 * *sign);
        *sign = -*sign;
        Some((more, scalar.slopes.map(|slope| -slope / rate)))
    }

    /// The longest step through a rest in which quadratic damping is left out, or toward one: rounding in the series of |ω| grows as
    /// 1/|ω| does, so that a step does not go as far as ω would take to zero at its present rate.
    pub(super) fn limit(&self, motion: &Motion, fastest: f64) -> f64 {
        let size = |k: usize| {
            (motion.omega.iter())
                .map(|x| x[k].value.powi(2))
                .sum::<f64>()
                .sqrt()
        };
        match self {
            Self::Quadratic { .. } if size(0) <= STILL * fastest => 2.0 * STILL * fastest / size(1),
            Self::Quadratic { .. } => 0.8 * size(0) / size(1),
            _ => f64::INFINITY,
        }
    }
}

/// The coefficient of order `k` of `s = √u` from s s = u: `s_k = (u_k − Σ_{0<j<k} s_j s_{k−j})/2s₀`.
fn speed(k: usize, squares: &[Number], speeds: &[Number], fastest: f64) -> Number {
    if k == 0 {
        let value = squares[0].value.sqrt();
        if value <= STILL * fastest {
            return ZERO;
        }
        return Number {
            value,
            slopes: squares[0].slopes.map(|slope| slope * (0.5 / value)),
        };
    }
    if speeds[0].value == 0.0 {
        return ZERO;
    }
    let known = (1..k).fold(ZERO, |sum, j| sum + speeds[j] * speeds[k - j]);
    (squares[k] - known) * 0.5 / speeds[0]
}
