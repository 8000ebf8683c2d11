//! One motion as the stepper needs it: in principal axes, in a unit of time of its own, from break to break of its load.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::field::Field;
use crate::error::Error;
use crate::mass::validity::ROUNDING;
use crate::motion::attitude::from_axes;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::{Frame, Term};
use crate::motion::simulate::State;
use crate::numerics::double_double::two_sum;

/// A motion to be found: the body's equations about the reference point P, what acts on it, and its state at the start.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// Euler's equations about P.
    pub equations: EulerEquations,
    /// m.
    pub mass: f64,
    /// C from P, in B.
    pub center: Vector3<f64>,
    /// What acts.
    pub terms: &'a [Term],
    /// At the first output time.
    pub initial: State,
}

/// ω̇ between two breaks, linear in what varies, in principal axes and real units.
#[derive(Clone, Debug)]
struct Linear {
    constant: Vector3<f64>,
    on_omega: Matrix3<f64>,
    on_attitude: [[f64; 4]; 3],
    /// A torque `M R_PN v` for each vector v fixed in space.
    on_space: Vec<(Vector3<f64>, Matrix3<f64>)>,
}

/// A motion on its way.
pub(super) struct Course<'a> {
    problem: Problem<'a>,
    times: &'a [f64],
    kappa: Vector3<f64>,
    inverse_moments: Vector3<f64>,
    axes: Matrix3<f64>,
    q_bp: UnitQuaternion<f64>,
    linear: Linear,
    /// Units of time to the second: a power of two near the fastest rate of the motion.
    unit: f64,
}

impl<'a> Course<'a> {
    pub(super) fn new(problem: Problem<'a>, times: &'a [f64]) -> Result<Self, Error> {
        let [i1, i2, i3] = problem.equations.moments();
        let axes = *problem.equations.axes();
        let over = |number: f64, moment: f64| if moment > 0.0 { number / moment } else { 0.0 };
        let mut course = Self {
            problem,
            times,
            kappa: Vector3::new(over(i2 - i3, i1), over(i3 - i1, i2), over(i1 - i2, i3)),
            inverse_moments: Vector3::new(over(1.0, i1), over(1.0, i2), over(1.0, i3)),
            axes,
            q_bp: from_axes(&axes),
            linear: Linear {
                constant: Vector3::zeros(),
                on_omega: Matrix3::zeros(),
                on_attitude: [[0.0; 4]; 3],
                on_space: Vec::new(),
            },
            unit: 1.0,
        };
        course.make_linear()?;
        Ok(course)
    }

    fn make_linear(&mut self) -> Result<(), Error> {
        let to_p = self.axes.transpose();
        let inv = Matrix3::from_diagonal(&self.inverse_moments);
        for term in self.problem.terms {
            match term {
                Term::ConstantTorque {
                    vector,
                    frame: Frame::Body,
                } => self.linear.constant += inv * (to_p * vector),
                Term::ConstantTorque { vector, .. } => {
                    self.linear.on_space.push((*vector, inv));
                }
                Term::UniformGravity { gravity } => {
                    let c = to_p * self.problem.center;
                    self.linear
                        .on_space
                        .push((gravity * self.problem.mass, inv * c.cross_matrix()));
                }
            }
        }
        let _ = ROUNDING;
        Ok(())
    }

    pub(super) fn unit(&self) -> f64 {
        self.unit
    }

    pub(super) fn direction(&self) -> f64 {
        (self.times[self.times.len() - 1] - self.times[0]).signum()
    }

    /// ω in principal axes and units of time, and (x, y, z, w) of the attitude.
    pub(super) fn start(&self) -> [f64; 7] {
        let State { attitude, omega } = self.problem.initial;
        let q = (attitude * self.q_bp).into_inner();
        let w = self.axes.tr_mul(&omega);
        [w.x, w.y, w.z, q.i, q.j, q.k, q.w]
    }

    pub(super) fn in_body(&self, state: &[f64; 7]) -> State {
        let [x, y, z, i, j, k, w] = *state;
        let q_np = Quaternion::new(w, i, j, k);
        State {
            attitude: UnitQuaternion::new_normalize(q_np * self.q_bp.conjugate().into_inner()),
            omega: self.axes * Vector3::new(x, y, z) * self.unit,
        }
    }

    pub(super) fn choose_unit(&mut self, omega: &[f64; 3]) -> f64 {
        let linear = &self.linear;
        let mut rate = Vector3::from(*omega).norm();
        rate = rate.max(linear.on_omega.amax());
        rate = rate.max(linear.constant.amax().sqrt());
        for (v, m) in &linear.on_space {
            rate = rate.max((v.amax() * m.amax()).sqrt());
        }
        let bits = rate.to_bits() & 0x7ff0_0000_0000_0000;
        self.unit = f64::from_bits(bits).clamp(1e-300, 1e300);
        if rate == 0.0 {
            self.unit = 1.0;
        }
        self.unit
    }

    pub(super) fn field<const B: usize>(&self) -> Field<f64, B> {
        let u2 = self.unit * self.unit;
        let mut field = Field {
            kappa: self.kappa.into(),
            constant: (self.linear.constant / u2).into(),
            on_omega: [[0.0; 3]; 3],
            on_attitude: [[0.0; 4]; 3],
            on_space: [[[0.0; 3]; 3]; B],
        };
        for n in 0..3 {
            for i in 0..3 {
                field.on_omega[n][i] = self.linear.on_omega[(n, i)] / self.unit;
            }
        }
        if B == 1 {
            for (v, m) in &self.linear.on_space {
                for n in 0..3 {
                    for i in 0..3 {
                        field.on_space[0][n][i] = m[(n, i)] * (v.norm() / u2);
                    }
                }
            }
        }
        field
    }

    pub(super) fn directions<const B: usize>(&self) -> [[f64; 3]; B] {
        let mut d = [[0.0; 3]; B];
        if B == 1 {
            for (v, _) in &self.linear.on_space {
                d[0] = v.normalize().into();
            }
        }
        d
    }

    pub(super) fn output(&self, k: usize) -> (f64, f64) {
        let (h, l) = two_sum(self.times[k], -self.times[0]);
        (h * self.unit, l * self.unit)
    }

    pub(super) fn end_of_segment(&self) -> (f64, f64) {
        (f64::INFINITY * self.direction(), 0.0)
    }

    pub(super) fn pass_break(&mut self) -> Result<(), Error> {
        Ok(())
    }

    pub(super) fn time(&self, now: (f64, f64)) -> f64 {
        self.times[0] + now.0 / self.unit
    }

    pub(super) fn fraction(&self, now: f64) -> f64 {
        now / self.unit / (self.times[self.times.len() - 1] - self.times[0])
    }
}
